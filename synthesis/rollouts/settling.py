"""Rollouts of the closed loop from many starts under many gains at once, side by side in compiled loops.

Each rollout is a column with its own gains, frequency of psi, time and step. They rank candidates, in
single precision and to two digits; `verify` integrates the design again.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache
from typing import Any, NamedTuple

import casadi as ca
import numpy as np

from ...models.deadline import Deadline
from ...models.equations import Plant, State
from ...models.excitation import Excitation
from ...models.gains import Gains
from ...models.tolerance import Tolerance
from ..settings import FAST, Settings
from .closed_loop import ClosedLoop, Controls, rows, stacked
from .compiler import At, Compiled, LoopNest, Single, compiled, pointer
from .runge_kutta import BOGACKI_SHAMPINE, Array, Stepper

POSE = 3  # rows of a state that hold the pose of a vehicle


class Trial(NamedTuple):
    """Gains (floats, (N,)) and their psi. In one batch, psi may differ in its frequency only."""

    gains: Gains
    excitation: Excitation


class Limits(NamedTuple):
    """The limits of rollouts."""

    horizon: float  # s
    abandon_above: float = math.inf  # s: a trial is stopped once its mean settling time must exceed this
    steps: int = FAST.most_steps  # most integration steps of one rollout


class Settling(NamedTuple):
    """The outcome of one rollout."""

    time: float  # s, from which all vehicles stay within the tolerance; inf if not settled by the horizon
    excess: float  # the largest error over its tolerance at the end
    end: float  # s, when the rollout ended
    final: State  # then, (N,) each
    steps: int  # integration steps


def settle_all(
    plant: Plant,
    trials: Sequence[Trial],
    starts: Sequence[State],
    limits: Limits,
    tolerance: Tolerance,
    settings: Settings = FAST,
) -> list[list[Settling | None]]:
    """How the fleet settles under every trial from every start, within the limits.

    An entry is None if the integrator gave up, or if the rollout was still running when its trial was abandoned. A
    rollout does not depend on those beside it.
    """
    batch = _Batch(plant, trials, starts, limits, tolerance, settings)
    deadline = Deadline(settings.rollout_seconds)
    while batch.refill() and not deadline.passed:
        for _ in range(settings.steps_between_checks):
            batch.step()
        batch.look()
    return [[batch.settled.get((i, k)) for k in range(len(starts))] for i in range(len(trials))]


class _Batch:
    """The running columns, the waiting ones, and the outcomes so far."""

    def __init__(
        self,
        plant: Plant,
        trials: Sequence[Trial],
        starts: Sequence[State],
        limits: Limits,
        tolerance: Tolerance,
        settings: Settings,
    ) -> None:
        self.settled: dict[tuple[int, int], Settling] = {}  # by trial and start
        self._limits, self._settings = limits, settings
        self._abandon_above = limits.abandon_above * len(starts)  # s, for the sum over the starts
        self._width = max(1, settings.simulated_vehicles // plant.graph.vehicles)
        self._closed_loop = ClosedLoop(plant, trials[0].excitation)
        frequencies = [float(trial.excitation.frequency) for trial in trials]
        self._controls = Controls.of([trial.gains for trial in trials], frequencies)
        self._starts = stacked(starts)
        self._hold = np.maximum(settings.settled_for, 2 * math.pi / self._controls.frequency)
        reference = plant.offset_x + plant.leader_x, plant.offset_y + plant.leader_y
        self._goal = rows([*reference, plant.leader_theta], plant.graph.vehicles)
        self._within = rows([tolerance.position, tolerance.position, tolerance.heading], plant.graph.vehicles)
        # Start after start, so a trial can be abandoned before all of its starts have run.
        self._trial = np.tile(np.arange(len(trials)), len(starts))
        self._start = np.repeat(np.arange(len(starts)), len(trials))
        self._outside = np.zeros(len(self._trial))  # s, when each was last seen outside the tolerance
        self._waiting = np.arange(len(self._trial))
        self._at = self._waiting[:0]  # the number of each column
        self._stepper = self._side_by_side(np.zeros(0), self._starts[..., :0], np.zeros(0))
        self._steps = self._excess = self._last = np.zeros(0)

    def refill(self) -> bool:
        """Put waiting columns into free places. Returns whether any column is running."""
        free = self._width - len(self._at)
        if free > self._width // 4 or not len(self._at):
            new, self._waiting = self._waiting[:free], self._waiting[free:]
            if len(new):
                self._renew(np.ones(len(self._at), dtype=bool), new)
        return bool(len(self._at))

    def step(self) -> None:
        """One step of every column; then test its errors at the end and halfway."""
        stepper, t = self._stepper, self._stepper.t
        stepper.attempt()
        self._furthest[...] = 0
        self._observe()
        stepper.accept()
        taken = stepper.taken > 0
        there, halfway = self._furthest
        self._excess = np.where(taken, there, self._excess)
        self._last = np.where(taken & (halfway > 1), (t + stepper.t) / 2, self._last)
        self._last = np.where(self._excess > 1, stepper.t, self._last)
        self._steps += 1

    def look(self) -> None:
        """Remove columns that have settled, reached the horizon, given up or been abandoned."""
        stepper, trial, horizon = self._stepper, self._trial[self._at], self._limits.horizon
        last = self._outside[self._at] = self._last
        settled = stepper.t - last > self._hold[trial]
        late = (stepper.t >= horizon) | (self._steps >= self._limits.steps)
        stalled = stepper.h < self._settings.shortest_step
        for place in np.flatnonzero((settled | late) & ~stalled):
            key = int(trial[place]), int(self._start[self._at[place]])
            time = float(last[place]) if settled[place] else math.inf
            final = State(*stepper.y[..., place].astype(float))
            excess, end, steps = math.sqrt(self._excess[place]), float(stepper.t[place]), int(self._steps[place])
            self.settled[key] = Settling(time, excess, end, final, steps)
        self._outside[self._at[stalled | (late & ~settled)]] = horizon
        abandoned = np.bincount(self._trial, np.minimum(self._outside, horizon)) > self._abandon_above
        self._waiting = self._waiting[~abandoned[self._trial[self._waiting]]]
        stay = ~(settled | late | stalled | abandoned[trial])
        if not stay.all():
            self._renew(stay, self._waiting[:0])

    def _renew(self, stay: Array, new: Array) -> None:
        """Continue with the remaining columns, and new ones beside them."""
        old, zeros = self._stepper, np.zeros(len(new))
        self._at = np.concatenate([self._at[stay], new])
        t, h = np.concatenate([old.t[stay], zeros]), np.concatenate([old.h[stay], zeros + self._settings.first_step])
        y = np.concatenate([old.y[..., stay], self._starts[..., self._start[new]]], axis=-1)
        self._stepper = self._side_by_side(t, y, h)
        self._steps = np.concatenate([self._steps[stay], zeros])
        self._last = np.concatenate([self._last[stay], zeros])
        self._excess = np.concatenate([self._excess[stay], zeros + math.inf])

    def _side_by_side(self, t: Array, y: Array, h: Array) -> Stepper:
        """(13)-(14) for the running columns, with t (B,) and y (5, N, B)."""
        problem = self._closed_loop.problem(self._controls.take(self._trial[self._at]))
        stepper = Stepper(BOGACKI_SHAMPINE, problem, t, y, h, self._settings.accuracy)
        self._furthest = np.empty((2, len(t)), Single)
        observed = {
            "pose": stepper.y[:POSE],
            "new": stepper.new[:POSE],
            "slope": stepper.slopes[0, :POSE],
            "ahead": stepper.slopes[-1, :POSE],
            "h": stepper.step_length,
            "goal": self._goal,
            "within": self._within,
            "furthest": self._furthest,
        }
        pointers = {name: pointer(array) for name, array in observed.items()}
        self._observe = _distances().bind(y.shape[1], len(t), pointers)
        return stepper


@cache
def _distances() -> Compiled:
    """The largest squared error over its tolerance, at the end of a step and halfway, by Hermite's cubic."""
    pose, new, slope, ahead, goal, within = (
        ca.SX.sym(name, POSE) for name in ("pose", "new", "slope", "ahead", "goal", "within")
    )
    h, furthest = ca.SX.sym("h"), ca.SX.sym("furthest", 2)
    halfway = (pose + new) / 2 + h / 8 * (slope - ahead)

    def over(place: Any) -> Any:
        x, y, theta = ca.vertsplit(((place - goal) / within) ** 2)
        return ca.fmax(x + y, theta)

    largest = ca.fmax(ca.vertcat(over(new), over(halfway)), furthest)
    each, item = At.EACH, At.ITEM
    loop = LoopNest(
        ca.Function("distances", [pose, new, slope, ahead, goal, within, h, furthest], [largest]),
        [
            ("pose", each),
            ("new", each),
            ("slope", each),
            ("ahead", each),
            ("goal", item),
            ("within", item),
            ("h", At.COLUMN),
            ("furthest", At.COLUMN),
        ],
        [("furthest", At.COLUMN)],
    )
    return compiled({"distances": loop})["distances"]
