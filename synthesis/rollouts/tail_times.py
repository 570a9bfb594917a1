"""The averaged flow of the cross-track errors for many trials at once: how long the tail of each takes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ...models.equations import Plant
from ...models.errors import UndecidedError
from ...models.tolerance import Tolerance
from ..rates import CrossTrack, Floats, heading_coefficients, track_coefficients
from ..settings import Accuracy
from .runge_kutta import BOGACKI_SHAMPINE, Rate, Stepper
from .settling import Trial

DENSE_VEHICLES = 40  # up to this size the responses of all trials are inverted and stored together
STEPS = 80  # after so many steps we extrapolate: 1 / error^2 keeps its last growth rate
PHASES = 32  # points in a period of psi at which the heading's swing is evaluated
FIRST_STEP = 1.0  # s
ACCURACY = Accuracy(1e-3, 1e-5, math.inf)


def tail_times(plant: Plant, trials: Sequence[Trial], trial: Sequence[int], y: Floats, tolerance: Tolerance) -> Floats:
    """The time (s) in which the cross-track errors y (N, B) fall to the tolerance, (B,).

    Column b of y belongs to trial[b]. The time is 0 for errors within the tolerance, inf if they never reach it.
    """
    if plant.graph.vehicles > DENSE_VEHICLES:
        return np.array([_time_to(plant, trials[k], column, tolerance) for k, column in zip(trial, y.T, strict=True)])
    return _together(_CrossTracks(plant, trials, trial), y, tolerance)


def _time_to(plant: Plant, trial: Trial, y: Floats, tolerance: Tolerance) -> float:
    try:
        return CrossTrack(plant, *trial).time_to(y, tolerance.position, tolerance.heading, ACCURACY.relative)[0]
    except UndecidedError:
        return math.inf


def _together(tracks: CrossTrack, y: Floats, tolerance: Tolerance) -> Floats:
    """All columns together for STEPS steps, then the power law of a cubic flow along its slowest mode."""

    def closeness(y: Floats) -> Floats:
        """(tolerance / error)^2 for the larger of both errors: it grows at a constant rate while y keeps its shape."""
        errors = np.abs(y).max(axis=0) / tolerance.position, tracks.swing(y).max(axis=0) / tolerance.heading
        return np.asarray(np.maximum(*errors) ** -2.0)

    width = y.shape[1]
    first = np.full(width, FIRST_STEP)

    def problem(y: Floats, slope: Floats) -> Rate:
        return lambda _: np.copyto(slope, -tracks.flow(y))

    stepper = Stepper(BOGACKI_SHAMPINE, problem, np.zeros(width), y, first, ACCURACY)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        now = closeness(y)
        times = np.where(now >= 1, 0.0, math.inf)
        for left in reversed(range(STEPS)):
            begin, before = stepper.t, now
            stepper.step()
            now = closeness(stepper.y.astype(float))
            reached = begin + (1 - before) * (stepper.t - begin) / (now - before)
            news = np.isinf(times) & (now > before) & ((now >= 1) | (left == 0))
            times = np.where(news, reached, times)
            if np.isfinite(times).all():
                break
    return times


class _CrossTracks(CrossTrack):
    """`CrossTrack` with another trial in every column, by dense inverses."""

    def __init__(self, plant: Plant, trials: Sequence[Trial], trial: Sequence[int]) -> None:
        self._L = plant.graph.composed_laplacian()
        self._tones = []
        used, column = np.unique(trial, return_inverse=True)
        L, tones = self._L.toarray(), np.array([trials[k].excitation.phasors() for k in used])  # (used, tones, 2)
        for w, phasor in np.moveaxis(tones, 0, 2):
            if not phasor.any():
                continue
            heading, track, amplitude = [], [], []
            for one, k in enumerate(used):
                gains, s = trials[k].gains, 1j * w[one].real
                M_v, C_v = track_coefficients(plant, gains)
                M_w, C_w = heading_coefficients(plant, gains)
                heading.append(_inverse(L + np.diag(M_w * s**2 + C_w * s)) / gains.p_omega)
                track.append(_inverse(L + np.diag(M_v * s**2 + C_v * s)))
                amplitude.append(gains.k_alpha * phasor[one])
            solvers = (_Inverses(np.array(inverses)[column]) for inverses in (heading, track))
            self._tones.append((w.real[column], np.array(amplitude)[column], *solvers))
        turn = np.linspace(0, 2 * math.pi, PHASES, endpoint=False)
        self._phases = [np.exp(1j * turn * round((w / tones[0, 1, 0]).real)) for w, phasor in tones[0] if phasor]


class _Inverses:
    """The inverses of one response, (B, N, N), one for every column."""

    def __init__(self, inverses: Any) -> None:
        self._inverses = np.ascontiguousarray(np.moveaxis(inverses, 0, 2), dtype=np.complex64)

    def solve(self, right: Any) -> Any:
        """The responses to the columns of `right` (N, B)."""
        return np.einsum("ijb,jb->ib", self._inverses, right.astype(np.complex64))


def _inverse(matrix: Any) -> Any:
    """The inverse, NaN for a singular matrix."""
    try:
        return np.linalg.inv(matrix)
    except np.linalg.LinAlgError:
        return np.full(matrix.shape, math.nan)
