"""Section 4: (12) and psi, Fig. 2, Lemma 1 on its graph, Tables 1 and 2."""

from __future__ import annotations

from fractions import Fraction

import sympy as sp
from flint import arb

from ....models import conditions
from ..claim import Claim, Expr, Fact, Kind, Relation
from ..formal import Development, proved_by
from ..method.ball import Ball, ball, evaluate, precise
from ..method.fleet_balls import paper, paper_peak
from ..method.fleet_symbols import OPS, SymbolicFleet
from ..method.inferences import compared
from ..method.rules import identity
from ..method.symbols import parameter, symbol
from ..this_fleet.excitation import rate_power
from .saturation import met_on_the_paper

VEHICLES = range(1, 7)


def claims(formal: Development) -> list[Claim]:
    """In the paper's order; (12) stands in Section 3."""
    return [eq_12(), psi_alone(formal), fig_2(), lemma_1(), table_1(), table_2(), psi_section_4(), psi_bar()]


def eq_12() -> Claim:
    """(12) for the paper's psi: the integral of psi'^2 over any 2 pi is 20/pi."""
    q, power = rate_power(paper().psi, Fraction(1)) or (Fraction(0), 0)
    factor, exponent = symbol("factor_of_pi"), symbol("power_of_pi")
    facts = compared(Relation(factor, "=", 20), {factor: q}), compared(Relation(exponent, "=", -1), {exponent: power})
    return Claim("eq-12", Kind.PAPER, facts)


def psi_alone(formal: Development) -> Claim:
    """A constant psi is exciting, psi' is not: with v, omega, q = 0 and p_omega e_theta = k psi b nothing moves."""
    fleet = SymbolicFleet("i", [], scaled=False)
    i = fleet[0]
    still = (identity(dot, fleet.fold(fleet.definitions[dot]), fleet) for dot in (i.v_dot, i.w_dot))
    turned = sp.atanh(sp.Rational(1, 4))  # theta - theta_l for b = 1/2, k psi/p_omega = 1/2, a_il = 1
    away = compared(Relation(sp.S.Zero, "<", turned), {})
    return Claim("pe-of-psi", Kind.REMARK, (*still, away, proved_by("constant_psi_is_not_enough", formal)))


# -- psi --------------------------------------------------------------------------------------------------------------


def psi_at(coefficient: Ball, u: Ball) -> Ball:
    """5/4 + coefficient sum_{k <= 5} sin((2k-1) u)/(2k-1), u = t/2."""
    waves = (((2 * k - 1) * u).sin() / (2 * k - 1) for k in range(1, 6))
    return ball(Fraction(5, 4)) + coefficient * sum(waves, arb(0))


def psi_section_4(coefficient: Ball | None = None) -> Claim:
    """The text reads 4/(2k-1) pi: with pi in the denominator (15) holds for the printed gains, else not."""
    with precise():
        read, beside = 4 / arb.pi() if coefficient is None else coefficient, 4 * arb.pi()
        size = psi_at(read, arb.pi() / 10)
        met = [
            compared(Relation(c / sp.tanh(1), "<=", d), {c: bound, d: given}) for c, d, bound, given in _bounds(size)
        ]
        largest = psi_at(beside, arb.pi() / 10)
        broken = [
            compared(Relation(c / sp.tanh(1), ">", d), {c: bound, d: given}) for c, d, bound, given in _bounds(largest)
        ]
    return Claim("psi-section-4", Kind.READING, (*met, *broken))


def _bounds(size: Ball) -> list[tuple[Expr, Expr, Ball, Fraction]]:
    """c_i and d_omega,i of the paper's vehicles, letters and numbers, for a bound of psi."""
    bounds, given = paper().excitation_bounds(size), paper().gains.d_omega
    return [
        (symbol("c", str(n)), symbol("d_omega", str(n)), bound, d)
        for n, bound, d in zip(VEHICLES, bounds, given, strict=True)
    ]


def closed_form() -> Expr:
    """psi_bar = (208 + 2000 sqrt5 + 1575 pi)/(1260 pi)."""
    return (208 + 2000 * sp.sqrt(5) + 1575 * sp.pi) / (1260 * sp.pi)


def psi_bar(stated: Expr | None = None) -> Claim:
    """The maximum of |psi| is at t = pi/5: every zero of psi' = (2/pi) sum cos((2k-1) u) is at u = t/2 = j pi/10.

    With z = exp(i u), the sum times 2i sin u telescopes. psi(pi - u) = psi(u), so that half of the zeros do.
    """
    z, size, bound = symbol("z"), symbol("psi_bar"), closed_form() if stated is None else stated
    cosines = sum((z - 1 / z) * (z ** (2 * k - 1) + z ** (1 - 2 * k)) for k in range(1, 6))
    peak, above = paper().psi.value(OPS, sp.pi / 5), symbol("psi_certified")
    with precise():
        exact, certified = evaluate(bound), paper().psi.bound
        elsewhere = [
            compared(
                Relation(sp.Abs(symbol("psi", str(j))), "<", size),
                {symbol("psi", str(j)): psi_at(4 / arb.pi(), arb.pi() * j / 10), size: exact},
            )
            for j in (2, 3, 4, 5, 11, 12, 13, 14, 15)
        ]
        return Claim(
            "psi-bar",
            Kind.PAPER,
            (
                identity(bound, peak),
                identity(cosines, z**10 - z**-10),
                *elsewhere,
                compared(Relation(size, "<=", above), {size: exact, above: certified}),
                compared(Relation(above - size, "<", sp.Rational(1, 10**8)), {above: certified, size: exact}),
            ),
            quantity=size,
        )


# -- figure and tables ------------------------------------------------------------------------------------------------


def fig_2() -> Claim:
    """Ring 1-2-3-4-5-6-1, chord 2-4, leader weight 10 to 2 and 4: (15) is met by less than 4 %, and (16) is met."""
    data = paper()
    degrees = [
        compared(Relation(symbol("D", str(n)), "=", stated), {symbol("D", str(n)): degree})
        for n, degree, stated in zip(VEHICLES, data.fleet.graph.degree, (2, 13, 2, 13, 2, 2), strict=True)
    ]
    tight = [
        compared(Relation(sp.Rational(24, 25) * d, "<", c / sp.tanh(1)), {c: bound, d: given})
        for c, d, bound, given in _bounds(paper_peak())
    ]
    return Claim("fig-2", Kind.READING, (*degrees, *tight, *met_on_the_paper(conditions.condition_16)))


def lemma_1() -> Claim:
    """Lemma 1 on the paper's graph: the rational pivots of L_l are positive, and its determinant is 1080."""
    pivots = paper().fleet.graph.ldl_pivots()
    values = {symbol("pivot", str(n)): pivot for n, pivot in enumerate(pivots, 1)}
    positive = (compared(Relation(pivot, ">", 0), values) for pivot in values)
    return Claim("lemma-1-paper", Kind.PAPER, (*positive, compared(Relation(sp.Mul(*values), "=", 1080), values)))


def table_1(stated: Expr | None = None) -> Claim:
    """The torque limits are given in N: by m v' = tau/r a torque is in kg (m/s^2) m."""
    kg, metre, second = (parameter(name) for name in ("kg", "metre", "second"))
    newton = kg * metre / second**2
    torque = kg * (metre / second**2) * metre
    printed = newton if stated is None else stated
    return Claim(
        "table-1",
        Kind.PAPER,
        (identity(printed, torque),),
        truth=(identity(newton * metre, torque),),
        quantity=parameter("tau_max"),
    )


def table_2() -> Claim:
    """The offsets are a triangle: vehicles 2, 4, 6 are the midpoints of its sides 1-3, 3-5, 5-1."""
    offsets = [vehicle.offset for vehicle in paper().fleet.vehicles]
    sides = ((2, 1, 3), (4, 3, 5), (6, 5, 1))
    facts: list[Fact] = []
    for axis, name in enumerate(("delta_x", "delta_y")):
        d = {n: symbol(name, str(n)) for n in VEHICLES}
        values = {d[n]: offsets[n - 1][axis] for n in VEHICLES}
        facts += [compared(Relation(2 * d[middle] - d[a] - d[b], "=", 0), values) for middle, a, b in sides]
    return Claim("table-2", Kind.PAPER, tuple(facts))
