"""Wheels that a robot may roll on: joints with horizontal axes, their swivels and radii."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from ...arrays import Array
from .tree import Joint, Tree, number

PARALLEL = 0.02  # rad: axes within this angle count as parallel; exporters write pi/2 as 1.57
_TURNING = ("continuous", "revolute", "floating", "planar", "spherical")


class Quantity(NamedTuple):
    """A number of a description and where it was read."""

    value: Fraction
    source: str


@dataclass(frozen=True)
class Wheel:
    """A joint with a horizontal axis, and the link that turns about it."""

    joint: Joint
    centre: Array  # (3,), m, in the root link's frame
    axle: Array  # (3,), of length 1
    radius: Quantity | None  # m; None without a cylinder or sphere
    swivel: Joint | None  # the joint above that turns the axle

    @property
    def bottom(self) -> float | None:
        """The height of the lowest point, m; None if the radius is not known."""
        return None if self.radius is None else float(self.centre[2]) - float(self.radius.value)

    def faces(self, other: Wheel) -> bool:
        """Whether both turn about one line, at different places on it."""
        between = other.centre - self.centre
        apart = float(np.linalg.norm(between))
        return (
            apart > 1e-6
            and parallel(self.axle, other.axle)
            and float(np.linalg.norm(np.cross(self.axle, between))) <= PARALLEL * apart
        )


def parallel(a: Array, b: Array) -> bool:
    """Whether two unit vectors are parallel, either way."""
    return bool(np.linalg.norm(np.cross(a, b)) <= PARALLEL)


def wheel_at(tree: Tree, joint: Joint) -> Wheel | None:
    """The wheel at a joint; None if its axis is not horizontal. Raises ValueError for an invalid radius."""
    frame = tree.frames[joint.child]
    axle = frame.turn @ joint.axis
    if abs(axle[2]) > PARALLEL:
        return None
    turning = (above for above in tree.above(joint.parent) if above.kind in _TURNING)
    swivel = next((above for above in turning if not parallel(axis_of(tree, above), axle)), None)
    return Wheel(joint, frame.place, axle, radius_of(joint.child, tree.links[joint.child]), swivel)


def axis_of(tree: Tree, joint: Joint) -> Array:
    """The axis of a joint in the root link's frame, (3,)."""
    return tree.frames[joint.child].turn @ joint.axis


def radius_of(name: str, link: Any) -> Quantity | None:
    """The largest radius (m) among a link's cylinders and spheres: of its collision shapes, else of its visual ones."""
    for kind in ("collision", "visual"):
        found = [
            Quantity(number(shape, "radius", f"link {name!r}: {kind} {shape.tag}"), f"{kind} {shape.tag} of {name!r}")
            for tag in ("cylinder", "sphere")
            for shape in link.findall(f"./{kind}/geometry/{tag}")
        ]
        if found:
            largest = max(found)
            if largest.value <= 0:
                raise ValueError(f"link {name!r}: its wheel radius is {float(largest.value):g} m; it must be > 0")
            return largest
    return None
