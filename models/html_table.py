"""Tables for notebooks: what `_repr_html_` of a fleet, a design and a certificate returns."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import Any

SHOWN = 20  # rows


def html_table(caption: str, headings: Sequence[str], rows: Sequence[Sequence[Any]]) -> str:
    """The first rows as an HTML table; all texts are escaped."""
    lines = [f"<table><caption>{escape(caption)}</caption>", _row("th", headings)]
    lines += [_row("td", row) for row in rows[:SHOWN]]
    if len(rows) > SHOWN:
        lines.append(_row("td", [f"... and {len(rows) - SHOWN} more"]))
    return "\n".join([*lines, "</table>"])


def _row(kind: str, values: Sequence[Any]) -> str:
    return "<tr>" + "".join(f"<{kind}>{escape(_text(value))}</{kind}>" for value in values) + "</tr>"


def _text(value: Any) -> str:
    return value if isinstance(value, str) else f"{float(value):.4g}"
