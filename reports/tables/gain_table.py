"""The gain table: gains with their torque bounds and margins, as rows, CSV and for the terminal."""

from __future__ import annotations

import csv
import io
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction
from pathlib import Path
from typing import NamedTuple

from ...models.conditions import exact_numbers, torque_bound
from ...models.excitation import Excitation
from ...models.files.text import write_text
from ...models.fleet import Fleet
from ...models.gains import GAIN_NAMES, Gains
from ...models.numbers import decimal_text
from .terminal import TerminalTable

DIGITS = 8  # significant digits of a torque bound, rounded up
SHOWN = 20  # vehicles in the table on a terminal
HEADINGS = {"torque_bound": "bound", "torque_limit": "limit", "speed_scale": "s", "turn_rate_scale": "o"}


class GainRow(NamedTuple):
    """One vehicle: gains as exact decimal texts, torques (N m) as rounded texts."""

    vehicle: str
    p_v: str
    d_v: str
    p_omega: str
    d_omega: str
    k_alpha: str
    position_scale: str  # m, the same for all, as is the next
    heading_scale: str  # rad
    speed_scale: str  # m/s
    turn_rate_scale: str  # rad/s
    torque_bound: str  # T of (16*), rounded up
    torque_limit: str  # the smaller limit of both wheels
    margin: str  # rounded down


COLUMNS = GainRow._fields
SCALES = COLUMNS[6:10]
NETWORK_SCALES = SCALES[:2]  # the same for all vehicles
CONTROLLER = COLUMNS[1:-3]  # the numbers of the control law: gains and scales


def rows(fleet: Fleet, excitation: Excitation, gains: Gains) -> list[GainRow]:
    """One row per vehicle."""
    data = fleet.condition_data(excitation)
    bounds = torque_bound(exact_numbers(), data, gains)
    scales = gains.saturation.columns(len(fleet))
    return [
        GainRow(
            vehicle=name,
            **{key: decimal_text(getattr(gains, key)[i]) for key in GAIN_NAMES},
            **{f"{key}_scale": decimal_text(Fraction(column[i])) for key, column in scales.items()},
            torque_bound=decimal(bounds[i], ROUND_CEILING),
            torque_limit=decimal_text(data.torque[i]),
            margin=decimal(data.torque[i] - bounds[i], ROUND_FLOOR),
        )
        for i, name in enumerate(fleet.names)
    ]


def decimal(value: Fraction, rounding: str, digits: int = DIGITS) -> str:
    """A fraction as a plain decimal of `digits` significant digits, rounded in the given direction."""
    context = Context(prec=digits, rounding=rounding)
    return f"{context.divide(Decimal(value.numerator), Decimal(value.denominator)):f}"


def write_csv(path: Path, table: list[GainRow]) -> Path:
    """gains.csv."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([COLUMNS, *table])
    return write_text(path, text.getvalue())


def for_terminal(table: list[GainRow]) -> TerminalTable:
    """The first rows for a terminal; with scales if they are not all 1."""
    unit = all(getattr(row, key) == "1" for row in table for key in SCALES)
    network = "" if unit else f"; scales: position {table[0].position_scale} m, heading {table[0].heading_scale} rad"
    keys = [key for key in COLUMNS if key not in (SCALES if unit else NETWORK_SCALES)]
    rows = [[row.vehicle, *(f"{float(getattr(row, key)):.4g}" for key in keys[1:])] for row in table[:SHOWN]]
    if len(table) > SHOWN:
        rows.append([f"... and {len(table) - SHOWN} more", *[""] * (len(keys) - 1)])
    headings = [HEADINGS.get(key, key) for key in keys]
    caption = f"torques in N m, the bound is (16*); exact gains in gains.csv{network}"
    return TerminalTable(headings, rows, caption)
