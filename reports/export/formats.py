"""The formats of `gaincert export`: one function per format turns a deployment into files; `mcap` logs a run."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable
from pathlib import Path

from ...models.errors import InputError
from ...models.files.text import write_text
from ..deployment import Deployment, fleet_of_folder, load_deployment
from ..escapes import no_formula
from ..rendering import render
from ..tables.gain_table import COLUMNS, rows

RUN_LOG = "mcap"  # the only format that exports a run; the others export gains
INTERFACES = ("effort", "velocity")
SPREADSHEET = "gains_export.csv"  # gains.csv itself keeps names as they are: it is read back


def export(folder: Path, kind: str, fleet_path: Path | None = None, interface: str = "effort") -> list[Path]:
    """Write one format of the results in a folder, each file whole or not at all. Raises InputError.

    `interface` is the command of the ROS 2 node: wheel torques (effort) or twists (velocity).
    """
    if kind not in (*FORMATS, RUN_LOG):
        raise InputError(f"format = {kind!r} is not known; choose one of {', '.join((*FORMATS, RUN_LOG))}")
    if interface not in INTERFACES:
        raise InputError(f"interface = {interface!r} is not known; choose one of {', '.join(INTERFACES)}")
    if interface != "effort" and kind != "ros2":
        raise InputError(f"interface = {interface!r} belongs to the format ros2, not to {kind}; leave it out")
    fleet = fleet_of_folder(folder, fleet_path)
    if kind == RUN_LOG:
        from .run_log import write_run_log

        return write_run_log(folder, fleet)
    deployed = load_deployment(folder, fleet)
    files = ros2_files(deployed, interface) if kind == "ros2" else FORMATS[kind](deployed)
    return [write_text(folder / name, text) for name, text in files.items()]


def csv_files(deployed: Deployment) -> dict[str, str]:
    """The gain table; each row repeats the digests that say where it comes from. Safe to open in a spreadsheet."""
    evidence = deployed.evidence
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow((*COLUMNS, *evidence))
    for row in rows(deployed.fleet, deployed.excitation, deployed.gains):
        writer.writerow((*row._replace(vehicle=no_formula(row.vehicle)), *evidence.values()))
    return {SPREADSHEET: text.getvalue()}


def latex_files(deployed: Deployment) -> dict[str, str]:
    """gains.tex: gains, psi and margins, for a paper."""
    from .latex import latex_files as files

    return files(deployed)


def markdown_files(deployed: Deployment) -> dict[str, str]:
    """gains.md."""
    table = rows(deployed.fleet, deployed.excitation, deployed.gains)
    return {
        "gains.md": render(
            "gains.md", fleet=deployed.fleet, evidence=deployed.evidence, psi=deployed.excitation.table(), table=table
        )
    }


def ros2_files(deployed: Deployment, interface: str = "effort") -> dict[str, str]:
    """Parameters of the ROS 2 node, and the node."""
    from .ros2 import ros2_files as files

    return files(deployed, interface)


def c_files(deployed: Deployment) -> dict[str, str]:
    """The C99 controller with its test."""
    from .c_controller import c_files as files

    return files(deployed)


FORMATS: dict[str, Callable[[Deployment], dict[str, str]]] = {
    "ros2": ros2_files,
    "c": c_files,
    "latex": latex_files,
    "csv": csv_files,
    "markdown": markdown_files,
}
