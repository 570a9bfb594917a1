"""Rollouts of the closed loop from many starts under many gains at once, side by side in NumPy arrays.

Each rollout is a column with its own gains, frequency of psi, time and step. In single precision and to two digits they
rank candidates; `verify` integrates a design anew.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import RK23

from ..models.deadline import Deadline
from ..models.equations import Plant, State, closed_loop
from ..models.excitation import Excitation
from ..models.gains import GAIN_NAMES, Gains
from ..models.ops import turning_ops
from ..models.tolerance import Tolerance

Array = NDArray[Any]
Single = np.float32


class Accuracy(NamedTuple):
    """The error that a step may have, in the root mean square over a column, and how long it may be."""

    relative: float
    absolute: float  # in units of the column
    longest: float  # s


# Enough to rank: test_what_ranks_is_accurate_enough compares the mean settling time with that at tolerances of 1e-8.
ACCURACY = Accuracy(1e-2, 1e-3, 2.0)
FIRST_STEP, SHORTEST_STEP = 0.05, 1e-5  # s
SAFETY, SHRINK, GROW = 0.9, 0.2, 4.0
VEHICLES = 8192  # side by side: more leave the cache
BETWEEN = 8  # steps between two looks at what is done
MAX_STEPS = 100_000  # of one rollout
SECONDS = 600.0  # of wall clock for all
PIECE = 15.0  # s, or a period of psi: a fleet that stays settled for so long counts as settled


class Trial(NamedTuple):
    """Gains (floats, (N,)) and the excitation they go with; trials of one batch differ in psi's frequency alone."""

    gains: Gains
    excitation: Excitation


class Settling(NamedTuple):
    """What one rollout says."""

    time: float  # s, from which all vehicles stay within the tolerance; inf where not by the horizon
    excess: float  # the largest error over its tolerance at the end
    end: float  # s, when the rollout ended
    final: State  # then, (N,) each
    steps: int  # of integration that it took


def settle_all(
    plant: Plant,
    trials: Sequence[Trial],
    starts: Sequence[State],
    horizon: float,
    tolerance: Tolerance,
    hopeless: float = math.inf,
    steps: int = MAX_STEPS,
) -> list[list[Settling | None]]:
    """How the fleet settles under every trial from every start, by the horizon and in so many steps.

    None stands where the integrator gave up, and where a trial was: once its mean settling time is known to be
    beyond `hopeless` (s), what still runs of it is left. A rollout does not depend on those beside it.
    """
    batch, deadline = _Batch(plant, trials, starts, horizon, tolerance, hopeless, steps), Deadline(SECONDS)
    while batch.refill() and not deadline.passed:
        for _ in range(BETWEEN):
            batch.step()
        batch.look()
    return [[batch.found.get((i, k)) for k in range(len(starts))] for i in range(len(trials))]


class Columns:
    """Initial value problems side by side, each with its own time and step, by Bogacki and Shampine's pair."""

    def __init__(self, rate: Callable[[Array, Array], Array], t: Array, y: Array, h: Array, accuracy: Accuracy) -> None:
        """Begin at the times t (B,) and values y (..., B) with steps h (B,), s; `rate(t, y)` gives y'."""
        self.rate, self.t, self.y, self.h = rate, t, y, h
        self._accuracy = accuracy
        self.slope = rate(t, y)

    def step(self) -> Array:
        """Try a step of every column; which were taken, (B,)."""
        h, slopes = self.h.astype(self.y.dtype), [self.slope]
        for weights, share in zip([*_STAGES, _SOLUTION], _TIMES, strict=True):
            new = _sum(weights, slopes)
            new *= h
            new += self.y
            slopes.append(self.rate(self.t + share * self.h, new))
        error = _sum(_ERROR, slopes)
        error *= h
        size = self._error(error, new)
        taken = size <= 1
        self.t = np.where(taken, self.t + self.h, self.t)
        self.y, self.slope = np.where(taken, new, self.y), np.where(taken, slopes[-1], slopes[0])
        self.h = np.minimum(self.h * np.clip(SAFETY * size ** (-1 / 3), SHRINK, GROW), self._accuracy.longest)
        return taken

    def _error(self, error: Array, new: Array) -> Array:
        """The error of a step over what is admitted, (B,); huge where it is not a number."""
        admitted = np.abs(new)
        admitted *= self._accuracy.relative
        admitted += self._accuracy.absolute
        error /= admitted
        error *= error
        mean = np.sqrt(_column_means(error))
        bounded: Array = np.clip(np.nan_to_num(mean, nan=1e3, posinf=1e3), 1e-6, 1e3)
        return bounded


_TIMES = (*RK23.C[1:], 1.0)
_STAGES = [row[:i].astype(Single) for i, row in enumerate(RK23.A[1:], 1)]
_SOLUTION, _ERROR = RK23.B.astype(Single), RK23.E.astype(Single)


def _sum(weights: Array, terms: Sequence[Array]) -> Array:
    (weight, term), *rest = [(weight, term) for weight, term in zip(weights, terms, strict=True) if weight]
    total: Array = weight * term
    for weight, term in rest:
        total += weight * term
    return total


def _column_means(values: Array) -> Array:
    """The mean of every column (..., B), in an order of summation that does not depend on what stands beside it."""
    rows = np.ascontiguousarray(values).reshape(-1, values.shape[-1])
    if rows.shape[1] == 1:
        rows = np.repeat(rows, 2, axis=1)
    means: Array = np.mean(rows, axis=0)[: values.shape[-1]]
    return means


class _Batch:
    """The columns at work, those that wait, and what has been found."""

    def __init__(
        self,
        plant: Plant,
        trials: Sequence[Trial],
        starts: Sequence[State],
        horizon: float,
        tolerance: Tolerance,
        hopeless: float,
        steps: int,
    ) -> None:
        self.found: dict[tuple[int, int], Settling] = {}  # by trial and start
        self._plant, self._horizon, self._hopeless = plant.map(_single), horizon, hopeless * len(starts)
        self._most = steps
        self._width = max(1, VEHICLES // plant.graph.vehicles)
        self._ops = turning_ops(plant.graph, Single)
        self._gains = _stacked(GAIN_NAMES, [trial.gains for trial in trials])
        self._starts = _stacked(State._fields, starts)
        self._psi = replace(trials[0].excitation, frequency=Fraction(1)).map(Single)
        self._frequency = np.array([float(trial.excitation.frequency) for trial in trials])
        self._hold = np.maximum(PIECE, 2 * math.pi / self._frequency)
        reference = self._plant.offset_x + self._plant.leader_x, self._plant.offset_y + self._plant.leader_y
        self._goal = np.stack([*reference, np.broadcast_to(self._plant.leader_theta, reference[0].shape)])[..., None]
        within = [tolerance.position, tolerance.position, tolerance.heading]
        self._within = _single(within)[:, None, None]
        # Start after start, so that what is hopeless shows before all of its starts are run.
        self._trial = np.tile(np.arange(len(trials)), len(starts))
        self._start = np.repeat(np.arange(len(starts)), len(trials))
        self._outside = np.zeros(len(self._trial))  # s, when each was last seen outside the tolerance
        self._waiting = np.arange(len(self._trial))
        self._at = self._waiting[:0]  # the number of each column
        self._columns = self._side_by_side(np.zeros(0), self._starts[..., :0], np.zeros(0))
        self._steps = self._excess = np.zeros(0)

    def refill(self) -> bool:
        """Let columns that wait take the places that are free; whether anything is at work."""
        free = self._width - len(self._at)
        if free > self._width // 4 or not len(self._at):
            new, self._waiting = self._waiting[:free], self._waiting[free:]
            if len(new):
                self._renew(np.ones(len(self._at), dtype=bool), new)
        return bool(len(self._at))

    def step(self) -> None:
        """One step of every column, and a look at where it is and where it was halfway."""
        columns = self._columns
        t, pose, slope = columns.t, columns.y[:3], columns.slope[:3]
        taken = columns.step()
        new = columns.y[:3]
        h = (columns.t - t).astype(Single)
        halfway = (pose + new) / 2 + h / 8 * (slope - columns.slope[:3])
        self._excess = self._over(new)
        self._steps += 1
        last = np.where(taken & (self._over(halfway) > 1), (t + columns.t) / 2, self._outside[self._at])
        self._outside[self._at] = np.where(self._excess > 1, columns.t, last)

    def look(self) -> None:
        """Take out what has settled, what has not by the horizon, what gave up, and what is hopeless."""
        columns, trial = self._columns, self._trial[self._at]
        last = self._outside[self._at]
        settled = columns.t - last > self._hold[trial]
        late = (columns.t >= self._horizon) | (self._steps >= self._most)
        stalled = columns.h < SHORTEST_STEP
        for place in np.flatnonzero((settled | late) & ~stalled):
            key = int(trial[place]), int(self._start[self._at[place]])
            time = float(last[place]) if settled[place] else math.inf
            final = State(*columns.y[..., place].astype(float))
            excess, end, steps = float(self._excess[place]), float(columns.t[place]), int(self._steps[place])
            self.found[key] = Settling(time, excess, end, final, steps)
        self._outside[self._at[stalled | (late & ~settled)]] = self._horizon
        least = np.bincount(self._trial, np.minimum(self._outside, self._horizon))
        hopeless = least > self._hopeless
        self._waiting = self._waiting[~hopeless[self._trial[self._waiting]]]
        stay = ~(settled | late | stalled | hopeless[trial])
        if not stay.all():
            self._renew(stay, self._waiting[:0])

    def _renew(self, stay: Array, new: Array) -> None:
        """Go on with the columns that stay, and new ones beside them."""
        old, zeros = self._columns, np.zeros(len(new))
        self._at = np.concatenate([self._at[stay], new])
        t, h = np.concatenate([old.t[stay], zeros]), np.concatenate([old.h[stay], zeros + FIRST_STEP])
        y = np.concatenate([old.y[..., stay], self._starts[..., self._start[new]]], axis=-1)
        self._columns = self._side_by_side(t, y, h)
        self._steps = np.concatenate([self._steps[stay], zeros])
        self._excess = self._over(y[:3])

    def _side_by_side(self, t: Array, y: Array, h: Array) -> Columns:
        """(13)-(14) for the columns at work, with t (B,) and y (5, N, B)."""
        trial = self._trial[self._at]
        gains = Gains(*(np.ascontiguousarray(column[:, trial]).T for column in self._gains))
        frequency = self._frequency[trial]
        # As large as the states, (B, N) or (B, E), for the equations alone: NumPy is twice as slow where it broadcasts.
        plant = self._plant.map(lambda v: np.repeat(v[:, None], len(trial), axis=1).T if v.ndim else v)

        def rate(t: Array, y: Array) -> Array:
            # A phase of many periods has no digits left in single precision.
            phase = np.remainder(t * frequency, 2 * math.pi).astype(Single)[:, None]
            state = State(*(column.T for column in y))
            rates = closed_loop(self._ops, plant, gains, self._psi, phase, state)
            return np.stack([column.T for column in rates])

        return Columns(rate, t, y, h, ACCURACY)

    def _over(self, pose: Array) -> Array:
        """The largest error of poses (3, N, B) over its tolerance, (B,)."""
        away = (pose - self._goal) / self._within
        away *= away
        return np.asarray(np.sqrt(np.maximum(away[0] + away[1], away[2]).max(axis=0)), dtype=float)


def _single(values: Any) -> Array:
    return np.asarray(values, dtype=Single)


def _stacked(names: Sequence[str], items: Sequence[Any]) -> Array:
    """The columns of those names of every item, (names, N, items)."""
    columns = [[np.asarray(getattr(item, name), dtype=Single) for item in items] for name in names]
    return np.ascontiguousarray(np.moveaxis(np.array(columns), 1, 2))
