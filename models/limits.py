"""The conditions on the gains, once: (15), (15'), (16), (16*) and the certified speed limits.

Each function returns an `Inequality` with one entry per vehicle, over floats, exact fractions, cvxpy expressions or
SymPy numbers: `Numbers` says how each of them takes a norm. For fractions the irrational parts are enclosed in the
safe direction, so that an inequality that holds in fractions holds in truth.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, fields
from fractions import Fraction
from functools import cache

from .gains import GAIN_NAMES, Gains
from .ops import Array


@dataclass(frozen=True)
class Numbers:
    """What the conditions need beyond + - * /."""

    sqrt2_norm: Callable[..., Array]  # sqrt2 times the Euclidean norm of its arguments; rounded up where inexact
    tanh: Callable[[Array], Array]  # of a positive constant; rounded down where inexact; endless where it is


@dataclass(frozen=True, eq=False)
class Inequality:
    """small <= large (or <, where strict) for every vehicle."""

    source: str  # the equation it comes from
    quantity: str  # what `small` is, in words with its unit
    small: Array  # (N,)
    large: Array  # (N,)
    scaled: tuple[str, ...]  # gains in which `small` is linear and on which `large` does not depend
    strict: bool = False

    @property
    def margin(self) -> Array:
        """large - small, (N,)."""
        return self.large - self.small

    @property
    def holds(self) -> Array:
        """(N,) of bool; exact for fractions."""
        return self.small < self.large if self.strict else self.small <= self.large


@dataclass(frozen=True, eq=False)
class Limits:
    """The numbers in the conditions that are not gains, all of one number type."""

    degree: Array  # (N,), D_i = a_il + l_ii
    psi_bar: Array  # bound of |psi|
    r: Array  # (N,), m, wheel radius
    arm: Array  # (N,), m, |lever arm|: 2R in (2) as printed, R on a physical drive
    torque: Array  # (N,), N m, min of the left and right limit
    speed: Array  # (N,), m/s, math.inf where none is asked for
    turn_rate: Array  # (N,), rad/s, math.inf where none is asked for

    def map(self, convert: Callable[[Array], Array]) -> Limits:
        """The same limits with every array converted."""
        return Limits(*(convert(getattr(self, field.name)) for field in fields(self)))


def excitation_bound(numbers: Numbers, limits: Limits, gains: Gains) -> Array:
    """c = sqrt2 k psi_bar D >= |alpha|, N m."""
    return limits.degree * numbers.sqrt2_norm(gains.k_alpha * limits.psi_bar)


def turning_bound(numbers: Numbers, limits: Limits, gains: Gains) -> Array:
    """p_omega D + c: what the heading error and the excitation can ask for together, N m."""
    return gains.p_omega * limits.degree + excitation_bound(numbers, limits, gains)


def pulling_bound(numbers: Numbers, limits: Limits, gains: Gains) -> Array:
    """sqrt2 p_v D: what the position error can ask for, N."""
    return limits.degree * numbers.sqrt2_norm(gains.p_v)


def damping(numbers: Numbers, limits: Limits, gains: Gains) -> Inequality:
    """(15): c <= d_omega tanh(1)."""
    c = excitation_bound(numbers, limits, gains)
    return Inequality("(15)", "excitation bound, N m", c, gains.d_omega * numbers.tanh(1), ("k_alpha",))


def strict_damping(numbers: Numbers, limits: Limits, gains: Gains) -> Inequality:
    """(15'): p_omega D + c < d_omega, which bounds the turn rate."""
    small = turning_bound(numbers, limits, gains)
    return Inequality("(15')", "heading and excitation bound, N m", small, gains.d_omega, _TURNING, strict=True)


def torque_sum(numbers: Numbers, limits: Limits, gains: Gains) -> Inequality:
    """(16): 2R u_v + u_omega < (4R / r) min tau, with R for 2R on a physical drive."""
    u_v = gains.d_v + pulling_bound(numbers, limits, gains)
    u_omega = gains.d_omega + turning_bound(numbers, limits, gains)
    small = limits.arm * u_v + u_omega
    quantity = "lever arm times force, plus moment, N m"
    return Inequality("(16)", quantity, small, torque_room(limits), GAIN_NAMES, strict=True)


def torque_room(limits: Limits) -> Array:
    """(4R / r) min tau, N m: the right side of (16)."""
    return 2 * limits.arm * limits.torque / limits.r


def torque_bound(numbers: Numbers, limits: Limits, gains: Gains) -> Array:
    """T of (16*), N m: the supremum of both wheel torques over all states and times; never attained."""
    # cos, sin of the heading meet the error as a rotated pair: |p_v phi -/+ (k psi / arm) phi_perp| is a norm.
    pull = limits.degree * numbers.sqrt2_norm(gains.p_v, gains.k_alpha * limits.psi_bar / limits.arm)
    turn = (gains.d_omega + gains.p_omega * limits.degree) / limits.arm
    return limits.r / 2 * (gains.d_v + pull + turn)


def torque(numbers: Numbers, limits: Limits, gains: Gains) -> Inequality:
    """(16*): T <= min(tau_left, tau_right)."""
    return Inequality("(16*)", "torque bound, N m", torque_bound(numbers, limits, gains), limits.torque, GAIN_NAMES)


def speed(numbers: Numbers, limits: Limits, gains: Gains) -> Inequality:
    """sqrt2 p_v D <= d_v tanh(speed limit): |v| never passes the limit that it starts within."""
    small = pulling_bound(numbers, limits, gains)
    large = gains.d_v * numbers.tanh(limits.speed)
    return Inequality("speed limit", "position error bound, N", small, large, ("p_v",))


def turn_rate(numbers: Numbers, limits: Limits, gains: Gains) -> Inequality:
    """p_omega D + c <= d_omega tanh(turn rate limit): |omega| never passes the limit that it starts within."""
    small = turning_bound(numbers, limits, gains)
    large = gains.d_omega * numbers.tanh(limits.turn_rate)
    return Inequality("turn rate limit", "heading and excitation bound, N m", small, large, _TURNING)


Condition = Callable[[Numbers, Limits, Gains], Inequality]

_TURNING = ("p_omega", "k_alpha")


@cache
def float_numbers() -> Numbers:
    """Floats: plain rounding, for display and search; never for a verdict."""
    import numpy as np

    return Numbers(lambda *parts: np.sqrt(2 * _squares(*parts)), _tanh_or(np.inf))


@cache
def exact_numbers() -> Numbers:
    """Object arrays of `Fraction`: roots exact where rational, else rounded up; tanh rounded down."""
    import numpy as np

    root = np.frompyfunc(sqrt_above, 1, 1)
    hyperbolic = np.frompyfunc(tanh_below, 1, 1)
    return Numbers(lambda *parts: root(2 * _squares(*parts)), hyperbolic)


@cache
def cvxpy_numbers() -> Numbers:
    """`Elementwise` cvxpy expressions that are affine in the gains: the conditions come out as second-order cones."""
    from .elementwise import sqrt2_norm

    return Numbers(sqrt2_norm, _tanh_or(NEVER_BINDS))


@cache
def casadi_numbers() -> Numbers:
    """CasADi columns."""
    import casadi as ca

    endless = _tanh_or(math.inf)
    return Numbers(lambda *parts: ca.sqrt(2 * _squares(*parts)), lambda q: ca.DM(endless(ca.DM(q).full())))


@cache
def sympy_numbers() -> Numbers:
    """Object arrays of SymPy numbers: no rounding at all."""
    import numpy as np
    import sympy as sp

    root = np.frompyfunc(sp.sqrt, 1, 1)
    hyperbolic = np.frompyfunc(lambda q: sp.oo if q == math.inf else sp.tanh(q), 1, 1)
    return Numbers(lambda *parts: root(2 * _squares(*parts)), hyperbolic)


def _squares(first: Array, *rest: Array) -> Array:
    return sum((part * part for part in rest), first * first)


def _tanh_or(endless: float) -> Callable[[Array], Array]:
    """Tanh of floats, and `endless` where the argument is infinite: no limit is asked for there."""
    import numpy as np

    return lambda q: np.where(np.isinf(q), endless, np.tanh(np.asarray(q, dtype=float)))


NEVER_BINDS = 1e6  # in place of infinity, which a solver does not take
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
