"""The excitation: certified bounds against exact values and dense grids, (12) exactly, derivatives consistent."""

import math
from fractions import Fraction

import casadi as ca
import mpmath
import numpy as np
import pytest
import sympy as sp
from gaincert.models.algebra.ops import casadi_ops, numpy_ops, sympy_ops
from gaincert.models.conditions import condition_15, exact_numbers
from gaincert.models.excitation import BOUND_EXCESS, Excitation
from gaincert.models.files.fleet_file import parse

ROUNDING = Fraction(1, 10**8)  # what a bound may exceed the supremum by, relatively: its docstring's promise


def wave(mean, sin=(), cos=(), frequency=1, **options):
    def exact(values):
        return tuple(Fraction(str(value)) for value in values)

    return Excitation(Fraction(str(mean)), Fraction(str(frequency)), exact(sin), exact(cos), **options)


def random_wave(random, harmonics):
    sin, cos = np.round(random.normal(size=(2, harmonics)), 3)
    return wave(round(random.normal(), 3), sin, cos, frequency=round(random.uniform(0.1, 5), 3))


def on_grid(psi, points):
    """psi over one period, and how far |psi| may rise above its largest grid value."""
    step = 2 * math.pi / float(psi.frequency) / points
    curvature = float(psi.frequency) ** 2 * sum(n * n * math.hypot(s, c) for n, s, c in psi.coefficients)
    # The supremum has a flat top at most half a step from a grid point: Taylor with |psi''| <= curvature.
    return psi.value(numpy_ops(), step * np.arange(points)), curvature * step**2 / 8


def test_the_bound_of_the_paper_s_psi_lies_just_above_its_exact_supremum(psi_of_paper):
    with mpmath.workdps(60):
        exact = (208 + 2000 * mpmath.sqrt(5) + 1575 * mpmath.pi) / (1260 * mpmath.pi)
        bound = mpmath.mpf(psi_of_paper.bound.numerator) / psi_of_paper.bound.denominator
        assert exact <= bound <= exact * (1 + mpmath.mpf("1e-6"))
        assert bound <= exact * (1 + mpmath.mpf("1e-8"))
        assert mpmath.nstr(exact, 15) == "2.43232820885761"
    attained = psi_of_paper.value(sympy_ops(), sp.pi / 5)
    assert float(sp.N(attained, 30)) == pytest.approx(float(exact), rel=1e-15)


def test_a_bound_rounded_down_would_not_be_a_bound(psi_of_paper):
    assert Fraction("2.43") < psi_of_paper.value(numpy_ops(), math.pi / 5) < psi_of_paper.bound


def test_the_paper_s_psi_is_its_formula(psi_of_paper):
    t = np.linspace(0, 30, 500)
    printed = 5 / 4 + sum(4 / ((2 * k - 1) * math.pi) * np.sin((2 * k - 1) / 2 * t) for k in range(1, 6))
    assert np.allclose(psi_of_paper.value(numpy_ops(), t), printed, atol=1e-14)


def test_psi_as_printed_reaches_12_919_and_breaks_15_for_every_vehicle(paper, gains_of_paper, psi_of_paper):
    pi = Fraction(mpmath.nstr(mpmath.pi, 40))
    printed = Excitation(Fraction(5, 4), Fraction(1, 2), tuple(pi * s for s in psi_of_paper.sin))
    assert float(printed.bound) == pytest.approx(12.919, abs=5e-4)
    assert not condition_15(exact_numbers(), paper.condition_data(printed), gains_of_paper).holds.any()
    assert condition_15(exact_numbers(), paper.condition_data(psi_of_paper), gains_of_paper).holds.all()


def test_the_derivative_bounds_of_the_paper_s_psi(psi_of_paper):
    # psi' = (2 / pi) sum cos((2k-1) t / 2) is largest at t = 0: 10 / pi.
    first, second = psi_of_paper.derivative_bounds
    assert 10 / math.pi <= first <= 10 / math.pi * (1 + 1e-8)
    t = np.linspace(0, 4 * math.pi, 400_001)
    curve = np.abs(sum((2 * k - 1) * np.sin((2 * k - 1) / 2 * t) for k in range(1, 6))) / math.pi
    assert curve.max() <= second <= curve.max() * (1 + 1e-7)


@pytest.mark.parametrize("harmonics", [1, 2, 3, 7, 20])
def test_bounds_enclose_random_sums_tightly(harmonics, random):
    for _ in range(3):
        psi = random_wave(random, harmonics)
        for curve, bound in zip(
            (psi, psi.derivative(), psi.derivative().derivative()),
            (psi.bound, *psi.derivative_bounds),
            strict=True,
        ):
            values, rise = on_grid(curve, 4000 * harmonics)
            top = np.max(np.abs(values))
            assert top <= bound * (1 + 1e-12)
            assert bound <= (top + rise) * (1 + ROUNDING)


@pytest.mark.parametrize(
    ("psi", "supremum"),
    [
        (wave(0), 0),
        (wave(-3), 3),
        (wave(0, [0, 0, 2]), 2),
        (wave(0, [3], [4]), 5),
        (wave("-1.25", [], ["0.75"]), 2),  # the trough is the extreme, at t = 0
        (wave("1e-30", ["1e-30"]), 2e-30),
        (wave(7, ["1e-20"], frequency="1e-9"), 7),
        (wave(0, [0] * 60 + [1]), 1),
    ],
    ids=["zero", "constant", "one tone", "3-4-5", "negative", "tiny", "swamped", "high"],
)
def test_bounds_of_simple_sums(psi, supremum):
    assert supremum <= psi.bound or math.isclose(supremum, psi.bound, rel_tol=1e-15)
    assert psi.bound <= Fraction(supremum) * (1 + ROUNDING)


def test_the_search_stops_far_below_the_promised_excess():
    assert BOUND_EXCESS < ROUNDING <= Fraction(1, 10**6)


def test_12_of_the_paper_s_psi_is_20_over_pi_on_every_window_of_2_pi(psi_of_paper):
    integral, power = psi_of_paper.power()
    assert (integral, power) == (40, -1)  # over its period 4 pi: 40 / pi exactly
    t, start = sp.symbols("t s", real=True)
    slope = psi_of_paper.derivative().value(sympy_ops(), t)
    antiderivative = sp.integrate(sp.expand(slope**2), t)
    window = antiderivative.subs(t, start + 2 * sp.pi) - antiderivative.subs(t, start)
    for instant in (0, sp.Rational(1, 3), sp.pi / 7, 50):
        assert abs(sp.N(window.subs(start, instant) - 20 / sp.pi, 30)) < 1e-25


def test_12_is_the_integral_over_a_period(random):
    for harmonics in (1, 3, 8):
        psi = random_wave(random, harmonics)
        integral, power = psi.power()
        assert psi.persistent
        # The mean over equidistant points is exact for a trigonometric polynomial.
        period = 2 * math.pi / float(psi.frequency)
        slope = psi.derivative().value(numpy_ops(), period * np.arange(4 * harmonics + 1) / (4 * harmonics + 1))
        assert float(integral) * math.pi**power == pytest.approx(period * np.mean(slope**2), rel=1e-10)


@pytest.mark.parametrize("psi", [wave(0), wave(2), wave(2, [0, 0], [0])], ids=["zero", "constant", "zero tones"])
def test_a_constant_psi_does_not_excite(psi):
    assert psi.power()[0] == 0
    assert not psi.persistent


def test_derivatives_are_derivatives(psi, psi_of_paper):
    t = sp.Symbol("t", real=True)
    for excitation in (psi, psi_of_paper):
        curve, value = excitation, excitation.value(sympy_ops(), t)
        for _ in range(2):
            curve, value = curve.derivative(), sp.diff(value, t)
            assert sp.expand(curve.value(sympy_ops(), t) - value) == 0


def test_psi_is_the_same_in_every_algebra(psi, psi_of_paper):
    for excitation in (psi, psi_of_paper):
        for instant in (-3.0, 0.0, 0.7, 41.5):
            exact = float(sp.N(excitation.value(sympy_ops(), sp.Rational(Fraction(instant))), 30))
            assert excitation.value(numpy_ops(), instant) == pytest.approx(exact, abs=1e-13)
            assert float(excitation.value(casadi_ops(), ca.DM(instant))) == pytest.approx(exact, abs=1e-13)


def test_sines_and_cosines_may_be_of_different_number():
    longer = wave("0.5", [1], [0, 2], frequency=3)
    t = np.linspace(0, 5, 40)
    assert np.allclose(longer.value(numpy_ops(), t), 0.5 + np.sin(3 * t) + 2 * np.cos(6 * t))
    assert np.allclose(longer.derivative().value(numpy_ops(), t), 3 * np.cos(3 * t) - 12 * np.sin(6 * t))


def test_phasors_add_up_to_psi(psi, psi_of_paper):
    t = np.linspace(-4, 20, 60)
    for excitation in (psi, psi_of_paper):
        waves = sum((A * np.exp(1j * w * t)).imag for w, A in excitation.phasors())
        assert np.allclose(waves, excitation.value(numpy_ops(), t), atol=1e-13)


@pytest.mark.parametrize("family", ["line"], indirect=True)
@pytest.mark.parametrize("drive", ["physical"], indirect=True)
def test_the_table_of_a_fleet_file_says_the_same(content, psi, psi_of_paper):
    for excitation in (psi, psi_of_paper):
        assert parse({**content, "excitation": excitation.table()}).psi == excitation


def test_coefficients_with_1_over_pi_are_no_table(psi_of_paper):
    with pytest.raises(ValueError, match="1/pi"):
        psi_of_paper.derivative().table()
