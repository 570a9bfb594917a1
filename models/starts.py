"""Random initial states, by default at the fleet's own scale."""

from __future__ import annotations

import math
from enum import IntEnum

import numpy as np

from .equations import State
from .fleet import Fleet


class Draw(IntEnum):
    """The purpose of random starts. Each has its own starts, so a design is validated on starts it never saw."""

    VALIDATION = 0  # the same starts as without this third number of the seed
    RANKING = 1
    TRAINING = 2
    COMPARISON = 3
    FINAL_RANKING = 4


def scale(fleet: Fleet) -> float:
    """The scale of the fleet, m: max(largest start offset along x or y, size of the formation), at least 0.1 m.

    For a fleet without starts it is twice the size of the formation, at least 1 m.
    """
    plant = fleet.plant()
    size = float(np.ptp(plant.offset_x) + np.ptp(plant.offset_y))
    start = fleet.start()
    if start is None:
        return max(1.0, 2 * size)
    far = [np.abs(start.x - plant.offset_x - plant.leader_x), np.abs(start.y - plant.offset_y - plant.leader_y)]
    return max(0.1, size, float(np.max(far)))


def random_starts(
    fleet: Fleet, count: int, seed: int, half_width: float | None = None, draw: Draw = Draw.VALIDATION
) -> list[State]:
    """`count` starts at rest: positions uniform in a square around the goal, headings uniform in (-pi, pi).

    `half_width` (m) is half the side of the square; None takes the fleet's own scale. `draw` is their purpose.
    """
    plant, half = fleet.plant(), scale(fleet) if half_width is None else half_width
    rest = np.zeros(len(fleet))
    starts = []
    for number in range(count):
        # One generator per start: start k is the same, however many are drawn.
        random = np.random.default_rng([seed, number, draw])
        x, y = random.uniform(-half, half, (2, len(fleet)))
        theta = random.uniform(-math.pi, math.pi, len(fleet))
        starts.append(State(plant.leader_x + x, plant.leader_y + y, theta, rest, rest))
    return starts
