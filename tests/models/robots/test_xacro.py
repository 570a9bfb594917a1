"""xacro: expanded if the package is installed, else the message names it; endless computations are stopped."""

import sys
from fractions import Fraction

import pytest
from gaincert.models.errors import InputError
from gaincert.models.files.robots.description import read_robot
from gaincert.models.files.robots.xacro import expand

from tests.models.robots.robot_files import BASE, WHEEL_BODY, joint, robot

SPACE = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
MACRO = f"""<robot name="kit" {SPACE}>
  <xacro:property name="radius" value="0.04"/>
  <xacro:macro name="wheel" params="side reflect">
    <link name="${{side}}">{WHEEL_BODY}<collision><geometry>
      <cylinder radius="${{radius * 2}}" length="0.02"/></geometry></collision></link>
    <joint name="${{side}}_joint" type="continuous"><parent link="base"/><child link="${{side}}"/>
      <origin xyz="0 ${{reflect * 0.2}} 0.08"/><axis xyz="0 1 0"/></joint>
  </xacro:macro>
  {BASE}
  <xacro:wheel side="left" reflect="1"/><xacro:wheel side="right" reflect="-1"/>
</robot>
"""


def written(tmp_path, text, name="robot.urdf.xacro"):
    path = tmp_path / name
    path.write_text(text)
    return path


@pytest.mark.needs("xacro")
def test_macros_and_properties_are_expanded(tmp_path):
    found = read_robot(written(tmp_path, MACRO))
    assert found.left_wheels == ("left_joint",)
    assert found.numbers["wheel_radius"].value == Fraction("0.08")


@pytest.mark.needs("xacro")
def test_files_beside_it_are_included(tmp_path):
    written(tmp_path, MACRO.replace(BASE, "").replace('<xacro:wheel side="left" reflect="1"/>', ""), "parts.xacro")
    include = f'<robot name="kit" {SPACE}><xacro:include filename="parts.xacro"/>{BASE}'
    found = read_robot(written(tmp_path, f'{include}<xacro:wheel side="left" reflect="1"/></robot>'))
    assert (found.left_wheels, found.right_wheels) == (("left_joint",), ("right_joint",))


@pytest.mark.needs("xacro")
def test_no_module_beside_the_file_is_run(tmp_path, monkeypatch):
    trap = "raise SystemExit('run')"
    for name in ("xacro.py", "math.py", "resource.py"):
        written(tmp_path, trap, name)
    monkeypatch.chdir(tmp_path)
    assert read_robot(written(tmp_path, MACRO)).left_wheels == ("left_joint",)


@pytest.mark.needs("xacro")
@pytest.mark.parametrize(
    ("spoiled", "says"),
    [
        ("${radius * 3 + missing}", "this is xacro and does not expand: "),
        ("$(find some_robot)", "this is xacro and does not expand: "),
        ("${().__class__.__base__.__subclasses__()}", "this is xacro and does not expand: "),
        ("${list(map(open, ['/etc/passwd']))}", "this is xacro and does not expand: "),
        ("${'x' * 10**10}", "this is xacro and does not expand: "),
    ],
)
def test_what_does_not_expand_is_refused(spoiled, says, tmp_path):
    with pytest.raises(InputError) as caught:
        read_robot(written(tmp_path, MACRO.replace("${radius * 2}", spoiled)))
    (line,) = caught.value.mistakes
    assert line.isprintable()
    assert says in line
    assert "run `xacro robot.urdf.xacro NAME:=VALUE > robot.urdf` there and name robot.urdf" in line


@pytest.mark.needs("xacro")
def test_a_computation_without_end_is_stopped(tmp_path):
    with pytest.raises(InputError, match="does not expand within 2 s; simplify it"):
        expand(written(tmp_path, MACRO.replace("${radius * 2}", "${7**7**9 > 0}")), 2**20, time_limit=2)


@pytest.mark.needs("xacro")
def test_an_expansion_without_bound_is_refused(tmp_path):
    with pytest.raises(InputError, match="expands to more than 0 MiB"):
        expand(written(tmp_path, MACRO), 100)


def test_the_message_names_the_package_where_it_is_missing(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "xacro", None)
    with pytest.raises(InputError) as caught:
        read_robot(written(tmp_path, MACRO))
    assert "this is xacro, and the package that expands it is missing: pip install 'gaincert[robots]'" in str(
        caught.value
    )


def test_an_expanded_file_that_still_declares_the_namespace_is_urdf(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "xacro", None)
    wheels = "".join(
        f'<link name="{side}">{WHEEL_BODY}<collision><geometry><sphere radius="0.05"/></geometry></collision></link>'
        + joint(f"{side}_joint", side, at=f"0 {y} 0.05")
        for side, y in (("l", 0.2), ("r", -0.2))
    )
    text = robot(BASE, wheels).replace("<robot", f"<robot {SPACE}")
    assert read_robot(written(tmp_path, text)).left_wheels == ("l_joint",)
