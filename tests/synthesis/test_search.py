"""The search counts work, so that it ends with the same gains on every machine; an interrupt keeps the best so far."""

import math
import os
import signal
import statistics
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from gaincert.models.errors import InputError
from gaincert.models.files.templates import template_text
from gaincert.models.fleet_tables import DisturbanceTable
from gaincert.models.paper import paper_fleet
from gaincert.models.starts import Draw, random_starts, scale
from gaincert.parallel import local
from gaincert.synthesis import measurement
from gaincert.synthesis.cost import cost
from gaincert.synthesis.design import design, incumbents
from gaincert.synthesis.measurement import StartSet, controls_of, measure_all
from gaincert.synthesis.rollouts.columns import Setup
from gaincert.synthesis.rollouts.settling import Outcomes
from gaincert.synthesis.search import comparison, ranking
from gaincert.synthesis.search import search as search_module
from gaincert.synthesis.search.comparison import Comparison
from gaincert.synthesis.search.exploration import distinct, explore
from gaincert.synthesis.search.halving import Run, halve
from gaincert.synthesis.search.search import search
from gaincert.synthesis.search.space import Space
from gaincert.synthesis.settings import BEST, FAST, Settings
from gaincert.synthesis.starts import slowest_pattern
from gaincert.synthesis.task import Options, Proposal, Task, prepare

from tests.campaigns import faults

GOOD = [1.83, 0.55, 1.16, 3.26, 2.74, 0.44, 0.34, 1.16, 0.07, 1.33]  # on the typical scalars: settles in 30 s
FEW = {"training_starts": 12, "heldout_starts": 4, "ranking_starts": 6, "learned_starts": 4, "explored_starts": 2}
TINY = replace(FAST, work=2e7, explored=12, basins=2, generations=2, population=6, separate_population=6, **FEW)  # type: ignore[arg-type]


def silent(_what: str, _fraction: float) -> None:
    """No progress is shown."""


def task_of(settings: Settings = TINY, **options: Any) -> Task:
    """Designing for the paper's fleet."""
    return prepare(paper_fleet(), Options("corrected", "designed", **options), settings)


def found(task: Task, executor: Any = None) -> list[Any]:
    """What a search without incumbents proposes, in numbers."""
    return [array.tolist() for array in controls_of(search(task, [], executor, silent))]


@pytest.mark.slow
def test_the_search_never_ends_worse_than_it_began() -> None:
    """The incumbents are ranked with the finds, on starts that the search has not tuned to."""
    few = {"learned_starts": 12, "training_starts": 60, "heldout_starts": 24, "ranking_starts": 40}
    fast = replace(FAST, work=1e8, explored=60, generations=2, **few)  # type: ignore[arg-type]
    long = replace(BEST, work=4e8, explored=60, basins=2, generations=3, separate_population=12, **few)  # type: ignore[arg-type]
    with local() as (executor, _):
        task = task_of(long)
        begun = incumbents(task, executor)
        one, best = (
            ranking.best_of(task, search(replace(task, settings=some), begun, executor, silent), executor, silent)
            for some in (fast, long)
        )
        starts = StartSet.both(task.far_starts(Draw.VALIDATION, 40))
        controllers = [best.candidate, one.candidate, *begun]
        outcomes = measure_all(task.setup, controls_of(controllers), starts, 1000.0, executor)
    costs = cost(outcomes.time, outcomes.excess, 1000.0, long)
    assert costs[0] <= 1.1 * costs[1:].min()
    assert best.candidate.origin == "time-domain search"
    assert max(outcomes.time[0]) <= 1.5 * max(outcomes.time[1])
    assert statistics.fmean(outcomes.time[0]) <= 1.2 * statistics.fmean(outcomes.time[1])


def test_a_design_is_the_best_of_its_search(monkeypatch: pytest.MonkeyPatch) -> None:
    """`design` ranks what the search met together with what it began from."""
    asked: list[list[str]] = []
    ranked = ranking.best_of

    def ranking_of(task: Task, proposals: list[Proposal], *rest: Any) -> Any:
        asked.append([one.origin for one in proposals])
        return ranked(task, proposals, *rest)

    monkeypatch.setattr("gaincert.synthesis.design.best_of", ranking_of)
    monkeypatch.setattr(
        "gaincert.synthesis.design.incumbents", lambda task, _: [task.proposal("closed form", task.typical)]
    )
    made = design(paper_fleet(), conditions="corrected", excitation="designed", settings=TINY)
    (origins,) = asked
    assert origins[-1] == "closed form"
    assert set(origins[:-1]) == {"time-domain search"}
    assert made.origin in asked[0]
    assert len(made.settling) == len(made.settling_held) == TINY.ranking_starts


@pytest.mark.slow
def test_an_interrupted_search_writes_the_best_so_far(tmp_path: Path) -> None:
    (tmp_path / "fleet.toml").write_text(template_text("line", 3))
    command = [sys.executable, "-m", "gaincert", "design", str(tmp_path / "fleet.toml"), "-o", str(tmp_path)]
    options = ["--conditions", "corrected", "--mode", "best", "--time-limit", "500"]
    with faults.start([*command, *options]) as running:
        time.sleep(20)
        os.killpg(running.pid, signal.SIGINT)  # as a terminal does: to every process
        try:
            out, err = running.communicate(timeout=120)
        finally:
            if running.poll() is None:
                os.killpg(running.pid, signal.SIGKILL)
    assert running.returncode == 0, err
    assert "interrupted; the best so far is kept" in err
    assert "Traceback" not in err
    assert "settles within" in out
    assert (tmp_path / "design.json").exists()


@pytest.mark.parametrize("kept", [True, False])
def test_an_interrupt_keeps_the_best_of_a_long_search(kept: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever was compared before, least cost first, and the incumbents; a short search lets the interrupt through."""
    task = task_of(replace(TINY, work=1e12, keep_on_interrupt=kept))
    seen: list[tuple[float, Proposal]] = []
    compared = Comparison.compared

    def third(self: Comparison, proposals: list[Proposal]) -> Any:
        if len(seen) >= 6:
            raise KeyboardInterrupt
        costs = compared(self, proposals)
        seen.extend(zip(costs.tolist(), proposals, strict=True))
        return costs

    monkeypatch.setattr(Comparison, "compared", third)
    incumbent = task.proposal("closed form", task.typical)
    if not kept:
        with pytest.raises(KeyboardInterrupt):
            search(task, [incumbent], None, silent)
        return
    *best, last = search(task, [incumbent], None, silent)
    assert last is incumbent
    order = [one.scalars for _, one in sorted(seen, key=lambda pair: pair[0])]
    assert [one.scalars for one in best] == order[: TINY.elite]


def costs_of(times: list[float], horizon: float = 100.0, excess: float = 2.0) -> float:
    """The cost of one candidate with these settling times; those that are inf ended at an excess."""
    far = [0.5 if math.isfinite(time) else excess for time in times]
    return float(cost(np.array([times]), np.array([far]), horizon, FAST)[0])


def test_a_start_that_never_settles_costs_more_than_any_that_does() -> None:
    """The more, the further away it ended; never without bound."""
    good, bad = costs_of([10.0, 99.0]), costs_of([10.0, math.inf], excess=1.0001)
    further, lost = (costs_of([10.0, math.inf], excess=excess) for excess in (5.0, math.inf))
    assert good < bad < further < lost < math.inf


def test_unsettled_starts_cost_more_than_all_starts_settled_late() -> None:
    """All starts settled in half the horizon cost less than half of them unsettled."""
    assert costs_of([50.0] * 32) < costs_of([1.0, math.inf] * 16)


def test_the_cost_is_of_the_starts_and_not_of_their_number() -> None:
    """The same starts twice cost the same, so costs of many and of few starts can be compared."""
    times = [10.0 * k for k in range(1, 9)]
    assert costs_of(times * 2, 1000.0) == pytest.approx(costs_of(times, 1000.0), rel=1e-12)
    assert costs_of([20.0] * 5) == pytest.approx(20.0, rel=1e-12)


def test_late_starts_count_more() -> None:
    """One start twice as late costs more than two half as much, and less than if it alone counted."""
    one, two = costs_of([40.0] * 31 + [80.0]), costs_of([40.0] * 30 + [60.0] * 2)
    assert costs_of([40.0] * 32) < two < one < 0.6 * 80.0


def test_settling_later_never_pays() -> None:
    """The cost rises with every settling time."""
    random = np.random.default_rng(0)
    for _ in range(200):
        times = random.uniform(10, 100, 12).tolist()
        one = int(random.integers(12))
        later = [time + (k == one) for k, time in enumerate(times)]
        assert costs_of(later, 1000.0) > costs_of(times, 1000.0)


def test_near_starts_are_small_errors_across_the_track() -> None:
    """At rest, on the leader's heading, as far away as is asked for; the same however many are drawn."""
    task = task_of()
    near, more = (task.near_starts(Draw.TRAINING, count).astype(float) for count in (8, 12))
    assert (near == more[..., :8]).all()
    theta = float(task.plant.leader_theta)
    along = near[0] * math.cos(theta) + near[1] * math.sin(theta)
    across = near[1] * math.cos(theta) - near[0] * math.sin(theta)
    error = FAST.near_errors * task.tolerance.position
    assert np.abs(along).max() < 1e-6
    assert np.abs(across).max(axis=0) == pytest.approx(error, rel=1e-5)
    assert near[2] == pytest.approx(theta, rel=1e-6)
    assert not near[3:].any()
    assert len({tuple(column) for column in np.round(across.T, 6)}) == 8


def test_every_other_near_start_is_that_of_the_slowest_shape() -> None:
    """About the slowest mode of D^-1 L_l, whose shape is known from eigenvalues; the others are not."""
    task = task_of()
    graph = task.plant.graph
    values, vectors = np.linalg.eig(np.diag(1 / graph.degree) @ graph.composed_laplacian().toarray())
    slowest = np.abs(vectors[:, np.argmin(values.real)].real)
    assert slowest_pattern(graph) == pytest.approx(slowest / slowest.max(), abs=0.03)
    near = task.near_starts(Draw.TRAINING, 20).astype(float)
    size = np.hypot(near[0], near[1])
    ratios = size / slowest[:, None]
    spread = ratios.max(axis=0) / ratios.min(axis=0)
    assert spread[::2].max() <= 1.1 * (1 + FAST.near_patterns) / (1 - FAST.near_patterns)
    assert np.median(spread[1::2]) > 3


def test_near_starts_are_an_even_third_of_the_far_ones() -> None:
    """Even, so that the ideal and the real robot begin from as many; at least one each."""
    for far in range(1, 60):
        count = FAST.near_count(far)
        assert count % 2 == 0
        assert count == 2 or abs(count - FAST.near_share * far) <= 1


def test_candidates_are_explored_with_a_part_of_the_friction(monkeypatch: pytest.MonkeyPatch) -> None:
    """And everything else of the disturbance; compared and ranked with all of it."""
    table = DisturbanceTable(sample_time="0.02", delay="0.04", coulomb="0.2", viscous="0.1")
    task = prepare(paper_fleet().model_copy(update={"disturbance": table}), Options(seed=3), TINY)
    eased, whole = task.eased.disturbance, task.setup.disturbance
    assert replace(eased, coulomb=whole.coulomb, viscous=whole.viscous) == whole
    assert (eased.coulomb, eased.viscous) == (FAST.explored_friction * 0.2, FAST.explored_friction * 0.1)
    met = []

    def noted(setup: Setup, *rest: Any) -> Outcomes:
        met.append(setup.disturbance)
        return measure_all(setup, *rest)

    monkeypatch.setattr(comparison, "measure_all", noted)
    compared, proposal = Comparison(task, None), task.proposal("", task.typical)
    compared.explored([proposal], 1.0)
    compared.least = 0.1
    compared.compared([proposal])
    compared.learned([proposal])
    assert met == [eased, whole, whole]


def test_near_starts_have_to_settle_within_a_part_of_the_tolerance() -> None:
    """An error that stays for good inside the tolerance, but outside that part, has not settled from a near start."""
    task = task_of()
    still = task.proposal("still", task.typical)
    still = replace(still, gains=replace(still.gains, k_alpha=1e-6 * still.gains.k_alpha))
    starts = task.near_starts(Draw.TRAINING, 4)
    starts[:2] *= 0.8 / FAST.near_errors  # now errors of 0.8 tolerances
    measured = measure_all(task.setup, controls_of([still]), StartSet.both(starts, starts), 100.0, None)
    assert np.isfinite(measured.time[0, :8]).all()
    assert np.isinf(measured.time[0, 8:]).all()


def test_near_starts_are_among_the_starts(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of every comparison, for the ideal robot as for the real one."""
    used = recorded(monkeypatch, [20.0] * 3)
    task = task_of()
    trials = Comparison(task, None)
    for ask in (lambda some: trials.explored(some, 100.0), trials.learned, trials.compared):
        ask([task.proposal("here", task.typical)])
    for starts, _ in used:
        distances = [np.hypot(some[0], some[1]).max(axis=0) for some in starts if some is not None]
        limit = 1.01 * FAST.near_errors * task.tolerance.position
        assert [bool((some <= limit).all()) for some in distances] == [False, False, True, True]
        assert all(some.size for some in distances)


def recorded(monkeypatch: pytest.MonkeyPatch, times: list[float]) -> list[tuple[StartSet, float]]:
    """The starts and horizons of rollouts that are not run; all starts of one comparison settle at a time."""
    asked: list[tuple[StartSet, float]] = []
    answers = iter(times)

    def measured(_setup: Any, controls: Any, starts: StartSet, horizon: float, _executor: Any) -> Outcomes:
        asked.append((starts, horizon))
        shape = len(controls.frequency), sum(some.shape[-1] for some in starts)
        return Outcomes(np.full(shape, next(answers)), np.full(shape, 0.5), np.full(shape, 7.0))

    monkeypatch.setattr(comparison, "measure_all", measured)
    return asked


def test_every_generation_learns_from_the_next_starts(monkeypatch: pytest.MonkeyPatch) -> None:
    """Far and near, half of them for each robot; a batch of the exploration takes none away."""
    used = recorded(monkeypatch, [20.0] * 6)
    task = task_of(replace(TINY, training_starts=5, explored_starts=2, learned_starts=2))
    trials = Comparison(task, None)
    far, near = task.far_starts(Draw.TRAINING, 5), task.near_starts(Draw.TRAINING, 5)
    names = {
        some[..., k].tobytes(): name for some, word in ((far, "abcde"), (near, "vwxyz")) for k, name in enumerate(word)
    }

    def explored(some: list[Proposal]) -> Any:
        return trials.explored(some, 100.0)

    asked = (explored, explored, trials.learned, trials.learned, explored, trials.learned)
    for ask in asked:
        ask([task.proposal("here", task.typical)])
    seen = ["".join(names[some[..., 0].tobytes()] for some in starts) for starts, _ in used]
    assert seen == ["abvw", "abvw", "abvw", "cdxy", "eazv", "eazv"]


def test_the_least_cost_so_far_limits_how_far_others_are_simulated(monkeypatch: pytest.MonkeyPatch) -> None:
    """Only costs over the held-out starts set it: luck on few starts sets no limit."""
    used = recorded(monkeypatch, [90.0, 20.0, 1.0, 50.0, 30.0])
    task = task_of()
    trials, one = Comparison(task, None), task.proposal("here", task.typical)
    least = []
    for ask in (trials.learned, trials.compared, trials.learned, trials.compared, trials.learned):
        ask([one])
        least.append(trials.least)
    assert least == pytest.approx([math.inf, 20.0, 20.0, 20.0, 20.0])
    learned, compared = (20.0 * factor for factor in (FAST.learned_horizon, FAST.compared_horizon))
    assert [horizon for _, horizon in used] == pytest.approx(
        [trials.longest, trials.longest, learned, compared, learned]
    )
    assert trials.work == sum(7.0 * sum(some.shape[-1] for some in starts) for starts, _ in used)


def test_the_better_half_of_the_explored_goes_on_until_enough_settle() -> None:
    """The horizon is doubled for them; after the first batch the least cost so far limits it."""
    task = task_of(replace(TINY, basins=1, explored=16, exploration_batch=8))
    space, trials, asked = Space.of(task), Comparison(task, None), []
    begin = trials.shortest

    def explored(proposals: list[Proposal], horizon: float) -> Any:
        asked.append((len(proposals), horizon))
        settles = horizon > 3 * begin
        return np.linspace(begin, 6.0 * begin, len(proposals)) if settles else np.full(len(proposals), 2 * horizon)

    trials.explored = explored  # type: ignore[method-assign, assignment]
    best = explore(trials, space, [space.point(task.typical)], silent)
    limit = FAST.explored_horizon * begin
    assert asked == [(9, begin), (5, 2 * begin), (3, 4 * begin), (8, begin), (4, 2 * begin), (2, limit)]
    assert len(best) == 3 + 2
    assert trials.least == best[0][0] == begin


def test_the_search_begins_in_basins_that_differ() -> None:
    points = [np.array(point) for point in ([0.0, 0.0], [0.1, 0.4], [0.0, 0.6], [2.0, 0.0], [5.0, 0.0])]
    scored = list(enumerate(points))
    kept = distinct(scored, FAST.basin_distance, 3)  # type: ignore[arg-type]
    assert [point.tolist() for point in kept] == [[0.0, 0.0], [0.0, 0.6], [2.0, 0.0]]


def test_random_scalars_are_tried_around_the_incumbents() -> None:
    """All of them come back, least cost first, the incumbents too; the same seed tries the same."""

    def tried(seed: int) -> list[tuple[float, list[float]]]:
        task = task_of(replace(TINY, explored=50), seed=seed)
        space, trials = Space.of(task), Comparison(task, None)
        trials.explored = lambda proposals, _: np.array([abs(one.scalars.e - 1.5) for one in proposals])  # type: ignore[method-assign, assignment, union-attr]
        centres = [space.point(task.typical), space.point(task.typical.scaled([2.0] * 10))]
        return [(value, point.tolist()) for value, point in explore(trials, space, centres, silent)]

    scored, points = tried(0), [point for _, point in tried(0)]
    task = task_of()
    assert len(scored) == 52
    assert [value for value, _ in scored] == sorted(value for value, _ in scored)
    assert Space.of(task).point(task.typical).tolist() in points
    assert scored == tried(0) != tried(1)


class Steps:
    """A comparison in which every generation takes a share of the work."""

    def __init__(self, step: float, **changes: Any) -> None:
        self.settings, self.share, self.least, self.step = replace(FAST, **changes), 0.0, 1.0, step
        self.shares: list[float] = []

    def learned(self, proposals: list[Any]) -> Any:
        self.shares.append(self.share)
        self.share += self.step
        return np.zeros(len(proposals))

    def compared(self, proposals: list[Any]) -> Any:
        return np.array([value for (value,) in proposals])


def counting(best: float, converged: bool = False) -> Any:
    """A run whose points all have one cost; it counts how often it learns."""
    run = SimpleNamespace(best=math.inf, converged=converged, advances=0, ask=lambda: [best], new=[np.array([best])])

    def tell(_costs: Any) -> None:
        run.advances += 1

    run.tell, run.space = tell, SimpleNamespace(size=1, proposal=lambda point: np.atleast_1d(point))
    return run


@pytest.mark.parametrize(
    ("generations", "step", "converged", "advances"),
    [
        (1, 0.25, [], [2, 4, 1, 3, 1]),
        (1, 0.125, [1.0], [2, 1, 1, 8, 1]),
        (3, 0.125, [], [6, 8, 3, 8, 3]),
        (3, 0.5, [], [2, 2, 2, 2, 2]),
        (3, 2.0, [], [1, 1, 1, 1, 1]),
    ],
)
def test_the_better_half_of_the_runs_goes_on(
    generations: int, step: float, converged: list[float], advances: list[int]
) -> None:
    """Until the work is used up, also within a round; a run that has converged ends."""
    runs = [counting(best, best in converged) for best in (3.0, 1.0, 4.0, 2.0, 5.0)]
    trials: Any = Steps(step, generations=generations, elite=3)
    elite = halve(trials, runs, 1.0, [], silent)
    assert [run.advances for run in runs] == advances
    assert [value for value, _ in elite][:1] == [1.0]
    assert len(elite) == 3


@pytest.mark.parametrize(
    ("settings", "shares"), [(FAST, [1.0]), (BEST, [BEST.scalars_share, 1.0])], ids=["fast", "best"]
)
def test_a_share_of_the_work_ends_the_scalars_of_a_long_search_alone(
    monkeypatch: pytest.MonkeyPatch, settings: Settings, shares: list[float]
) -> None:
    """Then separate gains are searched for, from the best scalars; a large fleet has none."""
    given: list[tuple[float, int]] = []

    def halved(_trials: Any, runs: list[Run], until: float, elite: list[Any], _progress: Any) -> None:
        given.append((until, runs[0].space.size))
        elite.append((1.0, np.zeros(runs[0].space.size)))

    monkeypatch.setattr(search_module, "halve", halved)
    monkeypatch.setattr(search_module, "explore", lambda _trials, _space, centres, _progress: [(1.0, centres[0])])
    search(task_of(settings), [], None, silent)
    assert [until for until, _ in given] == shares
    assert [size for _, size in given] == [10, 10 + 7 * 5][: len(shares)]
    given.clear()
    search(task_of(replace(settings, roles_vehicles=5)), [], None, silent)
    assert len(given) == 1


def test_work_ends_the_search(monkeypatch: pytest.MonkeyPatch) -> None:
    """No generation begins once the work is used up, and more of it goes on for longer."""
    shares: list[float] = []
    learned = Comparison.learned

    def counted(self: Comparison, proposals: list[Proposal]) -> Any:
        shares.append(self.share)
        return learned(self, proposals)  # type: ignore[arg-type]

    monkeypatch.setattr(Comparison, "learned", counted)
    begun = []
    for work in (4e7, 1.2e8):
        search(task_of(replace(TINY, work=work)), [], None, silent)
        assert shares == sorted(shares)
        assert shares[0] > 0
        assert shares[-1] < 1
        begun.append(len(shares))
        shares.clear()
    assert begun[0] < begun[1]


def test_the_work_is_that_of_the_rollouts() -> None:
    task = task_of()
    trials, one = Comparison(task, None), task.proposal("here", task.typical.scaled(GOOD))
    trials.compared([one])
    outcomes = measure_all(task.setup, controls_of([one]), trials._heldout, trials.longest, None)
    assert trials.work == outcomes.work.sum() > 0
    assert trials.least == cost(outcomes.time, outcomes.excess, trials.longest, TINY)[0]


def test_in_a_small_fleet_every_vehicle_has_its_own_gains() -> None:
    """And scales. In a larger fleet vehicles of equal role share them: v1 and v5, v2 and v4 of the paper's fleet."""
    assert FAST.separate_vehicles >= 6
    for settings, different in ((TINY, 6), (replace(TINY, separate_vehicles=5), 4)):
        task = task_of(settings)
        space = Space.of(task).with_separate_gains()
        assert space.size == 10 + 7 * (different - 1)
        point = np.concatenate([np.zeros(10), -0.01 * np.arange(1.0, space.size - 9)])
        gains = space.proposal(space.snapped(point)).gains
        speed = np.round(gains.saturation.speed, 9)
        assert len(set(speed)) == different
        assert (speed[0] == speed[4]) == (speed[1] == speed[3]) == (different == 4)
        # Vehicles of one role may still differ in p_v: their torque limits do.
        assert len(set(np.round(gains.p_v * task.data.degree / task.plant.m, 9))) >= different
        same = space.proposal(space.extended(np.zeros(10))).gains
        assert len(set(np.round(same.saturation.speed, 9))) == 1
    unit = Space.of(task_of(saturation="unit"))
    assert (unit.size, unit.with_separate_gains().size) == (6, 6 + 5 * 5)


def test_new_candidates_are_compared_over_starts_that_the_runs_did_not_learn_from() -> None:
    """Luck on the training starts decides nothing; each run learns from its own costs."""
    task = task_of(replace(TINY, generations=1, work=1.0))
    space, trials = Space.of(task), Comparison(task, None)
    runs = [Run(space, np.full(10, begin), 6, 0.1) for begin in (0.0, 0.5)]
    told: list[list[float]] = []
    for run in runs:
        tell = run.tell
        run.tell = lambda costs, tell=tell: (told.append(list(costs)), tell(costs))  # type: ignore[method-assign, misc]

    def learned(proposals: list[Proposal]) -> Any:
        trials.work += 1.0
        return np.arange(float(len(proposals)))[::-1]  # the last of every generation is lucky

    trials.learned = learned  # type: ignore[method-assign, assignment]
    answers = iter([[5.0, 6.0], [4.0, 2.0, 1.0, 3.0]])
    trials.compared = lambda _: np.array(next(answers))  # type: ignore[method-assign, assignment]
    elite = halve(trials, runs, 1.0, [], silent)
    assert told == [[11.0, 10.0, 9.0, 8.0, 7.0, 6.0], [5.0, 4.0, 3.0, 2.0, 1.0, 0.0]]
    assert [run.best for run in runs] == [2.0, 1.0]
    assert [value for value, _ in elite] == [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]  # with the beginnings
    new = [runs[1].new[0], runs[0].new[1], runs[1].new[1], runs[0].new[0]]
    assert all((point == other).all() for (_, point), other in zip(elite[:4], new, strict=True))
    assert (runs[0].new[1] == runs[0]._points[-1]).all()


def test_ranking_starts_are_not_training_starts(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nor those that new candidates are compared over: only the fleet's own start is in all of them."""
    used: dict[str, set[bytes]] = {}
    task = task_of()
    measured = measure_all
    for name, module in (("search", comparison), ("ranking", ranking)):
        columns = used.setdefault(name, set())

        def kept(setup: Any, controls: Any, starts: StartSet, *rest: Any, columns: set[bytes] = columns) -> Outcomes:
            columns |= {some[..., k].tobytes() for some in starts if some is not None for k in range(some.shape[-1])}
            return measured(setup, controls, starts, *rest)

        monkeypatch.setattr(module, "measure_all", kept)
    proposals = search(task, [], None, silent)
    ranking.best_of(task, proposals, None, silent)
    own = task.far_starts(Draw.TRAINING, 1)[..., 0].tobytes()
    assert used["search"] & used["ranking"] == {own}
    assert len(used["ranking"]) >= TINY.ranking_starts + 2
    trials = Comparison(task, None)
    training = {
        some[..., k].tobytes() for some in (trials._training, trials._training_near) for k in range(some.shape[-1])
    }
    heldout = {some[..., k].tobytes() for some in trials._heldout for k in range(some.shape[-1])}
    assert training & heldout == {own}


@pytest.mark.parametrize("workers", [1, 2, 5, 32])
def test_outcomes_do_not_depend_on_the_number_of_workers(workers: int, monkeypatch: pytest.MonkeyPatch) -> None:
    task = task_of()
    controls = controls_of(
        [task.proposal("here", task.typical.scaled(factors)) for factors in (GOOD, [1.0] * 10, [1.1] * 10)]
    )
    far = task.far_starts(Draw.TRAINING, 5)
    alone = measure_all(task.setup, controls, StartSet(far, far[..., :3]), 50.0, None)
    jobs: list[Any] = []

    def run(function: Any, some: list[Any]) -> Iterator[Any]:
        jobs.extend(some)
        return map(function, some)

    monkeypatch.setattr(measurement.os, "cpu_count", lambda: workers)
    executor: Any = SimpleNamespace(map=run)
    together = measure_all(task.setup, controls, StartSet(far, far[..., :3]), 50.0, executor)
    assert len(jobs) >= 2 * min(workers, 9)
    assert alone.time.shape == (3, 8)
    assert np.isfinite(alone.time).any()
    for one, other in zip(alone, together, strict=True):
        assert (one == other).all()


@pytest.mark.slow
def test_a_search_finds_the_same_with_and_without_workers() -> None:
    """For one seed; another seed finds something else."""
    with local(2) as (executor, _):
        shared = found(task_of(), executor)
    assert shared == found(task_of())
    assert shared != found(task_of(seed=1))


def test_starts_are_drawn_from_the_box_that_is_asked_for() -> None:
    fleet = paper_fleet()
    for box, half in ((8.0, 4.0), (None, scale(fleet))):
        task = prepare(fleet, Options("corrected", "designed", box=box))
        starts = task.far_starts(Draw.TRAINING, 21)
        plant, (random,) = fleet.plant(), random_starts(fleet, 1, 0, half, Draw.TRAINING)
        assert starts[0, :, 1] == pytest.approx(random.x - plant.leader_x - plant.offset_x, rel=1e-5, abs=1e-5)
        far = np.abs(starts[0, :, 1:] + plant.offset_x[:, None]).max()
        assert 0.8 * half < far <= half * (1 + 1e-6)
    with pytest.raises(InputError, match=r"box = 0\.0 must be"):
        prepare(fleet, Options("corrected", "designed", box=0.0))


def test_a_large_fleet_is_simulated_from_fewer_starts() -> None:
    """The first ones of the same starts."""
    few, many = (task_of(replace(FAST, starts_vehicles=count)) for count in (20, 2000))
    starts = few.far_starts(Draw.TRAINING, 100)
    assert starts.shape == (5, 6, 3)
    assert (starts == many.far_starts(Draw.TRAINING, 100)[..., :3]).all()
