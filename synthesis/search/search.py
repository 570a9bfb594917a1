"""The time-domain search: random scalars, CMA-ES over the scalars, then over separate gains and scales."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from concurrent.futures import Executor

from ..task import Progress, Proposal, Task
from .comparison import Comparison
from .exploration import Scored, distinct, explore
from .halving import Run, halve
from .part import part_of
from .space import Point, Space

LOG = logging.getLogger(__name__)


def search(task: Task, incumbents: Sequence[Proposal], executor: Executor | None, progress: Progress) -> list[Proposal]:
    """The best proposals met and the incumbents, to be ranked on starts that the search has not seen.

    The landscape has many basins: typical scalars, those of the incumbents and random ones around them are tried, the
    best `basins` go on for some generations, the better half of those again, and so on; then, with `separate_gains`,
    the best go on with separate gains and scales. Scalars of a large fleet are searched on a part of it. For one seed
    the result is the same on every machine.
    """
    settings, part = task.settings, part_of(task)
    if not settings.work:
        return list(incumbents)
    space, comparison = Space.of(part), Comparison(part, executor)
    elite: list[Scored] = []
    met: list[tuple[Space, Point]] = []
    try:
        centres = [space.point(part.typical), *(space.point(one.scalars) for one in incumbents if one.scalars)]
        explored = explore(comparison, space, centres, progress)
        begins = distinct(explored, settings.basin_distance, settings.basins)
        runs = [Run(space, begin, settings.population, settings.spread) for begin in begins]
        halve(comparison, runs, settings.scalars_share, elite, progress)
        if settings.separate_gains and elite and len(task.fleet) <= settings.roles_vehicles:
            met = [(space, point) for _, point in elite[: settings.elite // 2]]
            wider, best = space.with_separate_gains(), [point for _, point in elite[:2]]
            elite = []
            population, spread = settings.separate_population, settings.separate_spread
            further = [Run(wider, wider.extended(point), population, spread) for point in best]
            space = wider
            halve(comparison, further, 1.0, elite, progress)
    except KeyboardInterrupt:
        if not settings.keep_on_interrupt:
            raise
        LOG.warning("time-domain search: interrupted; the best so far is kept")
    except (ArithmeticError, AssertionError, RuntimeError, ValueError) as error:
        LOG.warning("time-domain search: broken off: %s: %s", type(error).__name__, error)
    met = [*((space, point) for _, point in elite), *met]
    proposals = [where.proposal(point) for where, point in met]
    if part is not task and proposals:  # to simulate the whole takes long
        ranked = proposals[: settings.part_elite]
        return [task.proposal(one.origin, one.scalars) for one in ranked if one.scalars]
    return [*proposals, *incumbents]
