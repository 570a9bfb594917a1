"""The kernel's conditions: decided exactly, with every limit, for every value of an interval."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from gaincert.models import conditions
from gaincert.verify import kernel
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.campaigns.certified_fleets import CASES
from tests.verify.certificate_documents import (
    Document,
    check,
    column,
    document,
    harmonics,
    reason,
    refusal,
    single,
    with_limit,
)


@settings(deadline=None)
@given(st.integers(1, 10**9), st.integers(1, 10**9), st.sampled_from([kernel.COARSE, kernel.FINE, 10, 1]))
def test_tanh_is_bounded_from_below_and_closely(p: int, q: int, one: int) -> None:
    a, b = kernel.tanh_below(p, q, one)
    with mp.workdps(400):
        true = mp.tanh(mp.mpf(p) / q)
        assert 0 <= mp.mpf(a) / b <= true
        if one >= kernel.COARSE and p / q > 1e-3:
            assert mp.mpf(a) / b > min(true, mp.tanh(100)) * (1 - mp.mpf(10) ** 6 / one)


@pytest.mark.parametrize(("p", "q"), [(1, 10**12), (1, 3), (50, 1), (199, 2), (100, 1), (100, 3), (201, 2), (10**9, 1)])
def test_tanh_is_bounded_from_below_where_it_is_almost_1(p: int, q: int) -> None:
    a, b = kernel.tanh_below(p, q, kernel.FINE)
    with mp.workdps(400):
        assert mp.mpf(a) / b <= mp.tanh(mp.mpf(p) / q)


@pytest.mark.parametrize("digits", [3, 15, 40, 59])
def test_a_torque_bound_equal_to_the_limit_is_accepted_and_one_above_it_refused(digits: int) -> None:
    assert check(single("6")).valid
    assert check(single("6." + "0" * digits + "1")).valid
    assert "(16*): vehicle 1: 6 exceeds " in reason(single("5." + "9" * digits))
    assert "stated margin" in reason(single("6", margins={"(16*)": "0." + "0" * digits + "1"}))


def test_a_strict_condition_refuses_equality() -> None:
    sides = (4, 1, 3, 1)
    assert kernel.holds(sides, 0)
    assert not kernel.holds(sides, 0, strict=True)
    assert kernel.holds((4, 1, 4, 1), 1, strict=True)  # a margin leaves room
    assert kernel.holds((4, 1, 4, 1), 0, strict=True)


@settings(deadline=None)
@given(st.integers(1, 10**40), st.integers(0, 30))
def test_roots_are_compared_exactly(square: int, shift: int) -> None:
    root = math.isqrt(square)
    assert kernel.holds((square, shift, root + shift, 1), 0) == (root * root == square)
    assert kernel.holds((square, shift, root + shift + 1, 1), 0)
    assert not kernel.holds((square, shift, root + shift - 1, 1), 0)


def test_a_negative_room_is_not_squared_away() -> None:
    assert not kernel.holds((1, 5, 3, 1), 0)
    assert not kernel.holds((1, 0, 2, 1), 9)  # a margin so large that its square is large
    assert kernel.holds((0, 1, 1, 1), 0)
    assert not kernel.holds((0, 2, 1, 1), 0)


def test_a_margin_is_accepted_up_to_the_room_there_is() -> None:
    sides = (4, 1, 9, 1)  # 2 + 1 <= 9, 6 to spare
    assert [kernel.holds(sides, margin) for margin in (0, 3, 6, 7, 8, 10, 14)] == [True] * 3 + [False] * 4
    assert "(16*): margin: all must be >= 0" in reason(single("6", margins={"(16*)": "-0.001"}))


@pytest.mark.parametrize(
    ("sides", "margin", "words"),
    [
        ((4, 1, 2, 1), 0, "3 exceeds 2 by 1"),
        ((4, 1, 3, 1), 0, "3 exceeds 3 by 0"),
        ((2 * 10**40, 0, 10**20, 10**20), 0, "1.41421356237 exceeds 1 by 0.414213562373"),
        ((4, 1, 9, 2), 4, "the stated margin 4 is more than 3"),
        ((4, 1, 3, 1), 2, "the stated margin 2 is more than 0"),
        ((4, 1, 2, 1), 2, "3 exceeds 2 by 1"),
    ],
)
def test_what_fails_is_said_with_both_sides(sides: kernel.Sides, margin: int, words: str) -> None:
    with pytest.raises(kernel.FalseError) as caught:
        kernel.explain(1, "here", sides, margin)
    assert str(caught.value) == f"here: {words}"


MODELS = {
    "(15)": conditions.condition_15,
    "(15')": conditions.condition_15_prime,
    "(16)": conditions.condition_16,
    "(16*)": conditions.condition_16_star,
    "speed": conditions.speed_condition,
    "turn_rate": conditions.turn_rate_condition,
    "acceleration": conditions.acceleration_condition,
    "turn_acceleration": conditions.turn_acceleration_condition,
}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("condition", MODELS)
def test_its_conditions_are_those_of_the_models(name: str, condition: str) -> None:
    """Both sides of every condition, for every vehicle, also of limits that the fleet does not ask for."""
    case = CASES[name]()
    data = case.fleet.condition_data(case.psi)
    claims = kernel.read_claims(document(name))
    numbers = conditions.exact_numbers()
    limit = np.full(len(case.fleet), Fraction(3, 4), dtype=object)
    kinds = dict.fromkeys(("speed", "turn_rate", "acceleration", "turn_acceleration"), limit)
    asked = conditions.ConditionData(**{**vars(data), **kinds})
    model = MODELS[condition](numbers, asked, case.gains)
    for i, vehicle in enumerate(claims.vehicles(range(len(case.fleet)))):
        square, rest, large, per_margin = kernel.CONDITIONS[condition](
            claims, vehicle, claims.unit * 3 // 4, kernel.FINE
        )
        scale = per_margin * claims.unit
        assert float(Fraction(math.isqrt(square) + rest, scale)) == pytest.approx(float(model.small[i]), rel=1e-12)
        assert float(Fraction(large, scale)) == pytest.approx(float(model.large[i]), rel=1e-12)
    assert (condition in kernel.STRICT) == model.strict


def test_every_condition_is_tried_with_a_coarse_and_a_fine_tanh() -> None:
    """A limit that is met within 1e-30 is decided by the fine one, and one that is broken by as little is refused."""
    with mp.workdps(60):
        least = mp.tanh(mp.mpf(1) / 2)  # d_v tanh(1 / 2) >= sqrt2
        d_v = mp.sqrt(2) / least
        above = mp.nstr(mp.ceil(d_v * mp.mpf(10) ** 40) / mp.mpf(10) ** 40, 45, strip_zeros=False)
        below = mp.nstr(mp.floor(d_v * mp.mpf(10) ** 40) / mp.mpf(10) ** 40, 45, strip_zeros=False)
    for text, valid in ((above, True), (below, False)):
        content = with_limit(single(), "speed", "0.5")
        content["gains"]["d_v"] = str(text)
        assert check(content).valid == valid


def test_few_conditions_may_be_so_close_that_they_take_the_fine_tanh(monkeypatch: pytest.MonkeyPatch) -> None:
    """A stated margin that leaves less than the coarse tanh decides: 9 tanh 1 - sqrt2 = 5.44013384122878894..."""
    for margin, close in (("5.4401338412287889", True), ("5.440133841", False)):
        content = with_limit(single(), "speed", "1", margin)
        content["gains"]["d_v"] = "9"
        monkeypatch.setattr(kernel, "MAX_CLOSE", 1)
        assert check(content).valid
        monkeypatch.setattr(kernel, "MAX_CLOSE", 0)
        if close:
            words = "more than 0 conditions hold by less than 1e-14: state smaller margins"
            assert refusal(content) == words
        else:
            assert check(content).valid
    assert "(16*): vehicle 1: 6 exceeds 5 by 1" in reason(single("5"))  # what is false is said to be false


SCALED = {"speed": ("speed_scale", "d_v", "3"), "turn_rate": ("turn_rate_scale", "d_omega", "5")}


@pytest.mark.parametrize("name", SCALED)
def test_a_limit_is_divided_by_its_scale(name: str) -> None:
    """tanh(limit / scale): twice both is the same."""
    scale, gain, enough = SCALED[name]
    results = []
    for limit, width in (("0.5", "1"), ("1", "2"), ("0.5", "2")):
        content = with_limit(single(), name, limit)
        content["gains"] |= {scale: width, gain: enough}
        results.append(check(content).valid)
    assert results == [False, False, False]
    for limit, width in (("1", "1"), ("2", "2")):
        content = with_limit(single(), name, limit)
        content["gains"] |= {scale: width, gain: enough}
        assert check(content).valid


LIMITS = {  # of the single vehicle: its bound, and a gain that keeps every other condition
    "acceleration": "2.41421356238",  # d_v + sqrt2
    "turn_acceleration": "4.41421356238",  # d_omega + 2 + sqrt2
}


@pytest.mark.parametrize("name", LIMITS)
def test_an_acceleration_is_bounded_by_force_over_mass(name: str) -> None:
    just = LIMITS[name]
    assert check(with_limit(single(), name, just)).valid
    less = just[:-1] + "7"
    assert f"{name}: vehicle 1" in reason(with_limit(single(), name, less))
    key = "mass" if name == "acceleration" else "inertia"
    heavy = with_limit(single(), name, less)
    heavy["fleet"][key] = "1.01"
    assert check(heavy).valid
    wheels = with_limit(single(), name, less)
    wheels["fleet"]["wheel_inertia"] = "0.01"
    assert check(wheels).valid
    uncertain = with_limit(single(), name, just)
    uncertain["fleet"][key] = ["0.99", "1.01"]
    assert f"{name}: vehicle 1" in reason(uncertain)
    radii = with_limit(single(), name, just)
    radii["fleet"]["wheel_radius"] = ["1.99", "2.00"]
    assert f"{name}: vehicle 1" in reason(radii)


def wheel_document(limit: str, rim: str, margin: str = "0") -> Document:
    """p_v = 1, d_v = 3, p_omega = 1, k psi_bar = 1, d_omega = 5: atanh(sqrt2 / 3) = 0.5118, atanh((1 + sqrt2) / 5)."""
    content = with_limit(single(), "wheel_speed", limit, margin)
    content["gains"] |= {"d_v": "3", "p_omega": "1", "d_omega": "5"}
    return {**content, "rim_speed": rim}


def test_a_wheel_speed_is_shared_between_v_and_omega() -> None:
    """V + arm Omega = r W: V must suffice for v, and what is left for omega."""
    with mp.workdps(30):
        V, Omega = mp.atanh(mp.sqrt(2) / 3), mp.atanh((1 + mp.sqrt(2)) / 5)
        W = (V + Omega) / 2
    fits, less = mp.nstr(W + mp.mpf("1e-9"), 10), mp.nstr(W - mp.mpf("1e-9"), 10)
    enough, little = mp.nstr(V + mp.mpf("1e-10"), 11), mp.nstr(V - mp.mpf("1e-9"), 10)
    assert check(wheel_document(fits, enough)).valid
    for limit, rim in ((less, enough), (fits, little), (fits, mp.nstr(V + mp.mpf("1e-7"), 10)), (fits, "9")):
        assert "wheel_speed: vehicle 1: " in reason(wheel_document(limit, rim))
    more = mp.nstr(W + 1, 10)
    assert check(wheel_document(more, enough, "1.99")).valid
    assert "wheel_speed: vehicle 1: " in reason(wheel_document(more, enough, "2.01"))
    slow = wheel_document(fits, enough)
    slow["fleet"]["wheel_radius"] = ["1.9", "2.0"]
    assert "wheel_speed: vehicle 1: " in reason(slow)
    long = wheel_document(fits, enough)
    long["fleet"]["half_track"] = ["1.0", "1.1"]
    assert "wheel_speed: vehicle 1: " in reason(long)


@pytest.mark.parametrize(
    ("limit", "d_v", "d_omega", "valid"),
    [("2", "2", "6", True), ("2", "1", "6", False), ("2", "2", "5", False), ("1", "2", "6", False)],
)
def test_a_wheel_speed_leaves_integers_to_both(limit: str, d_v: str, d_omega: str, valid: bool) -> None:
    """V = arm Omega = 1, the least numbers there are: sqrt2 <= d_v tanh 1 and 1 + 2 sqrt2 <= d_omega tanh 1."""
    content = {**wheel_document(limit, "1"), "psi_bar": "2"}
    content["fleet"] |= {"wheel_radius": "1", "excitation": harmonics("1")}
    content["gains"] |= {"d_v": d_v, "d_omega": d_omega}
    assert kernel.read_claims(content).unit == 1
    verdict = check(content)
    assert verdict.valid == valid and (valid or verdict.reason.startswith("wheel_speed: vehicle 1: ")), verdict


def test_a_wheel_speed_needs_its_rim_speed() -> None:
    assert "rim_speed: expected a string of 1 decimals" in refusal(wheel_document("1", ""))
    assert "rim_speed: expected a string of 0 decimals" in refusal(single(rim_speed="1"))


@pytest.mark.parametrize("conditions_name", kernel.SETS)
def test_each_set_requires_its_own_conditions(conditions_name: str) -> None:
    required = {"paper": ["(15)", "(16)"], "corrected": ["(16*)"], "rate-bounded": ["(15')", "(16*)"]}[conditions_name]
    content = single(conditions=conditions_name, margins=dict.fromkeys(required, "0"))
    content["gains"]["d_omega"] = "5"
    assert check(content).valid
    for name in required:
        content["margins"].pop(name)
        assert f"expected a table with the keys {', '.join(required)}" in refusal(content)
        content["margins"][name] = "0"


@pytest.mark.parametrize("name", kernel.LIMITS)
def test_a_limit_asks_for_a_margin(name: str) -> None:
    content = with_limit(single(), name, "50")
    content["gains"] |= {"d_v": "3", "d_omega": "9"}
    content["rim_speed"] = "1" if name == "wheel_speed" else ""
    assert check(content).valid
    content["margins"].pop(name)
    assert f"expected a table with the keys (16*), {name}" in refusal(content)
    content["margins"][name] = "0 0"
    assert f"{name}: margin: expected a string of 1 decimals" in refusal(content)
    content["margins"][name] = "-1"
    assert f"{name}: margin: all must be >= 0" in reason(content)


WORST: list[tuple[str, Any]] = [
    ("wheel_radius", ["1", "2"]),
    ("half_track", ["1", "3"]),
    ("torque_left", ["6", "9"]),
    ("torque_right", ["6", "9"]),
]


@pytest.mark.parametrize(("name", "ends"), WORST)
def test_a_vehicle_counts_with_its_worst_values(name: str, ends: list[str]) -> None:
    """The largest r, the smallest R and torque limit leave (16*) at equality; a worse end breaks it."""
    content = single("6")
    content["fleet"][name] = ends
    assert check(content).valid
    worse = {"wheel_radius": ["1.0", "2.1"], "half_track": ["0.9", "3.0"]}.get(name, ["5.9", "9.0"])
    content["fleet"][name] = worse
    assert "(16*): vehicle 1" in reason(content)


@pytest.mark.parametrize(("drive", "arm"), [("paper", 2), ("physical", 1)])
def test_the_arm_is_that_of_the_drive(drive: str, arm: int) -> None:
    content = single()
    content["fleet"]["drive"] = drive
    claims = kernel.read_claims(content)
    (vehicle,) = claims.vehicles([0])
    assert vehicle.arm_low == vehicle.arm_high == arm * claims.unit


def test_limits_concern_the_vehicles_that_ask_for_them() -> None:
    content = document("mixed_ring")
    assert content["fleet"]["limits"]["speed"]["vehicle"] == "0 3 4 6 9"
    gains = [Fraction(text) for text in content["gains"]["p_v"].split()]
    for vehicle, condition in ((0, "speed: vehicle 1"), (1, "(16*): vehicle 2")):
        louder = [gain * 3 if i == vehicle else gain for i, gain in enumerate(gains)]
        changed = {**content, "gains": {**content["gains"], "p_v": column(*map(float, louder))}}
        changed["margins"] = {name: " ".join("0" * (text.count(" ") + 1)) for name, text in content["margins"].items()}
        assert condition in reason(changed) or "(16*): vehicle" in reason(changed)
