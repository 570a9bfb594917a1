"""Gains from files: a design.json, a gains.csv or a gains.toml."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import Any, NamedTuple

from pydantic import TypeAdapter, ValidationError

from ..errors import InputError, did_you_mean
from ..excitation import Excitation
from ..fleet import Fleet
from ..fleet_tables import ExcitationTable, Links
from ..gain_checks import checked_gains
from ..gains import GAIN_NAMES, Gains
from ..saturation import SCALE_NAMES
from .fleet_file import MAX_CSV_BYTES, csv_rows, read_toml
from .mistakes import explain
from .psi_file import psi_path, read_psi
from .text import read_text


@dataclass(frozen=True)
class GainsFile:
    """The content of a gains file."""

    gains: Gains  # exact, (N,), with their scales
    excitation: Excitation  # the file's own, else the fleet's
    conditions: str | None  # the condition set that the gains were designed for
    links: Links | None = None  # the weights that the gains were designed with; None: the fleet's own


class _Content(NamedTuple):
    """The values in a file, not yet checked."""

    gains: Mapping[str, Any]  # by name
    saturation: Mapping[str, Any]  # by name; a scale that is left out is 1
    excitation: Any = None
    conditions: str | None = None
    digest: str | None = None
    weights: Any = None


def load_gains(path: str | Path, fleet: Fleet) -> GainsFile:
    """The gains in a design.json, gains.csv or gains.toml, for a fleet. Raises InputError.

    design.json and gains.toml: five keys p_v, d_v, p_omega, d_omega, k_alpha, each a list in file order or (TOML) one
    number for all, and optionally [excitation] and [saturation] as in a fleet file. gains.csv: columns vehicle, the
    five gains and optionally position_scale, heading_scale, speed_scale, turn_rate_scale; psi and designed weights are
    read from gains.psi.toml beside it, if that is there. Scales left out are 1.
    """
    path = Path(path)
    readers = {".json": _from_json, ".csv": _from_csv, ".toml": _from_toml}
    if path.suffix.lower() not in readers:
        raise InputError(f"{path}: gains are read from .json, .csv and .toml files; give it the suffix of its format")
    content = readers[path.suffix.lower()](path, fleet)
    if content.digest is not None and content.digest != fleet.digest:
        raise InputError(
            f"{path}: was designed for another fleet ({content.digest}, this is {fleet.digest}); design it again"
        )
    source = psi_path(path) if path.suffix.lower() == ".csv" else path
    excitation = _excitation(source, content.excitation) if content.excitation is not None else fleet.psi
    if excitation is None:
        raise InputError(f"{path}: neither it nor the fleet file has an [excitation] table; add one to either")
    gains = _gains(path, content, fleet)
    links = _links(source, content.weights, fleet) if content.weights is not None else None
    return GainsFile(gains, excitation, content.conditions, links)


def _from_json(path: Path, fleet: Fleet) -> _Content:
    try:
        content = json.loads(read_text(path, MAX_CSV_BYTES), parse_float=Decimal)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: is not JSON: {error}") from None
    except ArithmeticError:
        raise InputError(f"{path}: holds a number whose exponent is too large; correct it") from None
    if not isinstance(content, dict) or not isinstance(content.get("gains"), dict):
        raise InputError(f"{path}: is not a design.json: it has no object 'gains'")
    return _Content(
        content["gains"],
        _scales(path, content.get("saturation"), fleet),
        content.get("excitation"),
        _text(content.get("conditions")),
        _text(content.get("fleet_digest")),
        content.get("weights"),
    )


def _from_toml(path: Path, fleet: Fleet) -> _Content:
    content = read_toml(path)
    excitation, saturation = content.pop("excitation", None), content.pop("saturation", None)
    if unknown := set(content) - set(GAIN_NAMES):
        known = ", ".join((*GAIN_NAMES, "saturation", "excitation"))
        raise InputError(f"{path}: unknown key {min(unknown)!r}; a gains file has {known}")
    values = {key: value if isinstance(value, list) else [value] * len(fleet) for key, value in content.items()}
    return _Content(values, _scales(path, saturation, fleet), excitation)


def _from_csv(path: Path, fleet: Fleet) -> _Content:
    heading, entries = csv_rows(path)
    wanted = ["vehicle", *GAIN_NAMES]
    if missing := [key for key in wanted if key not in heading]:
        raise InputError(f"{path}: has no column {missing[0]!r}; a gains.csv has the columns {','.join(wanted)}")
    rows: dict[str, Mapping[str, str]] = {}
    for row in entries:
        if row["vehicle"] in rows:
            raise InputError(f"{path}: vehicle {row['vehicle']!r} is listed twice; keep one row")
        rows[row["vehicle"]] = row
    if extra := set(rows) - set(fleet.names):
        unknown = min(extra, key=str)
        raise InputError(f"{path}: vehicle {unknown!r} is not in the fleet{did_you_mean(unknown, fleet.names)}")
    if lost := [name for name in fleet.names if name not in rows]:
        raise InputError(f"{path}: has no row for vehicle {lost[0]!r}")

    def values(key: str) -> list[str]:
        return [rows[name][key] for name in fleet.names]

    scales = {name: values(f"{name}_scale") for name in SCALE_NAMES if f"{name}_scale" in heading}
    beside = read_psi(path)
    gains = {name: values(name) for name in GAIN_NAMES}
    return _Content(gains, scales, beside.get("excitation"), weights=beside.get("weights"))


def _scales(path: Path, table: Any, fleet: Fleet) -> dict[str, list[Any]]:
    """Every scale of a [saturation] table or object, one entry per vehicle."""
    if table is None:
        return {}
    if not isinstance(table, dict):
        raise InputError(f"{path}: saturation must be a table with {', '.join(SCALE_NAMES)}")
    if unknown := set(table) - set(SCALE_NAMES):
        raise InputError(f"{path}: saturation: unknown key {min(unknown)!r}; it has {', '.join(SCALE_NAMES)}")
    return {key: value if isinstance(value, list) else [value] * len(fleet) for key, value in table.items()}


def _gains(path: Path, content: _Content, fleet: Fleet) -> Gains:
    """Exact positive gains and scales, one per vehicle; every mistake at once."""
    mistakes = []
    if fleet.saturation is not None and not content.saturation and not fleet.saturation.scales.unit:
        mistakes.append(
            f"{path}: has no scales, which means 1, but the fleet file's [saturation] asks for others; add them"
        )
    return checked_gains(str(path), fleet.names, content.gains, content.saturation, mistakes)


def _excitation(path: Path, table: Any) -> Excitation:
    adapter: TypeAdapter[Any] = TypeAdapter(ExcitationTable)
    try:
        psi: Excitation = adapter.validate_python(table).psi
    except ValidationError as error:
        lines = [line for item in error.errors() for line in explain(item, {})]
        raise InputError(*(f"{path}: excitation: {line}" for line in lines)) from None
    return psi


def _links(path: Path, weights: Any, fleet: Fleet) -> Links:
    """The designed weights. Their links must be the fleet's own."""
    try:
        links = Links.model_validate(weights)
        fleet.with_links(links)
    except ValidationError as error:
        raise InputError(f"{path}: weights: {error.errors()[0]['msg']}; design them again") from None
    own = {frozenset(edge[:2]) for edge in fleet.links.edges}
    if {frozenset(edge[:2]) for edge in links.edges} != own:
        raise InputError(f"{path}: weights: their edges are not those of the fleet; design them again")
    return links


def _text(value: Any) -> str | None:
    return value if isinstance(value, str) else None
