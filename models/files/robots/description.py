"""The numbers of (2) and the motor limits from a robot description, each with its source."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import InputError
from ...numbers import decimal_text, exact
from .document import read_document
from .masses import Body, impossible_inertias, read_bodies
from .rolling import Quantity, Wheel
from .tree import Tree, read_tree
from .wheel_search import found_wheels
from .wheels import DriveWheels, Ignored, WheelNames, named_wheels

# decimal places (significant digits below 1): computed numbers are rounded, so they agree on every processor
PLACES = 12


@dataclass(frozen=True)
class RobotDescription:
    """A differential drive, as described; unknown quantities are left out."""

    path: Path
    numbers: dict[str, Quantity]  # mass, inertia, half_track, wheel_radius, wheel_inertia, torque_limit_left, ...
    left_wheels: tuple[str, ...]  # joints
    right_wheels: tuple[str, ...]
    ignored: tuple[Ignored, ...]
    warnings: tuple[str, ...]

    def vehicle_keys(self) -> dict[str, Any]:
        """The keys of a [[vehicle]] table that the description fills."""
        values = {key: quantity.value for key, quantity in self.numbers.items()}
        sides = [values.pop(f"torque_limit_{side}", None) for side in ("left", "right")]
        ahead, left = (values.pop(f"com_{direction}", None) for direction in ("ahead", "left"))
        wheel_speed = values.pop("wheel_speed", None)
        keys: dict[str, Any] = dict(values)
        if None not in sides:
            keys["torque_limit"] = dict(zip(("left", "right"), sides, strict=True))
        if ahead is not None:
            keys["com_offset"] = [ahead, left]
        if wheel_speed is not None:
            keys["limits"] = {"wheel_speed": wheel_speed}
        return keys


def read_robot(path: Path, names: WheelNames | None = None, given: Iterable[str] = ()) -> RobotDescription:
    """Read a URDF or xacro file. `given` are the keys of the fleet file, which replace the description's.

    The robot is one rigid body in the plane: masses add up, and by the parallel-axis theorem so do the yaw inertias
    about the point midway between its drive wheels. Raises InputError with a line for every mistake.
    """
    root, given = read_document(path), frozenset(given)
    try:
        tree = read_tree(root)
        if word := _holonomic(tree, root.findall("gazebo")):
            raise ValueError(
                f"is a mecanum or omnidirectional base ({word!r}); (2) holds for wheels that do not slide sideways: "
                "no gains can be designed for it"
            )
        wheels = named_wheels(tree, names) if names else found_wheels(tree)
        numbers = {"half_track": Quantity(_decimal(wheels.half_track), _joints(wheels.all))}
        warnings = list(_backwards(tree, wheels))
        if "wheel_radius" not in given:
            numbers["wheel_radius"] = _radius(wheels)
        numbers |= _body_numbers(tree, wheels, given, warnings)
        numbers |= _motor_limits(wheels, warnings)
    except InputError as error:
        raise InputError(*(f"{path}: {line}" for line in error.mistakes)) from None
    except ValueError as error:
        raise InputError(f"{path}: {error}") from None
    left, right = (tuple(wheel.joint.name for wheel in side) for side in (wheels.left, wheels.right))
    return RobotDescription(path, numbers, left, right, wheels.ignored, tuple(warnings))


_HOLONOMIC = re.compile(
    r"mecanum|planar_?move|force_based_move|omni[_-]?(wheel|drive|directional|chassis|base)", re.IGNORECASE
)


def _holonomic(tree: Tree, extensions: Sequence[Any]) -> str | None:
    """The word in a plugin, mesh or name by which the robot moves sideways; None without one."""
    plugins = (plugin for extension in extensions for plugin in extension.iter("plugin"))
    words = [word for plugin in plugins for word in (plugin.get("filename"), plugin.get("name"))]
    words += [mesh.get("filename") for link in tree.links.values() for mesh in link.iter("mesh")]
    words += [*tree.links, *(joint.name for joint in tree.joints)]
    return next((word for word in words if word and _HOLONOMIC.search(word)), None)


def _backwards(tree: Tree, wheels: DriveWheels) -> Iterator[str]:
    """Wheels that the fleet file names may be swapped: ahead is the x axis of the link that carries them (REP 103)."""
    carrier = tree.carrier([wheel.joint.child for wheel in wheels.all])
    if wheels.forward @ tree.frames[carrier].turn[:, 0] < -0.5:
        yield (
            f"left_wheels lie on the right of link {carrier!r}, so that ahead is its -x axis; swap left_wheels and "
            "right_wheels if that is not meant"
        )


def _radius(wheels: DriveWheels) -> Quantity:
    for wheel in wheels.all:
        if wheel.radius is None:
            raise ValueError(
                f"link {wheel.joint.child!r} has no cylinder or sphere from which the wheel radius is read; give "
                "wheel_radius in the fleet file"
            )
    radii = [wheel.radius for wheel in wheels.all if wheel.radius]
    least, most = min(radii), max(radii)
    if most.value - least.value > most.value / 10**6:
        raise ValueError(
            f"the drive wheels have different radii, {float(least.value):g} m ({least.source}) and "
            f"{float(most.value):g} m ({most.source}); one is needed: correct them or give "
            "wheel_radius in the fleet file"
        )
    return radii[0]


def _body_numbers(tree: Tree, wheels: DriveWheels, given: frozenset[str], warnings: list[str]) -> dict[str, Quantity]:
    """Mass, yaw inertia, centre of mass and wheel inertia. Raises InputError for impossible values.

    If the fleet file gives mass and inertia, mistakes in the links are only warnings.
    """
    bodies, mistakes = read_bodies(tree)
    mass = sum((body.mass for body in bodies), Fraction(0))
    yaw = sum(body.about(wheels.centre, np.array([0.0, 0.0, 1.0])) for body in bodies)
    turning = [_turning_links(tree, wheel) for wheel in wheels.all]
    if not mistakes:
        mistakes, small = impossible_inertias(bodies, yaw, set().union(*turning))
        warnings += small
    if not mistakes and not (mass > 0 and yaw > 0):
        mistakes = [
            f"the links' mass is {float(mass):g} kg and their yaw inertia {yaw:g} kg m^2; both must be > 0: give mass "
            "and inertia in the fleet file"
        ]
    if mistakes and not {"mass", "inertia"} <= given:
        raise InputError(*mistakes)
    numbers = {"wheel_inertia": _wheel_inertia(wheels, turning, bodies, warnings)}
    if mistakes:
        warnings += [f"{line} (mass and inertia are the fleet file's)" for line in mistakes]
        return numbers
    source = f"{len(bodies)} links"
    numbers["mass"] = Quantity(exact(decimal_text(mass)), source)
    numbers["inertia"] = Quantity(_decimal(yaw), source)
    centre = sum(float(body.mass) * body.centre for body in bodies) / float(mass) - wheels.centre
    numbers["com_ahead"] = Quantity(_decimal(float(centre @ wheels.forward)), source)
    numbers["com_left"] = Quantity(_decimal(float(centre @ wheels.axle)), source)
    base = tree.rigid_with(tree.carrier([wheel.joint.child for wheel in wheels.all]))
    if not {"mass", "inertia"} <= given and not any(body.mass for body in bodies if body.link in base):
        warnings.append(
            f"the base ({', '.join(map(repr, sorted(base)[:3]))}) has no mass: {float(mass):g} kg is the mass of the "
            "other links alone; give mass and inertia in the fleet file"
        )
    return numbers


def _turning_links(tree: Tree, wheel: Wheel) -> set[str]:
    """The links that turn with a wheel: its own and those that fixed joints tie to it."""
    return tree.rigid_with(wheel.joint.child)


def _wheel_inertia(wheels: DriveWheels, turning: list[set[str]], bodies: list[Body], warnings: list[str]) -> Quantity:
    """J of one side: of its wheel, or of all its wheels on a skid-steer base; the mean of both sides."""
    total = 0.0
    for wheel, links in zip(wheels.all, turning, strict=True):
        own = [body for body in bodies if body.link in links]
        moment = sum(body.about(wheel.centre, wheel.axle) for body in own)
        mass, radius = float(sum(body.mass for body in own)), wheel.radius and float(wheel.radius.value)
        if radius and moment > 1.001 * mass * radius**2:
            warnings.append(
                f"link {wheel.joint.child!r}: its moment about the axle, {moment:g} kg m^2, is more than its "
                f"{mass:g} kg on the rim would have ({mass * radius**2:.3g}); right where a geared "
                "rotor is counted, else give wheel_inertia in the fleet file"
            )
        total += moment
    source = f"<inertial> of {', '.join(repr(wheel.joint.child) for wheel in wheels.all)}"
    return Quantity(_decimal(total / 2), source)


def _motor_limits(wheels: DriveWheels, warnings: list[str]) -> dict[str, Quantity]:
    """Torque limits of the sides (the sum of their wheels') and the wheel-speed limit, both from <limit>."""
    found: dict[str, Quantity] = {}
    for wheel in wheels.all:
        for key, value in (("effort", wheel.joint.effort), ("velocity", wheel.joint.velocity)):
            if value is not None and value < 0:
                raise ValueError(
                    f"joint {wheel.joint.name!r}: <limit> {key} = {float(value):g}; it must be > 0: correct it"
                )
            if value == 0:
                warnings.append(f"joint {wheel.joint.name!r}: <limit> {key} = 0 is taken for a limit that is not given")
    for side, members in (("left", wheels.left), ("right", wheels.right)):
        efforts = [wheel.joint.effort for wheel in members]
        if all(efforts):
            source = f"<limit effort> of {_joints(members)}"
            found[f"torque_limit_{side}"] = Quantity(sum(filter(None, efforts), Fraction(0)), source)
    velocities = [wheel.joint.velocity for wheel in wheels.all]
    if all(velocities):
        found["wheel_speed"] = Quantity(min(filter(None, velocities)), f"<limit velocity> of {_joints(wheels.all)}")
    return found


def _joints(wheels: Sequence[Wheel]) -> str:
    return ", ".join(repr(wheel.joint.name) for wheel in wheels)


def _decimal(value: float) -> Fraction:
    """The number as a fleet file holds it. Raises ValueError if it is absurdly large or small."""
    return exact(f"{value:.{PLACES}{'f' if abs(value) >= 1 else 'g'}}")
