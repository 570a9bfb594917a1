"""The conditions on the gains, once: (15), (15'), (16), (16*) and the certified speed limits.

Each function returns an `Inequality` with one entry per vehicle, over floats, exact fractions, cvxpy expressions or
SymPy numbers: `Numbers` has their norm, tanh and atanh. For fractions the irrational parts are rounded in the
safe direction: an inequality that holds for the fractions is true.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from functools import cache

import numpy as np

from .arrays import Array
from .enclosures import atanh_above, sqrt_above, tanh_below
from .errors import InputError
from .gains import GAIN_NAMES, Gains


@dataclass(frozen=True)
class Numbers:
    """The functions that the conditions need beside + - * /."""

    sqrt2_norm: Callable[..., Array]  # sqrt2 times the Euclidean norm of its arguments; rounded up where inexact
    tanh: Callable[[Array], Array]  # of a positive constant; rounded down where inexact; inf for an infinite argument
    atanh: Callable[[Array], Array] | None  # of numbers >= 0; rounded up where inexact; inf from 1 on; None: missing


@dataclass(frozen=True, eq=False)
class Inequality:
    """small <= large (or <, where strict) for every vehicle."""

    source: str  # the equation it comes from
    quantity: str  # the name of `small`, with its unit
    small: Array  # (N,)
    large: Array  # (N,)
    # `small` is linear in these gains, for the wheel speed convex and 0 with them; `large` does not contain them.
    scaled: tuple[str, ...]
    strict: bool = False

    @property
    def margin(self) -> Array:
        """large - small, (N,); NaN for a vehicle without the limit whose small side has no bound either."""
        with np.errstate(invalid="ignore"):
            return self.large - self.small

    @property
    def holds(self) -> Array:
        """(N,) of bool; exact for fractions."""
        return self.small < self.large if self.strict else self.small <= self.large


@dataclass(frozen=True, eq=False)
class ConditionData:
    """The numbers in the conditions that are not gains, all of one number type."""

    degree: Array  # (N,), D_i = a_il + l_ii
    psi_bar: Array  # bound of |psi|
    r: Array  # (N,), m, wheel radius
    arm: Array  # (N,), m, |lever arm|: 2R in (2) as printed, R on a physical drive
    torque: Array  # (N,), N m, min of the left and right limit
    speed: Array  # (N,), m/s, math.inf without a limit
    turn_rate: Array  # (N,), rad/s, math.inf without a limit; the limits below likewise
    wheel_speed: Array  # (N,), rad/s, of either wheel
    acceleration: Array  # (N,), m/s^2
    turn_acceleration: Array  # (N,), rad/s^2
    m: Array  # (N,), kg, the least effective mass
    inertia: Array  # (N,), kg m^2, the least effective inertia
    longest_arm: Array  # (N,), m
    smallest_r: Array  # (N,), m

    def map(self, convert: Callable[[Array], Array]) -> ConditionData:
        """The same data with every array converted."""
        return ConditionData(*(convert(getattr(self, field.name)) for field in fields(self)))


def excitation_bound(numbers: Numbers, data: ConditionData, gains: Gains) -> Array:
    """c = sqrt2 k psi_bar D >= |alpha|, N m."""
    return data.degree * numbers.sqrt2_norm(gains.k_alpha * data.psi_bar)


def turning_bound(numbers: Numbers, data: ConditionData, gains: Gains) -> Array:
    """p_omega D + c: what the heading error and the excitation can ask for together, N m."""
    return gains.p_omega * data.degree + excitation_bound(numbers, data, gains)


def pulling_bound(numbers: Numbers, data: ConditionData, gains: Gains) -> Array:
    """sqrt2 p_v D: what the position error can ask for, N."""
    return data.degree * numbers.sqrt2_norm(gains.p_v)


def condition_15(numbers: Numbers, data: ConditionData, gains: Gains) -> Inequality:
    """(15): c <= d_omega tanh(1)."""
    c = excitation_bound(numbers, data, gains)
    return Inequality("(15)", "excitation bound, N m", c, gains.d_omega * numbers.tanh(1), ("k_alpha",))


def condition_15_prime(numbers: Numbers, data: ConditionData, gains: Gains) -> Inequality:
    """(15'): p_omega D + c < d_omega, which bounds the turn rate."""
    small = turning_bound(numbers, data, gains)
    return Inequality("(15')", "heading and excitation bound, N m", small, gains.d_omega, _TURNING, strict=True)


def condition_16(numbers: Numbers, data: ConditionData, gains: Gains) -> Inequality:
    """(16): 2R u_v + u_omega < (4R / r) min tau, with R for 2R on a physical drive."""
    u_v = gains.d_v + pulling_bound(numbers, data, gains)
    u_omega = gains.d_omega + turning_bound(numbers, data, gains)
    small = data.arm * u_v + u_omega
    quantity = "lever arm times force, plus moment, N m"
    return Inequality("(16)", quantity, small, torque_room(data), GAIN_NAMES, strict=True)


def torque_room(data: ConditionData) -> Array:
    """(4R / r) min tau, N m: the right side of (16)."""
    return 2 * data.arm * data.torque / data.r


def torque_bound(numbers: Numbers, data: ConditionData, gains: Gains) -> Array:
    """T of (16*), N m: the supremum of both wheel torques over all states and times; never attained."""
    # cos, sin of the heading meet the error as a rotated pair: |p_v phi -/+ (k psi / arm) phi_perp| is a norm.
    pull = data.degree * numbers.sqrt2_norm(gains.p_v, gains.k_alpha * data.psi_bar / data.arm)
    turn = (gains.d_omega + gains.p_omega * data.degree) / data.arm
    return data.r / 2 * (gains.d_v + pull + turn)


def condition_16_star(numbers: Numbers, data: ConditionData, gains: Gains) -> Inequality:
    """(16*): T <= min(tau_left, tau_right)."""
    return Inequality("(16*)", "torque bound, N m", torque_bound(numbers, data, gains), data.torque, GAIN_NAMES)


def speed_condition(numbers: Numbers, data: ConditionData, gains: Gains) -> Inequality:
    """sqrt2 p_v D <= d_v tanh(V / s) for a speed limit V: |v| never passes it."""
    small = pulling_bound(numbers, data, gains)
    large = gains.d_v * numbers.tanh(data.speed / gains.saturation.speed)
    return Inequality("speed limit", "position error bound, N", small, large, ("p_v",))


def turn_rate_condition(numbers: Numbers, data: ConditionData, gains: Gains) -> Inequality:
    """p_omega D + c <= d_omega tanh(Omega / o) for a turn-rate limit Omega: |omega| never passes it."""
    small = turning_bound(numbers, data, gains)
    large = gains.d_omega * numbers.tanh(data.turn_rate / gains.saturation.turn_rate)
    return Inequality("turn rate limit", "heading and excitation bound, N m", small, large, _TURNING)


def wheel_speed_condition(numbers: Numbers, data: ConditionData, gains: Gains) -> Inequality:
    """s atanh(sqrt2 p_v D / d_v) + arm o atanh((p_omega D + c) / d_omega) <= r W for a limit W of the wheels.

    The two terms are the speed V and the arm's speed arm Omega that (f) of the theorem certifies; a wheel turns at most
    at (V + arm Omega) / r. Both are convex in a common factor of p_v, p_omega and k_alpha, and 0 with it.
    """
    if numbers.atanh is None:
        raise TypeError("the wheel-speed condition needs atanh")
    V = gains.saturation.speed * numbers.atanh(pulling_bound(numbers, data, gains) / gains.d_v)
    Omega = gains.saturation.turn_rate * numbers.atanh(turning_bound(numbers, data, gains) / gains.d_omega)
    small, large = V + data.longest_arm * Omega, data.smallest_r * data.wheel_speed
    return Inequality("wheel speed limit", "rim speed, m/s", small, large, ("p_v", *_TURNING))


def acceleration_condition(numbers: Numbers, data: ConditionData, gains: Gains) -> Inequality:
    """d_v + sqrt2 p_v D <= a m for a limit a of |v'|."""
    small = gains.d_v + pulling_bound(numbers, data, gains)
    return Inequality("acceleration limit", "force bound, N", small, data.acceleration * data.m, ("p_v", "d_v"))


def turn_acceleration_condition(numbers: Numbers, data: ConditionData, gains: Gains) -> Inequality:
    """d_omega + p_omega D + c <= a I for a limit a of |omega'|."""
    small, large = gains.d_omega + turning_bound(numbers, data, gains), data.turn_acceleration * data.inertia
    return Inequality("turn acceleration limit", "moment bound, N m", small, large, ("d_omega", *_TURNING))


Condition = Callable[[Numbers, ConditionData, Gains], Inequality]

_TURNING = ("p_omega", "k_alpha")


@cache
def float_numbers() -> Numbers:
    """Floats: plain rounding, for display and search; never for a verdict."""
    return Numbers(lambda *parts: np.sqrt(2 * _squares(*parts)), _tanh_or(np.inf), _float_atanh)


@cache
def exact_numbers() -> Numbers:
    """Object arrays of `Fraction`: roots exact where rational, else rounded up; tanh rounded down."""
    root = np.frompyfunc(sqrt_above, 1, 1)
    tanh, atanh = (np.frompyfunc(function, 1, 1) for function in (tanh_below, atanh_above))
    return Numbers(lambda *parts: root(2 * _squares(*parts)), tanh, atanh)


@cache
def cvxpy_numbers() -> Numbers:
    """`Elementwise` cvxpy expressions that are affine in the gains: the conditions come out as second-order cones."""
    from .algebra.cvxpy_arrays import sqrt2_norm

    return Numbers(sqrt2_norm, _tanh_or(NEVER_BINDS), None)


@cache
def casadi_numbers() -> Numbers:
    """CasADi columns."""
    import casadi as ca

    constant = _tanh_or(math.inf)

    def tanh(q: Array) -> Array:
        if isinstance(q, (ca.SX, ca.MX)):  # over a scale that is a variable
            return ca.if_else(q > NEVER_BINDS, NEVER_BINDS, ca.tanh(q))
        return ca.DM(constant(ca.DM(q).full()))

    def atanh(q: Array) -> Array:
        inside = ca.fmin(q, 1 - 1e-9)  # from 1 on the condition is violated by far
        return ca.log((1 + inside) / (1 - inside)) / 2

    return Numbers(lambda *parts: ca.sqrt(2 * _squares(*parts)), tanh, atanh)


@cache
def sympy_numbers() -> Numbers:
    """Object arrays of SymPy numbers: no rounding at all."""
    import numpy as np
    import sympy as sp

    root = np.frompyfunc(sp.sqrt, 1, 1)
    tanh = np.frompyfunc(lambda q: sp.oo if q == math.inf else sp.tanh(q), 1, 1)
    atanh = np.frompyfunc(lambda q: sp.oo if q >= 1 else sp.atanh(q), 1, 1)
    return Numbers(lambda *parts: root(2 * _squares(*parts)), tanh, atanh)


def _squares(first: Array, *rest: Array) -> Array:
    return sum((part * part for part in rest), first * first)


def _tanh_or(without_limit: float) -> Callable[[Array], Array]:
    """Tanh of floats, and `without_limit` for an infinite argument: the fleet sets no limit there."""
    return lambda q: np.where(np.isinf(q), without_limit, np.tanh(np.asarray(q, dtype=float)))


def _float_atanh(q: Array) -> Array:
    with np.errstate(divide="ignore"):
        return np.arctanh(np.minimum(q, 1))


NEVER_BINDS = 1e6  # in place of infinity, which a solver does not take


@dataclass(frozen=True)
class ConditionSet:
    """A set of conditions from this module, and the theorem that it is sufficient for."""

    name: str
    theorem: str
    sources: tuple[str, ...]
    torque: Condition  # the condition that keeps the torques within their limits
    others: tuple[Condition, ...]

    def inequalities(self, numbers: Numbers, data: ConditionData, gains: Gains) -> list[Inequality]:
        """All conditions, with the limits that the fleet asks for. Without atanh the wheel-speed limit is left out."""
        conditions = (*self.bounding(data), *self.homogeneous(data))
        known = (c for c in conditions if c is not wheel_speed_condition or numbers.atanh is not None)
        return [condition(numbers, data, gains) for condition in known]

    def bounding(self, data: ConditionData) -> list[Condition]:
        """The conditions that can always be met by scaling all gains down: torque limits and accelerations."""
        limits = (acceleration_condition, data.acceleration), (turn_acceleration_condition, data.turn_acceleration)
        return [self.torque, *_asked_for(limits)]

    def homogeneous(self, data: ConditionData) -> list[Condition]:
        """The conditions on ratios of gains: scaling all gains together does not change them."""
        asked = (
            (speed_condition, data.speed),
            (turn_rate_condition, data.turn_rate),
            (wheel_speed_condition, data.wheel_speed),
        )
        return [*self.others, *_asked_for(asked)]


def _asked_for(limits: Sequence[tuple[Condition, Array]]) -> list[Condition]:
    return [condition for condition, limit in limits if np.any(limit != math.inf)]


BOUNDED = "the corrected theorem with bounded turn rates"
_SETS = (
    ConditionSet("paper", "Proposition 1 of the paper", ("(15)", "(16)"), condition_16, (condition_15,)),
    ConditionSet("corrected", "the corrected theorem", ("(16*)",), condition_16_star, ()),
    ConditionSet("rate-bounded", BOUNDED, ("(15')", "(16*)"), condition_16_star, (condition_15_prime,)),
)
CONDITION_SETS: dict[str, ConditionSet] = {conditions.name: conditions for conditions in _SETS}


def condition_set(name: str) -> ConditionSet:
    """The condition set called `name`. Raises InputError for any other name."""
    if name not in CONDITION_SETS:
        raise InputError(f"conditions = {name!r} is not known; choose one of {', '.join(CONDITION_SETS)}")
    return CONDITION_SETS[name]
