"""Inequalities by sign patterns: write the variables as sums of nonnegative slacks, expand, and look at the signs.

A polynomial whose coefficients are all nonnegative is nonnegative where its variables are. Hypotheses become true by
construction: x > e is x -> e + s with s >= 0, and 0 < x <= e is x -> e/(1 + s). A variable of unknown sign is u in one
case and -u in the other.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import Any

import sympy as sp

from ..claim import Expr, Relation
from .ball import evaluate
from .normal_form import normal_form

_GRID = (Fraction(4), Fraction(1), Fraction(1, 2), Fraction(0))
_MAX_TRIES = 4096


@dataclass(frozen=True)
class Case:
    """A gap in slacks alone, and what the statement's own letters are in them."""

    gap: Expr
    letters: dict[Expr, Expr]

    def put(self, letter: Expr, value: Expr) -> Case:
        """The case with a value in place of a letter."""
        letters = {name: sp.sympify(known).subs(letter, value) for name, known in self.letters.items()}
        return Case(self.gap.subs(letter, value), letters)

    def nonnegative(self) -> bool:
        """Whether every coefficient is nonnegative, in the numerator and in the denominator."""
        parts = sp.fraction(sp.together(self.gap))
        return all(_sign(term) for part in parts for term in sp.Add.make_args(normal_form(part)))

    def counterexample(self) -> dict[Expr, Any] | None:
        """Values of the letters at which the gap is negative, decided in ball arithmetic; None where none was found."""
        expression = sp.expand(self.gap)
        for values in _grid(sorted(expression.free_symbols, key=lambda s: s.name)):
            if all(value > 0 for s, value in values.items() if s.is_positive) and evaluate(expression, values) < 0:
                slacks = {s: Fraction(1) for e in self.letters.values() for s in e.free_symbols} | values
                return {letter: evaluate(e, slacks) for letter, e in self.letters.items()}
        return None


def cases(gap: Expr, hypotheses: Sequence[Relation]) -> list[Case]:
    """Cases that together cover all that the hypotheses admit; the left side of each is a letter or a generator."""
    known = [_on_the_left(hypothesis) for hypothesis in hypotheses]
    found = [Case(gap, {s: s for s in gap.free_symbols | {h.left for h in known}})]
    for number, hypothesis in enumerate(known):
        slack = sp.Symbol(f"slack_{number}", nonnegative=True)
        found = [case.put(*pair) for case in found for pair in _within(hypothesis, slack)]
    return [signed for case in found for signed in _signed(case)]


def _within(hypothesis: Relation, slack: Expr) -> list[tuple[Expr, Expr]]:
    """What may stand in place of a letter so that the hypothesis holds by construction."""
    letter, bound = hypothesis.left, hypothesis.right
    if ">" in hypothesis.sign:
        return [(letter, bound + slack)]
    if letter.func is sp.Abs:
        return [(letter.args[0], sign * bound / (1 + slack)) for sign in (1, -1)]
    if not letter.is_nonnegative:
        raise ValueError(f"{letter} may be negative, so that {bound}/(1 + s) does not reach all of it")
    return [(letter, bound / (1 + slack))]


def _on_the_left(hypothesis: Relation) -> Relation:
    """0 <= x as x >= 0; x in normal form, as it is in the gap."""
    if hypothesis.left.is_number:
        return Relation(normal_form(hypothesis.right), ">=", hypothesis.left)
    return Relation(normal_form(hypothesis.left), hypothesis.sign, hypothesis.right)


def _signed(case: Case) -> Iterator[Case]:
    unknown = sorted((s for s in case.gap.free_symbols if not s.is_nonnegative), key=lambda s: s.name)
    for signs in product((1, -1), repeat=len(unknown)):
        signed = case
        for s, sign in zip(unknown, signs, strict=True):
            signed = signed.put(s, sign * sp.Symbol(f"size_{s.name}", nonnegative=True))
        yield signed


def _grid(symbols: list[Any]) -> Iterator[dict[Expr, Fraction]]:
    values = _GRID if len(_GRID) ** len(symbols) <= _MAX_TRIES else _GRID[1::2]
    for number, point in enumerate(product(values, repeat=len(symbols))):
        if number >= _MAX_TRIES:
            return
        yield dict(zip(symbols, point, strict=True))


def _sign(term: Expr) -> bool:
    """Whether a term is a nonnegative number times powers of nonnegative atoms."""
    # sqrt2 and tanh(1) are numbers: their sign is decided in ball arithmetic.
    number, monomial = term.as_independent(*term.free_symbols, as_Add=False) if term.free_symbols else (term, sp.S.One)
    known = all(factor.is_nonnegative for factor in sp.Mul.make_args(monomial))
    return bool((number == 0 or evaluate(number) > 0) and known)
