"""Numbers that are possible and yet most likely slips: grams, millimetres, kg cm, degrees, the track for its half.

No slip is an error. The thresholds leave room for every robot that we know of.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from .arrays import floats
from .errors import some_vehicles
from .fleet import Fleet
from .fleet_tables import Leader, Pose, Vehicle
from .numbers import low, nominal

DENSE, LIGHT = 3000.0, 2.0  # kg / m^3, mass over the cube of the track: metal, and foam
WIDE, TALL = 5.0, 2.0  # m, half track and wheel radius
FAR = 2000.0  # tracks from the leader
FIERCE = 90.0  # m/s^2 under full torque; tyres hold about 10
NARROW, BROAD = 0.5, 5.0  # radius of gyration over half track
LATE = 1.0  # s, delay and sample time
DRAGGING = 0.5  # of a motor's torque: friction
HEAVY = 5.0  # times the mass: what the wheels' inertia adds
BODY = 10.0  # half tracks: a footprint
SPINNING = 20.0  # rad/s, limit of a turn rate
FAST, ROLLING = 30.0, 15.0  # m/s: limit of a speed, and of the rim of a wheel


class Slip(NamedTuple):
    """One suspicious entry of a vehicle."""

    kind: str
    text: str  # with the value, and the likely slip


def taken_to_be(vehicle: Vehicle) -> str:
    """The robot in words that a person would notice."""
    return (
        f"{_kg(vehicle)} on wheels of {_length(2 * float(nominal(vehicle.wheel_radius)))} diameter, "
        f"{_length(2 * float(nominal(vehicle.half_track)))} apart; full torque accelerates it at "
        f"{acceleration(vehicle):.3g} m/s^2"
    )


def acceleration(vehicle: Vehicle) -> float:
    """The acceleration under the full torque of both wheels, m/s^2, if the tyres held."""
    torque = sum(low(limit) for limit in (vehicle.torque_limit.left, vehicle.torque_limit.right))
    return float(torque / (nominal(vehicle.wheel_radius) * nominal(vehicle.mass)))


def motor_torque(vehicle: Vehicle) -> float:
    """The smaller torque limit of both wheels, N m."""
    return float(min(low(vehicle.torque_limit.left), low(vehicle.torque_limit.right)))


def slips(fleet: Fleet) -> list[str]:
    """One line for every kind of slip, with the vehicles that it concerns."""
    return [
        *_of_leader(fleet.leader),
        *_of_table(fleet),
        *_lines(fleet, lambda one: (*_of_numbers(one), *_of_limits(one), *_of_places(one, fleet.leader))),
        *(_on_one_place(fleet) or _too_near(fleet)),
    ]


def slips_of_run(fleet: Fleet, sample_time: float, delay: float, coulomb: float) -> list[str]:
    """The same of what only a run has: times (s) and friction (N m) that it is disturbed with; starts above limits."""
    return [*_of_disturbance(fleet, sample_time, delay, coulomb), *_lines(fleet, _of_start)]


def _lines(fleet: Fleet, slips_of: Callable[[Vehicle], Iterable[Slip]]) -> Iterator[str]:
    """One line for every kind of slip that a vehicle has."""
    found: dict[str, list[tuple[str, str]]] = defaultdict(list)
    for vehicle in fleet.vehicles:
        for slip in slips_of(vehicle):
            found[slip.kind].append((vehicle.name, slip.text))
    return (_line(entries, len(fleet)) for entries in found.values())


def _line(entries: Sequence[tuple[str, str]], count: int) -> str:
    """The slip of one kind: the first vehicle's text, and how many others it concerns."""
    name, text = entries[0]
    if len(entries) == 1:
        return f"vehicle {name!r}: {text}"
    same = all(other == text for _, other in entries)
    who = "every vehicle" if len(entries) == count else some_vehicles([repr(name) for name, _ in entries])
    return f"{who}: {text}" if same else f"{who}: {text} (these are the numbers of {name!r})"


def _of_numbers(vehicle: Vehicle) -> Iterator[Slip]:
    """Mass, lengths, torque and inertia against each other."""
    mass, radius = float(nominal(vehicle.mass)), float(nominal(vehicle.wheel_radius))
    half = float(nominal(vehicle.half_track))
    track, density = _length(2 * half), mass / (2 * half) ** 3
    gyration = math.sqrt(float(nominal(vehicle.inertia)) / mass) / half
    if half > WIDE or radius > TALL:
        yield Slip(
            "lengths",
            f"wheel_radius = {radius:g} m and half_track = {half:g} m: lengths are in m, not in mm",
        )
        return
    if not LIGHT <= density <= DENSE:
        likely = "dense as metal: mass is in kg, not in g" if density > DENSE else "lighter than foam: use kg and m"
        yield Slip("mass", f"{_kg(vehicle)} between wheels {track} apart is {likely}")
        return
    if gyration > BROAD:
        yield Slip(
            "inertia",
            f"inertia = {float(nominal(vehicle.inertia)):g} kg m^2 is that of {_kg(vehicle)} at "
            f"{_length(gyration * half)} from the centre: it is in kg m^2, not in kg cm^2",
        )
    if (spun := 2 * float(nominal(vehicle.wheel_inertia)) / radius**2) > HEAVY * mass:
        yield Slip(
            "wheel inertia",
            f"wheel_inertia = {float(nominal(vehicle.wheel_inertia)):g} kg m^2 adds {spun:.3g} kg to {_kg(vehicle)}: "
            "it is in kg m^2, of one wheel",
        )
    if vehicle.footprint is not None and vehicle.footprint > BODY * half:
        yield Slip(
            "footprint",
            f"footprint = {float(vehicle.footprint):g} m is the radius of a robot with wheels {track} apart: "
            "it is in m, not in mm",
        )
    if radius > 2 * half:
        yield Slip("wheels", f"wheel_radius = {radius:g} m is more than the track of {track}: exchanged, or in cm?")
    if acceleration(vehicle) > FIERCE:
        torque = float(low(vehicle.torque_limit.left))
        yield Slip(
            "torque",
            f"torque_limit = {torque:g} N m could accelerate {_kg(vehicle)} at "
            f"{acceleration(vehicle):.3g} m/s^2, and tyres hold about 10: torque_limit is in N m, not in kg cm",
        )
    if gyration < NARROW or (vehicle.footprint is not None and vehicle.footprint < nominal(vehicle.half_track)):
        yield Slip(
            "track",
            f"half_track = {half:g} m puts the wheels {track} apart, far out for this robot: it is half "
            "the distance between them, not all of it",
        )


def _of_limits(vehicle: Vehicle) -> Iterator[Slip]:
    """Limits in other units, and starts above limits that are to be certified."""
    limits, radius = vehicle.limits, float(nominal(vehicle.wheel_radius))
    if limits.turn_rate is not None and limits.turn_rate > SPINNING:
        turns = float(limits.turn_rate) / math.tau
        yield Slip(
            "turn rate",
            f"turn_rate = {float(limits.turn_rate):g} rad/s is {turns:.3g} turns a second: use rad/s, not deg/s",
        )
    if limits.speed is not None and limits.speed > FAST:
        yield Slip("speed", f"speed = {float(limits.speed):g} m/s: it is in m/s, not in mm/s")
    if limits.wheel_speed is not None and float(limits.wheel_speed) * radius > ROLLING:
        yield Slip(
            "wheel speed",
            f"wheel_speed = {float(limits.wheel_speed):g} rad/s rolls at "
            f"{float(limits.wheel_speed) * radius:.3g} m/s: it is in rad/s, not in rpm",
        )
    yield from _of_start(vehicle)


def _of_start(vehicle: Vehicle) -> Iterator[Slip]:
    """A start above a limit that is to be certified."""
    limits, start = vehicle.limits, vehicle.start
    if start is None:
        return
    for key, value, most in (("v", start.v, limits.speed), ("omega", start.omega, limits.turn_rate)):
        if most is not None and abs(value) > most:
            yield Slip(
                f"start {key}",
                f"starts with {key} = {float(value):g}, above the limit {float(most):g}: "
                "no gains can be certified for that",
            )


def _of_places(vehicle: Vehicle, leader: Leader) -> Iterator[Slip]:
    """Places in millimetres, and headings in degrees that are read as radians."""
    track = 2 * float(nominal(vehicle.half_track))
    start, points = vehicle.start, {"offset": vehicle.offset}
    if start is not None:
        x, y = (here - goal for here, goal in zip(start.position, leader.position, strict=True))
        points["start"] = x, y
    for what, point in points.items():
        if (distance := math.hypot(*point)) > FAR * track:
            yield Slip(
                f"{what} place",
                f"its {what} is {_length(distance)} from the leader: lengths are in m, not in mm",
            )
    if start is not None and in_degrees(start):
        yield Slip("heading", _degrees("start heading", start.theta))


def _of_leader(leader: Leader) -> Iterator[str]:
    if in_degrees(leader):
        yield _degrees("leader: heading", leader.theta)


def _of_table(fleet: Fleet) -> Iterator[str]:
    if (table := fleet.disturbance) is not None:
        yield from _of_disturbance(fleet, float(table.sample_time or 0), float(table.delay), float(table.coulomb))


def _of_disturbance(fleet: Fleet, sample_time: float, delay: float, coulomb: float) -> Iterator[str]:
    """Times in milliseconds, rates for times, and friction that takes most of what the motors have."""
    for key, time, other in (
        ("sample_time", sample_time, "not in ms, and no rate in Hz"),
        ("delay", delay, "not in ms"),
    ):
        if time > LATE:
            yield f"disturbance: {key} = {time:g} s is late for any robot: it is a time in s, {other}"
    share, weakest = max((coulomb / motor_torque(vehicle), vehicle.name) for vehicle in fleet.vehicles)
    if DRAGGING < share < 1:  # what holds a motor for good is an obstacle
        yield (
            f"disturbance: coulomb = {coulomb:g} N m takes {100 * share:.0f} % of the torque of {weakest!r}: "
            "it is the friction at one wheel, in N m"
        )


def in_degrees(pose: Pose) -> bool:
    """Whether the heading in rad is more than a turn, and so most likely meant in degrees."""
    return pose.heading is not None and abs(pose.heading) > math.tau


def _degrees(what: str, heading: float) -> str:
    turns = abs(heading) / math.tau
    return f"{what} = {heading:g} rad is {turns:.3g} turns: for degrees write heading_deg = {heading:g}"


def _on_one_place(fleet: Fleet) -> list[str]:
    """Vehicles with the same offset or the same start."""
    found = []
    for what, follows in (("offset", "they collide at the goal"), ("start position", "they start inside each other")):
        places: dict[object, list[str]] = defaultdict(list)
        for vehicle in fleet.vehicles:
            if what == "offset":
                places[vehicle.offset].append(vehicle.name)
            elif vehicle.start is not None:
                places[vehicle.start.position].append(vehicle.name)
        for names in places.values():
            if len(names) > 1:
                found.append(f"{some_vehicles([*map(repr, names)])} have the same {what}: {follows}; give each its own")
    return found


def _too_near(fleet: Fleet) -> list[str]:
    """The pair of offsets, and of starts, that lies nearest for its footprints, if nearer than these."""
    vehicles = [vehicle for vehicle in fleet.vehicles if vehicle.footprint is not None]
    started = [vehicle for vehicle in vehicles if vehicle.start is not None]
    offsets = [vehicle.offset for vehicle in vehicles]
    starts = [vehicle.start.position for vehicle in started if vehicle.start is not None]
    return [*_nearest("offsets", vehicles, offsets), *_nearest("start positions", started, starts)]


def _nearest(what: str, vehicles: Sequence[Vehicle], places: Sequence[tuple[Fraction, Fraction]]) -> Iterator[str]:
    if len(vehicles) < 2:
        return
    from scipy.spatial import cKDTree

    distance, other = cKDTree(floats(places)).query(floats(places), k=2)
    sizes = floats([vehicle.footprint for vehicle in vehicles])
    needed = sizes + sizes[other[:, 1]]
    i = int(np.argmin(distance[:, 1] / needed))
    if distance[i, 1] < needed[i]:
        pair = " and ".join(repr(vehicles[k].name) for k in sorted((i, int(other[i, 1]))))
        yield (
            f"vehicles {pair}: their {what} are {distance[i, 1]:.3g} m apart, and their footprints need "
            f"{needed[i]:.3g} m: they collide there"
        )


def _kg(vehicle: Vehicle) -> str:
    return f"{float(nominal(vehicle.mass)):.6g} kg"


def _length(metres: float) -> str:
    return f"{1000 * metres:.4g} mm" if metres < 1 else f"{metres:.4g} m"
