"""How points of the search become candidates: by scalars for the whole fleet, or by separate gains as well."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from ...models.errors import UndecidedError
from ...models.gains import GAIN_NAMES, Gains
from ..scaled_gains import Scalars
from ..task import Candidate, Task

ORIGIN = "time-domain search"
SCALARS = 6

Point = NDArray[np.float64]  # the variables of the search
Make = Callable[[Point], Candidate]  # raises UndecidedError where rounding leaves no gains
Compared = tuple[float, Candidate]  # with its cost, s


def by_scalars(task: Task) -> Make:
    """Points are the logarithms of the scalars."""
    return lambda point: task.candidate(ORIGIN, Scalars.from_logarithms(point))


def by_separate_gains(task: Task) -> tuple[Make, int]:
    """Points go on with the logarithms of factors on the gains of every role but the first.

    Vehicles of equal role in the graph share them; in a small fleet every vehicle has its own. Also returns how many
    numbers those are.
    """
    small = len(task.fleet) <= task.settings.own_gains_vehicles
    role = np.arange(len(task.fleet)) if small else task.plant.graph.roles()
    others, kinds = int(role.max()), len(GAIN_NAMES)

    def make(point: Point) -> Candidate:
        factors = np.vstack([np.zeros(kinds), point[SCALARS:].reshape(others, kinds)])
        return task.candidate(ORIGIN, Scalars.from_logarithms(point[:SCALARS]), Gains(*np.exp(factors[role]).T))

    return make, others * kinds


def possible(make: Make, point: Point) -> Candidate | None:
    """The candidate at a point of the search, None where rounding leaves no gains."""
    try:
        return make(point)
    except UndecidedError:
        return None


def by_cost(compared: Iterable[Compared]) -> list[Compared]:
    """Least cost first."""
    return sorted(compared, key=lambda pair: pair[0])


def distinct(candidates: Sequence[Candidate], distance: float, most: int | None = None) -> list[Scalars]:
    """The scalars of the candidates in their order, so many at most, without those that are near an earlier one.

    Near means that no logarithm differs by more than `distance`.
    """
    kept: list[Scalars] = []
    points: list[Point] = []
    for scalars in (candidate.scalars for candidate in candidates if candidate.scalars):
        point = scalars.logarithms()
        if len(kept) != most and all(np.abs(point - other).max() > distance for other in points):
            kept.append(scalars)
            points.append(point)
    return kept
