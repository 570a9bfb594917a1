"""The nearest gains within the conditions: a second-order cone program (cvxpy, Clarabel)."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ...models.algebra.cvxpy_arrays import Elementwise
from ...models.conditions import ConditionData, ConditionSet, cvxpy_numbers
from ...models.gains import GAIN_NAMES, Gains
from ..settings import FAST
from .solvers import clarabel_finds_optimum


def nearest(
    conditions: ConditionSet, data: ConditionData, target: Gains, seconds: float = FAST.clarabel_seconds
) -> Gains | None:
    """The gains within the conditions that are nearest to a target in relative terms: a second-order cone program.

    They keep its scales. `data` and `target` are floats; `seconds` limits the solve. None where Clarabel reports no
    optimum. Raises UndecidedError where it breaks down.
    """
    import cvxpy as cp

    relative = {name: cp.Variable(len(data.degree), pos=True) for name in GAIN_NAMES}
    scaled = {name: Elementwise(relative[name]) * getattr(target, name) for name in GAIN_NAMES}
    gains = Gains(**scaled, saturation=target.saturation)
    constraints: list[Any] = [
        inequality.small <= inequality.large for inequality in conditions.inequalities(cvxpy_numbers(), data, gains)
    ]
    distance = sum(cp.sum_squares(factor - 1) for factor in relative.values())
    problem = cp.Problem(cp.Minimize(distance), constraints)
    if not clarabel_finds_optimum(problem, seconds) or any(np.min(factor.value) <= 0 for factor in relative.values()):
        return None
    return replace(target, **{name: getattr(target, name) * relative[name].value for name in GAIN_NAMES})
