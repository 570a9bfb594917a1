"""Simulates the closed loop with CasADi's CVODES, and says what happened."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..models import energy
from ..models.equations import State, control
from ..models.errors import InputError, UndecidedError
from ..models.excitation import Excitation
from ..models.files import write_whole
from ..models.fleet import Fleet, floats
from ..models.gains import Gains
from ..models.numbers import low
from ..models.ops import numpy_ops, unbounded
from ..synthesis.rollout import Deadline, Rollout, Tolerance

Floats = NDArray[np.float64]

RELTOL = ABSTOL = 1e-10  # the global error on the paper's fleet is then below 1e-7 over 300 s
STEP = 0.1  # s between stored points
PIECE = 20.0  # s between looks at the clock
LONGEST = 5000.0  # s, where no horizon is asked for and the fleet does not settle before
MAX_NUMBERS = 40_000_000  # stored numbers; beyond, points are stored less often
HOLD = 0.25  # of the settling time that an open-ended run goes on for, to see that it stays settled


@dataclass(frozen=True, eq=False)
class Trajectory:
    """A run: times (K,), and arrays (K, N) over the fleet."""

    t: Floats  # s
    state: State
    tau_left: Floats  # N m
    tau_right: Floats  # N m
    V: Floats  # (K,), (17)
    W: Floats  # (K,), (19)

    def write(self, path: Path) -> None:
        """trajectory.npz, written whole or not at all."""
        arrays = {
            **self.state._asdict(),
            "tau_left": self.tau_left,
            "tau_right": self.tau_right,
            "V": self.V,
            "W": self.W,
        }
        write_whole(path, lambda file: np.savez_compressed(file, t=self.t, **arrays))


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
    plant, numbers, deadline = fleet.plant(), gains.map(floats), Deadline(wall_limit)
    end = LONGEST if horizon is None else horizon
    step = _step(end, len(fleet))
    piece = min(max(PIECE, step), end)
    rollout = Rollout(plant, excitation, step=step, piece=piece, reltol=RELTOL, abstol=ABSTOL, bounded=bounded)
    times, states, last_outside = [np.zeros(1)], [State(*(row[None] for row in start))], 0.0
    for t, state in rollout.pieces(numbers, start):
        times.append(t)
        states.append(state)
        outside = np.flatnonzero(rollout.excess(state, tolerance) > 1)
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
    keep = t <= end + step / 2
    return _with_outputs(fleet, numbers, excitation, bounded, t[keep], State(*(block[keep] for block in state)))


def _step(end: float, vehicles: int) -> float:
    """The time between stored points: STEP, or longer where the arrays would not fit into memory."""
    return max(STEP, end * vehicles * 5 / MAX_NUMBERS)


def _with_outputs(
    fleet: Fleet, gains: Gains, excitation: Excitation, bounded: bool, t: Floats, state: State
) -> Trajectory:
    plant = fleet.plant()
    ops = numpy_ops() if bounded else unbounded(numpy_ops())
    tau_left, tau_right = control(ops, plant, gains, excitation, t[:, None], state)
    V = energy.translational(ops, plant, gains, state)
    W = energy.rotational(ops, plant, gains, state)
    return Trajectory(t, state, tau_left, tau_right, V, W)


def summarize(fleet: Fleet, run: Trajectory, tolerance: Tolerance = Tolerance()) -> dict[str, Any]:  # noqa: B008
    """The content of summary.json."""
    position, heading = position_errors(fleet, run.state), heading_errors(fleet, run.state)
    excess = np.maximum(position.max(axis=1) / tolerance.position, heading.max(axis=1) / tolerance.heading)
    peaks = peak_torque_ratios(fleet, run)
    return {
        "settling_time_s": settling_time(run.t, excess),
        "tolerance": {"position_m": tolerance.position, "heading_rad": tolerance.heading},
        "horizon_s": float(run.t[-1]),
        "peak_torque_ratio": float(peaks.max()),
        "final_position_error_m": float(position[-1].max()),
        "final_heading_error_rad": float(heading[-1].max()),
        "max_V_increase": float(max(0.0, np.max(np.diff(run.V), initial=0.0))),
        "peak_speed": float(np.abs(run.state.v).max()),
        "peak_turn_rate": float(np.abs(run.state.omega).max()),
    }


def position_errors(fleet: Fleet, state: State) -> Floats:
    """Distance of every vehicle from its place in the formation, m, (K, N)."""
    plant = fleet.plant()
    return np.asarray(np.hypot(state.x - plant.offset_x - plant.leader_x, state.y - plant.offset_y - plant.leader_y))


def heading_errors(fleet: Fleet, state: State) -> Floats:
    """|theta - theta_l| on the real line, rad, (K, N)."""
    return np.asarray(np.abs(state.theta - fleet.plant().leader_theta))


def settling_time(t: Floats, excess: Floats) -> float | None:
    """The first stored time from which `excess` (error over tolerance) stays at or below 1; None where it does not."""
    outside = np.flatnonzero(excess > 1)
    if not outside.size:
        return 0.0
    return float(t[outside[-1] + 1]) if outside[-1] + 1 < len(t) else None


def peak_torque_ratios(fleet: Fleet, run: Trajectory) -> Floats:
    """The largest |torque| over its limit, of either wheel, (N,)."""
    left = floats([low(vehicle.torque_limit.left) for vehicle in fleet.vehicles])
    right = floats([low(vehicle.torque_limit.right) for vehicle in fleet.vehicles])
    return np.asarray(np.maximum(np.abs(run.tau_left).max(axis=0) / left, np.abs(run.tau_right).max(axis=0) / right))
