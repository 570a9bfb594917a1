"""Symbols: letters with an index, and those of one vehicle under the paper's names."""

from __future__ import annotations

from typing import Any

import sympy as sp

from ..claim import Expr

SCALES = ("s", "o")


def symbol(base: str, index: str = "", **assumptions: bool) -> Expr:
    """A real symbol called base_index; the reports typeset it by these two parts."""
    return sp.Symbol(f"{base}_{index}" if index else base, real=True, **assumptions)


def parameter(base: str, index: str = "") -> Expr:
    """A positive symbol."""
    return symbol(base, index, positive=True)


def nonnegative_symbol(base: str, index: str = "") -> Expr:
    """A symbol that may be 0, too."""
    return symbol(base, index, nonnegative=True)


V, W, W_HAT = symbol("V"), symbol("W"), symbol("What")  # the energies


def rate_of(name: Expr) -> Expr:
    """The symbol of the derivative of an energy."""
    return symbol(f"{name.name}_dot")


class Vehicle:
    """The symbols of one vehicle of a fleet under the paper's letters."""

    def __init__(self, fleet: Any, place: int) -> None:
        self.fleet, self.place, self.index = fleet, place, fleet.indices[place]

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return self.fleet.entry(_SHORT.get(name, name), self.index, name in _POSITIVE)

    @property
    def D(self) -> Expr:  # noqa: N802
        """D_i = a_il + l_ii."""
        return self.fleet.graph.degree[self.place]

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

    def error(self, coordinate: str, other: Vehicle | None = None) -> Expr:
        """zbar_i - z_l, or zbar_i - zbar_j, in one coordinate: x, y or theta."""
        return self._place_of(coordinate) - (other._place_of(coordinate) if other else symbol(coordinate, "l"))

    def _place_of(self, coordinate: str) -> Expr:
        offset = 0 if coordinate == "theta" else getattr(self, f"delta_{coordinate}")
        return getattr(self, coordinate) - offset


_SHORT = {
    "p_w": "p_omega",
    "d_w": "d_omega",
    "k": "k_alpha",
    "w": "omega",
    "w_dot": "omega_dot",
    "w_ddot": "omega_ddot",
}
_POSITIVE = {"m", "I", "r", "R", "p_v", "d_v", "p_w", "d_w", "k", "psi_bar", "psi1", "psi2", "s", "o"}
