"""The time-domain search: CMA-ES over the structured scalars, warm-started by the averaged program; anytime."""

from __future__ import annotations

import logging
import math
import warnings
from collections.abc import Sequence
from concurrent.futures import Executor
from typing import TYPE_CHECKING, Any

import numpy as np

from ..models.errors import UndecidedError
from .measure import cost, measure_all
from .rollout import Deadline
from .structure import Scalars

if TYPE_CHECKING:
    from ..models.equations import State
    from .design import Candidate, Progress, Task

LOG = logging.getLogger(__name__)

TRAINING_STARTS = 20  # fewer are overfitted: THEORY section 3
GENERATIONS = 120
SHORT_GENERATIONS = 12  # of mode "fast"
SHORT_STARTS = 8  # beside the fleet's own
HOPELESS = 2.0  # times the best cost so far: a mean settling time beyond which a candidate is not run to the end
POPULATION = 12
HORIZON = 6.0  # times the best cost so far
SPREAD = 0.35  # of the first generation, in logarithms
ELITE = 6  # candidates of a basin among which separate starts choose
BASINS = 3
USELESS = 1e9  # s, the cost of scalars that leave no gains
APART = 0.3  # in logarithms: beginnings nearer than this lead to the same place


def search(
    task: Task,
    incumbents: Sequence[Candidate],
    horizon: float,
    time_limit: float,
    short: bool,
    executor: Executor | None,
    progress: Progress,
) -> list[Candidate]:
    """The best candidates found and the incumbents, to be ranked on starts that the search has not seen.

    The landscape has many basins: the first BASINS incumbents that differ get SHORT_GENERATIONS generations each, the
    best of them goes on to GENERATIONS or until the time limit. With `short` the first incumbent is all. An interrupt
    ends it with what it has. For one seed the generations are the same: only the clock can change the result.
    """
    begins = _distinct(incumbents)[: 1 if short else BASINS]
    starts = task.starts(SHORT_STARTS if short else TRAINING_STARTS, task.seed + 1)
    deadline, basins = Deadline(time_limit), []
    try:
        for begin in begins:  # none where only the convex programs found something: there are no scalars to vary
            basins.append(_Basin(task, begin, starts, horizon, executor))
            basins[-1].advance(SHORT_GENERATIONS, deadline, progress)
        if basins and not short:
            min(basins, key=lambda basin: basin.best).advance(GENERATIONS, deadline, progress)
    except KeyboardInterrupt:
        if short:
            raise
        LOG.warning("time-domain search: interrupted; the best so far is kept")
    except (ArithmeticError, AssertionError, RuntimeError, ValueError) as error:
        LOG.warning("time-domain search: broken off: %s: %s", type(error).__name__, error)
    return [*(found for basin in basins for found in basin.finds()), *incumbents]


def _distinct(incumbents: Sequence[Candidate]) -> list[Scalars]:
    """The scalars of the incumbents in their order, but for those within APART of an earlier one."""
    kept: list[Scalars] = []
    for scalars in (candidate.scalars for candidate in incumbents if candidate.scalars):
        if all(np.abs(scalars.logarithms() - other.logarithms()).max() > APART for other in kept):
            kept.append(scalars)
    return kept


class _Basin:
    """One run of CMA-ES from its own beginning, and the best that it has met."""

    def __init__(
        self, task: Task, begin: Scalars, starts: Sequence[State], horizon: float, executor: Executor | None
    ) -> None:
        import cma

        self._task, self._starts, self._horizon, self._executor = task, starts, horizon, executor
        self._elite: list[tuple[float, Candidate]] = []
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of cma, about plotting
            options = {"seed": task.seed + 1, "popsize": POPULATION, "verbose": -9}
            self._strategy = cma.CMAEvolutionStrategy(begin.logarithms(), SPREAD, options)

    @property
    def best(self) -> float:
        """The least cost so far, s."""
        return self._elite[0][0] if self._elite else math.inf

    def finds(self) -> list[Candidate]:
        """The centre of the last generation and the best candidates; none before the first generation."""
        # The centre owes less to luck than the best: far from the goal the motion is chaotic.
        centre = self._candidate(self._strategy.mean) if self._elite else None
        return [*([centre] if centre else []), *(candidate for _, candidate in self._elite)]

    def advance(self, generations: int, deadline: Deadline, progress: Progress) -> None:
        """Some generations more, as long as there is time and the strategy has not converged."""
        for generation in range(generations):
            if deadline.passed or self._strategy.stop():
                return
            self._generation()
            done = max((generation + 1) / generations, deadline.share)
            progress(f"searching: {self.best:.0f} s on the training starts", done)

    def _generation(self) -> None:
        points = self._strategy.ask()
        candidates = {k: found for k, point in enumerate(points) if (found := self._candidate(point))}
        hopeless = HOPELESS * self.best
        measured = measure_all(
            self._task, list(candidates.values()), self._starts, self._horizon, self._executor, hopeless
        )
        costs = {k: cost(one, self._horizon) for k, one in zip(candidates, measured, strict=True)}
        self._strategy.tell(points, [math.log(costs.get(k, USELESS)) for k in range(len(points))])
        met = [*self._elite, *((costs[k], candidate) for k, candidate in candidates.items())]
        self._elite = sorted(met, key=lambda pair: pair[0])[:ELITE]
        self._horizon = min(self._horizon, HORIZON * self.best)

    def _candidate(self, point: Any) -> Candidate | None:
        """The candidate at a point of the search, None where rounding leaves no gains."""
        try:
            return self._task.candidate("time-domain search", Scalars.from_logarithms(point))
        except UndecidedError:
            return None
