"""Small robots for tests: one computed by hand, and functions that build others."""

# Axle centre at (0.1, 0) in the root frame; wheels at (0.1, +-0.25); a mast turned by a quarter turn about the vertical
# and an arm whose inertia tensor is given in a frame rolled by a quarter turn.
ROBOT = """<?xml version="1.0"?>
<robot name="cart">
  <link name="base">
    <inertial><origin xyz="0.4 0 0.2"/><mass value="4"/>
      <inertia ixx="1" ixy="0" ixz="0" iyy="1.25" iyz="0" izz="0.5"/></inertial>
  </link>
  <link name="mast">
    <inertial><origin xyz="0.2 0 1"/><mass value="2"/>
      <inertia ixx="7" ixy="0" ixz="0" iyy="7.125" iyz="0" izz="0.25"/></inertial>
  </link>
  <link name="arm">
    <inertial><origin xyz="0 0 0" rpy="1.5707963267948966 0 0"/><mass value="1"/>
      <inertia ixx="9" ixy="0" ixz="0" iyy="0.125" iyz="0" izz="9"/></inertial>
  </link>
  <link name="left">
    <inertial><mass value="0.5"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.003" iyz="0" izz="0.01"/></inertial>
    <collision><geometry><cylinder radius="0.11" length="0.03"/></geometry></collision>
  </link>
  <link name="right">
    <inertial><mass value="0.5"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.003" iyz="0" izz="0.01"/></inertial>
    <collision><geometry><cylinder radius="0.11" length="0.03"/></geometry></collision>
  </link>
  <link name="sensor"/>
  <joint name="j1" type="fixed"><parent link="base"/><child link="mast"/>
    <origin xyz="0.1 0 0" rpy="0 0 1.5707963267948966"/></joint>
  <joint name="j2" type="fixed"><parent link="mast"/><child link="arm"/><origin xyz="0.3 0.4 0"/></joint>
  <joint name="jl" type="continuous"><parent link="base"/><child link="left"/><origin xyz="0.1 0.25 0"/>
    <axis xyz="0 1 0"/></joint>
  <joint name="jr" type="continuous"><parent link="base"/><child link="right"/><origin xyz="0.1 -0.25 0"/>
    <axis xyz="0 1 0"/></joint>
  <joint name="js" type="fixed"><parent link="base"/><child link="sensor"/></joint>
</robot>
"""
# base: 0.5 + 4 * 0.3^2. mast: centre of mass at (0.1, 0.2), so 0.25 + 2 * 0.2^2.
# arm: at (0.1, 0) + a quarter turn of (0.3, 0.4) = (-0.3, 0.3); its y axis stands upright, so 0.125 + (0.4^2 + 0.3^2).
# each wheel: 0.01 + 0.5 * 0.25^2.
INERTIA = (0.5 + 0.36) + (0.25 + 0.08) + (0.125 + 0.25) + 2 * (0.01 + 0.03125)
WHEEL_INERTIA = 0.003


def inertial(mass, xx, yy, zz, at="0 0 0"):
    """An <inertial> without products of inertia."""
    return (
        f'<inertial><origin xyz="{at}"/><mass value="{mass}"/>'
        f'<inertia ixx="{xx}" ixy="0" ixz="0" iyy="{yy}" iyz="0" izz="{zz}"/></inertial>'
    )


WHEEL_BODY = inertial(0.1, 1e-4, 1e-4, 1e-4)


def link(name, body=WHEEL_BODY, shape=""):
    """A link with a body and one collision shape."""
    collision = f"<collision><geometry>{shape}</geometry></collision>" if shape else ""
    return f'<link name="{name}">{body}{collision}</link>'


def joint(name, child, kind="continuous", parent="base", at="0 0 0", axis="0 1 0", rpy="0 0 0", limit=""):
    """A joint."""
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{at}" rpy="{rpy}"/><axis xyz="{axis}"/>{limit}</joint>'
    )


def cylinder(radius):
    """A wheel's shape."""
    return f'<cylinder radius="{radius}" length="0.02"/>'


def wheel(name, at, radius=0.05, **keys):
    """A wheel and its joint, called NAME_joint."""
    return link(name, shape=cylinder(radius)) + joint(f"{name}_joint", name, at=at, **keys)


BASE = link("base", inertial(10, 0.1, 0.1, 0.15))
PAIR = wheel("l", "0 0.2 0.05") + wheel("r", "0 -0.2 0.05")


def robot(*parts):
    """The text of a description."""
    return f'<robot name="kit">{"".join(parts)}</robot>'
