"""Drive wheels: the sides of a robot, and how the fleet file names them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from .rolling import Wheel, parallel, wheel_at
from .tree import Tree

SIDE_SPREAD = 0.02  # share of the track by which the wheels of one side may differ in lateral position
UP = np.array([0.0, 0.0, 1.0])


class WheelNames(NamedTuple):
    """Joints (or their child links) that the fleet file names."""

    left: tuple[str, ...]
    right: tuple[str, ...]


class Ignored(NamedTuple):
    """A continuous joint that is no drive wheel."""

    joint: str
    why: str


@dataclass(frozen=True)
class DriveWheels:
    """The wheels of each side; forward is the left side's direction from the right one's, turned by -90 degrees."""

    left: tuple[Wheel, ...]
    right: tuple[Wheel, ...]
    ignored: tuple[Ignored, ...]

    @property
    def all(self) -> tuple[Wheel, ...]:
        """The left wheels, then the right ones."""
        return self.left + self.right

    @property
    def axle(self) -> Array:
        """The horizontal unit vector from the right side to the left, (3,)."""
        direction = self.left[0].axle * (1, 1, 0)
        return (
            direction
            / np.linalg.norm(direction)
            * (1 if (_mean(self.left) - _mean(self.right)) @ direction > 0 else -1)
        )

    @property
    def forward(self) -> Array:
        """The unit vector ahead, (3,)."""
        return np.cross(self.axle, UP)

    @property
    def centre(self) -> Array:
        """The point midway between the sides, (3,), m."""
        return (_mean(self.left) + _mean(self.right)) / 2

    @property
    def half_track(self) -> float:
        """Half the distance between the sides, m."""
        return float((_mean(self.left) - _mean(self.right)) @ self.axle) / 2


def _mean(wheels: Sequence[Wheel]) -> Array:
    return np.mean([wheel.centre for wheel in wheels], axis=0)


def named_wheels(tree: Tree, names: WheelNames) -> DriveWheels:
    """The wheels that the fleet file names. Raises ValueError if they are no wheels, or not on two sides."""
    left, right = (tuple(_wheel_called(tree, name) for name in side) for side in names)
    chosen = [wheel.joint.name for wheel in left + right]
    if twice := next((name for name in chosen if chosen.count(name) > 1), None):
        raise ValueError(f"joint {twice!r} is named twice in left_wheels and right_wheels; name it once")
    for wheel in left + right:
        if not parallel(wheel.axle, left[0].axle):
            raise ValueError(f"the axes of joints {chosen[0]!r} and {wheel.joint.name!r} are not parallel; name others")
    ignored = [
        Ignored(joint.name, "left_wheels and right_wheels do not name it")
        for joint in tree.joints
        if joint.kind == "continuous" and joint.name not in chosen
    ]
    wheels = DriveWheels(left, right, tuple(ignored))
    track = 2 * wheels.half_track
    for side, members in (("left", left), ("right", right)):
        lateral = [float(wheel.centre @ wheels.axle) for wheel in members]
        if not max(lateral) - min(lateral) <= SIDE_SPREAD * track:
            places = ", ".join(f"{place:g}" for place in lateral)
            raise ValueError(
                f"the {side} wheels lie at {places} m along the axle; the wheels of one side must lie on one line: "
                "correct left_wheels and right_wheels"
            )
    if not track > 0:
        raise ValueError("left_wheels and right_wheels lie on the same side; correct them")
    return wheels


def _wheel_called(tree: Tree, name: str) -> Wheel:
    joint = next((joint for joint in tree.joints if name in (joint.name, joint.child)), None)
    if joint is None:
        known = ", ".join(repr(joint.name) for joint in tree.joints if joint.kind == "continuous")
        raise ValueError(
            f"there is no joint {name!r}; left_wheels and right_wheels name joints: {known or 'none turns'}"
        )
    if joint.kind not in ("continuous", "revolute"):
        raise ValueError(f"joint {joint.name!r} has the type {joint.kind!r}; a drive wheel has the type 'continuous'")
    wheel = wheel_at(tree, joint)
    if wheel is None:
        raise ValueError(f"joint {joint.name!r} has no horizontal axis; a drive wheel's axis is horizontal: correct it")
    return wheel
