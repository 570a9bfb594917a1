"""The largest demands of a controller on every robot, compared with motor and friction, and its certified speeds."""

from __future__ import annotations

import math
from typing import NamedTuple

from ...models.arrays import floats
from ...models.conditions import float_numbers, pulling_bound, torque_bound, turning_bound
from ...models.excitation import Excitation
from ...models.fleet import Fleet
from ...models.fleet_tables import Vehicle
from ...models.gains import Gains
from ...models.numbers import low
from .terminal import TerminalTable

SHOWN = 20  # vehicles on a terminal


class DemandRow(NamedTuple):
    """One vehicle under its controller; nominal values for intervals."""

    vehicle: str
    motor: float  # N m, the smaller torque limit of both wheels
    friction: float  # N m, Coulomb friction at every wheel, of the [disturbance] table
    torque: float  # N m, T of (16*), the bound of all torques
    stops_within: float  # m, along-track error at which friction outweighs the controller; inf: everywhere
    speed: float  # m/s, certified bound from rest; inf: none
    turn_rate: float  # rad/s, the same


def demand_rows(fleet: Fleet, excitation: Excitation, gains: Gains) -> list[DemandRow]:
    """One row per vehicle of a fleet with the links that are used."""
    numbers, data, gains = float_numbers(), fleet.condition_data(excitation).map(floats), gains.map(floats)
    scale, friction = gains.saturation, coulomb(fleet)
    torques = torque_bound(numbers, data, gains)
    pull, turn = pulling_bound(numbers, data, gains) / gains.d_v, turning_bound(numbers, data, gains) / gains.d_omega
    speeds, rates = scale.columns(len(fleet))["speed"], scale.columns(len(fleet))["turn_rate"]
    return [
        DemandRow(
            vehicle=name,
            motor=float(data.torque[i]),
            friction=friction,
            torque=float(torques[i]),
            stops_within=float(scale.position) * _atanh(2 * friction / (data.r[i] * gains.p_v[i] * data.degree[i])),
            speed=float(speeds[i]) * _atanh(pull[i]),
            turn_rate=float(rates[i]) * _atanh(turn[i]),
        )
        for i, name in enumerate(fleet.names)
    ]


def coulomb(fleet: Fleet) -> float:
    """Coulomb friction at every wheel, N m; 0 unless the fleet file gives it."""
    return float(fleet.disturbance.coulomb) if fleet.disturbance else 0.0


def _atanh(share: float) -> float:
    return math.atanh(share) if share < 1 else math.inf


def for_terminal(rows: list[DemandRow]) -> TerminalTable:
    """The first rows for a terminal; with a friction column if there is friction."""
    headings = ["vehicle", "torque / N m", "motor / N m"]
    rubbing = any(row.friction for row in rows)
    headings += ["friction / N m", "may stop within / m"] if rubbing else []
    headings += ["speed / m/s", "turn rate / rad/s"]
    table = [
        [
            row.vehicle,
            f"{row.torque:.3g}",
            f"{row.motor:.3g}",
            *([f"{row.friction:.3g}", _finite(row.stops_within, "anywhere")] if rubbing else []),
            _finite(row.speed, "no bound"),
            _finite(row.turn_rate, "no bound"),
        ]
        for row in rows[:SHOWN]
    ]
    caption = "torque, speed and turn rate never exceed these from rest"
    if rubbing:
        caption += "; friction may stop a vehicle within this distance of its place"
    return TerminalTable(headings, table, caption)


def _finite(value: float, otherwise: str) -> str:
    return otherwise if math.isinf(value) else f"{value:.3g}"


def motor_torque(vehicle: Vehicle) -> float:
    """The smaller torque limit of both wheels, N m."""
    return float(min(low(vehicle.torque_limit.left), low(vehicle.torque_limit.right)))
