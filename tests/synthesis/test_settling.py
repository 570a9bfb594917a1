"""Rollouts side by side: as accurate as one by one, and independent of each other."""

import math
import statistics
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from gaincert.models.equations import State
from gaincert.models.paper import paper_fleet
from gaincert.models.starts import Draw
from gaincert.synthesis.measurement import controls_of
from gaincert.synthesis.rollouts.columns import Columns, Setup
from gaincert.synthesis.rollouts.continuous import Continuous
from gaincert.synthesis.rollouts.disturbance import Disturbance as Ranked
from gaincert.synthesis.rollouts.runge_kutta import Array
from gaincert.synthesis.rollouts.sampled import Sampled
from gaincert.synthesis.rollouts.settling import Outcomes, settle_all
from gaincert.synthesis.settings import FAST
from gaincert.synthesis.task import Candidate, Options, Task, prepare
from gaincert.verify.simulation import sampled_loop
from gaincert.verify.simulation.closed_loop import ClosedLoop
from gaincert.verify.simulation.disturbance import Disturbance as Verified
from gaincert.verify.simulation.integrators import Adams, Dop853
from gaincert.verify.simulation.sampled_loop import SampledLoop

HORIZON = 1000.0  # s
KINDS = [Continuous, Sampled]
GOOD = [1.83, 0.55, 1.16, 3.26, 2.74, 0.44, 0.34, 1.16, 0.07, 1.33]  # on the typical scalars: settles in 30 s
SLOW = [1.5, 1.5, 1.0, 1.1, 0.9, 1.2, 1.3, 2.0, 0.8, 0.9]


@pytest.fixture(scope="module")
def task() -> Task:
    return prepare(paper_fleet(), Options("corrected", "designed"))


def candidates(task: Task) -> list[Candidate]:
    """One that settles fast, and one that is slower, with other scales."""
    return [task.rounded(task.proposal("here", task.typical.scaled(factors))) for factors in (GOOD, SLOW)]


def loop_of(task: Task, candidate: Candidate) -> ClosedLoop:
    """Verify's closed loop, in the coordinates of the rollouts."""
    loop = ClosedLoop.of(task.fleet, candidate.gains, candidate.excitation)
    return replace(loop, plant=task.setup.plant)


def state_of(columns: Columns, column: int) -> Array:
    """The state (5 N,) of a column."""
    states: Any = columns._state if isinstance(columns, Sampled) else columns._arrays["y"]  # type: ignore[attr-defined]
    return np.asarray(states[..., column], dtype=float).reshape(-1)


def in_units(task: Task, difference: Array) -> float:
    """The largest difference of two states (5 N,), in the units of the state."""
    return float(np.abs(difference / task.setup.units.reshape(-1)).max())


def start_of(starts: Array, column: int) -> State:
    return State(*starts[..., column].astype(float))


@pytest.mark.parametrize("kind", KINDS)
def test_a_rollout_does_not_depend_on_those_beside_it(task: Task, kind: type[Columns]) -> None:
    """Alone, among others with other gains, and in a place that another one has left: the same to the last bit."""
    setup, starts, chosen = task.setup, task.far_starts(Draw.TRAINING, 4), candidates(task)

    def settled(some: list[Candidate], starts: Array, setup: Setup = setup) -> list[list[list[float]]]:
        return [column.tolist() for column in settle_all(kind, setup, controls_of(some), starts, 60.0)]

    together = settled(chosen, starts)
    alone = [[settled([one], starts[..., [k]]) for k in range(4)] for one in chosen]
    narrow = replace(setup, settings=replace(FAST, simulated_vehicles=3 * len(task.fleet)))
    assert 2 <= np.isfinite(together[0]).sum() <= 7  # some leave early
    assert together == [[[one[n][0][0] for one in row] for row in alone] for n in range(3)]
    assert together == settled(chosen, starts, narrow)


def test_each_rollout_follows_its_own_trial_and_start(task: Task) -> None:
    """With short steps, before chaos: every column ends where the true solution is then."""
    fine = replace(FAST, relative_error=1e-5, absolute_error=1e-5)
    chosen, starts = candidates(task), task.far_starts(Draw.TRAINING, 3)
    controls = controls_of([one for one in chosen for _ in range(3)])
    columns = Continuous(replace(task.setup, settings=fine), controls, np.tile(starts, 2))
    while columns.t.min() < 1:
        columns.advance(8)
    for column in range(6):
        start, end = starts[..., column % 3].astype(float).reshape(-1), columns.t[[column]].astype(float)
        loop = loop_of(task, chosen[column // 3])
        true = Dop853(loop, step=0.1, piece=10.0, tolerance=1e-9).solve(0, start, end)[0]
        assert in_units(task, true - start) > 3
        assert in_units(task, state_of(columns, column) - true) < 0.05


SAMPLES = 24
DISTURBANCES: list[dict[str, Any]] = [
    {},
    {"noise_position": 0.05, "noise_heading": 0.05, "noise_speed": 0.1},
    {"delay": 3},
    {"mismatch": 0.2},
    {"viscous": 0.5},
    {"coulomb": 0.5},
    {"lost_edge": 0, "lost_at": 0.16},
    {"noise_position": 0.01, "delay": 2, "mismatch": 0.1, "viscous": 0.2, "lost_edge": 3, "lost_at": 0.2},
]


@pytest.mark.parametrize("changes", DISTURBANCES, ids=lambda changes: "+".join(changes) or "held")
def test_sampled_rollouts_are_those_of_the_verifier(
    task: Task, changes: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same noise given, the same motion within a part of the tolerance; another disturbance is another motion."""
    ranked, starts, chosen = Ranked(0.02, **changes), task.far_starts(Draw.TRAINING, 2), candidates(task)
    setup, noise = replace(task.setup, disturbance=ranked), ranked.noise(len(task.fleet))
    held = Sampled(replace(setup, disturbance=Ranked(0.02)), controls_of(chosen), starts)
    columns = Sampled(setup, controls_of(chosen), starts)
    for _ in range(SAMPLES // 8):
        columns.advance(8)
        columns.keep(np.array([True, True]))  # what waits for the wheels stays in its order
        held.advance(8)
    given = {name: value for name, value in changes.items() if name not in ("lost_edge", "delay")}
    given["delay"] = ranked.delay * ranked.sample_time
    if ranked.lost_edge is not None:
        given["lost_link"] = tuple(task.fleet.links.edges[ranked.lost_edge][:2])
    for column, candidate in enumerate(chosen):
        numbers = iter(range(SAMPLES))

        def measured(state: State, *_: Any, numbers: Iterator[int] = numbers) -> State:
            row = np.zeros((5, 1)) if noise is None else noise[next(numbers)]
            return State(*(one + other for one, other in zip(state, row, strict=True)))

        monkeypatch.setattr(sampled_loop, "measured_state", measured)
        horizon = SAMPLES * ranked.sample_time
        loop = SampledLoop(
            task.fleet, loop_of(task, candidate), Verified(0.02, **given), horizon - 1e-9, task.tolerance
        )
        *_, last = loop.samples(start_of(starts, column))
        true = np.concatenate(last.after)
        error = in_units(task, state_of(columns, column) - true)
        assert error < 0.25
        if changes:
            assert in_units(task, state_of(held, column) - true) > 2 * error


def test_what_friction_holds_is_not_simulated_on(task: Task) -> None:
    """Robots that stand still outside the tolerance end after some periods of psi, not settled."""
    held = replace(task.setup, disturbance=Ranked(0.02, coulomb=1e3))
    controls, starts = controls_of(candidates(task)), task.far_starts(Draw.TRAINING, 2)
    found = settle_all(Sampled, held, controls, starts, 1e5)
    assert np.isinf(found.time).all()
    assert (found.excess > 1).all()
    periods = 2 * math.pi / controls.frequency.astype(float)
    steps = (task.setup.settings.settled_periods * periods + 1) / 0.02
    assert np.all(found.work[:, 0] <= steps * len(task.fleet) * 4)
    assert found.excess[0, 0] == pytest.approx(settle_all(Sampled, held, controls, starts, 0.1).excess[0, 0])


def one_by_one(task: Task, candidate: Candidate, start: State) -> float:
    """The settling time (s) by CVODES at 1e-8, on a grid of 0.1 s."""
    loop, last = loop_of(task, candidate), 0.0
    for t, states in Adams(loop, step=0.1, piece=50.0, tolerance=1e-8).pieces(start):
        outside = t[loop.excess(states, task.tolerance) > 1]
        last = float(outside[-1]) if len(outside) else last
        if last < t[0] - 0.1 or t[-1] > HORIZON:
            return last
    raise AssertionError("pieces end only here")


def agree(found: list[float], true: list[float]) -> None:
    """The means differ by no more than chance, which is small."""
    chance = math.hypot(*(statistics.stdev(times) / math.sqrt(len(times)) for times in (found, true)))
    assert abs(statistics.fmean(found) - statistics.fmean(true)) < 3 * chance < 0.4 * statistics.fmean(true)


@pytest.mark.slow
def test_the_ranking_integrator_is_accurate_enough(task: Task) -> None:
    """Two digits in single precision tell the mean settling time as eight do: single starts are chaotic."""
    starts, (candidate, _) = task.far_starts(Draw.TRAINING, 41)[..., 1:], candidates(task)
    found = settle_all(Continuous, task.setup, controls_of([candidate]), starts, HORIZON).time[0]
    true = [one_by_one(task, candidate, start_of(starts, k)) for k in range(40)]
    agree(found.tolist(), true)


@pytest.mark.slow
def test_sampled_rollouts_settle_when_the_verifier_says(task: Task) -> None:
    """Each with its own noise: the means agree."""
    starts, (candidate, _) = task.far_starts(Draw.TRAINING, 61)[..., 1:], candidates(task)
    found = settle_all(Sampled, task.setup, controls_of([candidate]), starts, HORIZON).time[0]
    ranked = task.setup.disturbance
    verified = Verified(
        ranked.sample_time, noise_position=ranked.noise_position, noise_heading=ranked.noise_heading, seed=1
    )
    loop = SampledLoop(task.fleet, loop_of(task, candidate), verified, 200.0, task.tolerance)
    true = loop.outcomes([start_of(starts, k) for k in range(60)]).settling_time
    assert np.isfinite(true).all()
    agree(found.tolist(), true.tolist())


@pytest.mark.parametrize("kind", KINDS)
def test_a_candidate_is_not_simulated_beyond_its_horizon(task: Task, kind: type[Columns]) -> None:
    """What settles later has not settled; what settles within it does so at the same time under any horizon."""
    starts, controls = task.far_starts(Draw.TRAINING, 12), controls_of(candidates(task)[:1])
    whole, cut, none = (settle_all(kind, task.setup, controls, starts, horizon) for horizon in (HORIZON, 50.0, 2.0))
    assert np.isfinite(whole.time).all()
    assert (whole.excess <= 1).all()
    in_time = np.isfinite(cut.time)
    assert in_time.any()
    assert not in_time.all()
    assert (cut.time[in_time] == whole.time[in_time]).all()
    assert np.isinf(none.time).all()
    assert ((none.excess > 1) & np.isfinite(none.excess)).all()
    assert (none.work < cut.work).all()
    assert (cut.work <= whole.work).all()
    if kind is Sampled:
        assert none.work == pytest.approx(2 * 6 * 104, abs=0)  # 2 s, in eight samples of 20 ms at a time


@pytest.mark.parametrize("kind", KINDS)
def test_a_start_on_which_the_integrator_gives_up_takes_no_other_with_it(task: Task, kind: type[Columns]) -> None:
    starts, controls = task.far_starts(Draw.TRAINING, 3), controls_of(candidates(task))
    whole = settle_all(kind, task.setup, controls, starts, 60.0)
    starts[3, :, 1] = np.nan
    broken = settle_all(kind, task.setup, controls, starts, 60.0)
    assert np.isinf(broken.time[:, 1]).all()
    assert np.isinf(broken.excess[:, 1]).all()
    for one, other in zip(broken, whole, strict=True):
        assert (one[:, [0, 2]] == other[:, [0, 2]]).all()


def test_steps_are_counted_and_bounded(task: Task) -> None:
    """A rollout that runs out of steps has not settled, and says how far away it ended."""
    starts, controls = task.far_starts(Draw.TRAINING, 3), controls_of(candidates(task)[:1])
    fine = replace(task.setup, settings=replace(FAST, relative_error=1e-7, absolute_error=1e-7))
    cut = settle_all(Continuous, fine, controls, starts, 2.0)
    assert cut.work.tolist() == [[4 * 6 * 104] * 3]  # as many steps as samples in 2 s, eight at a time
    assert np.isinf(cut.time).all()
    assert ((cut.excess > 1) & np.isfinite(cut.excess)).all()


@pytest.mark.parametrize("kind", KINDS)
def test_the_clock_ends_a_batch(task: Task, kind: type[Columns]) -> None:
    """What it does not reach has not settled and is as far away as can be."""
    setup = replace(task.setup, settings=replace(FAST, seconds=0.0))
    found: Outcomes = settle_all(kind, setup, controls_of(candidates(task)), task.far_starts(Draw.TRAINING, 3), HORIZON)
    assert np.isinf(found.time).all()
    assert np.isinf(found.excess).all()
    assert not found.work.any()
