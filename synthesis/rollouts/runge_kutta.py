"""One Runge-Kutta stepper: initial value problems side by side, each with its own time and step, for any tableau.

The rollouts of a design solve many problems in single precision with Bogacki and Shampine's pair. The engine for large
fleets solves one in double precision with Dormand and Prince's.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.integrate import RK23, RK45

from .compiler import Compiled, Double, Single, compiled, pointer
from .loops import At, LoopNest

Array = NDArray[Any]
Rate = Callable[[Array], None]  # called with the times (B,), s; writes the slopes of its Problem
Problem = Callable[[Array, Array], Rate]  # of values and slopes, (..., B); both arrays must not move in memory

SAFETY, SHRINK = 0.9, 0.2
SMALLEST, LARGEST = 1e-6, 1e3  # the error ratio is clamped to this range


@dataclass(frozen=True)
class Accuracy:
    """The error that a step may have, in the root mean square over a column, and how long it may be."""

    relative: float
    absolute: float  # in the units of each value
    longest: float  # s


@dataclass(frozen=True)
class Tableau:
    """An embedded pair whose last slope is the first of the next step, with its continuous extension."""

    times: tuple[float, ...]  # of the stages after the first, shares of the step
    stages: tuple[tuple[float, ...], ...]  # weights of the slopes so far; those of the last stage give the solution
    error: tuple[float, ...]  # weights of all slopes in the error
    dense: tuple[tuple[float, ...], ...]  # per slope, coefficients of s, s^2, ... at the share s of the step
    grow: float  # largest factor by which a step may grow
    real: Any  # number type of the values


def _tableau(method: Any, grow: float, real: Any) -> Tableau:
    """SciPy's tableau of a method."""
    stages = [*(row[:i] for i, row in enumerate(method.A[1:], 1)), method.B]
    return Tableau(
        times=(*method.C[1:].tolist(), 1.0),
        stages=tuple(tuple(row.tolist()) for row in stages),
        error=tuple(method.E.tolist()),
        dense=tuple(tuple(row) for row in method.P.tolist()),
        grow=grow,
        real=real,
    )


BOGACKI_SHAMPINE = _tableau(RK23, 4.0, Single)
DORMAND_PRINCE = _tableau(RK45, 5.0, Double)


def step_loops(tableau: Tableau, relative: float, absolute: float) -> dict[str, LoopNest]:
    """What a step does beside finding slopes: `stage0`, ..., `judge`, `control`, `accept`.

    They read and write y, new, units (absolute errors are measured in them) and slopes (all of them) by value and
    column, and h, error, taken, next_h by column; constants has 1 / (values of a column) and the longest step.
    """
    y, new, h, taken, error, units = (ca.SX.sym(name) for name in ("y", "new", "h", "taken", "error", "units"))
    slopes, constants = ca.SX.sym("slopes", 1 + len(tableau.times)), ca.SX.sym("constants", 2)
    each, column = At.EACH, At.COLUMN
    loops = {}
    for k, weights in enumerate(tableau.stages):
        ahead = y + h * ca.dot(slopes[: len(weights)], ca.DM(list(weights)))
        reads = [("y", each), ("h", column), ("slopes", each)]
        loops[f"stage{k}"] = LoopNest(ca.Function("stage", [y, h, slopes], [ahead]), reads, [("new", each)])
    bound = ca.fabs(new) * relative + absolute * units
    wrong = h * ca.dot(slopes, ca.DM(list(tableau.error))) / bound
    loops["judge"] = LoopNest(
        ca.Function("judge", [new, h, slopes, units, error], [error + wrong * wrong]),
        [("new", each), ("h", column), ("slopes", each), ("units", At.ITEM), ("error", column)],
        [("error", column)],
    )
    size = ca.sqrt(error * constants[0])
    size = ca.fmax(ca.if_else(size < LARGEST, size, LARGEST), SMALLEST)  # not a number: the step is far too long
    # The fourth root suits both pairs, and roots are the same on every processor.
    share = ca.fmin(ca.fmax(SAFETY / ca.sqrt(ca.sqrt(size)), SHRINK), tableau.grow)
    loops["control"] = LoopNest(
        ca.Function("control", [error, h, constants], [size <= 1, ca.fmin(h * share, constants[1])]),
        [("error", column), ("h", column), ("constants", At.ITEM)],
        [("taken", column), ("next_h", column)],
    )
    first = ca.if_else(taken, slopes[-1], slopes[0])
    loops["accept"] = LoopNest(
        ca.Function("accept", [y, new, slopes, taken], [ca.if_else(taken, new, y), first]),
        [("y", each), ("new", each), ("slopes", each), ("taken", column)],
        [("y", each), ("slopes", each)],
    )
    return loops


class Stepper:
    """Initial value problems side by side: times t and steps h (B,), values y (..., B)."""

    def __init__(self, tableau: Tableau, problem: Problem, t: Array, y: Array, h: Array, accuracy: Accuracy) -> None:
        """Begin at the times t (B,) and values y (..., B) with steps h (B,), s."""
        real, width = tableau.real, len(t)
        self.t, self.y = t, np.array(y, dtype=real, order="C")
        self.h, self._next = np.array(h, dtype=real), np.array(h, dtype=real)
        self.new = self.y.copy()
        self.slopes = np.empty((1 + len(tableau.times), *self.y.shape), real)
        self.taken = np.ones(width, real)  # 1 where the last step was good enough, else 0
        self._tableau, self._error = tableau, np.zeros(width, real)
        items = self.y[..., :1].size
        arrays = {
            "y": self.y,
            "new": self.new,
            "slopes": self.slopes,
            "h": self.h,
            "next_h": self._next,
            "taken": self.taken,
            "error": self._error,
            "units": np.ones(items, real),
            "constants": np.array([[1 / max(1, items)], [accuracy.longest]], real),
        }
        pointers = {name: pointer(array, real) for name, array in arrays.items()}
        loops = _loops(tableau, accuracy.relative, accuracy.absolute)
        bound = {name: loop.bind(1 if name == "control" else items, width, pointers) for name, loop in loops.items()}
        self._stages = [bound[f"stage{k}"] for k in range(len(tableau.times))]
        self._judge, self._control, self._accept = bound["judge"], bound["control"], bound["accept"]
        self._rates = [problem(self.new, slope) for slope in self.slopes[1:]]
        self._rates[-1](t)
        self.slopes[0] = self.slopes[-1]

    def step(self) -> None:
        """Try a step of every column, and accept those that are accurate enough."""
        self.attempt()
        self.accept()

    def attempt(self) -> None:
        """Try a step of every column: `new` is where it leads, `taken` says whether it is good enough."""
        for stage, rate, share in zip(self._stages, self._rates, self._tableau.times, strict=True):
            stage()
            rate(self.t + share * self.h)
        self._error[...] = 0
        self._judge()
        self._control()

    def accept(self) -> None:
        """Accept the steps that were good enough, and adapt all step lengths."""
        self._accept()
        self.t = self.t + self.taken * self.h
        self.h[...] = self._next

    def inside(self, share: float) -> Array:
        """The solution (..., B) at a share of the last step that was tried, before it is accepted."""
        weights = np.array(self._tableau.dense) @ share ** np.arange(1, 1 + len(self._tableau.dense[0]))
        # einsum and not dot: a BLAS would start threads, which on a busy machine cost ten times what they bring.
        return np.asarray(self.y + self.h * np.einsum("k,k...->...", weights, self.slopes))


@cache
def _loops(tableau: Tableau, relative: float, absolute: float) -> dict[str, Compiled]:
    return compiled(step_loops(tableau, relative, absolute), tableau.real)
