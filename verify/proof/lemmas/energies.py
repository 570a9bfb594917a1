"""Lemmas L2-L5: the edge identity, and the derivatives of V, W and the modified energy W-hat."""

from __future__ import annotations

from functools import cache

import sympy as sp

from ....models import energy
from ....models.arrays import Array, column
from ..claim import Claim, Expr, Fact, Kind, Relation, Walk
from ..method.fleet_symbols import OPS, SymbolicFleet, generic
from ..method.inferences import compared
from ..method.normal_form import difference, normal_form
from ..method.rules import identity
from ..method.symbols import W_HAT, V, Vehicle, W, parameter, rate_of, symbol


def edge_identity(forward: Expr, backward: Expr) -> Fact:
    """L2 on one edge, g odd: y_i a_ij g(x_i - x_j) + y_j a_ji g(x_j - x_i) as half the sum over ordered pairs."""
    y_i, y_j, g = symbol("y", "i"), symbol("y", "j"), symbol("g")
    pairs = (forward * (y_i - y_j) * g + backward * (y_j - y_i) * (-g)) / 2
    return identity(y_i * forward * g + y_j * backward * (-g), pairs)


@cache
def l2() -> Claim:
    """For g odd and a_ij = a_ji: sum_i y_i sum_j a_ij g(x_i - x_j) = (1/2) sum_ij a_ij (y_i - y_j) g(x_i - x_j).

    Both sides are sums over edges, so that one edge proves it for every graph. What is affine in the weights is a sum
    over vehicles, leader links and edges, so that an identity on the generic vehicle and edge holds on every graph.
    """
    fleet, weight = generic(), parameter("a", "ij")
    y, force = fleet.column("y"), column([symbol("f", "ij")])
    at_vehicles, at_edges = y * OPS.edge_sum(fleet.graph, force), force * OPS.edge_difference(fleet.graph, y)
    affine = [within_first_degree(rate_of(name)) for name in (V, W, W_HAT)]
    return Claim("L2", Kind.LEMMA, (edge_identity(weight, weight), identity(sum(at_vehicles), sum(at_edges)), *affine))


def within_first_degree(rate: Expr) -> Fact:
    """The rate of an energy is affine in the weights."""
    fleet = generic()
    weights = [*fleet.graph.weight, *fleet.graph.leader_weight]
    degree = sp.Poly(normal_form(fleet.unfold(rate)), *weights).total_degree()
    named = sp.Function("deg")(rate)
    return compared(Relation(named, "<=", sp.S.One), {named: degree})


@cache
def l3() -> Claim:
    """V' = -P_v."""
    fleet = generic()
    return Claim("L3", Kind.LEMMA, (identity(rate_of(V), -fleet.translational_dissipation, fleet, affine(V)),))


def affine(name: Expr) -> tuple[Fact, ...]:
    """What lifts an identity about the rate of an energy from the generic fleet to every graph."""
    edge, transposed, *_ = l2().facts
    return edge, transposed, l2().about(sp.Function("deg")(rate_of(name)))


@cache
def l4() -> Claim:
    """W' = -P_w + sum omega alpha / p_omega, and the rates of the errors along and across the heading."""
    fleet = generic()
    i, _ = fleet.vehicles
    push = sum(n.w * n.k * n.psi * n.b / n.p_w for n in fleet.vehicles)
    model = identity(push, energy.rotational_input(OPS, fleet.plant, fleet.gains, fleet.psi, fleet.state), fleet)
    rate = identity(rate_of(W), push - fleet.rotational_dissipation, fleet, (*affine(W), model))
    along = identity(i.q_dot, i.w * i.b + i.e_along, fleet)
    across = identity(i.b_dot, -i.w * i.q + i.e_across, fleet)
    return Claim("L4", Kind.LEMMA, (rate, along, across))


@cache
def l5() -> Claim:
    """The key identity: omega alpha, which no damping dominates, is a total derivative up to terms in the speeds."""
    fleet = generic()
    taken = sum(n.k / n.p_w * (n.psi * n.q + n.m / n.p_v * n.psi_dot * n.v) for n in fleet.vehicles)
    return Claim(
        "L5",
        Kind.LEMMA,
        (
            identity(W_HAT, W - taken, fleet),
            identity(rate_of(W_HAT), excitation_left(fleet) - fleet.rotational_dissipation, fleet, affine(W_HAT)),
        ),
    )


def excitation_left(fleet: SymbolicFleet) -> Expr:
    """What is left of the excitation in W-hat'."""
    return sum(n.k / n.p_w * _left(n) for n in fleet.vehicles)


def _left(n: Vehicle) -> Expr:
    inertial = -n.m / n.p_v * n.psi_ddot * n.v + n.d_v / n.p_v * n.psi_dot * sp.tanh(n.v / n.s)
    return inertial - n.psi * n.e_along


def walk(fleet: SymbolicFleet, name: Expr, stated: Expr) -> Walk:
    """V' or W' as a reader follows it: chain rule, (13)-(14) put in, terms that cancel in pairs, what is left."""
    total, rates = fleet.energies[name], dict(fleet.kinematics)
    for n in fleet.vehicles:
        rates |= {n.v_dot: _rate(n, fleet.closed_loop.v), n.w_dot: _rate(n, fleet.closed_loop.omega)}
    before = fleet.chain_rule(total)
    terms = [term for part in sp.Add.make_args(before) for term in sp.Add.make_args(normal_form(part.xreplace(rates)))]
    pairs, left = [], list(terms)
    for term in terms:
        if term in left and -term in left:
            left.remove(term)
            left.remove(-term)
            pairs.append((term, -term))
    left_over = sp.Add(*left)
    return Walk(len(fleet.indices), total, before, tuple(terms), tuple(pairs), left_over, difference(left_over, stated))


def _rate(n: Vehicle, accelerations: Array) -> Expr:
    """(13) or (14) with the errors in states and the excitation as the symbol alpha."""
    e_x, e_y, e_theta = (n.fleet.errors[name][n.place] for name in ("e_x", "e_y", "e_theta"))
    folded = n.fleet.fold(accelerations[n.place]).xreplace({n.b: n.alpha / (n.k * n.psi)})
    return sp.expand(folded).xreplace({n.q: n.along(e_x, e_y), n.e_theta: e_theta})
