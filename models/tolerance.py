"""The tolerance within which a fleet counts as settled."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Tolerance:
    """Settled: from some time on every vehicle is within both tolerances."""

    position: float = 0.1  # m, Euclidean
    heading: float = 0.1  # rad, not modulo 2 pi
