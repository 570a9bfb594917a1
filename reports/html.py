"""report.html: one file, no network, with all that lies in a folder."""

from __future__ import annotations

import base64
import csv
import json
from pathlib import Path
from typing import Any

from ..models.errors import InputError
from ..models.files import write_text
from ..models.fleet_file import MAX_CSV_BYTES, read_text

SHOWN = 200  # vehicles in the gain table of the report
CAPTIONS = {
    "paths": "Paths on the plane; open dots are starts, filled dots ends, arrows headings (figures 3, 4 of the paper).",
    "poses": "Poses against time; dashed lines are the goal (figures 5 and 6).",
    "torques": "The larger wheel torque of each vehicle over its limit (figure 7).",
    "energies": "The energies V of (17) and W of (19); under the bounded scheme V never rises.",
}


def write_report(folder: Path) -> Path:
    """Write DIR/report.html from the files in DIR. Raises InputError where nothing of ours lies there."""
    found = {name: _json(folder / f"{name}.json") for name in ("design", "certificate", "summary", "proof")}
    if not any(found.values()):
        raise InputError(f"{folder}: holds no design.json, certificate.json, summary.json or proof.json to report on")
    gains = _rows(folder / "gains.csv") if found["design"] else []
    page = _template().render(
        folder=folder.name,
        design=found["design"],
        verdicts=_verdicts(found),
        gains=gains[:SHOWN],
        hidden=max(0, len(gains) - SHOWN),
        shares=[round(100 * float(row["torque_bound"]) / float(row["torque_limit"]), 1) for row in gains[:SHOWN]],
        times=_times(found["design"]),
        figures=_figures(folder / "figures"),
        claims=found["proof"] or [],
        versions=next((content["versions"] for content in (found["design"], found["summary"]) if content), {}),
    )
    return write_text(folder / "report.html", page)


def _template() -> Any:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("gaincert.reports"), autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
    return environment.get_template("report.html.jinja")


def _verdicts(found: dict[str, Any]) -> list[dict[str, Any]]:
    verdicts = []
    if certificate := found["certificate"]:
        conditions = certificate.get("conditions")
        verdicts.append(
            {"good": True, "title": "Certified", "text": f"conditions {conditions}; gaincert verify checks it again"}
        )
    if summary := found["summary"]:
        settled = summary["settling_time_s"]
        peak = summary["peak_torque_ratio"]
        verdicts += [
            {
                "good": settled is not None,
                "title": "Settles" if settled is not None else "Does not settle",
                "text": _settling_text(summary),
            },
            {
                "good": peak <= 1,
                "title": "Torques within their limits" if peak <= 1 else "Torque limit exceeded",
                "text": f"largest torque {100 * peak:.2f} % of its limit in the simulation",
            },
        ]
    return verdicts


def _settling_text(summary: dict[str, Any]) -> str:
    tolerance = summary["tolerance"]
    within = f"{tolerance['position_m']:g} m and {tolerance['heading_rad']:g} rad"
    if summary["settling_time_s"] is None:
        return (
            f"after {summary['horizon_s']:g} s the largest errors are {summary['final_position_error_m']:.3g} m and "
            f"{summary['final_heading_error_rad']:.3g} rad; wanted: {within}"
        )
    return (
        f"within {within} after {summary['settling_time_s']:.1f} s, to the end of the run at {summary['horizon_s']:g} s"
    )


def _times(design: dict[str, Any] | None) -> str:
    times = design["measured_settling_s"] if design else []
    return ", ".join("not settled" if time is None else f"{time:.0f} s" for time in times)


def _figures(folder: Path) -> list[dict[str, str]]:
    paths = {name: folder / f"{name}.svg" for name in CAPTIONS}
    return [
        {"caption": CAPTIONS[name], "data": base64.b64encode(path.read_bytes()).decode()}
        for name, path in paths.items()
        if path.is_file()
    ]


def _json(path: Path) -> Any:
    if not path.is_file():
        return None
    try:
        return json.loads(read_text(path, MAX_CSV_BYTES))
    except ValueError as error:
        raise InputError(f"{path}: is not JSON: {error}; write it again") from None


def _rows(path: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(read_text(path, MAX_CSV_BYTES).splitlines())) if path.is_file() else []
