"""The masses and inertias of a robot's links, with a check for impossible ones."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from ...arrays import Array
from .tree import Frame, Tree, number, origin

NEGLIGIBLE = 1e-3  # share of the robot's yaw inertia below which an impossible inertia is a warning only
_ROUNDING = 1e-6  # relative error of a moment rounded in its file
_KEYS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


@dataclass(frozen=True)
class Body:
    """The inertia of one link."""

    link: str
    mass: Fraction  # kg
    centre: Array  # (3,), m, centre of mass in the root link's frame
    tensor: Array  # (3, 3), kg m^2, about the centre of mass, along the root link's axes

    def about(self, point: Array, axis: Array) -> float:
        """The moment of inertia (kg m^2) about the line through `point` (3,) along the unit vector `axis` (3,)."""
        arm = np.cross(axis, self.centre - point)
        return float(axis @ self.tensor @ axis + float(self.mass) * (arm @ arm))

    @property
    def impossible(self) -> float:
        """By how much (kg m^2) the largest principal moment exceeds the sum of the others; <= 0 for a real body."""
        first, second, third = np.linalg.eigvalsh(self.tensor)
        return float(third - first - second)


def read_bodies(tree: Tree) -> tuple[list[Body], list[str]]:
    """The bodies of all links that have an <inertial>, and a line for every impossible one."""
    bodies, mistakes = [], []
    for name, link in tree.links.items():
        inertial = link.find("inertial")
        if inertial is not None:
            try:
                bodies.append(_body(name, inertial, tree.frames[name]))
            except ValueError as error:
                mistakes.append(str(error))
    return bodies, mistakes


def _body(name: str, inertial: Any, link: Frame) -> Body:
    where = f"link {name!r}: <inertial>"
    mass_element, inertia = inertial.find("mass"), inertial.find("inertia")
    if mass_element is None:
        raise ValueError(f'{where} has no <mass>; give <mass value="..."/> in kg')
    if inertia is None:
        raise ValueError(f'{where} has no <inertia>; give <inertia ixx="..." .../> in kg m^2')
    mass = number(mass_element, "value", f"{where}: <mass>")
    if mass < 0:
        raise ValueError(f"{where} has the mass {float(mass):g} kg; it must be >= 0: correct its sign")
    xx, xy, xz, yy, yz, zz = (float(number(inertia, key, f"{where}: <inertia>")) for key in _KEYS)
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    smallest, _, largest = np.linalg.eigvalsh(tensor)
    if smallest < -_ROUNDING * max(largest, 0.0):
        raise ValueError(
            f"{where} has the moments ixx = {xx:g}, iyy = {yy:g}, izz = {zz:g} kg m^2 and the smallest principal "
            f"moment {smallest:g}; none may be negative: correct the inertia"
        )
    frame = link.then(origin(inertial, where))
    return Body(name, mass, frame.place, frame.turn @ tensor @ frame.turn.T)


def impossible_inertias(bodies: Iterable[Body], yaw_inertia: float, wheels: set[str]) -> tuple[list[str], list[str]]:
    """Lines for inertias that break the triangle inequality: errors, and warnings for those too small to matter.

    `yaw_inertia` (kg m^2) is the robot's. The drive wheels' links always count, because their own moment is used.
    """
    mistakes, warnings = [], []
    for body in bodies:
        excess = body.impossible
        moments = np.linalg.eigvalsh(body.tensor)
        if excess <= _ROUNDING * moments[2]:
            continue
        line = (
            f"link {body.link!r}: the principal moments {', '.join(f'{moment:g}' for moment in moments)} kg m^2 are no "
            "body's: the largest must not exceed the sum of the other two; "
        )
        if body.link in wheels or excess > NEGLIGIBLE * yaw_inertia:
            mistakes.append(line + "correct its <inertia>")
        else:
            warnings.append(line + f"used unchanged: it is below {NEGLIGIBLE:.1%} of the robot's yaw inertia")
    return mistakes, warnings
