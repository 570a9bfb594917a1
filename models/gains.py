"""The controller's numbers: five gains per vehicle, and the saturation scales."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from .arrays import Array
from .saturation import Saturation

GAIN_NAMES = ("p_v", "d_v", "p_omega", "d_omega", "k_alpha")


@dataclass(frozen=True, eq=False)
class Gains:
    """The gains of (7), (9) and (11), all positive, in any one number type, and the scales of (7)-(10)."""

    p_v: Array  # (N,), N, proportional gain of (7)
    d_v: Array  # (N,), N, damping gain of (7)
    p_omega: Array  # (N,), N m, proportional gain of (9)
    d_omega: Array  # (N,), N m, damping gain of (9); bounded below by (15) under the paper's conditions
    k_alpha: Array  # (N,), N m, gain of the excitation term (11)
    saturation: Saturation = field(default_factory=Saturation)

    def map(self, convert: Callable[[Array], Array]) -> Gains:
        """The same gains and scales with every array converted."""
        gains = {name: convert(getattr(self, name)) for name in GAIN_NAMES}
        return Gains(**gains, saturation=self.saturation.map(convert))

    def local(self) -> Gains:
        """The unit-scale gains with the same linearisation at the goal, (N,)."""
        scale = self.saturation
        return Gains(
            p_v=self.p_v / scale.position,
            d_v=self.d_v / scale.speed,
            p_omega=self.p_omega / scale.heading,
            d_omega=self.d_omega / scale.turn_rate,
            k_alpha=self.k_alpha / scale.position,
        )
