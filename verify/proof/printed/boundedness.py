"""The bound of alpha, the inequalities after (20), and what the paper concludes from them: omega bounded, (15)."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import chain, combinations

import sympy as sp
from flint import arb

from ....models.equations import State
from ..claim import Claim, Expr, Fact, Implication, Kind, Relation
from ..lemmas.bounds import l1, psi_limit
from ..lemmas.functions import sech2, tanh_below_1
from ..method.ball import ball, precise, text
from ..method.fleet_balls import BallFleet, paper, paper_peak
from ..method.fleet_symbols import generic_unit
from ..method.inferences import carried, compared, counterexample, gained, outgrows
from ..method.rules import identity, majorized, ordered, renamed
from ..method.symbols import W, nonnegative_symbol, parameter, rate_of, symbol

U = generic_unit()
VI, _ = U.vehicles
OMEGA, ALPHA, C, D, P, SIZE = (
    symbol("omega"),
    symbol("alpha"),
    parameter("c"),
    parameter("d"),
    parameter("p"),
    nonnegative_symbol("u"),
)
TANH_1 = sp.tanh(1)


def claims() -> list[Claim]:
    """In the paper's order."""
    return [alpha_bound(), after_20(), after_20_b(), after_20_c(), boundedness_of_omega(), any_alpha(), cuts(), eq_15()]


def alpha_bound() -> Claim:
    """|alpha| <= c."""
    c = sp.sqrt(2) * VI.k * VI.psi_bar * VI.D
    limits = (psi_limit(VI.psi, VI.psi_bar), l1().about(sp.Abs(VI.b)))
    return Claim("alpha-bound", Kind.PAPER, (renamed(majorized(VI.k * VI.psi * VI.b, limits, c), VI.alpha, U),))


# -- the inequalities after (20), of one vehicle each; p W' is what they speak of --------------------------------------


def after_20(size: Expr = OMEGA) -> Claim:
    """W' <= -sum (1/p)[d omega tanh omega - omega c]; true with |omega| in place of the last omega."""
    on_paper = _after_20_on_paper(size)
    shown = (on_paper,) if on_paper.holds is False else ()  # with |omega| the two sides are equal there
    return Claim("after-20", Kind.PAPER, (_after_20(size), *shown), truth=(_after_20(sp.Abs(OMEGA)),))


def _after_20(size: Expr) -> Fact:
    damping = D * OMEGA * sp.tanh(OMEGA)
    within = (Relation(sp.Abs(ALPHA), "<=", C),)
    return ordered((OMEGA * ALPHA - damping) / P, "<=", (size * C - damping) / P, within)


def _after_20_on_paper(size: Expr) -> Fact:
    """The bound at omega_2 = -1, alpha_2 = -c_2 on the paper's data, all other speeds 0."""
    with precise():
        data, c = paper(), paper().excitation_bounds(paper_peak())[1]
        values = {OMEGA: -1, ALPHA: -c, C: c, D: data.exact_gains.d_omega[1], P: data.exact_gains.p_omega[1]}
        damping = D * OMEGA * sp.tanh(OMEGA)
        rate, bound = ((push - damping) / P for push in (OMEGA * ALPHA, size * C))
        point = {
            symbol("omega", "2"): sp.Integer(-1),
            symbol("alpha", "2"): -parameter("c", "2"),
            parameter("c", "2"): text(c),
        }
        return compared(Relation(rate, "<=", bound), values, point)


def after_20_b() -> Claim:
    """W' <= -sum (1/p)[d tanh 1 - c]|omega| where every |omega| >= 1: tanh grows."""
    level = nonnegative_symbol("h")
    s = nonnegative_symbol("s")
    grown = ordered(0, "<=", sech2(1 + s), (tanh_below_1(1 + s),))
    slope = identity(sp.Derivative(sp.tanh(1 + s), s), sech2(1 + s))
    where = (Relation(level, ">=", TANH_1),)
    return Claim(
        "after-20-b",
        Kind.PAPER,
        (ordered(-(D * SIZE * level - SIZE * C) / P, "<=", -(D * TANH_1 - C) * SIZE / P, where), slope, grown),
    )


def after_20_c() -> Claim:
    """With (15) that bound is not positive; it says nothing where one |omega_j| < 1."""
    where = (Relation(D, ">=", C / TANH_1),)
    return Claim("after-20-c", Kind.PAPER, (ordered(-(D * TANH_1 - C) * SIZE / P, "<=", 0, where),))


# Where vehicles 1 and 2 are off their places, m, their headings over pi, and their turn rates; the others are at rest.
RISING = {0: ((40, -40), Fraction(-3, 4), Fraction(1)), 1: ((-40, 40), Fraction(1, 4), Fraction(1, 2))}


def rising_state(data: BallFleet) -> State:
    """A state at which W rises although |omega_1| >= 1."""
    errors = {place: error for place, (error, _, _) in RISING.items()}
    headings = {place: ball(turn) * arb.pi() for place, (_, turn, _) in RISING.items()}
    return data.state(errors, headings, omega={place: rate for place, (_, _, rate) in RISING.items()})


def _rising_point() -> dict[Expr, Expr]:
    """The same in symbols."""
    found: dict[Expr, Expr] = {symbol("psi"): text(paper_peak())}
    for place, (error, heading, rate) in RISING.items():
        number = str(place + 1)
        found |= {symbol("omega", number): sp.Rational(rate), symbol("theta", number): sp.Rational(heading) * sp.pi}
        for axis, off in zip("xy", error, strict=True):
            found[symbol(axis, number)] = symbol(axis, "l") + symbol(f"delta_{axis}", number) + off
    return found


def boundedness_of_omega() -> Claim:
    """'For all |omega_i| >= 1, W' <= 0, hence omega_i is bounded', with the controller's own alpha."""
    with precise():
        rate = paper().energy_rate(paper_peak(), rising_state(paper()))
        rises = compared(Relation(rate_of(W), "<=", sp.S.Zero), {rate_of(W): rate}, _rising_point())
    return Claim("boundedness-of-omega", Kind.PAPER, (rises,))


# -- boundedness under any bounded alpha ------------------------------------------------------------------------------


def any_alpha() -> Claim:
    """'Uniformly bounded under any bounded alpha': with the paper's gains a constant alpha_1 = c_1 turns vehicle 1."""
    angle, t, pull = symbol("theta"), parameter("t"), parameter("pull")  # pull = p_omega D > |p_omega e_theta|
    rule = Implication((Relation(sp.Abs(ALPHA), "<=", C),), Relation(angle, "bounded", sp.S.Zero))
    level = parameter("omega", "0")  # with tanh(level) at most (c - pull)/d
    with precise():
        data, c = paper(), paper().excitation_bounds(paper_peak())[0]
        held = (data.exact_gains.p_omega * data.plant.graph.degree)[0]
        positive = compared(Relation(sp.S.Zero, "<", C - pull), {C: c, pull: held})
    at_level = (Relation(sp.tanh(level), "<=", (C - pull) / D), Relation(C, ">=", pull))
    kept = ordered(0, "<=", C - pull - D * sp.tanh(level), at_level)
    runs = outgrows(carried(level, t, angle, (kept, positive)), t)
    facts = (ordered(sp.Abs(C), "<=", C), runs)
    return Claim("any-bounded-alpha", Kind.PAPER, (counterexample(rule, {ALPHA: C}, facts),))


def cuts() -> Claim:
    """Boundedness under any |alpha_i| <= c_i needs sum_S c_i/p_i <= a_l(S) + cut(S) for every set S of vehicles."""
    with precise():
        broken, total = broken_cuts(paper(), paper_peak())
    n, all_ = symbol("cuts_broken"), symbol("cuts_all")
    facts = compared(Relation(n, "=", 53), {n: broken}), compared(Relation(all_, "=", 63), {all_: total})
    return Claim("cuts", Kind.REMARK, facts)


def broken_cuts(data: BallFleet, psi_bar: arb) -> tuple[int, int]:
    """(broken, all): the vehicle sets S with sum_S c_i/p_wi > a_l(S) + cut(S)."""
    graph, push = data.plant.graph, data.excitation_bounds(psi_bar) / data.exact_gains.p_omega
    edges = list(zip(graph.tail, graph.head, graph.weight, strict=True))
    broken = total = 0
    for chosen in _subsets(len(data.fleet)):
        cut = sum((w for i, j, w in edges if (i in chosen) != (j in chosen)), arb(0))
        room = sum((graph.leader_weight[i] for i in chosen), cut)
        total += 1
        broken += bool(sum((push[i] for i in chosen), arb(0)) > room)
    return broken, total


def _subsets(n: int) -> Iterator[set[int]]:
    return map(set, chain.from_iterable(combinations(range(n), size) for size in range(1, n + 1)))


def eq_15() -> Claim:
    """(15) alone does not bound omega: a vehicle drifts out to any angle L, then swings back ever faster.

    One vehicle, I = 1, D = 1. Out: alpha = c. Back: alpha = -c, -omega' = c + p tanh(theta) + d tanh(omega) > g while
    theta >= 1 and omega > -infinity.
    """
    numbers = {P: sp.Rational(1, 2), D: sp.S.One, C: sp.Rational(19, 25)}
    angle, t, far = symbol("theta"), parameter("t"), parameter("L")
    premises = (Relation(C / TANH_1, "<=", D), Relation(sp.Abs(ALPHA), "<=", C))
    rule = Implication(premises, Relation(sp.Abs(OMEGA), "bounded", sp.S.Zero))
    level, pull, damping = parameter("omega", "0"), nonnegative_symbol("e"), nonnegative_symbol("h")
    at_level = (Relation(sp.tanh(level), "<=", ((C - P) / D).subs(numbers)),)
    drift = ordered(0, "<=", (C - P - D * sp.tanh(level)).subs(numbers), at_level)
    positive = compared(Relation(sp.S.Zero, "<", (C - P).subs(numbers)), {})
    out = outgrows(carried(level, t, angle, (drift, positive)), t)
    gain = (C + P * TANH_1 - D).subs(numbers)
    along = (Relation(pull, ">=", TANH_1), Relation(damping, "<=", sp.S.One))
    back = ordered(gain, "<=", (C + P * pull - D * damping).subs(numbers), along)
    swing = outgrows(gained(back, (angle, sp.S.One, far), OMEGA, sp.sqrt(2 * gain * (far - 1))), far)
    facts = (
        compared(Relation((C / TANH_1).subs(numbers), "<=", D.subs(numbers)), {}),
        ordered(sp.Abs(C.subs(numbers)), "<=", C.subs(numbers)),
        out,
        swing,
    )
    return Claim("eq-15", Kind.PAPER, (counterexample(rule, {**numbers, ALPHA: C.subs(numbers)}, facts),))
