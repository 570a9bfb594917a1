"""Remark 1 and (17)-(20): the energies as printed, and their derivatives line by line."""

from __future__ import annotations

from functools import cache

import sympy as sp

from ....models.algebra.log_cosh import log_cosh
from ..claim import Claim, Expr, Fact, Implication, Kind, Relation
from ..lemmas.bounds import l1
from ..lemmas.energies import affine, l2, walk
from ..lemmas.functions import S, X, l0, sech2
from ..method.fleet_symbols import SymbolicFleet, generic_unit, numbered
from ..method.inferences import counterexample, stays_above, tends_to_zero
from ..method.rules import by_gap, chained, falling, identity, less, ordered, restated
from ..method.symbols import V, W, parameter, rate_of, symbol

U = generic_unit()


def claims(inverse_bound: Claim) -> list[Claim]:
    """In the paper's order; `inverse_bound` is L9."""
    return [remark_1(), remark_1_limit(inverse_bound), eq_17(), eq_18(), speeds(), eq_19(), eq_20()]


# -- Remark 1 ---------------------------------------------------------------------------------------------------------


def remark_sum() -> Expr:
    """Remark 1 as printed, in x: half the sum over ordered pairs, and the leader terms."""
    total: Expr = sp.S.Zero
    for n in U.vehicles:
        led, error = U.graph.leader_weight[n.place], n.error("x")
        total += led * error * sp.tanh(error)
        for other in U.vehicles:
            if other.place != n.place:
                gap = n.error("x", other)
                total += U.graph.weight[0] * gap * sp.tanh(gap) / 2
    return total


def _product() -> Fact:
    """0 <= x tanh x."""
    return chained(l0().about(sp.S.Zero, "<="), l0().about(log_cosh(X), right=X * sp.tanh(X)))


def remark_1(stated: Expr | None = None) -> Claim:
    """The sum of Remark 1; each of its terms is x tanh x >= 0 and 0 only at 0."""
    summed = sum(n.error("x") * n.e_x for n in U.vehicles)
    same = identity(summed, remark_sum() if stated is None else stated, U, l2().facts[:1])
    return Claim("remark-1", Kind.PAPER, (same, _product()))


def remark_1_limit(inverse_bound: Claim) -> Claim:
    """'e = 0 only at 0' says nothing of limits: x/(1 + x^2) is 0 only at 0, and tends to 0 as x tends to infinity."""
    t, f, x = parameter("t"), symbol("f"), symbol("x")
    function = t / (1 + t**2)
    rule = Implication((Relation(sp.S.Zero, "<", f), Relation(f, "->", sp.S.Zero)), Relation(x, "->", sp.S.Zero))
    facts = (
        less(sp.S.Zero, function, function),
        tends_to_zero(ordered(function, "<=", 1 / t), t),
        stays_above(ordered(1, "<=", t, (Relation(t, ">=", sp.S.One),))),
    )
    truth = tuple(map(restated, inverse_bound.facts))
    return Claim("remark-1-limit", Kind.PAPER, (counterexample(rule, {f: function, x: t}, facts),), truth=truth)


# -- (17)-(20) --------------------------------------------------------------------------------------------------------


def printed_energy(axes: str, mass: str, gain: str, speed: str) -> Expr:
    """(17) or (19) as printed: every edge twice, and 1/2 in front."""
    total: Expr = sp.S.Zero
    for n in U.vehicles:
        total += getattr(n, mass) / getattr(n, gain) * getattr(n, speed) ** 2
        for axis in axes.split():
            total += 2 * U.graph.leader_weight[n.place] * log_cosh(n.error(axis))
            others = (other for other in U.vehicles if other.place != n.place)
            total += sum(U.graph.weight[0] * log_cosh(n.error(axis, other)) for other in others)
    return total / 2


def _unbounded() -> tuple[Fact, ...]:
    """log cosh >= 0, and cosh s > e^s/2: an energy is positive, and large where its arguments are."""
    return restated(l0().about(sp.S.Zero, "<=")), restated(l0().about(sp.exp(S) / 2))


def eq_17(stated: Expr | None = None) -> Claim:
    """V."""
    printed = printed_energy("x y", "m", "p_v", "v") if stated is None else stated
    return Claim("eq-17", Kind.PAPER, (identity(V, printed, U), *_unbounded()))


def eq_19(stated: Expr | None = None) -> Claim:
    """W."""
    printed = printed_energy("theta", "I", "p_w", "w") if stated is None else stated
    return Claim("eq-19", Kind.PAPER, (identity(W, printed, U), *_unbounded()))


def printed_rate_of_v(fleet: SymbolicFleet) -> Expr:
    """The right side of (18)."""
    return -sum(n.d_v / n.p_v * n.v * sp.tanh(n.v) for n in fleet.vehicles)


def printed_rate_of_w(fleet: SymbolicFleet) -> Expr:
    """The right side of (20)."""
    return -sum((n.d_w * n.w * sp.tanh(n.w) - n.w * n.alpha) / n.p_w for n in fleet.vehicles)


def eq_18(stated: Expr | None = None) -> Claim:
    """V' <= 0."""
    printed = printed_rate_of_v(U) if stated is None else stated
    walks = tuple(walk(fleet, V, printed_rate_of_v(fleet)) for fleet in shown_fleets())
    return Claim("eq-18", Kind.PAPER, (identity(rate_of(V), printed, U, affine(V)), _product()), walks=walks)


def eq_20(stated: Expr | None = None) -> Claim:
    """W'."""
    printed = printed_rate_of_w(U) if stated is None else stated
    walks = tuple(walk(fleet, W, printed_rate_of_w(fleet)) for fleet in shown_fleets())
    return Claim("eq-20", Kind.PAPER, (identity(rate_of(W), printed, U, affine(W)),), walks=walks)


@cache
def shown_fleets() -> tuple[SymbolicFleet, ...]:
    """The fleets on which a reader follows a derivative: the generic one, two vehicles, three vehicles."""
    return U, numbered(2), numbered(3)


def speeds() -> Claim:
    """v is square integrable: |v| <= M gives (tanh(M)/M) v^2 <= v tanh v, as tanh s / s decreases; v' is bounded."""
    most, ratio = parameter("M"), sp.tanh(S) / S
    slope = l0().about(S**2 * sp.diff(ratio, S)), l0().about(S * sech2(S))
    square = by_gap(sp.tanh(most) / most * S**2, S * sp.tanh(S), S**2, falling(ratio, S, most, slope))
    return Claim("v-in-L2", Kind.PAPER, (square, restated(l1().about(sp.Abs(U[0].v_dot)))))
