"""The constants of the lemmas, each in one function: of symbols where it is checked, of numbers for a fleet.

Every function takes a `Setting` and returns one value per vehicle, (N,), of the setting's number type.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from ...models.algebra.ops import Ops
from ...models.arrays import Array
from ...models.equations import Plant
from ...models.gains import Gains

Number = Any  # a float or a SymPy expression


@dataclass(frozen=True, eq=False)
class Setting:
    """A plant with gains, their scales, and bounds of psi, in one number type."""

    ops: Ops
    root2: Number
    plant: Plant
    gains: Gains
    psi0: Array  # bound of |psi|, (N,) or one number
    psi1: Array  # of |psi'|, 1/s
    psi2: Array  # of |psi''|, 1/s^2

    @property
    def degree(self) -> Array:
        """D_i."""
        return self.plant.graph.degree

    @property
    def coupling(self) -> Array:
        """D_i + l_ii: what speeds of at most 1 can do to e_i in a second."""
        return 2 * self.degree - self.plant.graph.leader_weight


def excitation_bound(c: Setting) -> Array:
    """c = sqrt2 k psi0 D of L1, N m: |alpha| < c."""
    return c.root2 * c.gains.k_alpha * c.psi0 * c.degree


def acceleration_bound(c: Setting) -> Array:
    """B of L1, m/s^2: |v'| < B."""
    return (c.root2 * c.gains.p_v * c.degree + c.gains.d_v) / c.plant.m


def turn_acceleration_bound(c: Setting) -> Array:
    """A of L1, rad/s^2: |omega'| < A."""
    return (c.gains.p_omega * c.degree + c.gains.d_omega + excitation_bound(c)) / c.plant.inertia


def speed_weight(c: Setting) -> Array:
    """g of L6: W-hat' <= -P_w + sum g_i |v_i|."""
    graph, push = c.plant.graph, c.gains.k_alpha / c.gains.p_omega
    inertial = (c.plant.m * c.psi2 + c.gains.d_v * c.psi1 / c.gains.saturation.speed) / c.gains.p_v
    weight = push * (inertial + c.psi0 * c.degree / c.gains.saturation.position)
    np.add.at(weight, graph.tail, graph.weight * (push * c.psi0)[graph.head] / c.gains.saturation.position)
    np.add.at(weight, graph.head, graph.weight * (push * c.psi0)[graph.tail] / c.gains.saturation.position)
    return weight


def damping_share(c: Setting, weight: Array, slack: Number, vehicles: Number) -> Array:
    """K_e of L7 per vehicle: weight |v| <= e/N + K (d_v/p_v) |v| tanh(|v|/s), for a slack e > 0 over N vehicles."""
    return weight * c.gains.p_v / (c.gains.d_v * c.ops.tanh(slack / (vehicles * weight * c.gains.saturation.speed)))


def energy_offset(c: Setting) -> Array:
    """C0 of L8, one summand per vehicle."""
    push = c.gains.k_alpha / c.gains.p_omega
    return excitation_bound(c) / c.gains.p_omega + c.plant.m / (2 * c.gains.p_v) * (push * c.psi1) ** 2


def level_for(c: Setting, error: Number, scale: Number, cut: Number, vehicles: Number) -> Number:
    """chi of L9: |e_i| <= chi for all N vehicles implies |error| <= `error`, for a least cut kappa_cut."""
    return cut / vehicles * c.ops.tanh(error / (vehicles * scale))


def steep_stretch(period: Number, power: Number, psi2: Number) -> Number:
    """The length over which |psi'| stays above half of what (12) gives somewhere, as far as psi'' goes: L10."""
    slope = power / period
    return (slope.sqrt() if hasattr(slope, "sqrt") else slope ** Fraction(1, 2)) / (2 * psi2)


def variance_bound(period: Number, power: Number, stretch: Number) -> Number:
    """L10: nu >= mu h^3/(48 T) for a stretch h <= T/2."""
    return power * stretch**3 / (48 * period)


def spike_energy(c: Setting, peak: Number, length: Number, scale: Array) -> Array:
    """L11: int f tanh(f/o) over a stretch of this length within eta/(2A) of a point where |f| = eta."""
    return length * (peak / 2) * c.ops.tanh(peak / (2 * scale))


def spike_length(peak: Number, rate: Array) -> Array:
    """L11: eta/(2A), within which f, which changes by at most A a second, keeps half of its peak eta."""
    return peak / (2 * rate)


def pull_rate(c: Setting) -> Array:
    """r of L12: |q'|, |b'| <= r eta while |v|, |omega| <= eta."""
    return c.root2 * c.degree + c.coupling / c.gains.saturation.position


def heading_rate(c: Setting) -> Array:
    """sigma of L12: |e_theta'| <= sigma eta while |omega| <= eta."""
    return c.coupling / c.gains.saturation.heading


def across_bound(c: Setting, period: Number, variance: Number) -> Array:
    """beta of L12: |b| <= beta eta over a window in which |v|, |omega| <= eta."""
    gains, psi0, rate = c.gains, c.psi0, pull_rate(c)
    by_parts = c.plant.inertia * (4 * psi0 + period * c.psi1)
    headings = gains.p_omega * psi0 * heading_rate(c) * period**2
    damping = 2 * psi0 * period * gains.d_omega / c.gains.saturation.turn_rate
    drift = gains.k_alpha * psi0**2 * rate * period**2
    return (by_parts + headings + damping + drift) / (gains.k_alpha * variance) + rate * period


def heading_bound(c: Setting, period: Number, across: Array) -> Array:
    """eps of L12: |e_theta| <= eps eta over such a window, where |b| <= across eta."""
    gains, rate = c.gains, heading_rate(c)
    turning = 2 * c.plant.inertia + gains.p_omega * rate * period**2 / 2
    inputs = gains.d_omega * period / c.gains.saturation.turn_rate + gains.k_alpha * c.psi0 * period * across
    return (turning + inputs) / (gains.p_omega * period) + rate * period


def along_bound(c: Setting, period: Number) -> Array:
    """xi of L12: |q| <= xi eta over such a window."""
    gains, rate = c.gains, pull_rate(c)
    driving = 2 * c.plant.m + gains.p_v * rate * period**2 / 2 + gains.d_v * period / c.gains.saturation.speed
    return driving / (gains.p_v * period) + rate * period
