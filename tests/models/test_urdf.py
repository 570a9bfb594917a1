"""Robots from URDF: a small robot whose numbers are computed by hand, a real one, and files that mean harm."""

import math
from fractions import Fraction
from pathlib import Path

import gaincert
import numpy as np
import pytest
from gaincert.models.errors import InputError
from gaincert.models.files import urdf as module
from gaincert.models.files.fleet_file import parse
from gaincert.models.files.urdf import read_urdf

TURTLEBOT = Path(gaincert.__file__).resolve().parent.parent / "shared" / "data" / "turtlebot3_burger.urdf"

# Axle centre at (0.1, 0) in the root frame; wheels at (0.1, +-0.25); a mast turned by a quarter turn about the vertical
# and an arm whose inertia tensor is given in a frame rolled by a quarter turn.
ROBOT = """<?xml version="1.0"?>
<robot name="cart">
  <link name="base">
    <inertial><origin xyz="0.4 0 0.2"/><mass value="4"/>
      <inertia ixx="1" ixy="0" ixz="0" iyy="2" iyz="0" izz="0.5"/></inertial>
  </link>
  <link name="mast">
    <inertial><origin xyz="0.2 0 1"/><mass value="2"/>
      <inertia ixx="7" ixy="0" ixz="0" iyy="8" iyz="0" izz="0.25"/></inertial>
  </link>
  <link name="arm">
    <inertial><origin xyz="0 0 0" rpy="1.5707963267948966 0 0"/><mass value="1"/>
      <inertia ixx="9" ixy="0" ixz="0" iyy="0.125" iyz="0" izz="9"/></inertial>
  </link>
  <link name="left">
    <inertial><mass value="0.5"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.01"/></inertial>
    <collision><geometry><cylinder radius="0.11" length="0.03"/></geometry></collision>
  </link>
  <link name="right">
    <inertial><mass value="0.5"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.01"/></inertial>
    <collision><geometry><cylinder radius="0.11" length="0.03"/></geometry></collision>
  </link>
  <link name="sensor"/>
  <joint name="j1" type="fixed"><parent link="base"/><child link="mast"/>
    <origin xyz="0.1 0 0" rpy="0 0 1.5707963267948966"/></joint>
  <joint name="j2" type="fixed"><parent link="mast"/><child link="arm"/><origin xyz="0.3 0.4 0"/></joint>
  <joint name="jl" type="continuous"><parent link="base"/><child link="left"/><origin xyz="0.1 0.25 0"/></joint>
  <joint name="jr" type="continuous"><parent link="base"/><child link="right"/><origin xyz="0.1 -0.25 0"/></joint>
  <joint name="js" type="fixed"><parent link="base"/><child link="sensor"/></joint>
</robot>
"""
# base: 0.5 + 4 * 0.3^2. mast: centre of mass at (0.1, 0.2), so 0.25 + 2 * 0.2^2.
# arm: at (0.1, 0) + a quarter turn of (0.3, 0.4) = (-0.3, 0.3); its y axis stands upright, so 0.125 + (0.4^2 + 0.3^2).
# each wheel: 0.01 + 0.5 * 0.25^2.
INERTIA = (0.5 + 0.36) + (0.25 + 0.08) + (0.125 + 0.25) + 2 * (0.01 + 0.03125)


def written(tmp_path, text):
    path = tmp_path / "robot.urdf"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def refusal(tmp_path, text):
    with pytest.raises(InputError) as caught:
        read_urdf(written(tmp_path, text))
    (line,) = caught.value.mistakes
    assert line.isprintable()
    return line.removeprefix(f"{tmp_path}/robot.urdf: ")


def test_a_robot_computed_by_hand(tmp_path):
    found = read_urdf(written(tmp_path, ROBOT))
    assert found.keys() == {"mass", "inertia", "half_track", "wheel_radius"}
    assert found["mass"] == 8
    assert float(found["inertia"]) == pytest.approx(INERTIA, abs=1e-12)
    assert found["half_track"] == Fraction("0.25")
    assert found["wheel_radius"] == Fraction("0.11")


def test_where_the_root_frame_lies_does_not_count(tmp_path):
    """The same robot on a footprint that is shifted and turned about the vertical."""
    moved = ROBOT.replace(
        '<link name="sensor"/>',
        '<link name="sensor"/><link name="footprint"/><joint name="f" type="fixed"><parent link="footprint"/>'
        '<child link="base"/><origin xyz="3 -2 1" rpy="0 0 0.7"/></joint>',
    )
    here, there = (read_urdf(written(tmp_path, text)) for text in (ROBOT, moved))
    assert there["mass"] == here["mass"]
    for key in ("inertia", "half_track", "wheel_radius"):
        assert float(there[key]) == pytest.approx(float(here[key]), abs=1e-11)


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
    upright, turned = R1 @ np.diag([7, 8, 0.25]) @ R1.T, R1 @ R2 @ R3 @ np.diag([9, 0.125, 9]) @ (R1 @ R2 @ R3).T
    expected = 0.86 + 2 * (0.01 + 0.03125)
    for tensor, mass, (x, y, _) in ((upright, 2, mast), (turned, 1, arm)):
        expected += tensor[2, 2] + mass * ((x - 0.1) ** 2 + y**2)
    assert float(read_urdf(written(tmp_path, text))["inertia"]) == pytest.approx(expected, abs=1e-11)


@pytest.mark.parametrize("seed", range(3))
def test_any_attitude_of_a_frame_gives_the_rotated_tensor(tmp_path, seed):
    """The yaw inertia is e_z^T R I R^T e_z, with URDF's R = Rz(yaw) Ry(pitch) Rx(roll), products of inertia and all."""
    random = np.random.default_rng(seed)
    root = random.normal(size=(3, 3))
    tensor = np.round(root @ root.T, 6)
    roll, pitch, yaw = np.round(random.uniform(-3, 3, 3), 6)
    R = rotation(roll, pitch, yaw)
    keys = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
    attributes = " ".join(f'{key}="{tensor[place]:.6f}"' for key, place in keys.items())
    old = '<inertia ixx="1" ixy="0" ixz="0" iyy="2" iyz="0" izz="0.5"/>'
    text = ROBOT.replace(old, f"<inertia {attributes}/>")
    text = text.replace('<origin xyz="0.4 0 0.2"/>', f'<origin xyz="0.4 0 0.2" rpy="{roll} {pitch} {yaw}"/>')
    found = read_urdf(written(tmp_path, text))
    assert float(found["inertia"]) - INERTIA + 0.5 == pytest.approx((R @ tensor @ R.T)[2, 2], abs=1e-10)


@pytest.mark.needs("shared")
def test_the_turtlebot3_burger():
    # The base about its own vertical; wheels at +-0.08 m, rolled by -1.57; caster at -0.081, scanner at -0.032.
    s, c = math.sin(-1.57), math.cos(-1.57)
    wheel = 1.1192413e-05 * s**2 + 2.0712558e-05 * c**2 + 2 * -1.4400107e-11 * s * c + 2.8498940e-02 * 0.08**2
    caster = 0.001 * s**2 + 0.001 * c**2 + 0.005 * 0.081**2
    scanner = 0.001 + 0.114 * 0.032**2
    inertia = 2.0064271e-03 + 2 * wheel + caster + scanner
    assert inertia == pytest.approx(0.00454313937, abs=5e-12)

    found = read_urdf(TURTLEBOT)
    assert found["mass"] == Fraction("1.00173292")
    assert float(found["inertia"]) == pytest.approx(inertia, abs=1e-12)
    assert found["half_track"] == Fraction("0.08")
    assert found["wheel_radius"] == Fraction("0.033")


# -- in a fleet file --------------------------------------------------------------------------------------------------


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
    assert "continuous joints" in caught.value.mistakes[0]
    assert all(line.startswith("vehicle 'a': torque_limit.") for line in caught.value.mistakes[1:])
    assert len(caught.value.mistakes) == 3


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
    assert refusal(tmp_path, text).startswith(("is not safe XML: ", "is not a differential-drive URDF: "))


def test_no_entity_is_expanded_not_even_a_harmless_one(tmp_path):
    text = ROBOT.replace("<robot", '<!DOCTYPE r [<!ENTITY four "4">]><robot').replace('value="4"', 'value="&four;"')
    assert refusal(tmp_path, text).startswith("is not safe XML: EntitiesForbidden")


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('name="jl" type="continuous"', 'name="jl" type="fixed"', "it has 1 continuous joints; a differential drive"),
        ('name="j1" type="fixed"', 'name="j1" type="continuous"', "it has 3 continuous joints"),
        ('<mass value="4"/>', '<mass value="nan"/>', "is not finite"),
        ('<mass value="4"/>', '<mass value="1e999999"/>', "has more than 60 digits or an exponent beyond 60"),
        ('<mass value="4"/>', '<mass value="four"/>', "is not a number"),
        ('<mass value="4"/>', '<mass value="-1"/>', "link 'base' has the mass -1.0 kg; it must be >= 0"),
        ('<mass value="4"/>', "", "is not a differential-drive URDF: "),
        ('iyz="0" izz="0.5"/>', 'iyz="0" izz="-9"/>', "both must be > 0"),
        ('izz="0.5"/>', "/>", "is not a differential-drive URDF: "),
        ('xyz="0.4 0 0.2"', 'xyz="0.4 0"', "is not a differential-drive URDF: "),
        ('<child link="left"/>', '<child link="nowhere"/>', "is not a differential-drive URDF: "),
        ('<child link="left"/>', "", "is not a differential-drive URDF: "),
        ('<parent link="base"/><child link="mast"/>', '<parent link="arm"/><child link="mast"/>', "form a loop"),
        ('<cylinder radius="0.11" length="0.03"/>', '<sphere radius="0.11"/>', "has no collision cylinder"),
        ('<cylinder radius="0.11"', '<cylinder radius="0.12"', "different radii [0.11, 0.12]; one is needed"),
    ],
)
def test_what_is_no_differential_drive_is_refused(old, new, says, tmp_path):
    assert old in ROBOT
    assert says in refusal(tmp_path, ROBOT.replace(old, new, 1))


def test_a_wheel_that_is_no_link_has_no_radius(tmp_path):
    text = ROBOT.replace('<child link="left"/>', '<child link="hub"/>')
    text = text.replace('<parent link="base"/><child link="sensor"/>', '<parent link="hub"/><child link="sensor"/>')
    assert "there is no link 'hub'" in refusal(tmp_path, text)


def test_a_chain_of_links_without_end_is_refused(tmp_path):
    links = "".join(f'<link name="k{i}"/>' for i in range(3000))
    joints = "".join(
        f'<joint name="n{i}" type="fixed"><parent link="k{i + 1}"/><child link="k{i}"/></joint>' for i in range(2999)
    )
    assert "a chain of more than 100" in refusal(tmp_path, ROBOT.replace("</robot>", f"{links}{joints}</robot>"))


def test_xml_nested_without_end_is_refused_or_read(tmp_path):
    assert refusal(tmp_path, "<a>" * 20000 + "</a>" * 20000)


def test_files_that_cannot_be_read(tmp_path, monkeypatch):
    with pytest.raises(InputError, match="Is a directory"):
        read_urdf(tmp_path)
    with pytest.raises(InputError, match="No such file"):
        read_urdf(tmp_path / "none.urdf")
    assert refusal(tmp_path, ROBOT.replace("cart", "é").encode("latin-1")) == "is not UTF-8 text"
    monkeypatch.setattr(module, "MAX_URDF_BYTES", 2**20)
    assert refusal(tmp_path, "<robot/>" + " " * 2**20).startswith("is larger than 1 MiB")
