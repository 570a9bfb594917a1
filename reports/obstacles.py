"""Obstacles: reasons why robots cannot use a design, each with a remedy, found before the robots run."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from ..models.fleet import Fleet
from ..models.numbers import nominal
from ..models.plausibility import motor_torque
from ..models.tolerance import Tolerance
from .tables.demands_table import DemandRow, coulomb

if TYPE_CHECKING:  # `check` needs no integrators
    from ..verify.simulation.room import Room
    from ..verify.simulation.summary import Summary


class Obstacle(NamedTuple):
    """A reason why the robots cannot use the design, and its remedy."""

    what: str
    remedy: str
    possible: bool = False  # it may happen; runs say whether it does

    def __str__(self) -> str:
        return f"{self.what}; {self.remedy}"


def of_fleet(fleet: Fleet) -> list[Obstacle]:
    """Obstacles for all gains: motors that cannot overcome friction."""
    friction = coulomb(fleet)
    held = [vehicle.name for vehicle in fleet.vehicles if motor_torque(vehicle) <= friction]
    if not held:
        return []
    what = f"friction of {friction:g} N m at every wheel is more than the motors of {_some(held)} can overcome"
    return [Obstacle(what, "correct torque_limit or coulomb, or take stronger motors")]


def of_gains(rows: list[DemandRow], tolerance: Tolerance) -> list[Obstacle]:
    """Friction against the torques that the controller asks for."""
    held = [row.vehicle for row in rows if row.torque <= row.friction]
    if held:
        what = f"the controller never asks {_some(held)} for more torque than friction takes, so they do not move"
        return [
            Obstacle(
                what,
                "reduce the friction, or raise what holds torques down: speed limit, torque limit, --torque-factor",
            )
        ]
    short = [row for row in rows if row.stops_within > tolerance.position or row.stops_turned > tolerance.heading]
    if not short:
        return []
    worst = max(short, key=lambda row: max(row.stops_within / tolerance.position, row.stops_turned / tolerance.heading))
    turned = "at any heading" if math.isinf(worst.stops_turned) else f"up to {worst.stops_turned:.3g} rad off"
    where = (
        "anywhere" if math.isinf(worst.stops_within) else f"up to {worst.stops_within:.3g} m from its place, {turned}"
    )
    what = (
        f"friction may hold {worst.vehicle!r} {where}, and {len(short)} of {len(rows)} vehicles outside the tolerance"
    )
    remedy = "ask for a wider --tolerance, reduce the friction, or raise what holds the torques down"
    return [Obstacle(what, remedy, possible=True)]


def of_control_rate(sample_time: float | None, largest: float | None) -> list[Obstacle]:
    """The fleet's sample time against the largest with which the design still settles, s; None if unknown."""
    if sample_time is None:
        return []
    if largest is None:
        what = "with the fleet's [disturbance] not all ranking starts settle, however often the torques are computed"
        return [Obstacle(what, "check delay, noise and friction and their units, or ask for a wider --tolerance")]
    if sample_time <= largest:
        return []
    what = (
        f"torques are computed every {1000 * sample_time:g} ms, and this design needs {1000 * largest:.3g} ms or less"
    )
    return [Obstacle(what, "compute them more often, or design with this sample_time in [disturbance]")]


def of_run(fleet: Fleet, summary: Summary) -> list[Obstacle]:
    """Collisions, and a disturbed run that does not reach its goal in a time in which the nominal one does."""
    from ..verify.simulation.settling import Approach

    found = [] if summary.room is None else _collisions(fleet, summary.room)
    in_time = summary.nominal is None or summary.nominal.settled
    late = not summary.settled and summary.approach is not Approach.CLOSING_IN
    if summary.disturbance is not None and late and in_time:
        what = (
            f"with its disturbance the fleet does not settle: after {summary.horizon:g} s it is {summary.approach}, "
            f"{summary.final_position_error:.3g} m and {summary.final_heading_error:.3g} rad off"
        )
        found.append(Obstacle(what, "reduce the disturbance or ask for a wider --tolerance"))
    return found


def _collisions(fleet: Fleet, room: Room) -> list[Obstacle]:
    """The nearest pair of robots, compared with their footprints, if both have one."""
    nearest = room.nearest
    sizes = [fleet.vehicles[i].footprint for i in (nearest.first, nearest.second)]
    if math.isinf(nearest.distance) or None in sizes:
        return []
    needed = float(sum(size for size in sizes if size is not None))
    if nearest.distance >= needed:
        return []
    pair = f"{room.names[nearest.first]!r} and {room.names[nearest.second]!r}"
    what = f"{pair} come within {nearest.distance:.3g} m at {nearest.time:.4g} s and need {needed:g} m: they collide"
    return [Obstacle(what, "change their starts or offsets; the controller does not avoid collisions")]


def footprint_hints(fleet: Fleet, summary: Summary) -> list[str]:
    """Robots that come nearer than their half tracks, where no footprint says whether they collide."""
    if summary.room is None or math.isinf(summary.room.nearest.distance):
        return []
    nearest = summary.room.nearest
    pair = [fleet.vehicles[i] for i in (nearest.first, nearest.second)]
    width = float(sum(nominal(vehicle.half_track) for vehicle in pair))
    if nearest.distance >= width or all(vehicle.footprint is not None for vehicle in pair):
        return []
    names = " and ".join(repr(vehicle.name) for vehicle in pair)
    return [
        f"{names} come within {nearest.distance:.3g} m of each other, and their half tracks add up to {width:g} m: "
        "robots that large collide. Give each vehicle its footprint (a radius, m) to have this judged"
    ]


def _some(names: list[str]) -> str:
    shown = ", ".join(map(repr, names[:3]))
    return shown if len(names) <= 3 else f"{shown} and {len(names) - 3} more"
