"""The final ranking: candidates over common starts that the search has not seen."""

from __future__ import annotations

import logging
import math
from collections.abc import Sequence
from concurrent.futures import Executor

from ...models.equations import State
from ...models.starts import Draw
from ..cost import cost
from ..measurement import measure_all
from ..rollouts.settling import Limits
from ..task import Candidate, Progress, Task

LOG = logging.getLogger(__name__)

Ranked = tuple[list[Candidate], list[float]]  # least cost first, and the settling times (s) of the first


def rank_finally(
    task: Task,
    candidates: Sequence[Candidate],
    searched: bool,
    horizon: float,
    executor: Executor | None,
    progress: Progress,
) -> Ranked:
    """The candidates ranked, and the best of them once more from more starts where the settings ask for it."""
    settings = task.settings
    count = settings.ranking_starts if searched else settings.unsearched_ranking_starts
    starts = task.starts(Draw.RANKING, count, settings.ranked_vehicles)
    ranked, times = rank(task, candidates, starts, horizon, executor, progress, settings.keep_on_interrupt)
    if not settings.final_ranking:
        return ranked, times
    final = task.starts(Draw.FINAL_RANKING, settings.final_starts, settings.final_vehicles)
    if len(final) <= len(starts):
        return ranked, times
    try:
        return rank(task, ranked[: settings.final_candidates], final, horizon, executor, progress)
    except KeyboardInterrupt:
        if not settings.keep_on_interrupt:
            raise
        LOG.warning("final ranking: interrupted; the best from %d starts is kept", len(times))
        return ranked, times


def rank(
    task: Task,
    candidates: Sequence[Candidate],
    starts: Sequence[State],
    horizon: float,
    executor: Executor | None,
    progress: Progress,
    keep: bool = False,
) -> Ranked:
    """The candidates by cost over the starts, least first, and the settling times (s) of the first.

    They are simulated up to a share of the horizon, and further where the first does not settle from every start.
    With `keep` an interrupt leaves those that have been measured, if there are any.
    """
    measured: list[tuple[float, int, list[float]]] = []
    try:
        for share in task.settings.ranking_shares:
            measured, end = [], share * horizon
            for number, runs in enumerate(measure_all(task, candidates, starts, Limits(end), executor)):
                measured.append((cost(runs, end, task.settings), number, [run.time for run in runs]))
                progress("ranking candidates by simulation", (number + 1) / len(candidates))
            if max(min(measured)[2]) < math.inf:
                break
    except KeyboardInterrupt:
        if not (keep and measured):
            raise
        LOG.warning("ranking: interrupted; %d of %d candidates are kept", len(measured), len(candidates))
    measured.sort()
    return [candidates[number] for _, number, _ in measured], measured[0][2]
