"""`urdf = ...` of a [[vehicle]] table: the description's numbers replace it, but not the fleet file's own keys."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

from ...errors import InputError, did_you_mean, shown
from .description import RobotDescription, read_robot
from .wheels import WheelNames

_SIDES = ("left_wheels", "right_wheels")
_STAND_IN = dict.fromkeys(("mass", "inertia", "half_track", "wheel_radius", "torque_limit"), 1)


class Robot(NamedTuple):
    """The description of one vehicle, and the keys and limits that the fleet file replaces."""

    description: RobotDescription
    given: frozenset[str]


class Source(NamedTuple):
    """A vehicle's `urdf` entry."""

    file: str
    names: WheelNames | None


def with_robots(
    content: dict[str, Any], folder: Path, mistakes: list[str]
) -> tuple[dict[str, Any], tuple[Robot | None, ...]]:
    """The content with every `urdf` replaced by the numbers of its description, and the robot of each vehicle.

    Adds a line to `mistakes` for each that cannot be read; stand-in numbers keep the other mistakes of the file apart.
    """
    vehicles = content.get("vehicle")
    if not isinstance(vehicles, list) or not any(isinstance(v, dict) and "urdf" in v for v in vehicles):
        return content, ()
    known: dict[tuple[Source, frozenset[str]], RobotDescription | None] = {}
    replaced: list[Any] = []
    robots: list[Robot | None] = []
    for vehicle in vehicles:
        robots.append(None)
        if isinstance(vehicle, dict) and "urdf" in vehicle:
            limits = vehicle.get("limits")
            given = frozenset(vehicle).union(limits if isinstance(limits, dict) else ()) - {"urdf", "name"}
            description = None
            try:
                source = _source(vehicle)
                if (source, given) not in known:
                    known[source, given] = None
                    known[source, given] = read_robot(folder / source.file, source.names, given)
                description = known[source, given]
            except InputError as error:
                mistakes += error.mistakes
            if description:
                robots[-1] = Robot(description, given)
            vehicle = _merged(description.vehicle_keys() if description else _STAND_IN, vehicle)
        replaced.append(vehicle)
    return {**content, "vehicle": replaced}, tuple(robots)


def _merged(described: dict[str, Any], vehicle: dict[str, Any]) -> dict[str, Any]:
    merged = {**described, **{key: value for key, value in vehicle.items() if key != "urdf"}}
    if isinstance(vehicle.get("limits"), dict):
        merged["limits"] = {**described.get("limits", {}), **vehicle["limits"]}
    return merged


def _source(vehicle: dict[str, Any]) -> Source:
    """The file and the wheels that a `urdf` entry names. Raises InputError."""
    entry, urdf = vehicle["urdf"], f"vehicle {shown(vehicle.get('name', 'without name'))}: urdf"
    if isinstance(entry, str):
        return Source(entry, None)
    if not isinstance(entry, dict):
        raise InputError(
            f"{urdf} = {shown(entry)} must be a text in quotes, or {{ file = ..., left_wheels = [...], ... }}"
        )
    if unknown := [key for key in entry if key not in ("file", *_SIDES)]:
        hint = did_you_mean(unknown[0], ("file", *_SIDES))
        raise InputError(f"{urdf}: unknown key {unknown[0]!r}{hint}; correct or remove it")
    if not isinstance(entry.get("file"), str):
        raise InputError(f"{urdf}: file = {shown(entry.get('file'))} must be a text in quotes")
    present = [side for side in _SIDES if side in entry]
    for side in present:
        names = entry[side]
        if not isinstance(names, list) or not names or not all(isinstance(name, str) for name in names):
            raise InputError(f"{urdf}: {side} = {shown(names)} must be a list of joint names in quotes")
    if len(present) == 1:
        raise InputError(f"{urdf}: {present[0]} is given and the other side is not; name the wheels of both sides")
    return Source(entry["file"], WheelNames(*(tuple(entry[side]) for side in _SIDES)) if present else None)
