"""Fleet files: TOML in (with CSV tables and URDF robots beside it), every mistake found at once; TOML out."""

from __future__ import annotations

import csv
import difflib
import json
import re
import tomllib
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from .errors import InputError
from .fleet import Fleet, SpeedLimits, Table
from .numbers import decimal_text

MAX_TOML_BYTES = 32 * 2**20
MAX_CSV_BYTES = 1024 * 2**20
SUGGESTED = 100  # mistakes up to which a likely name is sought among those of the fleet, which takes long


def load(path: str | Path) -> Fleet:
    """The fleet described by a TOML file. Raises InputError with one line for every mistake."""
    path = Path(path)
    return parse(read_toml(path), path.parent)


def read_toml(path: Path) -> dict[str, Any]:
    """A TOML file with exact decimals. Raises InputError where it cannot be read or parsed."""
    text = read_text(path, MAX_TOML_BYTES)
    try:
        return tomllib.loads(text, parse_float=Decimal)
    except RecursionError:
        raise InputError(f"{path}: is nested too deeply") from None
    except ValueError as error:  # TOMLDecodeError, and integers of thousands of digits
        raise InputError(f"{path}: is not TOML: {error}") from None
    except ArithmeticError:
        raise InputError(f"{path}: holds a number whose exponent is beyond all reading; correct it") from None


def read_text(path: Path, max_bytes: int) -> str:
    """The text of a UTF-8 file of bounded size. Raises InputError."""
    try:
        with path.open("rb") as file:
            data = file.read(max_bytes + 1)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    except ValueError:
        raise InputError(f"{path}: cannot be read: the name of a file holds no NUL character") from None
    if len(data) > max_bytes:
        raise InputError(f"{path}: is larger than {max_bytes // 2**20} MiB; put large fleets into CSV tables")
    try:
        return data.decode("utf-8-sig")  # spreadsheets write a byte order mark
    except UnicodeDecodeError:
        raise InputError(f"{path}: is not UTF-8 text") from None


def parse(content: dict[str, Any], folder: Path = Path()) -> Fleet:
    """The fleet that the content of a TOML file describes; CSV and URDF paths are taken from `folder`."""
    content = _with_tables(content, folder)
    mistakes: list[str] = []
    content = _with_robots(content, folder, mistakes)
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
        raise InputError(*mistakes)
    return fleet


# -- CSV tables and URDF robots ---------------------------------------------------------------------------------------

_VEHICLE_COLUMNS = {
    **{key: key for key in ("name", "mass", "inertia", "half_track", "wheel_radius", "torque_limit")},
    **dict.fromkeys(("offset_x", "offset_y"), "offset"),
    **dict.fromkeys(("x", "y", "heading_deg", "v", "omega"), "start"),
}


def _with_tables(content: dict[str, Any], folder: Path) -> dict[str, Any]:
    """The content with the CSV tables that it names read in their place."""
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
                raise InputError(*(f"{leaders}: vehicle {name!r} stands twice; keep one row" for name in twice))
            graph["leader_links"] = {row["vehicle"]: row["weight"] for row in rows}
    return content


def _vehicle_row(row: dict[str, str]) -> dict[str, Any]:
    vehicle: dict[str, Any] = {key: row[key] for key, field in _VEHICLE_COLUMNS.items() if key == field}
    vehicle["offset"] = [row["offset_x"], row["offset_y"]]
    vehicle["start"] = {"position": [row["x"], row["y"]], **{key: row[key] for key in ("heading_deg", "v", "omega")}}
    return vehicle


_LINE = re.compile(r"[^\r\n]++(?:\r\n?|\n)?|\r\n?|\n")


def csv_rows(path: Path) -> tuple[list[str], list[dict[str, str]]]:
    """The first line of a CSV table and its rows, whatever they hold. Raises InputError."""
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


def _with_robots(content: dict[str, Any], folder: Path, mistakes: list[str]) -> dict[str, Any]:
    """The content with `urdf = FILE` of a vehicle replaced by the numbers which that file yields."""
    vehicles = content.get("vehicle")
    if not isinstance(vehicles, list) or not any(isinstance(v, dict) and "urdf" in v for v in vehicles):
        return content
    from .urdf import read_urdf

    known: dict[Any, dict[str, Any]] = {}
    replaced = []
    for vehicle in vehicles:
        if isinstance(vehicle, dict) and "urdf" in vehicle:
            source = vehicle["urdf"] if isinstance(vehicle["urdf"], str) else None
            if source not in known:
                try:
                    if source is None:
                        raise InputError(f"urdf = {shown(vehicle['urdf'])} must be a text in quotes")
                    known[source] = read_urdf(folder / source)
                except InputError as error:
                    mistakes += error.mistakes
                    known[source] = dict.fromkeys(("mass", "inertia", "half_track", "wheel_radius"), 1)
            # What the fleet file says itself wins over the robot's description.
            vehicle = {**known[source], **{key: value for key, value in vehicle.items() if key != "urdf"}}
        replaced.append(vehicle)
    return {**content, "vehicle": replaced}


# -- what is wrong with a fleet ---------------------------------------------------------------------------------------


def graph_mistakes(names: Sequence[str], edges: Iterable[Any], leader_links: Mapping[str, Any]) -> list[str]:
    """One line for every mistake in names and links: (A1) of the theorem and a well-formed graph. O(N + E)."""
    if not names:
        return ["the fleet has no vehicles; add a [[vehicle]] table"]
    mistakes: list[str] = []

    def meant(word: str) -> str:
        return _suggest(word, names) if len(mistakes) < SUGGESTED else ""

    neighbours: dict[str, list[str]] = {}
    for name in names:
        if name in neighbours:
            mistakes.append(f"vehicle {name!r}: the name stands twice; names must differ")
        neighbours[name] = []
    seen = set()
    for a, b, *_ in edges:
        pair = (min(a, b), max(a, b))
        for end in pair:
            if end not in neighbours:
                mistakes.append(f"graph: edge {a!r} - {b!r}: there is no vehicle {end!r}{meant(end)}")
        if a == b:
            mistakes.append(f"graph: edge {a!r} - {b!r} joins a vehicle to itself; remove it")
        elif pair in seen:
            mistakes.append(f"graph: edge {a!r} - {b!r} stands twice; keep one, with the sum of the weights")
        seen.add(pair)
        if a in neighbours and b in neighbours:
            neighbours[a].append(b)
            neighbours[b].append(a)
    led = []
    for name, weight in leader_links.items():
        if name not in neighbours:
            mistakes.append(f"graph: leader link of {name!r}: there is no such vehicle{meant(name)}")
        elif weight != 0:
            led.append(name)
    return mistakes or _unled(neighbours, led)


def _unled(neighbours: dict[str, list[str]], led: list[str]) -> list[str]:
    """(A1): every connected component of the followers has a leader link."""
    reached, frontier = set(led), list(led)
    while frontier:
        new = [b for b in neighbours[frontier.pop()] if b not in reached]
        reached.update(new)
        frontier += new
    lost = [name for name in neighbours if name not in reached]
    if not lost:
        return []
    shown = ", ".join(repr(name) for name in lost[:5]) + (f" and {len(lost) - 5} more" if len(lost) > 5 else "")
    return [f"graph: no path joins {shown} to the leader, so L_l is singular (Lemma 1); add an edge or a leader link"]


def _raw_graph_mistakes(content: dict[str, Any]) -> list[str]:
    """The mistakes in the links of content whose tables did not validate, as far as it can be read."""
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


def explain(item: Any, content: dict[str, Any]) -> list[str]:
    """The lines of one pydantic error: the thing, its value and what is wanted."""
    kind, value = item["type"], item["input"]
    if kind == "graph":
        return str(item["msg"]).split("\n")
    place, key = _place(list(item["loc"]), content)
    if kind == "missing":
        return [f"{place}{key} is missing"]
    if kind == "extra_forbidden":
        return [
            f"{place}unknown key {key!r}{_suggest(item['loc'][-1], _known_keys(item['loc']))}; correct or remove it"
        ]
    if kind in ("number", "edge") or isinstance(value, (str, int, Decimal)):
        return [f"{place}{key} = {shown(value)} {_requirement(item)}"]
    return [f"{place}{key} {_requirement(item)}"]


def _requirement(item: Any) -> str:
    kind, words = item["type"], str(item["msg"])
    if kind in ("number", "edge", "heading", "constant"):
        return words
    return _WANTED.get(kind, f"is not valid: {words[0].lower()}{words[1:]}")


_WANTED = {  # pydantic's words, where they speak of Python
    "dict_type": "must be a table",
    "model_type": "must be a table",
    "string_type": "must be a text in quotes",
    "tuple_type": "must be a list: [..., ...], or tables under [[...]]",
    "union_tag_not_found": "must say its family: 'square-wave' or 'harmonics'",
    "union_tag_invalid": "must have the family 'square-wave' or 'harmonics'",
}


def _place(loc: list[Any], content: dict[str, Any]) -> tuple[str, str]:
    """Where an error lies, in a reader's words, and the key."""
    parts = [part for i, part in enumerate(loc) if i > 1 or part not in ("square-wave", "harmonics")]
    if parts[:1] == ["vehicle"] and len(parts) > 1:
        vehicle = content["vehicle"][parts[1]]
        name = vehicle.get("name") if isinstance(vehicle, dict) else None
        label = f"vehicle {name!r}: " if isinstance(name, str) else f"vehicle number {parts[1] + 1}: "
        parts = parts[2:]
    elif len(parts) > 1:
        label, parts = f"{parts[0]}: ", parts[1:]
    else:
        label = ""
    return label, ".".join(str(part) for part in parts) or "the table"


def _known_keys(loc: Sequence[Any]) -> list[str]:
    """The keys that the table around an unknown key may have."""
    model: Any = Fleet
    for part in loc[:-1]:
        for name, field in getattr(model, "model_fields", {}).items():
            if part in (name, field.alias):
                model = _table_in(field.annotation)
                break
    return [field.alias or name for name, field in getattr(model, "model_fields", {}).items()]


def _table_in(annotation: Any) -> Any:
    """The Table class inside an annotation like tuple[Vehicle, ...] or Start | None."""
    if hasattr(annotation, "model_fields"):
        return annotation
    found = [_table_in(argument) for argument in getattr(annotation, "__args__", ())]
    return next((table for table in found if table is not None), None)


def _suggest(word: Any, known: Iterable[str]) -> str:
    close = difflib.get_close_matches(str(word), list(known)[:2000], 1)
    return f" (did you mean {close[0]!r}?)" if close else ""


def shown(value: Any) -> str:
    """A value of a file in a message, cut where it is long."""
    try:
        text = repr(value) if isinstance(value, str) else str(value)
    except (ValueError, RecursionError):  # an integer of thousands of digits, tables nested too deeply
        return "(too long to show)"
    return text if len(text) <= 60 else f"{text[:57]}..."


# -- out --------------------------------------------------------------------------------------------------------------


def dumps(fleet: Fleet) -> str:
    """The TOML text of a fleet; reading it back gives an equal fleet."""
    content = _entries(fleet)
    vehicles = content.pop("vehicle")
    tables = {key: content.pop(key) for key in ("leader", "excitation", "disturbance", "graph") if key in content}
    lines = _lines(content)
    for key, table in tables.items():
        lines += ["", f"[{key}]", *_lines(_entries(table))]
    for vehicle in vehicles:
        entries = _entries(vehicle)
        if vehicle.torque_limit.left == vehicle.torque_limit.right:
            entries["torque_limit"] = vehicle.torque_limit.left
        lines += ["", "[[vehicle]]", *_lines(entries)]
    return "\n".join(lines) + "\n"


def _entries(table: Table) -> dict[str, Any]:
    """The keys of a table that say something, as they are called in a file."""
    named = {field.alias or name: getattr(table, name) for name, field in type(table).model_fields.items()}
    return {key: value for key, value in named.items() if value not in (None, (), SpeedLimits())}


def _lines(entries: dict[str, Any]) -> list[str]:
    return [f"{_toml(key) if not _BARE.fullmatch(key) else key} = {_toml(value)}" for key, value in entries.items()]


def _toml(value: Any) -> str:
    """A TOML value on one line."""
    if isinstance(value, Fraction):
        return decimal_text(value)
    if isinstance(value, Table):
        value = _entries(value)
    if isinstance(value, dict):
        return "{ " + ", ".join(_lines(value)) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_toml, value)) + "]"
    return json.dumps(value, ensure_ascii=False).replace(
        "\x7f", "\\u007f"
    )  # TOML's basic strings are JSON's, but for DEL


_BARE = re.compile(r"[A-Za-z0-9_-]+")
