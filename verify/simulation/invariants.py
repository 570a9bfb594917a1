"""What must hold on every run of the bounded scheme; a violation is named with its time and vehicle."""

from __future__ import annotations

from collections.abc import Sequence

from ...models.equations import State
from .loop import Loop
from .observer import Outcome

ENERGY_ERROR = 1e3  # times the integrator's tolerance: the relative error of V that is put down to integration
ROUNDING = 1e-6  # by which a ratio may pass 1 through the integration's error


def violations(loop: Loop, outcome: Outcome, start: State, accuracy: float, names: Sequence[str]) -> list[str]:
    """One sentence for every broken promise of the theorem: torque limits, V (17) falling, certified speeds."""
    if not loop.bounded:
        return []
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
    allowed = ENERGY_ERROR * accuracy * (1 + float(loop.translational_energy(start)))
    if outcome.energy_rise > allowed:
        broken.append(f"V of (17) rises by {outcome.energy_rise:.3g}, more than integration explains ({allowed:.3g})")
    return broken
