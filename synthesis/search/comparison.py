"""Costs of candidates over common starts, each simulated only as far as the best so far makes worth while."""

from __future__ import annotations

import math
import statistics
from collections.abc import Iterator, Sequence
from concurrent.futures import Executor

from ...models.equations import State
from ...models.starts import Draw
from ..cost import Run, cost
from ..measurement import measure_all
from ..rollouts.settling import Limits
from ..settings import Bounds
from ..task import Candidate, Task
from .candidates import Compared


class Comparison:
    """Simulates candidates over common starts.

    The strategies learn from the training starts; new candidates are compared over the held-out ones.
    """

    def __init__(self, task: Task, horizon: float, executor: Executor | None) -> None:
        settings = task.settings
        self.task, self.settings = task, settings
        most = settings.searched_starts_vehicles
        self.training: Sequence[State] = task.starts(Draw.TRAINING, settings.training_starts, most)
        self.heldout: Sequence[State] = task.starts(Draw.COMPARISON, settings.heldout_starts, most)
        self._horizon, self._executor = horizon, executor
        self.least, self._steps = math.inf, settings.most_steps  # mean settling time (s), most steps of the best so far
        self._best, self._starts = math.inf, 0  # its cost, s, and the number of starts that it was measured from
        self._next = 0  # of the training starts

    def compared(self, candidates: Sequence[Candidate]) -> list[Compared]:
        """The candidates with their costs over the held-out starts."""
        return list(zip(self._costs(candidates, self.heldout, self.settings.compared), candidates, strict=True))

    def explored(self, candidates: Sequence[Candidate]) -> list[Compared]:
        """The candidates with their costs over a few starts."""
        starts = self.training[: self.settings.exploration_starts]
        return list(zip(self._costs(candidates, starts, self.settings.tried), candidates, strict=True))

    def learned(self, candidates: Sequence[Candidate], count: int) -> Iterator[float]:
        """The costs of candidates over the next `count` training starts, or all where there are no more."""
        every, begin = self.training, self._next
        count = min(count, len(every))
        self._next = (begin + count) % len(every)
        starts = [every[(begin + k) % len(every)] for k in range(count)]
        return iter(self._costs(candidates, starts, self.settings.learned))

    def _costs(self, candidates: Sequence[Candidate], starts: Sequence[State], bounds: Bounds) -> list[float]:
        horizon = min(self._horizon, bounds.horizon * self.least)
        steps = min(self.settings.most_steps, round(bounds.steps * self._steps))
        limits = Limits(horizon, bounds.abandon_above * self.least, steps)
        measured = list(measure_all(self.task, candidates, starts, limits, self._executor))
        costs = [cost(runs, horizon, self.settings) for runs in measured]
        self._follow(costs, measured, horizon)
        return costs

    def _follow(self, costs: Sequence[float], measured: Sequence[Sequence[Run]], horizon: float) -> None:
        """Take the cheapest from the most starts so far as the best: the best from few of them is the luckiest."""
        value, runs = min(zip(costs, measured, strict=True), key=lambda pair: pair[0], default=(math.inf, ()))
        steps = max((run.steps for run in runs), default=0)
        if steps and (-len(runs), value) < (-self._starts, self._best):
            self._starts, self._best, self._steps = len(runs), value, steps
            mean = statistics.fmean(min(run.time, horizon) for run in runs)
            self.least = max(self.settings.least_mean, mean)
