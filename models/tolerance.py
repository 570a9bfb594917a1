"""What counts as settled."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Tolerance:
    """What counts as settled: every vehicle within both, from that time on."""

    position: float = 0.1  # m, Euclidean
    heading: float = 0.1  # rad, not modulo 2 pi
