"""The generic fleet on which identities are proved: symbols for every parameter and state, the model's own functions.

Two vehicles and one edge, all weights symbolic, are a generic vehicle and a generic edge: the residual of every
identity is affine in the weights, its part without weight speaks of one vehicle, its coefficient of a_il of one
vehicle, that of a_ij of two. If it vanishes here it vanishes on every graph with any N (lemma L2 checks the two verbs).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property
from typing import Any

import numpy as np
import sympy as sp

from ...models import equations
from ...models.algebra.ops import sympy_ops
from ...models.arrays import Array, column
from ...models.equations import Plant, State
from ...models.gains import GAIN_NAMES, Gains
from ...models.graph import Graph
from .normal_form import Expr

FOLDED = ("e_x", "e_y", "e_theta")  # the consensus errors as symbols of their own


def symbol(base: str, index: Any = "", **assumptions: bool) -> Expr:
    """A real symbol called base_index; the reports typeset it by these two parts."""
    return sp.Symbol(f"{base}_{index}" if index != "" else base, real=True, **assumptions)


def parameter(base: str, index: Any = "") -> Expr:
    """A positive symbol."""
    return symbol(base, index, positive=True)


@dataclass(frozen=True, eq=False)
class Scene:
    """N vehicles and a list of edges, with a symbol for everything; `weight` and `leader_weight` may be numbers."""

    vehicles: int
    edges: Sequence[tuple[int, int]]
    weight: Callable[[int, int], Expr] = field(default=lambda i, j: parameter("a", f"{i}{j}"))
    leader_weight: Callable[[int], Expr] = field(default=lambda i: parameter("a", f"{i}l"))
    arm_factor: int = 2  # the lever arm of the left wheel is arm_factor R: 2 in (2) as printed, -1 on a physical drive

    def column(self, base: str, positive: bool = False) -> Array:
        """One symbol per vehicle."""
        make = parameter if positive else symbol
        return column(make(base, i) for i in range(1, self.vehicles + 1))

    @cached_property
    def graph(self) -> Graph:
        """The graph with symbolic weights."""
        tail = np.array([i - 1 for i, _ in self.edges], dtype=np.int64)
        head = np.array([j - 1 for _, j in self.edges], dtype=np.int64)
        weights = column(sp.sympify(self.weight(i, j)) for i, j in self.edges)
        led = column(sp.sympify(self.leader_weight(i)) for i in range(1, self.vehicles + 1))
        return Graph(tail, head, weights, led)

    @cached_property
    def plant(self) -> Plant:
        """Masses, inertias, wheels and offsets."""
        return Plant(
            self.graph,
            m=self.column("m", positive=True),
            inertia=self.column("I", positive=True),
            r=self.column("r", positive=True),
            arm=self.arm_factor * self.column("R", positive=True),
            offset_x=self.column("delta_x"),
            offset_y=self.column("delta_y"),
            leader_x=symbol("x", "l"),
            leader_y=symbol("y", "l"),
            leader_theta=symbol("theta", "l"),
        )

    @cached_property
    def gains(self) -> Gains:
        """All positive."""
        return Gains(*(self.column(name, positive=True) for name in GAIN_NAMES))

    @cached_property
    def state(self) -> State:
        """Poses and velocities."""
        return State(*(self.column(name) for name in State._fields))

    @cached_property
    def psi(self) -> Array:
        """psi_i(t), one per vehicle: the paper lets them differ."""
        return self.column("psi")

    @cached_property
    def psi_dot(self) -> Array:
        """psi_i'(t)."""
        return self.column("psi_dot")

    @cached_property
    def errors(self) -> dict[str, Array]:
        """e_x, e_y, e_theta of (8) and (10), from the model."""
        errors = self.consensus_errors
        return {"e_x": errors.x, "e_y": errors.y, "e_theta": errors.theta}

    @cached_property
    def consensus_errors(self) -> equations.Errors:
        """(8) and (10), from the model."""
        return equations.consensus_errors(sympy_ops(), self.plant, self.gains.saturation, self.state)

    @cached_property
    def closed_loop(self) -> State:
        """The right-hand sides of (13) and (14), from the model."""
        return equations.closed_loop(sympy_ops(), self.plant, self.gains, self.psi, self.state)

    @cached_property
    def rates(self) -> dict[Expr, Expr]:
        """d/dt of every symbol: the kinematics from the model, all else as a symbol with a dot."""
        rates: dict[Expr, Expr] = {}
        for name in ("x", "y", "theta"):
            rates.update(zip(getattr(self.state, name), getattr(self.closed_loop, name), strict=True))
        for name in ("v", "omega", *FOLDED, "psi"):
            rates.update(zip(self.column(name), self.column(f"{name}_dot"), strict=True))
        rates.update(zip(self.psi_dot, self.column("psi_ddot"), strict=True))
        return rates

    def dt(self, expression: Expr) -> Expr:
        """The time derivative along the closed loop."""
        rates = self.rates
        return sum((expression.diff(s) * rates[s] for s in _ordered(expression) if s in rates), sp.S.Zero)

    @cached_property
    def definitions(self) -> dict[Expr, Expr]:
        """What the folded symbols and the dotted symbols stand for, in states."""
        meaning: dict[Expr, Expr] = {}
        for name in FOLDED:
            meaning.update(zip(self.column(name), self.errors[name], strict=True))
            meaning.update(zip(self.column(f"{name}_dot"), map(self.dt, self.errors[name]), strict=True))
        for name in ("v", "omega"):
            meaning.update(zip(self.column(f"{name}_dot"), getattr(self.closed_loop, name), strict=True))
        return meaning

    def unfold(self, expression: Expr) -> Expr:
        """The expression in states alone."""
        return sp.sympify(expression).xreplace(self.definitions)

    def fold(self, expression: Expr) -> Expr:
        """The expression with the errors (8), (10) as symbols: the inverse of `unfold`.

        The tanh of each leader link is expressed by the error that it belongs to; what is a function of the errors
        then loses every other tanh of a difference by itself.
        """
        return sp.expand(sp.sympify(expression).xreplace(self._leader_atoms))

    @cached_property
    def _leader_atoms(self) -> dict[Expr, Expr]:
        atoms = {}
        for name in FOLDED:
            for error, meaning in zip(self.column(name), map(sp.expand, self.errors[name]), strict=True):
                atom = _leader_atom(meaning, f"{name[2:]}_l")
                factor = meaning.coeff(atom)  # -a_il where SymPy has turned the sign of the argument
                atoms[atom] = (error - (meaning - factor * atom)) / factor
        return atoms


def _leader_atom(error: Expr, leader: str) -> Expr:
    return next(atom for atom in error.atoms(sp.tanh) if any(s.name == leader for s in atom.free_symbols))


def _ordered(expression: Expr) -> Iterable[Expr]:
    return sorted(expression.free_symbols, key=lambda s: s.name)


@cache
def generic() -> Scene:
    """A generic vehicle and a generic edge: N = 2, E = 1, drive (2) as printed."""
    return Scene(2, [(1, 2)])


@cache
def generic_physical() -> Scene:
    """The same on a physical drive, where the lever arm is R and right minus left turns left."""
    return Scene(2, [(1, 2)], arm_factor=-1)


@cache
def concrete() -> tuple[Scene, ...]:
    """Small graphs with numbers for weights, N = 2, 3, 6; the last is the paper's."""
    ring = [(i, i % 6 + 1) for i in range(1, 7)]
    return (
        Scene(2, [(1, 2)], lambda _i, _j: sp.Rational(3, 2), lambda i: sp.Integer(i)),
        Scene(3, [(1, 2), (2, 3), (1, 3)], lambda i, j: sp.Integer(i + j), lambda _i: sp.Rational(1, 3)),
        Scene(6, [*ring, (2, 4)], lambda _i, _j: sp.S.One, lambda i: sp.Integer(10 if i in (2, 4) else 0)),
    )
