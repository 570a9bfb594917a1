"""The condition sets under which gains are designed and certified."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..models.errors import InputError
from ..models.gains import Gains
from ..models.limits import (
    Condition,
    Inequality,
    Limits,
    Numbers,
    damping,
    speed,
    strict_damping,
    torque,
    torque_sum,
    turn_rate,
)


@dataclass(frozen=True)
class ConditionSet:
    """A set of conditions from `models.limits`, sufficient for the theorem that is named."""

    name: str
    theorem: str
    sources: tuple[str, ...]
    torque: Condition  # the one that keeps the torques within their limits
    others: tuple[Condition, ...]

    def inequalities(self, numbers: Numbers, limits: Limits, gains: Gains) -> list[Inequality]:
        """All conditions, with the limits on speed and turn rate where the fleet asks for them."""
        return [condition(numbers, limits, gains) for condition in (self.torque, *self.homogeneous(limits))]

    def homogeneous(self, limits: Limits) -> list[Condition]:
        """The conditions that scaling all gains together leaves true: all but the torque limit."""
        asked = ((speed, limits.speed), (turn_rate, limits.turn_rate))
        return [*self.others, *(condition for condition, bound in asked if np.any(bound != math.inf))]


_SETS = (
    ConditionSet("paper", "Proposition 1 of the paper", ("(15)", "(16)"), torque_sum, (damping,)),
    ConditionSet("corrected", "the corrected theorem", ("(16*)",), torque, ()),
    ConditionSet(
        "rate-bounded",
        "the corrected theorem with bounded turn rates",
        ("(15')", "(16*)"),
        torque,
        (strict_damping,),
    ),
)
CONDITION_SETS: dict[str, ConditionSet] = {conditions.name: conditions for conditions in _SETS}


def condition_set(name: str) -> ConditionSet:
    """The condition set called `name`. Raises InputError for any other name."""
    if name not in CONDITION_SETS:
        raise InputError(f"conditions = {name!r} is not known; choose one of {', '.join(CONDITION_SETS)}")
    return CONDITION_SETS[name]
