"""What the search minimises: the settling time over far and near starts, as an ideal robot and as a real one moves."""

from __future__ import annotations

import numpy as np

from .rollouts.runge_kutta import Array
from .settings import Settings


def cost(time: Array, excess: Array, horizon: float, settings: Settings) -> Array:
    """The power mean of settling times over starts, (candidates,), s, from times and excesses (candidates, starts).

    A start that did not settle counts beyond the horizon, the more the further away it ended. The power lets late
    starts decide: with near starts among them, which fall most slowly, no start can meet a long tail.
    """
    beyond = 1 + np.log(np.clip(excess, 1.0, settings.largest_excess))
    counted = np.where(np.isfinite(time), time, horizon * beyond)
    return np.asarray(np.mean(counted**settings.power, axis=1) ** (1 / settings.power))
