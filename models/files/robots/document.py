"""The XML of a robot description: read safely, with xacro expanded; other formats are refused by name."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ...errors import InputError
from ..text import read_text
from .xacro import expand

MAX_URDF_BYTES = 16 * 2**20
_XACRO = ("{http://www.ros.org/wiki/xacro}", "{http://ros.org/wiki/xacro}", "{http://wiki.ros.org/xacro}")


def read_document(path: Path, max_bytes: int = MAX_URDF_BYTES) -> Any:
    """The <robot> element of a URDF or xacro file. Raises InputError if it is neither, or unreadable."""
    root = _parse(path, read_text(path, max_bytes))
    if root.tag == "sdf":
        raise InputError(
            f"{path}: this is SDF; gaincert reads URDF and xacro: give the robot's URDF, or leave urdf out and give "
            "mass, inertia, half_track and wheel_radius in the fleet file"
        )
    if root.tag != "robot":
        raise InputError(f"{path}: the outermost element is <{root.tag}>; a robot description (URDF) has <robot>")
    if _is_xacro(root):
        root = _parse(path, expand(path, max_bytes))
    return root


def _is_xacro(root: Any) -> bool:
    """Whether xacro elements are left to expand. A declared namespace alone, as in expanded files, does not count."""
    return any(
        str(element.tag).startswith(_XACRO) or any("${" in value for value in element.attrib.values())
        for element in _elements(root)
    )


def _elements(root: Any) -> Iterator[Any]:
    return (element for element in root.iter() if isinstance(element.tag, str))


def _parse(path: Path, text: str) -> Any:
    from xml.etree.ElementTree import ParseError

    from defusedxml import DefusedXmlException
    from defusedxml.ElementTree import fromstring

    try:
        return fromstring(text)
    except (ParseError, DefusedXmlException, RecursionError) as error:
        raise InputError(f"{path}: is not safe XML: {error or type(error).__name__}") from None
