"""The largest demands of a controller on every robot, compared with motor and friction, and its certified speeds."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ...models.arrays import Array, floats
from ...models.conditions import ConditionData, float_numbers, pulling_bound, torque_bound, turning_bound
from ...models.excitation import Excitation
from ...models.fleet import Fleet
from ...models.gains import Gains
from ...models.graph import Graph
from ...models.standstill import farthest_standstill
from .terminal import TerminalTable

SHOWN = 20  # vehicles on a terminal


class DemandRow(NamedTuple):
    """One vehicle under its controller; nominal values for intervals."""

    vehicle: str
    motor: float  # N m, the smaller torque limit of both wheels
    friction: float  # N m, Coulomb friction at every wheel, of the [disturbance] table
    torque: float  # N m, T of (16*), the bound of all torques
    stops_within: float  # m, largest position error at which friction may stop it; inf: everywhere
    stops_turned: float  # rad, largest heading error, the same
    speed: float  # m/s, certified bound from rest; inf: none
    turn_rate: float  # rad/s, the same


def demand_rows(fleet: Fleet, excitation: Excitation, gains: Gains) -> list[DemandRow]:
    """One row per vehicle of a fleet with the links that are used."""
    numbers, data, gains = float_numbers(), fleet.condition_data(excitation).map(floats), gains.map(floats)
    scale, friction = gains.saturation, coulomb(fleet)
    torques = torque_bound(numbers, data, gains)
    pull, turn = pulling_bound(numbers, data, gains) / gains.d_v, turning_bound(numbers, data, gains) / gains.d_omega
    speeds, rates = scale.columns(len(fleet))["speed"], scale.columns(len(fleet))["turn_rate"]
    position, heading = _standstill(fleet.graph, data, gains, friction)
    return [
        DemandRow(
            vehicle=name,
            motor=float(data.torque[i]),
            friction=friction,
            torque=float(torques[i]),
            stops_within=float(position[i]),
            stops_turned=float(heading[i]),
            speed=float(speeds[i]) * _atanh(pull[i]),
            turn_rate=float(rates[i]) * _atanh(turn[i]),
        )
        for i, name in enumerate(fleet.names)
    ]


def _standstill(graph: Graph, data: ConditionData, gains: Gains, friction: float) -> tuple[Array, Array]:
    """The errors of position (m) and heading (rad), (N,) each, within which friction may stop the vehicles.

    Headings are nearly right and along an axis, where (8) pulls least. Across the heading the pull is k psi with psi at
    its largest: at some time it is that strong.
    """
    force, moment = 2 * friction / data.r, 2 * friction * data.arm / data.r
    pulls = (force / gains.p_v, moment / (gains.k_alpha * data.psi_bar), moment / gains.p_omega)
    along, across, turned = (farthest_standstill(graph, pull) for pull in pulls)
    scale = gains.saturation
    return scale.position * np.maximum(along, across), scale.heading * turned


def coulomb(fleet: Fleet) -> float:
    """Coulomb friction at every wheel, N m; 0 unless the fleet file gives it."""
    return float(fleet.disturbance.coulomb) if fleet.disturbance else 0.0


def _atanh(share: float) -> float:
    return math.atanh(share) if share < 1 else math.inf


def for_terminal(rows: list[DemandRow]) -> TerminalTable:
    """The first rows for a terminal; with a friction column if there is friction."""
    headings = ["vehicle", "torque / N m", "motor / N m"]
    rubbing = any(row.friction for row in rows)
    headings += ["friction / N m", "may stop within"] if rubbing else []
    headings += ["speed / m/s", "turn rate / rad/s"]
    table = [
        [
            row.vehicle,
            f"{row.torque:.3g}",
            f"{row.motor:.3g}",
            *([f"{row.friction:.3g}", _stops(row)] if rubbing else []),
            _finite(row.speed, "no bound"),
            _finite(row.turn_rate, "no bound"),
        ]
        for row in rows[:SHOWN]
    ]
    caption = "from rest, torque, speed and turn rate never exceed the bounds that are shown"
    if rubbing:
        caption += "; friction may stop a vehicle so near its place and heading"
    return TerminalTable(headings, table, caption)


def _stops(row: DemandRow) -> str:
    if math.isinf(row.stops_within):
        return "anywhere"
    return f"{row.stops_within:.2g} m, {_finite(row.stops_turned, 'any')} rad"


def _finite(value: float, otherwise: str) -> str:
    return otherwise if math.isinf(value) else f"{value:.3g}"
