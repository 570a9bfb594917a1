"""A vehicle whose centre of mass is off the middle of its axle: not (2), and nothing is certified of it.

With the centre of mass d ahead and e to the left, the mass m moves with (v - e w, d w) along and across the heading:

    F = m* v' - m e w' - m d w^2,    M = I* w' - m e v' + m d v w,

where m* and I* are the effective values of (2), I* about the middle of the axle, and F and M the force and the moment
of the wheels.
"""

from __future__ import annotations

from dataclasses import dataclass

from .arrays import Array, column, floats
from .equations import Plant, State, accelerations
from .fleet import Fleet
from .numbers import nominal


@dataclass(frozen=True, eq=False)
class OffAxle:
    """Where the centres of mass are, (N,) each."""

    mass: Array  # kg, without the wheels' spin
    ahead: Array  # m, d
    left: Array  # m, e

    @classmethod
    def of(cls, fleet: Fleet) -> OffAxle:
        """Of the vehicles of a fleet."""
        offsets = [vehicle.com_offset for vehicle in fleet.vehicles]
        mass = column(nominal(vehicle.mass) for vehicle in fleet.vehicles)
        return cls(*map(floats, (mass, column(d for d, _ in offsets), column(e for _, e in offsets))))

    def accelerations(self, plant: Plant, state: State, tau_left: Array, tau_right: Array) -> tuple[Array, Array]:
        """v' (m/s^2) and w' (rad/s^2) from the wheel torques (N m)."""
        v_rate, omega_rate = accelerations(plant, tau_left, tau_right)
        force = plant.m * v_rate + self.mass * self.ahead * state.omega**2
        moment = plant.inertia * omega_rate - self.mass * self.ahead * state.v * state.omega
        coupling = self.mass * self.left
        determinant = plant.m * plant.inertia - coupling**2
        return (
            (plant.inertia * force + coupling * moment) / determinant,
            (plant.m * moment + coupling * force) / determinant,
        )
