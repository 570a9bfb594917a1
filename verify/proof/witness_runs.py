"""The theorem and the boundedness witnesses exercised by simulation: evidence beside the proof, never part of it.

SciPy integrates `models.equations.closed_loop` here, so that nothing depends on the simulator that the tool ships.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...models import conditions, energy
from ...models.algebra.ops import numpy_ops
from ...models.arrays import column, floats
from ...models.equations import Plant, State, closed_loop
from ...models.excitation import Excitation
from ...models.fleet import Fleet
from ...models.gains import Gains
from ...models.paper import paper_excitation, paper_fleet, paper_gains

Floats = NDArray[np.float64]
TOLERANCE = {"rtol": 1e-7, "atol": 1e-9}


@dataclass(frozen=True, eq=False)
class Run:
    """A simulated trajectory: times (T,) and the five state parts, each (T, N)."""

    t: Floats
    state: State


def simulate(fleet: Fleet, gains: Gains, psi: Excitation, start: State, horizon: float, t0: float = 0.0) -> Run:
    """Integrate (13)-(14) from t0 over `horizon` seconds (LSODA)."""
    from scipy.integrate import solve_ivp

    ops, plant, numbers = numpy_ops(), fleet.plant(), gains.map(floats)

    def rate(t: float, flat: Floats) -> Floats:
        return np.concatenate(closed_loop(ops, plant, numbers, psi.value(ops, t), State(*flat.reshape(5, -1))))

    span = (t0, t0 + horizon)
    found = solve_ivp(rate, span, np.concatenate(start), method="LSODA", t_eval=np.linspace(*span, 2001), **TOLERANCE)
    return Run(found.t, State(*np.moveaxis(found.y.reshape(5, -1, found.t.size), 2, 1)))


def errors(plant: Plant, run: Run) -> tuple[Floats, Floats]:
    """The largest position (m) and heading (rad) error of the fleet at every time, (T,) each."""
    x = run.state.x - plant.offset_x - plant.leader_x
    y = run.state.y - plant.offset_y - plant.leader_y
    return np.hypot(x, y).max(axis=1), np.abs(run.state.theta - plant.leader_theta).max(axis=1)


def small_fleet(vehicles: int) -> Fleet:
    """A line of light robots, all led, near their places."""
    names = [f"r{i}" for i in range(1, vehicles + 1)]
    return Fleet.model_validate(
        {
            "name": f"line of {vehicles}",
            "leader": {"position": [0, 0], "heading": 0},
            "excitation": {"family": "harmonics", "frequency": 1, "sin": [1]},
            "graph": {
                "edges": [[a, b, "0.1"] for a, b in pairwise(names)],
                "leader_links": dict.fromkeys(names, 1),
            },
            "vehicle": [_robot(name, i) for i, name in enumerate(names)],
        }
    )


def _robot(name: str, i: int) -> dict[str, Any]:
    start = {"position": [f"{1 - 0.7 * i:.2f}", f"{0.8 - 0.5 * i:.2f}"], "heading": f"{0.5 * (-1) ** i:.1f}"}
    body = {"mass": 1, "inertia": 1, "half_track": "0.2", "wheel_radius": "0.1", "torque_limit": 100}
    return {"name": name, **body, "offset": [i, 0], "start": start}


def undamped_gains(fleet: Fleet, psi: Excitation) -> Gains:
    """Gains with c = 10 d_omega tanh(1): they break (15) tenfold, for every vehicle, and slightly more."""
    degree, ones = fleet.graph.degree, column([Fraction(1)] * len(fleet))
    inertia = column(v.inertia for v in fleet.vehicles)
    mass = column(v.mass for v in fleet.vehicles)
    p_omega, p_v = inertia / degree * 4, mass / degree * 4
    d_omega = p_omega * degree / 2
    # c = sqrt2 k psi_bar D >= 1.41 k psi_bar D; 7.7 > 10 tanh(1).
    k_alpha = d_omega * Fraction(77, 10) / (Fraction(141, 100) * psi.bound * degree)
    return Gains(p_v * ones, p_v * degree, p_omega, d_omega, k_alpha)


def damping_ratio(fleet: Fleet, gains: Gains, psi: Excitation) -> Floats:
    """c / (d_omega tanh 1) per vehicle: above 1 (15) is broken, above 10 tenfold."""
    found = conditions.condition_15(conditions.exact_numbers(), fleet.condition_data(psi), gains)
    ratio: Floats = floats(found.small) / floats(found.large)
    return ratio


def rising_energy(horizon: float = 30.0) -> tuple[Run, Floats]:
    """The first boundedness witness: the paper's fleet from the state where W' = +1.234 at t = pi/5; (run, W(t))."""
    fleet, gains, psi = paper_fleet(), paper_gains(), paper_excitation()
    plant = fleet.plant()
    x, y = plant.offset_x + plant.leader_x, plant.offset_y + plant.leader_y
    x, y = x + np.array([40, -40, 0, 0, 0, 0.0]), y + np.array([-40, 40, 0, 0, 0, 0.0])
    theta = np.array([-3 * np.pi / 4, np.pi / 4, *[plant.leader_theta] * 4])
    start = State(x, y, theta, np.zeros(6), np.array([1, 0.5, 0, 0, 0, 0]))
    run = simulate(fleet, gains, psi, start, horizon, np.pi / 5)
    return run, energy.rotational(numpy_ops(), plant, gains.map(floats), run.state)


@dataclass(frozen=True, eq=False)
class Swings:
    """The second witness: theta and omega of the single vehicle under bang-bang alpha, and the peak of each swing."""

    t: Floats
    theta: Floats
    omega: Floats
    alpha: Floats
    peaks: Floats  # the largest |omega| of each swing back
    reaches: Floats  # the angle L at which that swing began


def bang_bang(reaches: tuple[float, ...] = (5.0, 20.0, 80.0, 320.0)) -> Swings:
    """I=1, p=.5, a=1, d=1, |alpha| = .76: drift out to L, swing back, and again with a larger L."""
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

    event.terminal, event.direction = True, np.sign(alpha)  # type: ignore[attr-defined]
    found = solve_ivp(rate, (0, 1e5), start, method="LSODA", events=event, max_step=5.0, **TOLERANCE)
    return np.column_stack([*found.y, np.full(found.t.size, alpha)])
