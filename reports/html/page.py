"""report.html: one file, no network, with all that lies in a folder."""

from __future__ import annotations

import csv
import io
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from ...models.errors import InputError
from ...models.files.fleet_file import MAX_CSV_BYTES
from ...models.files.text import read_text, write_text
from ...models.fleet import Fleet
from ...verify.simulation.trajectory import Trajectory, read_trajectory
from ..deployment import FLEET_COPY, Deployment, fleet_of_folder
from ..rendering import render, undefined_error
from ..tables.conditions_table import condition_rows
from ..tables.designs_table import HEADINGS, design_rows, read_json
from ..tables.gain_table import COLUMNS, GainRow, rows
from .animation import animation_data
from .embed import figure_data, safe_mathml, script_hash
from .verdicts import (
    CERTIFIED,
    Verdict,
    certificate_verdict,
    origin_verdict,
    proof_verdict,
    simulation_verdicts,
    validation_verdicts,
)

SHOWN = 200  # vehicles in the gain table of the report
PARTS = ("design", "certificate", "summary", "validation", "proof")
STATUSES = ("REFUTED", "CORRECTED", "OPEN", "PROVED", "CITED")
CAPTIONS = {
    "figures/paths": "Paths; open dots are starts, filled dots ends, arrows headings (figures 3, 4 of the paper).",
    "figures/poses": "Poses against time; dashed lines are the goal (figures 5 and 6).",
    "figures/cross_track": "Envelopes of the cross-track errors: near the goal they fall as t^(-1/2), the dashed line.",
    "figures/torques": "The larger wheel torque of each vehicle over its limit (figure 7).",
    "figures/energies": "The energies V of (17) and W of (19); under the bounded scheme V never rises.",
    "figures/settling": "Settling times over many starts.",
    "figures/designs": "Settling times of the designs, a dot for every start.",
    "figures/witness_energy": "Witness: W rises under the paper's gains, which meet (15).",
    "figures/witness_bang_bang": "Witness: under a bounded push the turn rate grows without bound, though (15) holds.",
    "proof_graph": "What rests on what in the proof.",
}


def write_report(folder: Path, fleet_path: Path | None = None) -> Path:
    """Write DIR/report.html from the files in DIR. Raises InputError where nothing of ours lies there.

    The fleet is read from the file that is given, else from the folder's copy; without either there is no animation.
    """
    found = {name: read_json(folder / f"{name}.json") for name in PARTS}
    if not any(found.values()):
        raise InputError(f"{folder}: holds no {', '.join(f'{name}.json' for name in PARTS)} to report on")
    fleet = fleet_of_folder(folder, fleet_path) if fleet_path or (folder / FLEET_COPY).is_file() else None
    try:
        page = render("report.html", **_contents(folder, found, fleet))
    except (*_MALFORMED, undefined_error()) as error:
        raise InputError(
            f"{folder}: a file in it is not of this version ({type(error).__name__}: {error}); write it again"
        ) from None
    return write_text(folder / "report.html", page)


_MALFORMED = (LookupError, TypeError, ValueError, AttributeError, ArithmeticError, RecursionError, csv.Error)


def _contents(folder: Path, found: dict[str, Any], fleet: Fleet | None) -> dict[str, Any]:
    """All that the template shows."""
    claims = found["proof"] or []
    certified, deployed = certificate_verdict(folder, fleet)
    run = _trajectory_of(folder, fleet)
    draw_figures(folder, found["validation"], fleet, run)
    gains = _gain_rows(folder, deployed)
    script = _script()
    return {
        "title": _title(folder, found, fleet),
        "design": found["design"],
        "rates": _rates(found["certificate"], certified),
        "verdicts": [
            *origin_verdict(found, fleet),
            *certified,
            *simulation_verdicts(found["summary"]),
            *validation_verdicts(found["validation"]),
            *proof_verdict(claims),
        ],
        "gains": [(row, _share(row)) for row in gains[:SHOWN]],
        "hidden": max(0, len(gains) - SHOWN),
        "conditions": condition_rows(deployed) if deployed else [],
        "designs": design_rows(folder),
        "design_headings": HEADINGS,
        "times": _times(found["design"]),
        "animation": animation_data(fleet, run) if fleet and run else None,
        "missing_fleet": fleet is None and (folder / "trajectory.npz").is_file(),
        "script": script,
        "script_hash": script_hash(script),
        "figures": _figures(folder),
        "groups": _groups(claims),
        "evidence": deployed.evidence if deployed else {},
        "summary": found["summary"] or {},
        "versions": next((c["versions"] for c in (found["design"], found["summary"]) if c and "versions" in c), {}),
    }


def _title(folder: Path, found: dict[str, Any], fleet: Fleet | None) -> str:
    return str(fleet.name if fleet else (found["design"] or {}).get("fleet", folder.resolve().name))


def _rates(certificate: Any, verdicts: list[Verdict]) -> dict[str, Any]:
    """The certified rates, of a certificate that the kernel has just accepted and of no other."""
    if any(verdict.good and verdict.title == CERTIFIED for verdict in verdicts):
        return dict(certificate["rates"])
    return {"gamma_omega": None, "gamma_v": None}


def _trajectory_of(folder: Path, fleet: Fleet | None) -> Trajectory | None:
    """The trajectory of the folder, where it is of as many vehicles as the fleet."""
    path = folder / "trajectory.npz"
    run = read_trajectory(path) if path.is_file() else None
    matches = run is not None and fleet is not None and run.state.x.shape[1] == len(fleet)
    return run if matches else None


def draw_figures(folder: Path, validation: Any, fleet: Fleet | None, run: Trajectory | None) -> None:
    """The figures that need more than one verb's files, and those of a run that is there without them."""
    from ..figures.run_figures import write_figures
    from ..figures.settling_times import write_designs, write_settling

    figures = folder / "figures"
    if validation:
        write_settling(validation, figures)
    if designs := design_rows(folder):
        write_designs(designs, figures)
    if fleet and run and not (figures / "paths.svg").is_file():
        write_figures(fleet, {"simulation": run}, figures)


def _gain_rows(folder: Path, deployed: Deployment | None) -> list[GainRow]:
    """The gain table, computed where the fleet is known, else as gains.csv has it."""
    if deployed:
        return rows(deployed.fleet, deployed.excitation, deployed.gains)
    path = folder / "gains.csv"
    if not path.is_file():
        return []
    # Not splitlines: a name may hold what Unicode calls a line separator.
    table = csv.DictReader(io.StringIO(read_text(path, MAX_CSV_BYTES), newline=""))
    return [GainRow(*(row[key] for key in COLUMNS)) for row in table]


def _share(row: GainRow) -> float:
    """The torque bound in per cent of the limit."""
    return round(100 * float(row.torque_bound) / float(row.torque_limit), 1)


def _times(design: dict[str, Any] | None) -> str:
    times = design["measured_settling_s"] if design else []
    return ", ".join("not settled" if time is None else f"{time:.0f} s" for time in times)


def _figures(folder: Path) -> list[dict[str, str]]:
    data = figure_data([folder / name for name in CAPTIONS])
    return [
        {"name": name.rpartition("/")[2], "caption": caption, "data": content}
        for (name, caption), content in zip(CAPTIONS.items(), data, strict=True)
        if content
    ]


def _groups(claims: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The claims by status, what is false first, with their formulas as markup that can be nothing else."""
    groups = []
    for status in STATUSES:
        members = [claim for claim in claims if claim["status"] == status]
        if members:
            groups.append({"status": status, "claims": [{**claim, "typeset": _typeset(claim)} for claim in members]})
    return groups


def _typeset(claim: dict[str, Any]) -> dict[str, Any]:
    return {name: safe_mathml(text) for name, text in claim.get("mathml", {}).items()}


@cache
def _script() -> Any:
    from markupsafe import Markup

    return Markup((files("gaincert.reports") / "templates" / "animation.js").read_text())  # noqa: S704 -- our own file
