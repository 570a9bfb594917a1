"""Exact facts about a Fourier excitation: (12), the supremum of |psi|, and lemma L10's number nu.

Each is computed here from the coefficients alone and then compared with what `models.excitation` says.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations
from typing import Any

from flint import arb

from ...models.excitation import Excitation
from .ball import Ball, ball


def rate_coefficients(psi: Excitation) -> list[tuple[int, Fraction, Fraction]]:
    """(n, cos_n, sin_n) of psi', without the factor pi^-p: n w s cos(n w t) - n w c sin(n w t)."""
    return [(n, n * psi.frequency * s, -n * psi.frequency * c) for n, s, c in psi.coefficients]


def rate_power(psi: Excitation, turns: Fraction) -> tuple[Fraction, int] | None:
    """(q, j): the integral of psi'^2 over any window of length 2 pi `turns` is q pi^j; None where the window matters.

    Products of two tones are sums of tones at n w +- m w; each integrates to 0 over the window if and only if its
    frequency times `turns` is a whole number other than 0.
    """
    terms = rate_coefficients(psi)
    tones = [Fraction(2 * n) for n, _, _ in terms]
    tones += [Fraction(n + sign * m) for (n, _, _), (m, _, _) in combinations(terms, 2) for sign in (1, -1)]
    if any((tone * psi.frequency * turns).denominator != 1 for tone in tones):
        return None
    squares = sum((c * c + s * s for _, c, s in terms), Fraction(0))
    return squares * turns, 1 - 2 * psi.over_pi


def variance(psi: Excitation) -> tuple[Fraction, int]:
    """(q, j): min over c of the integral of (psi - c)^2 over one period 2 pi / w is q pi^j (L10, by orthogonality)."""
    squares = sum((s * s + c * c for _, s, c in psi.coefficients), Fraction(0))
    return squares / psi.frequency, 1 - 2 * psi.over_pi


def times_power_of_pi(value: tuple[Fraction, int]) -> Ball:
    """q pi^j."""
    return ball(value[0]) * arb.pi() ** value[1]


def odd_square_wave_terms(psi: Excitation) -> int | None:
    """K where psi = mean + sum_{k <= K} s/(2k-1) sin((2k-1) w t), else None; for these the zeros of psi' are known."""
    terms = psi.coefficients
    amplitude = terms[0][1] if terms else Fraction(0)
    expected = [(2 * k - 1, amplitude / (2 * k - 1), Fraction(0)) for k in range(1, len(terms) + 1)]
    return len(terms) if terms and terms == expected else None


def telescopes(terms: int) -> bool:
    """2 sin u sum_{k <= K} cos((2k-1) u) = sin(2K u), term by term: 2 sin u cos(n u) = sin((n+1) u) - sin((n-1) u)."""
    sines: dict[int, int] = {}
    for k in range(1, terms + 1):
        for n, sign in ((2 * k, 1), (2 * k - 2, -1)):
            sines[n] = sines.get(n, 0) + sign
    return {n: c for n, c in sines.items() if c and n} == {2 * terms: 1}


def square_wave_peak(psi: Excitation, value: Any) -> tuple[Ball, Fraction]:
    """The maximum of |psi| and where: all zeros of psi' are at w t = j pi/(2K), so it is the largest of 4K - 1 values.

    `value` evaluates psi at a phase w t. The zeros come from `telescopes`: psi' is a multiple of sin(2K u)/sin u.
    """
    terms = odd_square_wave_terms(psi) or 0
    zeros = [Fraction(j, 2 * terms) for j in range(1, 4 * terms)]
    best, where = abs(value(arb.pi() * ball(zeros[0]))), zeros[0]
    for zero in zeros[1:]:
        size = abs(value(arb.pi() * ball(zero)))
        if size > best:
            best, where = size, zero
    return best, where
