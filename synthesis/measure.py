"""Measures candidates by simulation over starts: what every ranking rests on."""

from __future__ import annotations

import math
import statistics
from collections.abc import Iterator, Sequence
from concurrent.futures import BrokenExecutor, Executor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..models.equations import Plant, State
from ..models.errors import UndecidedError
from ..models.excitation import Excitation
from ..models.fleet import floats
from ..models.gains import Gains
from .rates import LONGEST_TAIL, CrossTrack
from .rollout import Rollout, Settling, Tolerance

if TYPE_CHECKING:
    from .design import Candidate, Task

WORST_SHARE = 0.15  # of the worst start in the cost, beside the mean
TAIL_SHARE = 0.01  # of the mean tail to half the tolerance: it keeps what comes after settling from being traded away
TAIL_DIRECTIONS = 3  # in which the fleet is 1 m off its track, from which the averaged flow is followed
STEP = 0.5  # s between the points at which a rollout is looked at
PIECE = 15.0  # s, or a period of psi: a fleet that stays settled for so long counts as settled
ACCURACY: dict[str, Any] = {"reltol": 1e-4, "abstol": 1e-5, "multistep": "adams"}  # enough to rank
NEVER = Settling(math.inf, math.inf)


@dataclass(frozen=True)
class Measured:
    """What simulation and the averaged flow say of a candidate."""

    runs: list[Settling]  # for every start
    tails: list[float]  # s, for every direction; inf where the averaged flow does not fall so far


Job = tuple[Plant, "Candidate", Sequence[State], float, Tolerance, float]


def measure_all(
    task: Task,
    candidates: Sequence[Candidate],
    starts: Sequence[State],
    horizon: float,
    executor: Executor | None,
    hopeless: float = math.inf,
) -> Iterator[Measured]:
    """The measurements of candidates in turn, over common starts, in other processes where there is an executor.

    A candidate whose mean settling time is beyond `hopeless` (s) whatever the rest does is not run to the end.
    """
    jobs: list[Job] = [(task.plant, candidate, starts, horizon, task.tolerance, hopeless) for candidate in candidates]
    try:
        yield from executor.map(measure, jobs) if executor else map(measure, jobs)
    except BrokenExecutor:
        raise UndecidedError("design: a worker process died or took too long; run the same command again") from None


def measure(job: Job) -> Measured:
    """How the fleet settles from every start (never, where the integrator gave up), and its tails."""
    plant, candidate, starts, horizon, tolerance, hopeless = job
    piece = max(PIECE, 2 * math.pi / float(candidate.excitation.frequency))
    rollout = Rollout(plant, candidate.excitation, step=STEP, piece=piece, **ACCURACY)
    gains = candidate.gains.map(floats)
    runs: list[Settling] = []
    for start in starts:
        if sum(min(run.time, horizon) for run in runs) > hopeless * len(starts):
            return Measured([*runs, *[NEVER] * (len(starts) - len(runs))], [math.inf])
        try:
            runs.append(rollout.settling(gains, start, horizon, tolerance))
        except UndecidedError:  # such gains are of no use to anybody
            runs.append(NEVER)
    return Measured(runs, _tails(plant, gains, candidate.excitation, tolerance))


def _tails(plant: Plant, gains: Gains, excitation: Excitation, tolerance: Tolerance) -> list[float]:
    """Times from 1 m across the track to half the tolerance, by the averaged flow, from fixed directions."""
    try:
        track = CrossTrack(plant, gains, excitation)
    except UndecidedError:
        return [math.inf]
    sides = np.random.default_rng(0).choice([-1.0, 1.0], (TAIL_DIRECTIONS, plant.graph.vehicles))
    return [track.time_to(side, tolerance.position / 2, tolerance.heading / 2)[0] for side in sides]


def cost(measured: Measured, horizon: float) -> float:
    """Mean settling time with a share of the worst, and a share of the same of the tails, s."""
    times = [_counted(run.time, run.excess, horizon) for run in measured.runs]
    tails = [tail if tail < LONGEST_TAIL else LONGEST_TAIL for tail in measured.tails]  # nan counts as the longest
    return _mean_and_worst(times) + TAIL_SHARE * _mean_and_worst(tails)


def _mean_and_worst(times: Sequence[float]) -> float:
    return statistics.fmean(times) + WORST_SHARE * max(times)


def _counted(time: float, excess: float, horizon: float) -> float:
    """A start that did not settle counts beyond the horizon, the more the further away it ended."""
    return time if math.isfinite(time) else horizon * (1 + math.log(min(max(excess, 1.0), 1e6)))
