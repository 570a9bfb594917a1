"""Initial value problems side by side, each with its own time and step, by Bogacki and Shampine's pair."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.integrate import RK23

from .compiler import At, Compiled, LoopNest, Single, compiled, pointer

Array = NDArray[Any]
Rate = Callable[[Array], None]  # of the times (B,), s: writes the slopes where it was told to
Problem = Callable[[Array, Array], Rate]  # what finds the slopes (..., B) of values (..., B), both to stay in place

SAFETY, SHRINK, GROW = 0.9, 0.2, 4.0
TIMES = (*RK23.C[1:], 1.0)


class Accuracy(NamedTuple):
    """The error that a step may have, in the root mean square over a column, and how long it may be."""

    relative: float
    absolute: float  # in units of the column
    longest: float  # s


class Columns:
    """Initial value problems side by side: times t and steps h (B,), values y (..., B)."""

    def __init__(self, problem: Problem, t: Array, y: Array, h: Array, accuracy: Accuracy) -> None:
        """Begin at the times t (B,) and values y (..., B) with steps h (B,), s."""
        self.t, self.h, self.y = t, h, np.ascontiguousarray(y, dtype=Single)
        self.new = self.y.copy()
        self.slopes = np.empty((1 + len(TIMES), *self.y.shape), Single)
        self.taken = np.ones(len(t), Single)
        self.step_length = np.empty(len(t), Single)
        self._longest, self._error = accuracy.longest, np.zeros(len(t), Single)
        self._items = self.y[..., :1].size
        loops = _loops(accuracy)
        arrays = {"y": self.y, "new": self.new, "slopes": self.slopes, "h": self.step_length, "taken": self.taken}
        pointers = {name: pointer(array) for name, array in {**arrays, "error": self._error}.items()}
        bound = {name: loop.bind(self._items, len(t), pointers) for name, loop in loops.items()}
        self._stages = [bound[f"stage{k}"] for k in range(len(TIMES))]
        self._judge, self._accept = bound["judge"], bound["accept"]
        self._rates = [problem(self.new, slope) for slope in self.slopes[1:]]
        self._rates[-1](t)
        self.slopes[0] = self.slopes[-1]

    def step(self) -> None:
        """Try a step of every column, and go on with those that are good enough."""
        self.attempt()
        self.accept()

    def attempt(self) -> None:
        """Try a step of every column: where it leads and whether it is taken stands in `new` and `taken`."""
        self.step_length[...] = self.h
        for stage, rate, share in zip(self._stages, self._rates, TIMES, strict=True):
            stage()
            rate(self.t + share * self.h)
        self._error[...] = 0
        self._judge()
        # Where it is not a number the step is far too long.
        self._size = np.maximum(np.fmin(np.sqrt(self._error / max(1, self._items)), 1e3), 1e-6)
        self.taken[...] = self._size <= 1

    def accept(self) -> None:
        """Go on with the steps that are taken, and with another length of step."""
        self._accept()
        self.t = self.t + self.taken * self.h
        share = SAFETY * self._size ** Single(-1 / 3)
        self.h = np.minimum(self.h * np.minimum(np.maximum(share, SHRINK), GROW), self._longest)


@cache
def _loops(accuracy: Accuracy) -> dict[str, Compiled]:
    """What a step does beside finding slopes."""
    y, new, h, taken, error = (ca.SX.sym(name) for name in ("y", "new", "h", "taken", "error"))
    slopes = ca.SX.sym("slopes", 1 + len(TIMES))
    each, column = At.EACH, At.COLUMN
    loops = {}
    for k, weights in enumerate([*(row[:i] for i, row in enumerate(RK23.A[1:], 1)), RK23.B]):
        ahead = y + h * ca.dot(slopes[: len(weights)], ca.DM(weights))
        reads = [("y", each), ("h", column), ("slopes", each)]
        loops[f"stage{k}"] = LoopNest(ca.Function("stage", [y, h, slopes], [ahead]), reads, [("new", each)])
    wrong = h * ca.dot(slopes, ca.DM(RK23.E)) / (ca.fabs(new) * accuracy.relative + accuracy.absolute)
    loops["judge"] = LoopNest(
        ca.Function("judge", [new, h, slopes, error], [error + wrong * wrong]),
        [("new", each), ("h", column), ("slopes", each), ("error", column)],
        [("error", column)],
    )
    first = ca.if_else(taken, slopes[-1], slopes[0])
    loops["accept"] = LoopNest(
        ca.Function("accept", [y, new, slopes, taken], [ca.if_else(taken, new, y), first]),
        [("y", each), ("new", each), ("slopes", each), ("taken", column)],
        [("y", each), ("slopes", each)],
    )
    return compiled(loops)
