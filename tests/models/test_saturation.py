"""The saturation scales: unit scales are the paper's controller, and other units of length and time change nothing."""

from dataclasses import replace

import numpy as np
import pytest
from gaincert.models import energy, equations
from gaincert.models.algebra.ops import numpy_ops
from gaincert.models.arrays import floats
from gaincert.models.conditions import condition_set, float_numbers
from gaincert.models.equations import State
from gaincert.models.gains import GAIN_NAMES, Gains
from gaincert.models.saturation import SCALE_NAMES, Saturation
from scipy.integrate import solve_ivp

LENGTH, TIME = 2.3, 0.37  # of the new units in the old ones


def in_other_units(plant, gains, state):
    """The same fleet with lengths times LENGTH and times times TIME; masses stay, psi's frequency is divided by TIME.

    A force scales as LENGTH / TIME^2, a moment as LENGTH^2 / TIME^2.
    """
    a, b, s = LENGTH, TIME, gains.saturation
    force, moment = a / b**2, a**2 / b**2
    lengths = ("r", "arm", "offset_x", "offset_y", "leader_x", "leader_y")
    moved = replace(plant, inertia=a**2 * plant.inertia, **{name: a * getattr(plant, name) for name in lengths})
    scaled = Gains(
        p_v=force * gains.p_v,
        d_v=force * gains.d_v,
        p_omega=moment * gains.p_omega,
        d_omega=moment * gains.d_omega,
        k_alpha=moment * gains.k_alpha,
        saturation=Saturation(a * s.position, s.heading, a / b * s.speed, s.turn_rate / b),
    )
    return moved, scaled, State(a * state.x, a * state.y, state.theta, a / b * state.v, state.omega / b)


def trajectory(plant, gains, psi, state, horizon, pace=1.0):
    """States at eleven times up to the horizon, s; psi runs in its own time, `pace` times as long."""
    ops, n = numpy_ops(), len(state.x)

    def rate(t, x):
        now = psi.value(ops, t / pace)
        return np.concatenate(equations.closed_loop(ops, plant, gains, now, State(*x.reshape(5, n))))

    times = np.linspace(0, horizon, 11)
    accuracy = {"rtol": 1e-10, "atol": 1e-12}
    return solve_ivp(rate, (0, horizon), np.concatenate(state), method="LSODA", t_eval=times, **accuracy).y


def test_other_units_map_trajectories_onto_trajectories(fleet, gains, psi, draw_state):
    plant, state = fleet.plant(), draw_state(len(fleet))
    other_plant, other_gains, other_state = in_other_units(plant, gains, state)
    here = trajectory(plant, gains, psi, state, 0.5)
    there = trajectory(other_plant, other_gains, psi, other_state, 0.5 * TIME, TIME)
    for k, (one, other) in enumerate(zip(here.T, there.T, strict=True)):
        _, _, expected = in_other_units(plant, gains, State(*one.reshape(5, -1)))
        assert other == pytest.approx(np.concatenate(expected), rel=1e-6, abs=1e-6), k


def test_other_units_scale_energies_and_torques(fleet, gains, psi, draw_state):
    """V and W are divided by a gain of their channel: V scales as a length, W not at all."""
    ops, plant, state = numpy_ops(), fleet.plant(), draw_state(len(fleet))
    there = in_other_units(plant, gains, state)
    V, W = energy.translational(ops, plant, gains, state), energy.rotational(ops, plant, gains, state)
    assert energy.translational(ops, *there) == pytest.approx(LENGTH * V, rel=1e-12)
    assert energy.rotational(ops, *there) == pytest.approx(W, rel=1e-12)
    now = psi.value(ops, 0.7)
    pairs = zip(
        equations.control(ops, plant, gains, now, state),
        equations.control(ops, *there[:2], now, there[2]),
        strict=True,
    )
    for torque, other in pairs:
        assert other == pytest.approx(LENGTH**2 / TIME**2 * torque, rel=1e-11)


@pytest.mark.parametrize("name", ["paper", "corrected", "rate-bounded"])
def test_other_units_scale_both_sides_of_every_condition(fleet, gains, psi, draw_state, name):
    data = replace(
        fleet.condition_data(psi).map(floats), speed=np.full(len(fleet), 1.7), turn_rate=np.full(len(fleet), 2.1)
    )
    a, b = LENGTH, TIME
    other = replace(
        data,
        r=a * data.r,
        arm=a * data.arm,
        torque=a**2 / b**2 * data.torque,
        speed=a / b * data.speed,
        turn_rate=data.turn_rate / b,
    )
    _, scaled, _ = in_other_units(fleet.plant(), gains, draw_state(len(fleet)))
    conditions = condition_set(name)
    here = conditions.inequalities(float_numbers(), data, gains)
    there = conditions.inequalities(float_numbers(), other, scaled)
    for one, two in zip(here, there, strict=True):
        assert two.small / two.large == pytest.approx(one.small / one.large, rel=1e-12), one.source


def test_one_heading_unit_and_matching_speed_scales_are_the_paper_in_other_units(fleet, gains, psi, draw_state):
    """rho = 1, s = l o: lengths in l and times in 1 / o turn the controller into that of unit scales."""
    length, o = 0.3, 5.0
    own = replace(gains, saturation=Saturation(length, 1.0, length * o, o))
    plant, state, ops = fleet.plant(), draw_state(len(fleet)), numpy_ops()
    lengths = ("r", "arm", "offset_x", "offset_y", "leader_x", "leader_y")
    moved = replace(
        plant, inertia=plant.inertia / length**2, **{name: getattr(plant, name) / length for name in lengths}
    )
    force, moment = length * o**2, length**2 * o**2
    unit = Gains(own.p_v / force, own.d_v / force, own.p_omega / moment, own.d_omega / moment, own.k_alpha / moment)
    there = State(state.x / length, state.y / length, state.theta, state.v / (length * o), state.omega / o)
    now = psi.value(ops, 0.7)
    rates = equations.closed_loop(ops, plant, own, now, state)
    expected = equations.closed_loop(ops, moved, unit, now, there)
    factors = State(length * o, length * o, o, length * o**2, o**2)
    for rate, factor, other in zip(rates, factors, expected, strict=True):
        assert rate == pytest.approx(factor * other, rel=1e-10, abs=1e-10)


def test_local_gains_move_the_fleet_alike_near_the_goal(fleet, gains, psi):
    ops, plant, n = numpy_ops(), fleet.plant(), len(fleet)
    size = 1e-6
    random = np.random.default_rng(n)
    goal = (plant.leader_x + plant.offset_x, plant.leader_y + plant.offset_y, np.full(n, plant.leader_theta))
    state = State(*(place + size * random.standard_normal(n) for place in (*goal, 0.0, 0.0)))
    now = psi.value(ops, 0.7)
    scaled = equations.closed_loop(ops, plant, gains, now, state)
    unit = equations.closed_loop(ops, plant, gains.local(), now, state)
    for one, two in zip(scaled, unit, strict=True):
        assert np.abs(one - two).max() < 1e-5 * max(np.abs(two).max(), size)


def test_unit_scales_are_the_paper_s_controller(paper, gains_of_paper):
    assert gains_of_paper.saturation.unit
    assert not Saturation(speed=np.array([1, 2])).unit
    local = gains_of_paper.local()
    assert all((getattr(local, name) == getattr(gains_of_paper, name)).all() for name in GAIN_NAMES)
    columns = gains_of_paper.saturation.columns(len(paper))
    assert list(columns) == list(SCALE_NAMES)
    assert all((column == 1).all() and column.shape == (len(paper),) for column in columns.values())
