"""The averaged program: structured scalars that settle the fleet fastest near the goal, by CasADi and IPOPT.

In the modes U of D^-1 L_l (U^T D U = 1) the responses of docs/theory.md 7.2 to a tone w of amplitude A are explicit in
the six scalars. For y = U eta, with lambda the eigenvalues,

    b = D U (lambda eta),  Theta = h A U (lambda eta / (lambda - mu_omega w^2 + i c w)),
    X = -U (U^T (Theta b) / (lambda - mu_v w^2 + i e w)),  c(y) = -1/2 sum over tones of Re(conj(Theta) i w X).

The slowest direction sets the tail: the program maximises kappa, the least decay over a set of directions around the
slowest mode, and adds the times that the approach and the two exponential channels take.
"""

from __future__ import annotations

import logging
import math
from concurrent.futures import Executor
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from ...models.algebra.ops import casadi_column
from ...models.conditions import ConditionData, ConditionSet, casadi_numbers
from ...models.equations import Plant
from ...models.errors import last_line
from ...models.excitation import Excitation
from ..modes import Modes, modes
from ..scaled_gains import INWARD, Scalars, structured
from ..settings import Settings
from ..task import Task
from .solvers import ipopt_finds_optimum

Floats = NDArray[np.float64]
Optimum = tuple[Scalars, float]  # with its predicted settling time, s
LOG = logging.getLogger(__name__)

LARGE = 200  # vehicles; above this size one local optimum is enough
TILT = 0.5  # how far the slowest mode is tilted towards each of the others
TIME_CONSTANTS = (2.0, 5.0, 15.0)  # time constants allowed for the exponential channels, one program each
SLACK = 1e-3  # an optimum may exceed its bounds by this much, in logarithms
LARGEST = 50.0  # logarithm of the longest predicted time, in s
STARTS = (
    Scalars(1.0, 3.0, 1.0, 1.0, 2.0, 0.7),
    Scalars(0.05, 0.3, 1.0, 0.05, 0.3, 1.0),
    Scalars(3.0, 2.2, 1.0, 5.0, 0.6, 0.25),
    Scalars(0.01, 0.1, 1.0, 0.01, 0.1, 1.2),
)


def local_optima(task: Task, distance: float, executor: Executor | None = None) -> list[Optimum]:
    """The different local optima that IPOPT reports from several starts, each with its predicted settling time in s.

    `distance` (m) is how far the fleet starts from its goal. The programs are solved by the executor, if there is one.
    """
    programs = [(task, distance, constants) for constants in _time_constants(task)]
    optima: list[Optimum] = []
    for solutions, error in executor.map(_solve, programs) if executor else map(_solve, programs):
        if error:
            LOG.warning("averaged program: broken off: %s", error)
        for optimum in solutions:
            if not any(np.allclose(optimum[0].logarithms(), seen.logarithms(), atol=0.02) for seen, _ in optima):
                optima.append(optimum)
    if not optima:
        LOG.warning("averaged program: left out, because IPOPT reports no optimum")
    return optima


def _time_constants(task: Task) -> tuple[float, ...]:
    return TIME_CONSTANTS[1:2] if len(task.fleet) > LARGE else TIME_CONSTANTS


def _solve(program: tuple[Task, float, float]) -> tuple[list[Optimum], str]:
    """IPOPT's optima from the starts (only one in a large fleet), and the last error, if any."""
    task, distance, constants = program
    optima: list[Optimum] = []
    try:
        averaged = AveragedProgram(task, distance=distance, time_constants=constants)
        for start in STARTS:
            if optimum := averaged.solve(start):
                optima.append(optimum)
                if len(task.fleet) > LARGE:
                    break
    except RuntimeError as error:  # of CasADi, IPOPT or ARPACK
        return optima, last_line(error)
    return optima, ""


class AveragedProgram:
    """Minimises the predicted settling time over the logarithms of the scalars and of the two exponential rates."""

    def __init__(
        self,
        task: Task,
        *,
        distance: float,
        time_constants: float,
    ) -> None:
        """Build the program once; `solve` runs it from a start."""
        plant, tolerance = task.plant, task.tolerance
        logs = ca.MX.sym("logs", 10)
        *values, gamma_omega, gamma_v, kappa, reach = ca.vertsplit(ca.exp(logs))
        scalars = Scalars(*values)
        slow = modes(plant.graph)
        flow = _Flow(slow, plant.graph.degree, task.excitation, scalars)
        # |y|' = -kappa |y|^3 takes 1 / (2 kappa reach^2) down to |y| = reach; the heading's swing has to settle too.
        time = (
            1 / (2 * kappa * reach**2) + _approach(scalars, distance) + time_constants * (1 / gamma_omega + 1 / gamma_v)
        )
        slowest = float(slow.eigenvalues[0])
        rows = [
            1 - reach / tolerance.position,
            1 - reach * flow.swing() / tolerance.heading,
            scalars.c - 2 * gamma_omega * scalars.mu_omega,
            slowest - gamma_omega * scalars.c + gamma_omega**2 * scalars.mu_omega,
            scalars.e - 2 * gamma_v * scalars.mu_v,
            slowest - gamma_v * scalars.e + gamma_v**2 * scalars.mu_v,
            *(flow.decay(direction) / kappa - 1 for direction in _directions(len(slow.eigenvalues))),
            *_conditions(plant, task.data, task.conditions, scalars),
        ]
        self._seconds = task.settings.ipopt_seconds
        problem = {"x": logs, "f": ca.log(time), "g": ca.vertcat(*rows)}
        self._solver = ca.nlpsol("averaged", "ipopt", problem, _ipopt_options(task.settings))
        low, high = np.log(task.tempo_range)
        self._lower = np.array([*[-9.0] * 5, low, -9.0, -9.0, -12.0, -9.0])
        self._upper = np.array([*[7.0] * 5, high, 5.0, 5.0, 9.0, 3.0])

    def solve(self, start: Scalars) -> Optimum | None:
        """(scalars, predicted settling time in s) of a local optimum, None if IPOPT does not report one.

        An answer outside the bounds does not count, whatever IPOPT reports. Raises RuntimeError if IPOPT breaks down or
        its time runs out.
        """
        x0 = np.clip([*start.logarithms(), -3.0, -3.0, -3.0, -3.0], self._lower, self._upper)
        solution = self._solver(x0=x0, lbx=self._lower, ubx=self._upper, lbg=0, ubg=math.inf)
        optimal = ipopt_finds_optimum(self._solver.stats(), self._seconds)
        point, value = np.asarray(solution["x"]).ravel(), float(solution["f"])
        inside = np.all((self._lower - SLACK <= point) & (point <= self._upper + SLACK))  # False for NaN
        if not optimal or not inside or not abs(value) < LARGEST:
            return None
        return Scalars.from_logarithms(point[:6]), math.exp(value)


def _ipopt_options(settings: Settings) -> dict[str, Any]:
    return {
        "ipopt": {
            "print_level": 0,
            "sb": "yes",
            "max_iter": settings.ipopt_iterations,
            "tol": 1e-4,
            "max_wall_time": settings.ipopt_seconds,
        },
        "print_time": False,
        "error_on_fail": False,
    }


class _Flow:
    """The averaged cross-track flow in the slow modes, over CasADi."""

    def __init__(self, slow: Modes, degree: Floats, excitation: Excitation, scalars: Scalars) -> None:
        self._U, self._values, self._degree = ca.DM(slow.vectors), ca.DM(slow.eigenvalues), ca.DM(degree)
        self._tones = [(scalars.tempo * w, abs(phasor)) for w, phasor in excitation.phasors()]
        self._scalars = scalars

    def _heading(self, eta: Any, w: Any, amplitude: float) -> tuple[Any, Any]:
        """Theta, real and imaginary, (N,)."""
        s = self._scalars
        real, imaginary = self._values - s.mu_omega * w**2, s.c * w
        drive = s.h * amplitude * self._values * eta / (real**2 + imaginary**2)
        return self._U @ (drive * real), -self._U @ (drive * imaginary)

    def swing(self) -> Any:
        """The largest heading swing of the slowest mode, rad per m of its largest error."""
        s, slowest = self._scalars, self._values[0]
        gains = (amplitude / ca.hypot(slowest - s.mu_omega * w**2, s.c * w) for w, amplitude in self._tones)
        return s.h * slowest * sum(gains)

    def decay(self, eta: Any) -> Any:
        """The coefficient of |y|' = -kappa |y|^3 at y = U eta, |y| being the root mean square over the degrees."""
        s, U = self._scalars, self._U
        b = self._degree * (U @ (self._values * eta))
        c = 0
        for w, amplitude in self._tones:
            theta = self._heading(eta, w, amplitude)
            real, imaginary = self._values - s.mu_v * w**2, s.e * w
            size = real**2 + imaginary**2
            push = [U.T @ (part * b) for part in theta]
            # X = -U (push / (real + i imaginary)); Re(conj(Theta) i w X) = w (Theta_im X_re - Theta_re X_im)
            x_real = -U @ ((push[0] * real + push[1] * imaginary) / size)
            x_imaginary = -U @ ((push[1] * real - push[0] * imaginary) / size)
            c = c - w * (theta[1] * x_real - theta[0] * x_imaginary) / 2
        square = ca.sumsqr(eta)  # y^T D y
        return ca.dot(U @ eta, self._degree * c) * ca.sum1(self._degree) / square**2


def _directions(count: int) -> list[Any]:
    """Every mode, and the slowest one tilted towards each of the others, both ways; in coordinates of the modes."""
    slowest, *others = np.eye(count)
    leaning = [slowest + sign * TILT * other for other in others for sign in (1, -1)]
    return [ca.DM(direction) for direction in (slowest, *others, *leaning)]


def _approach(scalars: Scalars, distance: float) -> Any:
    """Estimated time from `distance` with saturated errors, s: damped swings plus travel at the terminal speed."""
    swings = 2 * ca.sqrt(2 * distance * scalars.mu_v) * (1 + 1 / scalars.e)
    return swings + distance * scalars.e


def _conditions(plant: Plant, data: ConditionData, conditions: ConditionSet, scalars: Scalars) -> list[Any]:
    """Each condition as (large - small) / large >= 0, once for each kind of vehicle.

    With structured gains the degree cancels in every condition: vehicles of one kind share their conditions.
    """
    limits = (data.torque, data.speed, data.turn_rate, data.wheel_speed, data.acceleration, data.turn_acceleration)
    kinds = np.stack([plant.m, plant.inertia, data.r, data.arm, *limits])
    _, first = np.unique(kinds, axis=1, return_index=True)

    def of_each_kind(values: Any) -> Any:
        return casadi_column(values[first] if np.ndim(values) else values)

    numbers = data.map(of_each_kind)
    gains = structured(scalars, of_each_kind(plant.m), of_each_kind(plant.inertia), numbers.degree)
    inequalities = [
        condition(casadi_numbers(), numbers, gains)
        for condition in (*conditions.bounding(data), *conditions.homogeneous(data))
    ]
    return [INWARD - inequality.small / inequality.large for inequality in inequalities]
