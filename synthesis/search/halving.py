"""Runs of CMA-ES side by side, of which the worse half ends again and again."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ...models.deadline import Deadline
from ..scaled_gains import Scalars
from ..task import Progress
from .candidates import by_separate_gains
from .cma_run import CmaRun
from .comparison import Comparison


def halve(comparison: Comparison, runs: Sequence[CmaRun], deadline: Deadline, progress: Progress) -> None:
    """Advance all runs, then the better half, then the better half of those, and so on; in the end the best alone."""
    for _ in range(comparison.settings.rounds):
        advance(comparison, runs, comparison.settings.scalars_starts, deadline, progress)
        runs = sorted(runs, key=lambda run: run.best)[: math.ceil(len(runs) / 2)]


def search_separate_gains(
    comparison: Comparison, begins: Sequence[Scalars], runs: list[CmaRun], deadline: Deadline, progress: Progress
) -> None:
    """Go on with separate gains from the beginnings; with every third of the time the worse half of the runs ends.

    So do runs that find nothing better any more. The runs are appended to `runs`, which an interrupt leaves as far as
    they came.
    """
    settings = comparison.settings
    make, more = by_separate_gains(comparison.task)
    points = [np.concatenate([begin.logarithms(), np.zeros(more)]) for begin in begins]
    population, spread = settings.own_gains_population, settings.own_gains_spread
    runs += [CmaRun(comparison.task, make, point, population, spread) for point in points]
    going, begun, waited = list(runs), deadline.share, [0] * len(runs)
    while going and not deadline.passed:
        before = [run.best for run in going]
        advance(comparison, going, settings.own_gains_starts, deadline, progress)
        waited = [0 if run.best < best else count + 1 for run, best, count in zip(going, before, waited, strict=True)]
        third = int(3 * (deadline.share - begun) / (1 - begun))
        kept = sorted(range(len(going)), key=lambda k: going[k].best)[: math.ceil(len(runs) / 2**third)]
        kept = [k for k in kept if waited[k] < settings.patience and not going[k].converged]
        going, waited = [going[k] for k in kept], [waited[k] for k in kept]


def advance(comparison: Comparison, runs: Sequence[CmaRun], count: int, deadline: Deadline, progress: Progress) -> None:
    """A round of generations of all runs, from `count` training starts each, then a comparison of new candidates."""
    generations = comparison.settings.generations
    for generation in range(generations):
        going = [run for run in runs if not run.converged]
        if deadline.passed or not going:
            break
        asked = [run.ask() for run in going]
        costs = comparison.learned([candidate for candidates in asked for candidate in candidates.values()], count)
        for run, candidates in zip(going, asked, strict=True):
            run.tell({number: next(costs) for number in candidates})
        best = min(run.best for run in runs)
        progress(
            f"searching: {best:.0f} s" if best < math.inf else "searching",
            max((generation + 1) / generations, deadline.share),
        )
    new = [(run, candidate) for run in runs for candidate in run.new]
    for (run, candidate), (value, _) in zip(new, comparison.compared([one for _, one in new]), strict=True):
        run.compare(value, candidate)
