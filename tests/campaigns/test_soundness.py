"""The kernel against two other judges on fleets at the edge of a condition. Also tests that the comparison can fail."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from gaincert.models import conditions
from gaincert.models.gains import GAIN_NAMES
from gaincert.models.paper import paper_excitation, paper_fleet, paper_gains
from gaincert.verify import kernel

from tests.campaigns import soundness, soundness_theory

Patch = pytest.MonkeyPatch
Sides = kernel.Sides


def test_two_hundred_fleets_are_judged_alike(capsys: pytest.CaptureFixture[str]) -> None:
    assert soundness.main(["200"]) == 0
    printed = capsys.readouterr().out
    assert all(f"| {condition} |" in printed for condition in soundness.CONDITIONS)
    assert "0 failures" in printed and ": 0 verdicts of the kernel change" in printed


def test_the_theory_gives_the_left_sides_of_16_for_the_papers_fleet() -> None:
    """653.27, ... against 1320, ...; (15) asks for d_omega >= 27.0997 and 58.7161."""
    numbers, gains = paper_fleet().condition_data(paper_excitation()), paper_gains()
    rows = [
        soundness_theory.Row(
            *(float(q[i]) for q in (numbers.degree, [numbers.psi_bar] * 6, numbers.r, numbers.arm, numbers.torque)),
            *[None] * 5,
            *[1.0] * 6,
            *(float(getattr(gains, name)[i]) for name in GAIN_NAMES),
        )
        for i in range(6)
    ]
    whole = np.array([soundness_theory.sides(math, "(16)", row) for row in rows])
    assert whole[:, 0] == pytest.approx([653.27, 1302.15, 753.11, 1489.10, 503.52, 503.52], abs=0.005)
    assert whole[:, 1] == pytest.approx([1320, 1320, 1493.33, 1493.33, 504, 504], abs=0.005)
    damping = [soundness_theory.sides(math, "(15)", row) for row in rows[:2]]
    needed = [small / large * row.d_omega for (small, large), row in zip(damping, rows[:2], strict=True)]
    assert needed == pytest.approx([27.0997, 58.7161], abs=5e-5)


def test_fleets_lie_on_both_sides_of_every_edge_and_on_it() -> None:
    trials = [soundness.draw(seed, condition) for condition in ("(16*)", "psi_bar") for seed in range(60)]
    outcomes = [soundness.judged(trial) for trial in trials]
    assert {outcome.truth for outcome in outcomes} == {True, False}
    assert {outcome.trial.condition for outcome in outcomes if outcome.trial.on_the_edge} == {"(16*)", "psi_bar"}
    on_torque = [one for one in outcomes if one.trial.on_the_edge and one.trial.condition == "(16*)"]
    assert all(one.verdict.valid and one.models for one in on_torque)


# -- a weaker kernel is found out -------------------------------------------------------------------------------------


def changed_condition(condition: str, change: Callable[[Sides], Sides]) -> Callable[[Patch], None]:
    """The kernel with the sides of a condition changed."""

    def apply(patch: Patch) -> None:
        rule = kernel.CONDITIONS[condition]
        patch.setitem(kernel.CONDITIONS, condition, lambda *args: change(rule(*args)))

    return apply


def with_changed_vehicles(condition: str, **changes: Callable[[Any], int]) -> Callable[[Patch], None]:
    """The kernel with some numbers of a vehicle changed in a condition."""

    def apply(patch: Patch) -> None:
        rule = kernel.CONDITIONS[condition]

        def changed(claims: Any, vehicle: Any, *rest: Any) -> Sides:
            other = vehicle._replace(**{name: change(vehicle) for name, change in changes.items()})
            return rule(claims, other, *rest)

        patch.setitem(kernel.CONDITIONS, condition, changed)

    return apply


def without_sqrt2(sides: Sides) -> Sides:
    return (sides[0] // 2, *sides[1:])


def with_tolerance(sides: Sides) -> Sides:
    square, rest, large, per_margin = sides
    return square, rest, large + large // 10**14, per_margin


def psi_bar_rounded_down(patch: Patch) -> None:
    rule = kernel.CONDITIONS["(15)"]

    def rounded(claims: kernel.Claims, *rest: Any) -> Sides:
        unit = 10 ** max(0, len(str(claims.psi_bar)) - 3)
        return rule(claims._replace(psi_bar=claims.psi_bar // unit * unit), *rest)

    patch.setitem(kernel.CONDITIONS, "(15)", rounded)


def tanh_rounded_up(patch: Patch) -> None:
    below = kernel.tanh_below

    def above(p: int, q: int, one: int) -> tuple[int, int]:
        a, b = below(p, q, one)
        return a * 10**14 + b, b * 10**14

    patch.setattr(kernel, "tanh_below", above)


def psi_not_bounded(patch: Patch) -> None:
    patch.setattr(kernel, "psi_bounded", lambda _: None)


def margins_ignored(patch: Patch) -> None:
    holds = kernel.holds
    patch.setattr(kernel, "holds", lambda sides, _, *strict: holds(sides, 0, *strict))


def wheels_taken_on_trust(patch: Patch) -> None:
    patch.setitem(kernel.CONDITIONS, "wheel_speed", lambda *_: (0, 0, 1, 1))


WEAKER = {
    "(16*) without sqrt2": ("(16*)", changed_condition("(16*)", without_sqrt2)),
    "(16) without sqrt2": ("(16)", changed_condition("(16)", without_sqrt2)),
    "(15) with psi_bar rounded down": ("(15)", psi_bar_rounded_down),
    "(15') without p_omega D": ("(15')", with_changed_vehicles("(15')", p_omega=lambda _: 0)),
    "(16*) with a tolerance": ("(16*)", changed_condition("(16*)", with_tolerance)),
    "tanh rounded up": ("speed", tanh_rounded_up),
    "psi_bar taken on trust": ("psi_bar", psi_not_bounded),
    "margins not checked": ("turn_rate", margins_ignored),
    "wheel speeds taken on trust": ("wheel_speed", wheels_taken_on_trust),
    "the smallest wheel radius": ("(16)", with_changed_vehicles("(16)", r_high=lambda v: v.r_low)),
    "the largest mass": ("acceleration", with_changed_vehicles("acceleration", mass_low=lambda v: v.mass_high)),
    "the inertia without mismatch": (
        "turn_acceleration",
        with_changed_vehicles("turn_acceleration", r_high=lambda v: v.r_low, arm_high=lambda v: v.arm_low),
    ),
    "a unit scale": ("speed", with_changed_vehicles("speed", speed_scale=lambda v: v.speed_scale // 2 + 1)),
}


@pytest.mark.parametrize("fault", WEAKER)
def test_a_weaker_kernel_is_found_to_accept_what_is_false(fault: str, monkeypatch: Patch) -> None:
    condition, apply = WEAKER[fault]
    apply(monkeypatch)
    tally = soundness.run(40, condition=condition, scale_every=0)
    assert tally.falsely_accepted > 0
    assert any("accepts what is false" in line for line in tally.failures)


def test_a_kernel_that_refuses_too_much_is_found(monkeypatch: Patch) -> None:
    changed_condition("(16*)", lambda s: (s[0], s[1], s[2] - s[2] // 10**9, s[3]))(monkeypatch)
    tally = soundness.run(30, condition="(16*)", scale_every=0)
    assert tally.falsely_accepted == 0
    assert any("refuses what is true" in line for line in tally.failures)


def test_rounding_in_the_models_is_found(monkeypatch: Patch) -> None:
    exact = conditions.exact_numbers()
    loose = replace(exact, sqrt2_norm=lambda *parts: exact.sqrt2_norm(*parts) * (1 - Fraction(1, 10**13)))
    monkeypatch.setattr(soundness, "exact_numbers", lambda: loose)
    tally = soundness.run(30, condition="(15')", scale_every=0)
    assert any("the models say True" in line for line in tally.failures)
    assert soundness.main(["40"]) == 1


def test_a_verdict_that_depends_on_the_units_is_found(monkeypatch: Patch) -> None:
    rule = kernel.CONDITIONS["(16*)"]

    def with_absolute_tolerance(claims: kernel.Claims, *rest: Any) -> Sides:
        square, rest_of_small, large, per_margin = rule(claims, *rest)
        return square, rest_of_small, large + per_margin * claims.unit // 10**6, per_margin

    monkeypatch.setitem(kernel.CONDITIONS, "(16*)", with_absolute_tolerance)
    tally = soundness.run(20, condition="(16*)", scale_every=2)
    assert any("changes the verdict of the kernel" in line for line in tally.failures)
