"""Measures candidates by simulation over starts: what every ranking rests on."""

from __future__ import annotations

import math
import os
import statistics
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, Executor
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..models.equations import Plant, State, across
from ..models.errors import UndecidedError
from ..models.fleet import floats
from ..models.ops import numpy_ops
from ..models.tolerance import Tolerance
from .batch import MAX_STEPS, Settling, Trial, settle_all
from .tails import tail_times

if TYPE_CHECKING:
    from .design import Candidate, Task

TAIL = 8  # the worst one start in so many is the tail: its mean is less a matter of chance than the worst
TAIL_SHARE = 0.25  # of the tail in the cost, beside the mean
FINER_SHARE = 0.03  # of the time to half the tolerance: what comes after settling must not be traded away
LATE = 6.0  # mean settling times: what a start needs beyond it for half the tolerance is late
LATE_SHARE = 0.6  # of the lateness in the tail; at most 1, or settling later would pay
JOB_VEHICLES = 16_384  # simulated in one job, all its rollouts together
LONGEST_FINER = 10.0  # horizons, as which a longer time to half the tolerance counts


class Run(NamedTuple):
    """What simulation and the averaged flow say of a candidate from one start."""

    time: float  # s, from which on the fleet is settled; inf where not by the horizon
    finer: float  # s, the same for half the tolerance, followed by the averaged flow once the fleet is settled
    excess: float  # the largest error over its tolerance at the end
    steps: int = 0  # of integration that it took


NEVER = Run(math.inf, math.inf, math.inf)
Job = tuple[Plant, Sequence["Candidate"], Sequence[State], float, Tolerance, float, int]


def measure_all(
    task: Task,
    candidates: Sequence[Candidate],
    starts: Sequence[State],
    horizon: float,
    executor: Executor | None,
    hopeless: float = math.inf,
    steps: int = MAX_STEPS,
) -> Iterator[list[Run]]:
    """The measurements of candidates in turn, over common starts, in other processes where there is an executor.

    A candidate whose mean settling time is beyond `hopeless` (s) whatever the rest does is not run to the end, and no
    rollout takes more than so many steps.
    """
    columns = len(candidates) * len(starts) * len(task.fleet)
    cores = os.cpu_count() or 1 if executor else 1
    rounds = max(1, math.ceil(columns / (cores * JOB_VEHICLES)))
    each = max(1, math.ceil(len(candidates) / (cores * rounds)))  # candidates of one job
    jobs: list[Job] = [
        (task.plant, candidates[k : k + each], starts, horizon, task.tolerance, hopeless, steps)
        for k in range(0, len(candidates), each)
    ]
    try:
        for found in executor.map(measure, jobs) if executor else map(measure, jobs):
            yield from found
    except BrokenExecutor:
        raise UndecidedError("design: a worker process died or took too long; run the same command again") from None


def measure(job: Job) -> list[list[Run]]:
    """How the fleet settles under every candidate from every start; never, where the integrator gave up."""
    plant, candidates, starts, horizon, tolerance, hopeless, steps = job
    trials = [Trial(candidate.gains.map(floats), candidate.excitation) for candidate in candidates]
    settled = settle_all(plant, trials, starts, horizon, tolerance, hopeless, steps)
    later = [(k, settling) for k, row in enumerate(settled) for settling in row if settling and _goes_on(settling)]
    times = iter(_later(plant, trials, later, tolerance))
    return [[_run(settling, times) for settling in row] for row in settled]


def _goes_on(settling: Settling) -> bool:
    """Whether it ended within the tolerance, but not within half of it."""
    return math.isfinite(settling.time) and settling.excess > 0.5


def _later(
    plant: Plant, trials: Sequence[Trial], ends: Sequence[tuple[int, Settling]], tolerance: Tolerance
) -> list[float]:
    """When fleets that go on, each under a trial, are within half the tolerance, s: by the averaged flow."""
    if not ends:
        return []
    x, y = np.array([(settling.final.x, settling.final.y) for _, settling in ends]).transpose(1, 2, 0)
    away = x - (plant.offset_x + plant.leader_x)[:, None], y - (plant.offset_y + plant.leader_y)[:, None]
    side = across(numpy_ops(), plant.leader_theta, *away)
    half = Tolerance(tolerance.position / 2, tolerance.heading / 2)
    tails = tail_times(plant, trials, [trial for trial, _ in ends], side, half).tolist()
    return [end.end + tail for (_, end), tail in zip(ends, tails, strict=True)]


def _run(settling: Settling | None, later: Iterator[float]) -> Run:
    if settling is None:
        return NEVER
    finer = next(later) if _goes_on(settling) else settling.time
    return Run(settling.time, finer, settling.excess, settling.steps)


def cost(runs: Sequence[Run], horizon: float) -> float:
    """Mean settling time with shares of the tail's, of the times to half the tolerance and of what is late there, s."""
    times = [_counted(run.time, run.excess, horizon) for run in runs]
    finer = [max(time, min(run.finer, LONGEST_FINER * horizon)) for time, run in zip(times, runs, strict=True)]
    mean = statistics.fmean(times)
    # Late starts are few, and by how much is a matter of decades: as a logarithm, one of them does not decide.
    late = mean * _tail(math.log(max(1.0, time / (LATE * mean))) for time in finer) if mean else 0.0
    return mean + TAIL_SHARE * _tail(times) + FINER_SHARE * statistics.fmean(finer) + LATE_SHARE * late


def _tail(values: Iterable[float]) -> float:
    """The mean of the largest one in TAIL."""
    ordered = sorted(values)
    return statistics.fmean(ordered[-math.ceil(len(ordered) / TAIL) :])


def _counted(time: float, excess: float, horizon: float) -> float:
    """A start that did not settle counts beyond the horizon, the more the further away it ended."""
    return time if math.isfinite(time) else horizon * (1 + math.log(min(max(excess, 1.0), 1e6)))
