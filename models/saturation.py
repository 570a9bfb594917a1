"""The saturation scales: each divides the argument of one tanh of the controller."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields

import numpy as np

from .arrays import Array


@dataclass(frozen=True, eq=False)
class Saturation:
    """The scales of (7)-(10), all positive, in any one number type; all 1 is the controller as the paper prints it.

    `position` and `heading` belong to the whole network: an edge term must look the same from both of its ends.
    """

    position: Array = 1  # l, m, divides z in (8)
    heading: Array = 1  # rho, rad, divides theta in (10)
    speed: Array = 1  # s_i, m/s, (N,) or one number for all, divides v in (7)
    turn_rate: Array = 1  # o_i, rad/s, (N,) or one number for all, divides omega in (9)

    def map(self, convert: Callable[[Array], Array]) -> Saturation:
        """The same scales, each converted."""
        return Saturation(*(convert(getattr(self, name)) for name in SCALE_NAMES))

    def columns(self, vehicles: int) -> dict[str, Array]:
        """Every scale by name, one entry per vehicle, (N,)."""
        return {name: np.broadcast_to(getattr(self, name), vehicles) for name in SCALE_NAMES}

    @property
    def unit(self) -> bool:
        """Whether all scales are 1: the paper's controller."""
        return all(bool(np.all(np.equal(getattr(self, name), 1))) for name in SCALE_NAMES)


SCALE_NAMES: tuple[str, ...] = tuple(field.name for field in fields(Saturation))
