"""Columns of the closed loop in continuous time, by Runge-Kutta steps."""

from __future__ import annotations

import math
from functools import lru_cache

import casadi as ca
import numpy as np

from ...models.excitation import Excitation
from .closed_loop import Controls, controller_arrays, controller_loops, controller_parts, edge_ends
from .columns import POSE, Columns, Setup, excess, fraction
from .compiler import Program, Single, compiled_programs, pointer
from .loops import At, LoopNest, Part
from .runge_kutta import BOGACKI_SHAMPINE, Array, step_loops

TABLEAU = BOGACKI_SHAMPINE
KEPT = ("t", "h", "last", "far", "phase")  # by column


class Continuous(Columns):
    """The closed loop as (13)-(14) say, each column with its own time and step."""

    cost = 4  # evaluations of the controller that a step counts as

    def __init__(self, setup: Setup, controls: Controls, state: Array) -> None:
        """See `Columns`."""
        self._setup, self._controls = setup, controls
        width = state.shape[-1]
        first = setup.disturbance.sample_time
        kept = {name: np.zeros(width, Single) for name in KEPT} | {"h": np.full(width, first, Single)}
        self._begin(state, kept)

    def _begin(self, state: Array, kept: dict[str, Array]) -> None:
        setup, settings, width = self._setup, self._setup.settings, state.shape[-1]
        y = np.array(state, dtype=Single, order="C")
        slopes = np.empty((1 + len(TABLEAU.times), *y.shape), Single)
        longest = settings.longest_step * setup.disturbance.sample_time
        self._arrays = {
            **controller_arrays(setup.plant, self._controls),
            **{name: np.ascontiguousarray(array) for name, array in kept.items()},
            "y": y,
            "new": y.copy(),
            "slopes": slopes,
            **{f"slope{k}": slope for k, slope in enumerate(slopes)},
            "turning": np.asarray(self._controls.frequency / (2 * math.pi), dtype=Single),
            "now": np.empty(width, Single),
            "taken": np.zeros(width, Single),
            "next_h": np.empty(width, Single),
            "error": np.zeros(width, Single),
            "furthest": np.zeros((2, width), Single),
            "units": setup.units.reshape(-1),
            "constants": np.array([[1 / y[..., :1].size], [longest]], Single),
            "goal": setup.goal,
            "within": setup.within,
        }
        pointers = {name: pointer(array) for name, array in self._arrays.items()}
        programs = _programs(setup.excitation, settings.relative_error, settings.absolute_error)
        ends = edge_ends(setup.plant.graph)
        programs["begin"].bind(setup.sizes, width, pointers, ends)(1)
        self._run = programs["step"].bind(setup.sizes, width, pointers, ends)

    def advance(self, steps: int) -> None:
        """See `Columns`."""
        self._run(steps)

    def keep(self, stay: Array) -> None:
        """See `Columns`."""
        self._controls = self._controls.take(stay)
        self._begin(self._arrays["y"][..., stay], {name: self._arrays[name][stay] for name in KEPT})

    @property
    def t(self) -> Array:
        """See `Columns`."""
        return np.asarray(self._arrays["t"])

    @property
    def last(self) -> Array:
        """See `Columns`."""
        return np.asarray(self._arrays["last"])

    @property
    def far(self) -> Array:
        """See `Columns`."""
        return np.asarray(self._arrays["far"])

    @property
    def failed(self) -> Array:
        """See `Columns`."""
        shortest = self._setup.settings.shortest_step * self._setup.disturbance.sample_time
        return np.asarray(~(self._arrays["h"] >= shortest))


@lru_cache(maxsize=16)
def _programs(excitation: Excitation, relative: float, absolute: float) -> dict[str, Program]:
    """`begin` finds the first slope, `step` tries a step of every column and goes on with those that are good."""
    loops = {
        **controller_loops(excitation),
        **step_loops(TABLEAU, relative, absolute),
        **{f"phase{k}": _phase(share) for k, share in enumerate((0.0, *TABLEAU.times))},
        "clear_column": LoopNest(ca.Function("clear", [], [0, ca.SX.zeros(2)]), [], _at_column("error", "furthest")),
        "observe": _observe(),
        "finish": _finish(),
    }
    last = len(TABLEAU.times)
    stages = [
        part
        for k in range(last)
        for part in (
            Part(f"stage{k}", "values"),
            Part(f"phase{k + 1}", "one"),
            *controller_parts("new", "now", "rates", f"slope{k + 1}"),
        )
    ]
    after = [
        Part("clear_column", "one"),
        Part("judge", "values"),
        Part("control", "one"),
        Part("observe", "vehicles", (("ahead", f"slope{last}"),)),
        Part("accept", "values"),
        Part("finish", "one"),
    ]
    begin = [Part("phase0", "one"), *controller_parts("new", "now", "rates", "slope0")]
    return compiled_programs(loops, {"begin": begin, "step": [*stages, *after]})


def _at_column(*names: str) -> list[tuple[str, At]]:
    return [(name, At.COLUMN) for name in names]


def _phase(share: float) -> LoopNest:
    """The phase of psi at a share of the step."""
    phase, h, turning = (ca.SX.sym(name) for name in ("phase", "h", "turning"))
    function = ca.Function("phase", [phase, h, turning], [fraction(phase + share * h * turning)])
    return LoopNest(function, _at_column("phase", "h", "turning"), _at_column("now"))


def _observe() -> LoopNest:
    """The largest squared error over its tolerance, at the end of a step and halfway, by Hermite's cubic."""
    y, new, slope, ahead, goal, within = (
        ca.SX.sym(name, POSE) for name in ("y", "new", "slope", "ahead", "goal", "within")
    )
    h, furthest = ca.SX.sym("h"), ca.SX.sym("furthest", 2)
    halfway = (y + new) / 2 + h / 8 * (slope - ahead)
    largest = ca.fmax(ca.vertcat(excess(new, goal, within), excess(halfway, goal, within)), furthest)
    each, item = At.EACH, At.ITEM
    return LoopNest(
        ca.Function("observe", [y, new, slope, ahead, goal, within, h, furthest], [largest]),
        [
            ("y", each),
            ("new", each),
            ("slope0", each),
            ("ahead", each),
            ("goal", item),
            ("within", item),
            *_at_column("h", "furthest"),
        ],
        _at_column("furthest"),
    )


def _finish() -> LoopNest:
    """What a step that is taken changes in its column, and the length of the next."""
    names = ("t", "h", "last", "far", "phase", "taken", "next_h", "turning")
    t, h, last, far, phase, taken, next_h, turning = (ca.SX.sym(name) for name in names)
    furthest = ca.SX.sym("furthest", 2)
    there, halfway = ca.vertsplit(furthest)
    later = t + taken * h
    seen = ca.if_else(halfway > 1, (t + later) / 2, last)
    seen = ca.if_else(there > 1, later, seen)
    results = [
        later,
        next_h,
        ca.if_else(taken, seen, last),
        ca.if_else(taken, there, far),
        fraction(phase + taken * h * turning),
    ]
    function = ca.Function("finish", [t, h, last, far, phase, taken, next_h, turning, furthest], results)
    return LoopNest(function, _at_column(*names, "furthest"), _at_column("t", "h", "last", "far", "phase"))
