"""`gaincert check`: the content of a fleet file, the numbers used for every robot, and notes on surprising entries."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from .obstacles import say_obstacles

if TYPE_CHECKING:
    from ..console import Printer


def check_fleet(printer: Printer, path: Path) -> dict[str, Any]:
    """Print the summary of a fleet file and return it, as JSON. Raises InputError with all mistakes."""
    from ..models.files.fleet_file import load_fleet_file
    from ..models.plausibility import in_degrees, slips
    from ..models.vehicle_notes import centre_of_mass_note, heading_hint
    from ..reports.obstacles import of_fleet
    from ..reports.tables.fleet_summary import fleet_summary
    from ..reports.tables.robot_table import SHOWN, robot_summaries

    read = load_fleet_file(path)
    summary, robots = fleet_summary(read.fleet), robot_summaries(read)
    leader = read.fleet.leader
    turned = (one for one in read.fleet.vehicles if not (one.start and in_degrees(one.start)))  # else a warning says so
    hints = (heading_hint(vehicle, leader) for vehicle in turned if not in_degrees(leader))
    notes = list(filter(None, (centre_of_mass_note(read.fleet), *hints)))
    printer.say(*(f"{key:24} {value}" for key, value in summary.items()))
    for robot in robots[:SHOWN]:
        printer.say("", *robot.lines())
    if len(robots) > SHOWN:
        printer.say("", f"{len(robots) - SHOWN} more robots; --json lists them")
    warnings = list(dict.fromkeys([*(line for robot in robots for line in robot.warnings), *slips(read.fleet)]))
    printer.say(*(f"warning: {line}" for line in warnings), *(f"note: {note}" for note in notes))
    obstacles = of_fleet(read.fleet)
    say_obstacles(printer, obstacles)
    document = {**summary, "robots": [robot.to_json() for robot in robots], "notes": notes, "warnings": warnings}
    return {**document, "obstacles": list(map(str, obstacles))}
