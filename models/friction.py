"""Friction of the wheels that can hold a vehicle still: the torques that it takes over a step of time."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from .arrays import Array
from .equations import Plant, State, wheel_torques

SWEEPS = 4  # of Gauss-Seidel: each multiplies the error by (other / own)^2

Clip = Callable[[Array, Array], Array]  # x, limit -> x, at least -limit and at most limit


def friction_torques(
    clip: Clip, plant: Plant, state: State, torques: Sequence[Array], coulomb: Array, viscous: Array, h: Array
) -> list[Array]:
    """The friction torque of the left and the right wheel, N m, constant over the time h (s) from a state.

    `torques` (left, right) are held for so long. Coulomb friction (N m) opposes a wheel that turns at the end of the
    step and stops one that it can stop; a wheel at rest stays so while its torque is below it. Viscous friction
    (N m s/rad) is that of the speed at the end of the step.
    """
    straight, turning = 1 / (plant.m * plant.r**2), plant.arm**2 / (plant.inertia * plant.r**2)
    own, other = straight + turning, straight - turning  # rad/s^2 per N m at the same and at the other wheel
    # (2) conserves power: the left wheel turns at (v + arm omega) / r, the right one at (v - arm omega) / r.
    speeds = [(state.v + sign * plant.arm * state.omega) / plant.r for sign in (1, -1)]
    free = [speeds[k] + h * (own * torques[k] + other * torques[1 - k]) for k in (0, 1)]
    # Begin with what stops both wheels: where friction can do that, the sweeps change nothing.
    stopping = wheel_torques(plant, plant.m * state.v / h, plant.inertia * state.omega / h)
    lost = [clip(torques[k] + stopping[k], coulomb) for k in (0, 1)]
    for _ in range(SWEEPS):
        for k in (0, 1):
            speed = free[k] - h * other * lost[1 - k]  # at the end of the step, without friction at this wheel
            dry = clip(speed / (h * own), coulomb)
            lost[k] = dry + viscous * (speed - h * own * dry) / (1 + h * own * viscous)
    return lost
