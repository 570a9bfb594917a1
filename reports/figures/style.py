"""The style of all figures: colours, labels, names, file formats, and the vehicles drawn of a large fleet."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ...models.files.text import write_whole

LABELLED = 10  # in fleets up to this size every vehicle has a label
DRAWN = 60  # vehicles of a large fleet that are drawn
LONGEST_NAME = 20  # most characters of a vehicle's name

STYLE = {
    "font.size": 9,
    "axes.grid": True,
    "grid.alpha": 0.3,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "svg.hashsalt": "gaincert",
    "figure.constrained_layout.use": True,
}
LABEL = {"boxstyle": "square,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.8}  # behind a label on lines
# Okabe and Ito's colours, told apart by colour-blind readers, and two greys.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#8C6D31", "#7F7F7F", "#5B3A8C")


def shown_vehicles(count: int, most: int = DRAWN) -> list[int]:
    """All vehicles, or `most` of a large fleet, spread evenly."""
    return sorted(set(np.linspace(0, count - 1, min(count, most)).astype(int).tolist()))


def save(figure: Any, path: Path, origin: str = "") -> list[Path]:
    """Write a figure as SVG, PNG and PDF, the same bytes for the same data; `origin` states its fleet and gains."""
    metadata = {
        "svg": {"Date": None, "Description": origin},
        "png": {"Software": None, "Description": origin},
        "pdf": {"CreationDate": None, "Subject": origin},
    }
    return [
        write_whole(
            path.with_suffix(f".{kind}"),
            lambda file, kind=kind: figure.savefig(file, format=kind, dpi=150, metadata=metadata[kind]),  # type: ignore[misc]
        )
        for kind in metadata
    ]


def belongs(path: Path, origin: str) -> bool:
    """Whether a figure (a path without its suffix) was written with this origin."""
    files = [path.with_suffix(f".{kind}") for kind in ("svg", "png")]
    return all(file.is_file() and origin.encode() in file.read_bytes() for file in files)


def plain(name: str) -> str:
    """A name that fits beside a line, and that matplotlib does not read as mathematics."""
    shown = "".join(c if c.isprintable() else "?" for c in name)
    return (shown if len(shown) <= LONGEST_NAME else shown[: LONGEST_NAME - 1] + "…").replace("$", r"\$")
