"""Rounds gains inward to printed digits, and checks them exactly."""

from __future__ import annotations

import math
from dataclasses import replace
from decimal import ROUND_FLOOR, Context, Decimal
from fractions import Fraction

import numpy as np

from ..models.arrays import Array
from ..models.conditions import ConditionData, ConditionSet, Inequality, exact_numbers
from ..models.errors import UndecidedError
from ..models.gains import GAIN_NAMES, Gains
from ..models.saturation import Saturation


def rounded(
    conditions: ConditionSet, data: ConditionData, gains: Gains, digits: int, saturation: Saturation | None = None
) -> Gains:
    """Exact gains of at most `digits` significant digits that meet the conditions, from float gains that nearly do.

    All gains and scales are rounded down, which the torque limit survives; `saturation`, exact, are scales that are
    kept. Rounding a damping gain down may break a condition on ratios; it is met again by lowering the gains in which
    its small side is linear. `data` must be exact.
    Raises UndecidedError where the gains are not positive numbers, or where rounding leaves none,
    because `digits` is too small for the limits.
    """
    if not all(np.all(np.isfinite(column) & (column > 0)) for column in (getattr(gains, name) for name in GAIN_NAMES)):
        raise UndecidedError("a solver returned gains that are not positive numbers")
    numbers = exact_numbers()
    exact = gains.map(lambda column: floor_digits(column, digits))
    exact = exact if saturation is None else replace(exact, saturation=saturation)
    for condition in (*conditions.bounding(data), *conditions.homogeneous(data)):
        exact = _lowered(exact, condition(numbers, data, exact), digits)
    for inequality in conditions.inequalities(numbers, data, exact):
        if not np.all(inequality.holds):
            raise UndecidedError(f"rounding to {digits} digits breaks {inequality.source}; ask for more --digits")
    return exact


def floor_digits(values: Array, digits: int) -> Array:
    """Positive numbers (N,) rounded down to `digits` significant digits, as an object array of fractions."""
    context = Context(prec=digits, rounding=ROUND_FLOOR)

    def floor(value: float | Fraction) -> Fraction:
        exact = Fraction(value)
        return Fraction(context.divide(Decimal(exact.numerator), Decimal(exact.denominator)))

    return np.frompyfunc(floor, 1, 1)(values)


def _lowered(gains: Gains, inequality: Inequality, digits: int) -> Gains:
    broken = ~np.asarray(inequality.holds, dtype=bool)
    if not broken.any():
        return gains
    if any(small == math.inf for small in inequality.small[broken]):
        raise UndecidedError(f"rounding to {digits} digits breaks {inequality.source}; ask for more --digits")
    # One unit in the last place below large / small makes a strict inequality strict.
    shrink = 1 - Fraction(1, 10 ** (digits + 2))
    scale = inequality.large / inequality.small * shrink
    scale[~broken] = Fraction(1)
    return replace(gains, **{name: floor_digits(getattr(gains, name) * scale, digits) for name in inequality.scaled})


def decimal_places(value: float, digits: int) -> Fraction:
    """A positive number rounded to `digits` significant digits, to the nearest."""
    shift = digits - 1 - math.floor(math.log10(value))
    return Fraction(round(Fraction(value) * Fraction(10) ** shift)) / Fraction(10) ** shift
