"""Simulation: against an independent integrator, against the paper, and its summary."""

import math

import numpy as np
import pytest
from gaincert.models.algebra.ops import numpy_ops
from gaincert.models.arrays import floats
from gaincert.models.equations import State, closed_loop
from gaincert.models.errors import InputError, UndecidedError
from gaincert.models.paper import paper_fleet, paper_gains
from gaincert.verify.simulation import cvodes
from gaincert.verify.simulation.simulate import simulate, summarize
from gaincert.verify.simulation.trajectory import Trajectory
from scipy.integrate import simpson, solve_ivp


@pytest.fixture(scope="module")
def run() -> Trajectory:
    fleet = paper_fleet()
    return simulate(fleet, paper_gains(), fleet.psi, horizon=300)


@pytest.mark.slow
def test_cvodes_agrees_with_scipy_to_1e_6_over_300_s(run: Trajectory) -> None:
    fleet = paper_fleet()
    plant, gains, ops, psi = fleet.plant(), paper_gains().map(floats), numpy_ops(), fleet.psi.map(float)

    def rate(t: float, x: np.ndarray) -> np.ndarray:
        return np.concatenate(closed_loop(ops, plant, gains, psi.value(ops, t), State(*x.reshape(5, 6))))

    ends = run.t[::100]
    start = np.concatenate(fleet.start())
    reference = solve_ivp(rate, (0, 300), start, "LSODA", ends, rtol=1e-12, atol=1e-12).y.reshape(5, 6, -1)
    for column, expected in zip(run.state, reference, strict=True):
        assert np.abs(column[::100] - expected.T).max() < 1e-6


def test_v_never_rises_and_falls_by_what_is_dissipated(run: Trajectory) -> None:
    gains = paper_gains().map(floats)
    power = (gains.d_v / gains.p_v * run.state.v * np.tanh(run.state.v)).sum(axis=1)
    assert np.diff(run.V).max() <= 1e-9
    begin = 50  # 5 s: the first transients are shorter than the stored step
    dissipated = simpson(power[begin:], x=run.t[begin:])
    assert run.V[begin] - run.V[-1] == pytest.approx(dissipated, rel=1e-6)


def test_summary_says_what_is_in_the_run(run: Trajectory) -> None:
    fleet = paper_fleet()
    summary = summarize(fleet, run)
    assert summary.settling_time == math.inf
    assert summary.horizon == pytest.approx(300)
    assert summary.peak_torque_ratio == pytest.approx(0.3376, abs=2e-4)
    assert 0 <= summary.peak_speed - np.abs(run.state.v).max() < 1e-3
    goal = np.array([-25, -25]) + np.array([[float(c) for c in v.offset] for v in fleet.vehicles])
    last = np.stack([run.state.x[-1], run.state.y[-1]], axis=1)
    assert summary.final_position_error == pytest.approx(np.linalg.norm(last - goal, axis=1).max())


def test_the_papers_gains_are_a_metre_off_after_3000_s() -> None:
    fleet = paper_fleet()
    summary = summarize(fleet, simulate(fleet, paper_gains(), fleet.psi, horizon=3000))
    assert summary.final_position_error == pytest.approx(1.008, abs=0.005)
    assert summary.final_heading_error == pytest.approx(1.4, abs=0.05)
    assert summary.settling_time == math.inf


def test_the_unbounded_scheme_breaks_the_torque_limits() -> None:
    """The peaks of the paper's Fig. 7, within its first seconds."""
    fleet = paper_fleet()
    free = simulate(fleet, paper_gains(), fleet.psi, horizon=5, bounded=False)
    peaks = np.maximum(np.abs(free.tau_left), np.abs(free.tau_right)).max(axis=0)
    assert peaks == pytest.approx([6.5, 415, 22, 1101, 76, 40], rel=0.02)
    assert summarize(fleet, free).peak_torque_ratio > 7


def test_a_fleet_without_starts_cannot_be_simulated() -> None:
    fleet = paper_fleet()
    bare = fleet.model_copy(
        update={"vehicles": (fleet.vehicles[0].model_copy(update={"start": None}), *fleet.vehicles[1:])}
    )
    with pytest.raises(InputError, match="has no start"):
        simulate(bare, paper_gains(), fleet.psi, horizon=1)


def test_a_wall_clock_limit_ends_a_run_with_its_time() -> None:
    fleet = paper_fleet()
    with pytest.raises(UndecidedError, match="wall clock passed at t = 20 s of 3000 s"):
        simulate(fleet, paper_gains(), fleet.psi, horizon=3000, wall_limit=0.0)


def test_an_integrator_that_stalls_is_named_with_its_time(monkeypatch: pytest.MonkeyPatch) -> None:
    fleet = paper_fleet()
    monkeypatch.setattr(cvodes, "MAX_STEPS", 5)
    with pytest.raises(UndecidedError, match="the integrator gave up after t = 0 s"):
        simulate(fleet, paper_gains(), fleet.psi, horizon=50)
