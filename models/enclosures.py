"""Rational enclosures of irrational numbers: square roots from above, tanh from below."""

from __future__ import annotations

import math
from fractions import Fraction

ENCLOSURE_DIGITS = 40  # significant digits of a rational enclosure


def sqrt_above(q: Fraction) -> Fraction:
    """The square root of q >= 0 where it is rational, else a fraction above it, within 1e-40 of it."""
    # sqrt(a / b) = sqrt(a b) / b; scaling a b by 10^(2 shift) gives the digits wanted.
    inside = q.numerator * q.denominator
    root = math.isqrt(inside)
    if root * root == inside:
        return Fraction(root, q.denominator)
    shift = max(0, ENCLOSURE_DIGITS - len(str(root)) + 1)
    scaled = math.isqrt(inside * 10 ** (2 * shift)) + 1
    return Fraction(scaled, q.denominator * 10**shift)


def tanh_below(q: Fraction | float) -> Fraction | float:
    """A fraction at or below tanh(q), q > 0, within 1e-40 of it; inf for an infinite q, where no limit is asked for."""
    if q == math.inf:
        return math.inf
    from flint import arb, ctx, fmpq

    exact = Fraction(q)
    with ctx.workprec(4 * ENCLOSURE_DIGITS):
        scaled = arb(fmpq(exact.numerator, exact.denominator)).tanh() * 10**ENCLOSURE_DIGITS
        return Fraction(int(scaled.lower().floor().fmpz()), 10**ENCLOSURE_DIGITS)
