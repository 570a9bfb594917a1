"""The fleet as a MuJoCo model: its masses and inertias, wheels that roll on contact, casters without friction.

A wheel touches the floor in one point, as a sphere does: the contact of a cylinder of some width resists turning on the
spot, which (2) does not know. Robots do not touch each other.
"""

from __future__ import annotations

from dataclasses import dataclass
from xml.etree import ElementTree

from ...models.errors import InputError
from ...models.fleet import Fleet
from ...models.fleet_tables import Vehicle
from ...models.numbers import nominal

TIME_STEP = 0.001  # s
FRICTION = 1.0  # of a wheel on the floor, as of rubber on concrete
WHEEL_MASS = 0.02  # of the robot's mass, at most, for each wheel
WHEEL_YAW = 0.05  # of the robot's yaw inertia, at most, for the mass of each wheel
LEAST_SPIN = 1e-3  # of m r^2: J of a wheel where the fleet has less, since a body without inertia cannot be simulated
CLEARANCE = 2e-3  # of r: a caster hangs as high above the floor
_CONTACT = {"solref": "0.004 1", "solimp": "0.99 0.999 0.0001"}  # stiff: a wheel creeps little under load


_DRY = {"solreffriction": "0.002 1", "solimpfriction": "0.999 0.9999 0.0001"}  # a wheel below its friction stands still


@dataclass(frozen=True)
class Bodies:
    """How one robot's mass and inertia are shared between its base and its wheels."""

    base_mass: float  # kg
    base_centre: tuple[float, float]  # m, ahead and left of the axle's middle
    base_inertia: float  # kg m^2, yaw, about the base's own centre of mass
    wheel_mass: float  # kg, of one wheel
    spin: float  # kg m^2, J of one wheel about the axle

    @classmethod
    def of(cls, vehicle: Vehicle) -> Bodies:
        """Totals are those of the fleet file: mass, centre of mass, and yaw inertia about the axle's middle."""
        m, inertia, R, r = (
            float(nominal(value)) for value in (vehicle.mass, vehicle.inertia, vehicle.half_track, vehicle.wheel_radius)
        )
        spin = max(float(nominal(vehicle.wheel_inertia)), LEAST_SPIN * m * r**2)
        wheel = min(WHEEL_MASS * m, WHEEL_YAW * inertia / R**2)
        base = m - 2 * wheel
        ahead, left = (m / base * float(value) for value in vehicle.com_offset)
        yaw = inertia - 2 * (wheel * R**2 + spin / 2) - base * (ahead**2 + left**2)
        if yaw <= 0:
            raise InputError(
                f"vehicle {vehicle.name!r}: inertia = {inertia:g} kg m^2 is less than its wheels and its centre of "
                f"mass off the axle need, {inertia - yaw:g}; correct inertia, wheel_inertia or com_offset"
            )
        return cls(base, (ahead, left), yaw, wheel, spin)


def scene_xml(fleet: Fleet, coulomb: float, viscous: float, time_step: float = TIME_STEP) -> str:
    """The MJCF text; friction at every wheel: coulomb in N m, viscous in N m s/rad."""
    root = ElementTree.Element("mujoco", model="gaincert")
    options = {"gravity": "0 0 -9.81", "solver": "Newton", "tolerance": "1e-12", "integrator": "implicitfast"}
    ElementTree.SubElement(
        root, "option", {**options, "timestep": f"{time_step!r}", "cone": "elliptic", "impratio": "100"}
    )
    world = ElementTree.SubElement(root, "worldbody")
    ElementTree.SubElement(world, "geom", type="plane", size="0 0 1", contype="1", conaffinity="1")
    actuators = ElementTree.SubElement(root, "actuator")
    for i, vehicle in enumerate(fleet.vehicles):
        _robot(world, actuators, i, vehicle, {"frictionloss": f"{coulomb!r}", "damping": f"{viscous!r}", **_DRY})
    return ElementTree.tostring(root, encoding="unicode")


def _robot(
    world: ElementTree.Element, actuators: ElementTree.Element, i: int, vehicle: Vehicle, friction: dict[str, str]
) -> None:
    bodies = Bodies.of(vehicle)
    R, r = float(nominal(vehicle.half_track)), float(nominal(vehicle.wheel_radius))
    base = ElementTree.SubElement(world, "body", name=f"base_{i}", pos=f"0 0 {r!r}")
    ElementTree.SubElement(base, "freejoint", name=f"free_{i}")
    _inertial(base, (*bodies.base_centre, 0.0), bodies.base_mass, (0.6, 0.6, 1.0), bodies.base_inertia)
    for side, y in (("left", R), ("right", -R)):
        wheel = ElementTree.SubElement(base, "body", name=f"{side}_{i}", pos=f"0 {y!r} 0")
        joint = {"name": f"{side}_{i}", "type": "hinge", "axis": "0 1 0"}
        ElementTree.SubElement(wheel, "joint", {**joint, **friction})
        _inertial(wheel, (0.0, 0.0, 0.0), bodies.wheel_mass, (0.5, 1.0, 0.5), bodies.spin)
        _ball(wheel, r, (0.0, 0.0, 0.0), f"{FRICTION} 0 0", "3")
        ElementTree.SubElement(actuators, "motor", name=f"{side}_{i}", joint=f"{side}_{i}")
    size = r / 4
    for x in (R, -R):
        _ball(base, size, (x, 0.0, size - r * (1 - CLEARANCE)), "0 0 0", "1")


def _inertial(
    body: ElementTree.Element, centre: tuple[float, ...], mass: float, shape: tuple[float, ...], moment: float
) -> None:
    moments = " ".join(repr(part * moment) for part in shape)
    place = " ".join(map(repr, centre))
    ElementTree.SubElement(body, "inertial", pos=place, mass=repr(mass), diaginertia=moments)


def _ball(body: ElementTree.Element, radius: float, place: tuple[float, ...], friction: str, dimension: str) -> None:
    """A geometry that touches the floor and nothing else; its friction wins over the floor's."""
    shape = {"type": "sphere", "size": repr(radius), "pos": " ".join(map(repr, place))}
    touch = {"friction": friction, "condim": dimension, "contype": "0", "conaffinity": "1", "priority": "1", **_CONTACT}
    ElementTree.SubElement(body, "geom", {**shape, **touch})
