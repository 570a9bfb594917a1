"""Ball arithmetic (Arb): every number is an interval that contains the true value, so a sign that it shows is the sign.

`arb_ops` lets the paper's own equations be evaluated in balls; `evaluate` does so for a SymPy expression.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
import sympy as sp
from flint import arb, ctx, fmpq

from ....models.algebra.log_cosh import log_cosh
from ....models.algebra.ops import Ops, numpy_ops
from ....models.arrays import Array, column

Ball = Any  # a flint.arb
BITS = 256  # working precision: witnesses carry about 70 digits


def ball(number: Any) -> Ball:
    """The ball of an exact number (int, Fraction or SymPy rational); a ball stays what it is."""
    if isinstance(number, arb):
        return number
    exact = Fraction(int(number.p), int(number.q)) if isinstance(number, sp.Rational) else Fraction(number)
    return arb(fmpq(exact.numerator, exact.denominator))


def balls(values: Iterable[Any] | Any) -> Array:
    """An object array of balls; one ball for one number."""
    return column(map(ball, values)) if isinstance(values, Iterable) else ball(values)


def text(value: Ball, digits: int = 6) -> str:
    """The ball as a decimal that is right to its last digit."""
    return str(value.str(digits, radius=False))


@cache
def arb_ops() -> Ops:
    """Ops over NumPy object arrays of balls."""

    def elementwise(function: Any) -> Any:
        return np.frompyfunc(function, 1, 1)

    return Ops(
        ball,
        arb.pi(),
        elementwise(lambda s: s.sin()),
        elementwise(lambda s: s.cos()),
        elementwise(lambda s: s.tanh()),
        elementwise(lambda s: s.cosh().log()),
        numpy_ops().edge_difference,
        numpy_ops().edge_sum,
    )


def precise() -> Any:
    """A context with the working precision of this checker."""
    return ctx.workprec(BITS)


_FUNCTIONS: dict[Any, Any] = {
    sp.sin: lambda s: s.sin(),
    sp.cos: lambda s: s.cos(),
    sp.tanh: lambda s: s.tanh(),
    sp.sech: lambda s: s.sech(),
    sp.exp: lambda s: s.exp(),
    sp.log: lambda s: s.log(),
    sp.atanh: lambda s: s.atanh(),
    sp.Abs: abs,
    log_cosh: lambda s: s.cosh().log(),
}


def evaluate(expression: Any, values: Mapping[Any, Any] | None = None) -> Ball:
    """The ball of a SymPy expression at exact values (or balls) of its symbols."""
    values = values or {}
    if expression in values:
        return ball(values[expression])
    if expression.is_Rational:
        return ball(expression)
    if expression is sp.pi:
        return arb.pi()
    if expression.is_Symbol:
        raise KeyError(f"no value for {expression}")
    parts = [evaluate(part, values) for part in expression.args]
    if expression.is_Add:
        return sum(parts[1:], parts[0])
    if expression.is_Mul:
        product = parts[0]
        for part in parts[1:]:
            product = product * part
        return product
    if expression.is_Pow:
        return _power(parts[0], expression.exp, parts[1])
    return _FUNCTIONS[expression.func](*parts)


def _power(base: Ball, exponent: Any, exponent_ball: Ball) -> Ball:
    if exponent.is_Integer:
        return base ** int(exponent)
    return base.sqrt() ** int(2 * exponent) if (2 * exponent).is_Integer else base**exponent_ball


def sample(symbols: Iterable[Any], seed: int = 0) -> dict[Any, Fraction]:
    """A fixed rational point in general position: every symbol between 1/3 and 4/3, by a hash of its name."""
    return {symbol: Fraction(333 + _hash(f"{seed}:{symbol.name}") % 1000, 1000) for symbol in symbols}


def _hash(word: str) -> int:
    return int.from_bytes(hashlib.sha256(word.encode()).digest()[:4], "big")
