"""The closed loop (13)-(14) of one fleet under given gains, over NumPy arrays of times (K,) and states (K, N)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...models import energy
from ...models.algebra.ops import Ops, numpy_ops, unbounded
from ...models.arrays import floats
from ...models.conditions import ConditionData, float_numbers, pulling_bound, turning_bound
from ...models.equations import Plant, State, closed_loop, control
from ...models.excitation import Excitation
from ...models.fleet import Fleet
from ...models.gains import Gains
from ...models.numbers import low
from ...models.tolerance import Tolerance

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ClosedLoop:
    """Plant, gains and excitation as floats, with the torque limits and the data of the conditions."""

    plant: Plant
    gains: Gains
    excitation: Excitation
    torque_left: Floats  # (N,), N m, limit
    torque_right: Floats  # (N,), N m, limit
    data: ConditionData  # floats, (N,): D, psi_bar, speed and turn-rate limits
    bounded: bool = True  # False: the comparison scheme of Section 4, tanh(s) -> s

    @classmethod
    def of(cls, fleet: Fleet, gains: Gains, excitation: Excitation, *, bounded: bool = True) -> ClosedLoop:
        """The closed loop of a fleet. Of a torque limit given as an interval, the smaller value is used."""
        left = floats([low(vehicle.torque_limit.left) for vehicle in fleet.vehicles])
        right = floats([low(vehicle.torque_limit.right) for vehicle in fleet.vehicles])
        data = fleet.condition_data(excitation).map(floats)
        return cls(fleet.plant(), gains.map(floats), excitation, left, right, data, bounded)

    @property
    def vehicles(self) -> int:
        """N."""
        return self.plant.graph.vehicles

    @property
    def ops(self) -> Ops:
        """The NumPy algebra of the scheme."""
        return numpy_ops() if self.bounded else unbounded(numpy_ops())

    def psi(self, t: Any) -> Floats:
        """The excitation at times (K,), as a column (K, 1); at one time, (1,)."""
        return np.asarray(self.excitation.value(self.ops, np.asarray(t, dtype=float)[..., None]))

    def rates(self, t: Any, state: State) -> State:
        """(13)-(14): the derivative of the state, (K, N)."""
        return closed_loop(self.ops, self.plant, self.gains, self.psi(t), state)

    def torques(self, t: Any, state: State) -> tuple[Floats, Floats]:
        """(6)-(11): left and right torque, N m, (K, N)."""
        return control(self.ops, self.plant, self.gains, self.psi(t), state)

    def torque_ratios(self, t: Any, state: State) -> Floats:
        """Left, then right torque divided by its limit, signed, (K, 2 N)."""
        left, right = self.torques(t, state)
        return np.concatenate([left / self.torque_left, right / self.torque_right], axis=-1)

    def translational_energy(self, state: State) -> Floats:
        """V of (17), (K,)."""
        return np.asarray(energy.translational(self.ops, self.plant, self.gains, state))

    def rotational_energy(self, state: State) -> Floats:
        """W of (19), (K,)."""
        return np.asarray(energy.rotational(self.ops, self.plant, self.gains, state))

    def certified_speeds(self, start: State) -> tuple[Floats, Floats]:
        """Lemma L18: bounds of |v| (m/s) and |omega| (rad/s) for all runs from a start, (N,); inf without a bound."""
        numbers, gains, scale = float_numbers(), self.gains, self.gains.saturation
        if not self.bounded:
            return np.full(self.vehicles, np.inf), np.full(self.vehicles, np.inf)
        pull = pulling_bound(numbers, self.data, gains) / gains.d_v
        turn = turning_bound(numbers, self.data, gains) / gains.d_omega
        return _certified(pull, scale.speed, start.v), _certified(turn, scale.turn_rate, start.omega)

    def offsets(self, state: State) -> State:
        """The state relative to the formation: x, y (m) and theta (rad) from the vehicle's place in it."""
        plant = self.plant
        return State(
            state.x - plant.offset_x - plant.leader_x,
            state.y - plant.offset_y - plant.leader_y,
            state.theta - plant.leader_theta,
            state.v,
            state.omega,
        )

    def distances(self, state: State) -> tuple[Floats, Floats]:
        """Distance from the formation (m) and |theta - theta_l| (rad, on the real line), (..., N)."""
        offset = self.offsets(state)
        return np.hypot(offset.x, offset.y), np.abs(offset.theta)

    def excess(self, state: State, tolerance: Tolerance) -> Floats:
        """The largest error of the fleet divided by its tolerance, (...,): settled means that it stays at most 1."""
        position, heading = self.distances(state)
        return np.asarray(np.maximum(position / tolerance.position, heading / tolerance.heading).max(axis=-1))


def _certified(share: Floats, scale: Floats, start: Floats) -> Floats:
    """max(|start|, scale atanh(share)) where share < 1, else inf."""
    holds = share < 1
    return np.where(holds, np.maximum(np.abs(start), scale * np.arctanh(np.where(holds, share, 0.0))), np.inf)
