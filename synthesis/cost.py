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

from ..models.arrays import floats
from ..models.equations import Plant, State
from ..models.errors import UndecidedError
from ..models.tolerance import Tolerance
from .modes import MODES, modes
from .rollouts.settling import MAX_STEPS, Settling, Trial, settle_all
from .rollouts.tail_times import tail_times

if TYPE_CHECKING:
    from .design import Candidate, Task

TAIL_POWER = 0.25  # of the tail in the cost: a start that ends its way across the track must not take long
SHORTEST = 0.1  # s, as which shorter times count
TAIL_FROM = 1.0  # m, across the track
TAIL_TO = 0.5  # of the tolerance
TAIL_VEHICLES = 640  # in all modes that it is followed from: a large fleet is followed from the slowest alone
LONGEST_TAIL = 1e5  # s, as which a longer one counts
JOB_VEHICLES = 16_384  # simulated in one job, all its rollouts together


class Run(NamedTuple):
    """What simulation and the averaged flow say of a candidate from one start."""

    time: float  # s, from which on the fleet is settled; inf where not by the horizon
    excess: float  # the largest error over its tolerance at the end
    steps: int = 0  # of integration that it took
    tail: float = 0.0  # s, across the track by the averaged flow, of the candidate from any start


NEVER = Run(math.inf, math.inf)
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
    tails = _tails(plant, trials, tolerance)
    return [[_run(one, tail) for one in row] for row, tail in zip(settled, tails, strict=True)]


def _tails(plant: Plant, trials: Sequence[Trial], tolerance: Tolerance) -> list[float]:
    """How long TAIL_FROM across the track takes into TAIL_TO of the tolerance under every trial, s: at the worst.

    Of the graph's slowest modes and as many random shapes, for gains are soon found that are fast from a few shapes
    alone; and far in, where what is left has taken the slowest shape of these gains.
    """
    vehicles = plant.graph.vehicles
    slow = modes(plant.graph, max(1, min(MODES, TAIL_VEHICLES // vehicles))).vectors
    random = np.random.default_rng(0).standard_normal((vehicles, slow.shape[1] if slow.shape[1] > 1 else 0))
    shapes = np.hstack([slow, random])
    y = TAIL_FROM * shapes / np.abs(shapes).max(axis=0)
    column = np.repeat(np.arange(len(trials)), shapes.shape[1]).tolist()
    goal = Tolerance(TAIL_TO * tolerance.position, TAIL_TO * tolerance.heading)
    times = tail_times(plant, trials, column, np.tile(y, len(trials)), goal).reshape(len(trials), -1)
    longest: list[float] = np.minimum(times, LONGEST_TAIL).max(axis=1).tolist()
    return longest


def _run(settling: Settling | None, tail: float) -> Run:
    if settling is None:
        return NEVER._replace(tail=tail)
    return Run(settling.time, settling.excess, settling.steps, tail)


def cost(runs: Sequence[Run], horizon: float) -> float:
    """The typical settling time and the tail, which any start may meet, as a weighted geometric mean, s.

    Most starts of a fast fleet end within the tolerance or nearly so, and a few meet the tail: too few to be seen
    among some dozens, so that only the tail itself can be kept short. A per cent of it weighs the same in fast and in
    slow fleets, and no short tail makes up for starts that do not settle.
    """
    times = [_counted(run.time, run.excess, horizon) for run in runs]
    tail = statistics.fmean(run.tail for run in runs)
    settling, tail = (max(SHORTEST, time) for time in (_typical(times), tail))
    weighted: float = settling ** (1 - TAIL_POWER) * tail**TAIL_POWER
    return weighted


def _typical(times: Iterable[float]) -> float:
    """The mean of the square roots, squared: a few starts are late by decades, and would hide all others in noise."""
    return statistics.fmean(map(math.sqrt, times)) ** 2


def _counted(time: float, excess: float, horizon: float) -> float:
    """A start that did not settle counts beyond the horizon, the more the further away it ended."""
    return time if math.isfinite(time) else horizon * (1 + math.log(min(max(excess, 1.0), 1e6)))
