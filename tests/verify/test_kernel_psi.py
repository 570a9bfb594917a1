"""The kernel's bound of |psi|: decided exactly, on both halves of a period, for both signs."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import mpmath as mp
import pytest
from gaincert.models.errors import InputError
from gaincert.models.numbers import decimal_text
from gaincert.verify import kernel
from gaincert.verify.certificates.arcs import arcs as find_arcs
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.verify.certificate_documents import arcs, check, document, harmonics, reason, refusal, single


def psi_of(excitation: dict[str, Any], places: int = 0) -> kernel.Psi:
    return kernel.read_psi(kernel.Reader(max(places, kernel.places_of(excitation)), 1), excitation)


def bounded(psi: dict[str, Any], bar: str) -> bool:
    """Whether arcs are found and the kernel accepts them."""
    try:
        content = single(psi_bar=bar, arcs=find_arcs(psi, bar))
    except InputError:
        return False
    content["fleet"]["excitation"] = psi
    return check(content).valid


def test_pi_is_bounded_from_below_by_its_decimals() -> None:
    below, unit = kernel.PI_BELOW
    with mp.workdps(90):
        assert mp.mpf(below) / unit < mp.pi < mp.mpf(below + 1) / unit


def test_the_bound_of_the_papers_psi_is_proven_below_2_4323284() -> None:
    content = document()
    assert Fraction(content["psi_bar"]) < Fraction("2.4323284")
    margins = {name: " ".join("0" * 6) for name in content["margins"]}
    for bar, valid in (("2.4323284", True), ("2.43232820886", False), ("2.4323282", False), ("2.43", False)):
        assert check({**content, "psi_bar": bar, "margins": margins}).valid == valid
    finer = find_arcs(content["fleet"]["excitation"], "2.43232820886")
    assert check({**content, "psi_bar": "2.43232820886", "arcs": finer, "margins": margins}).valid
    assert "psi_bounded: |psi| > psi_bar at" in reason({**content, "psi_bar": "2.43"})
    with pytest.raises(InputError, match="too close to the supremum"):
        find_arcs(content["fleet"]["excitation"], "2.4323282")


@settings(deadline=None, max_examples=50)
@given(st.integers(0, 30), st.integers(1, 8))
def test_psi_bounds_are_decided_to_every_digit(digits: int, harmonic: int) -> None:
    # |3/4 + sin(n x)| has the supremum 7/4, which no rational half-tangent attains for n = 1 .. 8 but at n x = pi/2.
    psi = harmonics(" ".join("0" * (harmonic - 1) + "1"), mean="0.75")
    off = Fraction(1, 10**digits)
    assert bounded(psi, decimal_text(Fraction(7, 4) + off))
    if digits <= 9:
        assert not bounded(psi, decimal_text(Fraction(7, 4) - off / 10))


@pytest.mark.parametrize("sign", ["", "-"])
@pytest.mark.parametrize("half_turn", [0, 1])
def test_a_bound_is_checked_on_both_halves_and_for_both_signs(sign: str, half_turn: int) -> None:
    """|1/4 + cos(x)| has its only supremum, 5/4, at x = 0; with -cos(x) it is at x = pi; then both negated."""
    wave = {"": "-", "-": ""}[sign] + "1" if half_turn else sign + "1"
    psi = harmonics(cos=wave, mean=f"{sign}0.25")
    assert bounded(psi, "1.2500000001")
    for bar, words in (
        ("1.2499999999", "is too wide"),
        ("0.25", "|psi| > psi_bar at w t = 2 atan("),
        ("0.2499", f"psi has the mean {sign}0.25, beyond psi_bar = 0.2499"),
    ):
        content = single(psi_bar=bar, arcs=find_arcs(psi, "1.2500000001"))
        content["fleet"]["excitation"] = psi
        assert reason(content).startswith("INVALID: psi_bounded: ") and words in reason(content)
    wave, arcs_of_16 = psi_of(psi, 10), [4] * 32
    kernel.bounded_on_half(wave, 12 * 10**9, 1 - half_turn, arcs_of_16)
    with pytest.raises(kernel.FalseError, match=rf"psi_bar at w t = 2 atan\(.*\) \+ {half_turn} pi"):
        kernel.bounded_on_half(wave, 12 * 10**9, half_turn, arcs_of_16)


@pytest.mark.parametrize("n", range(1, 6))
def test_every_harmonic_is_turned_by_half_a_period(n: int) -> None:
    """sin(n x) and cos(n x) at x + pi are (-1)^n times what they are at x."""
    psi = psi_of(harmonics(" ".join("0" * (n - 1) + "2"), " ".join("0" * (n - 1) + "1"), mean="0.75"))
    for half_turn in (0, 1):
        for p, q in ((0, 1), (1, 3), (-2, 5)):
            least, scale = kernel.slack(psi, 400, half_turn, p, q)
            x = 2 * mp.atan(mp.mpf(p) / q) + mp.pi * half_turn
            value = 75 + 100 * mp.cos(n * x) + 200 * mp.sin(n * x)
            assert mp.almosteq(mp.mpf(least) / scale, min(400 - value, 400 + value), 1e-12)


@pytest.mark.parametrize("terms", [1, 3, 10])
def test_a_square_wave_counts_with_less_than_pi(terms: int) -> None:
    """4 / pi sum sin((2k - 1) x) / (2k - 1): what is a bound with the decimals of pi is one with pi."""
    psi = psi_of({"family": "square-wave", "mean": "0.25", "frequency": "1", "terms": terms})
    with mp.workdps(60):
        for p, q in ((1, 1), (-1, 1), (3, 7)):
            x = 2 * mp.atan(mp.mpf(p) / q)
            true = mp.mpf(1) / 4 + 4 / mp.pi * sum(mp.sin(n * x) / n for n in range(1, 2 * terms, 2))
            for bar in (150, 200):
                least, scale = kernel.slack(psi, bar, 0, p, q)
                claimed = mp.mpf(least) / (psi.over * scale)
                assert claimed <= min(bar - 100 * true, bar + 100 * true)
                assert mp.almosteq(claimed, min(bar - 100 * true, bar + 100 * true), 1e-40, 1e-40)


@pytest.mark.parametrize(("above", "valid"), [("1.2732395447351626861510701070", True), ("1.2732395447351", False)])
def test_four_over_pi_is_a_bound_of_one_term(above: str, valid: bool) -> None:
    psi = {"family": "square-wave", "mean": "0", "frequency": "1", "terms": 1}
    assert bounded(psi, above) == valid


@pytest.mark.parametrize("depth", [1, 2, 3])
def test_an_arc_is_accepted_up_to_what_the_curvature_takes(depth: int) -> None:
    """psi = cos(x) over the arc of t that ends at 0: slack bar - 1 there, and B h^2 / 8 = 2^(-2 depth) / 2."""
    psi, unit = psi_of(harmonics(cos="1"), 12), 10**12
    needed = unit >> (2 * depth + 1)
    for bar, fits in ((unit + needed, True), (unit + needed - 1, False)):
        ends = kernel.slack(psi, bar, 0, -1, 1 << depth), kernel.slack(psi, bar, 0, 0, 1)
        assert kernel.settled(psi, depth, *ends) == fits
        assert not kernel.settled(psi, depth, (-1, 1), ends[0])


@pytest.mark.parametrize(("s", "c"), [(3, 2), (-3, 2), (3, -2), (-3, -2), (0, -5), (-5, 0)])
@pytest.mark.parametrize("n", [1, 3])
def test_the_curvature_counts_every_amplitude(s: int, c: int, n: int) -> None:
    """|psi''| <= sum n^2 (|s_n| + |c_n|), whatever the signs; 2^(2 depth + 1) times the slack is as much or more."""
    psi, most = kernel.Psi(0, [(n, s, c), (4, 1, 0)], 7, 1), 7 * (n * n * (abs(s) + abs(c)) + 16)
    for depth in (0, 1, 5):
        scale = 2 ** (2 * depth + 1)
        for least, fits in ((most, True), (most - 1, False)):
            assert kernel.settled(psi, depth, (least, scale)) == fits
            assert kernel.settled(psi, depth, (least, scale), (10 * most, scale)) == fits


def test_a_bound_that_is_passed_by_one_unit_is_said_to_be_passed() -> None:
    with pytest.raises(kernel.FalseError, match=r"^\|psi\| > psi_bar at w t = 2 atan\(0\) \+ 0 pi$"):
        kernel.bounded_on_half(kernel.Psi(0, [(1, 0, 1)], 1, 1), 0, 0, [0, 0])


def test_a_list_of_arcs_is_no_longer_than_its_work_allows(monkeypatch: pytest.MonkeyPatch) -> None:
    """An arc costs 4 or more: eight arcs are refused before they are read where the work may be 31."""
    monkeypatch.setattr(kernel, "MAX_WORK", 32)
    assert check(single()).valid
    monkeypatch.setattr(kernel, "MAX_WORK", 31)
    assert "arcs: expected a string of 7 decimals" in refusal(single())


@pytest.mark.parametrize("terms", [100, 101])
def test_a_square_wave_has_at_most_100_terms(terms: int) -> None:
    psi = {"family": "square-wave", "mean": "0", "frequency": "1", "terms": terms}
    if terms <= 100:
        assert len(psi_of(psi).terms) == 100
    else:
        with pytest.raises(kernel.UnreadableError, match="terms must be 1 to 100"):
            psi_of(psi)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"here": "2 2 2 2 2 2 2"}, "the arcs do not cover half a period"),
        ({"here": "2 2 2 2 2 2 2 2 2"}, "the arcs do not cover half a period"),
        ({"opposite": "3 2 2 2 2 2 2 2"}, "the arcs do not cover half a period"),
        ({"opposite": ""}, "the arcs do not cover half a period"),
        ({"here": "0 0"}, "the arc of width 2^-0 that ends at"),
        ({"opposite": "2 2 1 2 2 1"}, "the arc of width 2^-1 that ends at 1 is too wide"),
    ],
)
def test_arcs_cover_both_halves_and_are_narrow_enough(change: dict[str, str], words: str) -> None:
    content = single()
    content["arcs"].update(change)
    assert words in reason(content)


def test_arcs_of_other_widths_serve_as_well() -> None:
    content = single()
    content["arcs"].update(here="2 2 2 3 3 2 4 4 3 2 2", opposite="5 " * 63 + "5")
    assert check(content).valid


def test_the_supremum_itself_is_refused_as_too_close() -> None:
    with pytest.raises(InputError, match="too close to the supremum"):
        find_arcs(harmonics(cos="1", mean="0.75"), "1.75")
    content = single(psi_bar="1.75", arcs=arcs(6))
    content["fleet"]["excitation"] = harmonics(cos="1", mean="0.75")
    assert "is too wide" in reason(content)


def test_the_work_on_psi_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    """A point costs 3, the highest harmonic, and the square of it times the depth, over 10^5; about microseconds."""
    content = single(arcs=arcs(2))
    content["fleet"]["excitation"] = harmonics(" ".join(["0.1"] + ["0.0"] * 198 + ["0.1"]))
    assert "too wide" in reason(content)
    monkeypatch.setattr(kernel, "MAX_WORK", 10**5)
    most = kernel.MAX_WORK // (3 + 200 + (17 * 200) ** 2 // 10**5)
    content["arcs"]["here"] = " ".join(["17"] * most)
    assert "do not cover" in reason(content)
    content["arcs"]["here"] = " ".join(["17"] * (most + 1))
    assert "arcs: too many to be checked" in refusal(content)


@pytest.mark.parametrize("depth", ["80", "-1", "1.5", ""])
def test_a_depth_is_an_integer_below_80(depth: str) -> None:
    content = single()
    content["arcs"]["here"] = f"{depth} 2"
    try:
        assert not check(content).valid
    except kernel.UnreadableError as error:
        assert "arcs" in str(error)


def test_a_constant_psi_is_refused() -> None:
    for psi in (harmonics(mean="0.5"), harmonics("0 0", "0.0", mean="0.5")):
        content = single()
        content["fleet"]["excitation"] = psi
        assert reason(content) == "INVALID: excited: psi is constant"
    with pytest.raises(InputError, match="psi is constant"):
        find_arcs(harmonics("0"), "1")


def test_psi_is_read_as_it_is_written() -> None:
    reader = kernel.Reader(2, 1)
    square = kernel.read_psi(reader, {"family": "square-wave", "mean": "-0.5", "frequency": "2", "terms": 3})
    assert (square.mean, square.terms) == (-50, [(1, 15, 0), (3, 5, 0), (5, 3, 0)])
    assert Fraction(square.times, square.over) > Fraction(400, 15) / Fraction("3.14159265358979323846264338327950289")
    for sin, cos in (("1 0 0 3", "0.0 0.5"), ("1", "0.0 0.5 0.0 0.0"), ("", ""), ("-1.25", "")):
        psi = kernel.read_psi(reader, harmonics(sin, cos, "-0.5", "2"))
        assert (psi.mean, psi.times, psi.over) == (-50, 1, 1)
        found = {n: (s, c) for n, s, c in psi.terms}
        for n in range(1, 5):
            own = tuple(Fraction(q.split()[n - 1]) * 100 if n <= len(q.split()) else 0 for q in (sin, cos))
            assert found.get(n, (0, 0)) == own
        assert (0, 0) not in found.values()


@pytest.mark.parametrize(
    "wrong",
    [
        {"family": "noise"},
        {"sin": 5},
        {"cos": "x"},
        {"sin": ["1"]},
        {"frequency": None},
        {"mean": "1 2"},
        {"more": "1"},
        *({"family": "square-wave", "terms": terms} for terms in (0, -1, True, "3", 101, None)),
    ],
)
def test_another_excitation_is_refused(wrong: dict[str, Any]) -> None:
    table = {**harmonics("1"), **wrong}
    if wrong.get("family") == "square-wave":
        table = {key: value for key, value in table.items() if key not in ("sin", "cos")}
    content = single()
    content["fleet"]["excitation"] = table
    refusal(content)
    content = single()
    content["designed"]["excitation"] = table
    refusal(content)


def test_the_frequency_must_be_positive() -> None:
    for frequency in ("0", "-1"):
        content = single()
        content["fleet"]["excitation"]["frequency"] = frequency
        assert "frequency: all must be > 0 (A2)" in reason(content)


@pytest.mark.parametrize("harmonics_count", [199, 200, 201])
def test_psi_has_at_most_200_harmonics(harmonics_count: int) -> None:
    content = single(arcs=arcs(8))
    content["fleet"]["excitation"] = harmonics(" ".join(["0"] * (harmonics_count - 1) + ["1"]))
    if harmonics_count <= 200:
        assert "too wide" in reason(content)
    else:
        assert "at most 200 harmonics" in refusal(content)


@pytest.mark.parametrize(("p", "q"), [(0, 1), (1, 1), (-1, 1), (1, 2), (-3, 7), (5, 3)])
def test_harmonic_sums_are_those_of_sines_and_cosines(p: int, q: int) -> None:
    terms = {1: (3, -2), 2: (0, 5), 5: (-7, 1)}
    numerator, denominator = kernel.harmonic_sum(terms, p, q)
    assert denominator == (p * p + q * q) ** 5
    with mp.workdps(40):
        x = 2 * mp.atan(mp.mpf(p) / q)
        true = sum(s * mp.sin(n * x) + c * mp.cos(n * x) for n, (s, c) in terms.items())
        assert mp.almosteq(mp.mpf(numerator) / denominator, true, 1e-35, 1e-35)
