"""Simulates the closed loop, and says what happened: settling and peaks to the accuracy of the integrator."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...models.deadline import Deadline
from ...models.equations import State
from ...models.errors import InputError, UndecidedError
from ...models.excitation import Excitation
from ...models.fleet import Fleet
from ...models.gains import Gains
from ...models.tolerance import Tolerance
from .engine import make, named
from .integrators import Integrator
from .invariants import violations as broken_promises
from .loop import Loop
from .observer import Observer, Outcome, Peak, distances
from .recording import Recording

Floats = NDArray[np.float64]

ROUNDING = 64 * 2.0**-52  # of the largest coordinate: what thousands of steps in doubles lose at any tolerance
LOOSER = 10.0  # times its tolerance: the run that an integrator's error is measured against
STEP = 0.1  # s between stored points
PIECE = 20.0  # s between looks at the clock
LONGEST = 5000.0  # s, where no horizon is asked for and the fleet does not settle before
MAX_NUMBERS = 40_000_000  # stored numbers; beyond, points are stored less often
LOOK = 250_000  # numbers that are looked at together when a run is measured
HOLD = 0.25  # of the settling time that an open-ended run goes on for, to see that it stays settled


@dataclass(frozen=True, eq=False)
class Trajectory(Recording):
    """A run that can be looked at between its points."""

    integrator: Integrator  # that made it, with its loop

    @property
    def loop(self) -> Loop:
        """What was integrated."""
        return self.integrator.loop


def simulate(
    fleet: Fleet,
    gains: Gains,
    excitation: Excitation,
    *,
    start: State | None = None,
    bounded: bool = True,
    horizon: float | None = None,
    tolerance: Tolerance = Tolerance(),  # noqa: B008 -- frozen
    wall_limit: float = 600.0,
    engine: str = "auto",
    progress: Any = lambda _what, _fraction: None,
) -> Trajectory:
    """A run of the fleet from its own start (or `start`) under gains and an excitation.

    Args:
        fleet: the fleet.
        gains: the gains, exact or floats, (N,).
        excitation: psi.
        start: the initial state, each (N,); None takes the fleet file's.
        bounded: False for the paper's unbounded comparison scheme, tanh(s) -> s.
        horizon: s; None runs until the fleet has settled and stayed so, or LONGEST.
        tolerance: what counts as settled.
        wall_limit: s of wall clock.
        engine: "cvodes", "scale" (large fleets), or "auto", which chooses from the number of vehicles.
        progress: called with what is going on and the fraction done.

    Raises:
        InputError: where neither the fleet file nor the caller gives a start.
        UndecidedError: where the integrator stalls or the wall-clock limit passes.

    """
    start = fleet.start() if start is None else start
    if start is None:
        raise InputError(
            "simulate: a vehicle of the fleet file has no start; add start = { position, heading } to each"
        )
    loop, deadline = Loop.of(fleet, gains, excitation, bounded=bounded), Deadline(wall_limit)
    end = LONGEST if horizon is None else horizon
    step = _step(end, len(fleet))
    integrator = make(named(engine, len(fleet)), loop, step=step, piece=min(max(PIECE, step), end))
    times, states, last_outside = [np.zeros(1)], [State(*(row[None] for row in start))], 0.0
    for t, state in integrator.pieces(start):
        times.append(t)
        states.append(state)
        outside = np.flatnonzero(_excess(loop, state, tolerance) > 1)
        last_outside = float(t[outside[-1]]) if outside.size else last_outside
        settled = horizon is None and t[-1] > (1 + HOLD) * last_outside + PIECE
        progress("simulating", min(1.0, float(t[-1]) / end))
        if settled or t[-1] >= end - step / 2:
            break
        if deadline.passed:
            raise UndecidedError(
                f"simulate: {wall_limit:g} s of wall clock passed at t = {t[-1]:g} s of {end:g} s; shorten --horizon"
            )
    t = np.concatenate(times)
    state = State(*(np.concatenate(blocks) for blocks in zip(*states, strict=True)))
    count = int(np.searchsorted(t, end + step / 2))
    return trajectory(integrator, t[:count], State(*(block[:count] for block in state)))


def _step(end: float, vehicles: int) -> float:
    """The time between stored points: STEP, or longer where the arrays would not fit into memory."""
    return max(STEP, end * vehicles * 5 / MAX_NUMBERS)


def trajectory(integrator: Integrator, t: Floats, state: State) -> Trajectory:
    """The trajectory through the states (K, N) at the times (K,), with its torques and energies."""
    loop = integrator.loop
    return Trajectory(
        t, state, *loop.torques(t, state), loop.translational_energy(state), loop.rotational_energy(state), integrator
    )


def summarize(fleet: Fleet, run: Trajectory, tolerance: Tolerance = Tolerance()) -> dict[str, Any]:  # noqa: B008
    """The content of summary.json: settling as an event, peaks between the stored points found."""
    outcome = observe(run, tolerance)
    settled = np.isfinite(outcome.settling_time)
    return {
        "settling_time_s": outcome.settling_time if settled else None,
        "tolerance": {"position_m": tolerance.position, "heading_rad": tolerance.heading},
        "horizon_s": float(run.t[-1]),
        "peak_torque_ratio": outcome.torque_ratio.value,
        "peak_torque": where(fleet, outcome.torque_ratio),
        "final_position_error_m": outcome.final_position,
        "final_heading_error_rad": outcome.final_heading,
        "max_V_increase": outcome.energy_rise,
        "peak_speed": outcome.speed.value,
        "peak_turn_rate": outcome.turn_rate.value,
        "violations": violations(run, outcome, fleet.names),
    }


def violations(run: Trajectory, outcome: Outcome, names: Sequence[str]) -> list[str]:
    """What the theorem promises of a run of the bounded scheme and this one breaks, one sentence each."""
    start = State(*(column[0] for column in run.state))
    return broken_promises(run.loop, outcome, start, run.integrator.tolerance, names)


def where(fleet: Fleet, peak: Peak) -> dict[str, Any]:
    """The time and the vehicle of a peak."""
    return {"time_s": peak.time, "vehicle": fleet.names[peak.vehicle]}


def observe(run: Trajectory, tolerance: Tolerance) -> Outcome:
    """What a stored run says, refined between its points by its own integrator."""
    observer = Observer(run.loop, run.integrator, tolerance, State(*(column[0] for column in run.state)))
    rows = max(1, LOOK // run.loop.vehicles)
    for begin in range(1, len(run.t), rows):
        part = slice(begin, begin + rows)
        observer.see(run.t[part], State(*(column[part] for column in run.state)))
    return observer.outcome()


def integration_error(run: Trajectory) -> dict[str, float]:
    """The largest difference to a run at LOOSER times the tolerance, over all stored points.

    It is the error of that looser run, up to the smaller one of `run` itself: an estimate from above of the latter.
    Where both are at the rounding of doubles they may agree by chance: no error below ROUNDING is reported.
    """
    looser = run.integrator.with_tolerance(LOOSER * run.integrator.tolerance)
    largest_x, largest_y, heading = (
        ROUNDING * float(np.abs(column).max()) for column in (run.state.x, run.state.y, run.state.theta)
    )
    position, seen = float(np.hypot(largest_x, largest_y)), 1
    for t, state in looser.pieces(State(*(column[0] for column in run.state))):
        part = slice(seen, min(seen + len(t), len(run.t)))
        count = part.stop - part.start
        x, y, theta = (getattr(run.state, name)[part] - getattr(state, name)[:count] for name in ("x", "y", "theta"))
        position = max(position, float(np.hypot(x, y).max(initial=0)))
        heading = max(heading, float(np.abs(theta).max(initial=0)))
        seen = part.stop
        if seen >= len(run.t):
            break
    return {"integration_error_m": position, "integration_error_rad": heading}


def settling_time(t: Floats, excess: Floats) -> float | None:
    """The first stored time from which `excess` (error over tolerance) stays at or below 1; None where it does not."""
    outside = np.flatnonzero(excess > 1)
    if not outside.size:
        return 0.0
    return float(t[outside[-1] + 1]) if outside[-1] + 1 < len(t) else None


def _excess(loop: Loop, state: State, tolerance: Tolerance) -> Floats:
    """The larger of both errors over their tolerances, (K,)."""
    position, heading = distances(loop, state)
    return np.asarray(np.maximum(position / tolerance.position, heading / tolerance.heading).max(axis=1))
