"""Section 4: (12) and psi, Fig. 2, Lemma 1 on its graph, Tables 1 and 2."""

from __future__ import annotations

from fractions import Fraction
from math import prod

import sympy as sp
from flint import arb

from ....models import conditions
from ....models.enclosures import tanh_below
from ..claim import Claim, Expr, Fact, Kind, Relation
from ..formal import Development, proved_by
from ..method.ball import Ball, ball, evaluate, precise
from ..method.fleet_balls import paper
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
    mu, exponent = symbol("mu"), symbol("power_of_pi")
    exact = compared(Relation(mu / sp.pi**exponent, "=", sp.Integer(20)), q, 20)
    return Claim("eq-12", Kind.PAPER, (exact, compared(Relation(exponent, "=", sp.Integer(-1)), power, -1)))


def psi_alone(formal: Development) -> Claim:
    """A constant psi is exciting, psi' is not: with v, omega, q = 0 and p_omega e_theta = k psi b nothing moves."""
    fleet = SymbolicFleet("i", [], scaled=False)
    i = fleet[0]
    still = (identity(dot, fleet.fold(fleet.definitions[dot]), fleet) for dot in (i.v_dot, i.w_dot))
    turned = sp.atanh(sp.Rational(1, 4))  # theta - theta_l for b = 1/2, k psi/p_omega = 1/2, a_il = 1
    with precise():
        away = compared(Relation(sp.S.Zero, "<", i.theta - symbol("theta", "l")), 0, evaluate(turned))
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
            compared(Relation(symbol("c", str(n)) / sp.tanh(1), "<=", symbol("d_omega", str(n))), needed, given)
            for n, needed, given in zip(VEHICLES, _needed(size), paper().gains.d_omega, strict=True)
        ]
        largest = psi_at(beside, arb.pi() / 10)
        broken = sum(bool(needed > ball(d)) for needed, d in zip(_needed(largest), paper().gains.d_omega, strict=True))
        other = compared(Relation(symbol("broken"), "=", sp.Integer(6)), broken, 6)
    return Claim("psi-section-4", Kind.READING, (*met, other))


def _needed(size: Ball) -> list[Ball]:
    """What (15) asks of d_omega for a bound of psi."""
    return [c / arb(1).tanh() for c in paper().excitation_bounds(size)]


def closed_form() -> Expr:
    """psi_bar = (208 + 2000 sqrt5 + 1575 pi)/(1260 pi)."""
    return (208 + 2000 * sp.sqrt(5) + 1575 * sp.pi) / (1260 * sp.pi)


def psi_bar(stated: Expr | None = None) -> Claim:
    """The maximum of |psi| is at t = pi/5: every zero of psi' = (2/pi) sum cos((2k-1) u) is at u = t/2 = j pi/10.

    With z = exp(i u), the sum times 2i sin u telescopes. psi(pi - u) = psi(u), so that half of the zeros do.
    """
    z, size, bound = symbol("z"), symbol("psi_bar"), closed_form() if stated is None else stated
    cosines = sum((z - 1 / z) * (z ** (2 * k - 1) + z ** (1 - 2 * k)) for k in range(1, 6))
    peak = paper().psi.value(OPS, sp.pi / 5)
    with precise():
        exact, certified = evaluate(bound), ball(paper().psi.bound)
        zeros = [arb.pi() * j / 10 for j in (2, 3, 4, 5, 11, 12, 13, 14, 15)]
        elsewhere = max((abs(psi_at(4 / arb.pi(), u)) for u in zeros), key=float)
        return Claim(
            "psi-bar",
            Kind.PAPER,
            (
                identity(bound, peak),
                identity(cosines, z**10 - z**-10),
                compared(Relation(symbol("psi", "j"), "<", size), elsewhere, exact),
                compared(Relation(size, "<=", symbol("psi_certified")), exact, certified),
                compared(
                    Relation(symbol("psi_certified") - size, "<", sp.Rational(1, 10**8)),
                    certified - exact,
                    Fraction(1, 10**8),
                ),
            ),
            quantity=size,
        )


# -- figure and tables ------------------------------------------------------------------------------------------------


def fig_2() -> Claim:
    """Ring 1-2-3-4-5-6-1, chord 2-4, leader weight 10 to 2 and 4: (15) is met by less than 4 %, and (16) is met."""
    data = paper()
    found = conditions.condition_15(conditions.exact_numbers(), data.fleet.condition_data(data.psi), data.gains)
    degrees = [
        compared(Relation(symbol("D", str(n)), "=", sp.Integer(stated)), degree, stated)
        for n, degree, stated in zip(VEHICLES, data.fleet.graph.degree, (2, 13, 2, 13, 2, 2), strict=True)
    ]
    tight = [
        compared(
            Relation(sp.Rational(24, 25), "<", symbol("share", str(n))),
            Fraction(24, 25),
            small / tanh_below(Fraction(1)) / d,
        )
        for n, small, d in zip(VEHICLES, found.small, data.gains.d_omega, strict=True)
    ]
    return Claim("fig-2", Kind.READING, (*degrees, *tight, *met_on_the_paper(conditions.condition_16)))


def lemma_1() -> Claim:
    """Lemma 1 on the paper's graph: the rational pivots of L_l are positive, and its determinant is 1080."""
    pivots = paper().fleet.graph.ldl_pivots()
    positive = [compared(Relation(symbol("pivot", str(n)), ">", sp.S.Zero), p, 0) for n, p in enumerate(pivots, 1)]
    determinant = compared(Relation(symbol("det"), "=", sp.Integer(1080)), prod(pivots), 1080)
    return Claim("lemma-1-paper", Kind.PAPER, (*positive, determinant))


def table_1(stated: Expr | None = None) -> Claim:
    """The torque limits are given in N: by m v' = tau/r a torque is in kg (m/s^2) m."""
    kg, metre, second = (parameter(name) for name in ("kg", "metre", "second"))
    newton = kg * metre / second**2
    torque = kg * (metre / second**2) * metre
    printed = newton if stated is None else stated
    return Claim("table-1", Kind.PAPER, (identity(printed, torque),), truth=(identity(newton * metre, torque),))


def table_2() -> Claim:
    """The offsets are a triangle: vehicles 2, 4, 6 are the midpoints of its sides 1-3, 3-5, 5-1."""
    offsets = [vehicle.offset for vehicle in paper().fleet.vehicles]
    facts: list[Fact] = []
    for middle, (one, other) in {2: (1, 3), 4: (3, 5), 6: (5, 1)}.items():
        for axis, name in enumerate(("delta_x", "delta_y")):
            names = [symbol(name, str(n)) for n in (middle, one, other)]
            gap = 2 * offsets[middle - 1][axis] - offsets[one - 1][axis] - offsets[other - 1][axis]
            facts.append(compared(Relation(2 * names[0] - names[1] - names[2], "=", sp.S.Zero), gap, 0))
    return Claim("table-2", Kind.PAPER, tuple(facts))
