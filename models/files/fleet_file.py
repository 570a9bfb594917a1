"""Fleet files: TOML in (with CSV tables and URDF robots beside it), every mistake found at once; TOML out."""

from __future__ import annotations

import csv
import re
import tomllib
from collections import Counter
from decimal import Decimal
from pathlib import Path
from typing import Any, NamedTuple

from pydantic import ValidationError

from ..errors import InputError
from ..fleet import Fleet
from ..graph_checks import graph_mistakes
from .mistakes import explain, said_once
from .robots.fleet_robots import Robot, with_robots
from .text import read_text

MAX_TOML_BYTES = 32 * 2**20
MAX_CSV_BYTES = 1024 * 2**20


class FleetFile(NamedTuple):
    """A fleet and the robot descriptions that its file names."""

    fleet: Fleet
    robots: tuple[Robot | None, ...]  # of each vehicle; empty if the file names none


def load_fleet(path: str | Path) -> Fleet:
    """The fleet described by a TOML file. Raises InputError with one line for every mistake."""
    return load_fleet_file(path).fleet


def load_fleet_file(path: str | Path) -> FleetFile:
    """The fleet described by a TOML file, and its robot descriptions. Raises InputError."""
    path = Path(path)
    return parse_file(read_toml(path), path.parent)


def read_toml(path: Path) -> dict[str, Any]:
    """A TOML file with exact decimals. Raises InputError if it cannot be read or parsed."""
    text = read_text(path, MAX_TOML_BYTES)
    try:
        return tomllib.loads(text, parse_float=Decimal)
    except RecursionError:
        raise InputError(f"{path}: is nested too deeply") from None
    except ValueError as error:  # TOMLDecodeError, and integers of thousands of digits
        raise InputError(f"{path}: is not TOML: {error}") from None
    except ArithmeticError:
        raise InputError(f"{path}: holds a number whose exponent is beyond all reading; correct it") from None


def build_fleet(**tables: Any) -> Fleet:
    """A fleet without a file: the keys and tables of a fleet file as dicts, lists and numbers. Raises InputError.

    build_fleet(name="pair", leader={"position": (0, 0), "heading": 0}, graph={...}, vehicle=[{...}, {...}])
    """
    return parse({key: list(value) if isinstance(value, tuple) else value for key, value in tables.items()})


def parse(content: dict[str, Any], folder: Path = Path()) -> Fleet:
    """The fleet that the content of a TOML file describes; CSV and URDF paths are taken from `folder`."""
    return parse_file(content, folder).fleet


def parse_file(content: dict[str, Any], folder: Path = Path()) -> FleetFile:
    """The same, with the robot descriptions."""
    content = _with_tables(content, folder)
    mistakes: list[str] = []
    content, robots = with_robots(content, folder, mistakes)
    for name, field in Fleet.model_fields.items():
        if field.alias and name in content:  # Python code may say links and vehicles, a file says graph and [[vehicle]]
            mistakes.append(f"unknown key {name!r} (did you mean {field.alias!r}?); correct or remove it")
            content = {field.alias: content[name], **{key: value for key, value in content.items() if key != name}}
    try:
        fleet = Fleet.model_validate(content)
    except ValidationError as error:
        mistakes += [line for item in error.errors() for line in explain(item, content)]
        mistakes += [line for line in _raw_graph_mistakes(content) if line not in mistakes]
    if mistakes:
        vehicles = content.get("vehicle")
        raise InputError(*said_once(mistakes, len(vehicles) if isinstance(vehicles, (list, tuple)) else 0))
    return FleetFile(fleet, robots)


_VEHICLE_COLUMNS = {
    **{key: key for key in ("name", "mass", "inertia", "half_track", "wheel_radius", "torque_limit")},
    **dict.fromkeys(("offset_x", "offset_y"), "offset"),
    **dict.fromkeys(("x", "y", "heading_deg", "v", "omega"), "start"),
}


def _with_tables(content: dict[str, Any], folder: Path) -> dict[str, Any]:
    """The content with every CSV table that it names read in."""
    content = dict(content)
    if isinstance(content.get("vehicles"), str):
        if "vehicle" in content:
            raise InputError("vehicles = CSV file and [[vehicle]] tables exclude each other; keep one")
        rows = read_csv(folder / content.pop("vehicles"), list(_VEHICLE_COLUMNS))
        content["vehicle"] = [_vehicle_row(row) for row in rows]
    graph = content.get("graph")
    if isinstance(graph, dict):
        graph = content["graph"] = dict(graph)
        if isinstance(graph.get("edges"), str):
            rows = read_csv(folder / graph["edges"], ["from", "to", "weight"])
            graph["edges"] = [[row["from"], row["to"], row["weight"]] for row in rows]
        if isinstance(graph.get("leader_links"), str):
            leaders = folder / graph["leader_links"]
            rows = read_csv(leaders, ["vehicle", "weight"])
            if twice := [
                name for name, rows_of_it in Counter(row["vehicle"] for row in rows).items() if rows_of_it > 1
            ]:
                raise InputError(*(f"{leaders}: vehicle {name!r} is listed twice; keep one row" for name in twice))
            graph["leader_links"] = {row["vehicle"]: row["weight"] for row in rows}
    return content


def _vehicle_row(row: dict[str, str]) -> dict[str, Any]:
    vehicle: dict[str, Any] = {key: row[key] for key, field in _VEHICLE_COLUMNS.items() if key == field}
    vehicle["offset"] = [row["offset_x"], row["offset_y"]]
    vehicle["start"] = {"position": [row["x"], row["y"]], **{key: row[key] for key in ("heading_deg", "v", "omega")}}
    return vehicle


_LINE = re.compile(r"[^\r\n]++(?:\r\n?|\n)?|\r\n?|\n")


def csv_rows(path: Path) -> tuple[list[str], list[dict[str, str]]]:
    """The first line of a CSV table and its rows, unchecked. Raises InputError."""
    # Not splitlines: a quoted name may hold a line break, or what Unicode calls one.
    reader = csv.DictReader(found[0] for found in _LINE.finditer(read_text(path, MAX_CSV_BYTES)))
    try:
        return list(reader.fieldnames or []), list(reader)
    except csv.Error as error:
        raise InputError(f"{path}: line {reader.reader.line_num}: {error}") from None


def read_csv(path: Path, columns: list[str]) -> list[dict[str, str]]:
    """The rows of a CSV table with exactly these columns. Raises InputError."""
    heading, rows = csv_rows(path)
    if heading != columns:
        raise InputError(f"{path}: the first line must be {','.join(columns)}")
    for number, row in enumerate(rows, 2):
        if None in row or None in row.values():
            raise InputError(f"{path}: row {number} must have {len(columns)} columns: {','.join(columns)}")
    return rows


def _raw_graph_mistakes(content: dict[str, Any]) -> list[str]:
    """The mistakes in the links of invalid content, as far as it can be read."""
    vehicles, graph = content.get("vehicle"), content.get("graph")
    if not isinstance(vehicles, list) or not isinstance(graph, dict):
        return []
    names = [v["name"] for v in vehicles if isinstance(v, dict) and isinstance(v.get("name"), str)]
    edges, links = graph.get("edges", []), graph.get("leader_links")
    well_formed = (
        len(names) == len(vehicles)
        and isinstance(edges, list)
        and all(isinstance(e, list) and len(e) in (2, 3) and all(isinstance(end, str) for end in e[:2]) for e in edges)
        and isinstance(links, dict)
    )
    return graph_mistakes(names, edges, links or {}) if well_formed else []
