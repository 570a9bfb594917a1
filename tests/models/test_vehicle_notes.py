"""Notes on vehicles: a centre of mass off the axle, a start some turns away."""

import math
import re

import pytest
from gaincert.models.files.fleet_file import parse
from gaincert.models.paper import paper_fleet
from gaincert.models.vehicle_notes import centre_of_mass_note, heading_hint, is_off_axle


def fleet_of(leader=0, **keys):
    numbers = {"mass": 1, "inertia": 2, "half_track": "0.2", "wheel_radius": 4, "torque_limit": 5, "offset": [1, 0]}
    content = {
        "name": "one",
        "leader": {"position": [0, 0], "heading_deg": leader},
        "graph": {"leader_links": {"a": 1}},
        "vehicle": [{"name": "a", **numbers, **keys}],
    }
    return parse(content)


@pytest.mark.parametrize(
    ("place", "says"),
    [
        (["-0.1", "0.03"], "10 cm behind and 3 cm left (26 % of the track)"),
        (["0.0041", 0], "0.41 cm ahead (1 % of the track)"),
        (["0", "-0.02"], "2 cm right (5 % of the track)"),
    ],
)
def test_a_centre_of_mass_off_the_axle_is_said(place, says):
    assert f"'a' {says}" in centre_of_mass_note(fleet_of(com_offset=place))


@pytest.mark.parametrize("place", [[0, 0], ["0.004", 0], ["0.002", "-0.003"]])
def test_one_per_cent_of_the_track_is_not_said(place):
    assert centre_of_mass_note(fleet_of(com_offset=place)) is None
    assert not is_off_axle(fleet_of(com_offset=place).vehicles[0])


def test_many_vehicles_are_counted():
    content = fleet_of(com_offset=["0.1", 0]).model_dump(by_alias=True)
    content["vehicle"] = [{**content["vehicle"][0], "name": f"v{i}"} for i in range(13)]
    content["graph"]["leader_links"] = {f"v{i}": 1 for i in range(13)}
    assert "'v9'" in (note := centre_of_mass_note(parse(content)))
    assert "; and 3 more" in note and "'v10'" not in note


def test_the_centre_of_mass_is_no_part_of_what_is_certified():
    assert fleet_of(com_offset=["0.1", 0]).digest == fleet_of().digest


@pytest.mark.parametrize("leader", [0, 30, 225, -400])
@pytest.mark.parametrize("error", [-725, -541, -180, -179, 0, 90, 180, 181, 359, 360, 540, 1000])
def test_the_hint_is_the_same_pose_and_within_half_a_turn(leader, error):
    fleet = fleet_of(leader, start={"position": [0, 0], "heading_deg": leader + error})
    hint = heading_hint(fleet.vehicles[0], fleet.leader)
    assert (hint is None) == (abs(error) <= 180)
    if hint:
        nearer = float(re.search(r"heading_deg = (\S+) is", hint)[1])
        assert abs(nearer - leader) <= 180 + 1e-6
        assert math.remainder(nearer - (leader + error), 360) == pytest.approx(0, abs=1e-6)
        assert f"starts {abs(error):.4g} degrees from the leader's heading" in hint


def test_a_vehicle_without_start_has_no_hint():
    fleet = fleet_of()
    assert heading_hint(fleet.vehicles[0], fleet.leader) is None


def test_three_of_the_papers_starts_are_more_than_half_a_turn_away():
    fleet = paper_fleet()
    hinted = [vehicle.name for vehicle in fleet.vehicles if heading_hint(vehicle, fleet.leader)]
    assert hinted == ["v4", "v5", "v6"]
