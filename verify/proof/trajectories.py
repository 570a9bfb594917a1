"""The two boundedness witnesses as motions: evidence beside the proof, never part of it.

SciPy's DOP853 integrates the model's equations here, so that nothing depends on the simulator that the tool ships.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...models import energy
from ...models.algebra.ops import numpy_ops
from ...models.arrays import floats
from ...models.equations import State, closed_loop
from ...models.excitation import Excitation
from ...models.fleet import Fleet
from ...models.gains import Gains
from ...models.paper import paper_excitation, paper_fleet, paper_gains

Floats = NDArray[np.float64]
METHOD = {"method": "DOP853", "rtol": 1e-7, "atol": 1e-9}


@dataclass(frozen=True, eq=False)
class Motion:
    """A simulated motion: times (T,) and the five state parts, each (T, N)."""

    t: Floats
    state: State


def simulate(fleet: Fleet, gains: Gains, psi: Excitation, start: State, horizon: float, t0: float = 0.0) -> Motion:
    """Integrate (13)-(14) from t0 over `horizon` seconds."""
    from scipy.integrate import solve_ivp

    ops, plant, numbers = numpy_ops(), fleet.plant(), gains.map(floats)

    def rate(t: float, flat: Floats) -> Floats:
        return np.concatenate(closed_loop(ops, plant, numbers, psi.value(ops, t), State(*flat.reshape(5, -1))))

    span = (t0, t0 + horizon)
    found = solve_ivp(rate, span, np.concatenate(start), t_eval=np.linspace(*span, 2001), **METHOD)
    return Motion(found.t, State(*np.moveaxis(found.y.reshape(5, -1, found.t.size), 2, 1)))


def rising_energy(horizon: float = 30.0) -> tuple[Motion, Floats]:
    """The paper's fleet from the state where W' = +1.234 at t = pi/5, although |omega_1| >= 1; the motion and W(t)."""
    fleet, gains, psi = paper_fleet(), paper_gains(), paper_excitation()
    plant = fleet.plant()
    x, y = plant.offset_x + plant.leader_x, plant.offset_y + plant.leader_y
    x, y = x + np.array([40, -40, 0, 0, 0, 0.0]), y + np.array([-40, 40, 0, 0, 0, 0.0])
    theta = np.array([-3 * np.pi / 4, np.pi / 4, *[plant.leader_theta] * 4])
    start = State(x, y, theta, np.zeros(6), np.array([1, 0.5, 0, 0, 0, 0]))
    motion = simulate(fleet, gains, psi, start, horizon, np.pi / 5)
    return motion, energy.rotational(numpy_ops(), plant, gains.map(floats), motion.state)


@dataclass(frozen=True, eq=False)
class Swings:
    """Heading and turn rate of one vehicle that is pushed to and fro, and the peak of each swing back."""

    t: Floats
    theta: Floats
    omega: Floats
    alpha: Floats
    peaks: Floats  # the largest |omega| of each swing back
    reaches: Floats  # the angle at which that swing began


def bang_bang(reaches: tuple[float, ...] = (5.0, 20.0, 80.0, 320.0)) -> Swings:
    """I = 1, p = .5, a = 1, d = 1, |alpha| = .76, so that (15) holds: out to an angle, back, and again further out."""
    state, parts = np.array([0.0, 0.0, 0.0]), []
    peaks = []
    for reach in reaches:
        out = _phase(state, 0.76, lambda _t, s, reach=reach: s[1] - reach)
        back = _phase(out[-1][:3], -0.76, lambda _t, s: s[1] - 1.0)
        peaks.append(float(np.abs(back[:, 2]).max()))
        state = back[-1][:3]
        parts += [out, back]
    t, theta, omega, alpha = np.concatenate(parts).T
    return Swings(t, theta, omega, alpha, np.array(peaks), np.array(reaches))


def _phase(start: Floats, alpha: float, event: Callable[..., float]) -> Floats:
    """Rows (t, theta, omega, alpha) until the event; the direction of crossing follows the sign of alpha."""
    from scipy.integrate import solve_ivp

    def rate(_t: float, s: Floats) -> list[float]:
        return [1.0, s[2], alpha - 0.5 * np.tanh(s[1]) - np.tanh(s[2])]

    crossing: Any = event
    crossing.terminal, crossing.direction = True, np.sign(alpha)
    found = solve_ivp(rate, (0, 1e5), start, events=crossing, max_step=5.0, **METHOD)
    return np.column_stack([*found.y, np.full(found.t.size, alpha)])
