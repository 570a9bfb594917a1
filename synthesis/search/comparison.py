"""Costs of points over common starts, each simulated only as far as the best so far makes worth while."""

from __future__ import annotations

import math
from collections.abc import Sequence
from concurrent.futures import Executor

import numpy as np

from ...models.starts import Draw
from ..cost import cost
from ..measurement import StartSet, controls_of, measure_all
from ..rollouts.columns import Setup
from ..rollouts.runge_kutta import Array
from ..task import Proposal, Task


class Comparison:
    """Simulates proposals over common starts, and counts the work.

    The strategies learn from the training starts; new candidates are compared over the held-out ones.
    """

    def __init__(self, task: Task, executor: Executor | None) -> None:
        settings = task.settings
        self.task, self.settings, self.executor = task, settings, executor
        self.least = math.inf  # cost so far over the held-out starts, s; before that, in the exploration
        self.work = 0.0  # evaluations of one vehicle's controller so far
        self._training = task.far_starts(Draw.TRAINING, settings.training_starts)
        self._training_near = task.near_starts(Draw.TRAINING, settings.training_starts)
        heldout = task.far_starts(Draw.COMPARISON, settings.heldout_starts)
        near = task.near_starts(Draw.COMPARISON, settings.near_count(heldout.shape[-1]))
        self._heldout = StartSet.both(heldout, near)
        self._next = 0  # of the training starts
        way = task.half_width / float(np.min(task.data.speed))
        self.shortest = way + settings.first_horizon * task.typical.time  # horizon, s, that the exploration begins with
        self.longest = way + settings.longest_horizon * task.typical.time

    @property
    def share(self) -> float:
        """How much of the work is done; 1 or more when it is used up."""
        return self.work / self.settings.work

    def compared(self, proposals: Sequence[Proposal]) -> Array:
        """Costs (s) over the held-out starts."""
        horizon = min(self.longest, self.settings.compared_horizon * self.least)
        costs = self._costs(proposals, self._heldout, horizon)
        self.least = min([self.least, *costs])
        return costs

    def explored(self, proposals: Sequence[Proposal], horizon: float) -> Array:
        """Costs (s) over a few starts, up to a horizon in s, with a part of the friction."""
        starts = self._next_starts(self.settings.explored_starts, again=True)
        return self._costs(proposals, starts, horizon, self.task.eased)

    def learned(self, proposals: Sequence[Proposal]) -> Array:
        """Costs (s) over the next training starts."""
        horizon = min(self.longest, self.settings.learned_horizon * self.least)
        return self._costs(proposals, self._next_starts(self.settings.learned_starts), horizon)

    def _next_starts(self, count: int, again: bool = False) -> StartSet:
        """The next training starts, far and near; the same `again`."""
        far, near = self._training, self._training_near
        chosen = [(self._next + k) % far.shape[-1] for k in range(min(count, far.shape[-1]))]
        chosen_near = [(self._next + k) % near.shape[-1] for k in range(self.settings.near_count(count))]
        self._next += 0 if again else count
        return StartSet.halves(far[..., chosen], near[..., chosen_near])

    def _costs(
        self, proposals: Sequence[Proposal], starts: StartSet, horizon: float, setup: Setup | None = None
    ) -> Array:
        if not proposals:
            return np.zeros(0)
        outcomes = measure_all(setup or self.task.setup, controls_of(proposals), starts, horizon, self.executor)
        self.work += float(outcomes.work.sum())
        return cost(outcomes.time, outcomes.excess, horizon, self.settings)
