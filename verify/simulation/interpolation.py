"""Cubic Hermite interpolation between grid points: the peak of a quantity, and the last time it is above 1."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .closed_loop import Floats

FINE = 64  # points of one interval that are searched for a crossing


class Peaks(NamedTuple):
    """The largest |q| in every interval of a grid, each (K-1, Q)."""

    size: Floats
    place: Floats  # in [0, 1], from the left to the right end


def interval_peaks(values: Floats, slopes: Floats, step: float) -> Peaks:
    """The largest |q| in every interval, ends included, from q (K, Q) and its time derivative (1/s)."""
    a, b, c, d = _cubic(values, slopes, step)
    # q' = b + 2 c s + 3 d s^2; the roots in the form that does not cancel.
    root = np.sqrt(np.maximum(c * c - 3 * b * d, 0))
    turn = -(c + np.where(c < 0, -root, root))
    with np.errstate(divide="ignore", invalid="ignore"):
        places = np.stack([np.zeros_like(a), np.ones_like(a), turn / (3 * d), b / turn])
    places = np.where((places >= 0) & (places <= 1), places, 0.0)  # NaN too: no root
    sizes = np.abs(a + places * (b + places * (c + places * d)))
    best = np.argmax(sizes, axis=0)[None]
    return Peaks(np.take_along_axis(sizes, best, 0)[0], np.take_along_axis(places, best, 0)[0])


def last_above_one(values: Floats, slopes: Floats, step: float) -> float | None:
    """The last time, s from the first point, at which one of q (K, Q) is above 1; None if all stay at or below 1."""
    outside = np.flatnonzero(interval_peaks(values, slopes, step).size.max(axis=1) > 1)
    if not outside.size:
        return None
    k = int(outside[-1])
    a, b, c, d = _cubic(values[k : k + 2], slopes[k : k + 2], step)
    s = np.linspace(0, 1, FINE + 1)[:, None]
    q = (a + s * (b + s * (c + s * d))).max(axis=1)
    above = np.flatnonzero(q > 1)
    if not above.size:  # the peak lies between two of these points
        return step * (k + 0.5)
    last = int(above[-1])
    if last == FINE:
        return step * (k + 1)
    fraction = (q[last] - 1) / (q[last] - q[last + 1])
    return step * (k + (last + float(fraction)) / FINE)


def _cubic(values: Floats, slopes: Floats, step: float) -> tuple[Floats, Floats, Floats, Floats]:
    """The coefficients of 1, s, s^2, s^3 on every interval."""
    start, change = values[:-1], np.diff(values, axis=0)
    left, right = step * slopes[:-1], step * slopes[1:]
    return start, left, 3 * change - 2 * left - right, left + right - 2 * change
