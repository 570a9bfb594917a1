"""Rollouts of the closed loop from many starts under many gains at once, side by side in compiled loops.

Each rollout is a column with its own gains, frequency of psi, time and step. In single precision and to two digits they
rank candidates; `verify` integrates a design anew.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import fields, replace
from fractions import Fraction
from functools import lru_cache
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from ..models.deadline import Deadline
from ..models.equations import Plant, State, closed_loop
from ..models.excitation import Excitation
from ..models.gains import GAIN_NAMES, Gains
from ..models.graph import Graph
from ..models.tolerance import Tolerance
from .columns import Accuracy, Columns, Rate
from .compiler import At, Compiled, Loop, Single, compiled, pointer, single_ops

Array = NDArray[Any]

# Enough to rank: test_what_ranks_is_accurate_enough compares the mean settling time with that at tolerances of 1e-8.
ACCURACY = Accuracy(1e-2, 1e-3, 2.0)
FIRST_STEP, SHORTEST_STEP = 0.05, 1e-5  # s
VEHICLES = 16_384  # side by side: more leave the cache
BETWEEN = 8  # steps between two looks at what is done
MAX_STEPS = 100_000  # of one rollout
SECONDS = 600.0  # of wall clock for all
PIECE = 15.0  # s, or a period of psi: a fleet that stays settled for so long counts as settled
PLANT = tuple(field.name for field in fields(Plant) if field.name != "graph")
POSE = 3


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
        self._loops = _closed_loops(replace(trials[0].excitation, frequency=Fraction(1)))
        self._gains = _stacked(GAIN_NAMES, [trial.gains for trial in trials])
        self._starts = _stacked(State._fields, starts)
        self._frequency = np.array([float(trial.excitation.frequency) for trial in trials])
        self._hold = np.maximum(PIECE, 2 * math.pi / self._frequency)
        self._numbers = _rows([getattr(self._plant, name) for name in PLANT], plant.graph.vehicles)
        reference = self._plant.offset_x + self._plant.leader_x, self._plant.offset_y + self._plant.leader_y
        self._goal = _rows([*reference, self._plant.leader_theta], plant.graph.vehicles)
        self._within = _rows([tolerance.position, tolerance.position, tolerance.heading], plant.graph.vehicles)
        # Start after start, so that what is hopeless shows before all of its starts are run.
        self._trial = np.tile(np.arange(len(trials)), len(starts))
        self._start = np.repeat(np.arange(len(starts)), len(trials))
        self._outside = np.zeros(len(self._trial))  # s, when each was last seen outside the tolerance
        self._waiting = np.arange(len(self._trial))
        self._at = self._waiting[:0]  # the number of each column
        self._columns = self._side_by_side(np.zeros(0), self._starts[..., :0], np.zeros(0))
        self._steps = self._excess = self._last = np.zeros(0)

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
        columns, t = self._columns, self._columns.t
        columns.attempt()
        self._furthest[...] = 0
        self._observe()
        columns.accept()
        taken = columns.taken > 0
        there, halfway = self._furthest
        self._excess = np.where(taken, there, self._excess)
        self._last = np.where(taken & (halfway > 1), (t + columns.t) / 2, self._last)
        self._last = np.where(self._excess > 1, columns.t, self._last)
        self._steps += 1

    def look(self) -> None:
        """Take out what has settled, what has not by the horizon, what gave up, and what is hopeless."""
        columns, trial = self._columns, self._trial[self._at]
        last = self._outside[self._at] = self._last
        settled = columns.t - last > self._hold[trial]
        late = (columns.t >= self._horizon) | (self._steps >= self._most)
        stalled = columns.h < SHORTEST_STEP
        for place in np.flatnonzero((settled | late) & ~stalled):
            key = int(trial[place]), int(self._start[self._at[place]])
            time = float(last[place]) if settled[place] else math.inf
            final = State(*columns.y[..., place].astype(float))
            excess, end, steps = math.sqrt(self._excess[place]), float(columns.t[place]), int(self._steps[place])
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
        self._last = np.concatenate([self._last[stay], zeros])
        self._excess = np.concatenate([self._excess[stay], zeros + math.inf])

    def _side_by_side(self, t: Array, y: Array, h: Array) -> Columns:
        """(13)-(14) for the columns at work, with t (B,) and y (5, N, B)."""
        trial, width = self._trial[self._at], len(t)
        graph, vehicles = self._plant.graph, self._plant.graph.vehicles
        frequency = self._frequency[trial] / (2 * math.pi)
        turns, sums = np.empty(width, Single), np.empty((POSE, vehicles, width), Single)
        shared = {
            "gains": np.ascontiguousarray(self._gains[..., trial]),
            "plant": self._numbers,
            "weight": graph.weight,
            "leader_weight": graph.leader_weight,
            "turns": turns,
            "psi": np.empty(width, Single),
            "z": np.empty_like(sums),
            "sums": sums,
        }
        pointers = {name: pointer(array) for name, array in shared.items()}
        ends = [pointer(rows, np.int64) for rows in (graph.tail, graph.head)]

        def problem(state: Array, rates: Array) -> Rate:
            arrays = {**pointers, "state": pointer(state), "rates": pointer(rates)}
            excite = self._loops["excitation"].bind(1, width, arrays)
            place = self._loops["coordinates"].bind(vehicles, width, arrays)
            couple = self._loops["edges"].bind(graph.edges, width, arrays, ends, vehicles)
            move = self._loops["vehicles"].bind(vehicles, width, arrays)

            def rate(t: Array) -> None:
                # Many turns have no digits left in single precision.
                periods = t * frequency
                turns[...] = periods - np.floor(periods)
                sums[...] = 0
                excite(), place(), couple(), move()

            return rate

        columns = Columns(problem, t, y, h, ACCURACY)
        self._furthest = np.empty((2, width), Single)
        observed = {
            "pose": columns.y[:POSE],
            "new": columns.new[:POSE],
            "slope": columns.slopes[0, :POSE],
            "ahead": columns.slopes[-1, :POSE],
            "h": columns.step_length,
            "goal": self._goal,
            "within": self._within,
            "furthest": self._furthest,
        }
        self._observe = self._loops["distances"].bind(
            vehicles, width, {name: pointer(array) for name, array in observed.items()}
        )
        return columns


@lru_cache(maxsize=16)
def _closed_loops(excitation: Excitation) -> dict[str, Compiled]:
    """(13)-(14) in loops over the columns, the vehicles and the edges, and how far off the vehicles are."""
    symbol, each, item, column = ca.SX.sym, At.EACH, At.ITEM, At.COLUMN
    coordinates: list[Any] = []
    between: list[Any] = []
    differences, sums = symbol("differences", POSE), symbol("sums", POSE)

    def edge_difference(_: Graph, z: Any) -> Any:
        coordinates.append(z)
        return differences[len(coordinates) - 1]

    def edge_sum(_: Graph, f: Any) -> Any:
        between.append(f)
        return sums[len(between) - 1]

    ops = replace(single_ops(), edge_difference=edge_difference, edge_sum=edge_sum)
    weight, leader_weight, turns, psi = (symbol(name) for name in ("weight", "leader_weight", "turns", "psi"))
    numbers, gains, state = symbol("plant", len(PLANT)), symbol("gains", len(GAIN_NAMES)), symbol("state", 5)
    nobody = np.zeros(0, dtype=np.int64)
    plant = Plant(Graph(nobody, nobody, weight, leader_weight), *ca.vertsplit(numbers))
    known = _Known(psi)
    rates = closed_loop(ops, plant, Gains(*ca.vertsplit(gains)), known, turns, State(*ca.vertsplit(state)))  # type: ignore[arg-type]
    first, second = symbol("z_tail", POSE), symbol("z_head", POSE)
    at_first, at_second = symbol("sums_tail", POSE), symbol("sums_head", POSE)
    force = ca.substitute(ca.vertcat(*between), differences, first - second)
    return compiled(
        {
            "excitation": Loop(
                ca.Function("f", [turns], [excitation.value(ops, 2 * math.pi * turns)]),
                [("turns", column)],
                [("psi", column)],
            ),
            "coordinates": Loop(
                ca.Function("f", [state, numbers], [ca.vertcat(*coordinates)]),
                [("state", each), ("plant", item)],
                [("z", each)],
            ),
            "edges": Loop(
                ca.Function("f", [first, second, weight, at_first, at_second], [at_first + force, at_second - force]),
                [("z", At.TAIL), ("z", At.HEAD), ("weight", item), ("sums", At.TAIL), ("sums", At.HEAD)],
                [("sums", At.TAIL), ("sums", At.HEAD)],
            ),
            "vehicles": Loop(
                ca.Function("f", [state, numbers, leader_weight, gains, psi, sums], [ca.vertcat(*rates)]),
                [
                    ("state", each),
                    ("plant", item),
                    ("leader_weight", item),
                    ("gains", each),
                    ("psi", column),
                    ("sums", each),
                ],
                [("rates", each)],
            ),
            "distances": _distances(),
        }
    )


class _Known(NamedTuple):
    """An excitation whose value is known."""

    psi: Array

    def value(self, *_: object) -> Array:
        return self.psi


def _distances() -> Loop:
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
    return Loop(
        ca.Function("f", [pose, new, slope, ahead, goal, within, h, furthest], [largest]),
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


def _single(values: Any) -> Array:
    return np.asarray(values, dtype=Single)


def _rows(values: Sequence[Any], items: int) -> Array:
    """Numbers of every item, or one for all, as rows (values, items)."""
    return np.array([np.broadcast_to(value, items) for value in values], dtype=Single)


def _stacked(names: Sequence[str], items: Sequence[Any]) -> Array:
    """The columns of those names of every item, (names, N, items)."""
    columns = [[np.asarray(getattr(item, name), dtype=Single) for item in items] for name in names]
    return np.ascontiguousarray(np.moveaxis(np.array(columns), 1, 2))
