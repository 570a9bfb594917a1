"""cvxpy expressions with the arithmetic of arrays: `*` multiplies entry by entry, as the conditions are written."""

from __future__ import annotations

from typing import Any

import cvxpy as cp


class Elementwise:
    """A cvxpy expression of shape (N,) that behaves as a NumPy array does."""

    __array_ufunc__ = None  # array * Elementwise calls our __rmul__, not NumPy's loop

    def __init__(self, expression: Any) -> None:
        self.expression = expression

    def __add__(self, other: Any) -> Elementwise:
        return Elementwise(self.expression + plain(other))

    def __sub__(self, other: Any) -> Elementwise:
        return Elementwise(self.expression - plain(other))

    def __rsub__(self, other: Any) -> Elementwise:
        return Elementwise(plain(other) - self.expression)

    def __mul__(self, other: Any) -> Elementwise:
        return Elementwise(cp.multiply(plain(other), self.expression))

    def __truediv__(self, other: Any) -> Elementwise:
        return Elementwise(cp.multiply(1 / plain(other), self.expression))

    def __le__(self, other: Any) -> Any:
        return self.expression <= plain(other)

    __radd__, __rmul__ = __add__, __mul__


def plain(value: Any) -> Any:
    """The cvxpy expression inside, or the value itself."""
    return value.expression if isinstance(value, Elementwise) else value


def sqrt2_norm(*parts: Any) -> Elementwise:
    """Sqrt2 times the Euclidean norm, entry by entry, of expressions that are affine: a second-order cone."""
    return Elementwise(2**0.5 * cp.norm(cp.vstack([plain(part) for part in parts]), axis=0))
