"""Simulates the closed loop; settling time and peaks are measured to the accuracy of the integrator."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...models.deadline import Deadline
from ...models.equations import State
from ...models.errors import InputError, UndecidedError
from ...models.excitation import Excitation
from ...models.fleet import Fleet
from ...models.gain_checks import exact_gains
from ...models.gains import Gains
from ...models.tolerance import Tolerance
from .closed_loop import ClosedLoop, Floats
from .engines import engine_name, make_integrator
from .integrators import Integrator
from .invariants import violations
from .monitor import Monitor, Outcome
from .room import Room
from .summary import IntegrationError, Summary
from .trajectory import Trajectory

ROUNDING = 64 * 2.0**-52  # of the largest coordinate: rounding error after thousands of steps, whatever the tolerance
LOOSER = 10.0  # times the tolerance: a second run with it measures the integration error
STEP = 0.1  # s between stored points
PIECE = 20.0  # s of simulated time between two checks of the clock
LONGEST = 5000.0  # s, end of a run without a horizon that does not settle earlier
MAX_NUMBERS = 40_000_000  # stored numbers; a run that would have more gets a longer step between stored points
MEASURED_TOGETHER = 250_000  # numbers of a stored run that are measured at once
HOLD = 0.25  # share of the settling time: a run without a horizon goes on for so long, to see that it stays settled

Progress = Callable[[str, float], None]


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
    progress: Progress = lambda _what, _fraction: None,
) -> Trajectory:
    """A run of the fleet from its own start (or `start`) under gains and an excitation.

    Args:
        fleet: the fleet.
        gains: the gains, (N,), of any kind of number that `models.gain_checks.exact_gains` takes.
        excitation: psi.
        start: the initial state, each (N,); None takes the fleet file's.
        bounded: False for the paper's unbounded comparison scheme, tanh(s) -> s.
        horizon: s; None runs until the fleet has settled and stayed so, or LONGEST.
        tolerance: the errors within which the fleet counts as settled.
        wall_limit: s of wall clock.
        engine: "cvodes", "scale" (large fleets), or "auto", which chooses from the number of vehicles.
        progress: called with the name of the step and the fraction done.

    Raises:
        InputError: if neither the fleet file nor the caller gives a start, or for gains that are not numbers > 0.
        UndecidedError: if the integrator stalls or the wall-clock limit passes.

    """
    start = fleet.start() if start is None else start
    if start is None:
        raise InputError(
            "simulate: a vehicle of the fleet file has no start; add start = { position, heading } to each"
        )
    loop = ClosedLoop.of(fleet, exact_gains(gains, fleet.names), excitation, bounded=bounded)
    deadline = Deadline(wall_limit)
    end = LONGEST if horizon is None else horizon
    step = _step(end, len(fleet))
    engine = engine_name(engine, len(fleet))
    integrator = make_integrator(engine, loop, step=step, piece=min(max(PIECE, step), end))
    times, states, last_outside = [np.zeros(1)], [State(*(row[None] for row in start))], 0.0
    for t, state in integrator.pieces(start):
        times.append(t)
        states.append(state)
        outside = np.flatnonzero(loop.excess(state, tolerance) > 1)
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
    """The time between stored points: STEP, or longer if the arrays would not fit into memory."""
    return max(STEP, end * vehicles * 5 / MAX_NUMBERS)


def trajectory(integrator: Integrator, t: Floats, state: State) -> Trajectory:
    """The trajectory through the states (K, N) at the times (K,), with its torques and energies."""
    loop = integrator.loop
    return Trajectory(
        t, state, *loop.torques(t, state), loop.translational_energy(state), loop.rotational_energy(state), integrator
    )


def summarize(
    fleet: Fleet,
    run: Trajectory,
    tolerance: Tolerance = Tolerance(),  # noqa: B008 -- frozen
    *,
    with_error: bool = False,
) -> Summary:
    """Settling time, peaks and broken promises of a run of `simulate`; `with_error` adds its integration error."""
    integrator, outcome = run.made_by, measure(run, tolerance)
    broken = violations(integrator.loop, outcome, run.start, integrator.tolerance, fleet.names)
    peak = outcome.torque_ratio
    return Summary(
        settling_time=outcome.settling_time,
        approach=outcome.approach,
        tolerance=tolerance,
        horizon=float(run.t[-1]),
        peak_torque_ratio=peak.value,
        peak_torque=peak.named(fleet.names),
        final_position_error=outcome.final_position,
        final_heading_error=outcome.final_heading,
        max_V_increase=outcome.energy_rise,
        peak_speed=outcome.speed.value,
        peak_turn_rate=outcome.turn_rate.value,
        violations=broken,
        room=Room.of(run, fleet.names),
        integration_error=integration_error(run) if with_error else None,
    )


def measure(run: Trajectory, tolerance: Tolerance) -> Outcome:
    """Settling time and peaks of a run of `simulate`, refined between its points by its own integrator."""
    integrator = run.made_by
    monitor = Monitor(integrator.loop, integrator, tolerance, run.start)
    rows = max(1, MEASURED_TOGETHER // integrator.loop.vehicles)
    for begin in range(1, len(run.t), rows):
        part = slice(begin, begin + rows)
        monitor.update(run.t[part], State(*(column[part] for column in run.state)))
    return monitor.outcome()


def integration_error(run: Trajectory) -> IntegrationError:
    """The largest difference to a run at LOOSER times the tolerance, over all stored points.

    This is the error of the looser run, up to the smaller error of `run` itself: an upper estimate of the latter.
    Two runs at the rounding of doubles may agree by chance, so no error below ROUNDING is reported.
    """
    integrator = run.made_by
    looser = integrator.with_tolerance(LOOSER * integrator.tolerance)
    largest_x, largest_y, heading = (
        ROUNDING * float(np.abs(column).max()) for column in (run.state.x, run.state.y, run.state.theta)
    )
    position, compared = float(np.hypot(largest_x, largest_y)), 1
    for t, state in looser.pieces(run.start):
        part = slice(compared, min(compared + len(t), len(run.t)))
        count = part.stop - part.start
        x, y, theta = (getattr(run.state, name)[part] - getattr(state, name)[:count] for name in ("x", "y", "theta"))
        position = max(position, float(np.hypot(x, y).max(initial=0)))
        heading = max(heading, float(np.abs(theta).max(initial=0)))
        compared = part.stop
        if compared >= len(run.t):
            break
    return IntegrationError(position, heading)
