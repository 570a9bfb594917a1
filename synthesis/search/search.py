"""The time-domain search: CMA-ES over the scalars, then over separate gains, from the programs' candidates on."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from concurrent.futures import Executor

from ...models.deadline import Deadline
from ..task import Candidate, Progress, Task
from .candidates import by_cost, by_scalars, distinct
from .cma_run import CmaRun
from .comparison import Comparison
from .exploration import explore
from .halving import halve, search_separate_gains

LOG = logging.getLogger(__name__)


def search(
    task: Task, incumbents: Sequence[Candidate], horizon: float, executor: Executor | None, progress: Progress
) -> list[Candidate]:
    """The best candidates met and the incumbents, to be ranked on starts that the search has not seen.

    The landscape has many basins: the incumbents and random scalars around them are tried, the best `basins` go on for
    some generations, the better half of those again, and so on; then, with `own_gains`, the best go on with separate
    gains. For one seed the generations are the same: only the clock can change the result.
    """
    settings = task.settings
    comparison = Comparison(task, horizon, executor)
    deadline = Deadline(settings.seconds)
    first = Deadline(settings.scalars_share * settings.seconds)
    runs: list[CmaRun] = []
    kept: list[Candidate] = []
    try:
        kept = explore(comparison, incumbents, first, progress)
        # Where only convex programs gave gains there are no scalars to begin at.
        for begin in distinct(kept, settings.basin_distance, settings.basins):
            runs.append(CmaRun(task, by_scalars(task), begin.logarithms(), settings.population, settings.spread))
        halve(comparison, runs, first, progress)
        if settings.own_gains:
            compared = [*(pair for run in runs for pair in run.elite), *comparison.compared(kept[: settings.elite])]
            kept, runs = [candidate for _, candidate in by_cost(compared)], []
            if len(task.fleet) <= settings.roles_vehicles:
                begins = distinct(kept, settings.basin_distance, settings.own_gains_basins)
                search_separate_gains(comparison, begins, runs, deadline, progress)
    except KeyboardInterrupt:
        if not settings.keep_on_interrupt:
            raise
        LOG.warning("time-domain search: interrupted; the best so far is kept")
    except (ArithmeticError, AssertionError, RuntimeError, ValueError) as error:
        LOG.warning("time-domain search: broken off: %s: %s", type(error).__name__, error)
    best = sorted(runs, key=lambda run: run.best)[: settings.finalists]
    tried = [candidate for candidate in kept[: settings.elite] if candidate not in incumbents]
    begun = [candidate for candidate in incumbents if candidate.scalars] or incumbents
    found = [candidate for run in best for candidate in run.candidates()]
    return [*found, *(tried if settings.own_gains else []), *begun]
