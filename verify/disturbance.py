"""What a real robot adds: sampling, delay, noise, wrong parameters, friction, a link that fails.

The controller runs at sample times, on measured states, and its torques are held in between; the vehicles move by
(1)-(2) with their true parameters and friction at the wheels. All starts are integrated together.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..models.equations import Plant, State, control, motion
from ..models.errors import InputError, UndecidedError
from ..models.fleet import Fleet
from ..models.graph import Graph
from ..models.ops import numpy_ops
from ..synthesis.rollout import Tolerance
from .loop import Floats, Loop
from .observer import distances

SUBSTEP = 0.01  # s, of the Runge-Kutta method of order 4 between samples
STICTION_SPEED = 0.01  # rad/s of a wheel, over which Coulomb friction turns from one sign to the other
SHORTEST, LONGEST, HALVINGS = 2e-3, 2.0, 8  # s, s: where the largest sample time is looked for


@dataclass(frozen=True)
class Disturbance:
    """How reality differs from (1)-(14); all zero but the sample time is the sampled controller alone."""

    sample_time: float = 0.01  # s, between two computations of the torques
    delay: float = 0.0  # s, from measuring to the wheels; rounded to whole samples
    noise_position: float = 0.0  # m, standard deviation of each coordinate measured
    noise_heading: float = 0.0  # rad
    noise_speed: float = 0.0  # m/s and rad/s
    mismatch: float = 0.0  # relative: m, I, r and the arm differ from the controller's by up to this much
    coulomb: float = 0.0  # N m at every wheel
    viscous: float = 0.0  # N m s/rad at every wheel
    lost_link: tuple[str, str] | None = None  # vehicles; the edge between them fails
    lost_at: float = 0.0  # s
    seed: int = 0


@dataclass(frozen=True, eq=False)
class Outcomes:
    """One entry per start, (B,)."""

    settling_time: Floats  # s, inf where not settled at the end
    torque_ratio: Floats  # the largest commanded |torque| over its limit; torques are held, so this is exact
    final_position: Floats  # m
    final_heading: Floats  # rad

    @property
    def fine(self) -> bool:
        """Whether all starts settle with all torques within their limits."""
        return bool(np.isfinite(self.settling_time).all() and (self.torque_ratio <= 1).all())


def checked(disturbance: Disturbance, fleet: Fleet) -> Disturbance:
    """The disturbance, if it makes sense for the fleet. Raises InputError."""
    numbers = {key: value for key, value in vars(disturbance).items() if isinstance(value, float)}
    mistakes = [
        f"{key} = {value} must be finite and >= 0" for key, value in numbers.items() if not 0 <= value < math.inf
    ]
    if disturbance.lost_link is not None:
        ends = set(disturbance.lost_link)
        if not any({a, b} == ends for a, b, _ in fleet.links.edges):
            mistakes.append(f"lost link: the fleet has no edge {' - '.join(map(repr, disturbance.lost_link))}")
    if mistakes:
        raise InputError(*mistakes)
    return disturbance


def disturbed(
    fleet: Fleet, loop: Loop, starts: Sequence[State], disturbance: Disturbance, horizon: float, tolerance: Tolerance
) -> Outcomes:
    """All starts under a disturbance. Raises UndecidedError where a state is no longer finite."""
    random, ops = np.random.default_rng(disturbance.seed), numpy_ops()
    true, state = _true_plant(loop.plant, disturbance, random), State(*map(np.stack, zip(*starts, strict=True)))
    samples, held = math.ceil(horizon / disturbance.sample_time), round(disturbance.delay / disturbance.sample_time)
    nothing = np.zeros_like(state.x)
    waiting = deque([(nothing, nothing)] * held)
    last, peak, excess = np.zeros(len(starts)), np.zeros(len(starts)), np.zeros(len(starts))
    for sample in range(samples):
        t = sample * disturbance.sample_time
        seen = _with_link_lost(fleet, loop, disturbance) if disturbance.lost_link and t >= disturbance.lost_at else loop
        torques = control(ops, seen.plant, loop.gains, loop.excitation, t, _measured(state, disturbance, random))
        waiting.append(torques)
        peak = np.maximum(peak, _ratio(loop, *torques))
        state = _step(true, state, *waiting.popleft(), disturbance)
        excess = _excess(loop, state, tolerance)
        last = np.where(excess > 1, t + disturbance.sample_time, last)
    if not all(np.isfinite(column).all() for column in state):
        raise UndecidedError(f"the disturbed motion is no longer finite by {horizon:g} s; shorten the sample time")
    position, heading = distances(loop, state)
    return Outcomes(np.where(excess > 1, np.inf, last), peak, position.max(axis=-1), heading.max(axis=-1))


def largest_sample_time(
    fleet: Fleet, loop: Loop, starts: Sequence[State], disturbance: Disturbance, horizon: float, tolerance: Tolerance
) -> float | None:
    """The largest sample time, s, at which all starts settle within torque limits, by bisection; None where none does.

    It is found between two neighbours on a logarithmic scale: shorter ones are taken to be no worse.
    """

    def fine(sample_time: float) -> bool:
        sampled = replace(disturbance, sample_time=sample_time)
        try:
            return disturbed(fleet, loop, starts, sampled, horizon, tolerance).fine
        except UndecidedError:
            return False

    low, high = math.log(SHORTEST), math.log(LONGEST)
    found = None
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        if fine(math.exp(middle)):
            low, found = middle, math.exp(middle)
        else:
            high = middle
    return found


def parts(disturbance: Disturbance) -> list[Disturbance]:
    """Sampling alone, each disturbance that is not zero with it, and all of them where there are several."""
    alone = Disturbance(disturbance.sample_time, seed=disturbance.seed)
    groups = (
        ("delay",),
        ("noise_position", "noise_heading", "noise_speed"),
        ("mismatch",),
        ("coulomb", "viscous"),
        ("lost_link", "lost_at"),
    )
    kept = [replace(alone, **{name: getattr(disturbance, name) for name in names}) for names in groups]
    single = [one for one in kept if one != alone]
    return [alone, *single, disturbance] if len(single) > 1 else [alone, *single]


def report(disturbance: Disturbance, found: Outcomes, nominal: Sequence[float | None]) -> dict[str, Any]:
    """What validation.json says of a disturbance, beside the nominal settling times of the same starts."""
    from .validation import spread

    times = [float(time) if math.isfinite(time) else None for time in found.settling_time]
    later = [a - b for a, b in zip(times, nominal, strict=True) if a is not None and b is not None]
    return {
        "disturbance": {key: value for key, value in vars(disturbance).items() if value},
        "settled": sum(time is not None for time in times),
        "settling_time_s": {**spread(times), "each": times},
        "later_than_nominal_s": {"median": float(np.median(later)), "max": max(later)} if later else None,
        "peak_torque_ratio": float(found.torque_ratio.max()),
        "final_position_error_m": float(found.final_position.max()),
        "final_heading_error_rad": float(found.final_heading.max()),
    }


# -- the parts ---------------------------------------------------------------------------------------------------------


def _true_plant(plant: Plant, disturbance: Disturbance, random: np.random.Generator) -> Plant:
    """The vehicles as they are, where the controller knows them as `plant`."""
    width = disturbance.mismatch
    factors = 1 + random.uniform(-width, width, (4, plant.graph.vehicles))
    names = ("m", "inertia", "r", "arm")
    return replace(plant, **{name: getattr(plant, name) * factor for name, factor in zip(names, factors, strict=True)})


def _measured(state: State, disturbance: Disturbance, random: np.random.Generator) -> State:
    """What the controller sees: the state and white noise, drawn for all starts together."""
    place, turn, speed = disturbance.noise_position, disturbance.noise_heading, disturbance.noise_speed
    if not (place or turn or speed):
        return state
    widths = (place, place, turn, speed, speed)
    return State(
        *(
            column + width * random.standard_normal(column.shape) if width else column
            for column, width in zip(state, widths, strict=True)
        )
    )


def _with_link_lost(fleet: Fleet, loop: Loop, disturbance: Disturbance) -> Loop:
    """The loop without an edge: both ends no longer hear each other."""
    assert disturbance.lost_link is not None  # noqa: S101
    ends = {fleet.names.index(name) for name in disturbance.lost_link}
    graph = loop.plant.graph
    gone = [{int(i), int(j)} == ends for i, j in zip(graph.tail, graph.head, strict=True)]
    weight = np.where(gone, 0.0, graph.weight)
    lost = Graph(graph.tail, graph.head, weight, graph.leader_weight)
    return replace(loop, plant=replace(loop.plant, graph=lost))


def _step(plant: Plant, state: State, tau_left: Floats, tau_right: Floats, disturbance: Disturbance) -> State:
    """One sample time under held torques."""
    steps = math.ceil(disturbance.sample_time / SUBSTEP)
    h = disturbance.sample_time / steps

    def rate(now: State) -> State:
        friction = _friction(plant, now, disturbance)
        return motion(numpy_ops(), plant, now, tau_left - friction[0], tau_right - friction[1])

    for _ in range(steps):
        k1 = rate(state)
        k2 = rate(_along(state, k1, h / 2))
        k3 = rate(_along(state, k2, h / 2))
        k4 = rate(_along(state, k3, h))
        slope = State(*((a + 2 * b + 2 * c + d) / 6 for a, b, c, d in zip(k1, k2, k3, k4, strict=True)))
        state = _along(state, slope, h)
    return state


def _friction(plant: Plant, state: State, disturbance: Disturbance) -> tuple[Any, Any]:
    """Friction torque of the left and the right wheel, N m, against their speeds."""
    if not (disturbance.coulomb or disturbance.viscous):
        return 0.0, 0.0
    # (2) conserves power: the left wheel turns at (v + arm omega) / r, the right one at (v - arm omega) / r.
    speeds = [(state.v + sign * plant.arm * state.omega) / plant.r for sign in (1, -1)]
    left, right = (disturbance.coulomb * np.tanh(s / STICTION_SPEED) + disturbance.viscous * s for s in speeds)
    return left, right


def _along(state: State, slope: State, by: float) -> State:
    return State(*(column + by * rate for column, rate in zip(state, slope, strict=True)))


def _ratio(loop: Loop, left: Floats, right: Floats) -> Floats:
    return np.asarray(np.maximum(np.abs(left) / loop.torque_left, np.abs(right) / loop.torque_right).max(axis=-1))


def _excess(loop: Loop, state: State, tolerance: Tolerance) -> Floats:
    position, heading = distances(loop, state)
    return np.asarray(np.maximum(position / tolerance.position, heading / tolerance.heading).max(axis=-1))
