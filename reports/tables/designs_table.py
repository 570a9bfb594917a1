"""Designs side by side: the one of a folder and those of the folders in it."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from ...models.errors import InputError, one_line
from ...models.files.fleet_file import MAX_CSV_BYTES
from ...models.files.text import read_text

HEADINGS = {  # of the columns, in order
    "name": "gains",
    "conditions": "conditions",
    "psi": "psi",
    "weights": "weights",
    "settled": "settled",
    "median": "median",
    "worst": "slowest",
    "ratio": "of the limit",
    "peak": "peak torque",
    "speed": "top speed",
}


def design_rows(folder: Path) -> list[dict[str, Any]]:
    """One row per folder that holds a design.json or a validation.json, if there are several.

    The entries under the keys of HEADINGS are texts, `times` (s, inf where not settled) are those of every start.
    """
    places = [folder, *sorted(path for path in folder.glob("*") if path.is_dir())]
    found = [place for place in places if any((place / f"{name}.json").is_file() for name in ("design", "validation"))]
    if len(found) < 2:
        return []
    return [_row(place, "this design" if place == folder else place.name) for place in found]


def _row(place: Path, name: str) -> dict[str, Any]:
    design, validation, summary = (
        read_json(place / f"{part}.json") or {} for part in ("design", "validation", "summary")
    )
    try:
        measured = validation["settling_time_s"]["each"] if validation else design["measured_settling_s"]
        times = [math.inf if time is None else float(time) for time in measured]
        return {
            "name": name,
            "conditions": str(design.get("conditions", "-")),
            "psi": ("designed" if design["excitation_designed"] else "given") if design else "given",
            "weights": "designed" if design.get("weights") else "given",
            "times": times,
            "settled": f"{sum(map(math.isfinite, times))} of {len(times)}",
            "median": _time(sorted(times)[len(times) // 2]) if times else "not measured",
            "worst": _time(max(times)) if times else "not measured",
            "ratio": _number((validation.get("ratio_to_physical_limit") or {}).get("median"), "{:.3g} x"),
            "peak": _number((validation or summary).get("peak_torque_ratio"), "{:.1%}"),
            "speed": _number((validation or summary).get("peak_speed"), "{:.3g} m/s"),
        }
    except (KeyError, TypeError, ValueError, AttributeError):
        raise InputError(f"{place}: a file in it is not of this version; write it again") from None


def _time(time: float) -> str:
    return f"{time:.0f} s" if math.isfinite(time) else "not settled"


def _number(value: Any, form: str) -> str:
    return "-" if value is None else form.format(float(value))


def for_terminal(rows: list[dict[str, Any]]) -> Any:
    """A rich table of the rows; names say what the designs are under."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table
    from rich.text import Text

    shown = Table(box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    columns = {key: heading for key, heading in HEADINGS.items() if key not in ("conditions", "psi", "weights")}
    for heading in columns.values():
        shown.add_column(heading, justify="right" if len(shown.columns) else "left", no_wrap=True)
    for row in rows:
        shown.add_row(*(Text(one_line(row[key])) for key in columns))
    return shown


def read_json(path: Path) -> Any:
    """The content of a JSON file, None where there is no such file. Raises InputError where it is not JSON."""
    if not path.is_file():
        return None
    try:
        return json.loads(read_text(path, MAX_CSV_BYTES))
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: is not JSON: {error}; write it again") from None
