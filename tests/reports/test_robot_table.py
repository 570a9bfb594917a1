"""The robots in the output of `check`: every number with its source, equal robots once, warnings and notes below."""

import json

import pytest
from gaincert.models.files.fleet_file import load_fleet_file, parse_file
from gaincert.reports.tables.robot_table import robot_summaries

from tests.cli.command_line import gaincert
from tests.models.robots.robot_files import BASE, WHEEL_BODY, inertial, link, robot, wheel

SCAN = wheel("scan", "0 0 0.3", axis="0 0 1")
LIMITS = '<limit effort="5" velocity="10"/>'
TEXT = robot(BASE, wheel("l", "0 0.2 0.05", limit=LIMITS), wheel("r", "0 -0.2 0.05", limit=LIMITS), SCAN)
FLEET = """
name = "two kinds"
[leader]
position = [0, 0]
heading = 0
[graph]
leader_links = { a = 1, b = 1, c = 1 }
[[vehicle]]
name = "a"
urdf = "cart.urdf"
offset = [0, 0]
[[vehicle]]
name = "b"
urdf = "cart.urdf"
offset = [1, 0]
start = { position = [0, 0], heading_deg = 540 }
[[vehicle]]
name = "c"
urdf = "cart.urdf"
wheel_radius = 0.06
torque_limit = 4
limits = { wheel_speed = 8, speed = 1 }
offset = [2, 0]
"""


@pytest.fixture
def path(tmp_path):
    (tmp_path / "cart.urdf").write_text(TEXT)
    (tmp_path / "fleet.toml").write_text(FLEET)
    return tmp_path / "fleet.toml"


def entries(summary):
    return {entry.quantity: entry for entry in summary.entries}


def test_equal_robots_come_once_and_every_number_has_its_source(path):
    first, second = robot_summaries(load_fleet_file(path))
    assert (first.vehicles, second.vehicles) == (("a", "b"), ("c",))
    described = entries(first)
    assert described["mass"] == ("mass", "10.3 kg", "cart.urdf: 4 links")
    assert described["effective mass"].value == f"{10.3 + 2e-4 / 0.05**2:g} kg"
    assert described["wheel radius r"].source == "cart.urdf: collision cylinder of 'l'"
    assert described["left torque limit"] == ("left torque limit", "5 N m", "cart.urdf: <limit effort> of 'l_joint'")
    assert described["limit wheel_speed"].source == "cart.urdf: <limit velocity> of 'l_joint', 'r_joint'"
    assert described["left wheels"].value == "l_joint"
    assert described["ignored joint"] == ("ignored joint", "scan_joint", "its axis is not horizontal")
    overruled = entries(second)
    for key in ("wheel radius r", "left torque limit", "right torque limit", "limit wheel_speed", "limit speed"):
        assert overruled[key].source == "fleet file"
    assert overruled["mass"].source == "cart.urdf: 4 links"
    assert overruled["effective mass"].value == f"{10.3 + 2e-4 / 0.06**2:g} kg"


def test_intervals_and_the_lever_arm_of_the_printed_model():
    vehicle = {"name": "a", "mass": [9, 11], "inertia": 2, "half_track": "0.5", "wheel_radius": "0.5", "offset": [0, 0]}
    vehicle |= {"torque_limit": {"left": 5, "right": [4, 5]}, "wheel_inertia": [1, 2]}
    leader = {"position": [0, 0], "heading": 0}
    content = {
        "name": "n",
        "leader": leader,
        "drive": "paper",
        "graph": {"leader_links": {"a": 1}},
        "vehicle": [vehicle],
    }
    (summary,) = robot_summaries(parse_file(content))
    found = entries(summary)
    assert found["mass"].value == "9 to 11 kg"
    assert found["effective mass"].value == "17 to 27 kg"
    assert found["effective inertia"] == ("effective inertia", "10 to 18 kg m^2", "inertia + 2 J (arm / r)^2")
    assert found["right torque limit"].value == "4 to 5 N m"


def test_check_prints_robots_warnings_and_notes(path, tmp_path):
    heavy = inertial(0.1, 1e-3, 1e-3, 1e-3)
    shifted = link("base", inertial(10, 0.1, 0.1, 0.15, at="-0.1 0 0"))
    (tmp_path / "cart.urdf").write_text(TEXT.replace(WHEEL_BODY, heavy, 1).replace(BASE, shifted))
    done = gaincert("check", path)
    assert done.returncode == 0
    for line in ("robot a, b", "robot c", "warning: cart.urdf: link 'l': its moment about the axle"):
        assert any(said.startswith(line) for said in done.stdout.splitlines())
    assert (
        "note: the centre of mass is off the middle of the axle: 'a' 9.71 cm behind (24 % of the track)" in done.stdout
    )
    assert "note: vehicle 'b' starts 540 degrees from the leader's heading" in done.stdout
    document = json.loads(gaincert("check", path, "--json", "-q").stdout)
    assert [group["vehicles"] for group in document["robots"]] == [["a", "b"], ["c"]]
    assert document["robots"][0]["numbers"][0] == {
        "quantity": "mass",
        "value": "10.3 kg",
        "source": "cart.urdf: 4 links",
    }
    assert len(document["notes"]) == 2


def test_check_says_what_each_robot_is_and_warns_once_of_a_slip_of_all(path):
    path.write_text(FLEET.replace("heading_deg = 540", "heading = 90") + "mass = 10300\n")
    done = gaincert("check", path)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert any(
        line.startswith("robot a, b: 10.3 kg on wheels of 100 mm diameter, 400 mm apart; full") for line in lines
    )
    warnings = [line for line in lines if line.startswith("warning: ")]
    assert any("vehicle 'c': 10300 kg" in line and "mass is in kg, not in g" in line for line in warnings)
    assert any("vehicle 'b': start heading = 90 rad is 14.3 turns" in line for line in warnings)
    assert not any("will turn back" in line for line in lines)  # one slip, one line
    assert json.loads(gaincert("check", path, "--json").stdout)["warnings"]
