"""Measures controllers by simulation over starts: what every ranking rests on."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Sequence
from concurrent.futures import BrokenExecutor, Executor
from contextlib import contextmanager
from typing import NamedTuple

import numpy as np

from ..models.arrays import floats
from ..models.errors import UndecidedError
from .rollouts.closed_loop import Controls
from .rollouts.columns import Columns, Setup
from .rollouts.continuous import Continuous
from .rollouts.runge_kutta import Array
from .rollouts.sampled import Sampled
from .rollouts.settling import Outcomes, settle_all
from .task import Candidate, Proposal


class StartSet(NamedTuple):
    """Starts for the ideal robot and for the one whose torques are held, (5, N, S) singles each.

    From the near ones the fleet has to settle within a part of the tolerance (`Setup.near`).
    """

    continuous: Array
    sampled: Array
    near_continuous: Array | None = None
    near_sampled: Array | None = None

    @classmethod
    def halves(cls, far: Array, near: Array | None = None) -> StartSet:
        """Every other start for one of them, so that each start is simulated once."""
        return cls(far[..., ::2], far[..., 1::2], *_halves(near))

    @classmethod
    def both(cls, far: Array, near: Array | None = None) -> StartSet:
        """All far starts for both, every other near one for one of them."""
        return cls(far, far, *_halves(near))


def _halves(starts: Array | None) -> tuple[Array | None, Array | None]:
    """Every other start, and the rest."""
    return (None, None) if starts is None else (starts[..., ::2], starts[..., 1::2])


class Job(NamedTuple):
    """Rollouts of one process."""

    kind: type[Columns]
    setup: Setup
    controls: Controls
    starts: Array
    horizon: float  # s


def controls_of(controllers: Sequence[Proposal | Candidate]) -> Controls:
    """The numbers of several controllers side by side."""
    frequencies = [
        one.frequency if isinstance(one, Proposal) else float(one.excitation.frequency) for one in controllers
    ]
    return Controls.of([one.gains.map(floats) for one in controllers], frequencies)


def measure_all(
    setup: Setup, controls: Controls, starts: StartSet, horizon: float, executor: Executor | None
) -> Outcomes:
    """The outcomes (controllers, starts) in the order of a StartSet; in other processes where there is an executor.

    They do not depend on how many processes there are.
    """
    workers, fleets = os.cpu_count() or 1 if executor else 1, len(controls.frequency)
    jobs: list[Job] = []
    shapes: list[tuple[int, int]] = []
    kinds: list[tuple[type[Continuous | Sampled], Setup]]
    kinds = [(Continuous, setup), (Sampled, setup), (Continuous, setup.near), (Sampled, setup.near)]
    for (kind, used), some in zip(kinds, starts, strict=True):
        if some is None:
            continue
        rows = _parts(fleets, workers)
        columns = _parts(some.shape[-1], math.ceil(workers / len(rows)))
        jobs += [Job(kind, used, controls.take(row), some[..., column], horizon) for row in rows for column in columns]
        shapes.append((len(rows), len(columns)))
    with worker_errors():
        done = iter(list(executor.map(run_job, jobs) if executor else map(run_job, jobs)))
    tables = [[[next(done) for _ in range(width)] for _ in range(height)] for height, width in shapes]
    joined = [_joined(table) for table in tables if table[0]]
    return Outcomes(*(np.hstack(columns) for columns in zip(*joined, strict=True)))


def _joined(table: Sequence[Sequence[Outcomes]]) -> Outcomes:
    """The outcomes of a table of jobs: controllers downwards, starts to the right."""
    return Outcomes(*(np.block([[outcomes[k] for outcomes in row] for row in table]) for k in range(3)))


def _parts(count: int, most: int) -> list[slice]:
    """The numbers from 0 to `count` in at most so many parts of about equal size."""
    size = max(1, math.ceil(count / most))
    return [slice(begin, min(begin + size, count)) for begin in range(0, count, size)]


def run_job(job: Job) -> Outcomes:
    """The outcomes of a job."""
    return settle_all(*job)


@contextmanager
def worker_errors() -> Iterator[None]:
    """While an executor is asked: a worker that dies is an UndecidedError."""
    try:
        yield
    except BrokenExecutor:
        raise UndecidedError("design: a worker process died or took too long; run the same command again") from None
