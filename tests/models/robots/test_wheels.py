"""Which joints are the drive wheels: found by geometry in any order and frame; the others are named with a reason."""

import pytest
from gaincert.models.errors import InputError
from gaincert.models.files.robots.description import read_robot
from gaincert.models.files.robots.wheels import WheelNames

from tests.models.robots.robot_files import BASE, PAIR, WHEEL_BODY, cylinder, inertial, joint, link, robot, wheel


@pytest.fixture
def read(tmp_path):
    def read(*parts, **options):
        (tmp_path / "robot.urdf").write_text(robot(*parts))
        return read_robot(tmp_path / "robot.urdf", **options)

    return read


def refusal(read, *parts):
    with pytest.raises(InputError) as caught:
        read(*parts)
    (line,) = caught.value.mistakes
    return line.partition("robot.urdf: ")[2]


CASTER_WHEEL = link("cw", shape=cylinder(0.05)) + joint("cw_joint", "cw", parent="swivel", at="0.02 0 0")
SWIVEL = link("swivel")
OTHERS = {
    "spinning sensor": (link("scan") + joint("scan_joint", "scan", at="0 0 0.3", axis="0 0 1"), "is not horizontal"),
    "roller": (wheel("roller", "-0.2 0 0.02", radius=0.02), "no other wheel turns about the same axis"),
    "arms": (
        wheel("al", "0.1 0.15 0.6") + wheel("ar", "0.1 -0.15 0.6"),
        "it does not reach the floor",
    ),
    "caster": (
        SWIVEL + joint("swivel_joint", "swivel", at="-0.2 0 0.05", axis="0 0 1") + CASTER_WHEEL,
        "joint 'swivel_joint' above it turns its axis",
    ),
}


@pytest.mark.parametrize("other", OTHERS)
@pytest.mark.parametrize("first", [True, False])
def test_the_pair_is_found_and_the_others_are_named(other, first, read):
    text, why = OTHERS[other]
    found = read(BASE, *((text, PAIR) if first else (PAIR, text)))
    assert (found.left_wheels, found.right_wheels) == (("l_joint",), ("r_joint",))
    assert any(why in ignored.why for ignored in found.ignored)
    assert len(found.ignored) == text.count('type="continuous"')


@pytest.mark.parametrize("yaw", [0.0, 0.7, 2.0, 3.0, -1.6])
def test_left_is_left_of_the_carrying_links_x_axis_however_it_is_turned(yaw, read):
    frame = link("world", "") + joint("mount", "base", kind="fixed", parent="world", rpy=f"0 0 {yaw}")
    found = read(BASE, PAIR, frame)
    assert (found.left_wheels, found.right_wheels) == (("l_joint",), ("r_joint",))


def test_axes_may_point_either_way_and_be_rounded(read):
    left = wheel("l", "0 0.2 0.05", axis="0 0 1", rpy="-1.57 0 0")
    right = wheel("r", "0 -0.2 0.05", axis="0 0 1", rpy="1.57 0 0")
    assert float(read(BASE, left, right).numbers["half_track"].value) == 0.2


def test_a_suspension_that_slides_or_rocks_about_the_axle_is_no_swivel(read):
    parts = [BASE]
    for side, y, kind, axis in (("l", 0.2, "prismatic", "0 0 1"), ("r", -0.2, "revolute", "0 1 0")):
        parts += [
            link(f"{side}_arm"),
            joint(f"{side}_arm_joint", f"{side}_arm", kind=kind, at=f"0 {y} 0.05", axis=axis),
        ]
        parts += [wheel(side, "0 0 0", parent=f"{side}_arm")]
    found = read(*parts)
    assert (found.left_wheels, found.right_wheels) == (("l_joint",), ("r_joint",))


def test_what_is_fixed_to_a_wheel_turns_with_it(read):
    """A tyre: J is of rim and tyre, and the tyre's offset from the axle counts by the parallel-axis theorem."""
    tyre = link("tyre", inertial(0.2, 3e-4, 4e-4, 3e-4)) + joint("t", "tyre", kind="fixed", parent="l", at="0.01 0 0")
    found = read(BASE, PAIR, tyre)
    assert float(found.numbers["wheel_inertia"].value) == pytest.approx((2e-4 + 4e-4 + 0.2 * 0.01**2) / 2)


REVOLUTE = wheel("l", "0 0.2 0.05", kind="revolute") + wheel("r", "0 -0.2 0.05", kind="revolute")
SMALL = wheel("cl", "-0.25 0.1 0.02", radius=0.02) + wheel("cr", "-0.25 -0.1 0.02", radius=0.02)


def test_casters_are_not_taken_for_wheels_that_are_revolute(read):
    says = refusal(read, BASE, REVOLUTE, SMALL)
    assert says.startswith(
        "has 2 pairs that may be the drive wheels: 'l_joint' and 'r_joint' (type revolute, radius 0.05"
    )
    assert "'cl_joint' and 'cr_joint' (type continuous, radius 0.02 m); name the drive wheels: urdf = {" in says


@pytest.mark.parametrize("kind", ["revolute", "fixed"])
def test_wheels_of_another_type_are_named_with_it(kind, read):
    parts = BASE, REVOLUTE.replace("revolute", kind)
    says = refusal(read, *parts)
    assert says.startswith(f"joints 'l_joint' and 'r_joint' look like the drive wheels and have the type '{kind}'")


def test_two_pairs_that_reach_the_floor_are_ambiguous_until_they_are_named(read):
    assert refusal(read, BASE, PAIR, SMALL).startswith("has 2 pairs that may be the drive wheels")
    found = read(BASE, PAIR, SMALL, names=WheelNames(("l_joint",), ("r_joint",)))
    assert [ignored.joint for ignored in found.ignored] == ["cl_joint", "cr_joint"]


def test_a_car_is_refused(read):
    parts = [BASE, PAIR]
    for side, y in (("fl", 0.2), ("fr", -0.2)):
        parts += [link(f"{side}_knuckle"), wheel(side, "0 0 0", parent=f"{side}_knuckle")]
        parts += [joint(f"{side}_steer", f"{side}_knuckle", kind="revolute", at=f"0.4 {y} 0.05", axis="0 0 1")]
    assert refusal(read, *parts).startswith("joint 'fl_steer' steers the wheel of joint 'fl_joint': not a differential")


def test_an_axle_along_x_needs_names(read):
    along = wheel("a", "0.2 0 0.05", axis="1 0 0") + wheel("b", "-0.2 0 0.05", axis="1 0 0")
    assert "say which side is left: urdf = {" in refusal(read, BASE, along)
    found = read(BASE, along, names=WheelNames(("b",), ("a",)))
    assert float(found.numbers["half_track"].value) == 0.2
    assert found.warnings == ()


@pytest.mark.parametrize(
    ("spoiled", "says"),
    [
        (wheel("l", "0 0.2 0.05", kind="fixed"), "joint 'l_joint' has the type 'fixed'; a drive wheel has the type"),
        (wheel("l", "0 0.2 0.05", axis="0 0 1"), "joint 'l_joint' has no horizontal axis; a drive wheel's axis is"),
        (wheel("l", "0 0.2 0.05", axis="1 0 0"), "the axes of joints 'l_joint' and 'r_joint' are not parallel"),
    ],
)
def test_named_wheels_are_checked(spoiled, says, read):
    with pytest.raises(InputError) as caught:
        read(BASE, spoiled, wheel("r", "0 -0.2 0.05"), names=WheelNames(("l",), ("r",)))
    assert says in str(caught.value)


@pytest.mark.parametrize(
    "sign",
    [
        '<gazebo><plugin name="p" filename="libridgeback_ros_force_based_move.so"/></gazebo>',
        '<gazebo><plugin name="planar_move" filename="libgazebo_ros_planar_move.so"/></gazebo>',
        link("mecanum_roller", "") + joint("m", "mecanum_roller", kind="fixed"),
        link("cover", "", '<mesh filename="package://x/omni_wheel.stl"/>') + joint("m", "cover", kind="fixed"),
    ],
)
def test_a_mecanum_base_is_refused_as_such(sign, read):
    assert refusal(read, BASE, PAIR, sign).startswith("is a mecanum or omnidirectional base")
    with pytest.raises(InputError, match="is a mecanum"):
        read(BASE, PAIR, sign, names=WheelNames(("l",), ("r",)))


def test_an_omnidirectional_sensor_is_no_mecanum_wheel(read):
    assert read(BASE, PAIR, '<gazebo><plugin name="ir_omni_plugin" filename="libir.so"/></gazebo>').left_wheels == (
        "l_joint",
    )


def test_the_largest_round_shape_is_the_wheel_and_collision_comes_before_visual(read):
    shapes = "".join(f"<collision><geometry>{cylinder(r)}</geometry></collision>" for r in (0.04, 0.05, 0.045))
    drawn = f"<visual><geometry>{cylinder(0.07)}</geometry></visual>"
    left, right = (
        f'<link name="{name}">{WHEEL_BODY}{shapes}{drawn}</link>' + joint(f"{name}_joint", name, at=f"0 {y} 0.05")
        for name, y in (("l", 0.2), ("r", -0.2))
    )
    assert float(read(BASE, left, right).numbers["wheel_radius"].value) == 0.05
    left, right = (side.replace(shapes, "") for side in (left, right))
    radius = read(BASE, left, right).numbers["wheel_radius"]
    assert (float(radius.value), radius.source) == (0.07, "visual cylinder of 'l'")


def test_too_many_joints_that_may_be_wheels(read):
    assert refusal(read, BASE, *(wheel(f"w{i}", f"{i} 0 0.05") for i in range(65))).startswith(
        "has 65 joints that may be"
    )


def test_no_joint_turns(read):
    assert "(continuous joints: none); correct the joints or name the wheels" in refusal(read, BASE)
