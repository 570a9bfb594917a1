"""Validates gains over many starts: settling, peaks, and how far from what physics would allow.

An `Executor` decides where the runs take place. Each result is a function of its question alone, so that a start
can be replayed to the last bit, wherever and in whatever order it ran first.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from ...models.equations import State
from ...models.errors import UndecidedError
from ...models.excitation import Excitation
from ...models.fleet import Fleet, digest_of
from ...models.gains import GAIN_NAMES, Gains
from ...models.tolerance import Tolerance
from ...parallel import in_turn
from ..simulation.chaos_aware import Staged
from ..simulation.engine import ENGINES, make, named
from ..simulation.integrators import Integrator
from ..simulation.invariants import violations
from ..simulation.loop import Floats, Loop
from ..simulation.observer import Observer, Outcome
from ..simulation.simulate import Trajectory, trajectory
from .results_file import Ledger

STEP = 0.25  # s between the points at which a run is looked at
PIECE = 400.0  # s
PIECE_NUMBERS = 5_000_000  # of one piece; large fleets have shorter ones

Progress = Callable[[str, float], None]


@dataclass(frozen=True, eq=False)
class Question:
    """All that a result depends on, but the start."""

    loop: Loop
    tolerance: Tolerance
    horizon: float  # s
    method: str  # of engine.py
    content: dict[str, Any]  # the same for a reader, with versions
    names: tuple[str, ...]
    key: str  # the digest of the content

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Question) and self.key == other.key

    def __hash__(self) -> int:
        return hash(self.key)


def ask(
    fleet: Fleet,
    gains: Gains,
    excitation: Excitation,
    origin: dict[str, Any],
    *,
    horizon: float,
    tolerance: Tolerance,
    method: str = "auto",
    versions: Mapping[str, str],
) -> Question:
    """The question how a fleet settles under gains; `origin` says where the starts come from.

    Every entry of the content changes the key: what was stored under another version is not taken over.
    """
    method = named(method, len(fleet), "staged")
    content = {
        "fleet_digest": fleet.digest,
        "leader": [str(fleet.leader.position), fleet.leader.theta],
        "gains": {name: [str(gain) for gain in getattr(gains, name)] for name in GAIN_NAMES},
        "excitation": excitation.table(),
        "starts_from": origin,
        "horizon_s": horizon,
        "tolerance": {"position_m": tolerance.position, "heading_rad": tolerance.heading},
        "integrator": {"method": method, "tolerance": ENGINES[method][1], "step_s": STEP},
        "versions": dict(versions),
    }
    key = digest_of(content).removeprefix("sha256:")[:16]
    return Question(Loop.of(fleet, gains, excitation), tolerance, horizon, method, content, tuple(fleet.names), key)


def origin_of_states(states: Sequence[State]) -> dict[str, Any]:
    """Where starts come from that a file holds: the digest of their numbers."""
    rows = [[column.tolist() for column in state] for state in states]
    return {"digest": digest_of({"states": rows})}


def validate(
    question: Question,
    starts: Sequence[State],
    folder: Path,
    executor: Executor,
    workers: int,
    progress: Progress = lambda _what, _fraction: None,
) -> list[dict[str, Any]]:
    """The results of all starts in order: those that the folder's ledger holds, and the others by the executor.

    Raises UndecidedError where workers die; what is done by then is stored, and the same call goes on from there.
    """
    with Ledger(folder, question.key, question.content) as ledger:
        jobs = ((question, k, start) for k, start in enumerate(starts) if k not in ledger.done)
        for result in in_turn(executor, run_start, jobs, workers):
            ledger.add(result)
            progress(f"{len(ledger.done)} starts", min(1.0, len(ledger.done) / len(starts)))
        return [ledger.done[k] for k in range(len(starts))]


def run_start(question: Question, number: int, start: State) -> dict[str, Any]:
    """One start: the line of the ledger. An integrator that gives up is a failure of the start, not of the whole."""
    try:
        method = _method(question)
        outcome = observe(method, question, start)
    except UndecidedError as error:
        return {"start": number, "settling_time_s": None, "failure": str(error), "gave_up": True, "violations": []}
    settled = math.isfinite(outcome.settling_time)
    peaks = {"torque_ratio": outcome.torque_ratio, "speed": outcome.speed, "turn_rate": outcome.turn_rate}
    return {
        "start": number,
        "settling_time_s": outcome.settling_time if settled else None,
        "failure": None if settled else f"not settled by {question.horizon:g} s",
        **{
            f"peak_{name}": {"value": peak.value, "time_s": peak.time, "vehicle": question.names[peak.vehicle]}
            for name, peak in peaks.items()
        },
        "final_position_error_m": outcome.final_position,
        "final_heading_error_rad": outcome.final_heading,
        "max_V_increase": outcome.energy_rise,
        "physical_limit_s": physical_limit(question.loop, start),
        "violations": violations(question.loop, outcome, start, method.tolerance, question.names),
        "sensitivity_m": method.apart if isinstance(method, Staged) else None,
    }


def replay(
    question: Question, number: int, start: State, folder: Path
) -> tuple[dict[str, Any], dict[str, Any] | None, Trajectory]:
    """One start again: its result, the stored one of the folder's ledger if there is one, and its trajectory."""
    method, result = _method(question), run_start(question, number, start)
    with Ledger(folder, question.key, question.content) as ledger:
        stored = ledger.done.get(number)
    times, states = [np.zeros(1)], [State(*(row[None] for row in start))]
    for t, state in points(method, question.horizon, start):
        times.append(t)
        states.append(state)
    whole = State(*(np.concatenate(blocks) for blocks in zip(*states, strict=True)))
    return result, stored, trajectory(method, np.concatenate(times), whole)


def observe(method: Integrator, question: Question, start: State) -> Outcome:
    """What a run from a start to the horizon says."""
    observer = Observer(question.loop, method, question.tolerance, start)
    for t, state in points(method, question.horizon, start):
        observer.see(t, state)
    return observer.outcome()


def points(method: Integrator, horizon: float, start: State) -> Iterator[tuple[Floats, State]]:
    """The pieces of a run up to the horizon."""
    end = horizon + method.step / 2
    for t, state in method.pieces(start):
        keep = t <= end
        yield t[keep], State(*(column[keep] for column in state))
        if t[-1] >= horizon - method.step / 2:
            return


def physical_limit(loop: Loop, start: State) -> float:
    """A time that no controller can beat by much, s: the largest distance to travel over the top speed asked for.

    Without such a limit, the bang-bang time 2 sqrt(distance / acceleration) under the full torque of both wheels.
    """
    away = loop.offsets(start)
    distance = np.hypot(away.x, away.y)
    acceleration = (loop.torque_left + loop.torque_right) / (loop.plant.r * loop.plant.m)  # (2)
    speed = loop.limits.speed
    times = np.where(np.isfinite(speed), distance / speed, 2 * np.sqrt(distance / acceleration))
    return float(times.max())


@lru_cache(maxsize=1)
def _method(question: Question) -> Integrator:
    """The integrator of this process: building it takes as long as some seconds of simulation."""
    # Whole steps in the horizon, so that the last point is the horizon itself.
    step = question.horizon / math.ceil(question.horizon / STEP)
    piece = max(step, min(PIECE, question.horizon, step * PIECE_NUMBERS / (5 * question.loop.vehicles)))
    return make(question.method, question.loop, step=step, piece=piece)
