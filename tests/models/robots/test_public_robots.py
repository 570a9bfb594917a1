"""Public robot descriptions and small hard cases, read in place: each does what the README beside it says."""

import json
import re
from pathlib import Path

import pytest
from gaincert.models.errors import InputError
from gaincert.models.files.fleet_file import parse_file
from gaincert.models.files.robots.description import read_robot

pytestmark = pytest.mark.needs("shared")

SKID_WHEELS = {
    "left_wheels": ["front_left_wheel", "rear_left_wheel"],
    "right_wheels": ["front_right_wheel", "rear_right_wheel"],
}
LINOROBOT_WHEELS = {side: [f"{name}_joint" for name in names] for side, names in SKID_WHEELS.items()}
LEO_WHEELS = {
    "left_wheels": ["wheel_FL_joint", "wheel_RL_joint"],
    "right_wheels": ["wheel_FR_joint", "wheel_RR_joint"],
}


def vehicle_of(path, wheels=None, **keys):
    """(vehicle, robot description) of a fleet of one."""
    entry = str(path) if wheels is None else {"file": str(path), **wheels}
    vehicle = {"name": "a", "urdf": entry, "torque_limit": 5, "offset": [0, 0], **keys}
    if vehicle["torque_limit"] is None:
        del vehicle["torque_limit"]
    graph = {"leader_links": {"a": 1}}
    read = parse_file(
        {"name": "one", "leader": {"position": [0, 0], "heading": 0}, "graph": graph, "vehicle": [vehicle]}
    )
    return read.fleet.vehicles[0], read.robots[0].description


def refusal(path, wheels=None, **keys):
    with pytest.raises(InputError) as caught:
        vehicle_of(path, wheels, **keys)
    assert all(str(path) in line for line in caught.value.mistakes)
    return " ".join(caught.value.mistakes)


# -- shared/data/robots -----------------------------------------------------------------------------------------------

ROBOTS = {  # name -> wheels, keys of the fleet file, (mass, half track, wheel radius), rounded
    "kobuki": (None, {}, (2.4413, 0.115, 0.035)),
    "create3": (None, {}, (3.05, 0.1165, 0.03575)),
    "tb3_waffle": (None, {}, (1.5539, 0.144, 0.033)),
    "dingo_d": (None, {}, (10.323, 0.22616, 0.049)),
    "mir100": (None, {}, (86.639, 0.2226, 0.0625)),
    "articubot_one": (None, {}, (0.71, 0.1485, 0.033)),
    "fetch": (None, {"wheel_radius": "0.0625"}, (121.2832, 0.18738, 0.0625)),
    "freight": (None, {"wheel_radius": "0.0625"}, (78.8481, 0.18738, 0.0625)),
    "jackal": (SKID_WHEELS, {}, (18.432, 0.1878, 0.098)),
    "leo": (LEO_WHEELS, {}, (5.4955, 0.22381, 0.0625)),
    "scout_mini": (SKID_WHEELS, {"wheel_radius": "0.08"}, (144.38985, 0.15663, 0.08)),
    "limo_four_diff": (SKID_WHEELS, {}, (4.3657, 0.065, 0.045)),
    "linorobot2_4wd": (LINOROBOT_WHEELS, {}, (12.635, 0.1355, 0.07162)),
}
REFUSED = {"dingo_o.urdf", "tb3_burger_model.sdf"}


def test_every_public_robot_is_tested(shared):
    present = {path.name for path in (shared / "data" / "robots").iterdir() if path.suffix in (".urdf", ".sdf")}
    assert present == {f"{name}.urdf" for name in ROBOTS} | REFUSED


@pytest.mark.parametrize("name", ROBOTS)
def test_a_public_robot_loads(name, shared):
    wheels, keys, expected = ROBOTS[name]
    vehicle, _ = vehicle_of(shared / "data" / "robots" / f"{name}.urdf", wheels, **keys)
    found = (vehicle.mass, vehicle.half_track, vehicle.wheel_radius)
    assert list(map(float, found)) == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize(("name", "mass", "inertia"), [("kobuki", 1.67, 1.51), ("create3", 1.07, 1.06)])
def test_wheel_inertia_counts(name, mass, inertia, shared):
    vehicle, _ = vehicle_of(shared / "data" / "robots" / f"{name}.urdf")
    assert float(vehicle.effective_mass() / vehicle.mass) == pytest.approx(mass, abs=0.005)
    assert float(vehicle.effective_inertia(1) / vehicle.inertia) == pytest.approx(inertia, abs=0.007)


def test_the_dingos_centre_of_mass_is_behind_its_axle(shared):
    vehicle, _ = vehicle_of(shared / "data" / "robots" / "dingo_d.urdf")
    assert float(vehicle.com_offset[0]) == pytest.approx(-0.099, abs=0.0005)


@pytest.mark.parametrize("name", [name for name, (wheels, _, _) in ROBOTS.items() if wheels])
def test_skid_steer_needs_the_wheels_by_name(name, shared):
    wheels, keys, _ = ROBOTS[name]
    says = refusal(shared / "data" / "robots" / f"{name}.urdf", **keys)
    assert "has 2 driven wheels a side (skid steer)" in says
    assert set(re.findall(r'"(\w+)"', says)) == {joint for side in wheels.values() for joint in side}


def test_the_remedy_that_skid_steer_gets_can_be_copied(shared):
    """The line names the right sides where the base's x axis points ahead."""
    says = refusal(shared / "data" / "robots" / "jackal.urdf")
    for side, joints in SKID_WHEELS.items():
        assert f"{side} = {json.dumps(joints)}" in says


def test_the_casters_of_the_mir_are_ignored_by_name(shared):
    _, robot = vehicle_of(shared / "data" / "robots" / "mir100.urdf", torque_limit=None)
    assert (robot.left_wheels, robot.right_wheels) == (("left_wheel_joint",), ("right_wheel_joint",))
    corners = [f"{end}{side}" for end in "fb" for side in "lr"]
    names = {f"{corner}_caster_{part}_joint" for corner in corners for part in ("rotation", "wheel")}
    assert {ignored.joint for ignored in robot.ignored} == names


def test_the_arm_of_the_fetch_is_ignored_and_its_limits_are_read(shared):
    path = shared / "data" / "robots" / "fetch.urdf"
    assert "has no cylinder or sphere from which the wheel radius is read; give wheel_radius" in refusal(path)
    vehicle, robot = vehicle_of(path, wheel_radius="0.0625", torque_limit=None)
    assert {ignored.joint for ignored in robot.ignored} == {
        f"{part}_roll_joint" for part in ("upperarm", "forearm", "wrist")
    }
    assert float(vehicle.torque_limit.left) == 8.85
    assert float(vehicle.limits.wheel_speed) == 17.4
    vehicle, _ = vehicle_of(shared / "data" / "robots" / "freight.urdf", wheel_radius="0.0625", torque_limit=None)
    assert float(vehicle.limits.wheel_speed) == 34.8


def test_the_radius_of_the_articubot_is_that_of_a_sphere(shared):
    _, robot = vehicle_of(shared / "data" / "robots" / "articubot_one.urdf")
    assert robot.numbers["wheel_radius"].source == "collision sphere of 'left_wheel'"


@pytest.mark.parametrize("wheels", [None, SKID_WHEELS])
def test_mecanum_is_refused_as_such(wheels, shared):
    says = refusal(shared / "data" / "robots" / "dingo_o.urdf", wheels)
    assert "is a mecanum or omnidirectional base" in says


def test_sdf_is_named(shared):
    for path in (shared / "data/robots/tb3_burger_model.sdf", shared / "cases/urdf/sdf.urdf"):
        assert "this is SDF; gaincert reads URDF and xacro" in refusal(path)


# -- shared/cases/urdf ------------------------------------------------------------------------------------------------

FOUR = {"left_wheels": ["fl_joint", "rl_joint"], "right_wheels": ["fr_joint", "rr_joint"]}
LOADS = {  # what the fleet file says besides, and the joints that are ignored
    "ok": (None, {}, ()),
    "effort_limit": (None, {"torque_limit": None}, ()),
    "fourwheel": (FOUR, {}, ()),
    "caster_continuous": (None, {}, ("caster_joint",)),
    "arm_continuous": (None, {}, ("arm_roll_joint",)),
    "sphere_wheel": (None, {}, ()),
    "mesh_wheel": (None, {"wheel_radius": "0.05"}, ()),
    "com_offset": (None, {}, ()),
}
SAYS = {
    "fourwheel": 'left_wheels = ["fl_joint", "rl_joint"], right_wheels = ["fr_joint", "rr_joint"]',
    "mesh_wheel": "link 'left_wheel' has no cylinder or sphere from which the wheel radius is read; give wheel_radius",
    "two_casters_only": "'left_wheel_joint' and 'right_wheel_joint' (type revolute, radius 0.05 m)",
    "neg_inertia": "link 'base': <inertial> has the moments ixx = -1, iyy = 0.1, izz = 0.2 kg m^2",
    "no_mass": "link 'base': <inertial> has no <mass>; give <mass",
    "two_roots": "links 'base', 'floating' have no parent; one root is needed",
    "comma": "joint 'left_wheel_joint': <origin>: xyz = '0,0.2,0.05' must be three finite numbers between spaces",
    "fixed": "joints 'left_wheel_joint' and 'right_wheel_joint' look like the drive wheels and have the type 'fixed'",
    "xacro_macro": "this is xacro",
    "sdf": "this is SDF",
}


def test_every_case_is_tested(shared):
    assert {path.stem for path in (shared / "cases" / "urdf").iterdir()} == LOADS.keys() | SAYS.keys()


@pytest.mark.parametrize("name", LOADS)
def test_a_case_loads(name, shared):
    wheels, keys, ignored = LOADS[name]
    vehicle, robot = vehicle_of(shared / "cases" / "urdf" / f"{name}.urdf", wheels, **keys)
    assert float(vehicle.half_track) == pytest.approx(0.2)
    assert float(vehicle.wheel_radius) == 0.05
    assert tuple(item.joint for item in robot.ignored) == ignored


@pytest.mark.parametrize("name", SAYS)
def test_a_case_is_refused(name, shared):
    assert SAYS[name] in refusal(shared / "cases" / "urdf" / f"{name}.urdf")


def test_effort_and_velocity_limits(shared):
    vehicle, _ = vehicle_of(shared / "cases" / "urdf" / "effort_limit.urdf", torque_limit=None)
    assert (vehicle.torque_limit.left, vehicle.limits.wheel_speed) == (5, 10)


def test_the_centre_of_mass_off_the_axle_is_carried(shared):
    vehicle, _ = vehicle_of(shared / "cases" / "urdf" / "com_offset.urdf")
    assert list(map(float, vehicle.com_offset)) == pytest.approx([-1 / 10.2, 0.3 / 10.2])


def test_reading_in_place_leaves_the_files_alone(shared):
    """Nothing is written beside a description, whatever it is."""
    folder = shared / "cases" / "urdf"
    before = sorted(map(Path.as_posix, folder.iterdir()))
    read_robot(folder / "ok.urdf")
    assert sorted(map(Path.as_posix, folder.iterdir())) == before
