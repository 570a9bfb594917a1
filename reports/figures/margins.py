"""The figure of the margins: how large each disturbance may become, beside its value in the fleet file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from ...verify.validation.margins import NAMES
from ..results import MarginResult
from .style import COLOURS, STYLE, save


def write_margins(margins: Mapping[str, MarginResult], folder: Path, origin: str = "") -> list[Path]:
    """margins.svg and .png: a bar over the values with which all starts settle, a line at the fleet's own value."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.4, 0.4 + 0.9 * len(margins)))
        axes = figure.subplots(len(margins), squeeze=False)[:, 0]
        for axis, (kind, margin) in zip(axes, margins.items(), strict=True):
            low, high = margin.tried
            if margin.largest is not None:
                axis.barh(0, margin.largest - low, left=low, color=COLOURS[2], height=0.6)
            if low <= margin.present <= high:
                axis.axvline(margin.present, color="k", lw=1.2)
            axis.set(xscale="log", xlim=(low, high), ylim=(-0.5, 0.5), yticks=[])
            axis.set_title(f"{NAMES.get(kind, kind)} / {margin.unit}", loc="left", fontsize=9)
        return save(figure, folder / "margins", origin)
