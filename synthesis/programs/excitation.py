"""Designs psi: zero mean, and the largest first tone within |psi| <= 1."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from ...models.errors import UndecidedError
from ...models.excitation import Excitation
from ..settings import FAST
from .solvers import clarabel_finds_optimum

TONES = 3  # odd harmonics 1, 3, 5
GRID = 400  # points of a quarter period at which the bound is imposed
PLACES = 4  # decimal places of an amplitude
BEYOND = 0.001  # |psi| may exceed 1 by this much, between grid points and by rounding


def flat_tones(seconds: float = FAST.clarabel_seconds, count: int = TONES) -> Excitation:
    """sum_k s_k sin((2k-1) t), k = 1..count, with the largest s_1 for which |psi| <= 1.

    The mean and the even harmonics raise psi_bar but move nothing (docs/theory.md 7.2), and kappa grows with the square
    of the amplitude at the frequency of the first tone. A linear program over a grid; sines of odd multiples are
    symmetric, so a quarter period is enough. Raises UndecidedError if Clarabel does not find it in `seconds`.
    """
    import cvxpy as cp

    phase = np.linspace(0, np.pi / 2, GRID)
    tones = np.sin(np.outer(phase, 2 * np.arange(count) + 1))
    amplitude = cp.Variable(count)
    problem = cp.Problem(cp.Maximize(amplitude[0]), [tones @ amplitude <= 1, tones @ amplitude >= -1])
    if not clarabel_finds_optimum(problem, seconds):
        raise UndecidedError(f"the program for psi's tones ended as {problem.status!r}; give psi in the fleet file")
    # sin t alone meets the bound, so s_1 must be at least 1, whatever Clarabel reports.
    if amplitude.value[0] < 1 - BEYOND or np.abs(tones @ amplitude.value).max() > 1 + BEYOND:
        raise UndecidedError(
            "the program for psi's tones returned other tones than were asked for; give psi in the fleet file"
        )
    sin = [Fraction(0)] * (2 * count - 1)
    sin[::2] = [Fraction(round(value * 10**PLACES), 10**PLACES) for value in amplitude.value.tolist()]
    return Excitation(Fraction(0), Fraction(1), tuple(sin))


def at_frequency(psi: Excitation, frequency: Fraction) -> Excitation:
    """The same tones over another base frequency, rad/s."""
    return Excitation(psi.mean, frequency, psi.sin, psi.cos, psi.over_pi, psi.terms)
