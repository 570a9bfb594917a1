"""CVODES in two stages: very accurate while the fleet gathers, economical afterwards.

Far from the goal the closed loop can be chaotic: under fast gains a disturbance of the paper's fleet grows a million
to a million million times within 20 s, and with it every error of integration. Later the motion contracts.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..models.equations import State
from .integrators import Adams, Cvodes, Integrator
from .loop import Floats, Loop

OPENING = 20.0  # s
OPENING_TOLERANCE = 1e-12


class Staged(Integrator):
    """Adams at OPENING_TOLERANCE up to about OPENING, then backward differentiation at `tolerance`."""

    def __init__(self, loop: Loop, *, step: float, piece: float, tolerance: float) -> None:
        """Build both stages; `piece` is that of the second."""
        super().__init__(loop, step=step, piece=piece, tolerance=tolerance)
        opening = max(step, min(piece, OPENING))
        self._opening = Adams(loop, step=step, piece=opening, tolerance=OPENING_TOLERANCE)
        self._rough = Cvodes(loop, step=step, piece=opening, tolerance=tolerance)
        self._cruise = Cvodes(loop, step=step, piece=piece, tolerance=tolerance)

    def pieces(self, start: State, begin: float = 0.0) -> Iterator[tuple[Floats, State]]:
        """See `Integrator`."""
        t, state = next(self._opening.pieces(start, begin))
        yield t, state
        yield from self._cruise.pieces(_last(state), float(t[-1]))

    def between(self, t: float, state: State) -> tuple[Floats, State]:
        """See `Integrator`."""
        return self._opening.between(t, state)

    def sensitivity(self, start: State, opening: State) -> float:
        """How far the opening at `tolerance` ends from the accurate one (K, N), m: small where a run is determined.

        The accurate run's own error is about OPENING_TOLERANCE / tolerance times as large, as long as this is small.
        """
        _, rough = next(self._rough.pieces(start))
        end = min(len(rough.x), len(opening.x)) - 1
        return float(np.hypot(rough.x[end] - opening.x[end], rough.y[end] - opening.y[end]).max())


def _last(state: State) -> State:
    return State(*(column[-1] for column in state))
