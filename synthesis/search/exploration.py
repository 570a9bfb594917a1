"""Random points around those that the programs and the fleet's typical scalars propose."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..task import Progress
from .comparison import Comparison
from .space import Point, Space

Scored = tuple[float, Point]  # with its cost, s


def explore(comparison: Comparison, space: Space, centres: Sequence[Point], progress: Progress) -> list[Scored]:
    """The centres and random points around them, by cost over a few starts, least first."""
    settings = comparison.settings
    random = np.random.default_rng(comparison.task.options.seed)
    scored: list[Scored] = []
    while len(scored) < settings.explored and comparison.share < settings.exploration_share:
        count = min(settings.exploration_batch, settings.explored - len(scored))
        chosen = np.array(centres)[random.integers(len(centres), size=count)]
        drawn = chosen + settings.exploration_spread * random.standard_normal((count, space.size))
        points = [*([] if scored else centres), *space.snapped(drawn)]
        scored = by_cost([*scored, *_scored(comparison, space, points, settings.basins, first=not scored)])
        comparison.horizon = min(comparison.horizon, settings.explored_horizon * scored[0][0])
        progress("searching: random scalars", min(1.0, len(scored) / settings.explored))
    comparison.least = scored[0][0]
    return scored


def _scored(comparison: Comparison, space: Space, points: Sequence[Point], enough: int, first: bool) -> list[Scored]:
    """The points with their costs; the first ones with a longer horizon, until enough of them settle mostly."""
    proposals = space.proposals(points)
    costs = comparison.explored(proposals)
    while first and np.sum(costs < comparison.horizon) < enough and comparison.horizon < comparison.longest:
        comparison.horizon = min(2 * comparison.horizon, comparison.longest)
        costs = comparison.explored(proposals)
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
