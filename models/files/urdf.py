"""Robots from URDF: mass, yaw inertia about the wheel axle's centre, half track and wheel radius."""

from __future__ import annotations

import math
from fractions import Fraction
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..numbers import decimal_text, exact
from .text import read_text

MAX_URDF_BYTES = 16 * 2**20
PLACES = 12  # decimal places of a number that had to be computed in floating point


def read_urdf(path: Path) -> dict[str, Any]:
    """The vehicle keys that a URDF yields: mass (kg), inertia (kg m^2), half_track (m), wheel_radius (m).

    The robot is one rigid body in the plane: masses add up, and by the parallel-axis theorem so do the yaw inertias
    about the point midway between the two drive wheels, which are the continuous joints on a left and a right link.
    Raises InputError where the file cannot be read or has not exactly two drive wheels of one radius.
    """
    root = _parse(path)
    try:
        poses = _link_poses(root)
        wheels = _drive_wheels(root)
        left, right = (poses[wheel.find("child").get("link")] for wheel in wheels)
        centre = [(a + b) / 2 for a, b in zip(left[1], right[1], strict=True)]
        mass, moment = _body(root, poses, centre)
        radii = {_wheel_radius(root, wheel) for wheel in wheels}
        half_track = math.dist(left[1][:2], right[1][:2]) / 2
        body = {
            "mass": exact(decimal_text(mass)),
            "inertia": _decimal(moment),
            "half_track": _decimal(half_track),
        }
    except (KeyError, ValueError, AttributeError, TypeError) as error:
        raise InputError(f"{path}: is not a differential-drive URDF: {error}") from None
    if len(radii) != 1:
        raise InputError(
            f"{path}: the two drive wheels have different radii {sorted(map(float, radii))}; one is needed"
        )
    return {**body, "wheel_radius": radii.pop()}


def _parse(path: Path) -> Any:
    from xml.etree.ElementTree import ParseError

    from defusedxml import DefusedXmlException
    from defusedxml.ElementTree import fromstring

    try:
        return fromstring(read_text(path, MAX_URDF_BYTES))
    except (ParseError, DefusedXmlException, RecursionError) as error:
        raise InputError(f"{path}: is not safe XML: {error or type(error).__name__}") from None


def _drive_wheels(root: Any) -> list[Any]:
    wheels = [joint for joint in root.iter("joint") if joint.get("type") == "continuous"]
    if len(wheels) != 2:
        raise ValueError(f"it has {len(wheels)} continuous joints; a differential drive has 2")
    return wheels


def _link_poses(root: Any) -> dict[str, tuple[Any, list[float]]]:
    """(rotation, position) of every link in the frame of the root link, all joints at zero."""
    joints = {joint.find("child").get("link"): joint for joint in root.findall("joint")}
    poses: dict[str, tuple[Any, list[float]]] = {}

    def pose(link: str, depth: int = 0) -> tuple[Any, list[float]]:
        if depth > 100:
            raise ValueError(f"the joints above link {link!r} form a loop or a chain of more than 100")
        if link not in poses:
            joint = joints.get(link)
            if joint is None:
                poses[link] = (_rotation(0, 0, 0), [0.0, 0.0, 0.0])
            else:
                rotation, position = pose(joint.find("parent").get("link"), depth + 1)
                turn, shift = _origin(joint)
                poses[link] = (_product(rotation, turn), _moved(rotation, position, shift))
        return poses[link]

    for link in root.findall("link"):
        pose(link.get("name"))
    return poses


def _body(root: Any, poses: dict[str, tuple[Any, list[float]]], centre: list[float]) -> tuple[Fraction, float]:
    """The mass, exact, and the yaw inertia about the vertical through `centre`."""
    mass, inertia = Fraction(0), 0.0
    for link in root.findall("link"):
        inertial = link.find("inertial")
        if inertial is None:
            continue
        own = exact(inertial.find("mass").get("value"))
        if own < 0:
            raise ValueError(f"link {link.get('name')!r} has the mass {float(own)} kg; it must be >= 0")
        rotation, position = poses[link.get("name")]
        turn, shift = _origin(inertial)
        axis = _product(rotation, turn)[2]  # the vertical in the frame of the inertia tensor
        x, y, _ = _moved(rotation, position, shift)
        mass += own
        inertia += _about(inertial.find("inertia"), axis) + float(own) * ((x - centre[0]) ** 2 + (y - centre[1]) ** 2)
    if mass <= 0 or not inertia > 0:
        raise ValueError(f"its mass is {float(mass)} kg and its yaw inertia {inertia} kg m^2; both must be > 0")
    return mass, inertia


def _about(tensor: Any, axis: Any) -> float:
    """The moment of inertia about a unit axis."""
    xx, xy, xz, yy, yz, zz = (float(exact(tensor.get(key))) for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
    a, b, c = axis
    moment: float = xx * a * a + yy * b * b + zz * c * c + 2 * (xy * a * b + xz * a * c + yz * b * c)
    return moment


def _wheel_radius(root: Any, wheel: Any) -> Fraction:
    name = wheel.find("child").get("link")
    for link in root.findall("link"):
        if link.get("name") == name:
            cylinder = link.find("./collision/geometry/cylinder")
            if cylinder is None:
                raise ValueError(f"link {name!r} has no collision cylinder, from which the wheel radius is read")
            return exact(cylinder.get("radius"))
    raise ValueError(f"there is no link {name!r}")


def _origin(element: Any) -> tuple[Any, list[float]]:
    origin = element.find("origin")
    if origin is None:
        return _rotation(0, 0, 0), [0.0, 0.0, 0.0]
    roll, pitch, yaw = _triple(origin.get("rpy", "0 0 0"))
    return _rotation(roll, pitch, yaw), _triple(origin.get("xyz", "0 0 0"))


def _triple(text: str) -> list[float]:
    x, y, z = (float(exact(word)) for word in text.split())
    return [x, y, z]


def _rotation(roll: float, pitch: float, yaw: float) -> Any:
    """Rz(yaw) Ry(pitch) Rx(roll), as URDF defines rpy."""
    (cr, sr), (cp, sp), (cy, sy) = ((math.cos(a), math.sin(a)) for a in (roll, pitch, yaw))
    return [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]


def _product(a: Any, b: Any) -> Any:
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def _moved(rotation: Any, position: list[float], shift: list[float]) -> list[float]:
    return [position[i] + sum(rotation[i][k] * shift[k] for k in range(3)) for i in range(3)]


def _decimal(value: float) -> Fraction:
    """The number that a fleet file can hold. Raises ValueError where it is of absurd size."""
    return exact(decimal_text(Fraction(round(value * 10**PLACES), 10**PLACES)))
