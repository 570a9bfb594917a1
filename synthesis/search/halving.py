"""Runs of CMA-ES side by side, of which the worse half ends after each round."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..task import Progress
from .cma_es import CmaEs
from .comparison import Comparison
from .exploration import Scored, by_cost
from .space import Point, Space


class Run:
    """A run of CMA-ES from its own beginning, and the best point that it has met."""

    def __init__(self, space: Space, begin: Point, population: int, spread: float) -> None:
        settings = space.task.settings
        self.space, self.best = space, math.inf  # s, least cost over the held-out starts
        self._converged = settings.converged
        self._strategy = CmaEs(begin, spread, population, space.task.options.seed)
        self._points = np.zeros((0, len(begin)))
        self.new: list[Point] = [begin]  # later the centre after the last generation and its best point

    @property
    def converged(self) -> bool:
        """Whether the strategy has nothing more to try."""
        return self._strategy.spread < self._converged

    def ask(self) -> list[Point]:
        """The next generation."""
        self._points = self.space.snapped(self._strategy.ask())
        return list(self._points)

    def tell(self, costs: Sequence[float]) -> None:
        """Learn from the costs of that generation."""
        self._strategy.tell(self._points, np.array(costs))
        # The centre owes less to luck than the best: far from the goal the motion is chaotic.
        self.new = [self.space.snapped(self._strategy.mean), self._points[int(np.argmin(costs))]]


def halve(
    comparison: Comparison, runs: Sequence[Run], until: float, elite: list[Scored], progress: Progress
) -> list[Scored]:
    """Compare the beginnings; advance all runs, then the better half, and so on, and at last the best alone.

    It ends with a share `until` of the work. Returns `elite` with the best points that were met, least cost first;
    it is changed in place as well, so that an interrupt leaves it as far as it came.
    """
    going = list(runs)
    _compare(comparison, going, elite)
    while going and comparison.share < until:
        for generation in range(comparison.settings.generations):
            if comparison.share >= until:
                break
            _advance(comparison, going)
            done = max((generation + 1) / comparison.settings.generations, comparison.share)
            progress(f"searching: {comparison.least:.3g} s", min(1.0, done))
        _compare(comparison, going, elite)
        going = sorted(going, key=lambda run: run.best)[: math.ceil(len(going) / 2)]
        going = [run for run in going if not run.converged]
    return elite


def _compare(comparison: Comparison, runs: Sequence[Run], elite: list[Scored]) -> None:
    """What the runs have newly met, over the held-out starts; the best are kept in `elite`."""
    new = [(run, point) for run in runs for point in run.new]
    costs = comparison.compared([run.space.proposal(point) for run, point in new])
    for (run, point), value in zip(new, costs.tolist(), strict=True):
        run.best = min(run.best, value)
        elite.append((value, run.space.extended(point) if len(point) < run.space.size else point))
    elite[:] = by_cost(elite)[: comparison.settings.elite]


def _advance(comparison: Comparison, runs: Sequence[Run]) -> None:
    """One generation of all runs over the same starts."""
    generations = [run.ask() for run in runs]
    proposals = [run.space.proposal(point) for run, points in zip(runs, generations, strict=True) for point in points]
    costs = iter(comparison.learned(proposals).tolist())
    for run, points in zip(runs, generations, strict=True):
        run.tell([next(costs) for _ in points])
