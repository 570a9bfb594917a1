"""The time-domain search: CMA-ES over the scalars, then over the gains of every role, from the averaged program on."""

from __future__ import annotations

import logging
import math
import warnings
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..models.errors import UndecidedError
from ..models.gains import GAIN_NAMES, Gains
from .measure import Run, cost, measure_all
from .rollout import Deadline
from .structure import Scalars

if TYPE_CHECKING:
    from ..models.equations import State
    from .design import Candidate, Progress, Task

LOG = logging.getLogger(__name__)

ORIGIN = "time-domain search"
TRAINING_STARTS = 32  # fewer are overfitted: THEORY section 3
GENERATIONS = 120
SHORT_GENERATIONS = 12  # of mode "fast"
SHORT_STARTS = 8  # beside the fleet's own
FIRST_SHARE = 0.4  # of the starts, on which the better half of a generation is chosen
HOPELESS = 2.0  # times the best cost so far: a mean settling time beyond which a candidate is not run to the end
POPULATION = 12
ROLES_POPULATION = 24  # more numbers, and noise: near the same gains, chaotic motion takes other times
HORIZON = 4.0  # times the best cost so far
SPREAD = 0.35  # of the first generation, in logarithms
ELITE = 4  # candidates of a run among which separate starts choose
BASINS = 3
SCALARS = 6
SCALARS_SHARE = 0.25  # of the time, for the scalars alone
ROLES_VEHICLES = 40  # the largest fleet of which roles are searched
ROLES_GENERATIONS = 400
ROLES_SPREAD = 0.15  # of their first generation
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

    The landscape has many basins: the first BASINS incumbents that differ get SHORT_GENERATIONS generations each, and
    the best of them goes on with the scalars for SCALARS_SHARE of the time, then with every gain of every role.
    With `short` the first incumbent is all. An interrupt ends it with what it has. For one seed the generations are
    the same: only the clock can change the result.
    """
    begins = _distinct(incumbents)[: 1 if short else BASINS]
    starts = task.starts(SHORT_STARTS if short else TRAINING_STARTS, task.seed + 1)
    first, deadline = Deadline(SCALARS_SHARE * time_limit), Deadline(time_limit)
    runs: list[_Run] = []
    try:
        for begin in begins:  # none where only the convex programs found something: there are no scalars to vary
            runs.append(_Run(task, _fleet_wide(task), begin.logarithms(), starts, horizon, executor))
            runs[-1].advance(SHORT_GENERATIONS, first, progress)
        if runs and not short:
            best = min(runs, key=lambda run: run.best)
            best.advance(GENERATIONS, first, progress)
            if len(task.fleet) <= ROLES_VEHICLES:
                runs.append(best.continued(*_per_role(task)))
                runs[-1].advance(ROLES_GENERATIONS, deadline, progress)
    except KeyboardInterrupt:
        if short:
            raise
        LOG.warning("time-domain search: interrupted; the best so far is kept")
    except (ArithmeticError, AssertionError, RuntimeError, ValueError) as error:
        LOG.warning("time-domain search: broken off: %s: %s", type(error).__name__, error)
    return [*(found for run in runs for found in run.finds()), *incumbents]


def _distinct(incumbents: Sequence[Candidate]) -> list[Scalars]:
    """The scalars of the incumbents in their order, but for those within APART of an earlier one."""
    kept: list[Scalars] = []
    for scalars in (candidate.scalars for candidate in incumbents if candidate.scalars):
        if all(np.abs(scalars.logarithms() - other.logarithms()).max() > APART for other in kept):
            kept.append(scalars)
    return kept


Point = NDArray[np.float64]  # what the strategy varies


def _fleet_wide(task: Task) -> Callable[[Point], Candidate]:
    """Points are the logarithms of the scalars."""
    return lambda point: task.candidate(ORIGIN, Scalars.from_logarithms(point))


def _per_role(task: Task) -> tuple[Callable[[Point], Candidate], int]:
    """Points go on with the logarithms of factors on the gains of every role but the first.

    Also says how many numbers those are.
    """
    role = task.plant.graph.roles()
    others, kinds = int(role.max()), len(GAIN_NAMES)

    def make(point: Point) -> Candidate:
        own = np.vstack([np.zeros(kinds), point[SCALARS:].reshape(others, kinds)])
        return task.candidate(ORIGIN, Scalars.from_logarithms(point[:SCALARS]), Gains(*np.exp(own[role]).T))

    return make, others * kinds


class _Run:
    """One run of CMA-ES from its own beginning, and the best that it has met."""

    def __init__(
        self,
        task: Task,
        make: Callable[[Point], Candidate],
        begin: Point,
        starts: Sequence[State],
        horizon: float,
        executor: Executor | None,
        population: int = POPULATION,
        spread: float = SPREAD,
    ) -> None:
        import cma

        self._task, self._make, self._starts, self._horizon, self._executor = task, make, starts, horizon, executor
        self._elite: list[tuple[float, Candidate, Point]] = []
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of cma, about plotting
            options = {"seed": task.seed + 1, "popsize": population, "verbose": -9}
            self._strategy = cma.CMAEvolutionStrategy(begin, spread, options)

    @property
    def best(self) -> float:
        """The least cost so far, s."""
        return self._elite[0][0] if self._elite else math.inf

    def continued(self, make: Callable[[Point], Candidate], more: int) -> _Run:
        """A run from the best point of this one, with `more` numbers besides that begin at 0."""
        begin = np.concatenate([self._elite[0][2] if self._elite else self._strategy.mean, np.zeros(more)])
        return _Run(
            self._task, make, begin, self._starts, self._horizon, self._executor, ROLES_POPULATION, ROLES_SPREAD
        )

    def finds(self) -> list[Candidate]:
        """The centre of the last generation and the best candidates; none before the first generation."""
        # The centre owes less to luck than the best: far from the goal the motion is chaotic.
        centre = self._candidate(self._strategy.mean) if self._elite else None
        return [*([centre] if centre else []), *(candidate for _, candidate, _ in self._elite)]

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
        few = math.ceil(FIRST_SHARE * len(self._starts))
        first = self._measured(candidates, self._starts[:few])
        costs = {k: cost(one, self._horizon) for k, one in first.items()}
        # The strategy learns from the order, mostly of the better half: only that half goes on to the other starts.
        better = sorted(costs, key=costs.__getitem__)[: math.ceil(len(points) / 2)]
        rest = self._measured({k: candidates[k] for k in better}, self._starts[few:])
        whole = {k: cost(first[k] + one, self._horizon) for k, one in rest.items()}
        behind = max(whole.values(), default=0.0)
        told = {k: whole[k] if k in whole else behind + value for k, value in costs.items()}
        self._strategy.tell(points, [math.log(told.get(k, USELESS)) for k in range(len(points))])
        met = [*self._elite, *((value, candidates[k], points[k]) for k, value in whole.items())]
        self._elite = sorted(met, key=lambda one: one[0])[:ELITE]
        self._horizon = min(self._horizon, HORIZON * self.best)

    def _measured(self, candidates: dict[int, Candidate], starts: Sequence[State]) -> dict[int, list[Run]]:
        """What simulation says of numbered candidates; those that are hopeless are not run to the end."""
        measured = measure_all(
            self._task, list(candidates.values()), starts, self._horizon, self._executor, HOPELESS * self.best
        )
        return dict(zip(candidates, measured, strict=True))

    def _candidate(self, point: Point) -> Candidate | None:
        """The candidate at a point of the search, None where rounding leaves no gains."""
        try:
            return self._make(np.asarray(point))
        except UndecidedError:
            return None
