"""Escapes for names and texts from files: C, YAML, JavaScript, LaTeX, Markdown, tables."""

from __future__ import annotations

import json
import re
from typing import Any

_C_SAFE = frozenset("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789 _.,:+-()")
_TEX = {
    "\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "_": r"\_", "^": r"\textasciicircum{}", "&": r"\&", "%": r"\%",
    "$": r"\$", "#": r"\#", "~": r"\textasciitilde{}", "<": r"\textless{}", ">": r"\textgreater{}", "|": r"\textbar{}",
    '"': "''", "\n": " ", "\r": " ", "-": "{-}",
}  # fmt: skip


def c_comment(text: Any) -> str:
    """Text inside a C comment: characters that end it, open another, form a trigraph or join lines are escaped."""
    return "".join(c if c in _C_SAFE else f"U+{ord(c):04X}" for c in str(text))


def yaml_text(text: Any) -> str:
    """A double-quoted YAML scalar in ASCII."""
    return '"' + "".join(map(_yaml_character, str(text))) + '"'


def _yaml_character(c: str) -> str:
    if c in '"\\':
        return "\\" + c
    if " " <= c <= "~":
        return c
    return f"\\x{ord(c):02x}" if ord(c) < 0x100 else f"\\u{ord(c):04x}" if ord(c) < 0x10000 else f"\\U{ord(c):08x}"


def script_json(content: Any) -> Any:
    """JSON for a script element of HTML: no character in it can end the element or open a comment."""
    from markupsafe import Markup

    text = json.dumps(content, separators=(",", ":"), allow_nan=False)
    for character in "<>&":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return Markup(text)  # noqa: S704 -- no <, > or & is left in it


def tex_text(text: Any) -> str:
    """Plain text for LaTeX: special characters escaped, characters without a glyph in pdflatex as code points."""
    return "".join(_TEX.get(c, c if " " <= c <= "~" else f"[U+{ord(c):04X}]") for c in str(text))


def markdown_text(text: Any) -> str:
    """Plain text for Markdown: markup and HTML escaped, one line."""
    line = " ".join(str(text).split()).replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    return re.sub(r"([\\`*_{}\[\]#|~$])", r"\\\1", line)


def no_formula(text: str) -> str:
    """Text that no spreadsheet takes for a formula: such a start gets an apostrophe before it."""
    return "'" + text if text.startswith(("=", "+", "-", "@", "\t", "\r", "\n")) else text
