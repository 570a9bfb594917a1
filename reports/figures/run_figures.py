"""Figures 3-7 of the paper for any fleet, energies and cross-track errors: both schemes side by side."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...models.fleet import Fleet
from .plots import plot_cross_track, plot_energies, plot_paths, plot_poses, plot_torques, plot_wheel_torques
from .style import LABELLED, STYLE, save

if TYPE_CHECKING:
    from ...verify.simulation.trajectory import Trajectory

DRAWINGS: dict[str, tuple[Callable[..., Any], int]] = {  # file -> how it is drawn, and its panels
    "paths": (plot_paths, 1),
    "poses": (plot_poses, 3),
    "cross_track": (plot_cross_track, 1),
    "torques": (plot_torques, 1),
    "wheel_torques": (plot_wheel_torques, 2),
    "energies": (plot_energies, 1),
}
ONE_SCALE = ("cross_track", "torques", "energies")  # figures whose panels share the vertical axis


def write_figures(fleet: Fleet, runs: Mapping[str, Trajectory], folder: Path, origin: str = "") -> list[Path]:
    """The figures of the runs (title -> run), one column of panels for each, as SVG, PNG and PDF."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    written = []
    with mpl.rc_context(STYLE):
        for name, (draw, rows) in DRAWINGS.items():
            figure = Figure(figsize=(5.2 * len(runs), 4.2 if rows == 1 else 2.2 * rows))
            share: Any = "row" if name in ONE_SCALE else "none"
            axes = figure.subplots(rows, len(runs), squeeze=False, sharex="col", sharey=share)
            for panels, (title, run) in zip(axes.T, runs.items(), strict=True):
                panels[0].set_title(title)
                draw(fleet, run, panels if rows > 1 else panels[0])
            _legend(figure, axes[0, 0])
            written += save(figure, folder / name, origin)
    return written


def _legend(figure: Any, axis: Any) -> None:
    """One legend below all panels, if the lines are few enough to tell apart."""
    handles, labels = axis.get_legend_handles_labels()
    if not 0 < len(handles) <= LABELLED:
        return
    widest = 0.6 + 0.08 * max(map(len, labels))  # inches of an entry
    columns = max(1, min(len(handles), int(figure.get_figwidth() / widest)))
    figure.legend(handles, labels, loc="outside lower center", ncols=columns, frameon=False)
