"""The time-domain search: CMA-ES over the scalars, then over the gains of every role, from the averaged program on."""

from __future__ import annotations

import logging
import math
import statistics
import warnings
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Executor
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..models.errors import UndecidedError
from ..models.gains import GAIN_NAMES, Gains
from ..models.starts import Draw
from .measure import Run, cost, measure_all
from .rollout import Deadline
from .structure import Scalars

if TYPE_CHECKING:
    from ..models.equations import State
    from .design import Candidate, Progress, Task

LOG = logging.getLogger(__name__)
Point = NDArray[np.float64]  # what the strategy varies
Make = Callable[[Point], "Candidate"]
Compared = tuple[float, "Candidate"]  # a cost, s, and whose it is

ORIGIN = "time-domain search"
TRAINING_STARTS = 128  # few are overfitted (THEORY section 3): every generation takes others of them
OTHER_STARTS = 160  # on which what a run met is compared: the training starts flatter it
SIMULATED_VEHICLES = 2000  # in all starts together: a large fleet is searched on fewer
SCALARS_STARTS = 12  # of a generation, for the scalars alone
ROLES_STARTS = 16
GENERATIONS = 10  # between two comparisons
SHORT_STARTS = 8  # beside the fleet's own
FIRST_SHARE = 0.4  # of those, on which the better half of a generation is chosen
EXPLORED = 240  # scalars tried at random
SHORT_EXPLORED = 48
EXPLORED_STARTS = 4
EXPLORED_SPREAD = 1.0  # around the incumbents, in logarithms
BATCH = 24  # of them at a time: what is found limits how long the next are simulated
POPULATION = 12
ROLES_POPULATION = 40  # more numbers, and noise: near the same gains, chaotic motion takes other times
HORIZON = 6.0  # times the least mean settling time so far
LEAST_HORIZON = 60.0  # s
HOPELESS = 0.5  # of the horizon: a mean settling time beyond which a candidate is not run to the end
SPREAD = 0.35  # of the first generation, in logarithms
ELITE = 4  # candidates of a run among which separate starts choose
BASINS = 8
SHORT_BASINS = 2
FINALISTS = 2  # runs whose finds are ranked in the end
ROUNDS = 12
SHORT_ROUNDS = 2
SCALARS = 6
SCALARS_SHARE = 0.25  # of the time, for the scalars alone
ROLES_VEHICLES = 40  # the largest fleet of which roles are searched
PATIENCE = 10  # comparisons without anything better after which roles are searched from the next beginning
ROLES_SPREAD = 0.15  # of their first generation
USELESS = 1e9  # s, the cost of scalars that leave no gains
APART = 0.5  # in logarithms: beginnings nearer than this lead to the same place


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

    The landscape has many basins: the incumbents and random scalars around them are tried, the best BASINS go on for
    GENERATIONS, the better half of those again, and so on for SCALARS_SHARE of the time; then the best goes on
    with every gain of every role, and where that finds nothing better any more, the next best follows.
    With `short` fewer are tried, the best SHORT_BASINS go on, for SHORT_ROUNDS, and that is all.
    An interrupt ends it with what it has, unless it is short. For one seed the generations are the same: only the
    clock can change the result.
    """
    starts = task.starts(Draw.TRAINING, SHORT_STARTS if short else TRAINING_STARTS, SIMULATED_VEHICLES)
    others = [] if short else task.starts(Draw.COMPARISON, OTHER_STARTS, SIMULATED_VEHICLES)
    trials = _Trials(task, starts, others, horizon, executor)
    first, deadline = Deadline(SCALARS_SHARE * time_limit), Deadline(time_limit)
    runs: list[_Run] = []
    kept: list[Candidate] = []
    try:
        kept = _explored(trials, incumbents, SHORT_EXPLORED if short else EXPLORED, first, progress)
        # Where only convex programs found gains there is nowhere to begin.
        for begin in _distinct(kept)[: SHORT_BASINS if short else BASINS]:
            runs.append(_Run(trials, _fleet_wide(task), begin.logarithms(), SCALARS_STARTS))
        _halve(runs, SHORT_ROUNDS if short else ROUNDS, first, progress)
        if not short:
            compared = [*(found for run in runs for found in run.elite), *trials.compared(kept[:ELITE])]
            kept, runs = [candidate for _, candidate in _sorted(compared)], []
            if len(task.fleet) <= ROLES_VEHICLES:
                _search_roles(trials, _distinct(kept), runs, deadline, progress)
    except KeyboardInterrupt:
        if short:
            raise
        LOG.warning("time-domain search: interrupted; the best so far is kept")
    except (ArithmeticError, AssertionError, RuntimeError, ValueError) as error:
        LOG.warning("time-domain search: broken off: %s: %s", type(error).__name__, error)
    best = sorted(runs, key=lambda run: run.best)[:FINALISTS]
    tried = [] if short else [candidate for candidate in kept[:ELITE] if candidate not in incumbents]
    return [*(found for run in best for found in run.finds()), *tried, *incumbents]


def _halve(runs: Sequence[_Run], rounds: int, deadline: Deadline, progress: Progress) -> None:
    """Advance all runs, then the better half, then the better half of those, and so on; in the end the best alone."""
    for _ in range(rounds):
        for run in runs:
            run.advance(GENERATIONS, deadline, progress)
        runs = sorted(runs, key=lambda run: run.best)[: math.ceil(len(runs) / 2)]


def _search_roles(
    trials: _Trials, begins: Sequence[Scalars], runs: list[_Run], deadline: Deadline, progress: Progress
) -> None:
    """Go on with the gains of every role from one beginning until nothing better is found, then from the next.

    The runs are appended to `runs`, which an interrupt leaves as far as they came.
    """
    make, more = _per_role(trials.task)
    for begin in begins:
        if deadline.passed:
            break
        point = np.concatenate([begin.logarithms(), np.zeros(more)])
        run = _Run(trials, make, point, ROLES_STARTS, ROLES_POPULATION, ROLES_SPREAD)
        runs.append(run)
        waited = 0
        while waited < PATIENCE and not (deadline.passed or run.converged):
            before = run.best
            run.advance(GENERATIONS, deadline, progress)
            waited = 0 if run.best < before else waited + 1


class _Trials:
    """Simulates candidates over common starts, only as far as the best so far makes worth while.

    The strategies learn from `starts`; what they met is compared over `others`, where there are any.
    """

    def __init__(
        self,
        task: Task,
        starts: Sequence[State],
        others: Sequence[State],
        horizon: float,
        executor: Executor | None,
    ) -> None:
        self.task, self.starts, self.others = task, starts, others
        self.horizon, self._executor = horizon, executor

    def measured(self, candidates: dict[int, Candidate], starts: Sequence[State]) -> dict[int, list[Run]]:
        """What simulation from some starts says of numbered candidates."""
        hopeless = HOPELESS * self.horizon
        runs = measure_all(self.task, list(candidates.values()), starts, self.horizon, self._executor, hopeless)
        return dict(zip(candidates, runs, strict=True))

    def learn(self, measurements: Iterable[list[Run]]) -> None:
        """Shorten the horizon by what was measured."""
        means = (statistics.fmean(run.time for run in runs) for runs in measurements)
        self.horizon = min([self.horizon, *(max(LEAST_HORIZON, HORIZON * mean) for mean in means)])

    def compared(self, candidates: Sequence[Candidate], starts: Sequence[State] | None = None) -> list[Compared]:
        """The candidates with their costs over some starts, the others where none are named."""
        measured = self.measured(dict(enumerate(candidates)), self.others if starts is None else starts).values()
        costs = [cost(runs, self.horizon) for runs in measured]
        self.learn(measured)
        return list(zip(costs, candidates, strict=True))


def _explored(
    trials: _Trials, incumbents: Sequence[Candidate], tried: int, deadline: Deadline, progress: Progress
) -> list[Candidate]:
    """The incumbents that have scalars and `tried` random ones around them, by cost over a few starts."""
    make, random = _fleet_wide(trials.task), np.random.default_rng(trials.task.seed)
    batch = [candidate for candidate in incumbents if candidate.scalars]
    centres = [scalars.logarithms() for scalars in _distinct(batch)]
    found: list[Compared] = []
    while batch and not deadline.passed:
        found += trials.compared(batch, trials.starts[:EXPLORED_STARTS])
        progress("searching: random scalars", min(1.0, len(found) / tried))
        count = max(0, min(BATCH, tried - len(found)))
        points = random.choice(centres, count) + EXPLORED_SPREAD * random.standard_normal((count, SCALARS))
        batch = [candidate for point in points if (candidate := _possible(make, point))]
    return [candidate for _, candidate in _sorted(found)]


def _sorted(found: Iterable[Compared]) -> list[Compared]:
    """Least cost first."""
    return sorted(found, key=lambda one: one[0])


def _distinct(candidates: Sequence[Candidate]) -> list[Scalars]:
    """The scalars of the candidates in their order, but for those within APART of an earlier one."""
    kept: list[Scalars] = []
    for scalars in (candidate.scalars for candidate in candidates if candidate.scalars):
        if all(np.abs(scalars.logarithms() - other.logarithms()).max() > APART for other in kept):
            kept.append(scalars)
    return kept


def _fleet_wide(task: Task) -> Make:
    """Points are the logarithms of the scalars."""
    return lambda point: task.candidate(ORIGIN, Scalars.from_logarithms(point))


def _per_role(task: Task) -> tuple[Make, int]:
    """Points go on with the logarithms of factors on the gains of every role but the first.

    Also says how many numbers those are.
    """
    role = task.plant.graph.roles()
    others, kinds = int(role.max()), len(GAIN_NAMES)

    def make(point: Point) -> Candidate:
        own = np.vstack([np.zeros(kinds), point[SCALARS:].reshape(others, kinds)])
        return task.candidate(ORIGIN, Scalars.from_logarithms(point[:SCALARS]), Gains(*np.exp(own[role]).T))

    return make, others * kinds


def _possible(make: Make, point: Point) -> Candidate | None:
    """The candidate at a point of the search, None where rounding leaves no gains."""
    try:
        return make(point)
    except UndecidedError:
        return None


class _Run:
    """One run of CMA-ES from its own beginning, and the best that it has met."""

    def __init__(
        self,
        trials: _Trials,
        make: Make,
        begin: Point,
        starts: int,
        population: int = POPULATION,
        spread: float = SPREAD,
    ) -> None:
        """Begin; every generation learns from `starts` of the training starts."""
        import cma

        self._trials, self._make, self._count = trials, make, starts
        self.elite: list[Compared] = []  # the best, least cost first
        self._trained: list[Compared] = []  # the best of all generations on the training starts
        self._met: list[Candidate] = []  # the centre of the last generation and its best
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of cma, about plotting
            options = {"seed": trials.task.seed + 1, "popsize": population, "verbose": -9}
            self._strategy = cma.CMAEvolutionStrategy(begin, spread, options)

    @property
    def best(self) -> float:
        """The least cost so far, s."""
        return self.elite[0][0] if self.elite else math.inf

    @property
    def converged(self) -> bool:
        """Whether the strategy has nothing more to try."""
        return bool(self._strategy.stop())

    def finds(self) -> list[Candidate]:
        """The best candidates, and those not compared yet; none before the first generation."""
        return [*(candidate for _, candidate in self.elite), *self._met]

    def advance(self, generations: int, deadline: Deadline, progress: Progress) -> None:
        """Some generations more, as long as there is time and the strategy has not converged, then a comparison."""
        before = self._strategy.countiter
        for generation in range(generations):
            if deadline.passed or self.converged:
                break
            self._generation()
            cost_so_far = f": {self.best:.0f} s" if self.elite else ""
            progress(f"searching{cost_so_far}", max((generation + 1) / generations, deadline.share))
        if not self._trials.others:
            self.elite = self._trained
        elif self._strategy.countiter > before:
            self.elite, self._met = _sorted([*self.elite, *self._trials.compared(self._met)])[:ELITE], []

    def _next_starts(self) -> list[State]:
        """The training starts of a generation: others than the last had, as far as there are others."""
        every = self._trials.starts
        begin = self._strategy.countiter * self._count
        return [every[k % len(every)] for k in range(begin, begin + min(self._count, len(every)))]

    def _generation(self) -> None:
        points = [np.asarray(point) for point in self._strategy.ask()]
        candidates = {k: found for k, point in enumerate(points) if (found := _possible(self._make, point))}
        starts = self._next_starts()
        few = math.ceil(FIRST_SHARE * len(starts))
        horizon = self._trials.horizon
        first = self._trials.measured(candidates, starts[:few])
        costs = {k: cost(one, horizon) for k, one in first.items()}
        # The strategy learns from the order, mostly of the better half: only that half goes on to the other starts.
        better = sorted(costs, key=costs.__getitem__)[: math.ceil(len(points) / 2)]
        rest = self._trials.measured({k: candidates[k] for k in better}, starts[few:])
        runs = {k: first[k] + one for k, one in rest.items()}
        whole = {k: cost(one, horizon) for k, one in runs.items()}
        behind = max(whole.values(), default=0.0)
        told = {k: whole[k] if k in whole else behind + value for k, value in costs.items()}
        self._strategy.tell(points, [told.get(k, USELESS) for k in range(len(points))])
        best = _sorted((value, candidates[k]) for k, value in whole.items())
        self._trained = _sorted([*self._trained, *best])[:ELITE]
        # The centre owes less to luck than the best: far from the goal the motion is chaotic.
        centre = _possible(self._make, self._strategy.mean)
        self._met = [*([centre] if centre else []), *(candidate for _, candidate in best[:1])]
        self._trials.learn(runs.values())
