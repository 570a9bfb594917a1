"""A rule for windows of time: what an equation of motion says of one of its terms while nothing moves much."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import sympy as sp

from ..claim import Expr, Fact, Method, Relation
from .normal_form import difference, majorant
from .rules import bounds_of, settled
from .symbols import parameter

ETA, PERIOD = parameter("eta"), parameter("T")
_AGE = parameter("age")  # the time since the window began


class Weight(NamedTuple):
    """A function f of time that an equation is multiplied by before it is integrated."""

    size: Expr  # bound of |f|
    slope: Expr  # bound of |f'|
    kept: Expr  # |integral of f times the coefficient of the term in question| over the window


def over_window(
    equation: Fact,
    term: Expr,
    weight: Weight,
    drifts: Sequence[Fact],
    limits: Sequence[Fact],
    stated: Expr,
    dots: Mapping[Expr, Expr],
) -> Fact:
    """|term| <= stated * eta over a window of length T with all speeds at most eta.

    `equation` is mass * rate = right side, the rate that of a speed. Multiply it by f and integrate, the left side by
    parts: the boundary gives 2 |f| eta, the rest |f'| eta T. Every term of the right side that drifts (`drifts` has
    |its rate| <= bound, and `dots` the symbol of each rate) is within bound * age of its value when the window began;
    of all but `term` f takes out that value, or `limits` bounds it.
    """
    letters, rates = {dot: letter for letter, dot in dots.items()}, bounds_of(drifts)
    moved = {letters[rate]: bound for rate, bound in rates.items()}
    (mass,) = sp.Poly(equation.left, *[s for s in equation.left.free_symbols if not s.is_positive]).coeffs()
    bounds = bounds_of(limits) | {letter: bound * _AGE for letter, bound in moved.items()}
    right = sp.integrate(majorant(equation.right, bounds), (_AGE, 0, PERIOD)) * weight.size
    left = mass * ETA * (2 * weight.size + weight.slope * PERIOD)
    found = (left + right) / weight.kept + moved[term] * PERIOD
    residual, grounds = difference(stated * ETA, found), (equation, *drifts, *limits)
    relation = Relation(sp.Abs(term), "<=", stated * ETA)
    return Fact(relation, settled(bool(residual == 0), grounds), Method.WINDOW, grounds, residual)
