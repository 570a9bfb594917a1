"""The convex programs (cvxpy, Clarabel): the fastest exponential rates, and the nearest gains within the conditions."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...models.algebra.cvxpy_arrays import Elementwise
from ...models.conditions import ConditionData, ConditionSet, cvxpy_numbers
from ...models.equations import Plant
from ...models.errors import UndecidedError
from ...models.gains import GAIN_NAMES, Gains

Floats = NDArray[np.float64]

SOLVE_SECONDS = 20.0  # of wall clock for one program
BISECTIONS = 14  # of ln gamma: 27.6 wide at first, 0.2 % of gamma at last


@dataclass(frozen=True)
class Channel:
    """A second-order channel M s'' + C s' + L_l s = 0 and what is left to it of the torque."""

    inertia: Floats  # (N,), kg or kg m^2
    degree: Floats  # (N,)
    proportional_cost: Floats  # (N,), torque per unit of p, N m
    damping_cost: Floats  # (N,), torque per unit of d, N m
    torque: Floats  # (N,), N m


def translation(plant: Plant, limits: ConditionData, share: float) -> Channel:
    """The along-track channel, with a share of the torque limit; its part of (16)."""
    unit = limits.r / 2
    return Channel(plant.m, limits.degree, unit * np.sqrt(2) * limits.degree, unit, share * limits.torque)


def rotation(plant: Plant, limits: ConditionData, share: float, excitation: float) -> Channel:
    """The heading channel, with a share of the torque limit; its part of (16).

    `excitation` is sqrt2 k psi_bar / p_omega, which the excitation costs beside the heading error.
    """
    unit = limits.r / (2 * limits.arm)
    return Channel(plant.inertia, limits.degree, unit * limits.degree * (1 + excitation), unit, share * limits.torque)


def fastest(channel: Channel, laplacian: Floats, ratio: float = 0.0) -> tuple[float, Floats, Floats] | None:
    """(gamma, p, d) of the largest certified rate within the torque, by bisection on a linear matrix inequality.

    The variables 1/p and d/p make C - 2 gamma M >= 0, L_l - gamma C + gamma^2 M >= 0 and the torque linear for a fixed
    gamma. `ratio` asks for d >= ratio p D besides, as (15) and (15') do for a given excitation. None where Clarabel
    finds no gains that it calls optimal. Raises UndecidedError where it breaks down.
    """
    low, high, best = 1e-6, 1e6, None
    for _ in range(BISECTIONS):
        middle = math.sqrt(low * high)
        found = _feasible(channel, laplacian, ratio, middle)
        low, high, best = (low, middle, best) if found is None else (middle, high, found)
    return None if best is None else (low, *best)


def _feasible(channel: Channel, laplacian: Floats, ratio: float, gamma: float) -> tuple[Floats, Floats] | None:
    """Gains (p, d) with rate gamma, None where there are none. The solver's word only chooses; certificates check."""
    import cvxpy as cp

    count = len(channel.inertia)
    M, C = cp.Variable(count, pos=True), cp.Variable(count, pos=True)  # inertia / p, d / p
    room = cp.Variable()
    spent = channel.proportional_cost + cp.multiply(channel.damping_cost, C)
    problem = cp.Problem(
        cp.Maximize(room),
        [
            2 * gamma * M + room <= C,
            laplacian - gamma * cp.diag(C) + gamma**2 * cp.diag(M) >> room * np.eye(count),
            spent <= cp.multiply(channel.torque / channel.inertia, M),
            ratio * channel.degree <= C,
            room <= 1,
        ],
    )
    if not optimal(problem) or room.value < 0 or min(np.min(M.value), np.min(C.value)) <= 0:
        return None
    p = channel.inertia / M.value
    return p, C.value * p


def optimal(problem: Any) -> bool:
    """Whether Clarabel calls a problem optimal, with numbers for all variables: nothing less is of use.

    Raises UndecidedError where it breaks down or takes too long: that is no answer.
    """
    import warnings

    import cvxpy as cp

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # "may be inaccurate": the status says so too
        try:
            problem.solve(solver=cp.CLARABEL, time_limit=SOLVE_SECONDS)
        except cp.SolverError:  # numerical trouble, as far from the optimum of a bisection
            return False
        except Exception as error:
            raise UndecidedError(f"Clarabel broke down: {type(error).__name__}: {str(error)[:200]}") from None
    if problem.status == cp.USER_LIMIT:
        raise UndecidedError(f"Clarabel found no answer within {SOLVE_SECONDS:g} s")
    values = [variable.value for variable in problem.variables()]
    return problem.status == cp.OPTIMAL and all(value is not None and np.isfinite(value).all() for value in values)


def nearest(conditions: ConditionSet, limits: ConditionData, target: Gains) -> Gains | None:
    """The gains within the conditions that are nearest to a target in relative terms: a second-order cone program.

    `limits` and `target` are floats. None where Clarabel reports no optimum.
    Raises UndecidedError where it breaks down.
    """
    import cvxpy as cp

    relative = {name: cp.Variable(len(limits.degree), pos=True) for name in GAIN_NAMES}
    gains = Gains(*(Elementwise(relative[name]) * getattr(target, name) for name in GAIN_NAMES))
    constraints: list[Any] = [
        inequality.small <= inequality.large for inequality in conditions.inequalities(cvxpy_numbers(), limits, gains)
    ]
    distance = sum(cp.sum_squares(factor - 1) for factor in relative.values())
    problem = cp.Problem(cp.Minimize(distance), constraints)
    if not optimal(problem) or any(np.min(factor.value) <= 0 for factor in relative.values()):
        return None
    return Gains(*(getattr(target, name) * relative[name].value for name in GAIN_NAMES))
