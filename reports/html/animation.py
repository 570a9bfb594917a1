"""The data of the animation in the report: a run thinned to its important frames, as small integers."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...models.arrays import floats
from ...models.fleet import Fleet
from ...models.numbers import low
from ...verify.simulation.trajectory import Floats, Trajectory
from ..figures.style import shown_vehicles

POSES = 60_000  # frames times vehicles
FRAMES = (150, 1500)  # fewest and most
EVEN = 0.3  # share of the frames that is spread evenly in time; the others are where the fleet moves
TURN = 0.5  # rad of turning that count as much as a twentieth of the picture's side
RESOLUTION = 4000  # steps across the picture
ANGLE = 1e-3  # rad
RATIO = 1e-4  # of a torque limit


def animation_data(fleet: Fleet, run: Trajectory) -> dict[str, Any]:
    """The data for the page's script: frame by frame, vehicle by vehicle, lengths in `unit` m from the leader."""
    shown = shown_vehicles(len(fleet))
    frames = frame_indices(run, shown, POSES // len(shown))
    plant = fleet.plant()
    goal = np.column_stack([plant.offset_x[shown], plant.offset_y[shown]])
    unit = _picture(run, shown) / RESOLUTION
    number = {vehicle: k for k, vehicle in enumerate(shown)}
    graph = fleet.graph
    pairs = zip(graph.tail.tolist(), graph.head.tolist(), strict=True)
    return {
        "names": [fleet.names[i] for i in shown],
        "hidden": len(fleet) - len(shown),
        "unit": unit,
        "angle": ANGLE,
        "ratio": RATIO,
        "t": [round(float(t), 3) for t in run.t[frames]],
        "x": _whole((run.state.x[frames][:, shown] - plant.leader_x) / unit),
        "y": _whole((run.state.y[frames][:, shown] - plant.leader_y) / unit),
        "theta": _whole(run.state.theta[frames][:, shown] / ANGLE),
        "left": _whole(peak_ratios(fleet, run, frames, "left")[:, shown] / RATIO),
        "right": _whole(peak_ratios(fleet, run, frames, "right")[:, shown] / RATIO),
        "goal": (goal / unit).round().astype(int).tolist(),
        "heading": plant.leader_theta,
        "edges": [[number[i], number[j]] for i, j in pairs if i in number and j in number],
        "led": [number[i] for i in np.flatnonzero(floats(graph.leader_weight)).tolist() if i in number],
    }


def frame_indices(run: Trajectory, shown: list[int], most: int) -> NDArray[np.int64]:
    """Stored points to show: dense while the vehicles move and turn, so that straight lines between them are enough."""
    wanted = int(np.clip(most, *FRAMES))
    if len(run.t) <= wanted:
        return np.arange(len(run.t))
    state = run.state
    travel = np.hypot(np.diff(state.x[:, shown], axis=0), np.diff(state.y[:, shown], axis=0)).max(axis=1)
    turning = np.abs(np.diff(state.theta[:, shown], axis=0)).max(axis=1)
    change = travel / (_picture(run, shown) / 20) + turning / TURN
    total = float(change.sum())
    share = change / total if total > 0 else np.zeros_like(change)
    clock = np.concatenate([[0.0], np.cumsum((1 - EVEN) * share + EVEN * np.diff(run.t) / (run.t[-1] - run.t[0]))])
    indices = np.searchsorted(clock, np.linspace(0, clock[-1], wanted))
    return np.unique(np.clip(indices, 0, len(run.t) - 1))


def peak_ratios(fleet: Fleet, run: Trajectory, frames: NDArray[np.int64], wheel: str) -> Floats:
    """The largest |torque| over its limit from one frame to the next, (frames, N): no peak is lost between frames."""
    limits = floats([low(getattr(vehicle.torque_limit, wheel)) for vehicle in fleet.vehicles])
    torques = run.tau_left if wheel == "left" else run.tau_right
    return np.asarray(np.maximum.reduceat(np.abs(torques), frames, axis=0) / limits)


def _picture(run: Trajectory, shown: list[int]) -> float:
    """The side of the square that holds all paths, m."""
    return max(float(np.ptp(run.state.x[:, shown])), float(np.ptp(run.state.y[:, shown])), 1e-3)


def _whole(values: Floats) -> list[int]:
    return np.nan_to_num(values).round().astype(np.int64).ravel().tolist()
