"""Ten numbers that describe the controller of a whole fleet, and how they become gains and scales per vehicle.

With D_i = a_il + l_ii, a length unit l and a time unit tau, THEORY sections 1b and 3 scale every vehicle by its own
mass, inertia and degree:

    p_v = m l / (tau^2 D),  d_v = e D p_v,  p_omega = I / (tau^2 mu D),  d_omega = c D p_omega,  k = h p_omega,

psi has the frequency w / tau, and the saturation scales are l, rho, s l / tau and o / tau. All but l and tau are
dimensionless. Every condition but the torque limit is then the same for all vehicles of one speed limit.
"""

from __future__ import annotations

from dataclasses import astuple, dataclass, fields, replace
from typing import Any

import numpy as np

from ..models.arrays import Array
from ..models.conditions import ConditionData, ConditionSet, Inequality, float_numbers
from ..models.gains import GAIN_NAMES, Gains
from ..models.saturation import Saturation

INWARD = 0.9999  # gains are scaled to this fraction of what a condition admits, before they are rounded


@dataclass(frozen=True)
class Scalars:
    """The numbers that describe a fleet's controller; all positive, of any one number type."""

    length: Any  # m, l: the position scale
    time: Any  # s, tau
    mu: Any  # I / (p_omega D tau^2)
    c: Any  # d_omega / (p_omega D)
    h: Any  # k / p_omega
    e: Any  # d_v / (p_v D)
    tempo: Any  # the frequency of psi times tau
    heading: Any  # rad, rho: the heading scale
    speed: Any  # s_i tau / l, of every vehicle
    turn_rate: Any  # o_i tau, of every vehicle

    def scaled(self, factors: Any) -> Scalars:
        """Every number multiplied by its own factor, (10,)."""
        return Scalars(*(number * factor for number, factor in zip(astuple(self), factors, strict=True)))

    @property
    def frequency(self) -> Any:
        """Of psi, rad/s."""
        return self.tempo / self.time

    @property
    def saturation(self) -> Saturation:
        """The scales, equal for all vehicles."""
        return Saturation(self.length, self.heading, self.speed * self.length / self.time, self.turn_rate / self.time)


SCALAR_NAMES = tuple(field.name for field in fields(Scalars))


def structured(scalars: Scalars, m: Array, inertia: Array, degree: Array) -> Gains:
    """The gains (N,) and scales of the scalars, before any condition; m (kg), inertia (kg m^2) and degree (N,)."""
    square = scalars.time * scalars.time
    p_v = m * scalars.length / (square * degree)
    p_omega = inertia / (square * scalars.mu * degree)
    return Gains(
        p_v=p_v,
        d_v=scalars.e * degree * p_v,
        p_omega=p_omega,
        d_omega=scalars.c * degree * p_omega,
        k_alpha=scalars.h * p_omega,
        saturation=scalars.saturation,
    )


def with_factors(gains: Gains, factors: Array) -> Gains:
    """Gains and vehicle scales multiplied by (5, N) or (7, N) factors, in the order of their names."""
    numbers = {name: getattr(gains, name) * row for name, row in zip(GAIN_NAMES, factors, strict=False)}
    scale = gains.saturation
    speed, turn_rate = factors[len(GAIN_NAMES) :] if len(factors) > len(GAIN_NAMES) else (1.0, 1.0)
    saturation = Saturation(scale.position, scale.heading, scale.speed * speed, scale.turn_rate * turn_rate)
    return Gains(**numbers, saturation=saturation)


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
