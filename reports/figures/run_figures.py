"""Figures 3-7 of the paper for any fleet, energies and cross-track errors: both schemes side by side, SVG and PNG."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...models.algebra.ops import numpy_ops
from ...models.arrays import floats
from ...models.equations import across
from ...models.fleet import Fleet
from ...models.numbers import low
from .style import COLOURS, LABEL, LABELLED, STYLE, plain, save, shown_vehicles

if TYPE_CHECKING:
    from ...verify.simulation.trajectory import Trajectory

Floats = NDArray[np.float64]

POINTS = 1500  # drawn per line
FLOOR = 1e-6  # lower end of a logarithmic axis


def write_figures(fleet: Fleet, runs: Mapping[str, Trajectory], folder: Path, origin: str = "") -> list[Path]:
    """Paths, poses, cross-track errors, torques and energies of the runs (title -> run), one panel each. SVG, PNG."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    drawings: dict[str, tuple[Callable[[Any, Fleet, Trajectory], None], int]] = {
        "paths": (_paths, 1),
        "poses": (_poses, 3),
        "cross_track": (_cross_track, 1),
        "torques": (_torques, 1),
        "energies": (_energies, 1),
    }
    written = []
    with mpl.rc_context(STYLE):
        for name, (draw, rows) in drawings.items():
            figure = Figure(figsize=(5.2 * len(runs), 4.2 if rows == 1 else 6.6))
            share: Any = "row" if name in ("cross_track", "torques", "energies") else "none"
            axes = figure.subplots(rows, len(runs), squeeze=False, sharex="col", sharey=share)
            for panels, (title, run) in zip(axes.T, runs.items(), strict=True):
                panels[0].set_title(title)
                draw(panels if rows > 1 else panels[0], fleet, run)
            _legend(figure, axes[0, 0])
            written += save(figure, folder / name, origin)
    return written


def _paths(axis: Any, fleet: Fleet, run: Trajectory) -> None:
    """Figures 3 and 4: the path of each vehicle, with its heading at the start and at the end."""
    keep, unit = _thinned(len(run.t)), float(max(np.ptp(run.state.x), np.ptp(run.state.y))) / 20
    for i in shown_vehicles(len(fleet)):
        colour = COLOURS[i % len(COLOURS)]
        axis.plot(run.state.x[keep, i], run.state.y[keep, i], color=colour, lw=0.9)
        for k, fill in ((0, "none"), (-1, colour)):
            x, y, theta = run.state.x[k, i], run.state.y[k, i], run.state.theta[k, i]
            axis.plot(x, y, "o", mfc=fill, mec=colour, ms=4)
            tip = (x + unit * np.cos(theta), y + unit * np.sin(theta))
            axis.annotate("", tip, (x, y), arrowprops={"arrowstyle": "->", "color": colour, "lw": 1.2})
        if len(fleet) <= LABELLED:
            axis.annotate(
                plain(fleet.names[i]),
                (run.state.x[0, i], run.state.y[0, i]),
                textcoords="offset points",
                xytext=(5, 5),
                color=colour,
            )
    axis.plot(*(float(value) for value in fleet.leader.position), "k*", ms=9)
    axis.annotate("leader", fleet.leader.position, textcoords="offset points", xytext=(6, -10))
    axis.set(xlabel="x / m", ylabel="y / m", aspect="equal")
    axis.set_adjustable("datalim")


def _poses(axes: Any, fleet: Fleet, run: Trajectory) -> None:
    """Figures 5 and 6: position relative to the place in the formation, and heading, against time."""
    plant = fleet.plant()
    rows = (
        (run.state.x - plant.offset_x, plant.leader_x, "x - offset / m"),
        (run.state.y - plant.offset_y, plant.leader_y, "y - offset / m"),
        (run.state.theta, plant.leader_theta, "heading / rad"),
    )
    keep = _thinned(len(run.t))
    for axis, (values, goal, label) in zip(axes, rows, strict=True):
        for i in shown_vehicles(len(fleet)):
            axis.plot(
                run.t[keep], values[keep, i], color=COLOURS[i % len(COLOURS)], lw=0.8, label=plain(fleet.names[i])
            )
        axis.axhline(goal, color="k", lw=0.8, ls="--")
        axis.set_ylabel(label)
    axes[-1].set_xlabel("time / s")


def _cross_track(axis: Any, fleet: Fleet, run: Trajectory) -> None:
    """The largest |error across the leader's heading| from each time on, and the t^(-1/2) that theory predicts."""
    plant = fleet.plant()
    error_x = run.state.x - plant.offset_x - plant.leader_x
    error_y = run.state.y - plant.offset_y - plant.leader_y
    size = np.abs(across(numpy_ops(), plant.leader_theta, error_x, error_y))
    later = run.t > run.t[-1] / 300
    if not later.any():
        return  # a run of one point
    # The excitation makes the error swing through 0; its envelope decays.
    t, peaks = _peaks(run.t[later], size[later], np.geomspace)
    envelope = np.maximum(np.maximum.accumulate(peaks[::-1])[::-1], FLOOR)
    for i in shown_vehicles(len(fleet)):
        axis.plot(t, envelope[:, i], color=COLOURS[i % len(COLOURS)], lw=1, label=plain(fleet.names[i]))
    tail = t[t >= t[-1] / 10]
    line = 1.6 * envelope[-1].max() * np.sqrt(t[-1] / tail)
    axis.plot(tail, line, color="k", lw=1.2, ls="--")
    middle = len(tail) // 2
    axis.annotate("t^(-1/2)", (tail[middle], line[middle]), textcoords="offset points", xytext=(4, 5), bbox=LABEL)
    axis.set(xlabel="time / s", ylabel="largest |cross-track error| from then on / m", xscale="log", yscale="log")


def _torques(axis: Any, fleet: Fleet, run: Trajectory) -> None:
    """Figure 7: the larger wheel torque over its limit; the largest in each drawn interval, so no peak is lost."""
    left = floats([low(vehicle.torque_limit.left) for vehicle in fleet.vehicles])
    right = floats([low(vehicle.torque_limit.right) for vehicle in fleet.vehicles])
    ratio = np.maximum(np.abs(run.tau_left) / left, np.abs(run.tau_right) / right)
    t, peaks = _peaks(run.t, ratio)
    for i in shown_vehicles(len(fleet)):
        axis.plot(
            t, np.maximum(peaks[:, i], FLOOR), color=COLOURS[i % len(COLOURS)], lw=0.8, label=plain(fleet.names[i])
        )
    axis.axhline(1, color="k", lw=1.2)
    axis.annotate("torque limit", (0.98, 1), xycoords=("axes fraction", "data"), ha="right", va="bottom")
    axis.set(xlabel="time / s", ylabel="largest |torque| / limit", yscale="log")


def _energies(axis: Any, _: Fleet, run: Trajectory) -> None:
    """V of (17), which never rises, and W of (19), which may."""
    keep = _thinned(len(run.t))
    for values, name, colour in ((run.V, "V (17)", COLOURS[0]), (run.W, "W (19)", COLOURS[1])):
        axis.plot(run.t[keep], np.maximum(values[keep], FLOOR), color=colour, lw=0.9, label=name)
    axis.set(xlabel="time / s", ylabel="energy", yscale="log")


def _legend(figure: Any, axis: Any) -> None:
    """One legend below all panels, if the lines are few enough to tell apart."""
    handles, labels = axis.get_legend_handles_labels()
    if not 0 < len(handles) <= LABELLED:
        return
    widest = 0.6 + 0.08 * max(map(len, labels))  # inches of an entry
    columns = max(1, min(len(handles), int(figure.get_figwidth() / widest)))
    figure.legend(handles, labels, loc="outside lower center", ncols=columns, frameon=False)


def _thinned(count: int, spread: Callable[[float, float, int], Floats] = np.linspace) -> NDArray[np.intp]:
    """At most POINTS indices from 0 to count - 1, spread evenly or by `spread`."""
    return np.unique(np.round(spread(1, count, min(count, POINTS)) - 1).astype(np.intp))


def _peaks(
    t: Floats, values: Floats, spread: Callable[[float, float, int], Floats] = np.linspace
) -> tuple[Floats, Floats]:
    """The largest of `values` (K, N) in each of at most POINTS intervals."""
    edges = _thinned(len(t), spread)
    return t[edges], np.maximum.reduceat(values, edges, axis=0)
