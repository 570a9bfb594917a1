"""The time-domain search: CMA-ES over the structured scalars, warm-started by the averaged program; anytime."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from concurrent.futures import Executor
from typing import TYPE_CHECKING

from .measure import cost, measure_all
from .rollout import Deadline
from .structure import Scalars

if TYPE_CHECKING:
    from ..models.equations import State
    from .design import Candidate, Progress, Task

TRAINING_STARTS = 12  # fewer are overfitted: THEORY section 3
GENERATIONS = 80
SHORT_GENERATIONS = 8  # of mode "fast"
SHORT_STARTS = 6  # beside the fleet's own
POPULATION = 12
SPREAD = 0.35  # of the first generation, in logarithms
ELITE = 6  # candidates among which separate starts choose


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

    Runs GENERATIONS generations (SHORT_GENERATIONS where `short`) or until the time limit; an interrupt ends it with
    what it has. For one seed the generations are the same, so that only the clock can change the result.
    """
    import cma

    begin = next((candidate.scalars for candidate in incumbents if candidate.scalars), None)
    if begin is None:  # only the convex programs found something: there are no scalars to vary
        return list(incumbents)
    starts = task.starts(SHORT_STARTS if short else TRAINING_STARTS, task.seed + 1)
    generations = SHORT_GENERATIONS if short else GENERATIONS
    deadline = Deadline(time_limit)
    elite: list[tuple[float, Candidate]] = []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of cma, about plotting
        options = {"seed": task.seed + 1, "popsize": POPULATION, "verbose": -9}
        strategy = cma.CMAEvolutionStrategy(begin.logarithms(), SPREAD, options)
    try:
        for generation in range(generations):
            if deadline.passed or strategy.stop():
                break
            points = strategy.ask()
            candidates = [task.candidate("time-domain search", Scalars.from_logarithms(point)) for point in points]
            costs = _costs(task, candidates, starts, horizon, executor)
            strategy.tell(points, [math.log(value) for value in costs])
            elite = sorted([*elite, *zip(costs, candidates, strict=True)], key=lambda pair: pair[0])[:ELITE]
            horizon = min(horizon, 8 * elite[0][0])
            done = max((generation + 1) / generations, deadline.share)
            progress(f"searching: {elite[0][0]:.0f} s on the training starts", done)
    except KeyboardInterrupt:
        progress("interrupted: keeping the best so far", 1.0)
    return [*(candidate for _, candidate in elite), *incumbents]


def _costs(
    task: Task, candidates: Sequence[Candidate], starts: Sequence[State], horizon: float, executor: Executor | None
) -> list[float]:
    return [cost(measured, horizon) for measured in measure_all(task, candidates, starts, horizon, executor)]
