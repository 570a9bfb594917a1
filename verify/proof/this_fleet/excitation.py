"""Exact facts about a Fourier excitation: (12), the number nu of L10, and the bounds of psi and its derivatives.

Each is computed here from the coefficients, and once more from samples of psi itself: over M equally spaced points of a
period the mean of a trigonometric polynomial of degree below M is exact, and its maximum over them falls short of the
supremum by a factor of at most cos(pi n/M), n the highest harmonic, M >= 2n (Ehlich and Zeller).
"""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations

import numpy as np
import sympy as sp
from flint import arb

from ....models.excitation import Excitation
from ..claim import Claim, Fact, Kind, Relation
from ..constants import steep_stretch, variance_bound
from ..method.ball import Ball, arb_ops, ball, precise
from ..method.inferences import compared
from ..method.symbols import symbol

SAMPLES = 200  # per harmonic and period: the supremum is then known to 1.3e-4
EXCESS = sp.Rational(10**8 + 1, 10**8)  # of a certified bound over the supremum, at most


def rate_power(psi: Excitation, turns: Fraction) -> tuple[Fraction, int] | None:
    """(q, j): the integral of psi'^2 over any window of length 2 pi `turns` is q pi^j; None where the window matters.

    Products of two tones are sums of tones at n w +- m w; each integrates to 0 over the window if and only if its
    frequency times `turns` is a whole number other than 0. Where 2 n w and n w - m w have that, so has n w + m w.
    """
    terms = psi.derivative().coefficients
    tones = [2 * n for n, _, _ in terms]
    tones += [n - m for (n, _, _), (m, _, _) in combinations(terms, 2)]
    if any((tone * psi.frequency * turns).denominator != 1 for tone in tones):
        return None
    squares = sum((c * c + s * s for _, s, c in terms), Fraction(0))
    return squares * turns, 1 - 2 * psi.over_pi


def variance(psi: Excitation) -> tuple[Fraction, int]:
    """(q, j): min over c of the integral of (psi - c)^2 over one period 2 pi / w is q pi^j (L10, by orthogonality)."""
    squares = sum((s * s + c * c for _, s, c in psi.coefficients), Fraction(0))
    return squares / psi.frequency, 1 - 2 * psi.over_pi


def samples(psi: Excitation) -> list[Ball]:
    """psi at SAMPLES points per harmonic of one period."""
    count = SAMPLES * max(1, psi.harmonics)
    times = np.array([2 * arb.pi() * n / (count * ball(psi.frequency)) for n in range(count)], dtype=object)
    return list(psi.value(arb_ops(), times) + 0 * times)  # an array where psi is constant, too


def power_of_samples(psi: Excitation) -> Ball:
    """The integral of psi^2 over one period, from its samples."""
    found = samples(psi)
    return sum((value * value for value in found), arb(0)) / len(found) * 2 * arb.pi() / ball(psi.frequency)


def times_power_of_pi(value: tuple[Fraction, int]) -> Ball:
    """q pi^j."""
    return ball(value[0]) * arb.pi() ** value[1]


def assumption_3(psi: Excitation) -> Claim:
    """(A3): psi, psi' and psi'' are bounded, and psi' is persistently exciting over every period."""
    mu, (q, power) = symbol("mu"), rate_power(psi, 1 / psi.frequency) or (Fraction(0), 0)
    with precise():
        sampled = power_of_samples(psi.derivative())
        exact = times_power_of_pi((q, power))
        exciting, twice = compared(Relation(mu, ">", 0), {mu: exact}), computed_twice("mu", exact, sampled)
        bounds = [fact for row in _bounds(psi) for fact in _bounded(*row)]
    return Claim("A3", Kind.FLEET, (exciting, twice, *bounds))


def _bounds(psi: Excitation) -> list[tuple[str, Excitation, Fraction]]:
    first, second = psi.derivative_bounds
    rate = psi.derivative()
    return [("psi_bar", psi, psi.bound), ("psi1", rate, first), ("psi2", rate.derivative(), second)]


def _bounded(name: str, psi: Excitation, bound: Fraction) -> tuple[Fact, Fact]:
    """The certified bound lies between the largest sample and what the samples leave possible."""
    letter, found = symbol(name), symbol("largest_sample")
    values = {letter: bound, found: max((abs(value) for value in samples(psi)), key=float)}
    most = found * EXCESS / sp.cos(sp.pi / SAMPLES)
    return compared(Relation(found, "<=", letter), values), compared(Relation(letter, "<=", most), values)


def computed_twice(name: str, one: Ball, other: Ball) -> Fact:
    """Two computations of a number differ by less than 1e-30 of it."""
    exact, sampled = symbol(name), symbol(f"{name}_sampled")
    relation = Relation(sp.Abs(exact - sampled), "<=", exact * sp.Rational(1, 10**30))
    return compared(relation, {exact: one, sampled: other})


def window_number(psi: Excitation) -> Claim:
    """nu over one period: positive, the same from samples, and at least what L10 gives."""
    mean = Excitation(psi.mean, psi.frequency, ())
    nu, below, q = symbol("nu"), symbol("nu_L10"), times_power_of_pi
    with precise():
        exact, mu, period = q(variance(psi)), q(psi.power()), 2 * arb.pi() / ball(psi.frequency)
        sampled = power_of_samples(psi) - ball(mean.mean) ** 2 * period
        stretch = min(period / 2, steep_stretch(period, mu, ball(psi.derivative_bounds[1])), key=float)
        least = variance_bound(period, mu, stretch)
        facts = (
            compared(Relation(nu, ">", 0), {nu: exact}),
            computed_twice("nu", exact, sampled),
            compared(Relation(below, "<=", nu), {below: least, nu: exact}),
        )
    return Claim("nu", Kind.FLEET, facts)
