"""When fleets settle: rollouts of the closed loop from many starts under many controllers, side by side.

Each rollout is a column with its own gains, scales and frequency of psi. In single precision and to two digits they
rank candidates; `verify` integrates a design anew.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ...models.deadline import Deadline
from .closed_loop import Controls
from .columns import Columns, Setup
from .runge_kutta import Array

UNCHANGED = 1e-6  # relative change of a squared error that single precision does not tell from none


class Outcomes(NamedTuple):
    """The outcomes of rollouts, (controllers, starts)."""

    time: Array  # s, from which all vehicles stay within the tolerance; inf where not by the horizon
    excess: Array  # the largest error over its tolerance at the end; inf where an integration broke down
    work: Array  # evaluations of the controller of one vehicle


def settle_all(kind: type[Columns], setup: Setup, controls: Controls, starts: Array, horizon: float) -> Outcomes:
    """How the fleet settles under every controller from all starts (5, N, S) by the horizon (s).

    `kind` says by which integrator. A rollout does not depend on those beside it.
    """
    fleets, count = len(controls.frequency), starts.shape[-1]
    controller, start = np.repeat(np.arange(fleets), count), np.tile(np.arange(count), fleets)
    outcomes = Outcomes(*(np.full(fleets * count, value) for value in (math.inf, math.inf, 0.0)))
    width, deadline = max(1, setup.settings.simulated_vehicles // setup.vehicles), Deadline(setup.settings.seconds)
    for begin in range(0, len(controller), width):
        if deadline.passed:
            break
        chosen = np.arange(begin, min(begin + width, len(controller)))
        columns = kind(setup, controls.take(controller[chosen]), starts[..., start[chosen]])
        period = 2 * math.pi / controls.frequency[controller[chosen]].astype(float)
        _settle(columns, setup, horizon, period, Outcomes(*(column[chosen[0] : chosen[-1] + 1] for column in outcomes)))
    return Outcomes(*(column.reshape(fleets, count) for column in outcomes))


def _settle(columns: Columns, setup: Setup, horizon: float, period: Array, outcomes: Outcomes) -> None:
    """Let columns run until all have settled or are late, and write what became of them into `outcomes`."""
    settings, at = setup.settings, np.arange(len(period))
    most = max(1.0, horizon / setup.disturbance.sample_time)  # steps of one rollout
    steps, standing = 0, _Standing(len(period))
    while len(at):
        columns.advance(settings.steps_between_checks)
        steps += settings.steps_between_checks
        t, last, failed = (np.asarray(column, dtype=float) for column in (columns.t, columns.last, columns.failed))
        hold = settings.settled_periods * period[at] + settings.settled_share * t
        failed = failed.astype(bool)
        settled = (t - last > hold) & ~failed
        held = standing.outside(columns.far, t) > settings.settled_periods * period[at]
        done = settled | failed | held | (t >= horizon) | (steps >= most)
        if not done.any():
            continue
        outcomes.time[at[settled]] = last[settled]
        outcomes.excess[at[done & ~failed]] = np.sqrt(columns.far[done & ~failed])
        outcomes.work[at[done]] = columns.cost * setup.vehicles * steps
        at = at[~done]
        if len(at):
            columns.keep(~done)
            standing.keep(~done)


class _Standing:
    """For how long the largest error of each column has not changed at all while outside the tolerance."""

    def __init__(self, count: int) -> None:
        self._far, self._since = np.full(count, np.nan), np.zeros(count)

    def outside(self, far: Array, t: Array) -> Array:
        """Seconds for which it has not, up to the time t."""
        moves = ~(np.abs(far - self._far) <= UNCHANGED * far) | (far <= 1)
        self._far, self._since = np.array(far, dtype=float), np.where(moves, t, self._since)
        return np.asarray(t - self._since)

    def keep(self, stay: Array) -> None:
        """Only these columns go on."""
        self._far, self._since = self._far[stay], self._since[stay]
