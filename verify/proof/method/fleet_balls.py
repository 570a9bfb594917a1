"""A fleet in ball arithmetic: states at which the model's own equations are evaluated, such as counterexamples."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, cached_property
from typing import Any

import numpy as np
from flint import arb

from ....models import energy, equations
from ....models.arrays import Array, column
from ....models.equations import Plant, State
from ....models.excitation import Excitation
from ....models.fleet import Fleet
from ....models.fleet_tables import Leader
from ....models.gains import Gains
from ....models.paper import paper_excitation, paper_fleet, paper_gains
from ....models.saturation import SCALE_NAMES
from .ball import Ball, arb_ops, ball, balls, precise

FAR = 60  # 1 - tanh(60) < 1e-51: as good as saturated, and still a true state


@dataclass(frozen=True, eq=False)
class BallFleet:
    """A fleet with gains and an excitation, all numbers as balls."""

    fleet: Fleet
    gains: Gains
    psi: Excitation

    @cached_property
    def plant(self) -> Plant:
        """The numbers of (1)-(14); the leader stands at the origin, which is a shift of the plane and no loss."""
        vehicles, zero = self.fleet.vehicles, arb(0)
        return Plant(
            self.fleet.graph.map(balls),
            m=balls(v.mass for v in vehicles),
            inertia=balls(v.inertia for v in vehicles),
            r=balls(v.wheel_radius for v in vehicles),
            arm=balls(self.fleet.arm),
            offset_x=balls(v.offset[0] for v in vehicles),
            offset_y=balls(v.offset[1] for v in vehicles),
            leader_x=zero,
            leader_y=zero,
            leader_theta=_angle(self.fleet.leader),
        )

    @cached_property
    def exact_gains(self) -> Gains:
        """The gains as balls."""
        return self.gains.map(balls)

    def psi_at(self, t: Ball) -> Ball:
        """psi(t)."""
        return self.psi.value(arb_ops(), np.array([t], dtype=object))[0]

    def excitation_bounds(self, psi_bar: Ball) -> Array:
        """c_i = sqrt2 k_i psi_bar D_i."""
        return arb(2).sqrt() * psi_bar * self.exact_gains.k_alpha * self.plant.graph.degree

    def energy_rate(self, psi: Ball, state: State) -> Ball:
        """W' of (20)."""
        damping = energy.rotational_dissipation(arb_ops(), self.exact_gains, state)
        return energy.rotational_input(arb_ops(), self.plant, self.exact_gains, psi, state) - damping

    def turning_input(self, psi: Ball, state: State) -> Array:
        """u_omega of (9)."""
        errors = equations.consensus_errors(arb_ops(), self.plant, self.exact_gains.saturation, state)
        return equations.angular_input(arb_ops(), self.exact_gains, psi, state, errors)

    def torques(self, psi: Ball, state: State) -> tuple[Array, Array]:
        """(6): left and right."""
        return equations.control(arb_ops(), self.plant, self.exact_gains, psi, state)

    def state(
        self, errors: dict[int, tuple[Any, Any]], theta: dict[int, Any], v: Any = None, omega: Any = None
    ) -> State:
        """A state given by zbar_i - z_l where it is not 0 and theta_i where it is not theta_l (i from 0)."""
        n = len(self.fleet)
        plant = self.plant

        def at(values: dict[int, Any] | None, default: Any = 0) -> Array:
            return column(_ball((values or {}).get(i, default)) for i in range(n))

        x = plant.offset_x + at({i: e[0] for i, e in errors.items()})
        y = plant.offset_y + at({i: e[1] for i, e in errors.items()})
        return State(x, y, at(theta, plant.leader_theta), at(v), at(omega))

    def worst_state(self, i: int, wheel: int, psi: Ball) -> State:
        """A state near the supremum of one wheel torque of vehicle i (0 left, 1 right), psi as given: lemma L16.

        All tanh of vehicle i are saturated; its heading is along p_v phi -/+ kappa phi_perp parallel to (1, 1).
        """
        gains, arm = self.gains, self.fleet.arm[i] * (1, -1)[wheel]
        p, kappa = gains.p_v[i], gains.k_alpha[i] * float(psi) / arm
        heading = Fraction(math.atan2(p + kappa, p - kappa))
        sign, scale = 1 if arm > 0 else -1, self.gains.saturation.columns(len(self.fleet))
        length, angle, speed, turn_rate = (FAR * _exact(scale[name][i]) for name in SCALE_NAMES)
        turns = 2 * math.ceil(angle) * arb.pi()  # whole: the angle lives on the real line, its sine and cosine do not
        theta = {i: ball(heading) - sign * turns}
        return self.state({i: (-length, -length)}, theta, {i: -speed}, {i: -turn_rate * sign})


def _exact(number: Any) -> Any:
    return number.item() if isinstance(number, np.generic) else number  # no ball is made of a NumPy integer


def _angle(leader: Leader) -> Ball:
    if leader.heading is not None:
        return ball(leader.heading)
    return arb.pi() * ball(leader.heading_deg) / 180


def _ball(value: Any) -> Ball:
    return value if isinstance(value, arb) else ball(value)


@cache
def paper() -> BallFleet:
    """The paper's fleet, gains and excitation (its coefficient read as 4 / ((2k-1) pi))."""
    return BallFleet(paper_fleet(), paper_gains(), paper_excitation())


@cache
def paper_peak() -> Ball:
    """psi(pi/5), the maximum of the paper's psi (claim psi-bar)."""
    with precise():
        return paper().psi_at(arb.pi() / 5)
