"""How a wheel-speed limit is shared between |v| and |omega|: the rim speeds that a certificate states."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from ...models.conditions import ConditionData, exact_numbers, pulling_bound, wheel_speed_condition
from ...models.fleet_content import fixed_point
from ...models.gains import Gains
from .margins import CheckedConditions, subset


def rim_speeds(data: ConditionData, gains: Gains, checked: CheckedConditions) -> str:
    """For each vehicle with a wheel-speed limit, the bound V of |v|, m/s, that is left to it.

    V lies between the least bound that can be certified and the one that leaves just enough to |omega|: what the
    stated margin was rounded off is divided between both.
    """
    limited = np.flatnonzero(data.wheel_speed != np.inf)
    if not len(limited):
        return ""
    few, own = subset(data, limited), subset(gains, limited)
    numbers = exact_numbers()
    assert numbers.atanh is not None  # noqa: S101
    least = own.saturation.speed * numbers.atanh(pulling_bound(numbers, few, own) / own.d_v)
    room = wheel_speed_condition(numbers, few, own).margin
    stated = map(checked.margins["wheel speed limit"].of, limited.tolist())
    return fixed_point(between(V, V + space - margin) for V, space, margin in zip(least, room, stated, strict=True))


def between(low: Fraction, high: Fraction) -> Fraction:
    """The shortest decimal near the middle of two decimals."""
    places = 0
    while not low <= (found := Fraction(round((low + high) / 2 * 10**places), 10**places)) <= high:
        places += 1
    return found
