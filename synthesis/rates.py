"""How fast: the exponential rates of heading and along-track motion, and the cubic flow across the track.

docs/theory.md 7. Near the goal the heading obeys M th'' + C th' + L_l th = 0, where M = I / p_omega and
C = d_omega / p_omega, and the along-track errors the same with m, p_v, d_v. The cross-track errors y fall by an
algebraic flow y' = -c(y) that the excitation causes; c is cubic, so that y ~ t^(-1/2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..models.deadline import Deadline
from ..models.equations import Plant
from ..models.errors import UndecidedError
from ..models.excitation import Excitation
from ..models.gains import Gains

Floats = NDArray[np.float64]

SWING_PHASES = 65  # points of a period at which the heading's swing is evaluated
TAIL_SECONDS = 60.0  # of wall clock for one tail
LONGEST_TAIL = 1e7  # s; a longer tail counts as infinite


@dataclass(frozen=True)
class Rates:
    """The rates near the goal."""

    gamma_omega: float  # 1/s, exponential rate of the headings
    gamma_v: float  # 1/s, exponential rate along the track
    kappa: float  # 1/(m^2 s), slowest cross-track coefficient: |y|' = -kappa |y|^3 for the largest |y_i|
    tail_time: float  # s, cross-track errors from twice the tolerance into it by the averaged flow


def heading_coefficients(plant: Plant, gains: Gains) -> tuple[Floats, Floats]:
    """M (s^2) and C (s) of the heading channel, (N,)."""
    return plant.inertia / gains.p_omega, gains.d_omega / gains.p_omega


def track_coefficients(plant: Plant, gains: Gains) -> tuple[Floats, Floats]:
    """M (s^2) and C (s) of the along-track channel, (N,)."""
    return plant.m / gains.p_v, gains.d_v / gains.p_v


def exponential_rate(M: Floats, C: Floats, L: Any) -> float:
    """The largest gamma with C - 2 gamma M >= 0 and L - gamma C + gamma^2 M >= 0, which certifies e^(-gamma t).

    M, C (N,) are diagonals, L (N, N) is sparse, symmetric and positive definite. Bisection; the second matrix falls
    with gamma as long as the first condition holds.
    """
    from scipy.sparse import diags_array

    low, high = 0.0, float(np.min(C / (2 * M)))
    for _ in range(50):
        middle = (low + high) / 2
        shifted = L + diags_array(middle * middle * M - middle * C)
        low, high = (middle, high) if _positive_definite(shifted) else (low, middle)
    return low


def _positive_definite(matrix: Any) -> bool:
    """Whether a sparse symmetric matrix has positive pivots, in the order of its diagonal."""
    from scipy.sparse.linalg import splu

    options = {"SymmetricMode": True}
    try:
        factors = splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
    except RuntimeError:  # an exact zero on the diagonal: singular
        return False
    return bool(np.array_equal(factors.perm_r, factors.perm_c) and np.all(factors.U.diagonal() > 0))


class CrossTrack:
    """The averaged motion across the track: y' = -c(y), and the heading swing that it rides on; tone by tone."""

    def __init__(self, plant: Plant, gains: Gains, excitation: Excitation) -> None:
        """Factorise the sparse responses at every tone of psi."""
        from scipy.sparse import diags_array
        from scipy.sparse.linalg import splu

        self._L = plant.graph.composed_laplacian()
        M_v, C_v = track_coefficients(plant, gains)
        self._tones = []
        for w, phasor in excitation.phasors():
            heading = diags_array(gains.p_omega) @ self._L + diags_array(-plant.inertia * w**2 + 1j * w * gains.d_omega)
            track = self._L + diags_array(-M_v * w**2 + 1j * w * C_v)
            try:
                self._tones.append((w, gains.k_alpha * phasor, splu(heading.tocsc()), splu(track.tocsc())))
            except RuntimeError:  # singular to floating point precision
                raise UndecidedError(
                    f"the response to psi at {w:g} rad/s is singular in floating point; "
                    "are a weight, a limit or a parameter of the fleet of the wrong size?"
                ) from None
        turns = np.linspace(0, 2 * math.pi, SWING_PHASES) / float(excitation.frequency)
        self._phases = [np.exp(1j * w * turns) for w, _ in excitation.phasors()]

    def flow(self, y: Floats) -> Floats:
        """c(y), m/s, for cross-track errors y (N,) or (N, K) in m; cubic in y."""
        b = self._L @ y
        c = np.zeros(y.shape)
        for w, amplitude, heading, track in self._tones:
            theta = heading.solve((amplitude * b.T).T.astype(complex))
            x = -track.solve(theta * b)
            c -= (theta.conj() * 1j * w * x).real / 2
        return c

    def swing(self, y: Floats) -> Floats:
        """The largest distance of each heading from theta_l over one period of psi, rad, shaped as y."""
        b = self._L @ y
        solved = (heading.solve((amplitude * b.T).T.astype(complex)) for _, amplitude, heading, _ in self._tones)
        swings = sum(np.multiply.outer(phase, theta).imag for phase, theta in zip(self._phases, solved, strict=True))
        return np.asarray(np.max(np.abs(swings), axis=0))

    def time_to(
        self,
        start: Floats,
        position: float,
        heading: float,
        accuracy: float = 1e-6,
        seconds: float = TAIL_SECONDS,
    ) -> tuple[float, float]:
        """(T, kappa): the time until |y| <= position and swing <= heading everywhere, and the coefficient there.

        kappa is that of d|y|/dt = -kappa |y|^3 for the largest entry; (inf, kappa) where the errors do not fall so far
        by LONGEST_TAIL, or within `seconds` of wall clock: then kappa is that of the start. `accuracy` is relative.
        """
        from scipy.integrate import solve_ivp

        def excess(_: float, y: Floats) -> float:
            if deadline.passed:
                raise TimeoutError
            return float(max(np.max(np.abs(y)) / position, np.max(self.swing(y)) / heading)) - 1

        deadline = Deadline(seconds)
        excess.terminal = True  # type: ignore[attr-defined]
        options: dict[str, Any] = {"events": excess, "rtol": accuracy, "atol": accuracy / 1000}
        try:
            if excess(0.0, start) <= 0:
                y, time = start, 0.0
            else:
                run = solve_ivp(lambda _, y: -self.flow(y), (0, LONGEST_TAIL), start, "LSODA", **options)
                y, time = run.y[:, -1], float(run.t[-1]) if run.status == 1 else math.inf
        except TimeoutError:
            y, time = start, math.inf
        leading = int(np.argmax(np.abs(y)))
        kappa = float(self.flow(y)[leading] / y[leading] ** 3)
        return time, kappa


TAIL_FROM = 2.0  # tolerances across the track


def rates(plant: Plant, gains: Gains, excitation: Excitation, position: float = 0.1, heading: float = 0.1) -> Rates:
    """All rates of a design (gains as floats), for a tolerance in m and rad; those of its local gains."""
    gains = gains.local()
    L = plant.graph.composed_laplacian()
    start = np.full(plant.graph.vehicles, TAIL_FROM * position)
    tail, kappa = CrossTrack(plant, gains, excitation).time_to(start, position, heading)
    return Rates(
        gamma_omega=exponential_rate(*heading_coefficients(plant, gains), L),
        gamma_v=exponential_rate(*track_coefficients(plant, gains), L),
        kappa=kappa,
        tail_time=tail,
    )
