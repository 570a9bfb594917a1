"""Pydantic's errors about a fleet file in plain words: the thing, its value, and what is required."""

from __future__ import annotations

import re
from collections.abc import Sequence
from decimal import Decimal
from typing import Any

from ..errors import did_you_mean, shown, some_vehicles
from ..fleet import Fleet


def explain(item: Any, content: dict[str, Any]) -> list[str]:
    """The lines of one pydantic error: the thing, its value and what is required."""
    kind, value = item["type"], item["input"]
    if kind == "graph":
        return str(item["msg"]).split("\n")
    place, key = _place(list(item["loc"]), content)
    if kind == "missing":
        return [f"{place}{key} is missing"]
    if kind == "extra_forbidden":
        return [
            f"{place}unknown key {key!r}{did_you_mean(item['loc'][-1], _known_keys(item['loc']))}; correct or remove it"
        ]
    if kind in ("number", "edge") or isinstance(value, (str, int, float, Decimal)):
        return [f"{place}{key} = {shown(value)} {_requirement(item)}"]
    return [f"{place}{key} {_requirement(item)}"]


def _requirement(item: Any) -> str:
    kind, words = item["type"], str(item["msg"])
    if kind in ("number", "edge", "heading", "constant"):
        return words
    return _WANTED.get(kind, f"is not valid: {words[0].lower()}{words[1:]}")


_WANTED = {  # replaces pydantic's messages about Python types
    "dict_type": "must be a table",
    "model_type": "must be a table",
    "string_type": "must be a text in quotes",
    "tuple_type": "must be a list: [..., ...], or tables under [[...]]",
    "union_tag_not_found": "must say its family: 'square-wave' or 'harmonics'",
    "union_tag_invalid": "must have the family 'square-wave' or 'harmonics'",
}


def _place(loc: list[Any], content: dict[str, Any]) -> tuple[str, str]:
    """The place of an error, in plain words, and the key."""
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


_OF_VEHICLE = re.compile(r"vehicle ('(?:[^'\\]|\\.)*'|\"(?:[^\"\\]|\\.)*\"): (.*)", re.DOTALL)


def said_once(mistakes: Sequence[str], vehicles: int) -> list[str]:
    """The same lines, but a mistake that several vehicles share is one line, in the place of the first."""
    sharing: dict[str, list[str]] = {}
    for line in mistakes:
        found = _OF_VEHICLE.fullmatch(line)
        sharing.setdefault(found[2] if found else line, []).append(found[1] if found else "")
    return [_said(text, names, vehicles) for text, names in sharing.items()]


def _said(text: str, names: list[str], vehicles: int) -> str:
    if names[0] == "":
        return text
    if len(names) == 1:
        return f"vehicle {names[0]}: {text}"
    if len(names) == vehicles:
        return f"every vehicle: {text}"
    return f"{some_vehicles(names)}: {text}"
