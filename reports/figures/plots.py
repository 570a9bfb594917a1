"""Plots of a run, each into given matplotlib axes or into a figure of its own; all return their axes.

Every function takes a fleet, a run of it, and `axis` (or as many `axes` as it has panels): None makes a new figure,
which is `axis.figure`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...models.algebra.ops import numpy_ops
from ...models.arrays import floats
from ...models.equations import across
from ...models.fleet import Fleet
from ...models.numbers import low
from .style import COLOURS, LABEL, LABELLED, STYLE, plain, shown_vehicles

if TYPE_CHECKING:
    from ...verify.simulation.trajectory import Trajectory

Floats = NDArray[np.float64]

POINTS = 1500  # drawn per line
FLOOR = 1e-6  # lower end of a logarithmic axis
IDLE = 0.02  # of the largest torque; less is next to none
LIMITS = 6  # different torque limits that are drawn


def plot_paths(fleet: Fleet, run: Trajectory, axis: Any = None) -> Any:
    """Figures 3 and 4: the path of each vehicle, with its heading at the start and at the end."""
    axis = _axes(axis)
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
                (run.state.x[-1, i], run.state.y[-1, i]),  # in the formation places differ, at the start they may not
                textcoords="offset points",
                xytext=(5, 5),
                color=colour,
            )
    axis.plot(*(float(value) for value in fleet.leader.position), "k*", ms=9)
    axis.annotate("leader", fleet.leader.position, textcoords="offset points", xytext=(6, -10))
    axis.set(xlabel="x / m", ylabel="y / m", aspect="equal")
    axis.set_adjustable("datalim")
    return axis


def plot_poses(fleet: Fleet, run: Trajectory, axes: Any = None) -> Any:
    """Figures 5 and 6: position relative to the place in the formation, and heading, against time; three panels."""
    axes, plant = _axes(axes, 3), fleet.plant()
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
    return axes


def plot_cross_track(fleet: Fleet, run: Trajectory, axis: Any = None) -> Any:
    """The largest |error across the leader's heading| from each time on, and the t^(-1/2) that theory predicts."""
    axis, plant = _axes(axis), fleet.plant()
    error_x = run.state.x - plant.offset_x - plant.leader_x
    error_y = run.state.y - plant.offset_y - plant.leader_y
    size = np.abs(across(numpy_ops(), plant.leader_theta, error_x, error_y))
    later = run.t > run.t[-1] / 300
    if not later.any():
        return axis  # a run of one point
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
    return axis


def plot_torques(fleet: Fleet, run: Trajectory, axis: Any = None) -> Any:
    """The larger wheel torque of each vehicle over its limit: its peak in every drawn interval."""
    axis, (left, right) = _axes(axis), torque_limits(fleet)
    ratio = np.maximum(np.abs(run.tau_left) / left, np.abs(run.tau_right) / right)
    t, peaks = _peaks(run.t, ratio)
    for i in shown_vehicles(len(fleet)):
        axis.plot(
            t, np.maximum(peaks[:, i], FLOOR), color=COLOURS[i % len(COLOURS)], lw=0.8, label=plain(fleet.names[i])
        )
    axis.axhline(1, color="k", lw=1.2)
    axis.annotate("torque limit", (0.98, 1), xycoords=("axes fraction", "data"), ha="right", va="bottom")
    axis.set(xlabel="time / s", ylabel="largest |torque| / limit", yscale="log")
    return axis


def plot_wheel_torques(fleet: Fleet, run: Trajectory, axes: Any = None) -> Any:
    """Figure 7: the torque of each wheel, N m, left and right in two panels; dashed lines are the limits.

    A run that goes on with next to no torque is drawn up to then.
    """
    axes = _axes(axes, 2)
    sides = (("left", run.tau_left), ("right", run.tau_right))
    end = _at_work(run.t, np.maximum(np.abs(run.tau_left), np.abs(run.tau_right)).max(axis=1))
    for axis, (side, torque), limit in zip(axes, sides, torque_limits(fleet), strict=True):
        t, ends = _range(run.t[:end], torque[:end])
        for i in shown_vehicles(len(fleet)):
            axis.plot(t, ends[:, i], color=COLOURS[i % len(COLOURS)], lw=0.7, label=plain(fleet.names[i]))
        for value in sorted(set(limit[shown_vehicles(len(fleet))]))[:LIMITS]:
            axis.axhline(value, color="k", lw=0.8, ls="--")
            axis.axhline(-value, color="k", lw=0.8, ls="--")
        axis.set_ylabel(f"{side} wheel / N m")
    later = f", later torques below {IDLE:.0%} of the largest" if end < len(run.t) else ""
    axes[-1].set_xlabel(f"time / s{later}")
    return axes


def _at_work(t: Floats, largest: Floats) -> int:
    """How many points of a run there are up to some time after the last torque that counts."""
    last = float(t[np.flatnonzero(largest >= IDLE * largest.max())[-1]])
    return max(2, int(np.searchsorted(t, 1.2 * last, side="right")))


def plot_energies(fleet: Fleet, run: Trajectory, axis: Any = None) -> Any:  # noqa: ARG001 -- as all plots
    """V of (17), which never rises, and W of (19), which may."""
    axis, keep = _axes(axis), _thinned(len(run.t))
    for values, name, colour in ((run.V, "V (17)", COLOURS[0]), (run.W, "W (19)", COLOURS[1])):
        axis.plot(run.t[keep], np.maximum(values[keep], FLOOR), color=colour, lw=0.9, label=name)
    axis.set(xlabel="time / s", ylabel="energy", yscale="log")
    return axis


def torque_limits(fleet: Fleet) -> tuple[Floats, Floats]:
    """The limits of the left and of the right wheels, N m, each (N,)."""
    return (
        floats([low(vehicle.torque_limit.left) for vehicle in fleet.vehicles]),
        floats([low(vehicle.torque_limit.right) for vehicle in fleet.vehicles]),
    )


def _axes(given: Any, panels: int = 1) -> Any:
    """The given axes, or those of a new figure with so many panels below each other."""
    if given is not None:
        return given
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context(STYLE):
        return Figure(figsize=(5.2, 4.2 if panels == 1 else 2.2 * panels)).subplots(panels, sharex=True)


def _thinned(count: int, spread: Callable[[float, float, int], Floats] = np.linspace) -> NDArray[np.intp]:
    """At most POINTS indices from 0 to count - 1, spread evenly or by `spread`."""
    return np.unique(np.round(spread(1, count, min(count, POINTS)) - 1).astype(np.intp))


def _peaks(
    t: Floats, values: Floats, spread: Callable[[float, float, int], Floats] = np.linspace
) -> tuple[Floats, Floats]:
    """The largest of `values` (K, N) in each of at most POINTS intervals."""
    edges = _thinned(len(t), spread)
    return t[edges], np.maximum.reduceat(values, edges, axis=0)


def _range(t: Floats, values: Floats) -> tuple[Floats, Floats]:
    """The smallest and the largest of `values` (K, N) in each of at most POINTS intervals, one after the other."""
    edges = _thinned(len(t))
    ends = [extreme.reduceat(values, edges, axis=0) for extreme in (np.minimum, np.maximum)]
    return np.repeat(t[edges], 2), np.stack(ends, axis=1).reshape(-1, values.shape[1])
