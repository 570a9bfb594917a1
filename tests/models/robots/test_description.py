"""Robot descriptions: a small robot computed by hand, laws of frames, and hostile files."""

import math
from fractions import Fraction

import numpy as np
import pytest
from gaincert.models.errors import InputError
from gaincert.models.files.robots.description import read_robot
from gaincert.models.files.robots.document import read_document

from tests.models.robots.robot_files import INERTIA, ROBOT, WHEEL_INERTIA, inertial


def written(tmp_path, text):
    path = tmp_path / "robot.urdf"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def keys(tmp_path, text):
    return read_robot(written(tmp_path, text)).vehicle_keys()


def refusal(tmp_path, text):
    with pytest.raises(InputError) as caught:
        read_robot(written(tmp_path, text))
    (line,) = caught.value.mistakes
    assert line.isprintable()
    return line.removeprefix(f"{tmp_path}/robot.urdf: ")


def test_a_robot_computed_by_hand(tmp_path):
    found = keys(tmp_path, ROBOT)
    assert found.keys() == {"mass", "inertia", "half_track", "wheel_radius", "wheel_inertia", "com_offset"}
    assert found["mass"] == 8
    assert float(found["inertia"]) == pytest.approx(INERTIA, abs=1e-12)
    assert found["half_track"] == Fraction("0.25")
    assert found["wheel_radius"] == Fraction("0.11")
    assert found["wheel_inertia"] == Fraction(str(WHEEL_INERTIA))
    # base 4 kg at (0.3, 0), mast 2 kg at (0, 0.2), arm 1 kg at (-0.4, 0.3), seen from the axle's centre
    assert [float(value) for value in found["com_offset"]] == pytest.approx([(1.2 - 0.4) / 8, (0.4 + 0.3) / 8])


def test_where_the_root_frame_lies_does_not_count(tmp_path):
    """The same robot on a footprint that is shifted and turned about the vertical."""
    moved = ROBOT.replace(
        '<link name="sensor"/>',
        '<link name="sensor"/><link name="footprint"/><joint name="f" type="fixed"><parent link="footprint"/>'
        '<child link="base"/><origin xyz="3 -2 1" rpy="0 0 0.7"/></joint>',
    )
    here, there = (keys(tmp_path, text) for text in (ROBOT, moved))
    assert there["mass"] == here["mass"]
    for key in ("inertia", "half_track", "wheel_radius", "wheel_inertia"):
        assert float(there[key]) == pytest.approx(float(here[key]), abs=1e-11)
    assert list(map(float, there["com_offset"])) == pytest.approx(list(map(float, here["com_offset"])), abs=1e-11)


def rotation(roll, pitch, yaw):
    """URDF's Rz(yaw) Ry(pitch) Rx(roll), by Rodrigues' formula."""
    product = np.eye(3)
    for axis, angle in ((2, yaw), (1, pitch), (0, roll)):
        generator = np.zeros((3, 3))
        i, j = (axis + 1) % 3, (axis + 2) % 3
        generator[i, j], generator[j, i] = -1, 1
        product = product @ (np.eye(3) + math.sin(angle) * generator + (1 - math.cos(angle)) * generator @ generator)
    return product


def test_frames_follow_one_another_from_the_root(tmp_path):
    """Turns do not commute: base -> mast -> arm, each with an attitude of its own."""
    first, second, own = (0.3, -0.8, 1.1), (-1.2, 0.4, 0.9), (0.7, 0.2, -0.5)
    text = ROBOT
    for old, new in (
        ('xyz="0.1 0 0" rpy="0 0 1.5707963267948966"', f'xyz="0.1 0 0" rpy="{first[0]} {first[1]} {first[2]}"'),
        ('xyz="0.3 0.4 0"', f'xyz="0.3 0.4 0" rpy="{second[0]} {second[1]} {second[2]}"'),
        ('xyz="0 0 0" rpy="1.5707963267948966 0 0"', f'xyz="0.1 0.2 0.3" rpy="{own[0]} {own[1]} {own[2]}"'),
    ):
        assert text.count(old) == 1
        text = text.replace(old, new)
    R1, R2, R3 = rotation(*first), rotation(*second), rotation(*own)
    mast = [0.1, 0, 0] + R1 @ [0.2, 0, 1]
    arm = [0.1, 0, 0] + R1 @ ([0.3, 0.4, 0] + R2 @ [0.1, 0.2, 0.3])
    upright, turned = R1 @ np.diag([7, 7.125, 0.25]) @ R1.T, R1 @ R2 @ R3 @ np.diag([9, 0.125, 9]) @ (R1 @ R2 @ R3).T
    expected = 0.86 + 2 * (0.01 + 0.03125)
    for tensor, mass, (x, y, _) in ((upright, 2, mast), (turned, 1, arm)):
        expected += tensor[2, 2] + mass * ((x - 0.1) ** 2 + y**2)
    assert float(keys(tmp_path, text)["inertia"]) == pytest.approx(expected, abs=1e-11)


@pytest.mark.parametrize("seed", range(3))
def test_any_attitude_of_a_frame_gives_the_rotated_tensor(tmp_path, seed):
    """The yaw inertia is e_z^T R I R^T e_z, with URDF's R = Rz(yaw) Ry(pitch) Rx(roll), products of inertia and all."""
    random = np.random.default_rng(seed)
    masses = random.normal(size=(3, 3))  # points: their tensor breaks no inequality
    tensor = np.round(sum((p @ p) * np.eye(3) - np.outer(p, p) for p in masses), 6)
    roll, pitch, yaw = np.round(random.uniform(-3, 3, 3), 6)
    R = rotation(roll, pitch, yaw)
    places = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
    attributes = " ".join(f'{key}="{tensor[place]:.6f}"' for key, place in places.items())
    old = '<inertia ixx="1" ixy="0" ixz="0" iyy="1.25" iyz="0" izz="0.5"/>'
    text = ROBOT.replace(old, f"<inertia {attributes}/>")
    text = text.replace('<origin xyz="0.4 0 0.2"/>', f'<origin xyz="0.4 0 0.2" rpy="{roll} {pitch} {yaw}"/>')
    found = keys(tmp_path, text)
    assert float(found["inertia"]) - INERTIA + 0.5 == pytest.approx((R @ tensor @ R.T)[2, 2], abs=1e-10)


@pytest.mark.needs("shared")
def test_the_turtlebot3_burger(shared):
    # The base about its own vertical; wheels at +-0.08 m, rolled by -1.57; caster at -0.081, scanner at -0.032.
    s, c = math.sin(-1.57), math.cos(-1.57)
    wheel = 1.1192413e-05 * s**2 + 2.0712558e-05 * c**2 + 2 * -1.4400107e-11 * s * c + 2.8498940e-02 * 0.08**2
    caster = 0.001 * s**2 + 0.001 * c**2 + 0.005 * 0.081**2
    scanner = 0.001 + 0.114 * 0.032**2
    inertia = 2.0064271e-03 + 2 * wheel + caster + scanner
    assert inertia == pytest.approx(0.00454313937, abs=5e-12)

    found = read_robot(shared / "data" / "turtlebot3_burger.urdf").vehicle_keys()
    assert found["mass"] == Fraction("1.00173292")
    assert float(found["inertia"]) == pytest.approx(inertia, abs=1e-12)
    assert found["half_track"] == Fraction("0.08")
    assert found["wheel_radius"] == Fraction("0.033")


# -- bad files --------------------------------------------------------------------------------------------------------

LAUGHS = "".join(f'<!ENTITY l{i} "{f"&l{i - 1};" * 10}">' for i in range(1, 12))


@pytest.mark.parametrize(
    "text",
    [
        f'<?xml version="1.0"?><!DOCTYPE r [<!ENTITY l0 "ha">{LAUGHS}]><robot name="&l11;"/>',
        '<!DOCTYPE r [<!ENTITY x SYSTEM "file:///etc/passwd">]><robot>&x;</robot>',
        f'<!DOCTYPE r [<!ENTITY a "{"a" * 10000}">]><robot>{"&a;" * 1000}</robot>',
        ROBOT[: len(ROBOT) // 2],
        ROBOT.replace("</robot>", "</robt>"),
        "",
        "not XML",
        b"\x00" * 50,
        '<?xml version="1.0" encoding="utf-7"?><robot/>',
    ],
    ids=["laughs", "external entity", "quadratic", "cut", "mismatched", "empty", "no XML", "NUL", "encoding"],
)
def test_unsafe_or_broken_xml_is_refused(text, tmp_path):
    assert refusal(tmp_path, text).startswith(("is not safe XML: ", "has no <link>"))


def test_no_entity_is_expanded_not_even_a_harmless_one(tmp_path):
    text = ROBOT.replace("<robot", '<!DOCTYPE r [<!ENTITY four "4">]><robot').replace('value="4"', 'value="&four;"')
    assert refusal(tmp_path, text).startswith("is not safe XML: EntitiesForbidden")


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('name="jl" type="continuous"', 'name="jl" type="fixed"', "has no drive wheels: two continuous joints on one"),
        ('<mass value="4"/>', '<mass value="nan"/>', "link 'base': <inertial>: <mass>: value = 'nan' is not finite"),
        ('<mass value="4"/>', '<mass value="1e999999"/>', "has more than 60 digits or an exponent beyond 60"),
        ('<mass value="4"/>', '<mass value="four"/>', "value = 'four' is not a number; it must be a finite number"),
        ('<mass value="4"/>', '<mass value="-1"/>', "link 'base': <inertial> has the mass -1 kg; it must be >= 0"),
        ('<mass value="4"/>', "<mass/>", "link 'base': <inertial>: <mass> has no value; give value="),
        ('<mass value="4"/>', "", "link 'base': <inertial> has no <mass>; give <mass value="),
        ('iyz="0" izz="0.5"/>', 'iyz="0" izz="-9"/>', "the smallest principal moment -9; none may be negative"),
        ('izz="0.5"/>', "/>", "link 'base': <inertial>: <inertia> has no izz; give izz="),
        ('<inertia ixx="1" ixy="0" ixz="0" iyy="1.25" iyz="0" izz="0.5"/>', "", "has no <inertia>; give <inertia ixx="),
        ('xyz="0.4 0 0.2"', 'xyz="0.4 0"', "xyz = '0.4 0' must be three finite numbers between spaces"),
        ('xyz="0.4 0 0.2"', 'xyz="0.4, 0, 0.2"', "between spaces; write spaces for commas"),
        ('<child link="left"/>', '<child link="nowhere"/>', "joint 'jl': its child link 'nowhere' is not in the file"),
        ('<child link="left"/>', "", "joint 'jl' has no <child link="),
        (
            '<child link="left"/>',
            '<child link="right"/>',
            "link 'right' is the child of 2 joints; a link has one parent",
        ),
        ('<link name="sensor"/>', '<link name="base"/>', "link 'base' is listed 2 times; give each link a name of its"),
        ('name="js" type', 'name="jr" type', "joint 'jr' is listed 2 times; give each joint a name of its own"),
        ('name="js" type="fixed"', 'type="fixed"', "a <joint> has no name; give it one"),
        ('<link name="sensor"/>', "<link/>", "a <link> has no name; give it one"),
        ('name="js" type="fixed"', 'name="js"', "joint 'js' has no type; a wheel has"),
        ('<axis xyz="0 1 0"/>', '<axis xyz="0 0 0"/>', "joint 'jl': its <axis> is '0 0 0'; it must not be zero"),
        ('<parent link="base"/><child link="mast"/>', '<parent link="arm"/><child link="mast"/>', "form a loop"),
        ('<joint name="js" type="fixed">', '<note name="js">', "is not safe XML"),
        ('<cylinder radius="0.11" length="0.03"/>', '<box size="1 1 1"/>', "has no cylinder or sphere from which"),
        ('<cylinder radius="0.11" length="0.03"/>', "<cylinder/>", "link 'left': collision cylinder has no radius"),
        ('<cylinder radius="0.11"', '<cylinder radius="0"', "link 'left': its wheel radius is 0 m; it must be > 0"),
        (
            '<cylinder radius="0.11"',
            '<cylinder radius="0.12"',
            "different radii, 0.11 m (collision cylinder of 'right') and 0.12 m (collision cylinder of 'left')",
        ),
    ],
)
def test_what_is_no_differential_drive_is_refused(old, new, says, tmp_path):
    assert old in ROBOT
    assert says in refusal(tmp_path, ROBOT.replace(old, new, 1))


def test_all_mistakes_come_at_once(tmp_path):
    text = ROBOT.replace('<mass value="4"/>', "").replace('<mass value="2"/>', '<mass value="-2"/>')
    with pytest.raises(InputError) as caught:
        read_robot(written(tmp_path, text))
    assert ["'base'" in line for line in caught.value.mistakes] == [True, False]
    assert "'mast'" in caught.value.mistakes[1]


def test_a_second_root_is_refused(tmp_path):
    text = ROBOT.replace("</robot>", f'<link name="adrift">{inertial(100, 1, 1, 1, "5 0 0")}</link></robot>')
    assert "links 'base', 'adrift' have no parent; one root is needed" in refusal(tmp_path, text)


def test_a_chain_of_links_without_end_is_refused(tmp_path):
    links = "".join(f'<link name="k{i}"/>' for i in range(3000))
    joints = "".join(
        f'<joint name="n{i}" type="fixed"><parent link="k{i + 1}"/><child link="k{i}"/></joint>' for i in range(2999)
    )
    joints += '<joint name="top" type="fixed"><parent link="base"/><child link="k2999"/></joint>'
    assert "a chain of more than 100" in refusal(tmp_path, ROBOT.replace("</robot>", f"{links}{joints}</robot>"))


def test_xml_nested_without_end_is_refused_or_read(tmp_path):
    assert refusal(tmp_path, "<a>" * 20000 + "</a>" * 20000)


def test_files_that_cannot_be_read(tmp_path):
    with pytest.raises(InputError, match="Is a directory"):
        read_robot(tmp_path)
    with pytest.raises(InputError, match="No such file"):
        read_robot(tmp_path / "none.urdf")
    assert refusal(tmp_path, ROBOT.replace("cart", "é").encode("latin-1")) == "is not UTF-8 text"
    with pytest.raises(InputError, match=r"robot\.urdf: is larger than 1 MiB"):
        read_document(written(tmp_path, "<robot/>" + " " * 2**20), 2**20)
