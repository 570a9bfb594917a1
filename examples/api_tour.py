"""The Python interface from a fleet to code for its robots: `python examples/api_tour.py [FOLDER]`."""

from __future__ import annotations

import sys
from pathlib import Path

from gaincert import certify, design, export, load_fleet, prove, simulate, write_report
from gaincert.models.conditions import exact_numbers, torque_bound
from gaincert.models.errors import InputError
from gaincert.models.files.text import write_json
from gaincert.reports.deployment import write_fleet_copy
from gaincert.verify.simulation.simulate import summarize


def tour(folder: Path, mode: str = "fast") -> None:
    """Design, certify, simulate, prove, report and export the line of TurtleBots."""
    fleet = load_fleet(Path(__file__).parent / "turtlebot3_line.toml")
    print(f"{fleet.name}: {len(fleet)} vehicles, {fleet.graph.edges} links, {fleet.digest[:14]}...")

    designed = design(fleet, conditions="corrected", mode=mode)
    print("p_v / N:", ", ".join(f"{float(p):g}" for p in designed.gains.p_v), "found by the", designed.origin)
    print("psi is bounded by", float(designed.excitation.bound))

    certificate = certify(fleet, designed.excitation, designed.gains, "corrected")
    certificate.write(folder / "certificate.json")  # raises InputError where it is not valid
    print(*certificate.facts, sep="\n")

    bounds = torque_bound(exact_numbers(), fleet.condition_data(designed.excitation), designed.gains)
    print("torque bounds (16*) / N m:", ", ".join(f"{float(bound):.4g}" for bound in bounds))

    run = simulate(fleet, designed.gains, designed.excitation, horizon=60.0)
    print(f"{len(run.t)} stored points; x is {run.state.x.shape}, torques up to {abs(run.tau_left).max():.3g} N m")
    run.write(folder / "trajectory.npz")
    write_json(folder / "summary.json", summarize(fleet, run).to_json())

    broken = designed.gains.map(lambda gains: gains * 1000)
    try:
        certify(fleet, designed.excitation, broken, "corrected").write(folder / "broken.json")
    except InputError as error:
        print("not certified:", error.mistakes[0])

    claims = prove(fleet)
    print(sum(claim.status.name == "PROVED" for claim in claims), "of", len(claims), "claims are proved as they stand")

    write_fleet_copy(fleet, folder)  # so that report and export need nothing but the folder
    print(*export(folder, "c"), write_report(folder), sep="\n")


if __name__ == "__main__":
    tour(Path(sys.argv[1] if len(sys.argv) > 1 else "out/tour"))
