"""Measures candidates by simulation over starts: what every ranking rests on."""

from __future__ import annotations

import math
import statistics
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, Executor
from typing import TYPE_CHECKING, Any, NamedTuple

from ..models.equations import Plant, State, across
from ..models.errors import UndecidedError
from ..models.fleet import floats
from ..models.ops import numpy_ops
from .rates import CrossTrack
from .rollout import Rollout, Settling, Tolerance

if TYPE_CHECKING:
    from .design import Candidate, Task

TAIL = 8  # the worst one start in so many is the tail: its mean is less a matter of chance than the worst
TAIL_SHARE = 0.25  # of the tail in the cost, beside the mean
FINER_SHARE = 0.03  # of the time to half the tolerance: what comes after settling must not be traded away
LATE = 6.0  # mean settling times: what a start needs beyond it for half the tolerance is late
LATE_SHARE = 0.6  # of the lateness in the tail; at most 1, or settling later would pay
FLOW_ACCURACY = 1e-3  # relative, of the averaged flow
LONGEST_FINER = 10.0  # horizons, as which a longer time to half the tolerance counts
STEP = 0.5  # s between the points at which a rollout is looked at
PIECE = 15.0  # s, or a period of psi: a fleet that stays settled for so long counts as settled
# Enough to rank: test_what_ranks_is_accurate_enough compares the mean settling time with that at tolerances of 1e-8.
ACCURACY: dict[str, Any] = {"reltol": 1e-2, "abstol": 1e-4, "multistep": "adams", "iteration": "functional"}


class Run(NamedTuple):
    """What simulation and the averaged flow say of a candidate from one start."""

    time: float  # s, from which on the fleet is settled; inf where not by the horizon
    finer: float  # s, the same for half the tolerance, followed by the averaged flow once the fleet is settled
    excess: float  # the largest error over its tolerance at the end


NEVER = Run(math.inf, math.inf, math.inf)
Job = tuple[Plant, "Candidate", Sequence[State], float, Tolerance, float]


def measure_all(
    task: Task,
    candidates: Sequence[Candidate],
    starts: Sequence[State],
    horizon: float,
    executor: Executor | None,
    hopeless: float = math.inf,
) -> Iterator[list[Run]]:
    """The measurements of candidates in turn, over common starts, in other processes where there is an executor.

    A candidate whose mean settling time is beyond `hopeless` (s) whatever the rest does is not run to the end.
    """
    jobs: list[Job] = [(task.plant, candidate, starts, horizon, task.tolerance, hopeless) for candidate in candidates]
    try:
        yield from executor.map(measure, jobs) if executor else map(measure, jobs)
    except BrokenExecutor:
        raise UndecidedError("design: a worker process died or took too long; run the same command again") from None


def measure(job: Job) -> list[Run]:
    """How the fleet settles from every start; never, where the integrator gave up."""
    plant, candidate, starts, horizon, tolerance, hopeless = job
    piece = max(PIECE, 2 * math.pi / float(candidate.excitation.frequency))
    rollout = Rollout(plant, candidate.excitation, step=STEP, piece=piece, **ACCURACY)
    gains = candidate.gains.map(floats)
    runs: list[Run] = []
    try:
        track = CrossTrack(plant, gains, candidate.excitation)
    except UndecidedError:  # such gains are of no use to anybody
        return [NEVER] * len(starts)
    for start in starts:
        if sum(min(run.time, horizon) for run in runs) > hopeless * len(starts):
            break
        try:
            settling = rollout.settling(gains, start, horizon, tolerance)
        except UndecidedError:
            runs.append(NEVER)
        else:
            runs.append(Run(settling.time, _finer(track, rollout, settling, tolerance), settling.excess))
    return [*runs, *[NEVER] * (len(starts) - len(runs))]


def _finer(track: CrossTrack, rollout: Rollout, settling: Settling, tolerance: Tolerance) -> float:
    """When the fleet is within half the tolerance, s: in the rollout, or by the averaged flow from its end on."""
    if not math.isfinite(settling.time):
        return math.inf
    if settling.excess <= 0.5:
        return settling.time
    side = across(numpy_ops(), rollout.plant.leader_theta, *rollout.offsets(settling.final))
    return settling.end + track.time_to(side, tolerance.position / 2, tolerance.heading / 2, FLOW_ACCURACY)[0]


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
