"""A fleet of symbols: every parameter and state has one, and the equations are the model's own functions.

Vehicle i with a neighbour j, one edge and two leader links are a generic vehicle and a generic edge: the residual of
every identity about energies is affine in the weights, its part without weight speaks of one vehicle, its coefficient
of a_il of one vehicle, that of a_ij of two. If it vanishes here it vanishes on every graph with any N (lemma L2).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import pairwise

import numpy as np
import sympy as sp

from ....models import energy, equations
from ....models.algebra.ops import sympy_ops
from ....models.arrays import Array, column
from ....models.equations import Plant, State
from ....models.gains import GAIN_NAMES, Gains
from ....models.graph import Graph
from ....models.saturation import Saturation
from ..claim import Expr
from ..constants import Setting
from .normal_form import normal_form
from .symbols import SCALES, W_HAT, V, Vehicle, W, parameter, rate_of, symbol

OPS = sympy_ops()
ERRORS = ("e_x", "e_y", "e_theta")


@dataclass(frozen=True, eq=False)
class SymbolicFleet:
    """Vehicles by their indices and edges between them, with a symbol for everything."""

    indices: Sequence[str]
    edges: Sequence[tuple[str, str]]
    scaled: bool = True  # whether the saturation scales are symbols; else all 1, as the paper has them
    units: tuple[tuple[Expr, Expr], ...] = ()  # what states and scales are in other units, put in when unfolding
    arm_factor: int = 2  # the lever arm of the left wheel is arm_factor R: 2 in (2) as printed, -1 on a physical drive

    def column(self, base: str, positive: bool = False) -> Array:
        """One symbol per vehicle."""
        return column(self.entry(base, index, positive) for index in self.indices)

    def entry(self, base: str, index: str, positive: bool) -> Expr:
        """The symbol of one vehicle or edge; 1 for a scale where there are none."""
        if base in SCALES and not self.scaled:
            return sp.S.One
        return parameter(base, index) if positive else symbol(base, index)

    def __getitem__(self, place: int) -> Vehicle:
        """The symbols of the vehicle at a place, from 0."""
        return Vehicle(self, place)

    @property
    def vehicles(self) -> list[Vehicle]:
        """Every vehicle's symbols."""
        return [self[place] for place in range(len(self.indices))]

    @cached_property
    def graph(self) -> Graph:
        """The graph with symbolic weights."""
        place = {index: number for number, index in enumerate(self.indices)}
        tail, head = (np.array([place[edge[end]] for edge in self.edges], dtype=np.int64) for end in (0, 1))
        weights = column(self.entry("a", i + j, True) for i, j in self.edges)
        return Graph(tail, head, weights, column(self.entry("a", f"{i}l", True) for i in self.indices))

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
        """All positive, with the scales l, rho, s, o."""
        scales = Saturation(self.length, self.angle, *(self.column(name, positive=True) for name in SCALES))
        return Gains(**{name: self.column(name, positive=True) for name in GAIN_NAMES}, saturation=scales)

    @cached_property
    def state(self) -> State:
        """Poses and velocities."""
        return State(*(self.column(name) for name in State._fields))

    @property
    def length(self) -> Expr:
        """The position scale l, m."""
        return parameter("l") if self.scaled else sp.S.One

    @property
    def angle(self) -> Expr:
        """The heading scale rho, rad."""
        return parameter("rho") if self.scaled else sp.S.One

    @cached_property
    def psi(self) -> Array:
        """psi_i(t), one per vehicle: the paper lets them differ."""
        return self.column("psi")

    # -- the model's functions ------------------------------------------------------------------------------------

    @cached_property
    def errors(self) -> dict[str, Array]:
        """e_x, e_y, e_theta of (8) and (10)."""
        return dict(zip(ERRORS, self._errors, strict=True))

    @cached_property
    def _errors(self) -> equations.Errors:
        return equations.consensus_errors(OPS, self.plant, self.gains.saturation, self.state)

    @cached_property
    def closed_loop(self) -> State:
        """The right-hand sides of (1), (13) and (14), through the torques (6) and the vehicle (2)."""
        return equations.closed_loop(OPS, self.plant, self.gains, self.psi, self.state, self._errors)

    @cached_property
    def setting(self) -> Setting:
        """What the constants of the lemmas depend on, the bounds of psi as symbols."""
        bounds = (self.column(name, positive=True) for name in ("psi_bar", "psi1", "psi2"))
        return Setting(OPS, sp.sqrt(2), self.plant, self.gains, *bounds)

    @cached_property
    def translational(self) -> Expr:
        """V of (17)."""
        return energy.translational(OPS, self.plant, self.gains, self.state)

    @cached_property
    def rotational(self) -> Expr:
        """W of (19)."""
        return energy.rotational(OPS, self.plant, self.gains, self.state)

    @cached_property
    def modified(self) -> Expr:
        """W-hat of L5."""
        return energy.modified(OPS, self.plant, self.gains, self.psi, self.column("psi_dot"), self.state)

    @cached_property
    def _inputs(self) -> dict[Expr, Expr]:
        """What u_v, u_omega, alpha and the torques stand for: (6), (7), (9), (11)."""
        u_v = equations.linear_input(OPS, self.gains, self.state, self._errors)
        u_w = equations.angular_input(OPS, self.gains, self.psi, self.state, self._errors)
        alpha = equations.excitation_input(OPS, self.gains, self.psi, self.state, self._errors)
        values = (u_v, u_w, alpha, *equations.wheel_torques(self.plant, u_v, u_w))
        names = ("u_v", "u_omega", "alpha", "tau_l", "tau_r")
        return {
            s: e
            for name, value in zip(names, values, strict=True)
            for s, e in zip(self.column(name), value, strict=True)
        }

    @property
    def translational_dissipation(self) -> Expr:
        """P_v of (18)."""
        return energy.translational_dissipation(OPS, self.gains, self.state)

    @property
    def rotational_dissipation(self) -> Expr:
        """P_w of (20)."""
        return energy.rotational_dissipation(OPS, self.gains, self.state)

    # -- rates, and expressions in short and in full --------------------------------------------------------------

    @cached_property
    def dots(self) -> dict[Expr, Expr]:
        """The symbol of d/dt of every symbol that changes."""
        names = (*State._fields, *ERRORS, "q", "b", "psi", "psi_dot")
        rates = {"psi_dot": "psi_ddot"}
        pairs = [(self.column(name), self.column(rates.get(name, f"{name}_dot"))) for name in names]
        return {s: dot for column_, dots in pairs for s, dot in zip(column_, dots, strict=True)}

    @cached_property
    def kinematics(self) -> dict[Expr, Expr]:
        """(1): what the rates of the poses are."""
        names = ("x", "y", "theta")
        return {
            self.dots[s]: rate
            for name in names
            for s, rate in zip(getattr(self.state, name), getattr(self.closed_loop, name), strict=True)
        }

    def dt(self, expression: Expr) -> Expr:
        """d/dt along the closed loop, the accelerations and the rates of the errors as symbols."""
        return self.chain_rule(expression).xreplace(self.kinematics)

    def chain_rule(self, expression: Expr) -> Expr:
        """d/dt with a symbol for every rate."""
        changing = sorted(expression.free_symbols & self.dots.keys(), key=lambda s: s.name)
        return sum((expression.diff(s) * self.dots[s] for s in changing), sp.S.Zero)

    @cached_property
    def definitions(self) -> dict[Expr, Expr]:
        """What the symbols of errors, projections and their rates stand for, in states."""
        meaning: dict[Expr, Expr] = {}
        for name in ERRORS:
            meaning.update(zip(self.column(name), self.errors[name], strict=True))
        for n in self.vehicles:
            e_x, e_y = meaning[n.e_x], meaning[n.e_y]
            meaning |= {n.q: n.along(e_x, e_y), n.b: n.across(e_x, e_y)}
        meaning |= {self.dots[s]: self.dt(value) for s, value in meaning.items()}
        for n in self.vehicles:
            rates = meaning[n.e_x_dot], meaning[n.e_y_dot]
            meaning |= {n.e_along: n.along(*rates), n.e_across: n.across(*rates)}
        for name in ("v", "omega"):
            meaning.update(zip(self.column(f"{name}_dot"), getattr(self.closed_loop, name), strict=True))
        return meaning | self.kinematics | self._inputs

    @cached_property
    def energies(self) -> dict[Expr, Expr]:
        """V, W and W-hat from the model."""
        return {V: self.translational, W: self.rotational, W_HAT: self.modified}

    @cached_property
    def _energy_rates(self) -> dict[Expr, Expr]:
        return {rate_of(name): self.dt(value).xreplace(self.definitions) for name, value in self.energies.items()}

    def unfold(self, expression: Expr) -> Expr:
        """The expression in states alone."""
        meaning = self.definitions
        if expression.free_symbols & {V, W, W_HAT, *map(rate_of, (V, W, W_HAT))}:
            meaning = meaning | self.energies | self._energy_rates
        return expression.xreplace(meaning).xreplace(dict(self.units))

    def exchange(self, expression: Expr) -> Expr:
        """The expression with vehicles i and j of a generic fleet exchanged; their edge stays."""
        swapped: dict[Expr, Expr] = {}
        i, j = self.indices
        for s in expression.free_symbols - set(self.graph.weight):
            base, _, index = s.name.rpartition("_")
            new = index.translate(str.maketrans(i + j, j + i))
            swapped[s] = sp.Symbol(f"{base}_{new}" if base else s.name, **s.assumptions0)
        return expression.xreplace(swapped)

    def fold(self, expression: Expr) -> Expr:
        """The expression with e_theta, q = phi^T e_z and b = phi_perp^T e_z as symbols: the inverse of `unfold`.

        The tanh of each leader link is expressed by the error that it belongs to; what is a function of the errors
        then loses every other tanh of a difference by itself.
        """
        in_errors = sp.expand(normal_form(expression).xreplace(self._leader_atoms))
        turned: dict[Expr, Expr] = {}
        for n in self.vehicles:  # e_z = phi q + phi_perp b
            turned |= {n.e_x: n.cos * n.q - n.sin * n.b, n.e_y: n.sin * n.q + n.cos * n.b}
        return normal_form(in_errors.xreplace(turned))

    @cached_property
    def _leader_atoms(self) -> dict[Expr, Expr]:
        atoms = {}
        for name in ERRORS:
            for error, meaning in zip(self.column(name), map(normal_form, self.errors[name]), strict=True):
                leader = symbol(name[2:], "l")
                atom = next(atom for atom in meaning.atoms(sp.tanh) if leader in atom.free_symbols)
                factor = meaning.coeff(atom)  # -a_il where SymPy has turned the sign of the argument
                atoms[atom] = (error - (meaning - factor * atom)) / factor
        return atoms


@cache
def generic() -> SymbolicFleet:
    """A generic vehicle i, a neighbour j and the edge between them; drive (2) as printed."""
    return SymbolicFleet("ij", [("i", "j")])


@cache
def generic_unit() -> SymbolicFleet:
    """The same at unit scales: the paper's controller."""
    return SymbolicFleet("ij", [("i", "j")], scaled=False)


@cache
def generic_physical() -> SymbolicFleet:
    """The same on a physical drive, where the lever arm is R and right minus left turns left."""
    return SymbolicFleet("ij", [("i", "j")], arm_factor=-1)


@cache
def numbered(vehicles: int) -> SymbolicFleet:
    """Vehicles 1, 2, ..., each joined to the next, at unit scales."""
    names = [str(number) for number in range(1, vehicles + 1)]
    return SymbolicFleet(names, list(pairwise(names)), scaled=False)
