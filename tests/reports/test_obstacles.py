"""Obstacles are named beforehand: friction, motors, control rate, collisions, and runs that do not arrive."""

import math
import re
import tomllib
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from gaincert.console import Printer
from gaincert.models.algebra.ops import numpy_ops
from gaincert.models.arrays import floats
from gaincert.models.equations import State, control
from gaincert.models.files.fleet_file import parse
from gaincert.models.files.fleet_text import dumps
from gaincert.models.numbers import nominal
from gaincert.models.paper import paper_excitation, paper_fleet, paper_gains
from gaincert.models.saturation import Saturation
from gaincert.models.tolerance import Tolerance
from gaincert.reports import obstacles
from gaincert.reports.tables.demands_table import demand_rows, for_terminal
from gaincert.verify.simulation.disturbance import Disturbance
from gaincert.verify.simulation.room import Room, _among_all, _by_tree
from gaincert.verify.simulation.settling import Approach
from gaincert.verify.simulation.summary import Summary
from gaincert.verify.simulation.trajectory import Trajectory
from gaincert.workflows.obstacles import confirmed


def fleet_with(coulomb=0.0, footprint=None):
    content = tomllib.loads(dumps(paper_fleet()), parse_float=str)
    content["disturbance"] = {"coulomb": coulomb, "sample_time": "0.02"}
    for vehicle in content["vehicle"]:
        if footprint is not None:
            vehicle["footprint"] = footprint
    return parse(content)


def rows_with(coulomb, saturation=None):
    gains = replace(paper_gains(), saturation=saturation or Saturation())
    return demand_rows(fleet_with(coulomb), paper_excitation(), gains)


def run_of(x, y):
    zero = np.zeros_like(x)
    t = np.arange(float(len(x)))
    return Trajectory(t, State(x, y, zero, zero, zero), zero, zero, t, t)


SUMMARY = Summary(
    settling_time=math.inf,
    approach=Approach.STANDING_STILL,
    tolerance=Tolerance(),
    horizon=80.0,
    peak_torque_ratio=0.5,
    final_position_error=2.0,
    final_heading_error=0.3,
    max_V_increase=0.0,
    peak_speed=1.0,
    peak_turn_rate=1.0,
    violations=(),
    disturbance=Disturbance(0.02, coulomb=1.0),
)


# -- friction ----------------------------------------------------------------------------------------------------------


def test_without_friction_nothing_is_in_the_way():
    assert obstacles.of_fleet(fleet_with()) == []
    rows = rows_with(0.0)
    assert obstacles.of_gains(rows, Tolerance()) == []
    assert all(row.stops_within == row.stops_turned == 0 for row in rows)
    assert "friction / N m" not in for_terminal(rows).headings


def test_friction_beyond_the_motors_is_said_of_the_fleet():
    (found,) = obstacles.of_fleet(fleet_with(56))
    assert str(found).startswith(
        "friction of 56 N m at every wheel is more than the motors of 'v1', 'v2', 'v5' and 1 more"
    )
    assert "stronger motors" in found.remedy


def test_friction_beyond_the_controller_is_said_of_the_gains():
    rows = rows_with(30)  # v1 never asks for more than 26.5 N m
    (found,) = obstacles.of_gains(rows, Tolerance())
    assert found.what == "the controller never asks 'v1' for more torque than friction takes, so they do not move"
    assert "--torque-factor" in found.remedy


def test_friction_near_the_goal_is_said_with_the_distance():
    rows = rows_with(0.1)
    position, heading = max(row.stops_within for row in rows), max(row.stops_turned for row in rows)
    assert 0.1 < position < math.inf and 0.1 < heading < math.inf
    (found,) = obstacles.of_gains(rows, Tolerance())
    assert re.search(r"friction may hold 'v\d' up to \d\.\d+ m from its place, up to \d\.\d+ rad off, and", found.what)
    assert obstacles.of_gains(rows, Tolerance(1.01 * position, 1.01 * heading)) == []
    for one in (Tolerance(1.01 * position, 0.99 * heading), Tolerance(0.99 * position, 1.01 * heading)):
        assert len(obstacles.of_gains(rows, one)) == 1


def test_what_friction_may_do_is_a_note_where_runs_settle_all_the_same(capsys):
    (may,) = obstacles.of_gains(rows_with(0.1), Tolerance())
    (does,) = obstacles.of_gains(rows_with(30), Tolerance())
    assert confirmed(
        Printer(json=False, quiet=False, verbose=False), [may, does], "all of 100 starts with friction"
    ) == [does]
    said = "".join(capsys.readouterr())
    assert f"note: {may.what}; all of 100 starts with friction settle all the same" in said
    assert does.what not in said


def test_friction_that_no_turn_overcomes_holds_a_robot_anywhere():
    (found,) = obstacles.of_gains(rows_with(0.5), Tolerance())
    assert "anywhere" in found.what


@pytest.mark.parametrize("kind", ["along", "across", "turned"])
def test_at_these_errors_every_wheel_gets_the_torque_that_friction_takes(kind):
    """All robots off by the printed errors, with headings along x: the controller (6) asks for +- 0.1 N m."""
    content = tomllib.loads(dumps(fleet_with(0.1)), parse_float=str)
    content["leader"]["heading_deg"] = 0
    fleet, scale = parse(content), Saturation(Fraction("2.5"), Fraction("0.5"), Fraction(1), Fraction(1))
    gains, psi = replace(paper_gains(), saturation=scale), paper_excitation()
    position, heading = standstill(fleet, psi, gains, kind)
    plant, zero = fleet.plant(), np.zeros(6)
    x, y = plant.offset_x + plant.leader_x, plant.offset_y + plant.leader_y
    state = State(x + position * (kind == "along"), y + position * (kind == "across"), heading, zero, zero)
    psi_bar = float(psi.bound) * (kind == "across")
    torques = control(numpy_ops(), plant, gains.map(floats), psi_bar, state)
    assert np.abs(torques) == pytest.approx(np.full((2, 6), 0.1))


def standstill(fleet, psi, gains, kind):
    """The errors (m, rad) of one kind, with all others 0."""
    strong = {"along": "k_alpha", "across": "p_v"}  # pulls that are made so strong that friction does not matter there
    factor = {strong[kind]: getattr(gains, strong[kind]) * 1000} if kind in strong else {}
    rows = demand_rows(fleet, psi, replace(gains, **factor))
    position = np.array([row.stops_within for row in rows])
    heading = np.array([row.stops_turned for row in rows])
    return (np.zeros(6), heading) if kind == "turned" else (position, np.zeros(6))


def test_a_smaller_scale_of_the_speed_certifies_a_lower_speed():
    half = rows_with(0, Saturation(1, 1, Fraction(1, 2), 1))
    whole = rows_with(0)
    for one, other in zip(half, whole, strict=True):
        assert one.speed == pytest.approx(other.speed / 2)


def test_a_bound_that_does_not_exist_is_called_so():
    rows = [row._replace(speed=math.inf) for row in rows_with(0.5)]
    assert for_terminal(rows).rows[0][-2] == "no bound"


# -- control rate, collisions, runs ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("sample", "largest", "count"), [(0.02, 0.05, 0), (0.05, 0.02, 1), (None, 0.1, 0), (None, None, 0)]
)
def test_a_computer_that_is_too_slow_is_named(sample, largest, count):
    found = obstacles.of_control_rate(sample, largest)
    assert len(found) == count
    assert not found or "every 50 ms, and this design needs 20 ms or less" in found[0].what


def test_a_disturbance_with_which_nothing_settles_is_named():
    (found,) = obstacles.of_control_rate(0.02, None)
    assert "not all ranking starts settle, however often the torques are computed" in found.what
    assert "check delay, noise and friction and their units" in found.remedy


def test_a_short_horizon_is_no_obstacle():
    """A disturbed run that does not arrive in a time in which the nominal one does not either."""
    late, arrived = (replace(SUMMARY, disturbance=None, settling_time=time) for time in (math.inf, 10.0))
    assert obstacles.of_run(fleet_with(), replace(SUMMARY, nominal=late)) == []
    assert len(obstacles.of_run(fleet_with(), replace(SUMMARY, nominal=arrived))) == 1


def test_robots_that_collide_are_named_where_their_size_is_known():
    x = np.array([[0.0, 5, 9, 13, 17, 21], [0.0, 0.5, 9, 13, 17, 21]])
    room = Room.of(run_of(x, np.zeros_like(x)), paper_fleet().names)
    summary = replace(SUMMARY, disturbance=None, room=room)
    assert obstacles.of_run(fleet_with(), summary) == []
    assert obstacles.of_run(fleet_with(footprint="0.2"), summary) == []
    (found,) = obstacles.of_run(fleet_with(footprint="0.4"), summary)
    assert found.what == "'v1' and 'v2' come within 0.5 m at 1 s and need 0.8 m: they collide"


def test_without_footprints_robots_nearer_than_their_half_tracks_get_a_hint():
    x = np.array([[0.0, 5, 9, 13, 17, 21], [0.0, 0.05, 9, 13, 17, 21]])
    summary = replace(SUMMARY, room=Room.of(run_of(x, np.zeros_like(x)), paper_fleet().names))
    (hint,) = obstacles.footprint_hints(fleet_with(), summary)
    width = sum(float(nominal(vehicle.half_track)) for vehicle in paper_fleet().vehicles[:2])
    assert width > 0.05
    assert hint.startswith(
        f"'v1' and 'v2' come within 0.05 m of each other, and their half tracks add up to {width:g} m"
    )
    assert obstacles.footprint_hints(fleet_with(footprint="0.4"), summary) == []
    x[1, 1] = width + 0.01
    apart = replace(SUMMARY, room=Room.of(run_of(x, np.zeros_like(x)), paper_fleet().names))
    assert obstacles.footprint_hints(fleet_with(), apart) == []
    assert obstacles.footprint_hints(fleet_with(), SUMMARY) == []


def test_a_disturbed_run_that_stands_still_is_useless_and_one_that_closes_in_is_not():
    (found,) = obstacles.of_run(fleet_with(), SUMMARY)
    assert "after 80 s it is standing still, 2 m and 0.3 rad off" in found.what
    assert obstacles.of_run(fleet_with(), replace(SUMMARY, approach=Approach.CLOSING_IN)) == []
    assert obstacles.of_run(fleet_with(), replace(SUMMARY, settling_time=10.0)) == []


def test_both_searches_for_the_nearest_pair_agree(random):
    x, y = random.uniform(-5, 5, (2, 7, 40))
    t = np.arange(7.0)
    assert _among_all(t, x, y) == pytest.approx(_by_tree(t, x, y))


def test_one_robot_has_no_nearest_one():
    room = Room.of(run_of(np.array([[0.0], [3.0]]), np.array([[0.0], [4.0]])), ["v1"])
    assert room.to_json() == {"room_m": [3.0, 4.0], "least_distance_m": None, "nearest": None}
    assert room.sentence() == "the fleet uses 3 m x 4 m"
