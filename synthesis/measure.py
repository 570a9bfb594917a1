"""Measures candidates by simulation over starts: what every ranking rests on."""

from __future__ import annotations

import math
import os
import statistics
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, Executor
from contextlib import contextmanager
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

FINER = 4  # parts of the tolerance, one of which is the finer one
FINER_POWER = 0.1  # of the time to it in the cost: what comes after settling must not be traded away
TAIL_POWER = 0.1  # of the tail: a start that just misses the tolerance must not take long
MOST_TAILS = 16  # random errors from which it is followed
TAIL_VEHICLES = 640  # in all of them together: a large fleet is followed from one
SHORTEST = 0.1  # s, as which shorter times count
LONGEST_TAIL = 1e5  # s, as which a longer one counts
JOB_VEHICLES = 16_384  # simulated in one job, all its rollouts together
LONGEST_FINER = 10.0  # horizons, as which a longer time to the finer tolerance counts


class Run(NamedTuple):
    """What simulation and the averaged flow say of a candidate from one start."""

    time: float  # s, from which on the fleet is settled; inf where not by the horizon
    finer: float  # s, the same for the tolerance over FINER, followed by the averaged flow once the fleet is settled
    excess: float  # the largest error over its tolerance at the end
    steps: int = 0  # of integration that it took
    tail: float = 0.0  # s, from the tolerance to the finer one by the averaged flow, of the candidate from any start


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
    with answering():
        for found in executor.map(measure, jobs) if executor else map(measure, jobs):
            yield from found


@contextmanager
def answering() -> Iterator[None]:
    """While an executor is asked: a worker that dies is an UndecidedError."""
    try:
        yield
    except BrokenExecutor:
        raise UndecidedError("design: a worker process died or took too long; run the same command again") from None


def measure(job: Job) -> list[list[Run]]:
    """How the fleet settles under every candidate from every start; never, where the integrator gave up."""
    plant, candidates, starts, horizon, tolerance, hopeless, steps = job
    trials = [Trial(candidate.gains.map(floats), candidate.excitation) for candidate in candidates]
    settled = settle_all(plant, trials, starts, horizon, tolerance, hopeless, steps)
    later = [(k, settling) for k, row in enumerate(settled) for settling in row if settling and _goes_on(settling)]
    times, tails = iter(_later(plant, trials, later, tolerance)), _tails(plant, trials, tolerance)
    return [[_run(one, times, tail) for one in row] for row, tail in zip(settled, tails, strict=True)]


def _goes_on(settling: Settling) -> bool:
    """Whether it ended within the tolerance, but not within the finer one."""
    return math.isfinite(settling.time) and settling.excess > 1 / FINER


def _later(
    plant: Plant, trials: Sequence[Trial], ends: Sequence[tuple[int, Settling]], tolerance: Tolerance
) -> list[float]:
    """When fleets that go on, each under a trial, are within the finer tolerance, s: by the averaged flow."""
    if not ends:
        return []
    x, y = np.array([(settling.final.x, settling.final.y) for _, settling in ends]).transpose(1, 2, 0)
    away = x - (plant.offset_x + plant.leader_x)[:, None], y - (plant.offset_y + plant.leader_y)[:, None]
    side = across(numpy_ops(), plant.leader_theta, *away)
    tails = tail_times(plant, trials, [trial for trial, _ in ends], side, _finer(tolerance)).tolist()
    return [end.end + tail for (_, end), tail in zip(ends, tails, strict=True)]


def _tails(plant: Plant, trials: Sequence[Trial], tolerance: Tolerance) -> list[float]:
    """How long cross-track errors as large as the tolerance take to fall to the finer one under every trial, s.

    The mean over a few random ones: unlike what simulations say, nothing in it is chance that differs between trials.
    """
    count = min(MOST_TAILS, math.ceil(TAIL_VEHICLES / plant.graph.vehicles))
    y = np.random.default_rng(0).standard_normal((plant.graph.vehicles, count))
    y *= tolerance.position / np.abs(y).max(axis=0)
    column = np.repeat(np.arange(len(trials)), count).tolist()
    times = tail_times(plant, trials, column, np.tile(y, len(trials)), _finer(tolerance))
    means: list[float] = np.minimum(times, LONGEST_TAIL).reshape(len(trials), count).mean(axis=1).tolist()
    return means


def _finer(tolerance: Tolerance) -> Tolerance:
    return Tolerance(tolerance.position / FINER, tolerance.heading / FINER)


def _run(settling: Settling | None, later: Iterator[float], tail: float) -> Run:
    if settling is None:
        return NEVER._replace(tail=tail)
    finer = next(later) if _goes_on(settling) else settling.time
    return Run(settling.time, finer, settling.excess, settling.steps, tail)


def cost(runs: Sequence[Run], horizon: float) -> float:
    """The typical settling time, the typical time to the finer tolerance and the tail, as a weighted geometric mean, s.

    So a per cent of each weighs the same in fast and in slow fleets, where the latter two are decades longer.
    """
    times = [_counted(run.time, run.excess, horizon) for run in runs]
    finer = [max(time, min(run.finer, LONGEST_FINER * horizon)) for time, run in zip(times, runs, strict=True)]
    tail = statistics.fmean(min(run.tail, LONGEST_TAIL) for run in runs)
    settling, later, tail = (max(SHORTEST, time) for time in (_typical(times), _typical(finer), tail))
    weighted: float = settling ** (1 - FINER_POWER - TAIL_POWER) * later**FINER_POWER * tail**TAIL_POWER
    return weighted


def _typical(times: Iterable[float]) -> float:
    """The mean of the square roots, squared: a few starts are late by decades, and would hide all others in noise."""
    return statistics.fmean(map(math.sqrt, times)) ** 2


def _counted(time: float, excess: float, horizon: float) -> float:
    """A start that did not settle counts beyond the horizon, the more the further away it ended."""
    return time if math.isfinite(time) else horizon * (1 + math.log(min(max(excess, 1.0), 1e6)))
