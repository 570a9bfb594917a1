"""The margins that a certificate states: floats where a condition holds with room, fractions where it is close."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from fractions import Fraction
from typing import Any

import numpy as np

from ...models.arrays import Array, floats
from ...models.conditions import ConditionData, ConditionSet, Inequality, exact_numbers, float_numbers
from ...models.gains import Gains
from .rounding import rounded

DIGITS = 6  # of a margin
EXACT_UP_TO = 20_000  # vehicles; in larger fleets floats decide where they leave no doubt
ROOM = 1e-6  # relative to the large side: a float margin beyond this is right to 1e-8 of itself
CAUTION = 1 - 1e-7  # factor on a float margin
LIMITS = {  # source of a condition: the limit that vehicles ask for
    "speed limit": "speed",
    "turn rate limit": "turn_rate",
    "wheel speed limit": "wheel_speed",
    "acceleration limit": "acceleration",
    "turn acceleration limit": "turn_acceleration",
}


@dataclass(frozen=True, eq=False)
class CheckedConditions:
    """The conditions of a set for all vehicles: stated margins, and exact sides where floats would not do."""

    margins: dict[str, list[Fraction | None]]  # by source, rounded down; None where no limit is asked for
    close: Array  # vehicles that were decided exactly
    exact: list[Inequality]  # of these vehicles
    data: ConditionData  # of these vehicles
    gains: Gains  # of these vehicles


def check_conditions(chosen: ConditionSet, data: ConditionData, gains: Gains) -> CheckedConditions:
    """All conditions of the set; every broken one is among the exactly decided ones."""
    count = len(data.degree)
    clear: list[Inequality] = []
    close = np.arange(count)
    if count > EXACT_UP_TO:
        clear = chosen.inequalities(float_numbers(), data.map(floats), gains.map(floats))
        doubtful = [~(sides.margin > ROOM * np.abs(sides.large)) & concerned(sides, data) for sides in clear]
        close = np.flatnonzero(np.any(doubtful, axis=0))
    few, own = subset(data, close), subset(gains, close)
    exact = chosen.inequalities(exact_numbers(), few, own) if len(close) else []
    margins: dict[str, list[Fraction | None]] = {sides.source: [None] * count for sides in (*clear, *exact)}
    for sides in clear:
        for i in np.flatnonzero(concerned(sides, data)):
            margins[sides.source][i] = rounded(Fraction(float(sides.margin[i]) * CAUTION), DIGITS)
    for sides in exact:
        for i, margin, asks in zip(close, sides.margin, concerned(sides, few), strict=True):
            if asks:
                margins[sides.source][i] = max(rounded(Fraction(margin), DIGITS), Fraction(0))
    return CheckedConditions(margins, close, exact, few, own)


def concerned(sides: Inequality, data: ConditionData) -> Array:
    """Which vehicles a condition is about, (N,): all, but those of a limit only where one is asked for."""
    if sides.source not in LIMITS:
        return np.ones(len(data.degree), dtype=bool)
    limit = getattr(data, LIMITS[sides.source])
    return np.array([value != np.inf for value in limit], dtype=bool)


def subset(columns: Any, chosen: Array) -> Any:
    """The same dataclass of columns for some vehicles; single numbers are left as they are."""
    changed = {}
    for field in fields(columns):
        value = getattr(columns, field.name)
        if hasattr(value, "__dataclass_fields__"):
            changed[field.name] = subset(value, chosen)
        elif getattr(value, "shape", ()) != ():
            changed[field.name] = value[chosen]
    return replace(columns, **changed)
