"""Scalars that suit a fleet roughly, in closed form: where exploration begins."""

from __future__ import annotations

import numpy as np

from ..models.conditions import ConditionData
from ..models.equations import Plant
from ..models.saturation import Saturation
from ..models.tolerance import Tolerance
from .scaled_gains import Scalars

# Found by the search on the fleets of `settings`, as multiples of what the fleet says.
LENGTH, HEADING = 2.0, 0.15  # scales, in tolerances
TORQUE_SHARE = 0.25  # of the least acceleration that the torque limits admit
SAMPLES = 5.0  # sample times in tau at least
TURNING = 2.5  # the frequency of the heading near the goal, in 1 / tau
TEMPO, DAMPING, TURN_DAMPING = 0.25, 0.15, 0.5  # in 1 / tau: of psi, and the rates d_v / (s m), d_omega / (o I)
C, H, E = 3.0, 3.0, 1.0


def typical_scalars(
    plant: Plant, data: ConditionData, tolerance: Tolerance, sample_time: float, saturation: Saturation | None
) -> Scalars:
    """The scalars, for given scales where there are some.

    tau is how long l takes by a share of the acceleration that the torque limits admit, or at the speed limit, and
    some sample times at least.
    """
    force = 2 * data.torque / data.r
    acceleration = TORQUE_SHARE * float(np.min(force / plant.m))
    turning = TORQUE_SHARE * float(np.min(force * data.arm / plant.inertia))
    length = LENGTH * tolerance.position if saturation is None else float(saturation.position)
    heading = HEADING * tolerance.heading if saturation is None else float(saturation.heading)
    time = max(float(np.sqrt(length / acceleration)), length / float(np.min(data.speed)), SAMPLES * sample_time)
    mu = max(1 / (TURNING**2 * heading), 1 / (turning * time**2))
    return Scalars(
        length=length,
        time=time,
        mu=mu,
        c=C,
        h=H,
        e=E,
        tempo=TEMPO,
        heading=heading,
        speed=E / DAMPING,
        turn_rate=C / (mu * TURN_DAMPING),
    )
