"""The symbols of one vehicle of a scene under the paper's letters, so that printed formulas can be typed as printed."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import sympy as sp

from .generic_fleet import Scene, generic, parameter, symbol
from .normal_form import Expr


@dataclass(frozen=True)
class Names:
    """Vehicle i of a scene; every attribute is the symbol of that name."""

    scene: Scene
    index: int

    def __getattr__(self, name: str) -> Any:
        positive = name in _POSITIVE
        return (parameter if positive else symbol)(_SHORT.get(name, name), self.index)

    @property
    def D(self) -> Expr:  # noqa: N802
        """D_i = a_il + l_ii."""
        return self.scene.graph.degree[self.index - 1]

    @property
    def cos(self) -> Expr:
        """cos theta_i: phi = (cos, sin), phi_perp = (-sin, cos)."""
        return sp.cos(self.theta)

    @property
    def sin(self) -> Expr:
        """sin theta_i."""
        return sp.sin(self.theta)

    def along(self, x: Expr, y: Expr) -> Expr:
        """phi^T (x, y)."""
        return self.cos * x + self.sin * y

    def across(self, x: Expr, y: Expr) -> Expr:
        """phi_perp^T (x, y)."""
        return -self.sin * x + self.cos * y

    @property
    def q(self) -> Expr:
        """phi^T e_z."""
        return self.along(self.e_x, self.e_y)

    @property
    def b(self) -> Expr:
        """phi_perp^T e_z."""
        return self.across(self.e_x, self.e_y)

    @property
    def q_of_rate(self) -> Expr:
        """phi^T e_z'."""
        return self.along(self.e_x_dot, self.e_y_dot)

    @property
    def b_of_rate(self) -> Expr:
        """phi_perp^T e_z'."""
        return self.across(self.e_x_dot, self.e_y_dot)

    @property
    def alpha(self) -> Expr:
        """(11)."""
        return self.k * self.psi * self.b


_SHORT = {"p_w": "p_omega", "d_w": "d_omega", "k": "k_alpha", "w": "omega", "w_dot": "omega_dot"}
_POSITIVE = {"m", "I", "r", "R", "p_v", "d_v", "p_w", "d_w", "k"}


@cache
def first() -> Names:
    """Vehicle 1 of the generic scene."""
    return Names(generic(), 1)


@cache
def second() -> Names:
    """Vehicle 2 of the generic scene, the neighbour."""
    return Names(generic(), 2)


def sech2(s: Expr) -> Expr:
    """sech^2."""
    return sp.sech(s) ** 2
