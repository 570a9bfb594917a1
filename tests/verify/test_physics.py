"""The fleet in MuJoCo: it accelerates as (2) says with effective values, rubs, waits and slips as it is told."""

import json
import sys
from dataclasses import replace
from itertools import pairwise
from xml.etree import ElementTree

import numpy as np
import pytest
from gaincert.models.algebra.ops import numpy_ops
from gaincert.models.arrays import floats
from gaincert.models.equations import State, accelerations, control
from gaincert.models.errors import InputError
from gaincert.models.files.fleet_file import parse
from gaincert.models.files.fleet_text import dumps
from gaincert.models.files.gains_file import load_gains
from gaincert.models.starts import random_starts
from gaincert.models.tolerance import Tolerance
from gaincert.reports.deployment import Deployment
from gaincert.reports.export.c_library import build_library
from gaincert.verify.physics.controller import CController
from gaincert.verify.physics.scene import Bodies, scene_xml
from gaincert.verify.physics.validation import PhysicsTask, PhysicsValidation, run_physics
from gaincert.verify.physics.world import World
from gaincert.verify.simulation.closed_loop import ClosedLoop
from gaincert.verify.simulation.disturbance import Disturbance

from tests.cli.command_line import gaincert

pytestmark = pytest.mark.needs("mujoco")

CART = {
    "name": "cart",
    "mass": 12,
    "inertia": "0.4",
    "half_track": "0.2",
    "wheel_radius": "0.06",
    "torque_limit": 2,
    "offset": [0, 0],
}
# What three makers build: a Waffle, a Kobuki and a Create 3, as `check` reads them from their descriptions.
TRIO = [
    {**CART, "name": "waffle", "mass": "1.5539", "inertia": "0.019638", "half_track": "0.144", "wheel_radius": "0.033"},
    {**CART, "name": "kobuki", "mass": "2.4413", "inertia": "0.041984", "half_track": "0.115", "wheel_radius": "0.035"},
    {**CART, "name": "create3", "mass": "3.05", "inertia": "0.0434", "half_track": "0.1165", "wheel_radius": "0.03575"},
]
for vehicle, spin, place, offset in zip(
    TRIO,
    ("0.0000207", "0.001", "0.0001278"),
    (["-0.00583", 0], ["0.00979", 0], ["0.00781", "0.00043"]),
    (["-0.8", "0.8"], [0, 0], ["-0.8", "-0.8"]),
    strict=True,
):
    vehicle |= {"wheel_inertia": spin, "com_offset": place, "offset": offset}


def fleet_of(*vehicles, **keys):
    names = [vehicle["name"] for vehicle in vehicles]
    graph = {"edges": list(map(list, pairwise(names))), "leader_links": dict.fromkeys(names, 1)}
    leader = {"position": [0, 0], "heading": 0}
    return parse({"name": "carts", "leader": leader, "graph": graph, "vehicle": list(vehicles), **keys})


def at_rest(n=1, theta=0.0):
    return State(*np.zeros((2, n)), np.full(n, theta), *np.zeros((2, n)))


def held(left, right):
    """Constant torques, whatever the state."""
    return lambda _t, _state: (np.atleast_1d(left), np.atleast_1d(right))


def motion(fleet, torques, seconds, start=None, **disturbance):
    """(samples, world) of a run."""
    world = World(fleet, Disturbance(**{"sample_time": 0.01, **disturbance}))
    return list(world.samples(start or at_rest(len(fleet)), torques, seconds)), world


# -- against (2) ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["ahead", "turning", "both"])
@pytest.mark.parametrize("i", range(3))
def test_accelerations_from_rest_are_those_of_the_model(i, kind):
    """Within 2 %, with the wheels' own inertia: for the Kobuki 0.6 of what its mass alone would do."""
    agrees_with_the_model(fleet_of({**TRIO[i], "com_offset": [0, 0]}), kind)


@pytest.mark.needs("shared")
@pytest.mark.parametrize("kind", ["ahead", "turning"])
@pytest.mark.parametrize("name", ["kobuki", "create3", "tb3_waffle", "mir100"])
def test_public_robots_accelerate_as_the_model_says(name, kind, shared):
    path = shared / "data" / "robots" / f"{name}.urdf"
    agrees_with_the_model(fleet_of({"name": "a", "urdf": str(path), "torque_limit": 2, "offset": [0, 0]}), kind)


def agrees_with_the_model(fleet, kind):
    plant = fleet.plant()
    torque = 0.3 * plant.m * plant.r / 2, plant.inertia * plant.r / (2 * np.abs(plant.arm))  # for 0.3 m/s^2, 1 rad/s^2
    left, right = {
        "ahead": (torque[0], torque[0]),
        "turning": (-torque[1], torque[1]),
        "both": (torque[0] / 2 - torque[1] / 3, torque[0] / 2 + torque[1] / 3),
    }[kind]
    seconds = 0.2
    samples, world = motion(fleet, held(left, right), seconds)
    v_rate, omega_rate = accelerations(plant, left, right)
    end = samples[-1].after
    if kind != "turning":
        assert end.v[0] / seconds == pytest.approx(v_rate, rel=0.02)
    if kind != "ahead":
        assert end.omega[0] / seconds == pytest.approx(omega_rate, rel=0.02)
    assert world.slip.share < 0.02


def test_a_cylinder_of_some_width_would_scrub():
    """Why wheels are balls: two contact points of one wheel resist turning on the spot, which (2) does not know."""
    import mujoco

    fleet = fleet_of(TRIO[1])
    plant = fleet.plant()
    turned = []
    for text in (scene_xml(fleet, 0.0, 0.0), _with_cylinders(scene_xml(fleet, 0.0, 0.0))):
        model = mujoco.MjModel.from_xml_string(text)
        data = mujoco.MjData(model)
        torque = float(plant.inertia[0] * plant.r[0] / (2 * abs(plant.arm[0])))
        data.ctrl[:] = -torque, torque
        mujoco.mj_step(model, data, nstep=200)
        turned.append(float(data.qvel[5]))
    assert turned[0] == pytest.approx(0.2, rel=0.02)
    assert turned[1] < 0.2 * turned[0]


def _with_cylinders(text):
    root = ElementTree.fromstring(text)  # noqa: S314 -- our own text
    for body in root.iter("body"):
        if body.get("name").startswith(("left", "right")):
            wheel = body.find("geom")
            radius = float(wheel.get("size"))
            wheel.attrib |= {"type": "cylinder", "size": f"{radius} 0.01", "quat": "0.7071068 0.7071068 0 0"}
    return ElementTree.tostring(root, encoding="unicode")


@pytest.mark.parametrize("i", range(3))
def test_mass_centre_and_yaw_inertia_are_the_fleets(i):
    import mujoco

    fleet = fleet_of(TRIO[i])
    (vehicle,), model = fleet.vehicles, mujoco.MjModel.from_xml_string(scene_xml(fleet, 0.0, 0.0))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    masses, centres = model.body_mass[1:], data.xipos[1:]
    middle = np.array([0.0, 0.0])
    total = masses @ centres[:, :2] / masses.sum()
    yaw = sum(
        m * np.sum((c[:2] - middle) ** 2) + (R.reshape(3, 3) @ np.diag(tensor) @ R.reshape(3, 3).T)[2, 2]
        for m, c, tensor, R in zip(masses, centres, model.body_inertia[1:], data.ximat[1:], strict=True)
    )
    assert masses.sum() == pytest.approx(float(vehicle.mass))
    assert total == pytest.approx([float(value) for value in vehicle.com_offset], abs=1e-9)
    assert yaw == pytest.approx(float(vehicle.inertia))


def test_a_centre_of_mass_off_the_axle_bends_a_coasting_turn():
    """Coasting at 2 rad/s with the mass 10 cm behind: m (v' - d w^2) = 0, so v' = d w^2 at first."""
    off = fleet_of({**CART, "com_offset": ["-0.1", 0], "inertia": "0.7"})
    start = at_rest()._replace(omega=np.array([2.0]))
    (*_, last), _ = motion(off, held(0.0, 0.0), 0.05, start)
    assert last.after.v[0] / 0.05 == pytest.approx(-0.1 * 4, rel=0.1)


# -- what a robot adds ------------------------------------------------------------------------------------------------


def test_torques_below_the_friction_move_nothing():
    samples, _ = motion(fleet_of(CART), held(0.019, 0.019), 1.0, coulomb=0.02)
    assert abs(samples[-1].after.x[0, 0]) < 1e-4


def test_friction_takes_its_torque_from_each_wheel():
    fleet = fleet_of(CART)
    samples, _ = motion(fleet, held(0.1, 0.1), 0.5, coulomb=0.02, viscous=0.001)
    plant, end = fleet.plant(), samples[-1].after
    v_rate, _ = accelerations(plant, 0.08, 0.08)
    rate = 2 * 0.001 / (plant.r**2 * plant.m)  # of the viscous part
    assert end.v[0] == pytest.approx(v_rate * -np.expm1(-0.5 * rate) / rate, rel=0.02)


def test_torques_arrive_after_the_delay():
    samples, _ = motion(fleet_of(CART), held(0.1, 0.1), 0.2, delay=0.05)
    moving = [sample.t for sample in samples if abs(sample.after.v[0, 0]) > 1e-4]
    assert min(moving) == pytest.approx(0.05)


def test_headings_count_turns():
    start = at_rest(theta=7.0)._replace(omega=np.array([3.0]))
    samples, _ = motion(fleet_of(CART), held(0.0, 0.0), 4.0, start)
    headings = np.array([sample.after.theta[0, 0] for sample in samples])
    assert headings[-1] == pytest.approx(7 + 12, rel=0.01)
    assert np.all(np.diff(headings) > 0)


def test_wheels_slip_where_the_torque_is_more_than_the_floor_holds():
    """Traction is at most the weight on the wheels: 12 kg pull with 118 N, which is 3.5 N m at each wheel."""
    within, slipping = (motion(fleet_of(CART), held(torque, torque), 0.3)[1].slip for torque in (1.0, 6.0))
    assert within.speed < 0.02 < 1 < slipping.speed
    assert within.share < 0.02 < 0.2 < slipping.share


def test_runs_are_the_same_every_time():
    ends = [motion(fleet_of(*TRIO), held([0.1] * 3, [0.05] * 3), 0.5, noise_position=0.1)[0][-1] for _ in range(2)]
    assert all(np.array_equal(a, b) for a, b in zip(ends[0].after, ends[1].after, strict=True))


@pytest.mark.parametrize(
    ("fleet", "disturbance", "says"),
    [
        ({"drive": "paper"}, {}, 'needs drive = "physical" in the fleet file'),
        ({}, {"mismatch": 0.1}, "the plant mujoco knows no mismatch and no lost link; leave them out"),
    ],
)
def test_what_mujoco_cannot_be_is_refused(fleet, disturbance, says):
    with pytest.raises(InputError, match=says):
        World(fleet_of(CART, **fleet), Disturbance(**disturbance))


def test_an_inertia_that_the_wheels_exceed_is_refused():
    with pytest.raises(InputError, match=r"vehicle 'cart': inertia = 0.4 kg m.2 is less than its wheels"):
        Bodies.of(fleet_of({**CART, "wheel_inertia": "0.5"}).vehicles[0])


def test_the_package_is_named_where_it_is_missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(InputError, match=r"pip install 'gaincert\[robots\]'"):
        World(fleet_of(CART), Disturbance())


# -- with the controller ----------------------------------------------------------------------------------------------

GAINS = """
p_v = [0.74, 0.32, 1.51]
d_v = [6.731, 17.22, 13.74]
p_omega = [0.0041, 0.00213, 0.00925]
d_omega = [0.331, 1.03, 0.7473]
k_alpha = [0.0184, 0.0096, 0.0416]
[saturation]
position = 0.1763
heading = 0.005319
speed = [1.073, 2.888, 1.262]
turn_rate = [14.42, 24.88, 15.06]
[excitation]
family = "harmonics"
frequency = 0.06336
sin = [1.0, 0.00813, 0.215]
"""


@pytest.fixture(scope="module")
def trio(tmp_path_factory):
    """(fleet, its gains, the compiled controller)."""
    folder = tmp_path_factory.mktemp("controller")
    fleet = fleet_of(*TRIO)
    (folder / "gains.toml").write_text(GAINS)
    gains = load_gains(folder / "gains.toml", fleet)
    deployed = Deployment(fleet, gains.excitation, gains.gains, fleet.digest, None, None)
    return fleet, gains, deployed, build_library(deployed, folder)


@pytest.mark.needs("gcc")
def test_the_controller_is_the_exported_one(trio, random):
    fleet, gains, _, library = trio
    state = State(*random.uniform(-2, 2, (5, 3)))
    found = CController(library, 3).torques(1.5, state)
    psi = gains.excitation.value(numpy_ops(), 1.5)
    expected = control(numpy_ops(), fleet.plant(), gains.gains.map(floats), psi, state)
    assert np.array(found) == pytest.approx(np.array(expected), abs=1e-12)


def task_of(trio, disturbance, horizon):
    fleet, gains, deployed, library = trio
    loop = ClosedLoop.of(fleet, gains.gains, gains.excitation)
    bounds = floats(deployed.torque_bounds)
    return PhysicsTask(fleet, loop, bounds, library, disturbance, horizon, Tolerance(0.1, 0.1))


@pytest.mark.needs("gcc")
def test_a_start_in_mujoco_stays_beside_the_model(trio):
    """20 s with hold and delay: positions within centimetres, torques within T of (16*), wheels roll."""
    task = task_of(trio, Disturbance(0.02, delay=0.04), 20.0)
    (start,) = random_starts(trio[0], 1, seed=3, half_width=2.0)
    result = run_physics(task, 0, start)
    assert result.largest_difference < 0.1
    assert result.bound_ratio < 1 and result.torque_ratio < 1
    assert result.slip_share < 0.01
    assert result.settling_time is None and result.failure.startswith("not settled within 20 s")
    assert result.track.real.shape == result.track.model.shape == (200, 2, 3)
    assert np.hypot(*(result.track.real - result.track.model).transpose(1, 0, 2)).max() <= result.largest_difference
    assert json.loads(json.dumps(result.to_json()))["start"] == 0


@pytest.mark.needs("gcc")
def test_a_fleet_that_stands_in_formation_has_settled(trio):
    fleet = trio[0]
    plant = fleet.plant()
    start = State(plant.offset_x, plant.offset_y, *np.zeros((3, 3)))
    validation = PhysicsValidation(task_of(trio, Disturbance(0.02), 5.0), [])
    result = run_physics(validation.task, 1, start)
    assert result.settling_time == result.model_settling_time == 0
    assert result.track is None
    document = replace(validation, results=[result]).to_json()
    assert (document["plant"], document["starts"], document["settled"]) == ("mujoco", 1, 1)
    assert document["model"]["settled"] == 1 and document["failures"] == []


@pytest.mark.needs("gcc")
def test_the_command_line_validates_in_mujoco(trio, tmp_path):
    (tmp_path / "fleet.toml").write_text(dumps(trio[0]))
    (tmp_path / "gains.toml").write_text(GAINS)
    command = ["validate", tmp_path / "fleet.toml", "--gains", tmp_path / "gains.toml", "-o", tmp_path / "out"]
    command += ["--starts", "2", "--horizon", "2", "--workers", "1", "--friction", "0.002", "0", "--plant", "mujoco"]
    done = gaincert(*command)
    assert done.returncode == 0, done.stderr
    assert "with torques held for 10 ms, friction of 0.002 N m at every wheel: 0 of 2 starts settle" in done.stdout
    document = json.loads((tmp_path / "out" / "validation.json").read_text())
    assert [failure["start"] for failure in document["failures"]] == [0, 1]
    assert document["peak_torque_over_bound"] < 1
    assert document["slip"]["friction"] == 1
    assert (tmp_path / "out" / "figures" / "physics.svg").is_file()
    refused = gaincert(*command, "--replay", "0", "--margins")
    assert refused.returncode == 2
    assert "--replay, --margins: not with --plant mujoco; leave it out" in refused.stderr
    reported = gaincert("report", tmp_path / "out")
    assert reported.returncode == 0, reported.stderr
    text = (tmp_path / "out" / "report.html").read_text()
    assert "in mujoco, driven by the exported C controller: 0 of 2 settle within 2 s" in text


def test_a_missing_compiler_is_named(trio, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(InputError, match="no C compiler was found"):
        build_library(trio[2], tmp_path)
