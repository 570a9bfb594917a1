"""Section 4 of the paper again: `python examples/paper_figures.py [FOLDER] [--horizon S] [--gains GAINS]`.

Prints the paper's numbers with those of this run, and draws its figures 3 to 7 under both schemes, as SVG, PNG and PDF.
With --gains, for example the design.json of a design, the same under these gains stands beside it.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import NamedTuple

from gaincert import load_fleet, load_gains, simulate, summarize
from gaincert.models.conditions import condition_15, condition_16, condition_16_star, exact_numbers
from gaincert.models.errors import InputError
from gaincert.models.files.gains_file import GainsFile
from gaincert.models.fleet import Fleet
from gaincert.reports.figures.run_figures import write_figures
from gaincert.verify.simulation.summary import Summary
from gaincert.verify.simulation.trajectory import Trajectory

HERE = Path(__file__).parent


class Reproduction(NamedTuple):
    """One set of gains under both schemes."""

    gains: GainsFile
    runs: dict[str, Trajectory]  # scheme -> run
    summaries: dict[str, Summary]


def reproduce(fleet: Fleet, gains: GainsFile, horizon: float) -> Reproduction:
    """Run the fleet from Table 2 under the unbounded and the bounded scheme."""
    runs = {
        f"{name} scheme": simulate(fleet, gains.gains, gains.excitation, bounded=name == "bounded", horizon=horizon)
        for name in ("unbounded", "bounded")
    }
    return Reproduction(gains, runs, {name: summarize(fleet, run) for name, run in runs.items()})


def conditions_table(fleet: Fleet, gains: GainsFile) -> list[str]:
    """Both sides of (15), (16) and (16*) for every vehicle."""
    data, numbers = fleet.condition_data(gains.excitation), exact_numbers()
    lines = [
        f"|psi| <= {float(data.psi_bar):.5f}",
        "vehicle         (15) / N m          (16) / N m         (16*) / N m",
    ]
    sides = [condition(numbers, data, gains.gains) for condition in (condition_15, condition_16, condition_16_star)]
    for i, name in enumerate(fleet.names):
        pairs = [(float(side.small[i]), "<" if side.holds[i] else ">", float(side.large[i])) for side in sides]
        lines.append(f"{name:7} " + " ".join(f"{left:9.2f} {sign} {right:7.2f}" for left, sign, right in pairs))
    return lines


def claims_table(found: Reproduction) -> list[str]:
    """What Section 4 says of its figures, and what came out."""
    unbounded, bounded = (found.summaries[f"{name} scheme"] for name in ("unbounded", "bounded"))
    return [
        f"figures 3-6, 'the formation goal is achieved': unbounded scheme {outcome(unbounded)}",
        f"                                               bounded scheme {outcome(bounded)}",
        f"figure 7, left, unbounded torques: up to {unbounded.peak_torque_ratio:.3g} times the limit",
        f"figure 7, right, 'the bounds of the actuators': up to {bounded.peak_torque_ratio:.3g} of the limit",
    ]


def outcome(summary: Summary) -> str:
    """Whether a run settles, and its errors at the end."""
    settled = f"settles after {summary.settling_time:.1f} s" if summary.settled else f"is {summary.approach}"
    errors = f"{summary.final_position_error:.3g} m and {summary.final_heading_error:.3g} rad off"
    return f"{settled}, {errors} after {summary.horizon:g} s"


def main() -> None:
    """Print and draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", type=Path, default=Path("out/figures"), help="[out/figures]")
    parser.add_argument("--horizon", type=float, default=200.0, metavar="S", help="simulated time of every run [200]")
    parser.add_argument("--gains", type=Path, help="other gains, to stand beside the paper's")
    options = parser.parse_args()
    fleet = load_fleet(HERE / "paper.toml")
    files = {"the paper's gains": HERE / "paper_gains.toml"} | ({"other gains": options.gains} if options.gains else {})
    try:
        loaded = {title: load_gains(path, fleet) for title, path in files.items()}
    except InputError as error:
        parser.error(str(error))
    drawn: dict[str, Trajectory] = {}
    for title, gains in loaded.items():
        found = reproduce(fleet.with_links(gains.links), gains, options.horizon)
        drawn |= {f"{title}, {name}": run for name, run in found.runs.items()}
        print(f"{title} ({files[title].name})", *conditions_table(fleet, gains), *claims_table(found), "", sep="\n")
    print(*(path for path in write_figures(fleet, drawn, options.folder) if path.suffix == ".pdf"), sep="\n")


if __name__ == "__main__":
    main()
