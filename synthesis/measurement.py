"""Measures candidates by simulation over starts: what every ranking rests on."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Sequence
from concurrent.futures import BrokenExecutor, Executor
from contextlib import contextmanager
from typing import NamedTuple

import numpy as np

from ..models.arrays import floats
from ..models.equations import Plant, State
from ..models.errors import UndecidedError
from ..models.tolerance import Tolerance
from .cost import NEVER, Run
from .modes import MODES, modes
from .rollouts.settling import Limits, Settling, Trial, settle_all
from .rollouts.tail_times import tail_times
from .settings import Settings
from .task import Candidate, Task


class Job(NamedTuple):
    """Candidates to be measured in one process."""

    plant: Plant
    candidates: Sequence[Candidate]
    starts: Sequence[State]
    limits: Limits
    tolerance: Tolerance
    settings: Settings


def measure_all(
    task: Task, candidates: Sequence[Candidate], starts: Sequence[State], limits: Limits, executor: Executor | None
) -> Iterator[list[Run]]:
    """The measurements of candidates in turn, over common starts, in other processes where there is an executor."""
    columns = len(candidates) * len(starts) * len(task.fleet)
    cores = os.cpu_count() or 1 if executor else 1
    rounds = max(1, math.ceil(columns / (cores * task.settings.simulated_vehicles)))
    each = max(1, math.ceil(len(candidates) / (cores * rounds)))  # candidates of one job
    jobs = [
        Job(task.plant, candidates[k : k + each], starts, limits, task.tolerance, task.settings)
        for k in range(0, len(candidates), each)
    ]
    with worker_errors():
        for rows in executor.map(measure, jobs) if executor else map(measure, jobs):
            yield from rows


@contextmanager
def worker_errors() -> Iterator[None]:
    """While an executor is asked: a worker that dies is an UndecidedError."""
    try:
        yield
    except BrokenExecutor:
        raise UndecidedError("design: a worker process died or took too long; run the same command again") from None


def measure(job: Job) -> list[list[Run]]:
    """How the fleet settles under every candidate from every start; never, where the integrator gave up."""
    trials = [Trial(candidate.gains.map(floats), candidate.excitation) for candidate in job.candidates]
    settled = settle_all(job.plant, trials, job.starts, job.limits, job.tolerance, job.settings)
    tails = worst_tails(job.plant, trials, job.tolerance, job.settings)
    return [[_run(settling, tail) for settling in row] for row, tail in zip(settled, tails, strict=True)]


def worst_tails(plant: Plant, trials: Sequence[Trial], tolerance: Tolerance, settings: Settings) -> list[float]:
    """How long `tail_from` across the track takes into `tail_to` of the tolerance under every trial, s, at the worst.

    Of the graph's slowest modes and as many random shapes, because some gains are fast from a few shapes alone; and
    far into the tolerance, where what is left has taken the slowest shape of these gains.
    """
    vehicles = plant.graph.vehicles
    slow = modes(plant.graph, max(1, min(MODES, settings.tail_vehicles // vehicles))).vectors
    random = np.random.default_rng(0).standard_normal((vehicles, slow.shape[1] if slow.shape[1] > 1 else 0))
    shapes = np.hstack([slow, random])
    y = settings.tail_from * shapes / np.abs(shapes).max(axis=0)
    column = np.repeat(np.arange(len(trials)), shapes.shape[1]).tolist()
    goal = Tolerance(settings.tail_to * tolerance.position, settings.tail_to * tolerance.heading)
    times = tail_times(plant, trials, column, np.tile(y, len(trials)), goal).reshape(len(trials), -1)
    longest: list[float] = np.minimum(times, settings.longest_tail).max(axis=1).tolist()
    return longest


def _run(settling: Settling | None, tail: float) -> Run:
    if settling is None:
        return NEVER._replace(tail=tail)
    return Run(settling.time, settling.excess, settling.steps, tail)
