"""The time-domain search: CMA-ES over the scalars, then over the gains of every role, from the averaged program on."""

from __future__ import annotations

import logging
import math
import statistics
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Executor
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...models.deadline import Deadline
from ...models.errors import UndecidedError
from ...models.gains import GAIN_NAMES, Gains
from ...models.starts import Draw
from ..cost import Run, cost, measure_all
from ..rollouts.settling import MAX_STEPS
from ..scaled_gains import Scalars

if TYPE_CHECKING:
    from ...models.equations import State
    from ..design import Candidate, Progress, Task

LOG = logging.getLogger(__name__)
Point = NDArray[np.float64]  # what the strategy varies
Make = Callable[[Point], "Candidate"]
Compared = tuple[float, "Candidate"]  # a cost, s, and whose it is

ORIGIN = "time-domain search"
TRAINING_STARTS = 320  # few are overfitted (THEORY section 3): every generation takes others of them
OTHER_STARTS = 320  # on which what a run met is compared: the training starts flatter it
SIMULATED_VEHICLES = 4000  # in all starts together: a large fleet is searched on fewer
SCALARS_STARTS = 24  # of a generation, for the scalars alone
SHORT_SCALARS_STARTS = 12
ROLES_STARTS = 16
GENERATIONS = 10  # between two comparisons
SHORT_STARTS = 24
EXPLORED = 960  # scalars tried at random
SHORT_EXPLORED = 240
EXPLORED_STARTS = 8
EXPLORED_SPREAD = 1.0  # around the incumbents, in logarithms
BATCH = 240  # of them at a time: what is found limits how long the next are simulated
POPULATION = 12
ROLES_POPULATION = 48  # more numbers, and noise: near the same gains, chaotic motion takes other times
LEAST_MEAN = 10.0  # s: a fleet that is settled from the start leaves a horizon
SPREAD = 0.35  # of the first generation, in logarithms
ELITE = 4  # candidates of a run among which separate starts choose
BASINS = 8
SHORT_BASINS = 4
FINALISTS = 2  # runs whose finds are ranked in the end
ROUNDS = 12
SHORT_ROUNDS = 1
SCALARS = 6
SCALARS_SHARE = 0.2  # of the time, for the scalars alone
ROLES_VEHICLES = 40  # the largest fleet of which roles are searched
OWN_VEHICLES = 12  # up to here every vehicle plays its own
PATIENCE = 8  # comparisons without anything better after which a run over roles ends
ROLES_BASINS = 4
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
    GENERATIONS, the better half of those again, and so on for SCALARS_SHARE of the time; then the best ROLES_BASINS
    go on with every gain of every role, and the worse half of them ends with every third of the time.
    With `short` fewer are tried, the best SHORT_BASINS go on, for SHORT_ROUNDS, and that is all.
    An interrupt ends it with what it has, unless it is short. For one seed the generations are the same: only the
    clock can change the result.
    """
    starts = task.starts(Draw.TRAINING, SHORT_STARTS if short else TRAINING_STARTS, SIMULATED_VEHICLES)
    others = task.starts(Draw.COMPARISON, SHORT_STARTS if short else OTHER_STARTS, SIMULATED_VEHICLES)
    trials = _Trials(task, starts, others, horizon, executor)
    deadline = Deadline(time_limit)
    first = deadline if short else Deadline(SCALARS_SHARE * time_limit)
    runs: list[_Run] = []
    kept: list[Candidate] = []
    try:
        kept = _explored(trials, incumbents, SHORT_EXPLORED if short else EXPLORED, first, progress)
        # Where only convex programs found gains there is nowhere to begin.
        for begin in _distinct(kept, SHORT_BASINS if short else BASINS):
            runs.append(_Run(task.seed, _fleet_wide(task), begin.logarithms(), POPULATION, SPREAD))
        count, rounds = (SHORT_SCALARS_STARTS, SHORT_ROUNDS) if short else (SCALARS_STARTS, ROUNDS)
        _halve(trials, runs, count, rounds, first, progress)
        if not short:
            compared = [*(found for run in runs for found in run.elite), *trials.compared(kept[:ELITE])]
            kept, runs = [candidate for _, candidate in _sorted(compared)], []
            if len(task.fleet) <= ROLES_VEHICLES:
                _search_roles(trials, _distinct(kept, ROLES_BASINS), runs, deadline, progress)
    except KeyboardInterrupt:
        if short:
            raise
        LOG.warning("time-domain search: interrupted; the best so far is kept")
    except (ArithmeticError, AssertionError, RuntimeError, ValueError) as error:
        LOG.warning("time-domain search: broken off: %s: %s", type(error).__name__, error)
    best = sorted(runs, key=lambda run: run.best)[:FINALISTS]
    tried = [] if short else [candidate for candidate in kept[:ELITE] if candidate not in incumbents]
    begun = [candidate for candidate in incumbents if candidate.scalars] or incumbents
    return [*(found for run in best for found in run.finds()), *tried, *begun]


def _halve(
    trials: _Trials, runs: Sequence[_Run], count: int, rounds: int, deadline: Deadline, progress: Progress
) -> None:
    """Advance all runs, then the better half, then the better half of those, and so on; in the end the best alone."""
    for _ in range(rounds):
        _advance(trials, runs, count, deadline, progress)
        runs = sorted(runs, key=lambda run: run.best)[: math.ceil(len(runs) / 2)]


def _search_roles(
    trials: _Trials, begins: Sequence[Scalars], runs: list[_Run], deadline: Deadline, progress: Progress
) -> None:
    """Go on with the gains of every role from the beginnings; with every third of the time the worse half of them ends.

    So do those that find nothing better any more. The runs are appended to `runs`, which an interrupt leaves as far
    as they came.
    """
    make, more = _per_role(trials.task)
    points = [np.concatenate([begin.logarithms(), np.zeros(more)]) for begin in begins]
    runs += [_Run(trials.task.seed, make, point, ROLES_POPULATION, ROLES_SPREAD) for point in points]
    going, begun, waited = list(runs), deadline.share, [0] * len(runs)
    while going and not deadline.passed:
        before = [run.best for run in going]
        _advance(trials, going, ROLES_STARTS, deadline, progress)
        waited = [0 if run.best < best else count + 1 for run, best, count in zip(going, before, waited, strict=True)]
        third = int(3 * (deadline.share - begun) / (1 - begun))
        kept = sorted(range(len(going)), key=lambda k: going[k].best)[: math.ceil(len(runs) / 2**third)]
        kept = [k for k in kept if waited[k] < PATIENCE and not going[k].converged]
        going, waited = [going[k] for k in kept], [waited[k] for k in kept]


def _advance(trials: _Trials, runs: Sequence[_Run], count: int, deadline: Deadline, progress: Progress) -> None:
    """GENERATIONS more of all runs at once, from `count` training starts each, then a comparison of what they met."""
    for generation in range(GENERATIONS):
        going = [run for run in runs if not run.converged]
        if deadline.passed or not going:
            break
        asked = [run.ask() for run in going]
        measured = trials.learned([candidate for candidates in asked for candidate in candidates.values()], count)
        for run, candidates in zip(going, asked, strict=True):
            run.tell({number: next(measured) for number in candidates})
        best = min(run.best for run in runs)
        progress(
            f"searching: {best:.0f} s" if best < math.inf else "searching",
            max((generation + 1) / GENERATIONS, deadline.share),
        )
    met = [(run, candidate) for run in runs for candidate in run.met]
    for (run, candidate), (value, _) in zip(met, trials.compared([candidate for _, candidate in met]), strict=True):
        run.elite = _sorted([*run.elite, (value, candidate)])[:ELITE]
        run.met = []


class _Bounds(NamedTuple):
    """How far candidates are simulated, in multiples of what the best so far took: few take longer and hold up all."""

    horizon: float  # of its mean settling time
    hopeless: float  # the same, as the mean of one candidate, beyond which it is not run to the end
    steps: float  # of the most steps that it took from one start


COMPARED, LEARNED, TRIED = _Bounds(6.0, 3.0, 10.0), _Bounds(2.0, 1.6, 3.0), _Bounds(3.0, 1.3, 3.0)


class _Trials:
    """Simulates candidates over common starts, only as far as the best so far makes worth while.

    The strategies learn from `starts`; what they met is compared over `others`.
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
        self._horizon, self._executor = horizon, executor
        self.least, self._steps = math.inf, MAX_STEPS  # mean settling time (s) and most steps of the best so far
        self._best, self._over = math.inf, 0  # its cost, s, and the starts that it was measured from
        self._next = 0  # of the training starts

    def compared(self, candidates: Sequence[Candidate]) -> list[Compared]:
        """The candidates with their costs over the other starts."""
        return list(zip(self._costs(candidates, self.others, COMPARED), candidates, strict=True))

    def explored(self, candidates: Sequence[Candidate]) -> list[Compared]:
        """The candidates with their costs over a few starts."""
        costs = self._costs(candidates, self.starts[:EXPLORED_STARTS], TRIED)
        return list(zip(costs, candidates, strict=True))

    def learned(self, candidates: Sequence[Candidate], count: int) -> Iterator[float]:
        """The costs of candidates over the next `count` training starts, or all where there are no more."""
        every, begin = self.starts, self._next
        count = min(count, len(every))
        self._next = (begin + count) % len(every)
        return iter(self._costs(candidates, [every[(begin + k) % len(every)] for k in range(count)], LEARNED))

    def _costs(self, candidates: Sequence[Candidate], starts: Sequence[State], bounds: _Bounds) -> list[float]:
        horizon = min(self._horizon, bounds.horizon * self.least)
        hopeless, steps = bounds.hopeless * self.least, min(MAX_STEPS, round(bounds.steps * self._steps))
        measured = list(measure_all(self.task, candidates, starts, horizon, self._executor, hopeless, steps))
        costs = [cost(runs, horizon) for runs in measured]
        self._follow(costs, measured, horizon)
        return costs

    def _follow(self, costs: Sequence[float], measured: Sequence[Sequence[Run]], horizon: float) -> None:
        """Take the cheapest from the most starts so far as the best: the best from few of them is the luckiest."""
        value, runs = min(zip(costs, measured, strict=True), key=lambda one: one[0], default=(math.inf, ()))
        steps = max((run.steps for run in runs), default=0)
        if steps and (-len(runs), value) < (-self._over, self._best):
            self._over, self._best, self._steps = len(runs), value, steps
            self.least = max(LEAST_MEAN, statistics.fmean(min(run.time, horizon) for run in runs))


def _explored(
    trials: _Trials, incumbents: Sequence[Candidate], tried: int, deadline: Deadline, progress: Progress
) -> list[Candidate]:
    """The incumbents and `tried` random scalars around those that have some, by cost over a few starts."""
    make, random = _fleet_wide(trials.task), np.random.default_rng(trials.task.seed)
    begun = [candidate for candidate in incumbents if candidate.scalars]
    found = trials.explored(begun or incumbents)
    centres = [scalars.logarithms() for scalars in _distinct(begun)]
    for begin in range(0, tried if centres else 0, BATCH):
        if deadline.passed:
            break
        count = min(BATCH, tried - begin)
        points = random.choice(centres, count) + EXPLORED_SPREAD * random.standard_normal((count, SCALARS))
        found += trials.explored([candidate for point in points if (candidate := _possible(make, point))])
        progress("searching: random scalars", min(1.0, len(found) / tried))
    return [candidate for _, candidate in _sorted(found)]


def _sorted(found: Iterable[Compared]) -> list[Compared]:
    """Least cost first."""
    return sorted(found, key=lambda one: one[0])


def _distinct(candidates: Sequence[Candidate], most: int | None = None) -> list[Scalars]:
    """The scalars of the candidates in their order, but for those within APART of an earlier one; so many at most."""
    kept: list[Scalars] = []
    points: list[Point] = []
    for scalars in (candidate.scalars for candidate in candidates if candidate.scalars):
        point = scalars.logarithms()
        if len(kept) != most and all(np.abs(point - other).max() > APART for other in points):
            kept.append(scalars)
            points.append(point)
    return kept


def _fleet_wide(task: Task) -> Make:
    """Points are the logarithms of the scalars."""
    return lambda point: task.candidate(ORIGIN, Scalars.from_logarithms(point))


def _per_role(task: Task) -> tuple[Make, int]:
    """Points go on with the logarithms of factors on the gains of every role but the first.

    Vehicles of equal role in the graph share them, in a small fleet none do. Also says how many numbers those are.
    """
    small = len(task.fleet) <= OWN_VEHICLES
    role = np.arange(len(task.fleet)) if small else task.plant.graph.roles()
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

    def __init__(self, seed: int, make: Make, begin: Point, population: int, spread: float) -> None:
        import cma

        self._make = make
        self.elite: list[Compared] = []  # the best, least cost first
        self.met: list[Candidate] = []  # the centre of the last generation and its best, not compared yet
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of cma, about plotting
            options = {"seed": seed + 1, "popsize": population, "verbose": -9}
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
        return [*(candidate for _, candidate in self.elite), *self.met]

    def ask(self) -> dict[int, Candidate]:
        """The next generation, by number; those are left out that rounding leaves no gains."""
        self._points = [np.asarray(point) for point in self._strategy.ask()]
        found = {number: _possible(self._make, point) for number, point in enumerate(self._points)}
        self._asked = {number: candidate for number, candidate in found.items() if candidate}
        return self._asked

    def tell(self, costs: dict[int, float]) -> None:
        """Learn from the costs of that generation."""
        self._strategy.tell(self._points, [costs.get(number, USELESS) for number in range(len(self._points))])
        # The centre owes less to luck than the best: far from the goal the motion is chaotic.
        centre = _possible(self._make, self._strategy.mean)
        best = [self._asked[min(costs, key=costs.__getitem__)]] if costs else []
        self.met = [*([centre] if centre else []), *best]
