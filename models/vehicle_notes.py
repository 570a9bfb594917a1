"""Notes on surprising entries of a vehicle: a centre of mass off the axle, a start some turns away from the goal."""

from __future__ import annotations

import math

from .fleet import Fleet
from .fleet_tables import Leader, Vehicle
from .numbers import nominal

OFF_AXLE = 0.01  # report an offset of the centre of mass above this share of the track
NAMED = 10  # vehicles that a note names


def centre_of_mass_note(fleet: Fleet) -> str | None:
    """Which centres of mass lie off the middle of the axle, and what that means; None if all are near it."""
    off = [vehicle for vehicle in fleet.vehicles if is_off_axle(vehicle)]
    if not off:
        return None
    named = "; ".join(f"{vehicle.name!r} {place_of_mass(vehicle)}" for vehicle in off[:NAMED])
    more = f"; and {len(off) - NAMED} more" if len(off) > NAMED else ""
    return (
        f"the centre of mass is off the middle of the axle: {named}{more}. All results hold for (2), which ignores that"
    )


def is_off_axle(vehicle: Vehicle) -> bool:
    """Whether the centre of mass is more than 1 % of the track off the middle of the axle."""
    return math.hypot(*vehicle.com_offset) > OFF_AXLE * 2 * float(nominal(vehicle.half_track))


def place_of_mass(vehicle: Vehicle) -> str:
    """Where the centre of mass is, seen from the middle of the axle, in cm and in per cent of the track."""
    ahead, left = (100 * float(value) for value in vehicle.com_offset)
    words = [
        f"{abs(value):.3g} cm {word}"
        for value, word in ((ahead, "ahead" if ahead > 0 else "behind"), (left, "left" if left > 0 else "right"))
        if abs(value) >= 0.05
    ]
    share = math.hypot(ahead, left) / (2 * float(nominal(vehicle.half_track)))
    return f"{' and '.join(words) or 'less than 1 mm'} ({share:.2g} % of the track)"


def heading_hint(vehicle: Vehicle, leader: Leader) -> str | None:
    """A note on a start more than half a turn from the leader's heading; it names the nearest heading of the same pose.

    None if the start is within half a turn. Headings lie on the real line: a vehicle turns back every whole turn.
    """
    if vehicle.start is None:
        return None
    error = vehicle.start.theta - leader.theta
    turns = math.ceil(abs(error) / math.tau - 0.5 - 1e-9)  # whole turns; without them at most half a turn is left
    if turns == 0:
        return None
    nearer = math.degrees(vehicle.start.theta - math.copysign(turns * math.tau, error))
    return (
        f"vehicle {vehicle.name!r} starts {math.degrees(abs(error)):.4g} degrees from the leader's heading and will "
        f"turn back by all of them; heading_deg = {nearer:.10g} is the same pose and nearer"
    )
