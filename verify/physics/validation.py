"""Many starts in MuJoCo, each beside the same start in the sampled model (2) under the same disturbance."""

from __future__ import annotations

import statistics
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...models.equations import State
from ...models.errors import UndecidedError
from ...models.fleet import Fleet
from ...models.tolerance import Tolerance
from ..simulation.closed_loop import ClosedLoop, Floats
from ..simulation.disturbance import Disturbance
from ..simulation.sampled_loop import STORED, Sample, SampledLoop
from ..validation.spread import Spread
from .controller import CController
from .scene import FRICTION
from .world import World


@dataclass(frozen=True, eq=False)
class PhysicsTask:
    """All that the result of a start depends on, but the start."""

    fleet: Fleet  # with the links that are used
    loop: ClosedLoop
    torque_bounds: Floats  # (N,), N m, T of (16*)
    library: Path  # the compiled C controller
    disturbance: Disturbance
    horizon: float  # s
    tolerance: Tolerance


@dataclass(frozen=True, eq=False)
class Track:
    """Where the vehicles of one start were, in MuJoCo and in the model."""

    t: Floats  # (K,), s
    real: Floats  # (K, 2, N), m, x and y in MuJoCo
    model: Floats  # (K, 2, N), m


@dataclass(frozen=True)
class PhysicsResult:
    """One start in MuJoCo, and in the model."""

    start: int
    settling_time: float | None  # s; None where not settled
    model_settling_time: float | None  # s
    failure: str | None  # what the error does at the end, or why the engine gave up
    torque_ratio: float  # the largest |torque| over its limit
    bound_ratio: float  # the largest |torque| over T of (16*)
    slip_speed: float  # m/s
    slip_share: float  # of the distance that wheels roll
    largest_difference: float  # m, between the positions of a vehicle in MuJoCo and in the model
    final_difference: float  # m
    track: Track | None = None  # of the first start, for a figure

    def to_json(self) -> dict[str, Any]:
        """An entry of "each" in validation.json."""
        return {
            "start": self.start,
            "settling_time_s": self.settling_time,
            "model_settling_time_s": self.model_settling_time,
            "failure": self.failure,
            "peak_torque_ratio": self.torque_ratio,
            "peak_torque_over_bound": self.bound_ratio,
            "slip_speed": self.slip_speed,
            "slip_share": self.slip_share,
            "largest_difference_m": self.largest_difference,
            "final_difference_m": self.final_difference,
        }


def run_physics(task: PhysicsTask, number: int, start: State) -> PhysicsResult:
    """One start, in MuJoCo and in the model side by side."""
    sampled = SampledLoop(task.fleet, task.loop, task.disturbance, task.horizon, task.tolerance)
    (model_time,) = _times(sampled.outcomes([start]).settling_time)
    world = World(task.fleet, task.disturbance)
    controller = CController(task.library, len(task.fleet))
    watch = _Watch(task.torque_bounds, every=max(1, round(STORED / task.disturbance.sample_time)))
    pairs = zip(
        world.samples(start, controller.torques, task.horizon),
        sampled.samples(State(*(column[None] for column in start))),
        strict=True,
    )
    try:
        outcome = sampled.outcomes_of(watch.seen(pairs))
    except UndecidedError as error:
        nothing = (float("inf"),) * 6
        return PhysicsResult(number, None, model_time, str(error), *nothing)
    (time,) = _times(outcome.settling_time)
    return PhysicsResult(
        start=number,
        settling_time=time,
        model_settling_time=model_time,
        failure=None if time is not None else f"not settled within {task.horizon:g} s ({outcome.approach[0]})",
        torque_ratio=float(outcome.torque_ratio[0]),
        bound_ratio=watch.bound_ratio,
        slip_speed=world.slip.speed,
        slip_share=world.slip.share,
        largest_difference=watch.largest,
        final_difference=watch.last,
        track=watch.track() if number == 0 else None,
    )


class _Watch:
    """What is to be known of two runs besides their outcomes."""

    def __init__(self, bounds: Floats, every: int) -> None:
        self._bounds, self._every = bounds, every
        self._points: list[tuple[float, Floats, Floats]] = []
        self.bound_ratio = self.largest = self.last = 0.0

    def seen(self, pairs: Iterator[tuple[Sample, Sample]]) -> Iterator[Sample]:
        """The first of each pair, when it has been looked at."""
        for number, (real, model) in enumerate(pairs):
            if number % self._every == 0:
                here, there = (np.concatenate([sample.before.x, sample.before.y]) for sample in (real, model))
                self._points.append((real.t, here, there))
            torque = np.maximum(np.abs(real.tau_left), np.abs(real.tau_right))
            self.bound_ratio = max(self.bound_ratio, float((torque / self._bounds).max()))
            apart = np.hypot(real.after.x - model.after.x, real.after.y - model.after.y)
            self.last = float(apart.max())
            self.largest = max(self.largest, self.last)
            yield real

    def track(self) -> Track:
        """The points that were kept."""
        t, real, model = zip(*self._points, strict=True)
        return Track(np.array(t), np.stack(real), np.stack(model))


def _times(settling: Floats) -> list[float | None]:
    return [float(time) if np.isfinite(time) else None for time in settling]


@dataclass(frozen=True)
class PhysicsValidation:
    """All starts, and what they come to."""

    task: PhysicsTask
    results: Sequence[PhysicsResult]

    def to_json(self) -> dict[str, Any]:
        """The content of validation.json, except its origin and versions."""
        times = [result.settling_time for result in self.results]
        model = [result.model_settling_time for result in self.results]
        return {
            "plant": "mujoco",
            "starts": len(self.results),
            "settled": _settled(times),
            "settling_time_s": {**Spread.of(times)._asdict(), "each": times},
            "model": {"settled": _settled(model), "settling_time_s": {**Spread.of(model)._asdict(), "each": model}},
            "ratio_to_model": self.ratios,
            "peak_torque_ratio": self.largest("torque_ratio"),
            "peak_torque_over_bound": self.largest("bound_ratio"),
            "slip": {"speed": self.largest("slip_speed"), "share": self.largest("slip_share"), "friction": FRICTION},
            "failures": [{"start": r.start, "failure": r.failure} for r in self.results if r.failure],
            "violations": [],
            "horizon_s": self.task.horizon,
            "tolerance": {
                "position_m": self.task.tolerance.position,
                "heading_rad": self.task.tolerance.heading,
            },
            "disturbance": self.task.disturbance.to_json(),
            "each": [result.to_json() for result in self.results],
        }

    @property
    def ratios(self) -> list[float]:
        """Settling time in MuJoCo over that in the model, of the starts that settle in both."""
        return [
            result.settling_time / result.model_settling_time
            for result in self.results
            if result.settling_time is not None and result.model_settling_time
        ]

    def largest(self, name: str) -> float | None:
        """The largest of one number over the starts that the engine finished."""
        values = [value for result in self.results if np.isfinite(value := getattr(result, name))]
        return max(values, default=None)

    def sentences(self) -> list[str]:
        """The same for a reader."""
        times = [result.settling_time for result in self.results]
        model = [result.model_settling_time for result in self.results]
        median = Spread.of(times).median
        lines = [
            f"MuJoCo with {self.task.disturbance.in_words()}: {_settled(times)} of {len(times)} starts settle"
            + ("" if median is None else f", median {median:.4g} s")
            + f"; the model: {_settled(model)}"
        ]
        if ratios := self.ratios:
            lines.append(
                f"settling time in MuJoCo over the model's: median {statistics.median(ratios):.3f}, "
                f"from {min(ratios):.3f} to {max(ratios):.3f}"
            )
        if (peak := self.largest("bound_ratio")) is not None:
            lines.append(
                f"largest torque {100 * peak:.4g} % of T of (16*); largest slip {self.largest('slip_speed'):.3g} m/s, "
                f"{100 * (self.largest('slip_share') or 0):.3g} % of the way that wheels roll"
            )
        return lines + [f"start {result.start}: {result.failure}" for result in self.results if result.failure]


def _settled(times: Sequence[float | None]) -> int:
    return sum(time is not None for time in times)
