"""Measures a run point by point: its settling time and its peaks, also between the points.

The grid shows which intervals matter. These are integrated again on a fifty times finer grid.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from ...models.equations import State
from ...models.tolerance import Tolerance
from .closed_loop import ClosedLoop, Floats
from .integrators import Integrator
from .interpolation import interval_peaks, last_above_one
from .settling import Approach, confirmed_by

GRAZING = 0.995  # an interval whose interpolated squared excess passes this is integrated again
TIME_EPSILON = 1e-6  # s, step of the finite difference along the solution

Curve = tuple[Floats, Floats]  # a quantity (K, Q) and its time derivative (1/s)
Place = tuple[float, State]  # a time, s, and the state there, each (N,)


class NamedPeak(NamedTuple):
    """A peak with the name of its vehicle."""

    value: float
    time: float  # s
    vehicle: str


@dataclass(frozen=True)
class Peak:
    """The largest value of a quantity over a run and the fleet."""

    value: float
    time: float  # s
    vehicle: int  # its place in the fleet

    def named(self, names: Sequence[str]) -> NamedPeak:
        """The same peak, with the name of its vehicle."""
        return NamedPeak(self.value, self.time, names[self.vehicle])


@dataclass(frozen=True)
class Outcome:
    """The measurements of one run."""

    settling_time: float  # s; inf if not settled at the end, or settled too late to see that it stays so
    approach: Approach  # how the error moves at the end
    torque_ratio: Peak  # |torque| over its limit
    speed: Peak  # |v|, m/s
    turn_rate: Peak  # |omega|, rad/s
    certified: Peak  # |v| and |omega| divided by the bounds of Lemma L18; 0 where there is no bound
    final_position: float  # m, the largest distance from the formation at the end
    final_heading: float  # rad
    energy_rise: float  # the largest rise of V, (17), between two points of the grid


@dataclass
class _Watch:
    """One quantity and the interval with its largest interpolated peak so far."""

    curve: Callable[[Floats, State, State], Curve]  # times, states, rates
    best: float = -1.0
    place: Place | None = None


@dataclass
class Monitor:
    """Takes in the points of a run; `outcome` then refines the intervals that matter.

    `integrator` made the run and integrates an interval again on a finer grid; its step is the grid's.
    """

    loop: ClosedLoop
    integrator: Integrator
    tolerance: Tolerance
    start: State
    _outside: list[Place] = field(default_factory=list)  # intervals that may hold the last moment outside
    _history: list[tuple[Floats, Floats]] = field(default_factory=list)  # times, largest squared excess, (K,) each
    _energy_rise: float = 0.0
    _refined_steps: dict[float, tuple[Floats, State, State, float]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Begin at the start, at t = 0."""
        self._time, self._state = np.zeros(1), State(*(np.asarray(column)[None] for column in self.start))
        self._watches = {
            "torque_ratio": _Watch(self._torque),
            "speed": _Watch(lambda _t, state, rate: (state.v, rate.v)),
            "turn_rate": _Watch(lambda _t, state, rate: (state.omega, rate.omega)),
            "certified": _Watch(self._certified),
        }
        self._bounds = np.concatenate(self.loop.certified_speeds(self.start))

    def update(self, times: Floats, states: State) -> None:
        """Take in the points (K,), (K, N) that follow the last ones."""
        if not len(times):
            return
        t = np.concatenate([self._time, times])
        state = State(*(np.concatenate(pair) for pair in zip(self._state, states, strict=True)))
        rate = self.loop.rates(t, state)
        for watch in self._watches.values():
            self._look(watch, t, state, rate)
        self._look_outside(t, state, rate)
        self._energy_rise = max(self._energy_rise, float(np.diff(self.loop.translational_energy(state)).max()))
        self._time, self._state = t[-1:], _rows(state, slice(-1, None))

    def outcome(self) -> Outcome:
        """Refine, and return the measurements so far."""
        position, heading = self.loop.distances(self._state)
        return Outcome(
            settling_time=self._settling(),
            approach=self._approach(),
            **{name: self._refined(watch) for name, watch in self._watches.items()},
            final_position=float(position.max()),
            final_heading=float(heading.max()),
            energy_rise=self._energy_rise,
        )

    # -- peaks ---------------------------------------------------------------------------------------------------------

    def _torque(self, t: Floats, state: State, rate: State) -> Curve:
        """Torque divided by its limit; its derivative along the solution by a finite difference."""
        now = self.loop.torque_ratios(t, state)
        ahead = self.loop.torque_ratios(t + TIME_EPSILON, _moved(state, rate, TIME_EPSILON))
        return now, (ahead - now) / TIME_EPSILON

    def _certified(self, _: Floats, state: State, rate: State) -> Curve:
        speeds = np.concatenate([state.v, state.omega], axis=1), np.concatenate([rate.v, rate.omega], axis=1)
        return speeds[0] / self._bounds, speeds[1] / self._bounds

    def _look(self, watch: _Watch, t: Floats, state: State, rate: State) -> None:
        sizes = interval_peaks(*watch.curve(t, state, rate), self.integrator.step).size.max(axis=1)
        k = int(np.argmax(sizes))
        if sizes[k] > watch.best:
            watch.best, watch.place = float(sizes[k]), (float(t[k]), _row(state, k))

    def _refined(self, watch: _Watch) -> Peak:
        """The peak in the watched interval or in the first one, whose transients the grid may not resolve."""
        places = [(0.0, self.start)] + ([watch.place] if watch.place and watch.place[0] > 0 else [])
        return max((self._peak(watch, *place) for place in places), key=lambda peak: peak.value)

    def _peak(self, watch: _Watch, begin: float, state: State) -> Peak:
        t, states, rate, step = self._finer(begin, state)
        top = interval_peaks(*watch.curve(t, states, rate), step)
        k, column = np.unravel_index(int(np.argmax(top.size)), top.size.shape)
        time = float(t[k] + step * top.place[k, column])
        return Peak(float(top.size[k, column]), time, int(column) % self.loop.vehicles)

    def _finer(self, begin: float, state: State) -> tuple[Floats, State, State, float]:
        """Times, states and rates on the finer grid of the step that begins at `begin`, and the finer step."""
        if begin not in self._refined_steps:
            times, states = self.integrator.between(begin, state)
            t = np.concatenate([[begin], times])
            whole = State(*(np.concatenate([column[None], rows]) for column, rows in zip(state, states, strict=True)))
            self._refined_steps[begin] = t, whole, self.loop.rates(t, whole), float(t[1] - t[0])
        return self._refined_steps[begin]

    # -- settling ------------------------------------------------------------------------------------------------------

    def _excess(self, state: State, rate: State) -> Curve:
        """Squared errors over squared tolerances and their rates, position then heading, (K, 2 N).

        Squares are smooth, so cubic interpolation works when an error passes 0.
        """
        offset, tolerance = self.loop.offsets(state), self.tolerance
        position = (offset.x**2 + offset.y**2) / tolerance.position**2
        position_rate = 2 * (offset.x * rate.x + offset.y * rate.y) / tolerance.position**2
        heading = offset.theta**2 / tolerance.heading**2
        heading_rate = 2 * offset.theta * rate.theta / tolerance.heading**2
        return np.concatenate([position, heading], axis=1), np.concatenate([position_rate, heading_rate], axis=1)

    def _look_outside(self, t: Floats, state: State, rate: State) -> None:
        values, slopes = self._excess(state, rate)
        self._history.append((t[1:], values[1:].max(axis=1)))
        begins_outside = np.flatnonzero(values[:-1].max(axis=1) > 1)
        first = int(begins_outside[-1]) if begins_outside.size else 0
        if begins_outside.size:
            self._outside.clear()
        grazing = interval_peaks(values[first:], slopes[first:], self.integrator.step).size.max(axis=1) > GRAZING
        self._outside += [(float(t[k]), _row(state, int(k))) for k in first + np.flatnonzero(grazing)]

    def _settling(self) -> float:
        ended, _ = self._excess(self._state, self._state)
        if ended.max() > 1:
            return math.inf
        for begin, state in reversed(self._outside):
            _, states, rate, step = self._finer(begin, state)
            last = last_above_one(*self._excess(states, rate), step)
            if last is not None:
                time = begin + last
                return time if time <= confirmed_by(self.loop, float(self._time[0])) else math.inf
        return 0.0

    def _approach(self) -> Approach:
        if not self._history:
            return Approach.STANDING_STILL
        t, squared = (np.concatenate(column) for column in zip(*self._history, strict=True))
        return Approach.of_history(t, np.sqrt(squared))


def _moved(state: State, rate: State, by: float) -> State:
    return State(*(column + by * slope for column, slope in zip(state, rate, strict=True)))


def _rows(state: State, rows: slice) -> State:
    return State(*(column[rows] for column in state))


def _row(state: State, k: int) -> State:
    return State(*(column[k].copy() for column in state))
