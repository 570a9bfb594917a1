"""Starts that designs are judged from, in coordinates in which every vehicle's goal is the origin."""

from __future__ import annotations

import math

import numpy as np

from ..models.equations import Plant, State
from ..models.fleet import Fleet
from ..models.graph import Graph
from ..models.starts import Draw, random_starts
from .rollouts.closed_loop import stacked
from .rollouts.runge_kutta import Array

STEPS = 4  # of inverse iteration towards the slowest mode
PLACES = 2  # decimal places of a pattern: what processors round differently is far below


def far_starts(fleet: Fleet, count: int, seed: int, half_width: float, draw: Draw) -> Array:
    """The fleet's own start, if it has one, and random ones, `count` in all, (5, N, count) singles."""
    own, plant = fleet.start(), fleet.plant()
    starts = [*([] if own is None else [own]), *random_starts(fleet, count, seed, half_width, draw)][:count]
    goal_x, goal_y = plant.offset_x + plant.leader_x, plant.offset_y + plant.leader_y
    return stacked([State(start.x - goal_x, start.y - goal_y, *start[2:]) for start in starts])


def near_starts(plant: Plant, count: int, seed: tuple[int, int], error: float, spread: float) -> Array:
    """Starts at rest with errors across the track of at most `error` (m), (5, N, count) singles.

    Every other one has the pattern of the graph's slowest mode, up to the relative `spread`; the rest are random.
    """
    slowest, vehicles = slowest_pattern(plant.graph), plant.graph.vehicles
    rest, theta = np.zeros(vehicles), float(plant.leader_theta)
    sine, cosine = (round(value, 12) for value in (math.sin(theta), math.cos(theta)))
    starts = []
    for number in range(count):
        random = np.random.default_rng([*seed, number])
        slow = slowest * (1 + spread * random.uniform(-1, 1, vehicles))
        pattern = slow if number % 2 == 0 else random.uniform(-1, 1, vehicles)
        side = 1 if number % 4 < 2 else -1
        y = side * error * pattern / np.abs(pattern).max()
        starts.append(State(-y * sine, y * cosine, rest + theta, rest, rest))
    return stacked(starts)


def slowest_pattern(graph: Graph) -> Array:
    """About the slowest mode of D^-1 L_l in every component of the graph, (N,), positive and at most 1."""
    from scipy.sparse.linalg import splu

    solver, pattern = splu(graph.composed_laplacian().tocsc()), np.ones(graph.vehicles)
    for _ in range(STEPS):
        pattern = solver.solve(np.asarray(graph.degree, dtype=float) * pattern)
        pattern /= pattern.max()
    return np.maximum(np.round(pattern, PLACES), 10.0**-PLACES)
