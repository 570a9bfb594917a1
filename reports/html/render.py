"""Templates of reports and exports, and how foreign text enters each language without becoming part of it."""

from __future__ import annotations

import json
from functools import cache
from typing import Any

from ..proof.report import markdown_text, tex_text


def render(name: str, /, **values: Any) -> str:
    """The template `name`.jinja filled in; HTML escapes by itself, the other languages by their filters."""
    return str(_environment().get_template(f"{name}.jinja").render(**values))


def undefined_error() -> type[Exception]:
    """What a template raises where a value is not there."""
    from jinja2 import UndefinedError

    return UndefinedError


@cache
def _environment() -> Any:
    from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape

    environment = Environment(
        loader=PackageLoader("gaincert.reports"),
        autoescape=select_autoescape(("html.jinja",), default_for_string=True),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters.update(c=c_comment, yaml=yaml_text, tex=tex_text, md=markdown_text, script=script_json)
    return environment


_SAFE = frozenset("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789 _.,:+-()")


def c_comment(text: Any) -> str:
    """Text inside a C comment: whatever could end it, open another, form a trigraph or splice a line is spelled out."""
    return "".join(c if c in _SAFE else f"U+{ord(c):04X}" for c in str(text))


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
