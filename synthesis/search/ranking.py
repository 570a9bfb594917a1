"""The final ranking: rounded candidates over common starts that the search has not seen."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace

import numpy as np

from ...models.errors import UndecidedError
from ...models.starts import Draw
from ..cost import cost
from ..measurement import StartSet, controls_of, measure_all
from ..rollouts.columns import Setup
from ..rollouts.runge_kutta import Array
from ..task import Candidate, Progress, Proposal, Task

LOG = logging.getLogger(__name__)

STEPS_PER_DECADE = 10  # of the sample times that are tried
DECADES = 2  # that they go up or down from the fleet's own
PATIENCE = 3.0  # times the worst settling time of the fleet's own sample time, for others


@dataclass(frozen=True, eq=False)
class Ranked:
    """The best candidate and what was measured of it."""

    candidate: Candidate
    settling: tuple[float, ...]  # s, from the ranking starts, with continuous torques; inf where not settled
    settling_held: tuple[float, ...]  # the same with torques that are held and the other disturbances
    largest_sample_time: float | None  # s, at which all ranking starts settle; None where none is known


def best_of(task: Task, proposals: Sequence[Proposal], executor: Executor | None, progress: Progress) -> Ranked:
    """The best of some proposals, rounded. Raises UndecidedError where rounding leaves none of them."""
    candidates = rounded(task, proposals)
    far = task.far_starts(Draw.RANKING, task.settings.ranking_starts)
    near = task.near_starts(Draw.RANKING, task.settings.near_count(far.shape[-1]))
    starts = StartSet.both(far, near)
    progress("ranking candidates by simulation", 0.0)
    horizon, costs, time = _settled(task, candidates, starts, executor)
    best = int(np.argmin(costs))
    count = far.shape[-1]
    worst = float(time[best].max(initial=0, where=np.isfinite(time[best])))
    horizon = min(horizon, PATIENCE * worst)
    progress("measuring the largest sample time", 0.5)
    return Ranked(
        candidate=candidates[best],
        settling=tuple(time[best, :count].tolist()),
        settling_held=tuple(time[best, count : 2 * count].tolist()),
        largest_sample_time=largest_sample_time(task, candidates[best], far, horizon, executor),
    )


def rounded(task: Task, proposals: Sequence[Proposal]) -> list[Candidate]:
    """The candidates of those proposals that can be rounded. Raises UndecidedError where there are none."""
    candidates = []
    for proposal in proposals:
        try:
            candidates.append(task.rounded(proposal))
        except UndecidedError as error:
            LOG.warning("%s: a candidate is left out: %s", proposal.origin, error)
            failure = error
    if not candidates:
        raise failure
    return candidates


def _settled(
    task: Task, candidates: Sequence[Candidate], starts: StartSet, executor: Executor | None
) -> tuple[float, Array, Array]:
    """A horizon (s), and costs (C,) and times (C, S) up to it: so long that the best settles, if it does in time."""
    settings, controls = task.settings, controls_of(candidates)
    way = task.half_width / float(np.min(task.data.speed))
    horizon = way + settings.first_horizon * task.typical.time
    longest = way + settings.longest_horizon * task.typical.time
    work = 0.0
    while True:
        outcomes = measure_all(task.setup, controls, starts, horizon, executor)
        work += float(outcomes.work.sum())
        costs = cost(outcomes.time, outcomes.excess, horizon, settings)
        late = np.isinf(outcomes.time[np.argmin(costs)]).any()
        enough = horizon >= min(longest, settings.ranked_horizon * costs.min()) or work > settings.ranking_work
        if not late or enough:
            return horizon, costs, outcomes.time
        horizon = min(2 * horizon, longest)


def largest_sample_time(
    task: Task, candidate: Candidate, far: Array, horizon: float, executor: Executor | None
) -> float | None:
    """The largest of some sample times up to which all starts settle by the horizon (s); None where none does.

    The sample times are the fleet's own, multiplied or divided by powers of 10^(1/10). Shorter ones are bisected.
    """
    controls, nowhere = controls_of([candidate]), far[..., :0]

    def settles(step: int) -> bool:
        factor = round(10 ** (step / STEPS_PER_DECADE), 2)
        outcomes = measure_all(_resampled(task.setup, factor), controls, StartSet(nowhere, far), horizon, executor)
        return bool(np.isfinite(outcomes.time).all())

    def sample_time(step: int) -> float:
        return _resampled(task.setup, round(10 ** (step / STEPS_PER_DECADE), 2)).disturbance.sample_time

    most = STEPS_PER_DECADE * DECADES
    if settles(0):
        last = next((step - 1 for step in range(1, most) if not settles(step)), most - 1)
        return sample_time(last)
    if not settles(-most):
        return None
    low, high = -most, 0
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if settles(middle) else (low, middle)
    return sample_time(low)


def _resampled(setup: Setup, factor: float) -> Setup:
    """The same robots with another sample time."""
    old = setup.disturbance
    delay = round(old.delay / factor)
    return replace(setup, disturbance=replace(old, sample_time=factor * old.sample_time, delay=delay))
