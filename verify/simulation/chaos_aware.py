"""CVODES at the accuracy that a start needs: loose for calm motion, at the limit of doubles for chaotic motion.

Far from the goal the closed loop can be chaotic: under fast gains a difference in the initial state of the paper's
fleet grows by a factor of 1e6 to 1e12 during the transient, and integration errors grow with it. Near the goal the
motion contracts.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...models.equations import State
from ...models.tolerance import Tolerance
from .closed_loop import ClosedLoop, Floats
from .integrators import Adams, Cvodes, Integrator

TEST_TOLERANCES = (1e-5, 1e-6)  # of the two runs that tell whether a start is chaotic
NOT_CHAOTIC = 0.05  # m, largest difference of these two runs; the loose integration then errs by less than 1 mm
TRANSIENT_PIECE = 20.0  # s between two tests whether the transient is over
TRANSIENT_TOLERANCE = 1e-15
COMPARISON_TOLERANCE = 1e-12  # of a second transient run; the difference tells how reliable the first one is
TAIL = Tolerance(0.1, 0.1)  # the transient ends where all vehicles are this close to the formation


class ChaosAware(Integrator):
    """Backward differentiation at `tolerance`; chaotic starts use Adams formulas until the transient is over.

    `sensitivity` is the largest distance, m, between two accurate runs of the last start. If it is large, the run
    depends on rounding, and its settling time means nothing.
    """

    def __init__(self, loop: ClosedLoop, *, step: float, piece: float, tolerance: float) -> None:
        """Build all integrators; `piece` (s) is for the tail, and the length of the test runs."""
        super().__init__(loop, step=step, piece=piece, tolerance=tolerance)
        transient = max(step, min(piece, TRANSIENT_PIECE))
        self._tests = [Cvodes(loop, step=step, piece=piece, tolerance=loose) for loose in TEST_TOLERANCES]
        self._transient = Adams(loop, step=step, piece=transient, tolerance=TRANSIENT_TOLERANCE)
        self._comparison = Adams(loop, step=step, piece=transient, tolerance=COMPARISON_TOLERANCE)
        self._tail = Cvodes(loop, step=step, piece=piece, tolerance=tolerance)
        self.sensitivity = 0.0

    def pieces(self, start: State, begin: float = 0.0) -> Iterator[tuple[Floats, State]]:
        """See `Integrator`."""
        first, second = (next(test.pieces(start, begin))[1] for test in self._tests)
        self.sensitivity = _distance(first, second)
        if self.sensitivity > NOT_CHAOTIC:
            self.sensitivity, state = 0.0, start
            pairs = zip(self._transient.pieces(start, begin), self._comparison.pieces(start, begin), strict=False)
            for (t, states), (_, compared) in pairs:
                self.sensitivity = max(self.sensitivity, _distance(states, compared))
                yield t, states
                begin, state = float(t[-1]), State(*(column[-1] for column in states))
                if self.loop.excess(state, TAIL) < 1:
                    break
            start = state
        yield from self._tail.pieces(start, begin)

    def between(self, t: float, state: State) -> tuple[Floats, State]:
        """See `Integrator`."""
        return self._transient.between(t, state)


def _distance(one: State, other: State) -> float:
    """The largest distance between two runs of a fleet, (K, N) each, m."""
    return float(np.hypot(one.x - other.x, one.y - other.y).max())
