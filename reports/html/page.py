"""report.html: one file, without network, with all results of a folder."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from ...models.errors import InputError
from ...models.files.fleet_file import MAX_CSV_BYTES, FleetFile
from ...models.files.text import read_text, write_text
from ...models.fleet import Fleet
from ...models.vehicle_notes import centre_of_mass_note
from ...verify.simulation.trajectory import Trajectory, read_trajectory
from ..deployment import FLEET_COPY, Deployment, fleet_of_folder
from ..figures.style import belongs
from ..rendering import render, undefined_error
from ..results import RESULTS, ClaimResult, DesignResult, Results, current_digests, read_results, stale_files
from ..tables.conditions_table import ConditionRow, condition_rows
from ..tables.designs_table import HEADINGS, DesignRow, design_rows
from ..tables.gain_table import COLUMNS, SCALES, GainRow, rows
from ..tables.robot_table import RobotSummary, robot_summaries
from .animation import animation_data
from .embed import figure_data, safe_mathml, script_hash
from .verdicts import (
    CERTIFIED,
    Verdict,
    certificate_verdict,
    many_starts_verdict,
    proof_verdict,
    run_verdicts,
    stale_verdict,
)

SHOWN = 200  # vehicles in the gain table of the report
STATUSES = ("REFUTED", "CORRECTED", "OPEN", "PROVED", "FORMAL", "CITED")
CAPTIONS = {
    "figures/paths": "Paths; open dots are starts, filled dots ends, arrows headings (figures 3, 4 of the paper).",
    "figures/poses": "Poses against time; dashed lines are the goal (figures 5 and 6).",
    "figures/cross_track": "Envelopes of the cross-track errors: near the goal they fall as t^(-1/2), the dashed line.",
    "figures/wheel_torques": "The torques of both wheels; dashed lines are their limits (figure 7).",
    "figures/torques": "The larger wheel torque of each vehicle over its limit.",
    "figures/energies": "The energies V of (17) and W of (19); under the bounded scheme V never rises.",
    "figures/settling": "Settling times over many starts.",
    "figures/margins": "Values of a disturbance with which all starts settle; the line is that of the fleet file.",
    "figures/physics": "In MuJoCo, with the exported C controller: one start beside the model, and all settling times.",
    "figures/designs": "Settling times of the designs, a dot for every start.",
    "figures/witness_energy": "Witness: W rises under the paper's gains, which meet (15).",
    "figures/witness_bang_bang": "Witness: under a bounded push the turn rate grows without bound, though (15) holds.",
    "proof_graph": "What rests on what in the proof.",
}
OF_ANY = (
    "figures/designs",
    "figures/witness_energy",
    "figures/witness_bang_bang",
    "proof_graph",
)  # figures that do not belong to one set of gains


@dataclass(frozen=True)
class Page:
    """The values that the template shows."""

    title: str
    verdicts: list[Verdict]
    design: DesignResult | None
    rates: dict[str, Any]  # of the certificate
    gains: list[tuple[GainRow, float]]  # with the used share of the torque limit, per cent
    hidden: int  # vehicles that the gain table leaves out
    conditions: list[ConditionRow]
    designs: list[DesignRow]
    design_headings: dict[str, str]
    robots: list[RobotSummary]
    robot_note: str | None  # about centres of mass
    times: str  # measured by the design
    animation: dict[str, Any] | None
    missing_fleet: bool  # there is a run, but no fleet to draw it
    script: Any
    script_hash: str
    figures: list[dict[str, str]]
    groups: list[dict[str, Any]]  # claims by status
    evidence: dict[str, str]
    versions: dict[str, str]


def write_report(folder: Path, fleet_path: Path | None = None) -> Path:
    """Write DIR/report.html from the files in DIR that belong together. Raises InputError if there are none.

    The fleet is read from the given file, else from the folder's copy; without either there is no animation.
    """
    results = read_results(folder)
    if results.empty:
        raise InputError(
            f"{folder}: holds no {', '.join(RESULTS)} to report on; run gaincert design, simulate or prove"
        )
    fleet = fleet_of_folder(folder, fleet_path) if fleet_path or (folder / FLEET_COPY).is_file() else None
    try:
        page = render("report.html", **vars(_page(results, fleet)))
    except (*_MALFORMED, undefined_error()) as error:
        raise InputError(
            f"{folder}: a file in it was not written by this version ({type(error).__name__}: {error}); write it again"
        ) from None
    return write_text(folder / "report.html", page)


_MALFORMED = (LookupError, TypeError, ValueError, AttributeError, ArithmeticError, RecursionError, csv.Error)


def _page(results: Results, fleet: Fleet | None) -> Page:
    folder = results.folder
    certified, deployed = certificate_verdict(folder, fleet)
    current = deployed.digests if deployed else current_digests(folder)
    stale = stale_files(folder, current) if current else []
    results = results.without(stale)
    run = _trajectory_of(folder, fleet)  # a damaged file is an error, even if it is stale
    run = None if "trajectory.npz" in stale else run
    draw_figures(results, fleet, run, str(current or ""))
    gains, script = _gain_rows(folder, deployed), _script()
    origins = (results.design, results.run, results.many_starts)
    return Page(
        title=_title(results, fleet),
        verdicts=[
            *certified,
            *stale_verdict(stale),
            *run_verdicts(results.run),
            *many_starts_verdict(results.many_starts),
            *proof_verdict(results.claims),
        ],
        design=results.design,
        rates=_rates(results.certificate, certified),
        gains=[(row, _share(row)) for row in gains[:SHOWN]],
        hidden=max(0, len(gains) - SHOWN),
        conditions=condition_rows(deployed) if deployed else [],
        designs=design_rows(folder),
        design_headings=HEADINGS,
        robots=robot_summaries(FleetFile(fleet, ()))[:SHOWN] if fleet else [],
        robot_note=centre_of_mass_note(fleet) if fleet else None,
        times=_times(results.design),
        animation=animation_data(fleet, run) if fleet and run else None,
        missing_fleet=fleet is None and (folder / "trajectory.npz").is_file(),
        script=script,
        script_hash=script_hash(script),
        figures=_figures(folder, str(current or "")),
        groups=_groups(results.claims),
        evidence=deployed.evidence if deployed else {},
        versions=next((part.versions for part in origins if part and part.versions), {}),
    )


def _title(results: Results, fleet: Fleet | None) -> str:
    if fleet:
        return fleet.name
    return results.design.fleet if results.design else results.folder.resolve().name


def _rates(certificate: dict[str, Any] | None, verdicts: list[Verdict]) -> dict[str, Any]:
    """The certified rates, only from a certificate that the kernel has just accepted."""
    if certificate and any(verdict.good and verdict.title == CERTIFIED for verdict in verdicts):
        return dict(certificate["rates"])
    return {"gamma_omega": None, "gamma_v": None}


def _trajectory_of(folder: Path, fleet: Fleet | None) -> Trajectory | None:
    """The trajectory of the folder, if it has as many vehicles as the fleet."""
    path = folder / "trajectory.npz"
    run = read_trajectory(path) if path.is_file() else None
    matches = run is not None and fleet is not None and run.state.x.shape[1] == len(fleet)
    return run if matches else None


def draw_figures(results: Results, fleet: Fleet | None, run: Trajectory | None, origin: str) -> None:
    """Draw the figures that need files of several verbs, and those of a run without figures."""
    from ..figures.margins import write_margins
    from ..figures.run_figures import write_figures
    from ..figures.settling_times import write_designs, write_settling

    figures = results.folder / "figures"
    if results.many_starts:
        write_settling(results.many_starts.settling_time_s.each, figures, origin)
        if results.many_starts.margins:
            write_margins(results.many_starts.margins, figures, origin)
    if designs := design_rows(results.folder):
        write_designs(designs, figures)
    if fleet and run and not belongs(figures / "paths", origin):
        write_figures(fleet, {"simulation": run}, figures, origin)


def _gain_rows(folder: Path, deployed: Deployment | None) -> list[GainRow]:
    """The gain table: computed if the fleet is known, else from gains.csv."""
    if deployed:
        return rows(deployed.fleet, deployed.excitation, deployed.gains)
    path = folder / "gains.csv"
    if not path.is_file():
        return []
    # Not splitlines: a name may hold a Unicode line separator.
    table = csv.DictReader(io.StringIO(read_text(path, MAX_CSV_BYTES), newline=""))
    unit = dict.fromkeys(SCALES, "1")  # for a table without scales
    return [GainRow(*({**unit, **row}[key] for key in COLUMNS)) for row in table]


def _share(row: GainRow) -> float:
    """The torque bound in per cent of the limit."""
    return round(100 * float(row.torque_bound) / float(row.torque_limit), 1)


def _times(design: DesignResult | None) -> str:
    times = design.measured_settling_s if design else []
    return ", ".join("not settled" if time is None else f"{time:.0f} s" for time in times)


def _figures(folder: Path, origin: str) -> list[dict[str, str]]:
    """The figures that belong to the other results."""
    shown = {name: caption for name, caption in CAPTIONS.items() if name in OF_ANY or belongs(folder / name, origin)}
    data = figure_data([folder / name for name in shown])
    return [
        {"name": name.rpartition("/")[2], "caption": caption, "data": content}
        for (name, caption), content in zip(shown.items(), data, strict=True)
        if content
    ]


def _groups(claims: list[ClaimResult]) -> list[dict[str, Any]]:
    """The claims by status, false ones first, with their formulas as cleaned MathML."""
    groups = []
    for status in STATUSES:
        members = [claim for claim in claims if claim.status == status]
        if members:
            groups.append({"status": status, "claims": [(claim, _typeset(claim)) for claim in members]})
    return groups


def _typeset(claim: ClaimResult) -> dict[str, Any]:
    return {name: safe_mathml(text) for name, text in claim.mathml.items()}


@cache
def _script() -> Any:
    from markupsafe import Markup

    return Markup((files("gaincert.reports") / "templates" / "animation.js").read_text())  # noqa: S704 -- our own file
