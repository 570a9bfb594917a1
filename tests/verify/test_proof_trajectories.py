"""The corrected theorem exercised: gains that break (15) tenfold converge; both boundedness witnesses move so."""

import numpy as np
import pytest
from gaincert.models.paper import paper_fleet
from gaincert.verify.proof.trajectories import bang_bang, rising_energy, simulate

from tests.verify.light_fleets import damping_ratio, line_of, undamped_gains


def errors(plant, motion):
    """The largest position (m) and heading (rad) error of the fleet at every time, (T,) each."""
    x = motion.state.x - plant.offset_x - plant.leader_x
    y = motion.state.y - plant.offset_y - plant.leader_y
    return np.hypot(x, y).max(axis=1), np.abs(motion.state.theta - plant.leader_theta).max(axis=1)


@pytest.mark.parametrize(
    ("fleet", "horizon"),
    [
        (line_of(1), 200),
        (line_of(3), 200),
        (line_of(5), 200),
        pytest.param(paper_fleet(), 1500, marks=pytest.mark.slow),
    ],
    ids=["one", "line of 3", "line of 5", "paper"],
)
def test_gains_that_break_15_tenfold_converge(fleet, horizon):
    gains = undamped_gains(fleet, fleet.psi)
    assert damping_ratio(fleet, gains, fleet.psi).min() > 10
    run = simulate(fleet, gains, fleet.psi, fleet.start(), horizon)
    position, heading = errors(fleet.plant(), run)
    last, middle = slice(-200, None), slice(800, 1000)
    print(
        f"{fleet.name}: position error {position[0]:.2f} -> {position[-1]:.3f} m, heading {heading[0]:.2f} -> "
        f"{heading[-1]:.3f} rad"
    )
    assert position[last].max() < position[middle].max()
    assert position[last].max() < 0.25
    assert heading[last].max() < 0.3


def test_energy_rises_with_a_fast_vehicle():
    run, energy = rising_energy(1.0)
    rate = (energy[1] - energy[0]) / (run.t[1] - run.t[0])
    assert run.state.omega[0, 0] == pytest.approx(1)
    assert rate == pytest.approx(1.2342, abs=0.01)


def test_bang_bang_makes_omega_grow_without_bound():
    swings = bang_bang()
    assert (np.abs(swings.alpha) <= 0.76).all()
    assert (swings.peaks >= np.sqrt(2 * 0.1408 * (swings.reaches - 1))).all()
    assert (swings.peaks[1:] > 1.8 * swings.peaks[:-1]).all()
