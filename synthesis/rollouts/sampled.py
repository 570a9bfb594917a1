"""Columns of the closed loop as a robot's computer runs it: torques held between samples, and disturbances."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from ...models.equations import State, motion
from ...models.excitation import Excitation
from ...models.friction import friction_torques
from .closed_loop import (
    PLANT,
    Controls,
    controller_arrays,
    controller_loops,
    controller_parts,
    edge_ends,
    phases,
    rows,
    symbolic_plant,
)
from .columns import POSE, Columns, Setup, excess, fraction
from .compiler import Program, Single, compiled_programs, pointer
from .disturbance import NOISE_BLOCK
from .loops import At, LoopNest, Part
from .runge_kutta import Array
from .single_functions import single_ops

STEPS_WITH_FRICTION = 2  # of a sample time


class Sampled(Columns):
    """The controller runs at sample times, on measured states; its torques are held in between.

    Under held torques speeds are exact and positions those of the midpoint rule.
    """

    def __init__(self, setup: Setup, controls: Controls, state: Array) -> None:
        """See `Columns`."""
        width, delay = state.shape[-1], setup.disturbance.delay
        self._setup, self._controls, self._number = setup, controls, 0
        self._noise = setup.disturbance.noise(setup.vehicles)
        rubbing = STEPS_WITH_FRICTION if setup.disturbance.friction else 0
        self.cost = 1 + (self._noise is not None) + rubbing
        waiting = [np.zeros((2, setup.vehicles, width), Single) for _ in range(delay)]
        self._begin(state, waiting, np.zeros(width, Single))

    def _begin(self, state: Array, waiting: list[Array], last: Array) -> None:
        """Go on from states, with the torques that wait for the wheels, the next first."""
        setup, disturbance, width = self._setup, self._setup.disturbance, state.shape[-1]
        h = disturbance.sample_time / (STEPS_WITH_FRICTION if disturbance.friction else 1)
        true, friction = disturbance.true_plant(setup.plant), [disturbance.coulomb, disturbance.viscous]
        turning = self._controls.frequency.astype(float) * disturbance.sample_time / (2 * math.pi)
        self._state = np.array(state, dtype=Single, order="C")
        self._arrays = {
            **controller_arrays(setup.plant, self._controls),
            "state": self._state,
            "measured": self._state if self._noise is None else np.empty_like(self._state),
            "true_plant": rows([getattr(true, name) for name in PLANT], setup.vehicles),
            "motion": rows([h, *friction], setup.vehicles),
            "turning": np.asarray(turning, dtype=Single),
            "sample_time": np.full((1, 1), disturbance.sample_time, Single),
            "goal": setup.goal,
            "within": setup.within,
            "furthest": np.zeros(width, Single),
            "last": np.ascontiguousarray(last),
            "t": np.full(width, self._number * disturbance.sample_time, Single),
        }
        # From the exact time, as `advance` does: else a column would depend on when others leave.
        exact = np.full(width, self._number * disturbance.sample_time)
        self._arrays["phase"][...] = phases(self._controls.frequency, exact)
        if self._noise is not None:
            self._arrays["noise"] = self._noise
        if disturbance.lost_edge is not None:
            self._arrays["losable"][disturbance.lost_edge] = 1
        self._torques = [np.ascontiguousarray(one) for one in waiting]
        self._torques.append(np.zeros((2, setup.vehicles, width), Single))
        self._slot = len(waiting)  # where the next torques go
        self._runs = self._bound()

    def _bound(self) -> list[Any]:
        """The program, for every slot that torques may go to; those that have waited longest move the vehicles."""
        setup, width = self._setup, self._state.shape[-1]
        pointers = {name: pointer(array) for name, array in self._arrays.items()}
        program = _program(setup.excitation, self._noise is not None, setup.disturbance.friction)
        slots, ends = [pointer(one) for one in self._torques], edge_ends(setup.plant.graph)
        pairs = [(slots[k], slots[(k + 1) % len(slots)]) for k in range(len(slots))]
        return [
            program.bind(setup.sizes, width, {**pointers, "command": new, "applied": old}, ends) for new, old in pairs
        ]

    def advance(self, steps: int) -> None:
        """See `Columns`."""
        disturbance = self._setup.disturbance
        samples = 1 if self._noise is None else len(self._noise) - NOISE_BLOCK
        most = NOISE_BLOCK if len(self._torques) == 1 else 1
        for begin in range(0, steps, most):
            at_once = min(most, steps - begin)
            if disturbance.lost_edge is not None:
                self._arrays["connected"][...] = self._number * disturbance.sample_time < disturbance.lost_at
            self._runs[self._slot](at_once, self._number % samples)
            self._slot = (self._slot + 1) % len(self._torques)
            self._number += at_once
        # Exactly: singles lose a little with every sample.
        t = np.full(self._state.shape[-1], self._number * disturbance.sample_time)
        self._arrays["t"][...] = t
        self._arrays["phase"][...] = phases(self._controls.frequency, t)

    def keep(self, stay: Array) -> None:
        """See `Columns`."""
        self._controls = self._controls.take(stay)
        slots = len(self._torques)
        order = [(self._slot + 1 + k) % slots for k in range(slots - 1)]
        waiting = [self._torques[slot][..., stay] for slot in order]
        self._begin(self._state[..., stay], waiting, self._arrays["last"][stay])

    @property
    def t(self) -> Array:
        """See `Columns`."""
        return self._arrays["t"]

    @property
    def last(self) -> Array:
        """See `Columns`."""
        return self._arrays["last"]

    @property
    def far(self) -> Array:
        """See `Columns`."""
        return self._arrays["furthest"]

    @property
    def failed(self) -> Array:
        """See `Columns`."""
        return np.asarray(~np.isfinite(self.far))


@lru_cache(maxsize=16)
def _program(excitation: Excitation, noisy: bool, friction: bool) -> Program:
    """One sample: measure, find torques, move, and see how far away the vehicles are."""
    loops = {
        **controller_loops(excitation),
        "measure": _measure(),
        "move": _move(friction),
        "forget": LoopNest(ca.Function("forget", [], [0]), [], [("furthest", At.COLUMN)]),
        "finish": _finish(),
    }
    measured = "measured" if noisy else "state"
    parts = [
        *([Part("measure", "vehicles", moving=("noise",))] if noisy else []),
        *controller_parts(measured, "phase", "torques", "command"),
        Part("forget", "one"),
        *[Part("move", "vehicles")] * (STEPS_WITH_FRICTION if friction else 1),
        Part("finish", "one"),
    ]
    return compiled_programs(loops, {"sample": parts})["sample"]


def _measure() -> LoopNest:
    state, noise = ca.SX.sym("state", 5), ca.SX.sym("noise", 5)
    function = ca.Function("measure", [state, noise], [state + noise])
    return LoopNest(function, [("state", At.EACH), ("noise", At.ITEM)], [("measured", At.EACH)])


def _move(friction: bool) -> LoopNest:
    """The motion under held torques, and the largest squared error over its tolerance where it ends."""
    ops, each, item = single_ops(), At.EACH, At.ITEM
    state, numbers, torques = ca.SX.sym("state", 5), ca.SX.sym("plant", len(PLANT)), ca.SX.sym("torques", 2)
    constants, goal, within = ca.SX.sym("constants", 3), ca.SX.sym("goal", POSE), ca.SX.sym("within", POSE)
    furthest, plant = ca.SX.sym("furthest"), symbolic_plant(numbers)
    h, coulomb, viscous = ca.vertsplit(constants)

    begin, held = State(*ca.vertsplit(state)), ca.vertsplit(torques)
    if friction:
        lost = friction_torques(_clip, plant, begin, held, coulomb, viscous, h)
        held = [held[k] - lost[k] for k in (0, 1)]

    def rate(now: State) -> State:
        return motion(ops, plant, now, *held)

    middle = _along(begin, rate(begin), h / 2)
    end = _along(begin, rate(middle), h)
    far = ca.fmax(excess(ca.vertcat(*end[:POSE]), goal, within), furthest)
    arguments = [state, numbers, torques, constants, goal, within, furthest]
    places = [
        ("state", each),
        ("true_plant", item),
        ("applied", each),
        ("motion", item),
        ("goal", item),
        ("within", item),
        ("furthest", At.COLUMN),
    ]
    function = ca.Function("move", arguments, [ca.vertcat(*end), far])
    return LoopNest(function, places, [("state", each), ("furthest", At.COLUMN)])


def _clip(x: Any, limit: Any) -> Any:
    return ca.fmin(ca.fmax(x, -limit), limit)


def _along(state: State, rate: State, by: Any) -> State:
    return State(*(column + by * slope for column, slope in zip(state, rate, strict=True)))


def _finish() -> LoopNest:
    """Time and phase after a sample, and when the vehicles were last outside."""
    t, last, phase, turning, furthest, sample_time = (
        ca.SX.sym(name) for name in ("t", "last", "phase", "turning", "furthest", "sample_time")
    )
    later = t + sample_time
    results = [later, ca.if_else(furthest > 1, later, last), fraction(phase + turning)]
    function = ca.Function("finish", [t, last, phase, turning, furthest, sample_time], results)
    reads = [(name, At.COLUMN) for name in ("t", "last", "phase", "turning", "furthest")]
    writes = [(name, At.COLUMN) for name in ("t", "last", "phase")]
    return LoopNest(function, [*reads, ("sample_time", At.ITEM)], writes)
