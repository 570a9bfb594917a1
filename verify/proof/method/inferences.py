"""Rules about limits, inferences and numbers: witnesses of false inferences, values compared, theorems cited."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

import sympy as sp
from flint import arb

from ..claim import Expr, Fact, Implication, Method, Quotation, Relation, Witness
from .ball import Ball, evaluate, precise, sample, text
from .fleet_symbols import SymbolicFleet
from .normal_form import equal, normal_form
from .rules import identity, settled


def tends_to_zero(size: Fact, t: Expr, function: Expr | None = None) -> Fact:
    """f -> 0 for t to infinity, from a fact f <= envelope, |f| <= envelope or f = 0; the envelope tends to 0."""
    stated = function if function is not None else size.left
    holds = bool(sp.limit(size.right, t, sp.oo) == 0 and size.left in (stated, sp.Abs(stated)))
    return Fact(Relation(stated, "->", sp.S.Zero), settled(holds, (size,)), Method.ENVELOPE, (size,))


def keeps_returning(function: Expr, t: Expr, times: Expr) -> Fact:
    """f does not tend to 0: at times that go to infinity with an integer it has one value, which is not 0."""
    (number,) = times.free_symbols
    value = normal_form(function.subs(t, times))
    with precise():
        there = number not in value.free_symbols and abs(evaluate(value, sample(value.free_symbols))) > 0
    holds = bool(there and sp.limit(times, number, sp.oo) == sp.oo)
    return Fact(Relation(function, "-/>", sp.S.Zero), holds, Method.RETURNS, values=(str(times), str(value)))


def stays_above(fact: Fact) -> Fact:
    """f does not tend to 0: from some time on it is at least a positive number (the fact)."""
    holds = True if fact.left.is_number and fact.left.is_positive else None
    return Fact(Relation(fact.right, "-/>", sp.S.Zero), settled(holds, (fact,)), Method.RETURNS, (fact,))


def outgrows(size: Fact, letter: Expr) -> Fact:
    """x is not bounded: it is at least what the fact says, which goes to infinity with a letter."""
    holds = bool(sp.limit(size.left, letter, sp.oo) == sp.oo)
    return Fact(Relation(size.right, "unbounded", sp.S.Zero), settled(holds, (size,)), Method.RETURNS, (size,))


def carried(level: Expr, t: Expr, angle: Expr, kept: Sequence[Fact]) -> Fact:
    """level t <= the angle: its rate stays at or above a level at which the rate does not fall and which is positive.

    `kept` has 0 <= acceleration at the level, and 0 < level.
    """
    names = [(fact.left, fact.sign) for fact in kept if isinstance(fact.statement, Relation)]
    holds = True if names == [(sp.S.Zero, "<="), (sp.S.Zero, "<")] else None
    return Fact(Relation(level * t, "<=", angle), settled(holds, kept), Method.COMPARISON, tuple(kept))


def gained(rate: Fact, stretch: tuple[Expr, Expr, Expr], speed: Expr, stated: Expr) -> Fact:
    """stated <= |speed|: speed^2/2 grows by the integral of the acceleration over a stretch (angle, start, end).

    The acceleration is at least a number g there: the fact, g <= acceleration.
    """
    work = identity(sp.Integral(rate.left, stretch), stated**2 / 2)
    relation, grounds = Relation(stated, "<=", sp.Abs(speed)), (rate, work)
    return Fact(relation, settled(True if rate.sign == "<=" else None, grounds), Method.COMPARISON, grounds)


_NEGATED = {"->": "-/>", "bounded": "unbounded"}


def counterexample(rule: Implication, functions: Mapping[Expr, Expr], facts: Sequence[Fact]) -> Fact:
    """The implication is false: for these functions each premise and the negated conclusion is one of the facts."""
    conclusion = rule.conclusion.subs(functions)
    wanted = [premise.subs(functions) for premise in rule.premises]
    wanted.append(Relation(conclusion.left, _NEGATED[conclusion.sign], conclusion.right))
    shown = [fact.statement for fact in facts if fact.holds]
    holds = False if all(any(_same(relation, other) for other in shown) for relation in wanted) else None
    point = Witness(tuple(functions.items()))
    return Fact(rule, holds, Method.COUNTEREXAMPLE, tuple(facts), witness=point if holds is False else None)


def _same(one: Relation, other: Any) -> bool:
    if not isinstance(other, Relation) or one.sign != other.sign:
        return False
    return equal(one.left, other.left) and equal(one.right, other.right)


def vanishes(expression: Expr, fleet: SymbolicFleet, theorem: Fact) -> Fact:
    """expression -> 0 along every solution: it is continuous, and 0 at the formation, where the theorem leads."""
    goal: dict[Expr, Expr] = {}
    for n in fleet.vehicles:
        goal |= {n.v: sp.S.Zero, n.w: sp.S.Zero, n.theta: symbol_of(fleet, "theta")}
        goal |= {n.x: symbol_of(fleet, "x") + n.delta_x, n.y: symbol_of(fleet, "y") + n.delta_y}
    there = identity(fleet.unfold(expression).subs(goal), 0)
    relation, grounds = Relation(expression, "->", sp.S.Zero), (there, theorem)
    return Fact(relation, settled(there.holds, grounds), Method.CONSEQUENCE, grounds)


def symbol_of(fleet: SymbolicFleet, coordinate: str) -> Expr:
    """The leader's x, y or theta."""
    return getattr(fleet.plant, f"leader_{coordinate}")


Value = Ball | Fraction | int
_OPPOSITE = {"<=": ">", "<": ">=", ">=": "<", ">": "<=", "=": "!=", "!=": "="}


def compared(
    relation: Relation, values: Mapping[Expr, Value], point: Mapping[Expr, Expr] | None = None, of: str = ""
) -> Fact:
    """A relation between numbers: its sides at values of their letters, exact or balls; undecided where balls overlap.

    Shown with the point that the values belong to, and with the name of what they are `of`.
    """
    relation = Relation(sp.sympify(relation.left), relation.sign, sp.sympify(relation.right))
    left, right, method = _sides(relation, values)
    true = {
        "<=": left <= right,
        "<": left < right,
        ">=": left >= right,
        ">": left > right,
        "=": left == right,
        "!=": left != right,
    }
    holds = True if true[relation.sign] else False if true[_OPPOSITE[relation.sign]] else None
    witness = Witness(tuple((point or {}).items()), _text(left), _text(right)) if holds is False else None
    shown = (_text(left), relation.sign, _text(right), *([of] if of else []))
    return Fact(relation, holds, method, witness=witness, values=shown)


def _sides(relation: Relation, values: Mapping[Expr, Value]) -> tuple[Value, Value, Method]:
    """Both sides as fractions where every value is one and no irrational function is applied, else as balls."""
    exact = {s: sp.Rational(int(q.numerator), int(q.denominator)) for s, q in values.items() if not isinstance(q, arb)}
    sides = relation.left, relation.right
    numbers = [side.xreplace(exact) for side in sides]
    if all(number.is_Rational for number in numbers):
        left, right = (Fraction(number.p, number.q) for number in numbers)
        return left, right, Method.EXACT
    with precise():
        left, right = (evaluate(side, values) for side in sides)
    return left, right, Method.BALLS


def _text(value: Value) -> str:
    if isinstance(value, arb):
        return str(value.unique_fmpz()) if value.is_integer() else text(value, 9)
    exact = str(value)
    return exact if len(exact) <= 12 else f"{float(value):.9g}"


def cited(quotation: Quotation, hypotheses: Sequence[Fact]) -> Fact:
    """A textbook theorem whose hypotheses are facts."""
    return Fact(quotation, settled(True, hypotheses), Method.CITED, tuple(hypotheses))
