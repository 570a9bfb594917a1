"""The search can stop at any time: an interrupt ends it with the best so far, and it keeps to its clock."""

import math
import os
import signal
import statistics
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from gaincert.models.arrays import floats
from gaincert.models.deadline import Deadline
from gaincert.models.errors import InputError
from gaincert.models.paper import paper_fleet
from gaincert.models.starts import Draw, random_starts, scale
from gaincert.parallel import local
from gaincert.synthesis.cost import NEVER, Run, cost
from gaincert.synthesis.design import FALLBACK, candidates, design
from gaincert.synthesis.measurement import measure_all
from gaincert.synthesis.rates import CrossTrack
from gaincert.synthesis.rollouts.settling import Limits
from gaincert.synthesis.scaled_gains import Scalars
from gaincert.synthesis.search import comparison, halving
from gaincert.synthesis.search import search as search_module
from gaincert.synthesis.search.candidates import by_scalars, by_separate_gains, distinct
from gaincert.synthesis.search.cma_run import CmaRun
from gaincert.synthesis.search.exploration import explore
from gaincert.synthesis.settings import BEST, FAST, Settings
from gaincert.synthesis.task import Options, prepare

ROOT = Path(__file__).parents[2]
GOOD = Scalars(0.15, 0.26, 3.9, 0.033, 0.14, 3.2)  # the paper's fleet settles after a minute


@pytest.mark.slow
def test_the_search_never_ends_worse_than_it_began() -> None:
    """The incumbents are ranked with the finds, on starts that the search has not tuned to; same seed, same gains."""
    few = replace(BEST, seconds=300.0, basins=2, rounds=2, patience=2, generations=2, explored=12, own_gains_basins=1)
    # As many starts as mode "fast" learns from: the worst of the starts below tells an overfitted search.
    short = {"training_starts": FAST.training_starts, "heldout_starts": FAST.heldout_starts}
    few = replace(few, own_gains_population=12, **short)
    asked = {"conditions": "corrected", "excitation": "designed"}
    with local() as (executor, _):
        fast = design(paper_fleet(), settings=replace(FAST, generations=2), executor=executor, **asked)  # type: ignore[arg-type]
        best, again = (design(paper_fleet(), settings=few, executor=executor, **asked) for _ in range(2))  # type: ignore[arg-type]
        task = prepare(paper_fleet(), Options("corrected", "designed"))
        starts = random_starts(paper_fleet(), 40, 0)
        begun, _ = candidates(task)
        runs, other, *before = measure_all(task, [best, fast, *begun], starts, Limits(1000.0), executor)  # type: ignore[list-item]
    assert cost(runs, 1000.0) <= min(cost(one, 1000.0) for one in before)
    assert max(run.time for run in runs) <= 1.5 * max(run.time for run in other)
    assert statistics.fmean(run.time for run in runs) <= 1.2 * statistics.fmean(run.time for run in other)
    assert all((a == b).all() for a, b in zip(best.gains.__dict__.values(), again.gains.__dict__.values(), strict=True))


@pytest.mark.slow
def test_an_interrupted_search_writes_the_best_so_far(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "gaincert", "design", "examples/paper.toml", "-o", str(tmp_path)]
    options = ["--conditions", "corrected", "--mode", "best", "--time-limit", "500"]
    with subprocess.Popen(
        [*command, *options],
        cwd=ROOT,
        stderr=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as running:
        time.sleep(30)
        os.killpg(running.pid, signal.SIGINT)  # as a terminal does: to every process
        out, err = running.communicate(timeout=120)
    assert running.returncode == 0, err
    assert "Traceback" not in err
    assert "settles within" in out
    assert (tmp_path / "design.json").exists()


def test_a_start_that_never_settles_costs_more_than_any_that_does() -> None:
    good, bad = [Run(10.0, 0.5), Run(90.0, 0.9)], [Run(10.0, 0.5), Run(math.inf, 2.0)]
    assert cost(good, 100.0) < cost(bad, 100.0) < math.inf


def test_no_short_tail_makes_up_for_starts_that_do_not_settle() -> None:
    """A tail ten times as long, with all starts settled in half the horizon, costs less than half of them unsettled."""
    settled = [Run(50.0, 0.5, tail=3000.0)] * 32
    unsettled = [Run(50.0, 0.5, tail=300.0), Run(math.inf, 5.0, tail=300.0)] * 16
    assert cost(settled, 100.0) < cost(unsettled, 100.0)


def test_the_cost_is_of_the_starts_and_not_of_their_number() -> None:
    """The same starts twice cost the same, so costs of many and of few starts can be compared."""
    runs = [Run(10.0 * k, 0.5, tail=100.0) for k in range(1, 9)]
    assert cost(runs * 2, 1000.0) == pytest.approx(cost(runs, 1000.0), rel=1e-12)


def test_one_late_start_counts_and_does_not_decide() -> None:
    """A start 100 times as late, which may be chance, counts only a few times more than one 10 times as late."""
    runs = [Run(40.0, 0.5, tail=100.0)] * 32
    late, later = ([runs[0]._replace(time=time), *runs[1:]] for time in (400.0, 4000.0))
    more, most = (cost(one, 5000.0) - cost(runs, 5000.0) for one in (late, later))
    assert 0.1 * 40.0 < more < 0.2 * 40.0
    assert 2 * more < most < 6 * more


def test_the_tail_is_of_the_candidate_and_not_of_its_starts() -> None:
    """Without chance: the same from any starts, whether or not it is run to the end; twice k_alpha shortens it."""
    task = prepare(paper_fleet(), Options("corrected", "designed"))
    candidate = task.candidate("here", GOOD)
    more = replace(candidate, gains=replace(candidate.gains, k_alpha=2 * candidate.gains.k_alpha))
    tails = [
        {run.tail for run in next(measure_all(task, [one], task.starts(Draw.TRAINING, count), Limits(1.0, most), None))}
        for one, count, most in ((candidate, 2, math.inf), (candidate, 5, 0.1), (more, 2, math.inf))
    ]
    (tail,), (again,), (shorter,) = tails
    assert tail == again
    assert shorter < 0.9 * tail
    runs = [Run(40.0, 0.5, tail=tail)] * 4
    assert cost(runs, 1000.0) > cost([run._replace(tail=shorter) for run in runs], 1000.0)


def test_the_tail_is_that_of_the_slowest_shape() -> None:
    """No other shape of 1 m across the track takes much longer to half the tolerance; all vehicles alike take less."""
    task = prepare(paper_fleet(), Options("corrected", "designed"))
    candidate = task.candidate("here", GOOD)
    (run, *_) = next(measure_all(task, [candidate], task.starts(Draw.TRAINING, 1), Limits(1.0), None))
    track = CrossTrack(task.plant, candidate.gains.map(floats), candidate.excitation)
    random = np.random.default_rng(0).standard_normal((6, 20))
    times = [track.time_to(y / np.abs(y).max(), 0.05, 0.05)[0] for y in [np.ones(6), *random.T]]
    assert times[0] < run.tail
    assert 0.7 * run.tail < max(times) < 1.3 * run.tail


def test_settling_later_never_pays() -> None:
    """The cost rises with every settling time."""
    random = np.random.default_rng(0)
    for _ in range(200):
        runs = [Run(time, 0.5, tail=50.0) for time in random.uniform(10, 100, 12)]
        one = int(random.integers(12))
        later = [run._replace(time=run.time + (k == one)) for k, run in enumerate(runs)]
        assert cost(later, 1000.0) > cost(runs, 1000.0)


def test_an_abandoned_candidate_is_not_run_to_the_end() -> None:
    """Runs that are left out count as never settled, so the candidate ranks behind every complete one."""
    task = prepare(paper_fleet(), Options("corrected", "designed"))
    candidate, starts = task.candidate("here", FALLBACK), task.starts(Draw.TRAINING, 3)
    whole = next(measure_all(task, [candidate], starts, Limits(60.0), None))
    cut = next(measure_all(task, [candidate], starts, Limits(60.0, abandon_above=1.0), None))
    assert cut == [NEVER._replace(tail=whole[0].tail)] * 4
    assert cost(cut, 60.0) > cost(whole, 60.0)


def test_a_start_on_which_the_integrator_gives_up_takes_no_other_with_it() -> None:
    task = prepare(paper_fleet(), Options("corrected", "designed"))
    candidate, starts = task.candidate("here", FALLBACK), task.starts(Draw.TRAINING, 2)
    whole = next(measure_all(task, [candidate], starts, Limits(60.0), None))
    starts[1] = starts[1]._replace(v=np.full(6, np.nan))
    assert next(measure_all(task, [candidate], starts, Limits(60.0), None)) == [
        whole[0],
        NEVER._replace(tail=whole[0].tail),
        whole[2],
    ]


def test_steps_are_counted_and_bounded() -> None:
    """A rollout that runs out of steps has not settled, and says how far away it ended."""
    task = prepare(paper_fleet(), Options("corrected", "designed"))
    candidate, starts = task.candidate("here", GOOD), task.starts(Draw.TRAINING, 2)
    whole = next(measure_all(task, [candidate], starts, Limits(1000.0), None))
    cut = next(measure_all(task, [candidate], starts, Limits(1000.0, steps=100), None))
    assert all(run.time < 1000.0 and run.steps > 100 for run in whole)
    assert all(run.time == math.inf and 1 < run.excess < math.inf and 100 <= run.steps < 200 for run in cut)


def test_the_search_begins_in_basins_that_differ() -> None:
    near, far = (replace(FALLBACK, e=value) for value in (FALLBACK.e * 1.1, FALLBACK.e * 3))
    begins = [SimpleNamespace(scalars=scalars) for scalars in (FALLBACK, None, near, far)]
    assert distinct(begins, FAST.basin_distance) == [FALLBACK, far]  # type: ignore[arg-type]


def fewer(**changes: Any) -> Settings:
    """FAST with one random start for each purpose."""
    return replace(FAST, training_starts=0, heldout_starts=0, **changes)


def test_random_scalars_are_tried_around_the_incumbents(monkeypatch: pytest.MonkeyPatch) -> None:
    """All of them come back, least cost first, the incumbents too; the same seed tries the same."""
    task = prepare(paper_fleet(), Options("corrected", "designed"), fewer(explored=50))
    incumbent = task.candidate("here", FALLBACK)

    def found() -> list[Any]:
        trials = comparison.Comparison(task, 60.0, None)
        monkeypatch.setattr(trials, "explored", lambda batch: [(abs(one.scalars.e - 1.0), one) for one in batch])
        return explore(trials, [incumbent], Deadline(100.0), lambda *_: None)

    tried = found()
    distances = [abs(candidate.scalars.e - 1.0) for candidate in tried]
    assert incumbent in tried
    assert len(tried) == 51
    assert distances == sorted(distances)
    assert [one.scalars for one in tried] == [one.scalars for one in found()]


def test_the_better_half_of_the_runs_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    runs = [SimpleNamespace(best=best, advances=0) for best in (3.0, 1.0, 4.0, 2.0, 5.0)]

    def advance(_trials: Any, going: list[Any], *_: Any) -> None:
        for run in going:
            run.advances += 1

    monkeypatch.setattr(halving, "advance", advance)
    trials: Any = SimpleNamespace(settings=replace(FAST, rounds=5))
    halving.halve(trials, runs, Deadline(100.0), lambda *_: None)  # type: ignore[arg-type]
    assert [run.advances for run in runs] == [2, 5, 1, 3, 1]


@pytest.mark.parametrize(("step", "gain", "advances"), [(0.12, 0.01, [3, 9, 3, 6]), (0.0, 0.0, [8, 8, 8, 8])])
def test_runs_over_separate_gains_end_with_the_time_and_where_they_find_nothing(
    monkeypatch: pytest.MonkeyPatch, step: float, gain: float, advances: list[int]
) -> None:
    """The worse half with every third of the time, all with the last; any after `patience` comparisons in vain."""
    bests, clock = iter([3.0, 1.0, 4.0, 2.0]), SimpleNamespace(share=0.0, passed=False)
    monkeypatch.setattr(halving, "CmaRun", lambda *_: SimpleNamespace(best=next(bests), converged=False, advances=0))

    def advance(_trials: Any, going: list[Any], *_: Any) -> None:
        clock.share += step
        clock.passed = clock.share > 1
        for run in going:
            run.advances += 1
            run.best -= gain

    monkeypatch.setattr(halving, "advance", advance)
    task = prepare(paper_fleet(), Options("corrected", "designed"))
    trials: Any = SimpleNamespace(task=task, settings=task.settings)
    runs: list[Any] = []
    halving.search_separate_gains(trials, [FALLBACK] * 4, runs, clock, lambda *_: None)  # type: ignore[arg-type]
    assert [run.advances for run in runs] == advances


def test_in_a_small_fleet_every_vehicle_has_its_own_gains() -> None:
    """In a larger fleet vehicles of equal role share them: v1 and v5, v2 and v4 of the paper's fleet."""
    task = prepare(paper_fleet(), Options("corrected", "designed"))
    make, more = by_separate_gains(task)
    assert more == 25
    point = np.concatenate([FALLBACK.logarithms(), -np.arange(25.0)])
    every = {
        float(gain / vehicle.mass) for gain, vehicle in zip(make(point).gains.p_v, task.fleet.vehicles, strict=True)
    }
    assert len(every) == 6
    by_roles = prepare(paper_fleet(), Options("corrected", "designed"), replace(FAST, own_gains_vehicles=5))
    assert by_separate_gains(by_roles)[1] == 15


def test_new_candidates_are_compared_over_starts_that_the_runs_did_not_learn_from() -> None:
    """Luck on the training starts decides nothing; all runs learn from the same starts, each from its own costs."""
    task = prepare(paper_fleet(), Options("corrected", "designed"), fewer())
    trials = comparison.Comparison(task, 60.0, None)
    lucky, good, other = (task.candidate(name, FALLBACK) for name in ("lucky", "good", "other"))
    luck = {lucky: 1.0, good: 2.0, other: 3.0}
    told: list[dict[int, float]] = []

    def run_of(generation: list[Any]) -> Any:
        run = CmaRun(task, by_scalars(task), FALLBACK.logarithms(), 4, 0.3)
        run.ask = lambda: dict(enumerate(generation))  # type: ignore[method-assign]

        def tell(costs: dict[int, float]) -> None:
            told.append(costs)
            run.new = generation

        run.tell = tell  # type: ignore[method-assign]
        return run

    first, second = run_of([lucky, good]), run_of([other])
    trials.learned = lambda batch, _count: iter([luck[one] for one in batch])  # type: ignore[method-assign]
    trials.compared = lambda batch: [(10 - luck[one], one) for one in batch]  # type: ignore[method-assign]
    halving.advance(trials, [first, second], 1, Deadline(100.0), lambda *_: None)
    assert told == [{0: 1.0, 1: 2.0}, {0: 3.0}] * FAST.generations
    assert (first.candidates(), first.best) == ([good, lucky], 8.0)
    assert (second.candidates(), second.best) == ([other], 7.0)


def test_every_generation_learns_from_the_next_starts(monkeypatch: pytest.MonkeyPatch) -> None:
    used: list[list[Any]] = []

    def measured(_task: Any, batch: list[Any], starts: list[Any], *_: Any) -> Any:
        used.append(starts)
        return iter([[Run(20.0, 0.5)]] * len(batch))

    monkeypatch.setattr(comparison, "measure_all", measured)
    trials = comparison.Comparison(prepare(paper_fleet(), Options("corrected", "designed"), fewer()), 300.0, None)
    trials.training = list("abcde")  # type: ignore[arg-type]
    for count in (2, 2, 2, 9):
        assert len(list(trials.learned([None], count))) == 1  # type: ignore[list-item]
    assert ["".join(starts) for starts in used] == ["ab", "cd", "ea", "bcdea"]


def test_the_best_mean_so_far_limits_how_far_others_are_simulated(monkeypatch: pytest.MonkeyPatch) -> None:
    """A fleet that is settled from the start leaves a horizon, and one that never settles a finite one."""
    asked: list[Limits] = []
    answers = iter([NEVER, Run(20.0, 0.5, 100), Run(0.0, 0.1, 7), NEVER])

    def measured(_task: Any, _candidates: Any, _starts: Any, limits: Limits, _executor: Any) -> Any:
        asked.append(limits)
        return iter([[next(answers)]])

    monkeypatch.setattr(comparison, "measure_all", measured)
    trials = comparison.Comparison(prepare(paper_fleet(), Options("corrected", "designed"), fewer()), 300.0, None)
    for _ in range(4):
        trials.compared([None])  # type: ignore[list-item]
    bounds = FAST.compared
    assert asked[0] == asked[1] == (300.0, math.inf, FAST.most_steps)
    assert asked[2] == (bounds.horizon * 20, bounds.abandon_above * 20, bounds.steps * 100)
    assert asked[3] == (bounds.horizon * FAST.least_mean, bounds.abandon_above * FAST.least_mean, bounds.steps * 7)


def test_results_from_few_starts_set_no_limit_once_there_are_results_from_more(monkeypatch: pytest.MonkeyPatch) -> None:
    """How far others are simulated follows the cheapest from the most starts so far, not the one of least mean."""
    answers = iter(
        [
            [[Run(20.0, 0.5, 10, tail=100.0)], [Run(15.0, 0.5, 20, tail=1e5)]],
            [[Run(30.0, 0.5, 30, tail=100.0)] * 2, [Run(math.inf, 9.0, 40, tail=100.0)] * 2],
            [[Run(1.0, 0.5, 50, tail=100.0)], [NEVER]],
        ]
    )
    monkeypatch.setattr(comparison, "measure_all", lambda *_: iter(next(answers)))
    trials = comparison.Comparison(prepare(paper_fleet(), Options("corrected", "designed"), fewer()), 300.0, None)
    seen = []
    for ask in (trials.explored, trials.compared, trials.explored):
        ask([None, None])  # type: ignore[list-item]
        seen.append((trials.least, trials._steps))
    assert seen == [(20.0, 10), (30.0, 30), (30.0, 30)]


@pytest.mark.parametrize(
    ("settings", "limits"),
    [
        (FAST, {"explore": 100.0, "halve": 100.0}),
        (BEST, {"explore": 20.0, "halve": 20.0, "search_separate_gains": 100.0}),
    ],
    ids=["fast", "best"],
)
def test_a_share_of_the_time_ends_the_scalars_of_a_long_search_alone(
    monkeypatch: pytest.MonkeyPatch, settings: Settings, limits: dict[str, float]
) -> None:
    """Mode fast ends by itself: on a slow machine the clock must not choose another design."""
    given: dict[str, float] = {}

    def part(name: str) -> Any:
        def until(*arguments: Any) -> list[Any]:
            given[name] = arguments[-2]
            return []

        return until

    monkeypatch.setattr(search_module, "Deadline", lambda seconds: seconds)
    for name in ("explore", "halve", "search_separate_gains"):
        monkeypatch.setattr(search_module, name, part(name))
    task = prepare(paper_fleet(), Options("corrected", "designed"), replace(settings, seconds=100.0))
    search_module.search(task, [], 300.0, None, lambda *_: None)
    assert given == limits


def test_starts_are_drawn_from_the_box_that_is_asked_for() -> None:
    fleet = paper_fleet()
    plant = fleet.plant()
    for box, half in ((8.0, 4.0), (None, scale(fleet))):
        task = prepare(fleet, Options("corrected", "designed", box=box))
        far = max(np.abs(start.x - plant.leader_x).max() for start in task.starts(Draw.TRAINING, 20)[1:])
        assert 0.8 * half < far <= half
    with pytest.raises(InputError, match=r"box = 0\.0 must be"):
        prepare(fleet, Options("corrected", "designed", box=0.0))
