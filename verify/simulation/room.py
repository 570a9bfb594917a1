"""The room that the fleet uses in the plane during a run, and how near its robots come to each other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from .closed_loop import Floats
from .trajectory import Trajectory

PAIRS = 20_000_000  # distances that are computed at once


class Nearest(NamedTuple):
    """The least distance between the centres of two vehicles over a run."""

    distance: float  # m; inf for a single vehicle
    first: int  # its place in the fleet
    second: int
    time: float  # s


@dataclass(frozen=True)
class Room:
    """The room that a run uses, and its least distance between robots."""

    width: float  # m, along x
    height: float  # m, along y
    nearest: Nearest
    names: tuple[str, ...]  # of the vehicles

    @classmethod
    def of(cls, run: Trajectory, names: Sequence[str]) -> Room:
        """Room and least distance over the stored points of a run."""
        x, y = run.state.x, run.state.y
        return cls(float(np.ptp(x)), float(np.ptp(y)), _nearest(run.t, x, y), tuple(names))

    def to_json(self) -> dict[str, Any]:
        """The entries of summary.json."""
        nearest = self.nearest
        pair = [self.names[nearest.first], self.names[nearest.second]]
        alone = math.isinf(nearest.distance)
        return {
            "room_m": [self.width, self.height],
            "least_distance_m": None if alone else nearest.distance,
            "nearest": None if alone else {"vehicles": pair, "time_s": nearest.time},
        }

    def sentence(self) -> str:
        """The room and least distance as a sentence."""
        nearest = self.nearest
        room = f"the fleet uses {self.width:.3g} m x {self.height:.3g} m"
        if math.isinf(nearest.distance):
            return room
        pair = f"{self.names[nearest.first]!r} and {self.names[nearest.second]!r}"
        return f"{room}; nearest: {pair}, {nearest.distance:.3g} m between their centres at {nearest.time:.4g} s"


def _nearest(t: Floats, x: Floats, y: Floats) -> Nearest:
    vehicles = x.shape[1]
    if vehicles < 2:
        return Nearest(math.inf, 0, 0, 0.0)
    rows = max(1, PAIRS // vehicles**2)
    search = _among_all if vehicles**2 <= PAIRS // 100 else _by_tree
    parts = (slice(begin, begin + rows) for begin in range(0, len(t), rows))
    return min(search(t[part], x[part], y[part]) for part in parts)


def _among_all(t: Floats, x: Floats, y: Floats) -> Nearest:
    i, j = np.triu_indices(x.shape[1], 1)
    distance = np.hypot(x[:, i] - x[:, j], y[:, i] - y[:, j])
    k, pair = np.unravel_index(int(np.argmin(distance)), distance.shape)
    return Nearest(float(distance[k, pair]), int(i[pair]), int(j[pair]), float(t[k]))


def _by_tree(t: Floats, x: Floats, y: Floats) -> Nearest:
    """For large fleets: the nearest neighbour of every vehicle, time by time."""
    from scipy.spatial import cKDTree

    best = Nearest(math.inf, 0, 0, 0.0)
    for time, places in zip(t, np.stack([x, y], axis=-1), strict=True):
        distance, neighbour = cKDTree(places).query(places, k=2)
        i = int(np.argmin(distance[:, 1]))
        first, second = sorted((i, int(neighbour[i, 1])))
        best = min(best, Nearest(float(distance[i, 1]), first, second, float(time)))
    return best
