"""Random scalars around the candidates of the programs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...models.deadline import Deadline
from ..task import Candidate, Progress
from .candidates import SCALARS, by_cost, by_scalars, distinct, possible
from .comparison import Comparison


def explore(
    comparison: Comparison, incumbents: Sequence[Candidate], deadline: Deadline, progress: Progress
) -> list[Candidate]:
    """The incumbents and random scalars around those that have some, by cost over a few starts, least first."""
    settings = comparison.settings
    make, random = by_scalars(comparison.task), np.random.default_rng(comparison.task.options.seed)
    with_scalars = [candidate for candidate in incumbents if candidate.scalars]
    compared = comparison.explored(with_scalars or incumbents)
    centres = [scalars.logarithms() for scalars in distinct(with_scalars, settings.basin_distance)]
    for begin in range(0, settings.explored if centres else 0, settings.exploration_batch):
        if deadline.passed:
            break
        count = min(settings.exploration_batch, settings.explored - begin)
        points = random.choice(centres, count)
        points = points + settings.exploration_spread * random.standard_normal((count, SCALARS))
        candidates = [candidate for point in points if (candidate := possible(make, point))]
        compared += comparison.explored(candidates)
        progress("searching: random scalars", min(1.0, len(compared) / settings.explored))
    return [candidate for _, candidate in by_cost(compared)]
