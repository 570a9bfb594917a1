"""A centre of mass off the axle: the model against Newton's law for the body, energy, and (2)."""

from dataclasses import replace

import numpy as np
import pytest
from gaincert.models.equations import Plant, State, accelerations
from gaincert.models.off_axle import OffAxle
from gaincert.models.paper import paper_fleet


@pytest.fixture
def case(fleet, random):
    """(plant, off-axle data, state, torques) of random robots whose wheels spin, too."""
    n = len(fleet)
    mass, ahead, left = random.uniform(1, 20, n), random.uniform(-0.3, 0.3, n), random.uniform(-0.1, 0.1, n)
    own = random.uniform(0.1, 3, n)  # kg m^2, about the centre of mass
    spin = random.uniform(0, 2, n)  # kg, 2 J / r^2
    plant: Plant = replace(
        fleet.plant(), m=mass + spin, inertia=own + mass * (ahead**2 + left**2) + spin * fleet.plant().arm ** 2
    )
    state = State(*random.normal(size=(5, n)))
    return plant, OffAxle(mass, ahead, left), state, random.normal(size=(2, n))


def test_it_is_the_model_where_the_centre_is_on_the_axle(case):
    plant, off, state, torques = case
    on_axle = OffAxle(off.mass, 0 * off.ahead, 0 * off.left)
    for found, expected in zip(
        on_axle.accelerations(plant, state, *torques), accelerations(plant, *torques), strict=True
    ):
        assert found == pytest.approx(expected)


def test_force_and_moment_are_those_of_the_moving_body(case):
    """The acceleration of the centre of mass from its own kinematics, m a = F across and along."""
    plant, off, state, torques = case
    v_rate, omega_rate = off.accelerations(plant, state, *torques)
    force = (torques[0] + torques[1]) / plant.r
    moment = plant.arm * (torques[0] - torques[1]) / plant.r
    d, e, v, w = off.ahead, off.left, state.v, state.omega
    along = v_rate - e * omega_rate - d * w**2  # of the centre of mass
    across = v * w + d * omega_rate - e * w**2
    wheels, own = plant.m - off.mass, plant.inertia - off.mass * (d**2 + e**2)
    assert off.mass * along + wheels * v_rate == pytest.approx(force)
    assert own * omega_rate + off.mass * (d * across - e * along) == pytest.approx(moment)


def test_coasting_keeps_the_energy(case):
    plant, off, state, _ = case
    zero = np.zeros_like(state.v)
    v_rate, omega_rate = off.accelerations(plant, state, zero, zero)
    v, w = state.v, state.omega
    power = plant.m * v * v_rate + plant.inertia * w * omega_rate - off.mass * off.left * (v_rate * w + v * omega_rate)
    assert power == pytest.approx(zero, abs=1e-9)


def test_the_offsets_of_a_fleet():
    content = paper_fleet().model_dump(by_alias=True)
    content["vehicle"][1]["com_offset"] = ["-0.1", "0.02"]
    off = OffAxle.of(type(paper_fleet()).model_validate(content))
    assert off.ahead.tolist() == [0, -0.1, 0, 0, 0, 0]
    assert off.left[1] == 0.02
    assert off.mass[:2].tolist() == [10, 10]


@pytest.mark.needs("shared")
def test_a_coasting_dingo_speeds_up(shared):
    """Turning at 2 rad/s without torque, a Dingo gains 0.385 m/s^2: its centre of mass is 9.9 cm behind the axle."""
    from gaincert.models.files.fleet_file import parse

    path = shared / "data" / "robots" / "dingo_d.urdf"
    vehicle = {"name": "a", "urdf": str(path), "torque_limit": 5, "offset": [0, 0]}
    leader, graph = {"position": [0, 0], "heading": 0}, {"leader_links": {"a": 1}}
    fleet = parse({"name": "dingo", "leader": leader, "graph": graph, "vehicle": [vehicle]})
    turning = State(*np.zeros((4, 1)), np.array([2.0]))
    v_rate, _ = OffAxle.of(fleet).accelerations(fleet.plant(), turning, np.zeros(1), np.zeros(1))
    assert abs(v_rate[0]) == pytest.approx(0.385, abs=0.002)
