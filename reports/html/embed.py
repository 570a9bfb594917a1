"""Content embedded in one HTML file: figures as data, cleaned MathML, and the hash that allows a script."""

from __future__ import annotations

import base64
import hashlib
import re
from html import unescape
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, ParseError, tostring

SVG_BYTES = 400_000  # a larger figure is inlined as PNG
FIGURE_BYTES = 2_000_000  # of all figures together
MATHML = frozenset(  # elements of presentation MathML that carry formulas
    ("math", "mrow", "mi", "mn", "mo", "mtext", "mspace", "mfrac", "msqrt", "mroot")
) | frozenset(("msub", "msup", "msubsup", "munder", "mover", "munderover"))
_NAMED = re.compile(r"&(?!(?:amp|lt|gt|quot|apos);)[A-Za-z]+;")  # characters named in HTML but not in XML


def figure_data(paths: list[Path]) -> list[str | None]:
    """A data URI for each figure (a path without its suffix), None if there is no file or no room left."""
    room = FIGURE_BYTES
    found: list[str | None] = []
    for path in paths:
        content = _smallest(path, room)
        room -= len(content[1]) if content else 0
        found.append(content and f"data:{content[0]};base64,{base64.b64encode(content[1]).decode()}")
    return found


def _smallest(path: Path, room: int) -> tuple[str, bytes] | None:
    for suffix, kind, most in ((".svg", "image/svg+xml", SVG_BYTES), (".png", "image/png", room)):
        file = path.with_suffix(suffix)
        if file.is_file() and file.stat().st_size <= min(most, room):
            return kind, file.read_bytes()
    return None


def safe_mathml(text: Any) -> Any:
    """MathML from a file, rebuilt from element names and text only; other text is returned as text."""
    from defusedxml.common import DefusedXmlException
    from defusedxml.ElementTree import fromstring
    from markupsafe import Markup, escape

    try:
        root = fromstring(_NAMED.sub(lambda found: unescape(found[0]), str(text)))
        rebuilt = _rebuilt(root)
    except (ParseError, DefusedXmlException, ValueError, RecursionError):
        return escape(str(text))
    rebuilt.set("displaystyle", "true")
    return Markup(tostring(rebuilt, encoding="unicode"))  # noqa: S704 -- MathML elements without attributes


def _rebuilt(element: Any) -> Element:
    if element.tag not in MATHML:
        raise ValueError(f"{element.tag} is no element of presentation MathML")
    copy = Element(element.tag)
    copy.text, copy.tail = element.text, element.tail
    copy.extend([_rebuilt(child) for child in element])
    return copy


def script_hash(script: str) -> str:
    """The source expression with which a content security policy lets exactly this script run."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()}'"
