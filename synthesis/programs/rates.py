"""The fastest exponential rates by linear matrix inequalities (cvxpy, Clarabel), and the proposals that they give."""

from __future__ import annotations

import logging
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...models.arrays import floats
from ...models.conditions import ConditionData
from ...models.equations import Plant
from ...models.errors import UndecidedError
from ...models.gains import Gains
from ...models.saturation import Saturation
from ..settings import FAST
from ..task import Proposal, Task
from .cones import nearest
from .solvers import clarabel_finds_optimum

Floats = NDArray[np.float64]

LOG = logging.getLogger(__name__)
DENSE_VEHICLES = 60  # beyond, the matrix inequalities take too long for a proposal
TRANSLATION_SHARES = (0.3, 0.6)  # of the torque limit
EXCITATION = 1.0  # sqrt2 k psi_bar / p_omega that the heading channel is given room for
BISECTIONS = 14  # of ln gamma: 27.6 wide at first, 0.2 % of gamma at last
DIGITS = 4  # significant digits of a proposal: what processors round differently is far below


@dataclass(frozen=True)
class Channel:
    """A second-order channel M s'' + C s' + L_l s = 0 of local gains, and what is left to it of the torque.

    With a time unit, M (in its square) and C are numbers: inertia and damping over p in the local gains p / scale and
    d / rate_scale.
    """

    inertia: Floats  # (N,), kg or kg m^2
    degree: Floats  # (N,)
    proportional_cost: Floats  # (N,), torque per unit of p, N m
    damping_cost: Floats  # (N,), torque per unit of d, N m
    torque: Floats  # (N,), N m
    scale: Any = 1.0  # l or rho
    rate_scale: Any = 1.0  # s or o, (N,) or one number
    time: float = 1.0  # s

    @property
    def damping(self) -> Any:
        """d / p per unit of C."""
        return self.time * self.rate_scale / self.scale

    @property
    def stiffness(self) -> Any:
        """p times M."""
        return self.inertia * self.scale / self.time**2


def translation(plant: Plant, data: ConditionData, share: float, saturation: Saturation, time: float = 1.0) -> Channel:
    """The along-track channel, with a share of the torque limit; its part of (16). `time` (s) is its unit."""
    unit = data.r / 2
    cost, torque = unit * np.sqrt(2) * data.degree, share * data.torque
    return Channel(plant.m, data.degree, cost, unit, torque, saturation.position, saturation.speed, time)


def rotation(plant: Plant, data: ConditionData, share: float, saturation: Saturation, time: float = 1.0) -> Channel:
    """The heading channel, with a share of the torque limit; its part of (16). `time` (s) is its unit.

    The excitation costs EXCITATION times what the heading error does.
    """
    unit = data.r / (2 * data.arm)
    cost, torque = unit * data.degree * (1 + EXCITATION), share * data.torque
    return Channel(plant.inertia, data.degree, cost, unit, torque, saturation.heading, saturation.turn_rate, time)


def fastest(
    channel: Channel, laplacian: Floats, ratio: float = 0.0, seconds: float = FAST.clarabel_seconds
) -> tuple[float, Floats, Floats] | None:
    """(gamma in 1/s, p, d) of the largest certified rate within the torque, by bisection on a matrix inequality.

    The variables 1/p and d/p make C - 2 gamma M >= 0, L_l - gamma C + gamma^2 M >= 0 and the torque linear for a fixed
    gamma. `ratio` also requires d >= ratio p D, as (15) and (15') do for a given excitation. `seconds` limits each
    solve. None if Clarabel reports no optimal gains. Raises UndecidedError if it breaks down.
    """
    low, high, best = 1e-6, 1e6, None
    for _ in range(BISECTIONS):
        middle = math.sqrt(low * high)
        found = _feasible(channel, laplacian, ratio, middle, seconds)
        low, high, best = (low, middle, best) if found is None else (middle, high, found)
    return None if best is None else (low / channel.time, *best)


def _feasible(
    channel: Channel, laplacian: Floats, ratio: float, gamma: float, seconds: float
) -> tuple[Floats, Floats] | None:
    """Gains (p, d) with rate gamma (per time unit), None where there are none.

    The solver's status only chooses; certificates check.
    """
    import cvxpy as cp

    count = len(channel.inertia)
    M, C = cp.Variable(count, pos=True), cp.Variable(count, pos=True)
    room = cp.Variable()
    damping = np.broadcast_to(channel.damping, count)
    spent = 1 + cp.multiply(channel.damping_cost * damping / channel.proportional_cost, C)
    problem = cp.Problem(
        cp.Maximize(room),
        [
            2 * gamma * M + room <= C,
            laplacian - gamma * cp.diag(C) + gamma**2 * cp.diag(M) >> room * np.eye(count),
            spent <= cp.multiply(channel.torque / (channel.stiffness * channel.proportional_cost), M),
            ratio * channel.degree / damping <= C,
            room <= 1,
        ],
    )
    if not clarabel_finds_optimum(problem, seconds) or room.value < 0 or min(np.min(M.value), np.min(C.value)) <= 0:
        return None
    p = channel.stiffness / M.value
    return p, damping * C.value * p


def convex_designs(task: Task) -> list[Proposal]:
    """Proposals with the fastest heading and along-track rates at the typical scales; none for large fleets."""
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


def _designs(task: Task, share: float) -> list[Proposal]:
    """The design with a share of the torque for the translation, if Clarabel finds it."""
    seconds, time = task.settings.clarabel_seconds, float(task.typical.time)
    saturation = task.typical.saturation if task.saturation is None else task.saturation.map(floats)
    laplacian = task.plant.graph.composed_laplacian().toarray()
    k_ratio = EXCITATION / (math.sqrt(2) * float(task.data.psi_bar))
    along = fastest(translation(task.plant, task.data, share, saturation, time), laplacian, seconds=seconds)
    turning = rotation(task.plant, task.data, 1 - share, saturation, time)
    heading = fastest(turning, laplacian, EXCITATION / math.tanh(1), seconds)
    if along is None or heading is None:
        return []
    (gamma_v, p_v, d_v), (_, p_omega, d_omega) = along, heading
    target = Gains(p_v, d_v, p_omega, d_omega, k_ratio * p_omega, saturation)
    gains = nearest(task.conditions, task.data, target, seconds)
    if gains is None:
        return []
    # psi moves the vehicles best where the along-track channel still answers: about its own rate.
    frequency = gamma_v if task.excitation_designed else float(task.excitation.frequency)
    rounded = gains.map(lambda column: snapped(column, DIGITS))
    return [Proposal("convex programs", task.within(rounded), float(snapped(frequency, DIGITS)))]


def snapped(values: Any, digits: int) -> Any:
    """Numbers rounded to so many significant digits."""
    return np.vectorize(lambda value: float(f"{float(value):.{digits}g}"))(values)
