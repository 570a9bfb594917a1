"""The rules that make facts by algebra. Each checks its statement; none takes a verdict from its caller.

A rule that is given facts (`by`, `limits`, ...) cannot hold where one of them does not. The same rules judge what is
true and what is false.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType

import sympy as sp

from ..claim import Expr, Fact, Method, Relation, Witness
from .ball import evaluate, precise, sample, text
from .fleet_symbols import SymbolicFleet
from .normal_form import difference, equal, majorant, normal_form
from .signs import cases

Vector = tuple[Expr, Expr]


def settled(holds: bool | None, by: Iterable[Fact]) -> bool | None:
    """What a check found; undecided where it used something that does not hold."""
    return holds if all(fact.holds for fact in by) else None


def assumed(relation: Relation) -> Fact:
    """A hypothesis, such as |psi| <= psi_bar of (A3); every claim shows its own."""
    return Fact(relation, True, Method.ASSUMED)


def restated(fact: Fact) -> Fact:
    """The fact of another claim as a step of a new one."""
    return Fact(fact.statement, fact.holds, fact.method, (fact,), witness=fact.witness, values=fact.values)


def instance(fact: Fact, values: Mapping[Expr, Expr], given: Sequence[Fact] = ()) -> Fact:
    """A fact that holds for every value of its letters, at some values.

    Where a letter is positive, or is bounded by a hypothesis of the fact, `given` must say the same of its value.
    """
    relation, known = _put(fact, values), [(g.left, g.sign, g.right) for g in given]
    hypotheses = [h for h in fact.assumptions if h.left.free_symbols & values.keys()]
    supplied = all((h.left.subs(values), h.sign, h.right.subs(values)) in known for h in hypotheses)
    signed = [value for letter, value in values.items() if letter.is_nonnegative and not value.is_nonnegative]
    supplied = supplied and all((sp.S.Zero, "<", value) in known for value in signed)
    holds, grounds = True if supplied else None, (fact, *given)
    return Fact(relation, settled(holds, grounds), Method.INSTANCE, grounds, discharged=tuple(hypotheses))


def _put(fact: Fact, values: Mapping[Expr, Expr]) -> Relation:
    left = (
        sp.Abs(fact.left.args[0].subs(values), evaluate=False) if fact.left.func is sp.Abs else fact.left.subs(values)
    )
    return Relation(left, fact.sign, fact.right.subs(values))


def renamed(fact: Fact, name: Expr, fleet: SymbolicFleet) -> Fact:
    """The fact about |expression| as one about |name|, a symbol that stands for the expression in the fleet."""
    same = identity(name, fact.left.args[0], fleet)
    relation = Relation(sp.Abs(name), fact.sign, fact.right)
    return Fact(relation, settled(same.holds, (fact,)), Method.INSTANCE, (same, fact))


def by_equation(fact: Fact, name: Expr, equation: Fact) -> Fact:
    """The fact about |expression| as one about |name|, which is the expression once `equation` is put into it."""
    same = identity(name.xreplace({equation.left: equation.right}), fact.left.args[0])
    relation, grounds = Relation(sp.Abs(name), fact.sign, fact.right), (equation, same, fact)
    return Fact(relation, settled(True, grounds), Method.INSTANCE, grounds)


def exchanged(fact: Fact, fleet: SymbolicFleet) -> Fact:
    """A fact about vehicle i and its neighbour j, with the two vehicles exchanged."""
    left, right = (fleet.exchange(side) for side in (fact.left, fact.right))
    return Fact(Relation(left, fact.sign, right), fact.holds, Method.INSTANCE, (fact,))


def sized(positive: Fact, upper: Fact) -> Fact:
    """|x| <= b from 0 < x and x <= b."""
    holds = True if positive.left == 0 and positive.right == upper.left else None
    relation, grounds = (
        Relation(sp.Abs(upper.left, evaluate=False), upper.sign, upper.right),
        (positive, upper),
    )
    return Fact(relation, settled(holds, grounds), Method.TRIANGLE, grounds)


# -- identities -------------------------------------------------------------------------------------------------------


def identity(left: Expr, right: Expr, fleet: SymbolicFleet | None = None, by: Sequence[Fact] = ()) -> Fact:
    """left = right for all states and parameters: zero in normal form, or a point at which it is not.

    `fleet` says what the symbols of errors and rates stand for; without it letters are letters.
    """
    relation = Relation(sp.sympify(left), "=", sp.sympify(right))
    unfold = fleet.unfold if fleet else sp.sympify
    left_side, right_side = (
        side.doit() if side.has(sp.Integral, sp.Derivative) else side for side in (relation.left, relation.right)
    )
    sides = unfold(left_side), unfold(right_side)
    decisive = difference(*sides)
    if decisive == 0:
        return Fact(relation, settled(True, by), Method.NORMAL_FORM, tuple(by), sp.S.Zero)
    witness = _separating_point(decisive, *map(normal_form, sides))
    residual = difference(left_side, right_side)
    return Fact(relation, settled(False if witness else None, by), Method.NORMAL_FORM, tuple(by), residual, witness)


def _separating_point(residual: Expr, left: Expr, right: Expr) -> Witness | None:
    """A rational point at which left - right is not 0, with both sides there; None where three points show none.

    Where letters cancel in the difference, it is given alone.
    """
    letters = residual.free_symbols
    with precise():
        for seed in range(3):
            point = sample(sorted(letters, key=lambda s: s.name), seed)
            value = evaluate(residual, point)
            if abs(value) > 0:
                shown = tuple((s, f"{float(q):g}") for s, q in point.items())
                if left.free_symbols | right.free_symbols <= letters:
                    return Witness(shown, text(evaluate(left, point)), text(evaluate(right, point)))
                return Witness(shown, gap=text(value))
    return None


# -- inequalities -----------------------------------------------------------------------------------------------------


def majorized(
    expression: Expr, limits: Sequence[Fact], stated: Expr, short: Mapping[Expr, Fact] = MappingProxyType({})
) -> Fact:
    """|expression| <= stated by the triangle inequality, with |generator| <= bound from each limit; < where one is <.

    Undecided where `stated` is not exactly what the inequality gives.

    A letter of `short` stands for the longer expression that its own limit speaks of.
    """
    grounds = (*limits, *short.values())
    bounds = bounds_of(limits) | {letter: fact.right for letter, fact in short.items()}
    residual = difference(stated, majorant(expression, bounds))
    strict = any(fact.sign == "<" for fact in grounds)
    whole = expression.xreplace({letter: fact.left.args[0] for letter, fact in short.items()})
    relation = Relation(sp.Abs(whole, evaluate=False), "<" if strict else "<=", stated)
    return Fact(relation, settled(True if residual == 0 else None, grounds), Method.TRIANGLE, grounds, residual)


def bounds_of(limits: Iterable[Fact]) -> dict[Expr, Expr]:
    """Facts |g| <= bound as a map from g to its bound, g in normal form and without a sign in front.

    Raises ValueError for a fact that bounds no size.
    """
    limits = tuple(limits)
    if other := [fact.statement for fact in limits if fact.left.func is not sp.Abs or fact.sign not in ("<", "<=")]:
        raise ValueError(f"{other[0]} does not bound the size of anything from above")
    inside = ((argument, fact.right) for fact in limits for argument in fact.left.args)
    return {normal_form(argument).as_coeff_Mul()[1]: bound for argument, bound in inside}


def cauchy_schwarz(u: Vector, e: Vector, limits: Sequence[Fact], stated: Expr) -> Fact:
    """|u^T e| < stated, from |u^T e|^2 + |u x e|^2 = |u|^2 |e|^2 and a strict limit of each component of e."""
    dot, cross = u[0] * e[0] + u[1] * e[1], u[0] * e[1] - u[1] * e[0]
    split = identity(dot**2 + cross**2, (u[0] ** 2 + u[1] ** 2) * (e[0] ** 2 + e[1] ** 2))
    bounds, grounds = bounds_of(limits), (split, *limits)
    square = normal_form((u[0] ** 2 + u[1] ** 2) * (bounds[e[0]] ** 2 + bounds[e[1]] ** 2))
    residual = difference(stated**2, square)
    holds = bool(residual == 0 and stated.is_nonnegative)
    relation = Relation(sp.Abs(dot, evaluate=False), "<", stated)
    return Fact(relation, settled(holds, grounds), Method.CAUCHY_SCHWARZ, grounds, residual)


def chained(first: Fact, second: Fact) -> Fact:
    """a <= c from a <= b and b <= c."""
    holds = True if equal(first.right, second.left) else None
    sign = "<" if "<" in (first.sign, second.sign) else "<="
    return Fact(
        Relation(first.left, sign, second.right), settled(holds, (first, second)), Method.TRIANGLE, (first, second)
    )


def ordered(
    left: Expr, sign: str, right: Expr, where: Sequence[Relation | Fact] = (), fleet: SymbolicFleet | None = None
) -> Fact:
    """left <= right, or left >= right, wherever `where` holds: every sign of the gap is + in slacks.

    `where` has hypotheses, under which the fact is then said to be made, and facts; each bounds a letter or generator.
    `fleet` says what the symbols of energies stand for.
    """
    grounds = tuple(known if isinstance(known, Fact) else assumed(known) for known in where)
    relation = Relation(sp.sympify(left), sign, sp.sympify(right))
    gap = {"<=": relation.right - relation.left, ">=": relation.left - relation.right}[sign]
    gap = normal_form(fleet.unfold(gap)) if fleet else gap
    with precise():
        for case in cases(gap, [fact.relation for fact in grounds]):
            if not case.nonnegative():
                witness = _point_of(case.counterexample(), relation)
                holds = False if witness else None
                return Fact(relation, settled(holds, grounds), Method.SIGNS, grounds, witness=witness)
    return Fact(relation, settled(True, grounds), Method.SIGNS, grounds)


def _point_of(letters: Mapping[Expr, object] | None, relation: Relation) -> Witness | None:
    if letters is None:
        return None
    shown = tuple((s, text(q, 4)) for s, q in sorted(letters.items(), key=lambda pair: str(pair[0])))
    return Witness(shown, text(evaluate(relation.left, letters)), text(evaluate(relation.right, letters)))


def less(left: Expr, right: Expr, gap: Expr, by: Sequence[Fact] = ()) -> Fact:
    """left < right, because right - left is the expression `gap`, which SymPy knows to be positive."""
    split = identity((right - left).rewrite(sp.exp), gap)
    holds = True if split.holds and gap.is_positive else None
    return Fact(Relation(left, "<", right), settled(holds, by), Method.POSITIVE, (split, *by))


def root(fact: Fact) -> Fact:
    """|x| <= b from x^2 <= b^2, b not negative."""
    base, bound = fact.left.base, sp.sqrt(fact.right)
    holds = True if fact.left.exp == 2 and bound.is_nonnegative else None
    relation = Relation(sp.Abs(base), fact.sign, bound)
    return Fact(relation, settled(holds, (fact,)), Method.SQUARES, (fact,))


def by_squares(left: Expr, right: Expr, where: Sequence[Relation | Fact] = ()) -> Fact:
    """left <= right from left^2 <= right^2, both not negative."""
    below = ordered(sp.expand(left**2), "<=", sp.expand(right**2), where)
    holds = below.holds if left.is_nonnegative and right.is_nonnegative else None
    return Fact(Relation(left, "<=", right), holds, Method.SQUARES, (below,), witness=below.witness)


def by_gap(left: Expr, right: Expr, factor: Expr, fact: Fact) -> Fact:
    """left <= right, because right - left is a positive factor times the gap of another fact."""
    same = identity(right - left, factor * (fact.right - fact.left))
    kept = factor.is_positive or (factor.is_nonnegative and fact.sign == "<=")
    holds, grounds = True if kept else None, (same, fact)
    return Fact(Relation(left, fact.sign, right), settled(holds, grounds), Method.TRIANGLE, grounds)


def scaled(fact: Fact, factor: Expr) -> Fact:
    """Both sides times a positive factor."""
    relation = Relation(fact.left * factor, fact.sign, fact.right * factor)
    return Fact(relation, settled(True if factor.is_positive else None, (fact,)), Method.TRIANGLE, (fact,))


def squares(left: Expr, right: Expr, parts: Sequence[tuple[Expr, Expr]], where: Sequence[Relation | Fact] = ()) -> Fact:
    """left <= right, because right - left is a sum of coefficients times squares, (coefficient, root).

    That no coefficient is negative follows from its signs in slacks under `where`.
    """
    split = identity(right - left, sum((coefficient * base**2 for coefficient, base in parts), sp.S.Zero))
    grounds = (split, *(ordered(0, "<=", coefficient, where) for coefficient, _ in parts))
    return Fact(Relation(left, "<=", right), settled(True, grounds), Method.SQUARES, grounds)


def grows(left: Expr, right: Expr, s: Expr, where: Sequence[Fact] = ()) -> Fact:
    """left <= right for s >= 0: equal at 0, and the derivative of right - left is not negative.

    `where` has what is known of the generators in the derivative.
    """
    gap = right - left
    slope = ordered(0, "<=", normal_form(gap.diff(s)), where)
    grounds = (identity(gap.subs(s, 0), 0), slope)
    return Fact(Relation(left, "<=", right), settled(True, grounds), Method.GROWTH, grounds)


def falling(function: Expr, s: Expr, last: Expr, slope: tuple[Fact, Fact]) -> Fact:
    """f(last) <= f(s) for 0 < s <= last.

    `slope` has s^2 f'(s) = a - b, and a <= b for all s >= 0.
    """
    same, sign = slope
    shown = equal(same.left, s**2 * function.diff(s)) and equal(same.right, sign.left - sign.right)
    grounds = (*slope, assumed(Relation(s, "<=", last)))
    holds = True if shown and (same.sign, sign.sign) == ("=", "<=") else None
    return Fact(Relation(function.subs(s, last), "<=", function), settled(holds, grounds), Method.GROWTH, grounds)


def mirrored(fact: Fact, s: Expr, x: Expr) -> Fact:
    """From s >= 0 to every real x: an even side stays, an odd one that is not negative is taken by its size."""
    grounds, shown = [fact], []
    for side in (fact.left, fact.right):
        odd = equal(side.subs(s, -s), -side)
        grounds.append(identity(side.subs(s, -s), -side if odd else side))
        shown.append(sp.Abs(side.subs(s, x)) if odd else side.subs(s, x))
        if odd and not side.is_nonnegative:
            raise ValueError(f"{side} is odd and not known to be nonnegative, so its size is not itself")
    relation = Relation(shown[0], fact.sign, shown[1])
    return Fact(relation, settled(True, grounds), Method.PARITY, tuple(grounds))


def saturated(expression: Expr, corner: Mapping[Expr, Expr], stated: Expr, by: Sequence[Fact] = ()) -> Fact:
    """expression comes as near to `stated` as one likes: equal to it where every tanh and error has its limit.

    `corner` gives those limits, which states far out approach, all together.
    """
    there = identity(expression.xreplace(dict(corner)), stated)
    relation, grounds = Relation(expression, "->", stated), (there, *by)
    return Fact(relation, settled(there.holds, by), Method.SATURATED, grounds, there.residual, there.witness)
