"""Figures over many starts: the settling histogram of a validation, and designs side by side."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ...verify.validation.spread import Spread
from ..tables.designs_table import DesignRow
from .style import COLOURS, LABEL, STYLE, plain, save

BINS = 30


def write_settling(times: Sequence[float | None], folder: Path, origin: str = "") -> list[Path]:
    """settling.svg and .png: a histogram of the settling times; None counts as not settled."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    each = np.array([math.inf if time is None else time for time in times], dtype=float)
    spread = Spread.of(times)
    settled = each[np.isfinite(each)]
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.4, 3.6))
        axis = figure.subplots()
        if settled.size:
            axis.hist(settled, bins=min(BINS, max(5, settled.size // 4)), color=COLOURS[0], edgecolor="white", lw=0.4)
        for time, name, high in ((spread.median, "median", 0.97), (spread.p90, "90 %", 0.87)):
            if time is not None:
                axis.axvline(time, color="k", lw=1, ls="--")
                label = f"{name} {time:.0f} s"
                place = {"xycoords": ("data", "axes fraction"), "textcoords": "offset points", "xytext": (4, 0)}
                axis.annotate(label, (time, high), va="top", bbox=LABEL, **place)
        axis.set(xlabel="settling time / s", ylabel="starts", title=_title(len(settled), len(each)))
        axis.set_xlim(left=0)
        axis.yaxis.get_major_locator().set_params(integer=True)
        return save(figure, folder / "settling", origin)


def _title(settled: int, starts: int) -> str:
    lost = starts - settled
    return f"{starts} starts" + (f", {lost} of them not settled" if lost else ", all settle")


def write_designs(designs: list[DesignRow], folder: Path) -> list[Path]:
    """designs.svg and .png: one dot per start of every design, a bar at the median."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    finite = [time for design in designs for time in design.times if math.isfinite(time)]
    beyond = 1.15 * max(finite, default=1.0)  # place of a start that does not settle
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.8, 1.2 + 0.55 * len(designs)))
        axis = figure.subplots()
        for row, design in enumerate(designs):
            times = np.minimum(sorted(design.times), beyond)
            if not times.size:
                continue
            colour = COLOURS[row % len(COLOURS)]
            lost = times >= beyond
            axis.plot(times[~lost], np.full((~lost).sum(), row), "o", color=colour, ms=5, alpha=0.7)
            axis.plot(times[lost], np.full(lost.sum(), row), "x", color=colour, ms=6)
            axis.plot([times[len(times) // 2]] * 2, [row - 0.3, row + 0.3], color=colour, lw=2)
        names = [f"{plain(design.name)} ({plain(design.conditions)})" for design in designs]
        axis.set_yticks(range(len(designs)), names)
        axis.set(xlabel="settling time / s", ylim=(len(designs) - 0.4, -0.6), xlim=(0, 1.05 * beyond))
        if any(len(design.times) > sum(map(math.isfinite, design.times)) for design in designs):
            axis.set_xlabel("settling time / s; a cross did not settle")
        return save(figure, folder / "designs")
