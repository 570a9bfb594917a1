"""`gaincert simulate`: the fleet from its start, in files, figures and words."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..console import Printer
    from ..models.files.gains_file import GainsFile
    from ..models.fleet import Fleet
    from ..models.tolerance import Tolerance
    from ..verify.simulation.disturbance import Disturbance
    from ..verify.simulation.recording import Recording
    from ..verify.simulation.simulate import Trajectory

CHAOTIC = 0.5  # m between two accurate integrations of one start: beyond, rounding decides part of the run


@dataclass(frozen=True)
class Simulation:
    """What `simulate` is to do."""

    schemes: tuple[str, ...]  # "bounded", "unbounded"; the first is summarised
    horizon: float | None  # s, None: until settled and a while longer
    tolerance: Tolerance
    engine: str = "auto"
    disturbance: Disturbance | None = None


def simulate_schemes(
    printer: Printer, fleet: Fleet, gains: GainsFile, simulation: Simulation, folder: Path
) -> dict[str, Any]:
    """Simulate the schemes and write all files; the content of summary.json."""
    from ..models.files.text import write_json
    from ..reports.deployment import write_fleet_copy
    from ..reports.figures.run_figures import write_figures
    from ..reports.versions import versions
    from ..verify.simulation.disturbance import in_words
    from ..verify.simulation.simulate import integration_error, summarize

    scheme, tolerance = simulation.schemes[0], simulation.tolerance
    runs = _runs(printer, fleet, gains, simulation)
    first = runs[scheme]
    stored: Recording = first
    summary = {**summarize(fleet, first, tolerance), **integration_error(first)}
    drawn: dict[str, Recording] = {f"{name} scheme": run for name, run in runs.items()}
    printer.say(f"simulation of the {scheme} scheme: {sentence(summary)}", *sensitivity(summary))
    if simulation.disturbance is not None:
        summary, stored = _disturbed(fleet, first, simulation.disturbance, tolerance, summary)
        drawn = {"with the disturbance": stored, **drawn}
        printer.say(f"with the disturbance ({in_words(summary['disturbance'])}): {sentence(summary)}")
    record = {**summary, "scheme": scheme, "fleet_digest": fleet.digest, "versions": versions()}
    stored.write(folder / "trajectory.npz")
    write_json(folder / "summary.json", record)
    write_fleet_copy(fleet, folder)
    write_figures(fleet, drawn, folder / "figures")
    printer.say(*(f"FALSE: {violation}" for violation in summary["violations"]), f"figures: {folder / 'figures'}")
    return record


def _runs(printer: Printer, fleet: Fleet, gains: GainsFile, simulation: Simulation) -> dict[str, Trajectory]:
    """A run of every scheme, all as long as the first; a further scheme that cannot be integrated is left out."""
    from ..models.errors import UndecidedError
    from ..verify.simulation.simulate import simulate

    runs: dict[str, Trajectory] = {}
    for scheme in simulation.schemes:
        end = float(runs[simulation.schemes[0]].t[-1]) if runs else simulation.horizon
        try:
            with printer.progress() as progress:
                runs[scheme] = simulate(
                    fleet.with_links(gains.links),
                    gains.gains,
                    gains.excitation,
                    bounded=scheme == "bounded",
                    horizon=end,
                    tolerance=simulation.tolerance,
                    engine=simulation.engine,
                    progress=progress,
                )
        except UndecidedError as error:
            if not runs:
                raise
            printer.say(f"{scheme} scheme for comparison: {error}")
    return runs


def _disturbed(
    fleet: Fleet, nominal: Trajectory, disturbance: Disturbance, tolerance: Tolerance, summary: dict[str, Any]
) -> tuple[dict[str, Any], Recording]:
    """The same start under the disturbance: its summary, with the nominal one in it, and its run."""
    from ..models.equations import State
    from ..verify.simulation.disturbance import disturbed_run, disturbed_summary

    start = State(*(column[0] for column in nominal.state))
    outcome, run = disturbed_run(fleet, nominal.loop, start, disturbance, float(nominal.t[-1]), tolerance)
    return disturbed_summary(outcome, run, tolerance, disturbance, summary), run


def sentence(summary: dict[str, Any]) -> str:
    """A summary for a reader."""
    settled, error = summary["settling_time_s"], summary.get("integration_error_m", CHAOTIC)
    return (
        (f"settles after {settled:.1f} s" if settled is not None else f"not settled by {summary['horizon_s']:g} s")
        + f", peak torque {100 * summary['peak_torque_ratio']:.1f} % of the limit, "
        f"final error {summary['final_position_error_m']:.3g} m, {summary['final_heading_error_rad']:.3g} rad"
        + ("" if error >= CHAOTIC else f", integration error below {error:.1g} m")
    )


def sensitivity(summary: dict[str, Any]) -> list[str]:
    """What a reader has to know of a chaotic run."""
    apart = summary["integration_error_m"]
    if apart < CHAOTIC:
        return []
    return [
        f"this start is sensitive: two accurate integrations of it are up to {apart:.1g} m apart on the way, because "
        "rounding grows while the vehicles still turn fast. Both obey the same equations; times from many starts "
        "(gaincert validate) mean more than the time from this one"
    ]
