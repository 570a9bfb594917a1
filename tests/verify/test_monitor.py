"""What lies between the points of a grid: peaks, the moment of settling; against runs on much finer grids."""

import math

import numpy as np
import pytest
from gaincert.models.fleet import Fleet
from gaincert.models.starts import random_starts
from gaincert.models.tolerance import Tolerance
from gaincert.verify.simulation.closed_loop import ClosedLoop
from gaincert.verify.simulation.integrators import Cvodes, Dop853
from gaincert.verify.simulation.interpolation import interval_peaks, last_above_one
from gaincert.verify.simulation.monitor import Monitor, Outcome
from gaincert.verify.simulation.simulate import integration_error, measure, simulate


def test_peaks_of_cubics_are_exact(random) -> None:
    coefficients = random.normal(size=(4, 50))
    t = np.array([0.0, 0.7])
    values = np.stack([np.polyval(coefficients, x) for x in t])
    slopes = np.stack([np.polyval(coefficients[:3] * np.array([[3], [2], [1]]), x) for x in t])
    fine = np.abs(np.stack([np.polyval(coefficients, x) for x in np.linspace(0, 0.7, 20001)])).max(axis=0)
    assert interval_peaks(values, slopes, 0.7).size[0] == pytest.approx(fine, rel=1e-7)


def test_a_constant_and_a_parabola_have_their_interval_peaks() -> None:
    top = interval_peaks(np.array([[2.0, 0.0], [2.0, 0.0]]), np.array([[0.0, 4.0], [0.0, -4.0]]), 1.0)
    assert top.size[0].tolist() == [2.0, 1.0]
    assert top.place[0, 1] == 0.5


def test_the_last_moment_above_one_is_found_between_points() -> None:
    t = np.linspace(0, 4, 9)
    curve, slope = 1.5 * np.exp(-t)[:, None], -1.5 * np.exp(-t)[:, None]
    assert last_above_one(curve, slope, 0.5) == pytest.approx(math.log(1.5), abs=1e-4)
    assert last_above_one(curve / 2, slope / 2, 0.5) is None
    # A bump between two points that are both below 1.
    assert last_above_one(np.array([[0.9], [0.9]]), np.array([[1.0], [-1.0]]), 1.0) == pytest.approx(0.887, abs=1e-3)


@pytest.mark.parametrize(
    ("excess", "expected"),
    [([2, 2, 0.5, 0.5], 1.5), ([0.5, 0.5, 0.5, 0.5], None), ([2, 0.5, 0.5, 2], 3.0), ([0.5, 2, 1.0, 0.9], 2.0)],
)
def test_settled_means_to_the_end(excess: list[float], expected: float | None) -> None:
    values = np.array(excess)[:, None]
    last = last_above_one(values, np.zeros_like(values), 1.0)
    assert last == (expected if expected is None else pytest.approx(expected, abs=0.3))


def run(loop: ClosedLoop, start, name: str, step: float, horizon: float, tolerance: Tolerance) -> tuple[Outcome, list]:
    method = {"cvodes": Cvodes, "dop853": Dop853}[name](loop, step=step, piece=horizon, tolerance=1e-10)
    monitor = Monitor(loop, method, tolerance, start)
    t, states = next(method.pieces(start))
    monitor.update(t, states)
    return monitor.outcome(), [t, states]


@pytest.mark.parametrize("number", range(3))
def test_peaks_and_settling_do_not_depend_on_the_grid(paper: Fleet, gains_of_paper, number: int) -> None:
    loop = ClosedLoop.of(paper, gains_of_paper, paper.psi)
    start = random_starts(paper, number + 1, 5, 30.0)[number]
    wide = Tolerance(25.0, 6.0)
    coarse, _ = run(loop, start, "cvodes", 0.25, 40.0, wide)
    fine, (t, states) = run(loop, start, "cvodes", 0.002, 40.0, wide)
    for name in ("torque_ratio", "speed", "turn_rate"):
        assert getattr(coarse, name).value == pytest.approx(getattr(fine, name).value, rel=1e-6)
        assert getattr(coarse, name).vehicle == getattr(fine, name).vehicle
    grid = [np.abs(states.v).max(), np.abs(states.omega).max(), np.abs(loop.torque_ratios(t, states)).max()]
    assert [fine.speed.value, fine.turn_rate.value] == pytest.approx(grid[:2], rel=1e-6)
    assert coarse.torque_ratio.value >= grid[2] * (1 - 1e-9)
    assert coarse.settling_time == pytest.approx(fine.settling_time, abs=1e-6)
    position, heading = loop.distances(states)
    outside = np.flatnonzero(((position > 25) | (heading > 6)).any(axis=1))
    expected = math.inf if outside.size and outside[-1] == len(t) - 1 else t[outside[-1]] if outside.size else 0.0
    assert coarse.settling_time == expected or abs(coarse.settling_time - expected) < 0.0021


def test_an_excursion_between_two_points_counts(paper: Fleet, gains_of_paper) -> None:
    """A tolerance just below a local maximum of the error that no point of the grid touches."""
    loop = ClosedLoop.of(paper, gains_of_paper, paper.psi)
    start = random_starts(paper, 1, 5, 30.0)[0]
    _, (t, states) = run(loop, start, "cvodes", 0.002, 40.0, Tolerance())
    error = loop.distances(states)[1].max(axis=1)
    top = int(np.argmax(error))
    on_grid = error[249::250]  # every half second
    limit = float((on_grid.max() + error[top]) / 2)
    assert on_grid.max() < limit < error[top]
    outcome, _ = run(loop, start, "cvodes", 0.5, 40.0, Tolerance(1e3, limit))
    last = np.flatnonzero(error > limit)[-1]
    assert t[last] <= outcome.settling_time <= t[last] + 0.0021


def test_both_integrators_agree(paper: Fleet, gains_of_paper) -> None:
    loop = ClosedLoop.of(paper, gains_of_paper, paper.psi)
    start = paper.start()
    cvodes, (_, one) = run(loop, start, "cvodes", 0.2, 20.0, Tolerance(40.0, 4.0))
    dop853, (_, other) = run(loop, start, "dop853", 0.2, 20.0, Tolerance(40.0, 4.0))
    for a, b in zip(one, other, strict=True):
        assert np.abs(a - b).max() < 1e-7
    assert cvodes.settling_time == pytest.approx(dop853.settling_time, abs=1e-6)
    assert cvodes.torque_ratio.value == pytest.approx(dop853.torque_ratio.value, rel=1e-7)


def test_the_integration_error_is_known(paper: Fleet, gains_of_paper) -> None:
    """The reported error is above the true one, against DOP853 at its limit, and not by orders of magnitude."""
    shown = simulate(paper, gains_of_paper, paper.psi, horizon=30)
    reported = integration_error(shown).position
    reference = Dop853(shown.integrator.loop, step=30.0, piece=30.0, tolerance=2.5e-14)
    _, end = next(reference.pieces(paper.start()))
    true = np.hypot(shown.state.x[-1] - end.x[0], shown.state.y[-1] - end.y[0]).max()
    assert true < reported < 1e-6


def test_a_run_that_is_looked_at_in_parts_says_the_same(paper: Fleet, gains_of_paper, monkeypatch) -> None:
    shown = simulate(paper, gains_of_paper, paper.psi, horizon=30)
    whole = measure(shown, Tolerance(30.0, 4.0))
    monkeypatch.setattr("gaincert.verify.simulation.simulate.MEASURED_TOGETHER", 6 * 37)
    assert measure(shown, Tolerance(30.0, 4.0)) == whole


def test_certified_speeds_bound_what_is_observed(paper: Fleet, gains_of_paper) -> None:
    loop = ClosedLoop.of(paper, gains_of_paper, paper.psi)
    for start in random_starts(paper, 3, 1, 30.0):
        outcome, _ = run(loop, start, "cvodes", 0.1, 20.0, Tolerance())
        assert outcome.certified.value < 1
