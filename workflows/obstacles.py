"""Obstacles: reasons why the robots cannot do what the controller asks, with remedies; a verb prints them last."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..console import Printer
    from ..models.files.gains_file import GainsFile
    from ..models.fleet import Fleet
    from ..models.tolerance import Tolerance
    from ..reports.obstacles import Obstacle
    from ..verify.simulation.disturbance import Disturbance


def obstacles_of(printer: Printer, fleet: Fleet, gains: GainsFile, tolerance: Tolerance) -> list[Obstacle]:
    """Print the largest demands on every robot. Returns the obstacles."""
    from ..reports.obstacles import of_fleet, of_gains
    from ..reports.tables.demands_table import demand_rows, for_terminal

    rows = demand_rows(fleet.with_links(gains.links), gains.excitation, gains.gains)
    printer.say(for_terminal(rows))
    return of_fleet(fleet) or of_gains(rows, tolerance)


def confirmed(printer: Printer, obstacles: Sequence[Obstacle], runs: str) -> list[Obstacle]:
    """The obstacles that stay where `runs` with the fleet's disturbance settle; what may happen becomes a note."""
    printer.say(*(f"note: {one.what}; {runs} settle all the same" for one in obstacles if one.possible))
    return [one for one in obstacles if not one.possible]


def say_slips(printer: Printer, fleet: Fleet) -> None:
    """Print one line for each kind of entry that is most likely a slip, before work is spent on it."""
    from ..models.plausibility import slips

    printer.say(*(f"warning: {line}" for line in slips(fleet)))


def say_slips_of_run(printer: Printer, fleet: Fleet, disturbance: Disturbance | None) -> None:
    """The same of what only a run has, before `simulate` and `validate`."""
    from ..models.plausibility import slips_of_run

    real = (disturbance.sample_time, disturbance.delay, disturbance.coulomb) if disturbance else (0.0, 0.0, 0.0)
    printer.say(*(f"warning: {line}" for line in slips_of_run(fleet, *real)))


def say_obstacles(printer: Printer, obstacles: Sequence[Obstacle]) -> None:
    """Print one line for each obstacle."""
    printer.say(*(f"NOT USABLE: {obstacle}" for obstacle in obstacles))
