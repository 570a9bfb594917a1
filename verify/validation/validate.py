"""Validates gains over many starts: settling, peaks, and the ratio to the physical limit.

An `Executor` decides where the runs take place. Each result depends only on the specification and the start, so a start
can be replayed to the last bit, wherever and in whatever order it ran first.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ...models.equations import State
from ...models.errors import UndecidedError
from ...models.fleet import Fleet, digest_of
from ...models.gains import GAIN_NAMES
from ...models.tolerance import Tolerance
from ...parallel import in_turn
from ..simulation.chaos_aware import ChaosAware
from ..simulation.closed_loop import ClosedLoop, Floats
from ..simulation.engines import ENGINES, engine_name, make_integrator
from ..simulation.integrators import Integrator
from ..simulation.invariants import violations
from ..simulation.monitor import Monitor, Outcome
from ..simulation.simulate import trajectory
from ..simulation.trajectory import Trajectory
from .results_file import ResultsFile
from .start_result import Measurement, StartResult

STEP = 0.25  # s between the grid points of a run
PIECE = 400.0  # s
PIECE_NUMBERS = 5_000_000  # of one piece; large fleets have shorter ones

Progress = Callable[[str, float], None]


@dataclass(frozen=True, eq=False)
class ValidationSpec:
    """Everything that a result depends on, except the start. Specifications with equal keys are equal."""

    loop: ClosedLoop
    tolerance: Tolerance
    horizon: float  # s
    engine: str  # of engines.py
    content: dict[str, Any]  # the same as JSON, with versions
    names: tuple[str, ...]  # of the vehicles
    key: str  # the digest of the content

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ValidationSpec) and self.key == other.key

    def __hash__(self) -> int:
        return hash(self.key)


class Replay(NamedTuple):
    """One start that was run again."""

    result: StartResult
    stored: StartResult | None  # from the results file, if it is there
    trajectory: Trajectory


def make_spec(
    fleet: Fleet,
    loop: ClosedLoop,
    origin: dict[str, Any],
    *,
    horizon: float,
    tolerance: Tolerance,
    engine: str = "auto",
    versions: Mapping[str, str],
) -> ValidationSpec:
    """The specification of a validation of a fleet in closed loop; `origin` is the origin of the starts.

    Every entry of the content changes the key: results of another version are not reused.
    """
    engine = engine_name(engine, len(fleet), "chaos-aware")
    content = {
        "fleet_digest": fleet.digest,
        "vehicles": fleet.names,
        "leader": [str(fleet.leader.position), fleet.leader.theta],
        "gains": {name: [str(gain) for gain in getattr(loop.gains, name)] for name in GAIN_NAMES},
        "excitation": loop.excitation.table(),
        "starts_from": origin,
        "horizon_s": horizon,
        "tolerance": {"position_m": tolerance.position, "heading_rad": tolerance.heading},
        "integrator": {"method": engine, "tolerance": ENGINES[engine][1], "step_s": STEP},
        "versions": dict(versions),
    }
    key = digest_of(content).removeprefix("sha256:")[:16]
    return ValidationSpec(loop, tolerance, horizon, engine, content, tuple(fleet.names), key)


def origin_of_states(states: Sequence[State]) -> dict[str, Any]:
    """The origin of starts from a file: the digest of their numbers."""
    rows = [[column.tolist() for column in state] for state in states]
    return {"digest": digest_of({"states": rows})}


def validate(
    spec: ValidationSpec,
    starts: Sequence[State],
    folder: Path,
    executor: Executor,
    workers: int,
    progress: Progress = lambda _what, _fraction: None,
) -> list[StartResult]:
    """The results of all starts in order: those in the folder's results file, and the others, run by the executor.

    Raises UndecidedError if workers die. Finished starts are stored; the same call continues from there.
    """
    with ResultsFile(folder, spec.key, spec.content) as file:
        jobs = ((spec, k, start) for k, start in enumerate(starts) if k not in file.done)
        for result in in_turn(executor, run_start, jobs, workers):
            file.add(result)
            progress(f"{len(file.done)} starts", min(1.0, len(file.done) / len(starts)))
        return [file.done[k] for k in range(len(starts))]


def run_start(spec: ValidationSpec, number: int, start: State) -> StartResult:
    """One start. An integrator that gives up is a failure of this start, not of the validation."""
    try:
        integrator = _integrator(spec)
        outcome = measure(integrator, spec, start)
    except UndecidedError as error:
        return StartResult(number, None, str(error))
    settled = math.isfinite(outcome.settling_time)
    measurement = Measurement(
        settling_time=outcome.settling_time if settled else None,
        torque_ratio=outcome.torque_ratio.named(spec.names),
        speed=outcome.speed.named(spec.names),
        turn_rate=outcome.turn_rate.named(spec.names),
        final_position_error=outcome.final_position,
        final_heading_error=outcome.final_heading,
        max_V_increase=outcome.energy_rise,
        physical_limit=physical_limit(spec.loop, start),
        sensitivity=integrator.sensitivity if isinstance(integrator, ChaosAware) else None,
    )
    failure = None if settled else f"not settled within {spec.horizon:g} s ({outcome.approach})"
    broken = violations(spec.loop, outcome, start, integrator.tolerance, spec.names)
    return StartResult(number, measurement, failure, broken)


def replay(spec: ValidationSpec, number: int, start: State, folder: Path) -> Replay:
    """One start again, with its trajectory."""
    integrator, result = _integrator(spec), run_start(spec, number, start)
    with ResultsFile(folder, spec.key, spec.content) as file:
        stored = file.done.get(number)
    times, states = [np.zeros(1)], [State(*(row[None] for row in start))]
    for t, state in points(integrator, spec.horizon, start):
        times.append(t)
        states.append(state)
    whole = State(*(np.concatenate(blocks) for blocks in zip(*states, strict=True)))
    return Replay(result, stored, trajectory(integrator, np.concatenate(times), whole))


def measure(integrator: Integrator, spec: ValidationSpec, start: State) -> Outcome:
    """Settling time and peaks of the run from a start to the horizon."""
    monitor = Monitor(spec.loop, integrator, spec.tolerance, start)
    for t, state in points(integrator, spec.horizon, start):
        monitor.update(t, state)
    return monitor.outcome()


def points(integrator: Integrator, horizon: float, start: State) -> Iterator[tuple[Floats, State]]:
    """The pieces of a run up to the horizon."""
    end = horizon + integrator.step / 2
    for t, state in integrator.pieces(start):
        keep = t <= end
        yield t[keep], State(*(column[keep] for column in state))
        if t[-1] >= horizon - integrator.step / 2:
            return


def physical_limit(loop: ClosedLoop, start: State) -> float:
    """A time in s that no controller can beat by much: the largest distance divided by the speed limit.

    Without a speed limit, the bang-bang time 2 sqrt(distance / acceleration) under the full torque of both wheels.
    """
    distance, _ = loop.distances(start)
    acceleration = (loop.torque_left + loop.torque_right) / (loop.plant.r * loop.plant.m)  # (2)
    speed = loop.data.speed
    times = np.where(np.isfinite(speed), distance / speed, 2 * np.sqrt(distance / acceleration))
    return float(times.max())


@lru_cache(maxsize=1)
def _integrator(spec: ValidationSpec) -> Integrator:
    """The integrator of this process, built once: building takes as long as some seconds of simulation."""
    # A whole number of steps in the horizon, so that the last point is the horizon itself.
    step = spec.horizon / math.ceil(spec.horizon / STEP)
    piece = max(step, min(PIECE, spec.horizon, step * PIECE_NUMBERS / (5 * spec.loop.vehicles)))
    return make_integrator(spec.engine, spec.loop, step=step, piece=piece)
