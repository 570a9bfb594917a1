"""The margins that a certificate states: floats where a condition holds with room, fractions where it is close."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from fractions import Fraction
from typing import Any

import numpy as np

from ...models.arrays import Array, floats
from ...models.conditions import ConditionData, ConditionSet, Inequality, exact_numbers, float_numbers
from ...models.fleet_content import scaled_text
from ...models.gains import Gains
from ...models.numbers import decimal_places
from .rounding import rounded

DIGITS = 6  # of a margin, the least of a condition where floats decided
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
class Stated:
    """The margins of one condition for the vehicles that it is about, as integers at one power of ten."""

    scaled: dict[int, int]  # by vehicle
    places: int

    @property
    def text(self) -> str:
        """The column of a certificate."""
        return scaled_text([self.scaled[i] for i in sorted(self.scaled)], self.places)

    def of(self, vehicle: int) -> Fraction:
        """The margin of one vehicle."""
        return Fraction(self.scaled[vehicle], 10**self.places)


@dataclass(frozen=True, eq=False)
class CheckedConditions:
    """The conditions of a set for all vehicles: stated margins, and exact sides where floats would not do."""

    margins: dict[str, Stated]  # by source, rounded down
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
    by_source = {sides.source: (Stated({}, 0), Stated({}, 0)) for sides in (*clear, *exact)}
    for sides in clear:
        vehicles = np.setdiff1d(np.flatnonzero(concerned(sides, data)), close)
        by_source[sides.source] = floored(vehicles, sides.margin[vehicles]), by_source[sides.source][1]
    for sides in exact:
        asks = concerned(sides, few)
        rounded_down = stated(close[asks].tolist(), sides.margin[asks])
        by_source[sides.source] = by_source[sides.source][0], rounded_down
    margins = {source: joined(*parts) for source, parts in by_source.items()}
    return CheckedConditions(margins, close, exact, few, own)


def floored(vehicles: Array, margins: Array) -> Stated:
    """Float margins > 0 rounded down to the places at which the least of them has its digits."""
    if not len(vehicles):
        return Stated({}, 0)
    places = max(DIGITS - 1 - math.floor(math.log10(margins.min())), 0)
    scaled = np.floor(margins * CAUTION * 10.0**places)
    return Stated(dict(zip(vehicles.tolist(), map(int, scaled.tolist()), strict=True)), places)


def stated(vehicles: Sequence[int], margins: Array) -> Stated:
    """Exact margins rounded down to digits of their own; 0 for a broken condition."""
    found = [max(rounded(Fraction(margin), DIGITS), Fraction(0)) for margin in margins]
    places = max((decimal_places(margin.denominator) or 0 for margin in found), default=0)
    return Stated({i: int(margin * 10**places) for i, margin in zip(vehicles, found, strict=True)}, places)


def joined(one: Stated, other: Stated) -> Stated:
    """The margins of both, at the larger number of places."""
    places = max(one.places, other.places)
    parts = ((part.scaled, 10 ** (places - part.places)) for part in (one, other))
    return Stated({i: value * factor for scaled, factor in parts for i, value in scaled.items()}, places)


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
