"""What a real robot adds: sampling, delay, noise, wrong parameters, friction, a link that fails.

The controller runs at sample times, on measured states, and its torques are held in between; the vehicles move by
(1)-(2) with their true parameters and friction at the wheels. All starts are integrated together.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...models.algebra.ops import numpy_ops
from ...models.equations import Plant, State, control, motion
from ...models.errors import InputError, UndecidedError
from ...models.fleet import Fleet
from ...models.fleet_tables import DisturbanceTable
from ...models.graph import Graph
from ...models.tolerance import Tolerance
from .loop import Floats, Loop
from .observer import distances
from .recording import Recording

SUBSTEP = 0.01  # s, of the Runge-Kutta method of order 4 between samples
STICTION_SPEED = 0.01  # rad/s of a wheel, over which Coulomb friction turns from one sign to the other
SHORTEST, LONGEST, HALVINGS = 2e-3, 2.0, 8  # s, s: where the largest sample time is looked for
RANGES = {"sample_time": (1e-4, 10.0), "delay": (0.0, 100.0), "mismatch": (0.0, 0.9)}
RECORDED = 0.1  # s between the points of a run that is kept


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


def of_table(table: DisturbanceTable | None, seed: int = 0) -> Disturbance:
    """What the [disturbance] table of a fleet file asks for; nothing but the default sample time without one."""
    if table is None:
        return Disturbance(seed=seed)
    given = {name: value for name, value in table if value is not None}
    numbers = {name: float(value) for name, value in given.items() if name != "lost_link"}
    return Disturbance(**numbers, lost_link=table.lost_link, seed=seed)


def checked(disturbance: Disturbance, fleet: Fleet) -> Disturbance:
    """The disturbance, if it makes sense for the fleet. Raises InputError."""
    numbers = {key: value for key, value in vars(disturbance).items() if isinstance(value, float)}
    mistakes = [
        f"{key} = {value} must be from {low:g} to {high:g}"
        for key, value in numbers.items()
        for low, high in [RANGES.get(key, (0.0, 1e6))]
        if not low <= value <= high
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
    together = State(*map(np.stack, zip(*starts, strict=True)))
    return _outcomes(loop, tolerance, disturbance, _samples(fleet, loop, together, disturbance, horizon))


def disturbed_run(
    fleet: Fleet, loop: Loop, start: State, disturbance: Disturbance, horizon: float, tolerance: Tolerance
) -> tuple[Outcomes, Recording]:
    """One start under a disturbance: its outcome, and a run with a point each RECORDED s or sample time.

    The torques of the run are those that are commanded.
    """
    every, kept = max(1, round(RECORDED / disturbance.sample_time)), []

    def kept_now_and_then() -> Iterator[_Sample]:
        for number, sample in enumerate(_samples(fleet, loop, State(*(c[None] for c in start)), disturbance, horizon)):
            if number % every == 0:
                kept.append(sample)
            yield sample

    outcome = _outcomes(loop, tolerance, disturbance, kept_now_and_then())
    state = State(*map(np.concatenate, zip(*(sample.before for sample in kept), strict=True)))
    t, left, right = zip(*((sample.t, sample.tau_left, sample.tau_right) for sample in kept), strict=True)
    energies = loop.translational_energy(state), loop.rotational_energy(state)
    return outcome, Recording(np.array(t), state, np.concatenate(left), np.concatenate(right), *energies)


def disturbed_summary(
    outcome: Outcomes, run: Recording, tolerance: Tolerance, disturbance: Disturbance, nominal: dict[str, Any]
) -> dict[str, Any]:
    """The content of summary.json for a disturbed run of one start, with the nominal one beside it."""
    time = float(outcome.settling_time[0])
    peak = float(outcome.torque_ratio[0])
    broken = [f"a commanded wheel torque is {peak:.6g} of its limit"] if peak > 1 else []
    return {
        "settling_time_s": time if math.isfinite(time) else None,
        "tolerance": {"position_m": tolerance.position, "heading_rad": tolerance.heading},
        "horizon_s": nominal["horizon_s"],
        "peak_torque_ratio": peak,
        "final_position_error_m": float(outcome.final_position[0]),
        "final_heading_error_rad": float(outcome.final_heading[0]),
        "max_V_increase": float(np.diff(run.V).max(initial=0)),
        "peak_speed": float(np.abs(run.state.v).max()),
        "peak_turn_rate": float(np.abs(run.state.omega).max()),
        "violations": [*nominal["violations"], *broken],
        "disturbance": _said(disturbance),
        "nominal": nominal,
    }


@dataclass(frozen=True, eq=False)
class _Sample:
    """One sample time of a disturbed motion."""

    t: float  # s, when it begins
    before: State
    after: State
    tau_left: Floats  # N m, commanded from the measurement at t
    tau_right: Floats  # N m


def _samples(fleet: Fleet, loop: Loop, state: State, disturbance: Disturbance, horizon: float) -> Iterator[_Sample]:
    """The disturbed motion from a state (..., N), sample after sample. Raises UndecidedError where it is not finite."""
    random = np.random.default_rng(disturbance.seed)
    true = _true_plant(loop.plant, disturbance, random)
    nothing = np.zeros_like(state.x)
    waiting = deque([(nothing, nothing)] * round(disturbance.delay / disturbance.sample_time))
    for number in range(math.ceil(horizon / disturbance.sample_time)):
        t = number * disturbance.sample_time
        seen = _with_link_lost(fleet, loop, disturbance) if disturbance.lost_link and t >= disturbance.lost_at else loop
        torques = control(loop.ops, seen.plant, loop.gains, loop.psi(t), _measured(state, disturbance, random))
        waiting.append(torques)
        before, state = state, _step(true, state, *waiting.popleft(), disturbance)
        yield _Sample(t, before, state, *torques)
    if not all(np.isfinite(column).all() for column in state):
        raise UndecidedError(f"the disturbed motion is no longer finite by {horizon:g} s; shorten the sample time")


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


def in_words(said: dict[str, Any]) -> str:
    """What is disturbed, for a reader; `said` is the entry "disturbance" of a report."""
    return ", ".join(f"{name} {value}" for name, value in said.items() if name != "seed")


def _said(disturbance: Disturbance) -> dict[str, Any]:
    return {name: value for name, value in vars(disturbance).items() if value}


def report(disturbance: Disturbance, found: Outcomes, nominal: Sequence[float | None]) -> dict[str, Any]:
    """What validation.json says of a disturbance, beside the nominal settling times of the same starts."""
    from ..validation.statistics import spread

    times = [float(time) if math.isfinite(time) else None for time in found.settling_time]
    later = [a - b for a, b in zip(times, nominal, strict=True) if a is not None and b is not None]
    return {
        "disturbance": _said(disturbance),
        "settled": sum(time is not None for time in times),
        "settling_time_s": {**spread(times), "each": times},
        "later_than_nominal_s": {"median": float(np.median(later)), "max": max(later)} if later else None,
        "peak_torque_ratio": float(found.torque_ratio.max()),
        "final_position_error_m": float(found.final_position.max()),
        "final_heading_error_rad": float(found.final_heading.max()),
    }


def _outcomes(loop: Loop, tolerance: Tolerance, disturbance: Disturbance, samples: Iterator[_Sample]) -> Outcomes:
    """What all starts of a disturbed motion, (B, N), come to."""
    last: Any = 0.0
    peak: Any = 0.0
    for sample in samples:
        peak = np.maximum(peak, _ratio(loop, sample.tau_left, sample.tau_right))
        excess = _excess(loop, sample.after, tolerance)
        last = np.where(excess > 1, sample.t + disturbance.sample_time, last)
    position, heading = distances(loop, sample.after)
    return Outcomes(np.where(excess > 1, np.inf, last), peak, position.max(axis=-1), heading.max(axis=-1))


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
