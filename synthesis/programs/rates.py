"""The fastest exponential rates by linear matrix inequalities (cvxpy, Clarabel), and the candidates from them."""

from __future__ import annotations

import logging
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...models.conditions import ConditionData
from ...models.equations import Plant
from ...models.errors import UndecidedError
from ...models.gains import Gains
from ..settings import FAST
from ..task import Task
from .cones import nearest
from .solvers import clarabel_finds_optimum

Floats = NDArray[np.float64]

LOG = logging.getLogger(__name__)
DENSE_VEHICLES = 60  # above this size the matrix inequalities take too long for a candidate
TRANSLATION_SHARES = (0.3, 0.6)  # of the torque limit
EXCITATION = 1.0  # sqrt2 k psi_bar / p_omega that the heading channel leaves room for
BISECTIONS = 14  # of ln gamma: the interval shrinks from 27.6 to 0.2 % of gamma


@dataclass(frozen=True)
class Channel:
    """A second-order channel M s'' + C s' + L_l s = 0 and its share of the torque."""

    inertia: Floats  # (N,), kg or kg m^2
    degree: Floats  # (N,)
    proportional_cost: Floats  # (N,), torque per unit of p, N m
    damping_cost: Floats  # (N,), torque per unit of d, N m
    torque: Floats  # (N,), N m


def translation(plant: Plant, data: ConditionData, share: float) -> Channel:
    """The along-track channel, with a share of the torque limit; its part of (16)."""
    unit = data.r / 2
    return Channel(plant.m, data.degree, unit * np.sqrt(2) * data.degree, unit, share * data.torque)


def rotation(plant: Plant, data: ConditionData, share: float, excitation: float) -> Channel:
    """The heading channel, with a share of the torque limit; its part of (16).

    `excitation` is sqrt2 k psi_bar / p_omega, which the excitation costs beside the heading error.
    """
    unit = data.r / (2 * data.arm)
    return Channel(plant.inertia, data.degree, unit * data.degree * (1 + excitation), unit, share * data.torque)


def fastest(
    channel: Channel, laplacian: Floats, ratio: float = 0.0, seconds: float = FAST.clarabel_seconds
) -> tuple[float, Floats, Floats] | None:
    """(gamma, p, d) of the largest certified rate within the torque, by bisection on a linear matrix inequality.

    The variables 1/p and d/p make C - 2 gamma M >= 0, L_l - gamma C + gamma^2 M >= 0 and the torque linear for a fixed
    gamma. `ratio` also requires d >= ratio p D, as (15) and (15') do for a given excitation. `seconds` limits each
    solve. None if Clarabel reports no optimal gains. Raises UndecidedError if it breaks down.
    """
    low, high, best = 1e-6, 1e6, None
    for _ in range(BISECTIONS):
        middle = math.sqrt(low * high)
        found = _feasible(channel, laplacian, ratio, middle, seconds)
        low, high, best = (low, middle, best) if found is None else (middle, high, found)
    return None if best is None else (low, *best)


def _feasible(
    channel: Channel, laplacian: Floats, ratio: float, gamma: float, seconds: float
) -> tuple[Floats, Floats] | None:
    """Gains (p, d) with rate gamma, None without any. The solver's status only selects; the certificate checks."""
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
    if not clarabel_finds_optimum(problem, seconds) or room.value < 0 or min(np.min(M.value), np.min(C.value)) <= 0:
        return None
    p = channel.inertia / M.value
    return p, C.value * p


def convex_designs(task: Task) -> list[tuple[Gains, float]]:
    """(gains as floats, tempo of psi) with the fastest heading and along-track rates; none for large fleets."""
    if len(task.fleet) > DENSE_VEHICLES:
        return []
    designs = []
    try:
        for share in TRANSLATION_SHARES:
            designs += _designs(task, share)
    except UndecidedError as error:
        LOG.warning("convex programs: broken off: %s", error)
    if not designs:
        LOG.warning("convex programs: left out, because Clarabel finds no gains that it calls optimal")
    return designs


def _designs(task: Task, share: float) -> list[tuple[Gains, float]]:
    """The design with a share of the torque for the translation, if Clarabel finds it."""
    seconds = task.settings.clarabel_seconds
    laplacian = task.plant.graph.composed_laplacian().toarray()
    k_ratio = EXCITATION / (math.sqrt(2) * float(task.data.psi_bar))
    along = fastest(translation(task.plant, task.data, share), laplacian, seconds=seconds)
    turning = rotation(task.plant, task.data, 1 - share, EXCITATION)
    heading = fastest(turning, laplacian, EXCITATION / math.tanh(1), seconds)
    if along is None or heading is None:
        return []
    (gamma_v, p_v, d_v), (_, p_omega, d_omega) = along, heading
    gains = nearest(task.conditions, task.data, Gains(p_v, d_v, p_omega, d_omega, k_ratio * p_omega), seconds)
    # psi moves the vehicles best near the rate of the along-track channel, which still responds there.
    return [] if gains is None else [(gains, float(np.clip(gamma_v, *task.tempo_range)))]
