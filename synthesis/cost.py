"""What the search minimises: the typical settling time, and the tail that any start may meet."""

from __future__ import annotations

import math
import statistics
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from .settings import FAST, Settings


class Run(NamedTuple):
    """What simulation and the averaged flow say of a candidate from one start."""

    time: float  # s, from which on the fleet is settled; inf where not by the horizon
    excess: float  # the largest error over its tolerance at the end
    steps: int = 0  # of integration that it took
    tail: float = 0.0  # s, across the track by the averaged flow, of the candidate from any start


NEVER = Run(math.inf, math.inf)


def cost(runs: Sequence[Run], horizon: float, settings: Settings = FAST) -> float:
    """The typical settling time and the tail as a weighted geometric mean, s.

    Most starts of a fast fleet end within the tolerance or nearly so, and a few meet the tail: too few to be seen
    among some dozens, so that only the tail itself can be kept short. A per cent of it weighs the same in fast and in
    slow fleets, and no short tail makes up for starts that do not settle.
    """
    times = [_counted(run.time, run.excess, horizon) for run in runs]
    tail = statistics.fmean(run.tail for run in runs)
    settling, tail = (max(settings.shortest_time, time) for time in (_typical(times), tail))
    weighted: float = settling ** (1 - settings.tail_power) * tail**settings.tail_power
    return weighted


def _typical(times: Iterable[float]) -> float:
    """The mean of the square roots, squared: a few starts are late by decades, and would hide all others in noise."""
    return statistics.fmean(map(math.sqrt, times)) ** 2


def _counted(time: float, excess: float, horizon: float) -> float:
    """A start that did not settle counts beyond the horizon, the more the further away it ended."""
    return time if math.isfinite(time) else horizon * (1 + math.log(min(max(excess, 1.0), 1e6)))
