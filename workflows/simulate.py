"""`gaincert simulate`: the fleet from its start, in files, figures and words."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .inputs import check_folder, digests_of

if TYPE_CHECKING:
    from ..console import Printer
    from ..models.files.gains_file import GainsFile
    from ..models.fleet import Fleet
    from ..models.tolerance import Tolerance
    from ..reports.obstacles import Obstacle
    from ..verify.simulation.disturbance import Disturbance
    from ..verify.simulation.summary import Summary
    from ..verify.simulation.trajectory import Trajectory

CHAOTIC = 0.5  # m between two accurate integrations of one start: above it part of the run depends on rounding


@dataclass(frozen=True)
class Simulation:
    """The options of `simulate`."""

    schemes: tuple[str, ...]  # "bounded", "unbounded"; the first is summarised
    horizon: float | None  # s, None: until settled and a while longer
    tolerance: Tolerance
    engine: str = "auto"
    disturbance: Disturbance | None = None


@dataclass(frozen=True)
class Simulated:
    """The results of `simulate`."""

    summary: Summary  # of the first scheme; of its disturbed run if there is a disturbance
    document: dict[str, Any]  # the content of summary.json
    obstacles: list[Obstacle]  # collisions, and a disturbance with which the robots do not arrive

    @property
    def false_claims(self) -> list[str]:
        """Broken promises of the theorem, and a torque above its limit, which the unbounded scheme does not prevent."""
        summary = self.summary
        over = summary.peak_torque_ratio > 1 and not summary.violations
        peak = f"the largest wheel torque is {summary.peak_torque_ratio:.3g} times its limit"
        return [*summary.violations, *([peak] if over else [])]


def simulate_schemes(
    printer: Printer, fleet: Fleet, gains: GainsFile, simulation: Simulation, folder: Path
) -> Simulated:
    """Simulate the schemes, write all files and print the results."""
    from ..reports.obstacles import footprint_hints, of_run
    from ..verify.simulation.simulate import summarize

    scheme, disturbance = simulation.schemes[0], simulation.disturbance
    check_folder(folder)
    runs = _runs(printer, fleet, gains, simulation)
    drawn = {f"{name} scheme": run for name, run in runs.items()}
    first = stored = runs[scheme]
    summary = summarize(fleet, first, simulation.tolerance, with_error=True)
    printer.say(f"simulation of the {scheme} scheme: {sentence(summary)}", *hints(summary), motion(summary))
    for name in simulation.schemes[1:]:
        if name in runs:
            beside = summarize(fleet, runs[name], simulation.tolerance)
            printer.say(f"the {name} scheme for comparison: {sentence(beside)}")
    if disturbance is not None:
        summary, stored = _disturbed(fleet, first, disturbance, summary)
        drawn = {"with the disturbance": stored, **drawn}
        printer.say(f"with the disturbance ({disturbance.in_words()}): {sentence(summary)}", motion(summary))
    result = Simulated(summary, _document(fleet, gains, summary, scheme), of_run(fleet, summary))
    _write(fleet, stored, drawn, result.document, folder)
    printer.say(
        *footprint_hints(fleet, summary),
        *(f"FALSE: {claim}" for claim in result.false_claims),
        f"figures: {folder / 'figures'}",
    )
    return result


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
    fleet: Fleet, nominal: Trajectory, disturbance: Disturbance, summary: Summary
) -> tuple[Summary, Trajectory]:
    """The same start under the disturbance: its summary, with the nominal one in it, and its run."""
    from ..verify.simulation.sampled_loop import SampledLoop

    loop, horizon = nominal.made_by.loop, float(nominal.t[-1])
    return SampledLoop(fleet, loop, disturbance, horizon, summary.tolerance).run(nominal.start, summary)


def _document(fleet: Fleet, gains: GainsFile, summary: Summary, scheme: str) -> dict[str, Any]:
    from ..reports.versions import versions

    origin = digests_of(fleet, gains).to_json()
    return {**summary.to_json(), "scheme": scheme, **origin, "versions": versions()}


def _write(
    fleet: Fleet, stored: Trajectory, drawn: dict[str, Trajectory], document: dict[str, Any], folder: Path
) -> None:
    from ..models.digests import Digests
    from ..models.files.text import write_json
    from ..reports.deployment import write_fleet_copy
    from ..reports.figures.run_figures import write_figures

    origin = Digests.of_json(document)
    stored.write(folder / "trajectory.npz", origin.to_json())
    write_json(folder / "summary.json", document)
    write_fleet_copy(fleet, folder)
    write_figures(fleet, drawn, folder / "figures", str(origin))


def sentence(summary: Summary) -> str:
    """A summary for a reader."""
    settled = f"settles after {summary.settling_time:.1f} s"
    error = summary.integration_error
    return (
        (settled if summary.settled else f"not settled within {summary.horizon:g} s ({summary.approach})")
        + f", peak torque {100 * summary.peak_torque_ratio:.3g} % of the limit, "
        f"final error {summary.final_position_error:.3g} m, {summary.final_heading_error:.3g} rad"
        + ("" if error is None or error.position >= CHAOTIC else f", integration error below {error.position:.1g} m")
    )


def motion(summary: Summary) -> str:
    """Room, least distance and top speeds of a run, for a reader."""
    speeds = f"top speed {summary.peak_speed:.3g} m/s, turn rate {summary.peak_turn_rate:.3g} rad/s"
    return f"{summary.room.sentence()}; {speeds}" if summary.room else speeds


def hints(summary: Summary) -> list[str]:
    """Notes on a chaotic run, and on a run that was too short."""
    error, found = summary.integration_error, []
    if error is not None and error.position >= CHAOTIC:
        found.append(
            f"this start is sensitive: two accurate integrations of it are up to {error.position:.1g} m apart on the "
            "way, because rounding grows while the vehicles still turn fast. Both obey the same equations; times from "
            "many starts (gaincert validate) mean more than the time from this one"
        )
    if not summary.settled and summary.disturbance is None:
        found.append("give a longer --horizon to see it settle")
    return found
