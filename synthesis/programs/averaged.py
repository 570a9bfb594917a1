"""The averaged program: scalars that settle the fleet soonest near the goal, by CasADi and IPOPT.

Near the goal the fleet moves as with unit scales and local gains. In the modes U of D^-1 L_l (U^T D U = 1) the
responses of docs/theory.md 7.2 to a tone w of amplitude A are explicit in six local scalars. For y = U eta, with lambda
the eigenvalues,

    b = D U (lambda eta),  Theta = h A U (lambda eta / (lambda - mu_omega w^2 + i c w)),
    X = -U (U^T (Theta b) / (lambda - mu_v w^2 + i e w)),  c(y) = -1/2 sum over tones of Re(conj(Theta) i w X).

The slowest direction sets the tail: the program maximises kappa, the least decay over a set of directions around the
slowest mode, and adds the times that the approach and the two exponential channels take. Its variables are logarithms
of factors on the fleet's typical scalars.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Mapping
from fractions import Fraction
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from ...models.algebra.ops import casadi_column
from ...models.conditions import ConditionData, ConditionSet, casadi_numbers
from ...models.equations import Plant
from ...models.errors import last_line
from ...models.excitation import Excitation
from ..modes import Modes, modes
from ..scaled_gains import INWARD, SCALAR_NAMES, Scalars, structured
from ..settings import Settings
from ..task import Task, fixed_scalars
from .excitation import at_frequency
from .solvers import ipopt_finds_optimum

Floats = NDArray[np.float64]
Optimum = tuple[Scalars, float]  # with its predicted settling time, s
LOG = logging.getLogger(__name__)

LARGEST_LIMIT = 1e12  # in place of infinity, which has no derivative
LARGE = 200  # vehicles; beyond, one local optimum has to do
TILT = 0.5  # how far the directions lean from the slowest mode towards each of the others
TIME_CONSTANTS = 5.0  # e-foldings that the exponential channels are given
WIDEST = 4.0  # logarithm of a factor on a typical scalar
SLACK = 1e-3  # of a logarithm, by which an optimum may lie outside its bounds
LARGEST = 50.0  # logarithm of a predicted time, in typical times, that can be meant
GRID = 0.01  # of the logarithms: processors that round differently leave IPOPT at nearby points
SAMPLES = 2.0  # sample times in the shortest time constant of either channel
STARTS: tuple[dict[str, float], ...] = (  # factors on the typical scalars, by name
    {},
    {"time": 3.0, "mu": 0.3},
    {"time": 0.5, "tempo": 0.5, "c": 0.5, "e": 0.5},
)


class LocalScalars(NamedTuple):
    """The six scalars of the fleet with unit scales that moves alike near the goal, of any one number type."""

    mu_omega: Any  # s^2, I / (p_omega D) of the local gains, and so on
    c: Any  # s, d_omega / (p_omega D)
    h: Any  # rad/m, k / p_omega
    mu_v: Any  # s^2, m / (p_v D)
    e: Any  # s, d_v / (p_v D)
    frequency: Any  # rad/s, of psi

    @classmethod
    def of(cls, scalars: Scalars, frequency: Any) -> LocalScalars:
        """Those of scalars, with psi at a frequency."""
        scale, square = scalars.saturation, scalars.time * scalars.time
        return cls(
            mu_omega=square * scalars.mu * scale.heading,
            c=scalars.c * scale.heading / scale.turn_rate,
            h=scalars.h * scale.heading / scale.position,
            mu_v=square,
            e=scalars.e * scale.position / scale.speed,
            frequency=frequency,
        )


def local_optima(task: Task, distance: float) -> list[Optimum]:
    """The different local optima that IPOPT reports from several starts, each with its predicted settling time in s.

    `distance` (m) is how far the fleet starts from its goal.
    """
    optima: list[Optimum] = []
    points: list[Floats] = []
    try:
        averaged = AveragedProgram(task, distance=distance)
        for factors in STARTS[:1] if len(task.fleet) > LARGE else STARTS:
            optimum = averaged.solve(factors)
            if optimum and not any(np.array_equal(optimum[2], point) for point in points):
                points.append(optimum[2])
                optima.append(optimum[:2])
    except RuntimeError as error:  # of CasADi, IPOPT or ARPACK
        LOG.warning("averaged program: broken off: %s", last_line(error))
    if not optima:
        LOG.warning("averaged program: left out, because IPOPT reports no optimum")
    return optima


class AveragedProgram:
    """Minimises the predicted settling time over factors on the typical scalars and over two exponential rates."""

    def __init__(self, task: Task, *, distance: float) -> None:
        """Build the program once; `solve` runs it from a start."""
        plant, tolerance, typical = task.plant, task.tolerance, task.typical
        count, unit = len(SCALAR_NAMES), float(typical.time)
        logs = ca.MX.sym("logs", count + 4)
        factors = ca.vertsplit(ca.exp(logs))
        scalars = typical.scaled(factors[:count])
        gamma_omega, gamma_v = (factor / unit for factor in factors[count : count + 2])
        kappa, reach = factors[-2] / (unit * tolerance.position**2), factors[-1] * tolerance.position
        slow, designed = modes(plant.graph), task.excitation_designed
        local = LocalScalars.of(scalars, scalars.frequency if designed else float(task.excitation.frequency))
        flow = _Flow(slow, plant.graph.degree, at_frequency(task.excitation, Fraction(1)), local)
        # |y|' = -kappa |y|^3 takes 1 / (2 kappa reach^2) down to |y| = reach; the heading's swing has to settle too.
        tail, channels = 1 / (2 * kappa * reach**2), TIME_CONSTANTS * (1 / gamma_omega + 1 / gamma_v)
        time = tail + _approach(scalars, distance) + channels
        slowest = float(slow.eigenvalues[0])
        rows = [
            1 - reach / tolerance.position,
            1 - reach / scalars.length,  # farther out the flow is not cubic
            1 - reach * flow.swing() / tolerance.heading,
            local.c / unit - 2 * gamma_omega * local.mu_omega / unit,
            slowest - gamma_omega * local.c + gamma_omega**2 * local.mu_omega,
            local.e / unit - 2 * gamma_v * local.mu_v / unit,
            slowest - gamma_v * local.e + gamma_v**2 * local.mu_v,
            *(flow.decay(direction) / kappa - 1 for direction in _directions(len(slow.eigenvalues))),
            *_slow_enough(local, SAMPLES * task.setup.disturbance.sample_time),
            *_conditions(plant, task.data, task.conditions, scalars),
        ]
        self._typical, self._seconds, self._unit = typical, task.settings.ipopt_seconds, unit
        problem = {"x": logs, "f": ca.log(time / unit), "g": ca.vertcat(*rows)}
        self._solver = ca.nlpsol("averaged", "ipopt", problem, _ipopt_options(task.settings))
        fixed = fixed_scalars(task)
        widths = np.array([0.0 if name in fixed else WIDEST for name in SCALAR_NAMES])
        self._lower = np.array([*-widths, -12.0, -12.0, -16.0, -6.0])
        self._upper = np.array([*widths, 3.0, 3.0, 6.0, 0.0])

    def solve(self, factors: Mapping[str, float]) -> tuple[Scalars, float, Floats] | None:
        """(scalars, predicted settling time in s, point) of a local optimum, None where IPOPT does not report one.

        It begins at factors on the typical scalars. An answer outside the bounds is none, whatever IPOPT calls it.
        Raises RuntimeError where IPOPT breaks down or its time runs out.
        """
        begin = [math.log(factors.get(name, 1.0)) for name in SCALAR_NAMES]
        x0 = np.clip([*begin, -3.0, -3.0, -3.0, -0.5], self._lower, self._upper)
        solution = self._solver(x0=x0, lbx=self._lower, ubx=self._upper, lbg=0, ubg=math.inf)
        optimal = ipopt_finds_optimum(self._solver.stats(), self._seconds)
        point, value = np.asarray(solution["x"]).ravel(), float(solution["f"])
        inside = np.all((self._lower - SLACK <= point) & (point <= self._upper + SLACK))  # False for NaN
        if not optimal or not inside or not abs(value) < LARGEST:
            return None
        point = np.rint(point[: len(SCALAR_NAMES)] / GRID) * GRID
        return self._typical.scaled(np.exp(point).tolist()), self._unit * math.exp(value), point


def _slow_enough(local: LocalScalars, shortest: float) -> list[Any]:
    """Rows >= 0 where no time constant of either channel is below `shortest` (s): torques are held for a while."""
    return [
        1 - shortest**2 / local.mu_omega,
        1 - shortest**2 / local.mu_v,
        1 - shortest * local.c / local.mu_omega,
        1 - shortest * local.e / local.mu_v,
    ]


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

    def __init__(self, slow: Modes, degree: Floats, excitation: Excitation, scalars: LocalScalars) -> None:
        self._U, self._values, self._degree = ca.DM(slow.vectors), ca.DM(slow.eigenvalues), ca.DM(degree)
        self._tones = [(scalars.frequency * w, abs(phasor)) for w, phasor in excitation.phasors()]
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
    """About the time from `distance` (m) under saturated errors, s: swings with friction e, or the terminal speed."""
    acceleration = scalars.length / scalars.time**2
    swings = 2 * ca.sqrt(2 * distance / acceleration) * (1 + 1 / scalars.e)
    return swings + distance * scalars.e / scalars.saturation.speed


def _conditions(plant: Plant, data: ConditionData, conditions: ConditionSet, scalars: Scalars) -> list[Any]:
    """Each condition as (large - small) / large >= 0, once for each kind of vehicle.

    With structured gains the degree cancels in every condition: vehicles of one kind share their conditions.
    """
    limits = (data.torque, data.speed, data.turn_rate, data.wheel_speed, data.acceleration, data.turn_acceleration)
    kinds = np.stack([plant.m, plant.inertia, data.r, data.arm, *limits])
    _, first = np.unique(kinds, axis=1, return_index=True)

    def of_each_kind(values: Any) -> Any:
        finite = np.minimum(values, LARGEST_LIMIT)
        return casadi_column(finite[first] if np.ndim(values) else finite)

    numbers = data.map(of_each_kind)
    gains = structured(scalars, of_each_kind(plant.m), of_each_kind(plant.inertia), numbers.degree)
    inequalities = [
        condition(casadi_numbers(), numbers, gains)
        for condition in (*conditions.bounding(data), *conditions.homogeneous(data))
    ]
    return [INWARD - inequality.small / inequality.large for inequality in inequalities]
