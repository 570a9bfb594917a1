"""Friction holds wheels at rest, stops them without turning them back, and else is Coulomb's and viscous."""

import numpy as np
import pytest
from gaincert.models.equations import State, accelerations
from gaincert.models.friction import friction_torques

H = 0.01


def clip(x, limit):
    return np.clip(x, -limit, limit)


def wheel_speeds(plant, state):
    return np.array([(state.v + sign * plant.arm * state.omega) / plant.r for sign in (1, -1)])


def step(plant, state, torques, coulomb, viscous=0.0):
    """(friction torques, wheel speeds after a step)."""
    lost = friction_torques(clip, plant, state, torques, coulomb, viscous, H)
    v_rate, omega_rate = accelerations(plant, torques[0] - lost[0], torques[1] - lost[1])
    after = state._replace(v=state.v + H * v_rate, omega=state.omega + H * omega_rate)
    return np.array(lost), wheel_speeds(plant, after)


@pytest.fixture
def plant(fleet):
    return fleet.plant()


def at_rest(plant):
    return State(*np.zeros((5, plant.graph.vehicles)))


def test_torques_below_friction_move_nothing(plant, random):
    torques = random.uniform(-0.99, 0.99, (2, plant.graph.vehicles))
    lost, speeds = step(plant, at_rest(plant), torques, coulomb=1.0, viscous=0.1)
    assert lost == pytest.approx(torques)
    assert speeds == pytest.approx(0, abs=1e-9)


def test_it_takes_its_torque_from_wheels_that_turn(plant, random):
    v = random.uniform(2, 3, plant.graph.vehicles)
    state = at_rest(plant)._replace(v=v)
    lost, speeds = step(plant, state, np.zeros((2, plant.graph.vehicles)), coulomb=1e-3)
    assert lost == pytest.approx(np.full(lost.shape, 1e-3))
    assert (speeds > 0).all()


def test_it_stops_wheels_and_does_not_turn_them_back(plant, random):
    pushed = random.uniform(-0.9, 0.9, (2, plant.graph.vehicles))
    v_rate, omega_rate = accelerations(plant, *pushed)
    state = at_rest(plant)._replace(v=H * v_rate, omega=H * omega_rate)
    lost, speeds = step(plant, state, np.zeros((2, plant.graph.vehicles)), coulomb=1.0)
    assert lost == pytest.approx(pushed)
    assert speeds == pytest.approx(0, abs=1e-9)


def test_a_torque_above_friction_accelerates_by_the_rest(plant):
    torques = np.full((2, plant.graph.vehicles), 1.5)
    lost, speeds = step(plant, at_rest(plant), torques, coulomb=1.0)
    assert lost == pytest.approx(np.ones(lost.shape))
    assert (speeds > 0).all()


def test_viscous_friction_is_that_of_the_speed_at_the_end(plant, draw_state):
    state = draw_state(plant.graph.vehicles)
    lost, speeds = step(plant, state, np.zeros((2, plant.graph.vehicles)), coulomb=0.0, viscous=0.02)
    assert lost == pytest.approx(0.02 * speeds, rel=1e-2, abs=1e-4)
