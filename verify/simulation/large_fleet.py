"""The engine for large fleets: Dormand and Prince's method on flat arrays, O(N + E) time and memory.

The right-hand side is `models.equations` over `flat_ops` (docs/performance.md). The stepper is the one that ranks
designs, here in double precision.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ...models.algebra.ops import flat_ops, unbounded
from ...models.equations import State, closed_loop
from ...models.errors import UndecidedError
from ...synthesis.rollouts.runge_kutta import DORMAND_PRINCE, Accuracy, Rate, Stepper
from .closed_loop import ClosedLoop, Floats
from .integrators import Explicit

FIRST_STEP = 1e-4  # s
MAX_STEPS = 10_000_000
SMALLEST_STEP = 1e-12  # s


class Dopri5(Explicit):
    """Dormand and Prince's method with an error per step below `tolerance` in the root mean square."""

    def __init__(self, loop: ClosedLoop, *, step: float, piece: float, tolerance: float) -> None:
        """Set up the right-hand side."""
        super().__init__(loop, step=step, piece=piece, tolerance=tolerance)
        self.rate = rate_function(loop)
        self.steps = 0  # taken so far
        self._h = FIRST_STEP

    def solve(self, begin: float, x: Floats, times: Floats) -> Floats:
        """See `Explicit`."""
        rows, found, end = np.empty((len(times), len(x))), 0, float(times[-1])
        stepper = self._stepper(begin, x, min(self._h, end - begin))
        for _ in range(MAX_STEPS):
            t, h = float(stepper.t[0]), float(stepper.h[0])
            if t + 1.0001 * h >= end:
                stepper.h[0] = h = end - t
            stepper.attempt()
            if taken := bool(stepper.taken[0]):
                while found < len(times) and times[found] <= t + h * (1 + 1e-12):
                    rows[found] = _inside(stepper, (times[found] - t) / h)
                    found += 1
            stepper.accept()
            self.steps += taken
            if found == len(times):
                return rows
            self._h = float(stepper.h[0])
            if not self._h > SMALLEST_STEP:  # also if the error is not a number
                break
        raise UndecidedError(f"the scale engine gave up at t = {t:g} s: its step fell to {self._h:.1g} s")

    def _stepper(self, begin: float, x: Floats, h: float) -> Stepper:
        def problem(state: Floats, slopes: Floats) -> Rate:
            return lambda t: self.rate(float(t[0]), state[:, 0], slopes[:, 0])

        accuracy = Accuracy(self.tolerance, self.tolerance, math.inf)
        return Stepper(DORMAND_PRINCE, problem, np.array([begin]), x[:, None], np.array([h]), accuracy)


def _inside(stepper: Stepper, share: float) -> Floats:
    """The solution at a share of the last step."""
    return np.asarray((stepper.new if share >= 1 else stepper.inside(share))[:, 0])


def rate_function(loop: ClosedLoop) -> Callable[[float, Floats, Floats], None]:
    """(13)-(14) over flat arrays: rate(t, x, out) fills `out` (5 N,), the columns of the state end to end."""
    ops = flat_ops(loop.plant.graph)
    ops = ops if loop.bounded else unbounded(ops)
    n = loop.vehicles

    def rate(t: float, x: Floats, out: Floats) -> None:
        state = State(*(x[i * n : (i + 1) * n] for i in range(5)))
        for i, column in enumerate(closed_loop(ops, loop.plant, loop.gains, loop.excitation.value(ops, t), state)):
            out[i * n : (i + 1) * n] = column

    return rate
