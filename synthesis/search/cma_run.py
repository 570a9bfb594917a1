"""One run of CMA-ES, and the best candidates that it has met."""

from __future__ import annotations

import math
import warnings

import numpy as np

from ..task import Candidate, Task
from .candidates import Compared, Make, Point, by_cost, possible


class CmaRun:
    """A run of CMA-ES from its own beginning."""

    def __init__(self, task: Task, make: Make, begin: Point, population: int, spread: float) -> None:
        import cma

        self._make, self._settings = make, task.settings
        self.elite: list[Compared] = []  # the best, least cost first
        self.new: list[Candidate] = []  # the centre of the last generation and its best, not compared yet
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of cma, about plotting
            options = {"seed": task.options.seed + 1, "popsize": population, "verbose": -9}
            self._strategy = cma.CMAEvolutionStrategy(begin, spread, options)

    @property
    def best(self) -> float:
        """The least cost so far, s."""
        return self.elite[0][0] if self.elite else math.inf

    @property
    def converged(self) -> bool:
        """Whether the strategy has nothing more to try."""
        return bool(self._strategy.stop())

    def candidates(self) -> list[Candidate]:
        """The best candidates, and those not compared yet; none before the first generation."""
        return [*(candidate for _, candidate in self.elite), *self.new]

    def ask(self) -> dict[int, Candidate]:
        """The next generation, by number; points whose rounding leaves no gains are left out."""
        self._points = [np.asarray(point) for point in self._strategy.ask()]
        candidates = {number: possible(self._make, point) for number, point in enumerate(self._points)}
        self._generation = {number: candidate for number, candidate in candidates.items() if candidate}
        return self._generation

    def tell(self, costs: dict[int, float]) -> None:
        """Learn from the costs of that generation."""
        values = [costs.get(number, self._settings.failure_cost) for number in range(len(self._points))]
        self._strategy.tell(self._points, values)
        # The centre owes less to luck than the best: far from the goal the motion is chaotic.
        centre = possible(self._make, self._strategy.mean)
        best = [self._generation[min(costs, key=costs.__getitem__)]] if costs else []
        self.new = [*([centre] if centre else []), *best]

    def compare(self, value: float, candidate: Candidate) -> None:
        """Take note of the cost of a new candidate over the held-out starts."""
        self.elite = by_cost([*self.elite, (value, candidate)])[: self._settings.elite]
        self.new = []
