"""Inertias that no body has are refused. Strange but possible values give a warning."""

import numpy as np
import pytest
from gaincert.models.errors import InputError
from gaincert.models.files.robots.description import read_robot
from gaincert.models.files.robots.masses import Body
from hypothesis import given
from hypothesis import strategies as st

from tests.models.robots.robot_files import BASE, PAIR, WHEEL_BODY, inertial, joint, link, robot


@pytest.fixture
def read(tmp_path):
    def read(*parts, **options):
        (tmp_path / "robot.urdf").write_text(robot(*parts))
        return read_robot(tmp_path / "robot.urdf", **options)

    return read


def test_a_base_that_breaks_the_triangle_inequality_is_refused(read):
    with pytest.raises(InputError, match=r"link 'base': the principal moments 0.1, 0.1, 0.3 kg m.2 are no body's"):
        read(link("base", inertial(10, 0.1, 0.1, 0.3)), PAIR)


def test_a_flat_plate_is_a_body(read):
    assert read(link("base", inertial(10, 0.1, 0.1, 0.2)), PAIR).warnings == ()


def test_a_wheel_that_breaks_it_is_refused_however_small(read):
    body = inertial(0.1, 1e-6, 1e-4, 1e-6)
    with pytest.raises(InputError, match="link 'l': the principal moments"):
        read(BASE, PAIR.replace(WHEEL_BODY, body, 1))


def test_a_finger_that_breaks_it_is_said_and_does_not_count(read):
    finger = link("finger", inertial(0.05, 1e-4, 0, 0)) + joint("f", "finger", kind="prismatic")
    (warning,) = read(BASE, PAIR, finger).warnings
    assert warning.startswith("link 'finger': the principal moments 0, 0, 0.0001 kg m^2 are no body's")
    assert warning.endswith("used unchanged: it is below 0.1% of the robot's yaw inertia")


def test_products_of_inertia_may_make_a_moment_negative(read):
    text = inertial(10, 0.1, 0.1, 0.15).replace('ixy="0"', 'ixy="0.2"')
    with pytest.raises(InputError, match=r"link 'base': .* the smallest principal moment -0.1; none may be negative"):
        read(link("base", text), PAIR)


def test_a_base_without_mass_is_said(read):
    ballast = link("ballast", inertial(3, 0.1, 0.1, 0.1)) + joint("b", "ballast", kind="prismatic", axis="0 0 1")
    bare = link("base", "")
    (warning,) = read(bare, PAIR, ballast).warnings
    assert warning.startswith("the base ('base') has no mass: 3.2 kg is the mass of the other links alone")
    assert read(bare, PAIR, ballast, given={"mass", "inertia"}).warnings == ()


def test_a_robot_without_any_mass_is_refused(read):
    bare = PAIR.replace(WHEEL_BODY, "")
    with pytest.raises(
        InputError, match=r"the links' mass is 0 kg .* both must be > 0: give mass and inertia in the fleet"
    ):
        read(link("base", ""), bare)


def test_a_wheel_heavier_about_its_axle_than_a_rim_is_said(read):
    heavy = PAIR.replace(WHEEL_BODY, inertial(0.1, 1e-3, 1e-3, 1e-3))
    warnings = read(BASE, heavy).warnings
    assert len(warnings) == 2
    assert (
        "its moment about the axle, 0.001 kg m^2, is more than its 0.1 kg on the rim would have (0.00025)"
        in warnings[0]
    )


@given(st.lists(st.tuples(*[st.floats(-2, 2)] * 3), min_size=4, max_size=8), st.tuples(*[st.floats(-3, 3)] * 3))
def test_a_body_of_points_is_possible_and_has_the_moment_of_its_points(points, place):
    """For the moment about any line: the sum of mass times distance squared."""
    points = np.array(points)
    centre = points.mean(axis=0)
    tensor = sum(((p - centre) @ (p - centre)) * np.eye(3) - np.outer(p - centre, p - centre) for p in points)
    body = Body("cloud", len(points), centre, tensor)
    assert body.impossible <= 1e-12 * (1 + np.trace(tensor))
    axis = np.array([0.6, 0, 0.8])
    expected = sum(np.sum(np.cross(axis, p - place) ** 2) for p in points)
    assert body.about(np.array(place), axis) == pytest.approx(expected, rel=1e-9, abs=1e-9)
