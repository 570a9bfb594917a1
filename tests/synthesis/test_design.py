"""Designs: exactly within their conditions, rounded to the given digits, and fast."""

import math
import time
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, Future, ThreadPoolExecutor
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from gaincert.models.arrays import floats
from gaincert.models.conditions import CONDITION_SETS, condition_set, exact_numbers, float_numbers
from gaincert.models.errors import InfeasibleError, InputError, UndecidedError
from gaincert.models.fleet import Fleet
from gaincert.models.gains import GAIN_NAMES, Gains
from gaincert.models.numbers import decimal_text
from gaincert.models.paper import paper_excitation, paper_fleet, paper_gains
from gaincert.models.starts import random_starts
from gaincert.models.tolerance import Tolerance
from gaincert.parallel import local
from gaincert.synthesis import design as design_module
from gaincert.synthesis.cost import Run
from gaincert.synthesis.design import FALLBACK, design
from gaincert.synthesis.measurement import Job, measure
from gaincert.synthesis.modes import modes
from gaincert.synthesis.programs.cones import nearest
from gaincert.synthesis.programs.excitation import flat_tones
from gaincert.synthesis.programs.rates import fastest, rotation, translation
from gaincert.synthesis.programs.weights import design_weights
from gaincert.synthesis.rates import exponential_rate, heading_coefficients, track_coefficients
from gaincert.synthesis.rollouts.settling import Limits
from gaincert.synthesis.rounding import floor_digits, rounded
from gaincert.synthesis.scaled_gains import Scalars, structured, within
from gaincert.synthesis.search import ranking
from gaincert.synthesis.settings import BEST, FAST, Settings
from gaincert.synthesis.task import Options, Task, prepare

SETS = list(CONDITION_SETS)


@pytest.fixture(scope="module")
def limited() -> Fleet:
    """The paper's fleet with speed and turn-rate limits on every vehicle."""
    fleet = paper_fleet()
    content = fleet.model_dump(by_alias=True)
    for vehicle in content["vehicle"]:
        vehicle["limits"] = {"speed": 3, "turn_rate": 3}
    return Fleet.model_validate(content)


@pytest.mark.parametrize("name", SETS)
@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("digits", [2, 4, 9])
def test_any_scalars_become_exact_gains_within_the_conditions(
    name: str, seed: int, digits: int, limited: Fleet
) -> None:
    """The closed form is feasible for every fleet, scalars and digits, and rounding keeps it so."""
    scalars = Scalars(*np.exp(np.random.default_rng(seed).uniform(-5, 5, 6)))
    psi = flat_tones()
    exact = limited.condition_data(psi)
    conditions = CONDITION_SETS[name]
    raw = structured(scalars, limited.plant().m, limited.plant().inertia, floats(exact.degree))
    gains = rounded(conditions, exact, within(conditions, exact.map(floats), raw), digits)
    for inequality in conditions.inequalities(exact_numbers(), exact, gains):
        assert all(inequality.holds), inequality.source
    for key in GAIN_NAMES:
        for value in getattr(gains, key):
            assert value > 0
            assert len(decimal_text(value).replace(".", "").strip("0")) <= digits


def test_rounding_loses_no_more_than_the_last_digits() -> None:
    values = np.array([1.23456, 99.9999, 1e-7, 8.0])
    assert [float(value) for value in floor_digits(values, 3)] == [1.23, 99.9, float(floor_digits(values, 3)[2]), 8]
    assert all(0 <= Fraction(v) - r <= Fraction(v) / 100 for v, r in zip(values, floor_digits(values, 3), strict=True))


@pytest.mark.parametrize("name", SETS)
def test_nearest_gains_leave_feasible_ones_alone_and_repair_others(name: str) -> None:
    fleet, conditions = paper_fleet(), CONDITION_SETS[name]
    limits = fleet.condition_data(flat_tones()).map(floats)
    good = within(conditions, limits, structured(FALLBACK, fleet.plant().m, fleet.plant().inertia, limits.degree))
    same = nearest(conditions, limits, good)
    assert same is not None
    for key in GAIN_NAMES:
        assert getattr(same, key) == pytest.approx(getattr(good, key), rel=1e-4)
    repaired = nearest(conditions, limits, good.map(lambda column: 1000 * column))
    assert repaired is not None
    for inequality in conditions.inequalities(float_numbers(), limits, repaired):
        assert np.all(inequality.small <= inequality.large * (1 + 1e-6)), inequality.source


def test_the_rate_program_reaches_a_rate_that_eigenvalues_confirm() -> None:
    """Clarabel's gamma is the rate of the gains it returns, and more torque never slows it."""
    fleet = paper_fleet()
    plant, limits = fleet.plant(), fleet.condition_data(flat_tones()).map(floats)
    laplacian = plant.graph.composed_laplacian().toarray()
    rates = []
    for share in (0.1, 0.5, 1.0):
        found = fastest(translation(plant, limits, share), laplacian)
        assert found is not None
        gamma, p, d = found
        assert exponential_rate(plant.m / p, d / p, plant.graph.composed_laplacian()) == pytest.approx(gamma, rel=0.01)
        assert np.all(limits.r / 2 * (d + np.sqrt(2) * limits.degree * p) <= share * limits.torque * (1 + 1e-6))
        rates.append(gamma)
    assert rates == sorted(rates)
    heading = fastest(rotation(plant, limits, 0.5, 1.0), laplacian, 1.3)
    assert heading is not None
    assert np.all(heading[2] >= 1.3 * heading[1] * limits.degree * (1 - 1e-6))


def test_certified_rates_are_those_of_the_eigenvalues() -> None:
    """No mode of M s^2 + C s + L_l decays slower than the certified rate, and the rate is not far below the slowest."""
    plant, gains = paper_fleet().plant(), paper_gains().map(floats)
    laplacian = plant.graph.composed_laplacian().toarray()
    for M, C in (heading_coefficients(plant, gains), track_coefficients(plant, gains)):
        rate = exponential_rate(M, C, plant.graph.composed_laplacian())
        companion = np.block([[np.zeros((6, 6)), np.eye(6)], [-laplacian / M[:, None], -np.diag(C / M)]])
        slowest = -np.linalg.eigvals(companion).real.max()
        assert 0.8 * slowest <= rate <= slowest * (1 + 1e-9)


def test_designed_psi_is_flat_and_has_no_mean() -> None:
    psi = flat_tones()
    assert psi.mean == 0
    assert 0.999 < psi.bound < 1.001
    assert float(psi.sin[0]) == pytest.approx(1.20711, abs=2e-4)  # the largest first tone of three
    assert psi.persistent


def test_designed_weights_raise_the_slowest_mode_on_the_same_links() -> None:
    fleet = paper_fleet()
    links = design_weights(fleet)
    assert [edge[:2] for edge in links.edges] == [edge[:2] for edge in fleet.links.edges]
    assert set(links.leader_links) == set(fleet.links.leader_links)
    for (*_, new), (*_, old) in zip(links.edges, fleet.links.edges, strict=True):
        assert old / 10 <= new <= old * 10
    before, after = (float(modes(f.plant().graph).eigenvalues[0]) for f in (fleet, fleet.with_links(links)))
    assert after > 2 * before


@pytest.mark.slow
@pytest.mark.parametrize(("name", "own_limit", "other_limit"), [("paper", 600, 1500), ("corrected", 250, 250)])
def test_the_papers_fleet_settles(name: str, own_limit: float, other_limit: float) -> None:
    """From the paper's start and from four random starts that the design has not seen."""
    fleet = paper_fleet()
    with local() as (executor, _):
        made = design(fleet, conditions=name, excitation="designed", executor=executor)
    assert all(np.all(inequality.holds) for inequality in made.inequalities())
    start = fleet.start()
    assert start is not None
    starts = [start, *random_starts(fleet, 4, seed=1234)]
    limits = Limits(2 * other_limit)
    (measured,) = measure(Job(fleet.plant(), [made], starts, limits, Tolerance(), FAST))  # type: ignore[list-item]
    times = [run.time for run in measured]
    assert times[0] < own_limit
    assert max(times) < other_limit


@pytest.mark.slow
def test_the_same_seed_gives_the_same_gains(limited: Fleet) -> None:
    settings = replace(FAST, generations=1)
    asked = {"conditions": "rate-bounded", "excitation": "designed", "seed": 3, "settings": settings}
    first, second = (design(limited, **asked) for _ in range(2))  # type: ignore[arg-type]
    assert all(np.array_equal(getattr(first.gains, key), getattr(second.gains, key)) for key in GAIN_NAMES)
    assert first.excitation == second.excitation
    assert {inequality.source for inequality in first.inequalities()} >= {
        "(15')",
        "(16*)",
        "speed limit",
        "turn rate limit",
    }


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"conditions": "none"}, "conditions = 'none'"),
        ({"mode": "slow"}, "mode = 'slow'"),
        ({"excitation": "none"}, "excitation = 'none'"),
        ({"digits": 0}, "digits = 0"),
    ],
)
def test_an_unknown_choice_is_named(wrong: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        design(paper_fleet(), **wrong)  # type: ignore[arg-type]


def test_a_given_psi_has_to_be_there() -> None:
    fleet = paper_fleet().model_copy(update={"excitation": None})
    with pytest.raises(InputError, match="no \\[excitation\\] table"):
        design(fleet, excitation="given")


def test_a_start_beyond_its_certified_limit_is_infeasible(limited: Fleet) -> None:
    content = limited.model_dump(by_alias=True)
    content["vehicle"][2]["start"]["v"] = 4
    with pytest.raises(InfeasibleError, match="vehicle 'v3': start v = 4 is beyond its certified limit 3"):
        design(Fleet.model_validate(content))


def test_gains_map_keeps_the_names() -> None:
    doubled = paper_gains().map(lambda column: 2 * column)
    assert isinstance(doubled, Gains)
    assert doubled.p_v[0] == 112


def test_an_interrupt_of_the_final_ranking_keeps_the_one_before(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """An interrupt in the final ranking does not lose the ten minutes of search before it."""
    task = prepare(paper_fleet(), Options("corrected", "designed"), BEST)

    def rank(_task: Task, candidates: list[Any], starts: list[Any], *_: Any) -> Any:
        if len(starts) > FAST.ranking_starts + 1:
            raise KeyboardInterrupt
        assert len(starts) <= FAST.ranked_vehicles // len(task.fleet)
        return candidates, [7.0, 9.0]

    monkeypatch.setattr(ranking, "rank", rank)
    ranked = ranking.rank_finally(task, ["before"], True, 300.0, None, lambda *_: None)  # type: ignore[list-item]
    assert ranked == (["before"], [7.0, 9.0])
    assert "final ranking: interrupted; the best from 2 starts is kept" in caplog.text


def test_an_interrupt_of_a_ranking_keeps_what_is_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    task = SimpleNamespace(settings=FAST)

    def measured(*_: Any) -> Iterator[list[Run]]:
        yield [Run(3.0, 0.5)]
        yield [Run(2.0, 0.5)]
        raise KeyboardInterrupt

    def ranked(**options: bool) -> Any:
        return ranking.rank(task, [1, 2, 3], [], 10.0, None, lambda *_: None, **options)  # type: ignore[arg-type,list-item]

    monkeypatch.setattr(ranking, "measure_all", measured)
    assert ranked(keep=True) == ([2, 1], [2.0])
    with pytest.raises(KeyboardInterrupt):
        ranked()


def test_candidates_are_simulated_until_the_first_settles_from_every_start(monkeypatch: pytest.MonkeyPatch) -> None:
    """A short tail puts one first that does not settle in a short horizon: another that does must not end it all."""
    horizons: list[float] = []

    def measured(_task: Any, _candidates: Any, _starts: Any, limits: Limits, *_: Any) -> Iterator[list[Run]]:
        horizons.append(limits.horizon)
        yield [Run(10.0, 0.5, tail=1e5), Run(12.0, 0.5, tail=1e5)]
        times = [11.0 if limits.horizon > 30 else math.inf, 40.0 if limits.horizon > 40 else math.inf]
        yield [Run(time, 2.0, tail=0.1) for time in times]

    monkeypatch.setattr(ranking, "measure_all", measured)
    task: Any = SimpleNamespace(settings=FAST)
    ranked, times = ranking.rank(task, ["slow tail", "later"], [], 640.0, None, lambda *_: None)  # type: ignore[list-item]
    assert horizons == [10.0, 40.0, 160.0]
    assert (ranked, times) == (["later", "slow tail"], [11.0, 40.0])


@pytest.mark.parametrize(("settings", "keeps"), [(FAST, [False]), (BEST, [True, False])])
def test_only_a_long_search_is_kept_from_an_interrupt(
    settings: Settings, keeps: list[bool], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The final ranking of mode best has the ranking before it to fall back on."""
    kept = []

    def rank(*arguments: Any) -> tuple[list[Any], list[float]]:
        kept.append(len(arguments) > 6 and arguments[6])
        return [], [7.0]

    monkeypatch.setattr(ranking, "rank", rank)
    task = prepare(paper_fleet(), Options("corrected", "designed"), settings)
    ranking.rank_finally(task, [], True, 300.0, None, lambda *_: None)
    assert kept == keeps


def test_leaving_a_pool_waits_for_no_work() -> None:
    """After an interrupt nobody waits for results that are thrown away."""
    begin = time.monotonic()
    with local(1) as (executor, _):
        assert executor.submit(abs, -1).result() == 1
        executor.submit(time.sleep, 40)
    assert time.monotonic() - begin < 30


def test_the_convex_programs_may_run_elsewhere_and_change_nothing() -> None:
    """The candidates are the same; where the worker dies the design says so."""
    task = prepare(paper_fleet(), Options("corrected", "designed"))

    class Elsewhere(ThreadPoolExecutor):
        dies = False

        def submit(self, function: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
            return super().submit(die if self.dies else function, *args, **kwargs)

    def die(*_: Any) -> None:
        raise BrokenExecutor

    with Elsewhere(1) as executor:
        alone, together = design_module.candidates(task), design_module.candidates(task, executor)
        executor.dies = True
        with pytest.raises(UndecidedError, match="worker process died"):
            design_module.candidates(task, executor)
    broken = SimpleNamespace(submit=die)  # as a pool is from then on
    with pytest.raises(UndecidedError, match="worker process died"):
        design_module.candidates(task, broken)  # type: ignore[arg-type]
    for one, other in zip(alone[0], together[0], strict=True):
        assert one.origin == other.origin
        assert all((a == b).all() for a, b in zip(vars(one.gains).values(), vars(other.gains).values(), strict=True))
    assert {candidate.origin for candidate in alone[0]} == {"averaged program", "convex programs"}


def test_limits_of_wheels_and_accelerations_are_designed_for() -> None:
    """Random gains far outside every limit are moved inside, exactly, by the closed form and by rounding."""
    limits = {"speed": 1, "turn_rate": 2, "wheel_speed": 30, "acceleration": "0.5", "turn_acceleration": 1}
    content = paper_fleet().model_dump(mode="json", by_alias=True)
    for vehicle in content["vehicle"]:
        vehicle["limits"] = limits
    fleet = Fleet.model_validate(content)
    conditions = condition_set("rate-bounded")
    exact = fleet.condition_data(paper_excitation())
    random = np.random.default_rng(0)
    for _ in range(20):
        wild = Gains(*np.exp(random.uniform(-2, 8, (5, len(fleet)))))
        gains = rounded(conditions, exact, within(conditions, exact.map(floats), wild), 5)
        sources = [one.source for one in conditions.inequalities(exact_numbers(), exact, gains)]
        assert {"wheel speed limit", "acceleration limit", "turn acceleration limit"} <= set(sources)
        assert all(one.holds.all() for one in conditions.inequalities(exact_numbers(), exact, gains))
