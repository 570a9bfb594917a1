"""The gain table: gains with their torque bounds and margins, as rows, CSV and for the terminal."""

from __future__ import annotations

import csv
import io
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any, NamedTuple

from ...models.conditions import exact_numbers, torque_bound
from ...models.errors import one_line
from ...models.excitation import Excitation
from ...models.files.text import write_text
from ...models.fleet import Fleet
from ...models.gains import GAIN_NAMES, Gains
from ...models.numbers import decimal_text

DIGITS = 8  # of a torque bound, rounded up


class GainRow(NamedTuple):
    """One vehicle: gains as exact decimal texts, torques (N m) as rounded ones."""

    vehicle: str
    p_v: str
    d_v: str
    p_omega: str
    d_omega: str
    k_alpha: str
    torque_bound: str  # T of (16*), rounded up
    torque_limit: str  # the smaller one of both wheels
    margin: str  # rounded down


COLUMNS = GainRow._fields


def rows(fleet: Fleet, excitation: Excitation, gains: Gains) -> list[GainRow]:
    """One row per vehicle."""
    data = fleet.condition_data(excitation)
    bounds = torque_bound(exact_numbers(), data, gains)
    return [
        GainRow(
            vehicle=name,
            **{key: decimal_text(getattr(gains, key)[i]) for key in GAIN_NAMES},
            torque_bound=decimal(bounds[i], ROUND_CEILING),
            torque_limit=decimal_text(data.torque[i]),
            margin=decimal(data.torque[i] - bounds[i], ROUND_FLOOR),
        )
        for i, name in enumerate(fleet.names)
    ]


def decimal(value: Fraction, rounding: str, digits: int = DIGITS) -> str:
    """A fraction as a plain decimal of `digits` significant digits, rounded in the direction asked for."""
    context = Context(prec=digits, rounding=rounding)
    return f"{context.divide(Decimal(value.numerator), Decimal(value.denominator)):f}"


def write_csv(path: Path, table: list[GainRow]) -> Path:
    """gains.csv."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([COLUMNS, *table])
    return write_text(path, text.getvalue())


def for_terminal(table: list[GainRow], most: int = 20) -> Any:
    """A rich table of the first rows."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table
    from rich.text import Text

    shown = Table(
        box=SIMPLE_HEAD, padding=(0, 1, 0, 0), caption="torques in N m, the bound is (16*); exact gains in gains.csv"
    )
    for key in COLUMNS:
        heading = key.removeprefix("torque_")
        shown.add_column(heading, justify="left" if key == "vehicle" else "right", no_wrap=True)
    for row in table[:most]:
        shown.add_row(Text(one_line(row.vehicle)), *(f"{float(text):.4g}" for text in row[1:]))
    if len(table) > most:
        shown.add_row(f"... and {len(table) - most} more", *[""] * (len(COLUMNS) - 1))
    return shown
