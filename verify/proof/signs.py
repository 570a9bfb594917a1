"""Inequalities by sign patterns: write the variables as sums of nonnegative slacks, expand, and look at the signs.

A polynomial whose coefficients are all nonnegative is nonnegative where its variables are. A case is a substitution
that makes the hypotheses true by construction ("d > c + u" is d -> c + u + s with s >= 0); together the cases cover
everything that the hypotheses admit.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction
from itertools import product
from typing import Any

import sympy as sp

from .ball import evaluate
from .normal_form import Expr, normal_form

Case = Mapping[Expr, Expr]

_GRID = (Fraction(0), Fraction(1, 2), Fraction(1), Fraction(4))
_MAX_TRIES = 4096


def nonnegative(gap: Expr, case: Case) -> bool:
    """Whether every coefficient is nonnegative after the substitution, in the numerator and in the denominator."""
    parts = sp.fraction(sp.together(sp.sympify(gap).subs(case, simultaneous=True)))
    return all(coefficient_sign(term) for part in parts for term in sp.Add.make_args(normal_form(part)))


def coefficient_sign(term: Expr) -> bool:
    """Whether a term is a nonnegative number times powers of nonnegative symbols."""
    number, monomial = _split(term)
    return _number_sign(number) and all(_nonnegative_factor(factor) for factor in sp.Mul.make_args(monomial))


def counterexample(gap: Expr, case: Case) -> dict[Expr, Fraction] | None:
    """Values of the slacks at which the gap is negative, decided in ball arithmetic; None where none was found."""
    expression = sp.expand(sp.sympify(gap).subs(case, simultaneous=True))
    for values in _grid(sorted(expression.free_symbols, key=lambda s: s.name)):
        if all(value > 0 for s, value in values.items() if s.is_positive) and evaluate(expression, values) < 0:
            return values
    return None


def _grid(symbols: list[Any]) -> Iterator[dict[Expr, Fraction]]:
    values = _GRID if len(_GRID) ** len(symbols) <= _MAX_TRIES else (Fraction(0), Fraction(1))
    for number, point in enumerate(product(reversed(values), repeat=len(symbols))):
        if number >= _MAX_TRIES:
            return
        yield dict(zip(symbols, point, strict=True))


def _split(term: Expr) -> tuple[Expr, Expr]:
    # sqrt2 and tanh(1) are numbers: their sign is decided in ball arithmetic.
    number, monomial = term.as_independent(*term.free_symbols, as_Add=False) if term.free_symbols else (term, sp.S.One)
    return number, monomial


def _number_sign(number: Expr) -> bool:
    return bool(number == 0 or evaluate(number) > 0)


def _nonnegative_factor(factor: Expr) -> bool:
    return bool(factor.is_nonnegative)
