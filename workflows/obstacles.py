"""What a controller asks of the robots, and why they cannot do it: the last lines of a verb, with the remedy."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..console import Printer
    from ..models.files.gains_file import GainsFile
    from ..models.fleet import Fleet
    from ..models.tolerance import Tolerance
    from ..reports.obstacles import Obstacle


def obstacles_of(printer: Printer, fleet: Fleet, gains: GainsFile, tolerance: Tolerance) -> list[Obstacle]:
    """Say what the controller can ask of every robot; what makes that useless."""
    from ..reports.obstacles import of_fleet, of_gains
    from ..reports.tables.demands_table import demand_rows, for_terminal

    rows = demand_rows(fleet.with_links(gains.links), gains.excitation, gains.gains)
    printer.say(for_terminal(rows))
    return of_fleet(fleet) or of_gains(rows, tolerance)


def say_obstacles(printer: Printer, obstacles: Sequence[Obstacle]) -> None:
    """One line for each."""
    printer.say(*(f"NOT USABLE: {obstacle}" for obstacle in obstacles))
