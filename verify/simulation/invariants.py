"""The theorem's promises for every run of the bounded scheme, checked on a measured run."""

from __future__ import annotations

from collections.abc import Sequence

from ...models.equations import State
from .closed_loop import ClosedLoop
from .monitor import Outcome

ENERGY_ERROR = 1e3  # times the integrator's tolerance: a smaller relative rise of V is integration error
ROUNDING = 1e-6  # a ratio may exceed 1 by this much, through integration error


def violations(
    loop: ClosedLoop, outcome: Outcome, start: State, tolerance: float, names: Sequence[str]
) -> tuple[str, ...]:
    """One sentence per broken promise: torque limits, V (17) never rising, certified speeds.

    `tolerance` is that of the integrator; `names` are the vehicles' names.
    """
    if not loop.bounded:
        return ()
    broken = []
    torque, certified = outcome.torque_ratio, outcome.certified
    if torque.value > 1:
        broken.append(
            f"vehicle {names[torque.vehicle]!r}: a wheel torque is {torque.value:.6g} of its limit "
            f"at t = {torque.time:.6g} s"
        )
    if certified.value > 1 + ROUNDING:
        broken.append(
            f"vehicle {names[certified.vehicle]!r}: |v| or |omega| is {certified.value:.9g} of its certified bound "
            f"at t = {certified.time:.6g} s"
        )
    allowed = ENERGY_ERROR * tolerance * (1 + float(loop.translational_energy(start)))
    if outcome.energy_rise > allowed:
        broken.append(f"V of (17) rises by {outcome.energy_rise:.3g}, more than integration explains ({allowed:.3g})")
    return tuple(broken)
