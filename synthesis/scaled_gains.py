"""Six scalars that describe the gains of a whole fleet, and how they become one set of gains per vehicle.

With D_i = a_il + l_ii, docs/theory.md 7.4 scales every vehicle by its own mass, inertia and degree:

    I / p_omega = mu_omega D,  d_omega / p_omega = c D,  k / p_omega = h,  m / p_v = mu_v D,  d_v / p_v = e D.

Every condition but the torque limit is then the same for all vehicles.
"""

from __future__ import annotations

from dataclasses import astuple, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..models.arrays import Array
from ..models.conditions import ConditionData, ConditionSet, Inequality, float_numbers
from ..models.gains import Gains

INWARD = 0.9999  # gains are scaled to this fraction of what a condition admits, before they are rounded


@dataclass(frozen=True)
class Scalars:
    """The six structured scalars; all positive, of any one number type."""

    mu_omega: Any  # s^2, I / (p_omega D)
    c: Any  # d_omega / (p_omega D)
    h: Any  # k / p_omega
    mu_v: Any  # s^2, m / (p_v D)
    e: Any  # d_v / (p_v D)
    tempo: Any = 1.0  # what the frequency of a designed psi is multiplied by

    def logarithms(self) -> NDArray[np.float64]:
        """The scalars as a search sees them, (6,)."""
        logarithms: NDArray[np.float64] = np.log(np.array(astuple(self), dtype=float))
        return logarithms

    @classmethod
    def from_logarithms(cls, logarithms: NDArray[np.float64]) -> Scalars:
        """The inverse of `logarithms`."""
        return cls(*np.exp(np.asarray(logarithms, dtype=float)).tolist())


def structured(scalars: Scalars, m: Array, inertia: Array, degree: Array) -> Gains:
    """The gains (N,) that the scalars stand for, before any condition; m (kg), inertia (kg m^2) and degree (N,)."""
    p_omega = inertia / (scalars.mu_omega * degree)
    p_v = m / (scalars.mu_v * degree)
    return Gains(
        p_v=p_v,
        d_v=scalars.e * degree * p_v,
        p_omega=p_omega,
        d_omega=scalars.c * degree * p_omega,
        k_alpha=scalars.h * p_omega,
    )


def within(conditions: ConditionSet, data: ConditionData, gains: Gains) -> Gains:
    """The gains (floats) moved into the conditions, vehicle by vehicle; always possible, in closed form.

    Conditions on ratios of gains come first: each is met by lowering the gains that scale its small side, and stays
    met when later ones are. Torque and acceleration limits come last and scale the gains of a channel or all together.
    """
    numbers = float_numbers()
    for condition in (*conditions.homogeneous(data), *conditions.bounding(data)):
        inequality = condition(numbers, data, gains)
        while np.any(unbounded := np.isinf(inequality.small) & np.isfinite(inequality.large)):
            gains = _scaled(gains, inequality, np.where(unbounded, 0.5, 1.0))
            inequality = condition(numbers, data, gains)
        gains = lowered(gains, inequality)
    return gains


def lowered(gains: Gains, inequality: Inequality) -> Gains:
    """The gains with those that scale the small side of an inequality lowered until it holds with a little room."""
    limited = np.isfinite(inequality.large)
    small = np.where(limited, inequality.small, 1.0)
    return _scaled(gains, inequality, np.minimum(1.0, np.where(limited, INWARD * inequality.large / small, 1.0)))


def _scaled(gains: Gains, inequality: Inequality, factor: Array) -> Gains:
    return replace(gains, **{name: getattr(gains, name) * factor for name in inequality.scaled})
