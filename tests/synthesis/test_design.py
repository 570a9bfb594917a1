"""Designs: exactly within their conditions, rounded to the given digits, fast, and the same everywhere."""

import json
import math
import os
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Future, ThreadPoolExecutor
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
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
from gaincert.models.saturation import SCALE_NAMES, Saturation
from gaincert.models.starts import Draw
from gaincert.models.tolerance import Tolerance
from gaincert.parallel import local
from gaincert.synthesis import design as design_module
from gaincert.synthesis import measurement
from gaincert.synthesis.design import Design, design
from gaincert.synthesis.measurement import StartSet, controls_of, measure_all
from gaincert.synthesis.modes import modes
from gaincert.synthesis.programs.cones import nearest
from gaincert.synthesis.programs.excitation import flat_tones
from gaincert.synthesis.programs.rates import fastest, rotation, translation
from gaincert.synthesis.programs.weights import design_weights
from gaincert.synthesis.rates import exponential_rate, heading_coefficients, track_coefficients
from gaincert.synthesis.rollouts.settling import Outcomes
from gaincert.synthesis.rounding import floor_digits, rounded
from gaincert.synthesis.scaled_gains import Scalars, structured, within
from gaincert.synthesis.search import ranking
from gaincert.synthesis.settings import BEST, DRAFT, FAST, MODES, WORK_PER_SECOND, Settings
from gaincert.synthesis.task import Candidate, Options, Task, prepare

TINY = replace(
    FAST,
    work=3e6,
    training_starts=8,
    heldout_starts=4,
    ranking_starts=6,
    explored_starts=2,
    learned_starts=2,
    explored=12,
    exploration_batch=12,
    first_horizon=256.0,
    longest_horizon=512.0,
    ranked_horizon=2.0,
    basins=2,
    generations=1,
    population=4,
    elite=2,
)
HERE = str(Path(__file__).resolve())


def line(saturation: dict[str, str] | None = None, **units: int) -> Fleet:
    """Two cars behind a leader, in units of length, time and mass that are so many times smaller."""
    metre, second, kilogram = (units.get(name, 1) for name in ("length", "time", "mass"))
    inertia = kilogram * metre**2
    sizes = {"mass": 4 * kilogram, "inertia": Fraction(1, 8) * inertia, "half_track": Fraction(1, 4) * metre}
    sizes |= {"wheel_radius": Fraction(1, 8) * metre, "torque_limit": Fraction(4 * inertia, second**2)}
    limits = {"speed": Fraction(2 * metre, second), "turn_rate": Fraction(4, second)}
    vehicles = [
        {
            "name": name,
            **{key: decimal_text(Fraction(value)) for key, value in sizes.items()},
            "offset": [-(k + 1) * metre, 0],
            "limits": {key: decimal_text(value) for key, value in limits.items()},
        }
        for k, name in enumerate("ab")
    ]
    content: dict[str, Any] = {
        "name": "line",
        "leader": {"position": [metre, 2 * metre], "heading": "0.5"},
        "graph": {"edges": [["a", "b"]], "leader_links": {"a": 1}},
        "vehicle": vehicles,
    }
    return Fleet.model_validate(content if saturation is None else {**content, "saturation": saturation})


def tiny(fleet: Fleet, **options: Any) -> Design:
    """A short design."""
    return design(fleet, **{"conditions": "corrected", "settings": TINY, "box": 4.0, **options})


@cache
def plain() -> Design:
    """The short design of the line with everything left to it, in this process."""
    return tiny(line())


def numbers(made: Design) -> dict[str, Any]:
    """Everything that a design says, to the last digit."""
    gains = {name: [str(value) for value in getattr(made.gains, name)] for name in GAIN_NAMES}
    scales = {key: [str(value) for value in column] for key, column in made.gains.saturation.columns(2).items()}
    psi = [str(value) for value in (made.excitation.frequency, *made.excitation.sin)]
    return {
        **gains,
        **scales,
        "psi": psi,
        "origin": made.origin,
        "settling": list(made.settling),
        "held": list(made.settling_held),
        "sample time": made.largest_sample_time,
    }


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
    scalars = Scalars(*np.exp(np.random.default_rng(seed).uniform(-5, 5, 10)))
    psi = flat_tones()
    exact = limited.condition_data(psi)
    conditions = CONDITION_SETS[name]
    raw = structured(scalars, limited.plant().m, limited.plant().inertia, floats(exact.degree))
    gains = rounded(conditions, exact, within(conditions, exact.map(floats), raw), digits)
    for inequality in conditions.inequalities(exact_numbers(), exact, gains):
        assert all(inequality.holds), inequality.source
    columns = [*(getattr(gains, key) for key in GAIN_NAMES), *gains.saturation.columns(len(limited)).values()]
    for column in columns:
        for value in column:
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
    typical = prepare(fleet, Options(name, "designed", "unit")).typical
    good = within(conditions, limits, structured(typical, fleet.plant().m, fleet.plant().inertia, limits.degree))
    same = nearest(conditions, limits, good)
    assert same is not None
    assert same.saturation == good.saturation
    for key in GAIN_NAMES:
        assert getattr(same, key) == pytest.approx(getattr(good, key), rel=1e-4)
    repaired = nearest(conditions, limits, replace(good, **{key: 1000 * getattr(good, key) for key in GAIN_NAMES}))
    assert repaired is not None
    for inequality in conditions.inequalities(float_numbers(), limits, repaired):
        assert np.all(inequality.small <= inequality.large * (1 + 1e-6)), inequality.source


@pytest.mark.parametrize("scale", [Saturation(), Saturation(0.5, 0.4, 0.7, 1.3)], ids=["unit", "scaled"])
def test_the_rate_program_reaches_a_rate_that_eigenvalues_confirm(scale: Saturation) -> None:
    """Clarabel's gamma is the rate of the local gains it returns, and more torque never slows it."""
    fleet = paper_fleet()
    plant, limits = fleet.plant(), fleet.condition_data(flat_tones()).map(floats)
    laplacian = plant.graph.composed_laplacian().toarray()
    rates = []
    for share in (0.1, 0.5, 1.0):
        found = fastest(translation(plant, limits, share, scale), laplacian)
        assert found is not None
        gamma, p, d = found
        M, C = plant.m / (p / scale.position), (d / scale.speed) / (p / scale.position)
        assert exponential_rate(M, C, plant.graph.composed_laplacian()) == pytest.approx(gamma, rel=0.01)
        assert np.all(limits.r / 2 * (d + np.sqrt(2) * limits.degree * p) <= share * limits.torque * (1 + 1e-6))
        rates.append(gamma)
    assert rates == sorted(rates)
    heading = fastest(rotation(plant, limits, 0.5, scale), laplacian, 1.3)
    assert heading is not None
    gamma, p, d = heading
    M, C = plant.inertia / (p / scale.heading), (d / scale.turn_rate) / (p / scale.heading)
    assert exponential_rate(M, C, plant.graph.composed_laplacian()) == pytest.approx(gamma, rel=0.01)
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
        made = design(fleet, conditions=name, excitation="designed", settings=DRAFT, executor=executor)
    assert all(np.all(inequality.holds) for inequality in made.inequalities())
    task = prepare(fleet, Options(name, "designed"), DRAFT)
    starts = StartSet.both(task.far_starts(Draw.VALIDATION, 5))
    found = measure_all(task.setup, controls_of([Candidate("", made.gains, made.excitation)]), starts, 3000.0, None)
    for times in found.time.reshape(2, 5):  # continuous torques, and those that are held
        assert times[0] < own_limit
        assert max(times) < other_limit


@pytest.mark.slow
def test_the_same_seed_gives_the_same_gains() -> None:
    first, second = (tiny(line(), conditions="rate-bounded", excitation="designed", seed=3) for _ in range(2))
    assert all(np.array_equal(getattr(first.gains, key), getattr(second.gains, key)) for key in GAIN_NAMES)
    scales = [made.gains.saturation.columns(2) for made in (first, second)]
    assert all(np.array_equal(scales[0][key], scales[1][key]) for key in SCALE_NAMES)
    assert first.excitation == second.excitation
    assert first.settling == second.settling
    assert first.settling_held == second.settling_held
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
        ({"saturation": "none"}, "saturation = 'none'"),
        ({"weights": "none"}, "weights = 'none'"),
        ({"torque_factor": 1.5}, "torque_factor = 1.5"),
        ({"box": 0.0}, "box = 0.0"),
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


def test_given_scales_have_to_be_there() -> None:
    with pytest.raises(InputError, match="no \\[saturation\\] table"):
        design(paper_fleet(), saturation="given")


def test_what_a_design_is_asked_for_reaches_its_task(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: dict[str, Any] = {
        "conditions": "rate-bounded",
        "excitation": "designed",
        "saturation": "unit",
        "seed": 5,
        "digits": 7,
        "tolerance": Tolerance(0.3, 0.2),
        "torque_factor": 0.5,
        "box": 12.0,
    }
    tasks = []

    def prepared(_fleet: Fleet, options: Options, settings: Settings) -> Task:
        tasks.append((options, settings))
        raise InfeasibleError

    monkeypatch.setattr(design_module, "prepare", prepared)
    for mode in MODES:
        with pytest.raises(InfeasibleError):
            design(paper_fleet(), mode=mode, time_limit=100.0, **asked)
    assert [options for options, _ in tasks] == [Options(**asked)] * 3
    assert [settings for _, settings in tasks] == [DRAFT, FAST, replace(BEST, work=100 * WORK_PER_SECOND)]


@pytest.mark.parametrize("factor", [0.01, 0.5, 1.0])
def test_a_share_of_the_torque_is_all_that_is_used(factor: float) -> None:
    """Scalars that ask for far more get that share of the limits, and hardly less."""
    fleet = line()
    task = prepare(fleet, Options("corrected", torque_factor=factor))
    made = task.rounded(task.proposal("", replace(task.typical, time=1e-3 * task.typical.time)))
    limits = fleet.condition_data(made.excitation)
    rows = [one for one in task.conditions.inequalities(exact_numbers(), limits, made.gains) if "(16" in one.source]
    assert rows
    spent = max(float(max(one.small / one.large)) for one in rows)
    assert 0.95 * factor < spent <= factor


def test_a_start_beyond_its_certified_limit_is_infeasible(limited: Fleet) -> None:
    content = limited.model_dump(by_alias=True)
    content["vehicle"][2]["start"]["v"] = 4
    with pytest.raises(InfeasibleError, match="vehicle 'v3': start v = 4 is beyond its certified limit 3"):
        design(Fleet.model_validate(content))


def test_gains_map_keeps_the_names() -> None:
    doubled = paper_gains().map(lambda column: 2 * column)
    assert isinstance(doubled, Gains)
    assert doubled.p_v[0] == 112


@pytest.mark.parametrize("keeps", [False, True])
def test_only_a_long_search_is_kept_from_an_interrupt(keeps: bool, caplog: pytest.LogCaptureFixture) -> None:
    """Mode best does not lose the minutes of search before an interrupt; its best is ranked with the incumbents."""
    assert (FAST.keep_on_interrupt, BEST.keep_on_interrupt) == (False, True)
    task = prepare(line(), Options("corrected", box=4.0), replace(TINY, work=1e9, keep_on_interrupt=keeps))
    known, said = [task.proposal("known", task.typical)], []

    def progress(what: str, _: float) -> None:
        said.append(what)
        if len(said) == 4:
            raise KeyboardInterrupt

    if not keeps:
        with pytest.raises(KeyboardInterrupt):
            design_module.search(task, known, None, progress)
        return
    found = design_module.search(task, known, None, progress)
    assert [one.origin for one in found] == ["time-domain search"] * TINY.elite + ["known"]
    assert "interrupted; the best so far is kept" in caplog.text
    assert len(said) == 4


def test_work_ends_the_search_and_not_the_clock() -> None:
    """More work finds more generations; the number of them does not depend on how fast the machine is."""

    def generations(work: float, delay: float = 0.0) -> int:
        said = []

        def progress(what: str, _: float) -> None:
            said.append(what)
            time.sleep(delay)

        task = prepare(line(), Options("corrected", box=4.0), replace(TINY, work=work, converged=0.0, generations=9))
        design_module.search(task, [], None, progress)
        return len(said)

    assert generations(1e6) == generations(1e6, 0.05) < generations(3e6)


def ranked_by(monkeypatch: pytest.MonkeyPatch, times: Callable[[float, Any], list[list[float]]]) -> list[float]:
    """Let a ranking measure these times (candidates, starts) by horizon and setup; the horizons that it asks for."""
    horizons: list[float] = []

    def measured(setup: Any, _controls: Any, _starts: Any, horizon: float, *_: Any) -> Outcomes:
        horizons.append(horizon)
        found = np.array(times(horizon, setup))
        return Outcomes(np.where(found < horizon, found, math.inf), np.full(found.shape, 2.0), np.ones(found.shape))

    monkeypatch.setattr(ranking, "measure_all", measured)
    monkeypatch.setattr(ranking, "controls_of", lambda candidates: candidates)
    return horizons


def test_candidates_are_simulated_until_the_best_settles_from_every_start(monkeypatch: pytest.MonkeyPatch) -> None:
    """Another one that settles in a short horizon from some starts must not end it all."""
    task: Any = SimpleNamespace(
        settings=replace(FAST, first_horizon=10.0, longest_horizon=1000.0),
        half_width=0.0,
        data=SimpleNamespace(speed=np.ones(2)),
        typical=SimpleNamespace(time=1.0),
        setup=None,
    )
    horizons = ranked_by(monkeypatch, lambda *_: [[5.0, math.inf], [11.0, 36.0]])
    horizon, costs, found = ranking._settled(task, ["never", "later"], None, None)  # type: ignore[list-item,arg-type]
    assert horizons == [10.0, 20.0, 40.0]
    assert horizon == 40
    assert costs[1] < costs[0]
    assert found.tolist() == [[5.0, math.inf], [11.0, 36.0]]
    horizons = ranked_by(monkeypatch, lambda *_: [[5.0, math.inf]])
    assert math.isinf(ranking._settled(task, ["never"], None, None)[2][0, 1])  # type: ignore[list-item,arg-type]
    assert horizons[-1] <= 1000


@pytest.mark.parametrize(("up_to", "found"), [(0.05, 0.0502), (0.02, 0.02), (0.01, 0.01), (0.0, None)])
def test_the_largest_sample_time_is_the_last_from_which_all_starts_settle(
    up_to: float, found: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On a grid of 10^(1/10) around the fleet's own, which every delay survives."""
    task = prepare(line(), Options("corrected"))

    def times(_: float, setup: Any) -> list[list[float]]:
        return [[1.0, 1.0 if setup.disturbance.sample_time <= 1.01 * up_to else math.inf]]

    ranked_by(monkeypatch, times)
    largest = ranking.largest_sample_time(task, None, np.zeros((5, 2, 2)), 10.0, None)  # type: ignore[arg-type]
    assert largest == (None if found is None else pytest.approx(found, rel=1e-3))


def test_a_sample_time_leaves_the_delay() -> None:
    setup = prepare(line(), Options("corrected")).setup
    setup = replace(setup, disturbance=replace(setup.disturbance, delay=6))
    slower = ranking._resampled(setup, 2.0).disturbance
    assert (slower.sample_time, slower.delay) == (2 * setup.disturbance.sample_time, 3)


def test_candidates_that_cannot_be_rounded_are_left_out() -> None:
    """Where none is left, the design says so."""
    task = prepare(line(), Options("corrected"))
    good = task.proposal("good", task.typical)
    bad = replace(good, origin="bad", gains=replace(good.gains, p_v=-good.gains.p_v))
    assert [one.origin for one in ranking.rounded(task, [bad, good])] == ["good"]
    with pytest.raises(UndecidedError, match="not positive"):
        ranking.rounded(task, [bad])


def test_leaving_a_pool_waits_for_no_work() -> None:
    """After an interrupt nobody waits for results that are thrown away."""
    begin = time.monotonic()
    with local(1) as (executor, _):
        assert executor.submit(abs, -1).result() == 1
        executor.submit(time.sleep, 40)
    assert time.monotonic() - begin < 30


def test_the_convex_programs_may_run_elsewhere_and_change_nothing() -> None:
    """The candidates are the same; where the worker dies the design says so."""
    task = prepare(line(), Options("corrected", box=4.0))

    class Elsewhere(ThreadPoolExecutor):
        dies = False

        def submit(self, function: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
            return super().submit(die if self.dies else function, *args, **kwargs)

    def die(*_: Any) -> None:
        raise BrokenExecutor

    with Elsewhere(1) as executor:
        alone, together = design_module.incumbents(task), design_module.incumbents(task, executor)
        executor.dies = True
        with pytest.raises(UndecidedError, match="worker process died"):
            design_module.incumbents(task, executor)
    broken = SimpleNamespace(submit=die)  # as a pool is from then on
    with pytest.raises(UndecidedError, match="worker process died"):
        design_module.incumbents(task, broken)  # type: ignore[arg-type]
    for one, other in zip(alone, together, strict=True):
        assert (one.origin, one.frequency, one.scalars) == (other.origin, other.frequency, other.scalars)
        assert all((getattr(one.gains, key) == getattr(other.gains, key)).all() for key in GAIN_NAMES)
        assert np.array_equal(*(list(vars(made.gains.saturation).values()) for made in (one, other)))
    assert {proposal.origin for proposal in alone} == {"averaged program", "convex programs"}


def test_where_no_program_finds_anything_the_typical_scalars_are_proposed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(design_module, "local_optima", lambda *_: [])
    monkeypatch.setattr(design_module, "convex_designs", lambda *_: [])
    task = prepare(line(), Options("corrected"))
    (only,) = design_module.incumbents(task)
    assert (only.origin, only.scalars) == ("closed form", task.typical)


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
        scales = Saturation(*np.exp(random.uniform(-2, 2, 4)))
        wild = Gains(*np.exp(random.uniform(-2, 8, (5, len(fleet)))), scales)
        gains = rounded(conditions, exact, within(conditions, exact.map(floats), wild), 5)
        sources = [one.source for one in conditions.inequalities(exact_numbers(), exact, gains)]
        assert {"wheel speed limit", "acceleration limit", "turn acceleration limit"} <= set(sources)
        assert all(one.holds.all() for one in conditions.inequalities(exact_numbers(), exact, gains))


GIVEN = {"position": "0.3", "heading": "0.25", "speed": "1.7", "turn_rate": "2.3"}


@pytest.mark.slow
@pytest.mark.parametrize("asked", ["given", None])
def test_given_scales_are_taken_exactly(asked: str | None) -> None:
    """Also where nothing is asked for, even if they have more digits than the gains."""
    made = tiny(line({**GIVEN, "position": "0.312345"}), saturation=asked, digits=3)
    expected = {**GIVEN, "position": "0.312345"}
    for name, column in made.gains.saturation.columns(2).items():
        assert column.tolist() == [Fraction(expected[name])] * 2, name


@pytest.mark.slow
def test_unit_scales_are_the_papers_controller() -> None:
    """Whatever the fleet says."""
    made = tiny(line(GIVEN), saturation="unit")
    assert made.gains.saturation.unit
    assert all(np.all(inequality.holds) for inequality in made.inequalities())


@pytest.mark.slow
def test_designed_scales_are_the_designs_own() -> None:
    """They have the digits asked for, do not depend on those of the fleet, and settle it sooner than unit scales."""
    made, unit = tiny(line(GIVEN), saturation="designed"), tiny(line(), saturation="unit")
    assert numbers(made) == numbers(plain())
    assert not made.gains.saturation.unit
    for column in made.gains.saturation.columns(2).values():
        assert all(len(decimal_text(value).replace(".", "").strip("0")) <= 4 for value in column)
    assert np.mean(made.settling) < np.mean(unit.settling)


@pytest.mark.slow
@pytest.mark.parametrize("unit", ["length", "time", "mass"])
def test_other_units_change_nothing(unit: str) -> None:
    """The same fleet with a unit half as large: the same times, in the units of time, and as many steps.

    All digits are kept, so that only floating point rounds: by a factor of two not even that.
    """
    half = line(**{unit: 2})
    seconds = 2 if unit == "time" else 1
    metres = 2 if unit == "length" else 1
    settings = replace(TINY, sample_time=TINY.sample_time * seconds)
    first = tiny(line(), digits=17)
    second = tiny(half, digits=17, tolerance=Tolerance(0.1 * metres, 0.1), box=4.0 * metres, settings=settings)
    assert max(first.settling) < math.inf
    assert second.origin == first.origin
    assert [time / seconds for time in second.settling] == pytest.approx(first.settling, rel=1e-3)
    assert [time / seconds for time in second.settling_held] == pytest.approx(first.settling_held, rel=1e-3)
    assert first.largest_sample_time is not None
    assert second.largest_sample_time == pytest.approx(seconds * first.largest_sample_time)
    (scale, other), metre = (made.gains.saturation for made in (first, second)), metres
    assert float(other.position) == pytest.approx(float(scale.position) * metre, rel=1e-6)
    assert float(other.heading) == pytest.approx(float(scale.heading), rel=1e-6)
    assert floats(other.speed) == pytest.approx(floats(scale.speed) * metre / seconds, rel=1e-6)
    force = (2 if unit == "mass" else 1) * metre / seconds**2
    assert floats(second.gains.p_v) == pytest.approx(floats(first.gains.p_v) * force, rel=1e-6)
    assert floats(second.gains.k_alpha) == pytest.approx(floats(first.gains.k_alpha) * force * metre, rel=1e-6)


@pytest.mark.parametrize("cores", [1, 2, 3, 7])
def test_outcomes_do_not_depend_on_how_they_are_shared_out(cores: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every controller from every start, the continuous ones first, to the last bit."""
    task = prepare(line(), Options("corrected", box=4.0), TINY)
    proposals = [task.proposal("", task.typical.scaled([1, 1, *[factor] * 8])) for factor in (1.0, 0.8, 1.2, 0.6, 1.5)]
    far = task.far_starts(Draw.TRAINING, 7)
    starts = StartSet(far[..., :4], far[..., 1:])
    controls, horizon = controls_of(proposals), 4000 * task.typical.time
    alone = measure_all(task.setup, controls, starts, horizon, None)
    monkeypatch.setattr(measurement.os, "cpu_count", lambda: cores)
    with ThreadPoolExecutor(2) as executor:
        shared = measure_all(task.setup, controls, starts, horizon, executor)
    assert alone.time.shape == (5, 10)
    assert len(np.unique(alone.time)) > 10
    for one, other in zip(alone, shared, strict=True):
        assert np.array_equal(one, other)


@pytest.mark.slow
@pytest.mark.parametrize("workers", [1, 3])
def test_the_design_is_the_same_for_any_number_of_workers(workers: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(measurement.os, "cpu_count", lambda: workers)
    with local(workers) as (executor, _):
        made = tiny(line(), executor=executor)
    assert numbers(made) == numbers(plain())


def avx512() -> bool:
    """Whether NumPy uses AVX512 here."""
    from numpy._core._multiarray_umath import __cpu_features__

    return bool(__cpu_features__.get("X86_V4") or __cpu_features__.get("AVX512_SKX"))


@pytest.mark.slow
@pytest.mark.skipif(not avx512(), reason="the processor lacks AVX512, or NumPy does not use it")
def test_a_processor_without_avx512_finds_the_same_design() -> None:
    """NumPy's other code rounds some functions differently; the grids of the search are far coarser."""
    environment = {**os.environ, "NPY_DISABLE_CPU_FEATURES": "X86_V4 AVX512_ICL AVX512_SPR"}
    found = subprocess.run([sys.executable, HERE], env=environment, capture_output=True, text=True, timeout=300)
    assert found.returncode == 0, found.stderr
    answer = json.loads(found.stdout.splitlines()[-1])
    assert not answer.pop("avx512")
    assert answer == numbers(plain())


if __name__ == "__main__":
    print(json.dumps({**numbers(plain()), "avx512": avx512()}))
