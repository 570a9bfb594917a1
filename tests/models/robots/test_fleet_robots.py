"""`urdf` in a fleet file: which numbers come from which file, and the sources that are shown."""

from fractions import Fraction

import pytest
from gaincert.models.errors import InputError
from gaincert.models.files.fleet_file import load_fleet, parse, parse_file
from gaincert.models.files.fleet_text import dumps

from tests.models.robots.robot_files import (
    BASE,
    INERTIA,
    ROBOT,
    WHEEL_INERTIA,
    robot,
    wheel,
)


def written(tmp_path, text):
    path = tmp_path / "robot.urdf"
    path.write_text(text)
    return path


def content(**vehicle):
    return {
        "name": "carts",
        "leader": {"position": [0, 0], "heading": 0},
        "graph": {"leader_links": {"a": 1}},
        "vehicle": [{"name": "a", "urdf": "robot.urdf", "torque_limit": 5, "offset": [0, 0], **vehicle}],
    }


def test_a_fleet_takes_its_robot_from_the_folder_of_its_file(tmp_path):
    written(tmp_path, ROBOT)
    (vehicle,) = parse(content(), tmp_path).vehicles
    assert (vehicle.mass, vehicle.half_track, vehicle.wheel_radius) == (8, Fraction("0.25"), Fraction("0.11"))
    assert float(vehicle.inertia) == pytest.approx(INERTIA)


def test_what_the_fleet_file_says_itself_wins(tmp_path):
    written(tmp_path, ROBOT)
    (vehicle,) = parse(content(mass="8.5"), tmp_path).vehicles
    assert (vehicle.mass, vehicle.half_track) == (Fraction("8.5"), Fraction("0.25"))


def test_robots_with_and_without_a_description_stand_side_by_side(tmp_path):
    written(tmp_path, ROBOT)
    numbers = {"mass": 1, "inertia": 2, "half_track": 3, "wheel_radius": 4, "torque_limit": 5, "offset": [1, 0]}
    mixed = content()
    mixed["vehicle"] += [{"name": "b", **numbers}, {**mixed["vehicle"][0], "name": "c"}]
    mixed["graph"]["edges"] = [["a", "b"], ["b", "c"]]
    assert [vehicle.mass for vehicle in parse(mixed, tmp_path).vehicles] == [8, 1, 8]


def test_a_bad_robot_is_named_beside_the_other_mistakes(tmp_path):
    written(tmp_path, "<robot/>")
    with pytest.raises(InputError) as caught:
        parse(content(torque_limit="none"), tmp_path)
    assert "robot.urdf: has no <link>" in caught.value.mistakes[0]
    assert all(line.startswith("vehicle 'a': torque_limit.") for line in caught.value.mistakes[1:])
    assert len(caught.value.mistakes) == 3


def test_wheel_radius_of_the_fleet_file_wins_where_the_description_has_none(tmp_path):
    written(tmp_path, ROBOT.replace('<cylinder radius="0.11" length="0.03"/>', '<mesh filename="wheel.stl"/>'))
    (vehicle,) = parse(content(wheel_radius="0.12"), tmp_path).vehicles
    assert vehicle.wheel_radius == Fraction("0.12")
    with pytest.raises(
        InputError, match=r"link 'left' has no cylinder or sphere .* give wheel_radius in the fleet file"
    ):
        parse(content(), tmp_path)


def test_wheels_of_two_radii_load_with_wheel_radius_in_the_fleet_file(tmp_path):
    written(tmp_path, ROBOT.replace('radius="0.11"', 'radius="0.2"', 1))
    assert parse(content(wheel_radius="0.12"), tmp_path).vehicles[0].wheel_radius == Fraction("0.12")


def test_mass_and_inertia_of_the_fleet_file_win_over_links_that_have_none(tmp_path):
    written(tmp_path, ROBOT.replace('<mass value="4"/>', ""))
    with pytest.raises(InputError, match="link 'base'"):
        parse(content(mass=9), tmp_path)
    read = parse_file(content(mass=9, inertia="0.7"), tmp_path)
    (vehicle,), (robot_read,) = read.fleet.vehicles, read.robots
    assert (vehicle.mass, vehicle.inertia, vehicle.com_offset) == (9, Fraction("0.7"), (0, 0))
    assert vehicle.wheel_inertia == Fraction(str(WHEEL_INERTIA))
    (warning,) = robot_read.description.warnings
    assert warning.startswith("link 'base'") and warning.endswith("(mass and inertia are the fleet file's)")


LIMITS = '<limit effort="5" velocity="10"/>'
LIMITED = ROBOT.replace('<axis xyz="0 1 0"/>', f'<axis xyz="0 1 0"/>{LIMITS}')


def without(key):
    fleet = content()
    del fleet["vehicle"][0][key]
    return fleet


def test_torque_and_wheel_speed_limits_come_from_the_joints(tmp_path):
    written(tmp_path, LIMITED)
    (vehicle,) = parse(without("torque_limit"), tmp_path).vehicles
    assert (vehicle.torque_limit.left, vehicle.torque_limit.right, vehicle.limits.wheel_speed) == (5, 5, 10)


def test_limits_of_the_fleet_file_win_one_by_one(tmp_path):
    written(tmp_path, LIMITED)
    (vehicle,) = parse(content(torque_limit=3, limits={"speed": 1}), tmp_path).vehicles
    assert (vehicle.torque_limit.left, vehicle.limits.speed, vehicle.limits.wheel_speed) == (3, 1, 10)
    (vehicle,) = parse(content(limits={"wheel_speed": 8}), tmp_path).vehicles
    assert vehicle.limits.wheel_speed == 8


def test_a_limit_of_zero_is_no_limit_and_said(tmp_path):
    written(tmp_path, ROBOT.replace('<axis xyz="0 1 0"/>', '<axis xyz="0 1 0"/><limit effort="0" velocity="0"/>'))
    read = parse_file(content(), tmp_path)
    assert read.fleet.vehicles[0].limits.wheel_speed is None
    assert (
        "joint 'jl': <limit> effort = 0 is taken for a limit that is not given" in read.robots[0].description.warnings
    )
    with pytest.raises(InputError, match="torque_limit is missing"):
        parse(without("torque_limit"), tmp_path)


def test_a_negative_limit_is_refused(tmp_path):
    written(tmp_path, LIMITED.replace('effort="5"', 'effort="-5"', 1))
    with pytest.raises(InputError, match="joint 'jl': <limit> effort = -5; it must be > 0"):
        parse(content(), tmp_path)


SKID = robot(
    BASE,
    *(wheel(name, at, limit=LIMITS) for name, at in (("fl", "0.15 0.2 0.05"), ("fr", "0.15 -0.2 0.05"))),
    *(wheel(name, at, limit=LIMITS) for name, at in (("rl", "-0.15 0.2 0.05"), ("rr", "-0.15 -0.2 0.05"))),
)
NAMED = {"file": "robot.urdf", "left_wheels": ["fl_joint", "rl_joint"], "right_wheels": ["fr_joint", "rr"]}


def test_a_skid_steer_base_loads_when_its_wheels_are_named(tmp_path):
    """By joint or by link; a side's torque limit and wheel inertia are the sums over its wheels."""
    written(tmp_path, SKID)
    with pytest.raises(InputError, match=r'2 driven wheels a side .*left_wheels = \["fl_joint", "rl_joint"\]'):
        parse(content(), tmp_path)
    fleet = content(urdf=NAMED)
    del fleet["vehicle"][0]["torque_limit"]
    (vehicle,) = parse(fleet, tmp_path).vehicles
    assert (vehicle.half_track, vehicle.wheel_radius) == (Fraction("0.2"), Fraction("0.05"))
    assert (vehicle.wheel_inertia, vehicle.torque_limit.left) == (Fraction("0.0002"), 10)
    assert vehicle.limits.wheel_speed == 10


@pytest.mark.parametrize(
    ("entry", "says"),
    [
        (5, "vehicle 'a': urdf = 5 must be a text in quotes, or { file = ..."),
        ({"left_wheels": ["fl"]}, "urdf: file = None must be a text in quotes"),
        ({**NAMED, "wheels": []}, "urdf: unknown key 'wheels'"),
        ({**NAMED, "left_wheel": []}, "urdf: unknown key 'left_wheel' (did you mean 'left_wheels'?)"),
        ({**NAMED, "left_wheels": "fl"}, "urdf: left_wheels = 'fl' must be a list of joint names in quotes"),
        ({**NAMED, "left_wheels": []}, "urdf: left_wheels = [] must be a list of joint names in quotes"),
        ({"file": "robot.urdf", "left_wheels": ["fl"]}, "urdf: left_wheels is given and the other side is not"),
        ({**NAMED, "left_wheels": ["fl", "x"]}, "there is no joint 'x'; left_wheels and right_wheels name joints: "),
        ({**NAMED, "left_wheels": ["fl", "fr"]}, "joint 'fr_joint' is named twice"),
        ({**NAMED, "left_wheels": ["rr", "fl"], "right_wheels": ["rl", "fr"]}, "the left wheels lie at"),
        ({**NAMED, "left_wheels": ["fl"], "right_wheels": ["rl"]}, "lie on the same side; correct them"),
    ],
)
def test_a_wrong_entry_is_refused(entry, says, tmp_path):
    written(tmp_path, SKID)
    with pytest.raises(InputError) as caught:
        parse(content(urdf=entry), tmp_path)
    (line,) = caught.value.mistakes
    assert says in line


def test_swapped_sides_are_said(tmp_path):
    written(tmp_path, SKID)
    swapped = {**NAMED, "left_wheels": NAMED["right_wheels"], "right_wheels": NAMED["left_wheels"]}
    (robot_read,) = parse_file(content(urdf=swapped), tmp_path).robots
    assert "left_wheels lie on the right of link 'base'" in robot_read.description.warnings[0]


def test_every_number_has_its_source(tmp_path):
    written(tmp_path, LIMITED)
    (robot_read,) = parse_file(content(), tmp_path).robots
    sources = {key: quantity.source for key, quantity in robot_read.description.numbers.items()}
    assert sources["wheel_radius"] == "collision cylinder of 'left'"
    assert sources["half_track"] == "'jl', 'jr'"
    assert sources["mass"] == sources["inertia"] == "5 links"
    assert sources["wheel_inertia"] == "<inertial> of 'left', 'right'"
    assert sources["torque_limit_left"] == "<limit effort> of 'jl'"
    assert sources["wheel_speed"] == "<limit velocity> of 'jl', 'jr'"
    assert robot_read.given == {"torque_limit", "offset"}


def test_a_fleet_with_robots_reads_back_as_it_was(tmp_path):
    written(tmp_path, LIMITED)
    fleet = parse(content(), tmp_path)
    (tmp_path / "copy.toml").write_text(dumps(fleet))
    assert load_fleet(tmp_path / "copy.toml") == fleet
