"""The five gains of the controller, one number per vehicle."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields

from .arrays import Array


@dataclass(frozen=True, eq=False)
class Gains:
    """The gains of (7), (9) and (11); all positive, in any one number type."""

    p_v: Array  # (N,), N, proportional gain of (7)
    d_v: Array  # (N,), N, damping gain of (7)
    p_omega: Array  # (N,), N m, proportional gain of (9)
    d_omega: Array  # (N,), N m, damping gain of (9); bounded below by (15) under the paper's conditions
    k_alpha: Array  # (N,), N m, gain of the excitation term (11)

    def map(self, convert: Callable[[Array], Array]) -> Gains:
        """The same gains with every array converted."""
        return Gains(*(convert(getattr(self, name)) for name in GAIN_NAMES))


GAIN_NAMES: tuple[str, ...] = tuple(field.name for field in fields(Gains))
