"""Measures candidates by simulation over starts: what every ranking rests on."""

from __future__ import annotations

import math
import statistics
from collections.abc import Iterator, Sequence
from concurrent.futures import Executor
from typing import TYPE_CHECKING

from ..models.equations import Plant, State
from ..models.errors import UndecidedError
from ..models.fleet import floats
from .rollout import Rollout, Settling, Tolerance

if TYPE_CHECKING:
    from .design import Candidate, Task

WORST_SHARE = 0.3  # of the worst start in the cost, beside the mean
HALF_SHARE = 0.1  # of the time to half the tolerance: it keeps the tail from being traded away

Measured = list[Settling]  # for every start
Job = tuple[Plant, "Candidate", Sequence[State], float, Tolerance]


def measure_all(
    task: Task, candidates: Sequence[Candidate], starts: Sequence[State], horizon: float, executor: Executor | None
) -> Iterator[Measured]:
    """The measurements of candidates in turn, over common starts, in other processes where there is an executor."""
    jobs: list[Job] = [(task.plant, candidate, starts, horizon, task.tolerance) for candidate in candidates]
    return executor.map(measure, jobs) if executor else map(measure, jobs)


def measure(job: Job) -> Measured:
    """How the fleet settles from every start; never, where the integrator gave up."""
    plant, candidate, starts, horizon, tolerance = job
    rollout = Rollout(plant, candidate.excitation)
    gains = candidate.gains.map(floats)
    measured = []
    for start in starts:
        try:
            measured.append(rollout.settling(gains, start, horizon, tolerance))
        except UndecidedError:  # such gains are of no use to anybody
            measured.append(Settling(math.inf, math.inf, math.inf))
    return measured


def cost(measured: Measured, horizon: float) -> float:
    """Mean settling time, with a share of the worst and of the mean to half the tolerance, s."""
    times = [_counted(run.time, run.excess, horizon) for run in measured]
    halves = [_counted(run.half, 2 * run.excess, horizon) for run in measured]
    return statistics.fmean(times) + WORST_SHARE * max(times) + HALF_SHARE * statistics.fmean(halves)


def _counted(time: float, excess: float, horizon: float) -> float:
    """A start that did not settle counts beyond the horizon, the more the further away it ended."""
    return time if math.isfinite(time) else horizon * (1 + math.log(min(max(excess, 1.0), 1e6)))
