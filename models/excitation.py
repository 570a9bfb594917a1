"""The excitation psi(t) of (11): its families, its derivatives, the exact integral of (12) and certified bounds."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from heapq import heapify, heappop, heappush
from typing import Any

from .algebra.ops import Ops
from .arrays import Array
from .numbers import decimal_text

CELLS = 20_000  # most cells of the branch and bound
BOUND_EXCESS = Fraction(1, 10**9)  # a certified bound exceeds the supremum by at most this fraction of it


@dataclass(frozen=True)
class Excitation:
    """psi(t) = mean + pi^-p sum_n [ sin_n sin(n w t) + cos_n cos(n w t) ], n = 1, 2, ..., with rational numbers.

    The power p is 1 for the paper's square wave, whose Fourier coefficients are rational multiples of 1/pi.
    """

    mean: Fraction
    frequency: Fraction  # w, rad/s
    sin: tuple[Fraction, ...]
    cos: tuple[Fraction, ...] = ()
    over_pi: bool = False
    terms: int | None = None  # of the square wave; kept to write the fleet file back unchanged

    @classmethod
    def square_wave(cls, mean: Fraction, terms: int, frequency: Fraction) -> Excitation:
        """The psi of Section 4: mean + sum_k 4 / ((2k-1) pi) sin((2k-1) w t), k = 1..terms."""
        sin = [Fraction(4, n) if n % 2 else Fraction(0) for n in range(1, 2 * terms)]
        return cls(mean, frequency, tuple(sin), over_pi=True, terms=terms)

    @property
    def harmonics(self) -> int:
        """The number of the highest harmonic."""
        return max(len(self.sin), len(self.cos))

    @cached_property
    def coefficients(self) -> list[tuple[int, Fraction, Fraction]]:
        """(n, sin_n, cos_n) of every harmonic that is present, without the factor pi^-p."""
        sin = self.sin + (Fraction(0),) * (self.harmonics - len(self.sin))
        cos = self.cos + (Fraction(0),) * (self.harmonics - len(self.cos))
        return [(n, s, c) for n, (s, c) in enumerate(zip(sin, cos, strict=True), 1) if s or c]

    def phasors(self) -> list[tuple[float, complex]]:
        """(w in rad/s, A) of the mean and of every harmonic that is present: psi(t) is the sum of Im(A e^(i w t))."""
        scale = 1 / math.pi if self.over_pi else 1.0
        tones = [(float(n * self.frequency), scale * complex(s, c)) for n, s, c in self.coefficients]
        return [(0.0, complex(0, self.mean)), *tones]

    def value(self, ops: Ops, t: Array) -> Array:
        """psi(t) over any algebra; exact over SymPy."""
        scale = 1 / ops.pi if self.over_pi else 1
        psi = ops.number(self.mean)
        for n, s, c in self.coefficients:
            phase = ops.number(n * self.frequency) * t
            parts = [ops.number(a) * wave(phase) for a, wave in ((s, ops.sin), (c, ops.cos)) if a]
            psi = psi + scale * sum(parts[1:], parts[0])
        return psi

    def map(self, convert: Callable[[Fraction], Any]) -> Excitation:
        """The same psi with every number converted, for example to floats."""
        numbers: dict[str, Any] = {"sin": tuple(map(convert, self.sin)), "cos": tuple(map(convert, self.cos))}
        return replace(self, mean=convert(self.mean), frequency=convert(self.frequency), **numbers)

    def table(self) -> dict[str, Any]:
        """The [excitation] table of this psi, numbers as exact decimal strings."""
        common = {"mean": decimal_text(self.mean), "frequency": decimal_text(self.frequency)}
        if self.terms is not None:
            return {"family": "square-wave", **common, "terms": self.terms}
        if self.over_pi:
            raise ValueError("coefficients with 1/pi are no table of a fleet file")
        tones = {"sin": [decimal_text(s) for s in self.sin], "cos": [decimal_text(c) for c in self.cos]}
        return {"family": "harmonics", **common, **tones}

    def derivative(self) -> Excitation:
        """psi'(t), again a Fourier sum."""
        sin, cos = [Fraction(0)] * self.harmonics, [Fraction(0)] * self.harmonics
        for n, s, c in self.coefficients:
            sin[n - 1], cos[n - 1] = -n * self.frequency * c, n * self.frequency * s
        return Excitation(Fraction(0), self.frequency, tuple(sin), tuple(cos), self.over_pi)

    def power(self) -> tuple[Fraction, int]:
        """(q, j): the integral of psi'^2 over one period 2 pi / w, (12), is exactly q pi^j, by orthogonality."""
        squares = sum((n * n * (s * s + c * c) for n, s, c in self.coefficients), Fraction(0))
        return self.frequency * squares, 1 - 2 * self.over_pi

    @property
    def persistent(self) -> bool:
        """(12): psi' is persistently exciting, which for a Fourier sum means that psi is not constant."""
        return self.power()[0] > 0

    @cached_property
    def bound(self) -> Fraction:
        """psi_bar >= |psi(t)| for all t: proved in ball arithmetic, with a relative excess of at most 1e-8."""
        return _supremum(self)

    @cached_property
    def derivative_bounds(self) -> tuple[Fraction, Fraction]:
        """(psi_1, psi_2): certified bounds of |psi'| and |psi''|."""
        rate = self.derivative()
        return rate.bound, rate.derivative().bound


def _supremum(psi: Excitation) -> Fraction:
    """An upper bound of |psi| over one period, by branch and bound in Arb's ball arithmetic.

    On a cell of half-width h around phase a, Taylor's theorem gives |psi| <= |psi(a)| + |psi'(a)| h + M h^2 / 2 with
    M >= |psi''| everywhere. The cell with the largest bound is halved until it is within BOUND_EXCESS of a value
    that psi takes. A psi with a very flat top runs out of CELLS first: its bound is then as valid and a little looser.
    """
    from flint import arb, ctx

    with ctx.workprec(128):
        scale = 1 / arb.pi() if psi.over_pi else arb(1)
        terms = [(n, scale * _arb(s), scale * _arb(c)) for n, s, c in psi.coefficients]
        mean = _arb(psi.mean)
        curvature = sum((n * n * (abs(s) + abs(c)) for n, s, c in terms), arb(0))

        def cell(a: Fraction, h: Fraction) -> tuple[float, Fraction, Fraction, Any, Any]:
            value, slope = _value_and_slope(terms, mean, 2 * arb.pi() * _arb(a))
            width = 2 * arb.pi() * _arb(h)
            upper = (abs(value) + abs(slope) * width + curvature * width * width / 2).upper()
            return -float(upper), a, h, upper, abs(value).lower()

        parts = 8 * max(1, psi.harmonics)
        cells = [cell(Fraction(2 * i + 1, 2 * parts), Fraction(1, 2 * parts)) for i in range(parts)]
        heapify(cells)
        lower = max(entry[4] for entry in cells)
        while len(cells) < CELLS and not cells[0][3] <= lower * (1 + _arb(BOUND_EXCESS)):
            _, a, h, _, _ = heappop(cells)
            for centre in (a - h / 2, a + h / 2):
                heappush(cells, new := cell(centre, h / 2))
                lower = max(lower, new[4])
        # The heap is ordered by a rounded key; the largest exact bound lies within that rounding of the first.
        return _round_up(max(entry[3] for entry in cells))


def _value_and_slope(terms: Sequence[tuple[int, Any, Any]], mean: Any, phase: Any) -> tuple[Any, Any]:
    value, slope = mean, 0 * mean
    for n, s, c in terms:
        sine, cosine = (n * phase).sin_cos()
        value += s * sine + c * cosine
        slope += n * (s * cosine - c * sine)
    return value, slope


def _arb(q: Fraction | int) -> Any:
    from flint import arb, fmpq

    return arb(fmpq(q.numerator, q.denominator))


def _round_up(x: Any) -> Fraction:
    """A decimal of 12 significant digits that is not below the Arb number x."""
    if x == 0:
        return Fraction(0)
    unit = Fraction(10) ** (math.floor(math.log10(float(x))) - 11)
    rounded: Fraction = math.ceil(Fraction(float(x)) / unit) * unit
    while not _arb(rounded) >= x:
        rounded += unit
    return rounded
