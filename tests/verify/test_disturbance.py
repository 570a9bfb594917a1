"""Disturbances: the nominal run in the limit, power, seeds, and what a lost link or a long sample time does."""

import tomllib
from decimal import Decimal

import numpy as np
import pytest
from gaincert.models.equations import State, accelerations
from gaincert.models.errors import InputError
from gaincert.models.files.fleet_file import parse
from gaincert.models.files.fleet_text import dumps
from gaincert.models.starts import random_starts
from gaincert.models.tolerance import Tolerance
from gaincert.verify.simulation import sampled_loop as module
from gaincert.verify.simulation.closed_loop import ClosedLoop
from gaincert.verify.simulation.disturbance import Disturbance, checked, of_table, parts
from gaincert.verify.simulation.integrators import Adams
from gaincert.verify.simulation.sampled_loop import Outcomes, SampledLoop
from gaincert.verify.simulation.settling import Approach
from gaincert.verify.simulation.summary import Summary
from gaincert.verify.validation.robustness import DisturbedRuns

WIDE = Tolerance(20.0, 5.0)


@pytest.fixture
def loop(paper, gains_of_paper) -> ClosedLoop:
    return ClosedLoop.of(paper, gains_of_paper, paper.psi)


@pytest.fixture
def starts(paper) -> list[State]:
    return random_starts(paper, 3, 2, 10.0)


def test_the_sampled_run_tends_to_the_nominal_one(paper, loop, starts) -> None:
    """A zero-order hold is an error of the first order in the sample time."""
    exact = []
    for start in starts:
        _, states = next(Adams(loop, step=5.0, piece=5.0, tolerance=1e-12).pieces(start))
        exact.append(loop.distances(states)[0].max())
    gaps = []
    for sample_time in (0.01, 0.005, 0.0025):
        found = SampledLoop(paper, loop, Disturbance(sample_time), 5.0, WIDE).outcomes(starts)
        gaps.append(np.abs(found.final_position - exact).max())
    assert gaps[2] < 0.02
    assert np.polyfit(np.log([0.01, 0.005, 0.0025]), np.log(gaps), 1)[0] == pytest.approx(1, abs=0.3)


def test_friction_takes_power_and_nothing_else(fleet, draw_state) -> None:
    """The power that friction takes from the kinetic energy, by (2), is that at the wheels."""
    plant, state = fleet.plant(), draw_state(len(fleet))
    zero = np.zeros(len(fleet))
    rubbing = Disturbance(coulomb=0.3, viscous=0.02)
    left, right = (-torque for torque in module._after_friction(plant, state, (zero, zero), rubbing, 1e-9))
    v_rate, omega_rate = accelerations(plant, -left, -right)
    power = plant.m * state.v * v_rate + plant.inertia * state.omega * omega_rate
    wheels = [(state.v + sign * plant.arm * state.omega) / plant.r for sign in (1, -1)]
    assert power == pytest.approx(-(left * wheels[0] + right * wheels[1]))
    assert (power <= 0).all()


def test_a_seed_gives_the_same_noise_and_parameters(paper, loop, starts) -> None:
    runs = [
        SampledLoop(paper, loop, Disturbance(mismatch=0.1, noise_position=0.05, seed=seed), 2.0, WIDE).outcomes(starts)
        for seed in (1, 1, 2)
    ]
    assert np.array_equal(runs[0].final_position, runs[1].final_position)
    assert not np.array_equal(runs[0].final_position, runs[2].final_position)


def test_torques_stay_within_limits_whatever_is_measured(paper, loop, starts) -> None:
    """(16*) holds for every state, so for every measurement of it."""
    wild = Disturbance(noise_position=100.0, noise_heading=10.0, noise_speed=100.0, delay=0.1)
    assert SampledLoop(paper, loop, wild, 2.0, WIDE).outcomes(starts).torque_ratio.max() < 1


def test_a_delay_holds_the_first_torques_back(paper, loop, starts) -> None:
    still = SampledLoop(paper, loop, Disturbance(sample_time=0.1, delay=1.0), 1.0, WIDE).outcomes(starts)
    begin = [loop.distances(start)[0].max() for start in starts]
    assert still.final_position == pytest.approx(begin)


def test_a_lost_link_leaves_the_other_weights(paper, loop) -> None:
    lost = module._with_link_lost(paper, loop.plant, Disturbance(lost_link=("v4", "v2"))).graph
    assert (lost.weight == 0).tolist() == [False] * 6 + [True]
    assert lost.degree.tolist() == [2, 12, 2, 12, 2, 2]


def test_parts_and_report() -> None:
    both = Disturbance(delay=0.1, mismatch=0.1)
    assert parts(both) == [Disturbance(), Disturbance(delay=0.1), Disturbance(mismatch=0.1), both]
    assert parts(Disturbance(delay=0.1)) == [Disturbance(), Disturbance(delay=0.1)]
    found = Outcomes(np.array([3.0, np.inf]), (Approach.CLOSING_IN,) * 2, np.array([0.5, 0.7]), np.ones(2), np.ones(2))
    said = DisturbedRuns(both, found, [1.0, 2.0]).to_json()
    assert said["settled"] == 1
    assert said["settling_time_s"]["each"] == [3.0, None]
    assert said["later_than_nominal_s"] == {"median": 2.0, "max": 2.0}
    assert not found.acceptable


@pytest.mark.parametrize(
    ("real", "message"),
    [
        (Disturbance(lost_link=("v1", "v9")), "no vehicle 'v9'"),
        (Disturbance(delay=float("nan")), "delay = nan must be"),
        (Disturbance(sample_time=1e-9), "sample_time = 1e-09 must be from 0.0001 to 10"),
        (Disturbance(coulomb=-1.0), "coulomb = -1.0 must be"),
    ],
)
def test_disturbances_that_make_no_sense_are_refused(paper, real: Disturbance, message: str) -> None:
    with pytest.raises(InputError, match=message):
        checked(real, paper)


def test_a_kept_run_is_the_one_that_was_measured(paper, loop, starts) -> None:
    real = Disturbance(sample_time=0.03, noise_position=0.01, mismatch=0.1, seed=4)
    sampled = SampledLoop(paper, loop, real, 6.0, WIDE)
    nominal = Summary(3.0, Approach.CLOSING_IN, WIDE, 6.0, 0.5, 0.0, 0.0, 0.0, 1.0, 1.0, ("V rises",))
    summary, run = sampled.run(starts[0], nominal)
    alone = sampled.outcomes(starts[:1])
    assert summary.settling_time == alone.settling_time
    assert summary.peak_torque_ratio == alone.torque_ratio
    assert run.t == pytest.approx(np.arange(0, 6, 0.09), abs=0.03)
    assert np.array_equal(run.state.x[0], starts[0].x)
    assert np.abs(run.tau_left / loop.torque_left).max() <= alone.torque_ratio[0]
    assert run.state.x.shape == (len(run.t), 6)
    assert summary.violations == ("V rises",)  # what the nominal run breaks is not hidden by the disturbed one
    assert summary.to_json()["nominal"]["settling_time_s"] == 3.0


def test_the_table_of_a_fleet_file_says_the_same_as_options(paper) -> None:
    table = 'sample_time = 0.02\ncoulomb = 0.5\nlost_link = ["v1", "v2"]\nlost_at = 3'
    fleet = parse(tomllib.loads(f"{dumps(paper)}\n[disturbance]\n{table}\n", parse_float=Decimal))
    assert of_table(fleet.disturbance, 7) == Disturbance(0.02, coulomb=0.5, lost_link=("v1", "v2"), lost_at=3.0, seed=7)
    assert fleet.digest == paper.digest  # a certificate does not depend on it
    assert parse(tomllib.loads(dumps(fleet), parse_float=Decimal)) == fleet
    assert of_table(None) == Disturbance()
