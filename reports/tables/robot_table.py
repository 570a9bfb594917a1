"""The numbers used for every robot of a fleet, each with its source."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

from ...models.files.fleet_file import FleetFile
from ...models.files.robots.fleet_robots import Robot
from ...models.fleet import Fleet
from ...models.fleet_tables import Vehicle
from ...models.numbers import Interval
from ...models.plausibility import taken_to_be
from ...models.vehicle_notes import is_off_axle, place_of_mass

SHOWN = 20  # different robots that are printed
_LIMITS = {
    "speed": "m/s",
    "turn_rate": "rad/s",
    "wheel_speed": "rad/s",
    "acceleration": "m/s^2",
    "turn_acceleration": "rad/s^2",
}


class Entry(NamedTuple):
    """One quantity of a robot."""

    quantity: str
    value: str  # with its unit
    source: str


@dataclass(frozen=True)
class RobotSummary:
    """The numbers of vehicles that are the same robot."""

    vehicles: tuple[str, ...]
    words: str  # what the robot is taken to be
    entries: tuple[Entry, ...]
    warnings: tuple[str, ...]

    def to_json(self) -> dict[str, Any]:
        """The entry in the JSON document of `check`."""
        numbers = [entry._asdict() for entry in self.entries]
        return {
            "vehicles": list(self.vehicles),
            "taken_to_be": self.words,
            "numbers": numbers,
            "warnings": list(self.warnings),
        }

    def lines(self) -> Iterator[str]:
        """The lines that `check` prints."""
        names = ", ".join(self.vehicles[:6]) + (f" and {len(self.vehicles) - 6} more" if len(self.vehicles) > 6 else "")
        yield f"robot {names}: {self.words}"
        for entry in self.entries:
            yield f"  {entry.quantity:22} {entry.value:24} {entry.source}"


def robot_summaries(read: FleetFile) -> list[RobotSummary]:
    """The robots of a fleet file, in file order; vehicles that are the same robot share an entry."""
    groups: dict[tuple[str, tuple[Entry, ...], tuple[str, ...]], list[str]] = {}
    robots = read.robots or (None,) * len(read.fleet)
    for vehicle, robot in zip(read.fleet.vehicles, robots, strict=True):
        warnings = (
            tuple(f"{robot.description.path.name}: {line}" for line in robot.description.warnings) if robot else ()
        )
        robot_as_read = (taken_to_be(vehicle), tuple(_entries(read.fleet, vehicle, robot)), warnings)
        groups.setdefault(robot_as_read, []).append(vehicle.name)
    return [RobotSummary(tuple(names), *group) for group, names in groups.items()]


def _entries(fleet: Fleet, vehicle: Vehicle, robot: Robot | None) -> Iterator[Entry]:
    arm = "arm" if fleet.drive == "paper" else "R"
    yield Entry("mass", _number(vehicle.mass, "kg"), _source(robot, "mass"))
    yield Entry("effective mass", _number(vehicle.mass_bounds(), "kg"), "mass + 2 J / r^2")
    yield Entry("inertia", _number(vehicle.inertia, "kg m^2"), _source(robot, "inertia"))
    effective = vehicle.inertia_bounds(fleet.arm_factor)
    yield Entry("effective inertia", _number(effective, "kg m^2"), f"inertia + 2 J ({arm} / r)^2")
    yield Entry("half track R", _number(vehicle.half_track, "m"), _source(robot, "half_track"))
    yield Entry("wheel radius r", _number(vehicle.wheel_radius, "m"), _source(robot, "wheel_radius"))
    yield Entry(
        "wheel inertia J",
        _number(vehicle.wheel_inertia, "kg m^2"),
        _source(robot, "wheel_inertia") if vehicle.wheel_inertia else "not given",
    )
    for side in ("left", "right"):
        torque = _number(getattr(vehicle.torque_limit, side), "N m")
        yield Entry(f"{side} torque limit", torque, _source(robot, "torque_limit", f"torque_limit_{side}"))
    for name, unit in _LIMITS.items():
        if (limit := getattr(vehicle.limits, name)) is not None:
            yield Entry(f"limit {name}", _number(limit, unit), _source(robot, name))
    if is_off_axle(vehicle):
        yield Entry("centre of mass", place_of_mass(vehicle), _source(robot, "com_offset", "com_ahead"))
    if robot:
        described = robot.description
        for side, joints in (("left", described.left_wheels), ("right", described.right_wheels)):
            yield Entry(f"{side} wheels", ", ".join(joints), described.path.name)
        for ignored in described.ignored:
            yield Entry("ignored joint", ignored.joint, ignored.why)


def _source(robot: Robot | None, key: str, part: str = "") -> str:
    """The source of a key of the fleet file; `part` is its name in the description if that differs."""
    described = robot.description.numbers.get(part or key) if robot and key not in robot.given else None
    return f"{robot.description.path.name}: {described.source}" if robot and described else "fleet file"


def _number(value: Any, unit: str) -> str:
    """A value or an interval with six digits and its unit."""
    if isinstance(value, (Interval, tuple)):
        least, most = (f"{float(end):.6g}" for end in value)
        return f"{least} {unit}" if least == most else f"{least} to {most} {unit}"
    return f"{float(value):.6g} {unit}"
