"""sin, cos and tanh in single precision, made of sums, products and quotients: the same on every processor."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import casadi as ca
import numpy as np

from ...models.algebra.ops import Ops, casadi_ops
from ...models.arrays import Array

LARGEST = 6.1  # for larger arguments tanh(6.1) is used


def single_ops() -> Ops:
    """`casadi_ops` with sin, cos and tanh made of sums, products and quotients, within 1e-5."""
    return replace(casadi_ops(), sin=_sin, cos=_cos, tanh=_tanh)


def _tanh(s: Array) -> Array:
    """Lambert's continued fraction s / (1 + s^2 / (3 + s^2 / (5 + ...))), cut off at 17."""
    s = ca.fmin(ca.fmax(s, -LARGEST), LARGEST)
    square = s * s
    over = _polynomial(square, [34459425, 4729725, 135135, 990, 1])
    return s * over / _polynomial(square, [34459425, 16216200, 945945, 13860, 45])


def _sin(s: Array) -> Array:
    rest, sign = _half_turn(s)
    return sign * rest * _polynomial(rest * rest, [(-1) ** k / math.factorial(2 * k + 1) for k in range(5)])


def _cos(s: Array) -> Array:
    rest, sign = _half_turn(s)
    return sign * _polynomial(rest * rest, [(-1) ** k / math.factorial(2 * k) for k in range(6)])


def _half_turn(s: Array) -> tuple[Array, Array]:
    """s less the nearest multiple of pi, and the sign that sin and cos have for it."""
    turns = ca.floor(s / math.pi + 0.5)
    pi = float(np.float32(math.pi))  # what a single lacks of pi goes off afterwards
    rest = (s - turns * pi) - turns * (math.pi - pi)
    return rest, 1 - 4 * (turns / 2 - ca.floor(turns / 2))


def _polynomial(s: Array, coefficients: Sequence[float]) -> Array:
    """By Horner's rule, the constant first."""
    *rest, value = coefficients
    for coefficient in reversed(rest):
        value = value * s + coefficient
    return value
