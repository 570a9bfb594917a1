"""The TOML text of a fleet."""

from __future__ import annotations

import json
import re
from fractions import Fraction
from typing import Any

from ..fleet import Fleet
from ..fleet_tables import Table
from ..numbers import decimal_text

TABLES = ("leader", "excitation", "saturation", "disturbance", "graph")


def dumps(fleet: Fleet) -> str:
    """The TOML text of a fleet; reading it back gives an equal fleet."""
    content = _entries(fleet)
    vehicles = content.pop("vehicle")
    tables = {key: content.pop(key) for key in TABLES if key in content}
    lines = _lines(content)
    for key, table in tables.items():
        lines += ["", f"[{key}]", *table_lines(table)]
    for vehicle in vehicles:
        entries = _entries(vehicle)
        if vehicle.torque_limit.left == vehicle.torque_limit.right:
            entries["torque_limit"] = vehicle.torque_limit.left
        lines += ["", "[[vehicle]]", *_lines(entries)]
    return "\n".join(lines) + "\n"


def table_lines(table: Table) -> list[str]:
    """The lines of a TOML table, without its heading."""
    return _lines(_entries(table))


def _entries(table: Table) -> dict[str, Any]:
    """The keys of a table that differ from their defaults, with their names in a file."""
    return {
        field.alias or name: getattr(table, name)
        for name, field in type(table).model_fields.items()
        if getattr(table, name) != field.default
    }


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
