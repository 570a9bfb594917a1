"""The speeds and accelerations that a motion from rest never exceeds, by the theorem."""

from __future__ import annotations

from typing import NamedTuple

from .arrays import Array
from .conditions import ConditionData, Numbers, pulling_bound, turning_bound
from .gains import Gains


class MotionBounds(NamedTuple):
    """Bounds from rest, (N,) each; inf if the gains give none."""

    speed: Array  # m/s
    turn_rate: Array  # rad/s
    acceleration: Array  # m/s^2
    turn_acceleration: Array  # rad/s^2


def motion_bounds(numbers: Numbers, data: ConditionData, gains: Gains) -> MotionBounds:
    """(f) of the theorem and L1: |v| <= s atanh(sqrt2 p_v D / d_v), |v'| < (d_v + sqrt2 p_v D) / m, and so for turning.

    Rounded up if `numbers` is not exact. Raises TypeError for numbers without atanh.
    """
    if numbers.atanh is None:
        raise TypeError("motion bounds need atanh")
    pull, turn = pulling_bound(numbers, data, gains), turning_bound(numbers, data, gains)
    return MotionBounds(
        gains.saturation.speed * numbers.atanh(pull / gains.d_v),
        gains.saturation.turn_rate * numbers.atanh(turn / gains.d_omega),
        (gains.d_v + pull) / data.m,
        (gains.d_omega + turn) / data.inertia,
    )
