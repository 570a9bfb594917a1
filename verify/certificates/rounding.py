"""Short decimals on the safe side of a number."""

from __future__ import annotations

from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction


def rounded(q: Fraction, digits: int, *, up: bool = False) -> Fraction:
    """A decimal of so many significant digits, not above q (not below, where `up`)."""
    context = Context(prec=digits, rounding=ROUND_CEILING if up else ROUND_FLOOR)
    return Fraction(context.divide(Decimal(q.numerator), Decimal(q.denominator)))
