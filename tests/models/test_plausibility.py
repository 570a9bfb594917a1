"""Likely slips are said with the vehicle, the value and the unit; robots as they are raise none."""

from pathlib import Path

import pytest
from gaincert.models.errors import InputError
from gaincert.models.files.fleet_file import build_fleet, load_fleet
from gaincert.models.files.templates import SHAPES, template_text
from gaincert.models.fleet_tables import DisturbanceTable
from gaincert.models.plausibility import slips, slips_of_run, taken_to_be

EXAMPLES = Path(__file__).parents[2] / "examples"
ROBOT = {
    "mass": 3.2,
    "inertia": 0.03,
    "half_track": 0.12,
    "wheel_radius": 0.035,
    "torque_limit": 0.5,
    "limits": {"speed": 0.8, "turn_rate": 2},
}


def fleet_of(leader=None, *, own=None, **keys):
    """Three robots with these keys, the first of them with `own` keys, too."""
    vehicles = [
        {"offset": [x, 0], "start": {"position": [x, -2], "heading_deg": 0}, **ROBOT, **keys, "name": name}
        for x, name in enumerate("abc")
    ]
    vehicles[0] |= own or {}
    return build_fleet(
        name="three",
        leader=leader or {"position": [0, 0], "heading_deg": 0},
        graph={"leader_links": dict.fromkeys("abc", 1)},
        vehicle=vehicles,
    )


def test_a_robot_is_said_in_words() -> None:
    words = "3.2 kg on wheels of 70 mm diameter, 240 mm apart; full torque accelerates it at 8.93 m/s^2"
    assert taken_to_be(fleet_of().vehicles[0]) == words
    grams = "3200 kg on wheels of 70 mm diameter, 240 mm apart; full torque accelerates it at 0.00893 m/s^2"
    assert taken_to_be(fleet_of(mass=3200).vehicles[0]) == grams


@pytest.mark.parametrize(
    ("keys", "part"),
    [
        ({"mass": 3200}, "mass is in kg, not in g"),
        ({"mass": 0.0032}, "lighter than foam"),
        ({"half_track": 120, "wheel_radius": 35}, "lengths are in m, not in mm"),
        ({"half_track": 0.24}, "half the distance between them, not all of it"),
        ({"footprint": 0.1}, "half the distance between them, not all of it"),
        ({"wheel_radius": 0.3}, "wheel_radius = 0.3 m is more than the track"),
        ({"torque_limit": 5.1}, "torque_limit = 5.1 N m could accelerate 3.2 kg at 91.1 m/s^2"),
        ({"inertia": 400}, "it is in kg m^2, not in kg cm^2"),
        ({"wheel_inertia": 2}, "wheel_inertia = 2 kg m^2 adds 3.27e+03 kg to 3.2 kg"),
        ({"footprint": 170}, "footprint = 170 m is the radius of a robot with wheels 240 mm apart"),
        ({"limits": {"turn_rate": 115}}, "use rad/s, not deg/s"),
        ({"limits": {"speed": 800}}, "it is in m/s, not in mm/s"),
        ({"limits": {"wheel_speed": 500}}, "it is in rad/s, not in rpm"),
    ],
    ids=str,
)
def test_a_slip_of_all_vehicles_is_one_line_and_that_of_one_names_it(keys, part) -> None:
    line, *_ = slips(fleet_of(**keys))
    assert line.startswith("every vehicle: ") and part in line
    (line,) = slips(fleet_of(own=keys))
    assert line.startswith("vehicle 'a': ") and part in line


@pytest.mark.parametrize(
    ("own", "part"),
    [
        ({"start": {"position": [0, -2], "heading": 90}}, "= 90 rad is 14.3 turns: for degrees write heading_deg = 90"),
        ({"offset": [1000, 0]}, "its offset is 1000 m from the leader: lengths are in m, not in mm"),
        ({"start": {"position": [0, -2000], "heading": 0}}, "its start is 2000 m from the leader"),
        ({"start": {"position": [0, -2], "heading": 0, "v": 1}}, "starts with v = 1, above the limit 0.8"),
        ({"start": {"position": [0, -2], "heading": 0, "omega": -3}}, "starts with omega = -3, above the limit 2"),
    ],
    ids=str,
)
def test_slips_of_places_and_starts_name_the_vehicle(own, part) -> None:
    (line,) = slips(fleet_of(own=own))
    assert line.startswith("vehicle 'a': ") and part in line


def test_two_robots_on_one_place_and_a_leader_in_degrees_are_said() -> None:
    assert slips(fleet_of(own={"offset": [1.0, 0]})) == [
        "vehicles 'a', 'b' have the same offset: they collide at the goal; give each its own"
    ]
    assert slips(fleet_of(own={"start": {"position": [2, -2], "heading_deg": 90}})) == [
        "vehicles 'a', 'c' have the same start position: they start inside each other; give each its own"
    ]
    (line,) = slips(fleet_of({"position": [0, 0], "heading": 225}))
    assert line.startswith("leader: heading = 225 rad is 35.8 turns")


@pytest.mark.parametrize(
    ("table", "part"),
    [
        (
            {"sample_time": 50},
            "sample_time = 50 s is late for any robot: it is a time in s, not in ms, and no rate in Hz",
        ),
        ({"delay": 40, "sample_time": 0.02}, "delay = 40 s is late for any robot: it is a time in s, not in ms"),
        (
            {"coulomb": 0.4},
            "coulomb = 0.4 N m takes 80 % of the torque of 'c': it is the friction at one wheel, in N m",
        ),
    ],
    ids=str,
)
def test_what_no_robot_would_meet_is_said(table, part) -> None:
    fleet, real = fleet_of(), DisturbanceTable.model_validate(table)
    assert slips(fleet.model_copy(update={"disturbance": real})) == [f"disturbance: {part}"]
    assert slips_of_run(fleet, float(real.sample_time or 0), float(real.delay), float(real.coulomb)) == slips(
        fleet.model_copy(update={"disturbance": real})
    )
    assert slips_of_run(fleet, 1.0, 1.0, 0.2) == []


def test_a_start_above_a_limit_is_said_of_a_run() -> None:
    start = {"position": [1, 1], "heading_deg": 0, "v": 2}
    fleet = fleet_of(own={"start": start, "limits": {"speed": 1.5}})
    assert slips_of_run(fleet, 0.0, 0.0, 0.0) == [
        "vehicle 'a': starts with v = 2, above the limit 1.5: no gains can be certified for that"
    ]


def test_places_nearer_than_the_footprints_are_said() -> None:
    (line,) = slips(fleet_of(footprint=0.13, own={"offset": [0.8, 0]}))
    words = "their offsets are 0.2 m apart, and their footprints need 0.26 m: they collide there"
    assert line == f"vehicles 'a' and 'b': {words}"
    (line,) = slips(fleet_of(footprint=0.13, own={"start": {"position": [1, -1.9], "heading_deg": 0}}))
    assert line.startswith("vehicles 'a' and 'b': their start positions are 0.1 m apart")
    assert slips(fleet_of(footprint=0.13)) == []


def test_different_numbers_of_one_slip_are_those_of_the_first_vehicle() -> None:
    (line,) = slips(fleet_of(mass=3200, own={"mass": 4000}))
    assert line.startswith("every vehicle: 4000 kg") and line.endswith("(these are the numbers of 'a')")


@pytest.mark.parametrize("kind", [*SHAPES, "turtlebot3"])
def test_templates_raise_none(kind, tmp_path) -> None:
    (tmp_path / "fleet.toml").write_text(template_text(kind, 4))
    assert slips(load_fleet(tmp_path / "fleet.toml")) == []


@pytest.mark.parametrize("name", ["turtlebot3_line", "mixed_ring", "five_robots"])
def test_examples_raise_none(name) -> None:
    assert slips(load_fleet(EXAMPLES / f"{name}.toml")) == []


def test_two_robots_of_the_paper_have_more_torque_than_tyres_hold() -> None:
    (line,) = slips(load_fleet(EXAMPLES / "paper.toml"))
    assert line.startswith("vehicles 'v1', 'v2': torque_limit = 55 N m could accelerate 10 kg at 220 m/s^2")


def test_mistakes_that_concern_every_vehicle_are_said_once() -> None:
    with pytest.raises(InputError) as caught:
        fleet_of(mass=-1, colour="red", own={"inertia": 0})
    lines = caught.value.mistakes
    assert len(lines) == 3
    assert lines[0].startswith("every vehicle: mass = -1 must be")
    assert lines[1].startswith("vehicle 'a': inertia = 0 must be")
    assert lines[2].startswith("every vehicle: unknown key 'colour'")
    with pytest.raises(InputError, match=r"^vehicle 'a': mass = -1"):
        fleet_of(own={"mass": -1})
