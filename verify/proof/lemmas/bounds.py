"""Lemmas L1, L6 and L8: bounds of the errors, their rates and the accelerations, and what they say of W-hat."""

from __future__ import annotations

from functools import cache

import sympy as sp

from ....models.algebra.log_cosh import log_cosh
from .. import constants
from ..claim import Claim, Expr, Fact, Kind, Relation
from ..method.fleet_symbols import SymbolicFleet, generic
from ..method.normal_form import normal_form
from ..method.rules import (
    assumed,
    by_equation,
    cauchy_schwarz,
    chained,
    exchanged,
    instance,
    majorized,
    ordered,
    renamed,
    root,
    sized,
    squares,
)
from ..method.symbols import W_HAT, V, Vehicle, W, parameter, rate_of, symbol
from .energies import l5
from .functions import X, l0, sech2, sech2_within, tanh_below_1, tanh_below_line

ROOT2 = sp.sqrt(2)
BETA = symbol("beta")  # the direction of a unit vector


def psi_limit(value: Expr, bound: Expr) -> Fact:
    """(A3): |psi| <= psi_bar, and the same of its derivatives."""
    return assumed(Relation(sp.Abs(value), "<=", bound))


# -- L1 ---------------------------------------------------------------------------------------------------------------


@cache
def l1() -> Claim:
    """Bounds of e_z, e_theta, of the accelerations, and of the rates of the errors."""
    fleet = generic()
    i, setting = fleet[0], fleet.setting
    e_x, e_y, e_theta = (_error_limit(fleet, name) for name in ("e_x", "e_y", "e_theta"))
    q, b = (
        renamed(cauchy_schwarz(u, (i.e_x, i.e_y), (e_x, e_y), ROOT2 * i.D), name, fleet)
        for u, name in (((i.cos, i.sin), i.q), ((-i.sin, i.cos), i.b))
    )
    speed = majorized(
        fleet.fold(fleet.closed_loop.v[0]), (q, tanh_below_1(i.v / i.s)), constants.acceleration_bound(setting)[0]
    )
    turning = (e_theta, b, psi_limit(i.psi, i.psi_bar), tanh_below_1(i.w / i.o))
    turn = majorized(fleet.fold(fleet.closed_loop.omega[0]), turning, constants.turn_acceleration_bound(setting)[0])
    accelerations = renamed(speed, i.v_dot, fleet), renamed(turn, i.w_dot, fleet)
    return Claim(
        "L1", Kind.LEMMA, (e_x, e_y, e_theta, q, b, *accelerations, *_place_rates(fleet), _heading_rate(fleet))
    )


def _error_limit(fleet: SymbolicFleet, name: str) -> Fact:
    """|e_x|, |e_y| or |e_theta| < D: every tanh of the model's error by 1."""
    error = fleet.errors[name][0]
    limits = [tanh_below_1(atom.args[0]) for atom in sorted(error.atoms(sp.tanh), key=str)]
    return renamed(majorized(error, limits, fleet[0].D), fleet.column(name)[0], fleet)


def damped_product_limit() -> Fact:
    """|u^T diag(S_x, S_y) phi| <= 1 for unit vectors u, phi and 0 < S_x, S_y <= 1."""
    s_x, s_y, heading = parameter("S", "x"), parameter("S", "y"), symbol("theta")
    cos, sin = sp.cos(heading), sp.sin(heading)
    product = s_x * sp.cos(BETA) * cos + s_y * sp.sin(BETA) * sin
    parts = [(sp.S.One, s_y * sp.cos(BETA) * sin - s_x * sp.sin(BETA) * cos), (1 - s_x**2, cos), (1 - s_y**2, sin)]
    return root(squares(product**2, sp.S.One, parts, [Relation(s, "<=", sp.S.One) for s in (s_x, s_y)]))


def _place_rates(fleet: SymbolicFleet) -> tuple[Fact, ...]:
    """|u^T e_z'| <= (D |v_i| + a_ij |v_j|)/l for every unit u; so along the heading and across it."""
    i, j = fleet.vehicles
    led, weight, within = fleet.graph.leader_weight[0], fleet.graph.weight[0], damped_product_limit()
    links = {("il", i): None, ("ij", i): j, ("ij", j): j}
    short = {}
    for (link, moving), other in links.items():
        slopes = {parameter("S", axis): i.error(axis, other) / fleet.length for axis in "xy"}
        values = {s: sech2(argument) for s, argument in slopes.items()} | {symbol("theta"): moving.theta}
        known = [fact for argument in slopes.values() for fact in sech2_within(argument)]
        short[symbol("K", link + moving.index)] = instance(within, values, known)
    to_leader, here, there = short
    rate = (led * to_leader * i.v + weight * (here * i.v - there * j.v)) / fleet.length
    stated = (i.D * sp.Abs(i.v) + weight * sp.Abs(j.v)) / fleet.length
    size = majorized(rate, (), stated, short)
    unit = renamed(size, sp.cos(BETA) * i.e_x_dot + sp.sin(BETA) * i.e_y_dot, fleet)
    turns = ((i.e_along, sp.S.Zero), (i.e_across, sp.pi / 2))
    return unit, *(renamed(instance(unit, {BETA: i.theta + turn}), name, fleet) for name, turn in turns)


def _heading_rate(fleet: SymbolicFleet) -> Fact:
    """|e_theta'| <= (D |omega_i| + a_ij |omega_j|)/rho."""
    i, j = fleet.vehicles
    led, weight = fleet.graph.leader_weight[0], fleet.graph.weight[0]
    to_leader, between = symbol("S", "il"), symbol("S", "ij")
    short = {
        letter: sized(*sech2_within(i.error("theta", other) / fleet.angle))
        for letter, other in ((to_leader, None), (between, j))
    }
    rate = (led * to_leader * i.w + weight * between * (i.w - j.w)) / fleet.angle
    stated = (i.D * sp.Abs(i.w) + weight * sp.Abs(j.w)) / fleet.angle
    return renamed(majorized(rate, (), stated, short), i.e_theta_dot, fleet)


# -- L6 and L8 --------------------------------------------------------------------------------------------------------


@cache
def l6() -> Claim:
    """|W-hat' + P_w| <= sum g_i |v_i|: the triangle inequality on L5, with L1, |tanh x| <= |x| and (A3)."""
    fleet, rate = generic(), l5().about(rate_of(W_HAT))
    damping = fleet.rotational_dissipation
    limits = [limit for n in fleet.vehicles for limit in _rate_limits(n)]
    weights = constants.speed_weight(fleet.setting)
    stated = sum(weight * sp.Abs(n.v) for weight, n in zip(weights, fleet.vehicles, strict=True))
    left = majorized(normal_form(rate.right + damping), limits, stated)
    return Claim("L6", Kind.LEMMA, (by_equation(left, rate.left + damping, rate),))


def _rate_limits(n: Vehicle) -> tuple[Fact, ...]:
    """Limits of the generators of L5: phi^T e_z', tanh(v/s), psi and its derivatives."""
    along = l1().about(sp.Abs(n.fleet[0].e_along))
    bounds = ((n.psi, n.psi_bar), (n.psi_dot, n.psi1), (n.psi_ddot, n.psi2))
    limits = (psi_limit(value, bound) for value, bound in bounds)
    return exchanged(along, n.fleet) if n.place else along, tanh_below_line(n.v / n.s), *limits


@cache
def l8() -> Claim:
    """|W-hat - W| <= V + C0: the correction by L1, Young's inequality and V's own kinetic part."""
    fleet = generic()
    offsets, letters = constants.energy_offset(fleet.setting), fleet.column("A")
    short = {letter: _taken(n, offset) for letter, n, offset in zip(letters, fleet.vehicles, offsets, strict=True)}
    kinetic = sum(n.m / (2 * n.p_v) * n.v**2 for n in fleet.vehicles)
    gap = renamed(majorized(-sum(letters), (), kinetic + sum(offsets), short), W_HAT - W, fleet)
    atoms = sorted(fleet.translational.atoms(log_cosh), key=str)
    potential = [instance(l0().about(sp.S.Zero, "<="), {X: atom.args[0]}) for atom in atoms]
    below = ordered(kinetic + sum(offsets), "<=", V + sum(offsets), potential, fleet)
    return Claim("L8", Kind.LEMMA, (chained(gap, below), *short.values(), below))


def _taken(n: Vehicle, offset: Expr) -> Fact:
    """(k/p_w)|psi q + (m/p_v) psi' v| <= (m/2p_v) v^2 + C0_n, by the triangle inequality and Young's."""
    q = l1().about(sp.Abs(n.fleet[0].q))
    limits = (exchanged(q, n.fleet) if n.place else q, psi_limit(n.psi, n.psi_bar), psi_limit(n.psi_dot, n.psi1))
    term = n.k / n.p_w * (n.psi * n.q + n.m / n.p_v * n.psi_dot * n.v)
    c = ROOT2 * n.k * n.psi_bar * n.D / n.p_w
    linear = majorized(term, limits, c + n.k / n.p_w * n.m / n.p_v * n.psi1 * sp.Abs(n.v))
    square = n.m / (2 * n.p_v)
    young = squares(linear.right, square * n.v**2 + offset, [(square, sp.Abs(n.v) - n.k / n.p_w * n.psi1)])
    return chained(linear, young)
