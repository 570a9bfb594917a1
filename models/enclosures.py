"""Rational enclosures of irrational numbers: square roots and atanh from above, tanh from below."""

from __future__ import annotations

import math
from contextlib import AbstractContextManager
from fractions import Fraction
from typing import Any

ENCLOSURE_DIGITS = 40  # significant digits of a rational enclosure
UNIT = 10**ENCLOSURE_DIGITS


def sqrt_above(q: Fraction) -> Fraction:
    """The square root of q >= 0 if it is rational, else a fraction above it, within 1e-40 of it."""
    # sqrt(a / b) = sqrt(a b) / b; scaling a b by 10^(2 shift) gives the digits wanted.
    inside = q.numerator * q.denominator
    root = math.isqrt(inside)
    if root * root == inside:
        return Fraction(root, q.denominator)
    shift = max(0, ENCLOSURE_DIGITS - len(str(root)) + 1)
    scaled = math.isqrt(inside * 10 ** (2 * shift)) + 1
    return Fraction(scaled, q.denominator * 10**shift)


def tanh_below(q: Fraction | float) -> Fraction | float:
    """A fraction at or below tanh(q), q > 0, within 1e-40 of it; inf for an infinite q."""
    if q == math.inf:
        return math.inf
    with _precision():
        return Fraction(int((_ball(q).tanh() * UNIT).lower().floor().fmpz()), UNIT)


def atanh_above(q: Fraction) -> Fraction | float:
    """A fraction at or above atanh(q), q >= 0, within 1e-40 of it; inf from q = 1 on."""
    if q >= 1:
        return math.inf
    with _precision():
        return Fraction(int((_ball(q).atanh() * UNIT).upper().ceil().fmpz()), UNIT)


def _precision() -> AbstractContextManager[None]:
    """Enough bits for ENCLOSURE_DIGITS, also near the pole of atanh at 1 where numbers have 60 digits."""
    from flint import ctx

    found: AbstractContextManager[None] = ctx.workprec(10 * ENCLOSURE_DIGITS)
    return found


def _ball(q: Fraction | float) -> Any:
    from flint import arb, fmpq

    exact = Fraction(q)
    return arb(fmpq(exact.numerator, exact.denominator))
