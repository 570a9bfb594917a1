"""CVODES as accurate as a start asks for: economical where the motion is calm, at the limit of doubles where it is not.

Far from the goal the closed loop can be chaotic: under fast gains a disturbance of the paper's fleet grows a million
to a million million times before it has gathered, and with it every error of integration. Later the motion contracts.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...models.equations import State
from .integrators import Adams, Cvodes, Integrator
from .loop import Floats, Loop
from .observer import distances

ROUGH_TOLERANCES = (1e-5, 1e-6)  # of the two runs that tell whether a start is calm
CALM = 0.05  # m, by which they may differ there: the economical run then errs by some tenths of a millimetre
OPENING = 20.0  # s, between two looks at whether the fleet has gathered
OPENING_TOLERANCE = 1e-15
SECOND_TOLERANCE = 1e-12  # of a second opening, which tells how far the first can be relied on
GATHERED = 0.1  # m and rad, from all places: what is left is small against the usual tolerances


class Staged(Integrator):
    """Backward differentiation at `tolerance`; before that, where a start is not calm, Adams until it has gathered."""

    def __init__(self, loop: Loop, *, step: float, piece: float, tolerance: float) -> None:
        """Build all stages; `piece` is that of the economical one, and the time over which a start must be calm."""
        super().__init__(loop, step=step, piece=piece, tolerance=tolerance)
        opening = max(step, min(piece, OPENING))
        self._rough = [Cvodes(loop, step=step, piece=piece, tolerance=rough) for rough in ROUGH_TOLERANCES]
        self._opening = Adams(loop, step=step, piece=opening, tolerance=OPENING_TOLERANCE)
        self._second = Adams(loop, step=step, piece=opening, tolerance=SECOND_TOLERANCE)
        self._cruise = Cvodes(loop, step=step, piece=piece, tolerance=tolerance)
        self.apart = 0.0  # m, by which two runs of the last start ever differed; beyond some, nobody knows the true one

    def pieces(self, start: State, begin: float = 0.0) -> Iterator[tuple[Floats, State]]:
        """See `Integrator`."""
        one, other = (next(rough.pieces(start, begin))[1] for rough in self._rough)
        self.apart = _distance(one, other)
        if self.apart > CALM:
            self.apart, state = 0.0, start
            pairs = zip(self._opening.pieces(start, begin), self._second.pieces(start, begin), strict=False)
            for (t, states), (_, second) in pairs:
                self.apart = max(self.apart, _distance(states, second))
                yield t, states
                begin, state = float(t[-1]), State(*(column[-1] for column in states))
                if self._gathered(state):
                    break
            start = state
        yield from self._cruise.pieces(start, begin)

    def between(self, t: float, state: State) -> tuple[Floats, State]:
        """See `Integrator`."""
        return self._opening.between(t, state)

    def _gathered(self, state: State) -> bool:
        position, heading = distances(self.loop, state)
        return bool(max(position.max(), heading.max()) < GATHERED)


def _distance(one: State, other: State) -> float:
    """The largest distance between two runs of a fleet, (K, N) each, m."""
    return float(np.hypot(one.x - other.x, one.y - other.y).max())
