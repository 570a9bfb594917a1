"""The condition sets side by side for one fleet and its gains, and designs side by side."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from ..models.errors import InputError
from ..models.fleet_file import MAX_CSV_BYTES, read_text
from ..models.limits import Inequality, exact_numbers
from ..synthesis.conditions import CONDITION_SETS
from .deployment import Deployment

MOST = 2000  # vehicles up to which all sets are evaluated exactly


def condition_rows(deployed: Deployment) -> list[dict[str, Any]]:
    """One row per condition set: whether these gains meet it, and its tightest condition and vehicle."""
    if len(deployed.fleet) > MOST:
        return []
    limits = deployed.fleet.limits(deployed.excitation)
    rows = []
    for conditions in CONDITION_SETS.values():
        sides = conditions.inequalities(exact_numbers(), limits, deployed.gains)
        used, source, vehicle = max(_tightest(side) for side in sides)
        rows.append(
            {
                "name": conditions.name,
                "theorem": conditions.theorem,
                "conditions": ", ".join(side.source for side in sides),
                "holds": all(bool(holds) for side in sides for holds in side.holds),
                "asked": conditions.name == deployed.conditions,
                "used": used,
                "where": f"{source}, vehicle {deployed.fleet.names[vehicle]}",
            }
        )
    return rows


def _tightest(side: Inequality) -> tuple[float, str, int]:
    """The largest small / large over the vehicles, with its source and vehicle."""
    pairs = zip(side.small, side.large, strict=True)
    shares = [float(small / large) if large != math.inf else 0.0 for small, large in pairs]
    vehicle = max(range(len(shares)), key=shares.__getitem__)
    return shares[vehicle], side.source, vehicle


def design_rows(folder: Path) -> list[dict[str, Any]]:
    """One row per design in the folder and the folders in it, if there are several."""
    paths = [path for path in (folder / "design.json", *sorted(folder.glob("*/design.json"))) if path.is_file()]
    if len(paths) < 2:
        return []
    return [_design_row(path, folder) for path in paths]


def _design_row(path: Path, folder: Path) -> dict[str, Any]:
    design, summary = read_json(path), read_json(path.with_name("summary.json")) or {}
    try:
        times = [math.inf if time is None else float(time) for time in design["measured_settling_s"]]
        peak = summary.get("peak_torque_ratio")
        return {
            "name": "this design" if path.parent == folder else path.parent.name,
            "conditions": str(design["conditions"]),
            "psi": "designed" if design["excitation_designed"] else "as given",
            "times": times,
            "median": _text(sorted(times)[len(times) // 2]) if times else "not measured",
            "worst": _text(max(times)) if times else "not measured",
            "peak": None if peak is None else float(peak),
        }
    except (KeyError, TypeError, ValueError):
        raise InputError(f"{path}: is no design.json of this version; design again") from None


def _text(time: float) -> str:
    return f"{time:.0f} s" if math.isfinite(time) else "not settled"


def read_json(path: Path) -> Any:
    """The content of a JSON file, None where there is no such file. Raises InputError where it is not JSON."""
    if not path.is_file():
        return None
    try:
        return json.loads(read_text(path, MAX_CSV_BYTES))
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: is not JSON: {error}; write it again") from None
