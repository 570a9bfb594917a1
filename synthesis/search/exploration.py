"""Random points around those that the programs and the fleet's typical scalars propose."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..task import Progress
from .comparison import Comparison
from .space import Point, Space

Floats = NDArray[np.float64]
Scored = tuple[float, Point]  # with its cost, s


def explore(comparison: Comparison, space: Space, centres: Sequence[Point], progress: Progress) -> list[Scored]:
    """The best of the centres and of random points around them, by cost over a few starts, least first."""
    settings = comparison.settings
    random = np.random.default_rng(comparison.task.options.seed)
    scored: list[Scored] = []
    tried, horizon = 0, comparison.longest
    while tried < settings.explored and comparison.share < settings.exploration_share:
        count = min(settings.exploration_batch, settings.explored - tried)
        chosen = np.array(centres)[random.integers(len(centres), size=count)]
        drawn = chosen + settings.exploration_spread * random.standard_normal((count, space.size))
        points = space.snapped(drawn) if tried else np.vstack([centres, space.snapped(drawn)])
        scored = by_cost([*scored, *_best(comparison, space, points, horizon)])
        horizon = min(horizon, settings.explored_horizon * scored[0][0])
        tried += count
        progress("searching: random scalars", min(1.0, tried / settings.explored))
    comparison.least = scored[0][0]
    return scored


def _best(comparison: Comparison, space: Space, points: Floats, longest: float) -> list[Scored]:
    """The best points with their costs: the better half goes on to twice the horizon, until enough of them settle."""
    settings, horizon = comparison.settings, min(comparison.shortest, longest)
    costs = comparison.explored(space.proposals(list(points)), horizon)
    enough = settings.basins
    while np.sum(costs < horizon) < enough and horizon < longest and comparison.share < settings.exploration_share:
        horizon = min(2 * horizon, longest)
        better = np.argsort(costs, kind="stable")[: max(2 * enough, math.ceil(len(points) / 2))]
        points = points[better]
        costs = comparison.explored(space.proposals(list(points)), horizon)
    return list(zip(costs.tolist(), points, strict=True))


def by_cost(scored: Sequence[Scored]) -> list[Scored]:
    """Least cost first."""
    return sorted(scored, key=lambda pair: pair[0])


def distinct(scored: Sequence[Scored], distance: float, most: int) -> list[Point]:
    """The points in their order, so many at most, without those that are near an earlier one.

    Near means that no variable differs by more than `distance`.
    """
    kept: list[Point] = []
    for _, point in scored:
        if len(kept) < most and all(np.abs(point - other).max() > distance for other in kept):
            kept.append(point)
    return kept
