"""Why gains are not certified: which vehicle, which condition, by how much, and the smallest change that repairs it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from ...models.arrays import column
from ...models.conditions import ConditionData, ConditionSet, Inequality, exact_numbers
from ...models.gains import GAIN_NAMES, Gains
from ...models.numbers import decimal_text
from .margins import CheckedConditions, concerned, subset
from .rounding import rounded

DIAGNOSED = 20  # vehicles for which a repair is sought
FAR = 10**6  # a gain is raised or lowered by at most this factor
FINEST = Fraction(1, 10**36)  # relative step of a change


@dataclass(frozen=True)
class Repair:
    """The smallest change of one gain of a vehicle after which all its conditions hold."""

    gain: str
    old: Fraction
    new: Fraction  # a decimal

    @property
    def relative(self) -> Fraction:
        """The size of the change as a part of the gain."""
        return abs(self.new - self.old) / self.old

    def __str__(self) -> str:
        verb = "lower" if self.new < self.old else "raise"
        return f"{verb} {self.gain} from {decimal_text(self.old)} to {decimal_text(self.new)}"


@dataclass(frozen=True)
class Violation:
    """One broken condition of one vehicle."""

    index: int
    vehicle: str
    condition: str
    quantity: str
    small: Fraction  # rounded up where it is irrational
    large: Fraction
    strict: bool
    repair: Repair | None  # None where no change of one gain repairs the vehicle
    sought: bool = True

    @property
    def excess(self) -> Fraction:
        """By how much the condition is broken; 0 where a strict one holds with equality."""
        return self.small - self.large

    def __str__(self) -> str:
        relation, unit = (">=" if self.strict else ">"), self.quantity.rpartition(", ")[2]
        sides = f"{float(self.small):.10g} {relation} {float(self.large):.10g}"
        remedy = str(self.repair or "no change of one gain repairs this vehicle: design its gains anew")
        broken = f"vehicle {self.vehicle!r}: {self.condition} is broken by {float(self.excess):.6g} {unit} ({sides})"
        return f"{broken}; {remedy}" if self.sought else broken


def violations(names: list[str], conditions: ConditionSet, checked: CheckedConditions) -> list[Violation]:
    """The broken conditions in vehicle order, with a repair for each of the first vehicles."""
    broken = sorted((i, c) for c, sides in enumerate(checked.exact) for i in _broken(sides, checked.data))
    repairs: dict[int, Repair | None] = {}
    result = []
    for i, c in broken:
        sought = i in repairs or len(repairs) < DIAGNOSED
        if sought and i not in repairs:
            repairs[i] = smallest_repair(conditions, _one(checked.data, i), _one(checked.gains, i))
        sides, vehicle = checked.exact[c], int(checked.close[i])
        result.append(
            Violation(
                index=vehicle,
                vehicle=names[vehicle],
                condition=sides.source,
                quantity=sides.quantity,
                small=sides.small[i],
                large=sides.large[i],
                strict=sides.strict,
                repair=repairs.get(i),
                sought=sought,
            )
        )
    return result


def _broken(sides: Inequality, data: ConditionData) -> list[int]:
    asked = concerned(sides, data)
    return [i for i, holds in enumerate(sides.holds) if not holds and asked[i]]


def smallest_repair(conditions: ConditionSet, data: ConditionData, gains: Gains) -> Repair | None:
    """The repair with the smallest relative change, for one vehicle; None where no single gain can do it.

    Every condition is monotone in every single gain. So along one direction those that are broken become true at one
    point, if at all, and going further can only break others.
    """
    start = {sides.source for sides in _failing(conditions, data, gains)}

    def cures(name: str, value: Fraction) -> bool:
        changed = replace(gains, **{name: column([value])})
        return not start & {sides.source for sides in _failing(conditions, data, changed)}

    options = []
    for name in GAIN_NAMES:
        old = Fraction(getattr(gains, name)[0])
        for direction in (-1, 1):
            new = _nearest(old, direction, lambda value, name=name: cures(name, value))  # type: ignore[misc]
            if new is not None and not _failing(conditions, data, replace(gains, **{name: column([new])})):
                options.append(Repair(name, old, new))
    return min(options, key=lambda repair: repair.relative, default=None)


def _failing(conditions: ConditionSet, data: ConditionData, gains: Gains) -> list[Inequality]:
    return [sides for sides in conditions.inequalities(exact_numbers(), data, gains) if _broken(sides, data)]


def _nearest(old: Fraction, direction: int, cures: Callable[[Fraction], bool]) -> Fraction | None:
    """The nearest short decimal to `old` in a direction from which on a monotone predicate holds; None if nowhere."""
    if not cures(old / FAR if direction < 0 else old * FAR):
        return None
    step = Fraction(10) ** (math.floor(math.log10(old)) - 6)
    while (steps := _steps(old, direction * step, cures)) < 100 and step > FINEST * old:
        step /= 1000  # until the change is known to three digits
    near = old + direction * steps * step
    return near if near > 0 else rounded(old / FAR, 6)


def _steps(old: Fraction, step: Fraction, cures: Callable[[Fraction], bool]) -> int:
    """How many steps from `old` a monotone predicate holds; past 0 it counts as true."""
    return _first(lambda n: old + n * step <= 0 or cures(old + n * step), int(old * FAR / abs(step)))


def _first(holds: Callable[[int], bool], far: int) -> int:
    """The smallest n in 1..far at which a monotone predicate holds, given that it holds at `far`."""
    high = 1
    while high < far and not holds(high):
        high *= 2
    low = high // 2
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if holds(middle) else (middle, high)
    return high


def _one(columns: Any, i: int) -> Any:
    """The same dataclass of columns for one vehicle."""
    return subset(columns, slice(i, i + 1))
