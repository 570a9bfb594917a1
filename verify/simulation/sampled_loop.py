"""The sampled closed loop with disturbances.

The controller runs at sample times, on measured states, and its torques are held in between; the vehicles move by
(1)-(2) with their true parameters and friction at the wheels. All starts are integrated together, (B, N).
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...models.algebra.ops import numpy_ops
from ...models.equations import Plant, State, control, motion
from ...models.errors import UndecidedError
from ...models.fleet import Fleet
from ...models.friction import friction_torques
from ...models.graph import Graph
from ...models.off_axle import OffAxle
from ...models.tolerance import Tolerance
from .closed_loop import ClosedLoop, Floats
from .disturbance import Disturbance
from .room import Room
from .settling import PART, Approach, confirmed_by
from .summary import Summary
from .trajectory import Trajectory

SUBSTEP = 0.01  # s, of the Runge-Kutta method of order 4 between samples
STORED = 0.1  # s between the points of a stored run


@dataclass(frozen=True, eq=False)
class SampledLoop:
    """A closed loop, the disturbance it runs under, how long it runs, and what counts as settled."""

    fleet: Fleet
    loop: ClosedLoop
    disturbance: Disturbance
    horizon: float  # s
    tolerance: Tolerance

    def outcomes(self, starts: Sequence[State]) -> Outcomes:
        """All starts together. Raises UndecidedError where a state is no longer finite."""
        together = State(*map(np.stack, zip(*starts, strict=True)))
        return self.outcomes_of(self.samples(together))

    def run(self, start: State, nominal: Summary) -> tuple[Summary, Trajectory]:
        """One start: the summary, beside that of the nominal run, and a trajectory.

        The trajectory has a point each STORED s or sample time; its torques are the commanded ones.
        """
        every, stored = max(1, round(STORED / self.disturbance.sample_time)), []

        def storing() -> Iterator[Sample]:
            for number, sample in enumerate(self.samples(State(*(column[None] for column in start)))):
                if number % every == 0:
                    stored.append(sample)
                yield sample

        outcomes = self.outcomes_of(storing())
        state = State(*map(np.concatenate, zip(*(sample.before for sample in stored), strict=True)))
        t, left, right = zip(*((sample.t, sample.tau_left, sample.tau_right) for sample in stored), strict=True)
        energies = self.loop.translational_energy(state), self.loop.rotational_energy(state)
        trajectory = Trajectory(np.array(t), state, np.concatenate(left), np.concatenate(right), *energies)
        return self._summary(outcomes, trajectory, nominal), trajectory

    def samples(self, state: State) -> Iterator[Sample]:
        """The motion from a state (..., N), sample by sample. Raises UndecidedError where it is not finite."""
        loop, disturbance = self.loop, self.disturbance
        random = np.random.default_rng(disturbance.seed)
        true = _true_plant(loop.plant, disturbance, random)
        off_axle = OffAxle.of(self.fleet) if disturbance.com_offset else None
        zero = np.zeros_like(state.x)
        waiting = deque([(zero, zero)] * round(disturbance.delay / disturbance.sample_time))
        for number in range(math.ceil(self.horizon / disturbance.sample_time)):
            t = number * disturbance.sample_time
            lost = disturbance.lost_link is not None and t >= disturbance.lost_at
            plant = _with_link_lost(self.fleet, loop.plant, disturbance) if lost else loop.plant
            measured = measured_state(state, disturbance, random)
            torques = control(loop.ops, plant, loop.gains, loop.psi(t), measured)
            waiting.append(torques)
            before, state = state, _step(true, off_axle, state, *waiting.popleft(), disturbance)
            yield Sample(t, before, state, *torques)
        if not all(np.isfinite(column).all() for column in state):
            raise UndecidedError(
                f"the disturbed motion is no longer finite by {self.horizon:g} s; shorten the sample time"
            )

    def outcomes_of(self, samples: Iterable[Sample]) -> Outcomes:
        """What the motion comes to that these samples are of, (B, N) each, by whatever physics."""
        last: Any = 0.0
        peak: Any = 0.0
        errors: list[Any] = [0.0, 0.0]  # the largest excess in the part of the run before the last, and in the last
        loop = self.loop
        for sample in samples:
            left, right = np.abs(sample.tau_left) / loop.torque_left, np.abs(sample.tau_right) / loop.torque_right
            peak = np.maximum(peak, np.maximum(left, right).max(axis=-1))
            excess = loop.excess(sample.after, self.tolerance)
            time = sample.t + self.disturbance.sample_time
            last = np.where(excess > 1, time, last)
            if time >= (1 - 2 * PART) * self.horizon:
                part = int(time >= (1 - PART) * self.horizon)
                errors[part] = np.maximum(errors[part], excess)
        position, heading = loop.distances(sample.after)
        settled = (excess <= 1) & (last <= confirmed_by(loop, self.horizon))
        pairs = np.broadcast_arrays(*errors, peak)[:2]
        approach = tuple(Approach.of(*pair) for pair in zip(*pairs, strict=True))
        return Outcomes(np.where(settled, last, np.inf), approach, peak, position.max(axis=-1), heading.max(axis=-1))

    def _summary(self, outcomes: Outcomes, run: Trajectory, nominal: Summary) -> Summary:
        """A broken promise of the nominal run is not hidden by the disturbed one."""
        peak = float(outcomes.torque_ratio[0])
        broken = [f"a commanded wheel torque is {peak:.6g} of its limit"] if peak > 1 else []
        return Summary(
            settling_time=float(outcomes.settling_time[0]),
            approach=outcomes.approach[0],
            tolerance=self.tolerance,
            horizon=nominal.horizon,
            peak_torque_ratio=peak,
            final_position_error=float(outcomes.final_position[0]),
            final_heading_error=float(outcomes.final_heading[0]),
            max_V_increase=float(np.diff(run.V).max(initial=0)),
            peak_speed=float(np.abs(run.state.v).max()),
            peak_turn_rate=float(np.abs(run.state.omega).max()),
            violations=(*nominal.violations, *broken),
            room=Room.of(run, self.fleet.names),
            disturbance=self.disturbance,
            nominal=nominal,
        )


@dataclass(frozen=True, eq=False)
class Outcomes:
    """One entry per start, (B,)."""

    settling_time: Floats  # s, inf where not settled at the end
    approach: tuple[Approach, ...]  # how the error moves at the end, if not settled
    torque_ratio: Floats  # the largest commanded |torque| divided by its limit; torques are held, so this is exact
    final_position: Floats  # m
    final_heading: Floats  # rad

    @property
    def acceptable(self) -> bool:
        """Whether all starts settle with all torques within their limits."""
        return bool(np.isfinite(self.settling_time).all() and (self.torque_ratio <= 1).all())


@dataclass(frozen=True, eq=False)
class Sample:
    """One sample time of a disturbed motion."""

    t: float  # s, when it begins
    before: State
    after: State
    tau_left: Floats  # N m, commanded from the measurement at t
    tau_right: Floats  # N m


# -- the parts ---------------------------------------------------------------------------------------------------------


def _true_plant(plant: Plant, disturbance: Disturbance, random: np.random.Generator) -> Plant:
    """The vehicles as they are, where the controller knows them as `plant`."""
    width = disturbance.mismatch
    factors = 1 + random.uniform(-width, width, (4, plant.graph.vehicles))
    names = ("m", "inertia", "r", "arm")
    return replace(plant, **{name: getattr(plant, name) * factor for name, factor in zip(names, factors, strict=True)})


def measured_state(state: State, disturbance: Disturbance, random: np.random.Generator) -> State:
    """The state with white noise, as the controller measures it."""
    position, heading, speed = disturbance.noise_position, disturbance.noise_heading, disturbance.noise_speed
    if not (position or heading or speed):
        return state
    widths = (position, position, heading, speed, speed)
    return State(
        *(
            column + width * random.standard_normal(column.shape) if width else column
            for column, width in zip(state, widths, strict=True)
        )
    )


def _with_link_lost(fleet: Fleet, plant: Plant, disturbance: Disturbance) -> Plant:
    """The plant without an edge: both ends no longer hear each other."""
    assert disturbance.lost_link is not None  # noqa: S101
    ends = {fleet.names.index(name) for name in disturbance.lost_link}
    graph = plant.graph
    lost = [{int(i), int(j)} == ends for i, j in zip(graph.tail, graph.head, strict=True)]
    weight = np.where(lost, 0.0, graph.weight)
    return replace(plant, graph=Graph(graph.tail, graph.head, weight, graph.leader_weight))


def _step(
    plant: Plant,
    off_axle: OffAxle | None,
    state: State,
    tau_left: Floats,
    tau_right: Floats,
    disturbance: Disturbance,
) -> State:
    """One sample time under held torques, by the classical Runge-Kutta method; friction is constant over its steps."""
    steps = math.ceil(disturbance.sample_time / SUBSTEP)
    h = disturbance.sample_time / steps

    def rate(now: State) -> State:
        rates = motion(numpy_ops(), plant, now, *torques)
        if off_axle is None:
            return rates
        v_rate, omega_rate = off_axle.accelerations(plant, now, *torques)
        return rates._replace(v=v_rate, omega=omega_rate)

    for _ in range(steps):
        torques = _after_friction(plant, state, (tau_left, tau_right), disturbance, h)
        k1 = rate(state)
        k2 = rate(_along(state, k1, h / 2))
        k3 = rate(_along(state, k2, h / 2))
        k4 = rate(_along(state, k3, h))
        slope = State(*((a + 2 * b + 2 * c + d) / 6 for a, b, c, d in zip(k1, k2, k3, k4, strict=True)))
        state = _along(state, slope, h)
    return state


def _after_friction(
    plant: Plant, state: State, torques: tuple[Floats, Floats], disturbance: Disturbance, h: float
) -> tuple[Floats, Floats]:
    """What friction leaves of the left and the right torque over a step of h seconds, N m."""
    if not (disturbance.coulomb or disturbance.viscous):
        return torques
    lost = friction_torques(_clip, plant, state, torques, disturbance.coulomb, disturbance.viscous, h)
    return torques[0] - lost[0], torques[1] - lost[1]


def _clip(x: Floats, limit: float) -> Floats:
    return np.clip(x, -limit, limit)


def _along(state: State, slope: State, by: float) -> State:
    return State(*(column + by * rate for column, rate in zip(state, slope, strict=True)))
