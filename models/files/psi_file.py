"""The file beside a gains.csv with what a table of gains has no column for: psi, and weights if they were designed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from ..digests import Digests
from ..errors import InputError
from ..excitation import Excitation
from ..fleet_tables import ExcitationTable, Links
from .fleet_file import read_toml
from .fleet_text import table_lines
from .text import write_text

TABLES = ("excitation", "weights")


def psi_path(table: Path) -> Path:
    """The file that belongs to a gains.csv: gains.psi.toml."""
    return table.with_suffix(".psi.toml")


def write_psi(table: Path, excitation: Excitation, links: Links | None, digests: Digests) -> Path:
    """Write psi and the designed weights of the gains in `table`."""
    adapter: TypeAdapter[Any] = TypeAdapter(ExcitationTable)
    lines = [
        f"# psi of the gains in {table.name}; gaincert reads it with them",
        f"# {digests}",
        "[excitation]",
        *table_lines(adapter.validate_python(excitation.table())),
        *([] if links is None else ["", "[weights]", *table_lines(links)]),
    ]
    return write_text(psi_path(table), "\n".join(lines) + "\n")


def read_psi(table: Path) -> dict[str, Any]:
    """The tables of the file beside a gains.csv; none if there is no such file. Raises InputError."""
    path = psi_path(table)
    if not path.is_file():
        return {}
    content = read_toml(path)
    if unknown := set(content) - set(TABLES):
        raise InputError(f"{path}: unknown key {min(unknown)!r}; it has the tables {', '.join(TABLES)}")
    return content
