"""The engine for large fleets: an explicit Runge-Kutta method of order 5(4) on flat arrays, O(N + E) time and memory.

The right-hand side is `models.equations` over `flat_ops`; docs/performance.md says why NumPy and not JAX or numba.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...models.algebra.ops import flat_ops, unbounded
from ...models.equations import State, closed_loop
from ...models.errors import UndecidedError
from .closed_loop import ClosedLoop, Floats
from .integrators import Explicit

# Dormand and Prince (1980); rows of the Butcher matrix, the last row is the solution of order 5.
_A = (
    (1 / 5,),
    (3 / 40, 9 / 40),
    (44 / 45, -56 / 15, 32 / 9),
    (19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729),
    (9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656),
    (35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84),
)
_C = (1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0)
_ERROR = np.array([71 / 57600, 0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40])
# Shampine's continuous extension of order 4.
_DENSE = np.array(
    [
        -12715105075 / 11282082432,
        0,
        87487479700 / 32700410799,
        -10690763975 / 1880347072,
        701980252875 / 199316789632,
        -1453857185 / 822651844,
        69997945 / 29380423,
    ]
)
SAFETY, SHRINK, GROW = 0.9, 0.2, 5.0
FIRST_STEP = 1e-4  # s
MAX_STEPS = 10_000_000
SMALLEST_STEP = 1e-12  # s


# einsum and not dot: a BLAS would start threads, which on a busy machine cost ten times what they bring.


class Dopri5(Explicit):
    """Dormand and Prince's method with an error per step below `tolerance` in the root mean square."""

    def __init__(self, loop: ClosedLoop, *, step: float, piece: float, tolerance: float) -> None:
        """Set up the arrays that every step uses again."""
        super().__init__(loop, step=step, piece=piece, tolerance=tolerance)
        self.rate = rate_function(loop)
        self.steps = 0  # taken so far, for whoever wants to know
        self._h = FIRST_STEP
        self._stages = np.empty((7, 5 * loop.vehicles))

    def solve(self, begin: float, x: Floats, times: Floats) -> Floats:
        """See `Explicit`."""
        rows, found, t, k = np.empty((len(times), len(x))), 0, begin, self._stages
        self.rate(t, x, k[0])
        h, end = min(self._h, float(times[-1]) - t), float(times[-1])
        for _ in range(MAX_STEPS):
            if t + 1.0001 * h >= end:
                h = end - t
            new = self._stages_of(t, x, h)
            size = self._error(x, new, h)
            if size <= 1:
                while found < len(times) and times[found] <= t + h * (1 + 1e-12):
                    rows[found] = self._inside(x, new, h, (times[found] - t) / h)
                    found += 1
                t, x, self.steps = t + h, new, self.steps + 1
                k[0] = k[6]  # first same as last
                if found == len(times):
                    return rows
            h *= min(GROW, max(SHRINK, SAFETY * size**-0.2)) if size > 0 else GROW
            self._h = h
            if not h > SMALLEST_STEP:  # also where the error is not a number
                break
        raise UndecidedError(f"the scale engine gave up at t = {t:g} s: its step fell to {h:.1g} s")

    def _stages_of(self, t: float, x: Floats, h: float) -> Floats:
        k, new = self._stages, x
        for i, (row, c) in enumerate(zip(_A, _C, strict=True), 1):
            new = np.einsum("i,ij->j", h * np.array(row), k[:i])
            new += x
            self.rate(t + c * h, new, k[i])
        return new

    def _error(self, x: Floats, new: Floats, h: float) -> float:
        scale = np.maximum(np.abs(x), np.abs(new))
        scale += 1
        error = np.einsum("i,ij->j", (h / self.tolerance) * _ERROR, self._stages)
        error /= scale
        return float(np.sqrt(np.einsum("i,i", error, error) / len(error)))

    def _inside(self, x: Floats, new: Floats, h: float, s: float) -> Floats:
        """The solution at the fraction s of the step."""
        if s >= 1:
            return new
        k, change = self._stages, new - x
        left = h * k[0] - change
        right = change - h * k[6] - left
        return np.asarray(
            x + s * (change + (1 - s) * (left + s * (right + (1 - s) * h * np.einsum("i,ij->j", _DENSE, k))))
        )


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
