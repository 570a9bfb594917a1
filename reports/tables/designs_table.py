"""Designs side by side: the design of a folder and those of its subfolders."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any, NamedTuple

from ...models.errors import InputError
from ...models.files.fleet_file import MAX_CSV_BYTES
from ...models.files.text import read_text
from .terminal import TerminalTable

HEADINGS = {  # of the columns, in order; the keys are fields of DesignRow
    "name": "gains",
    "conditions": "conditions",
    "psi": "psi",
    "weights": "weights",
    "settled": "settled",
    "median": "median",
    "worst": "slowest",
    "ratio": "median / physical limit",
    "peak": "peak torque",
    "speed": "top speed",
}
IN_NAMES = ("conditions", "psi", "weights")  # columns that the names of compared folders repeat


class DesignRow(NamedTuple):
    """One design; texts for a table, and the settling time of every start."""

    name: str
    conditions: str
    psi: str
    weights: str
    settled: str
    median: str
    worst: str
    ratio: str
    peak: str
    speed: str
    times: tuple[float, ...]  # s, inf if not settled


def design_rows(folder: Path) -> list[DesignRow]:
    """One row per folder with a design.json or a validation.json of one fleet, if there are several such folders."""
    places = [folder, *sorted(path for path in folder.glob("*") if path.is_dir())]
    found = [place for place in places if any((place / f"{name}.json").is_file() for name in ("design", "validation"))]
    fleet = _fleet_of(found[0]) if found else None
    found = [place for place in found if _fleet_of(place) == fleet]
    if len(found) < 2:
        return []
    return [_row(place, "this design" if place == folder else place.name) for place in found]


def as_json(rows: list[DesignRow]) -> list[dict[str, Any]]:
    """The rows without the times of every start."""
    return [{key: value for key, value in row._asdict().items() if key != "times"} for row in rows]


def _fleet_of(place: Path) -> Any:
    """The digest of the fleet that a folder's design, or else its validation, is of."""
    contents = (read_json(place / f"{part}.json") or {} for part in ("design", "validation"))
    return next((digest for content in contents if (digest := content.get("fleet_digest"))), None)


def _row(place: Path, name: str) -> DesignRow:
    design, validation, summary = (
        read_json(place / f"{part}.json") or {} for part in ("design", "validation", "summary")
    )
    try:
        measured = validation["settling_time_s"]["each"] if validation else design["measured_settling_s"]
        times = [math.inf if time is None else float(time) for time in measured]
        return DesignRow(
            name=name,
            conditions=str(design.get("conditions", "-")),
            psi=("designed" if design["excitation_designed"] else "given") if design else "given",
            weights="designed" if design.get("weights") else "given",
            settled=f"{sum(map(math.isfinite, times))} of {len(times)}",
            median=_time(sorted(times)[len(times) // 2]) if times else "not measured",
            worst=_time(max(times)) if times else "not measured",
            ratio=_number((validation.get("ratio_to_physical_limit") or {}).get("median"), "{:.3g} x"),
            peak=_number((validation or summary).get("peak_torque_ratio"), "{:.1%}"),
            speed=_number((validation or summary).get("peak_speed"), "{:.3g} m/s"),
            times=tuple(times),
        )
    except (KeyError, TypeError, ValueError, AttributeError):
        raise InputError(f"{place}: a file in it was not written by this version; write it again") from None


def _time(time: float) -> str:
    return f"{time:.0f} s" if math.isfinite(time) else "not settled"


def _number(value: Any, form: str) -> str:
    return "-" if value is None else form.format(float(value))


def for_terminal(rows: list[DesignRow]) -> TerminalTable:
    """The rows for a terminal."""
    columns = {key: heading for key, heading in HEADINGS.items() if key not in IN_NAMES}
    return TerminalTable(list(columns.values()), [[getattr(row, key) for key in columns] for row in rows])


def read_json(path: Path) -> Any:
    """The content of a JSON file, None if there is no such file. Raises InputError if it is not JSON."""
    if not path.is_file():
        return None
    try:
        return json.loads(read_text(path, MAX_CSV_BYTES))
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: is not JSON: {error}; write it again") from None
