"""The kernel against two other judges on fleets at the edge of a condition. Also tests that the comparison can fail."""

from __future__ import annotations

from collections.abc import Callable
from decimal import ROUND_FLOOR, Context, Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from gaincert.models import conditions
from gaincert.models.paper import paper_excitation, paper_fleet, paper_gains
from gaincert.verify import kernel

from tests.campaigns import soundness

Patch = pytest.MonkeyPatch


def test_two_hundred_fleets_are_judged_alike(capsys: pytest.CaptureFixture[str]) -> None:
    assert soundness.main(["200"]) == 0
    printed = capsys.readouterr().out
    assert all(f"| {condition} |" in printed for condition in soundness.CONDITIONS)
    assert "0 failures" in printed and ": 0 verdicts of the kernel change" in printed


def test_the_theory_gives_the_left_sides_of_16_for_the_papers_fleet() -> None:
    """653.27, ... against 1320, ...; (15) asks for d_omega >= 27.0997 and 58.7161."""
    numbers, gains = paper_fleet().condition_data(paper_excitation()), paper_gains()
    columns = [numbers.degree, [numbers.psi_bar] * 6, numbers.r, numbers.arm, numbers.torque, [1] * 6, [1] * 6]
    columns += [getattr(gains, name) for name in soundness.GAIN_NAMES]
    rows = [soundness.Row(*map(float, entries)) for entries in zip(*columns, strict=True)]
    whole = np.array([soundness.sides(soundness.math, "(16)", row) for row in rows])
    assert whole[:, 0] == pytest.approx([653.27, 1302.15, 753.11, 1489.10, 503.52, 503.52], abs=0.005)
    assert whole[:, 1] == pytest.approx([1320, 1320, 1493.33, 1493.33, 504, 504], abs=0.005)
    damping = [soundness.sides(soundness.math, "(15)", row) for row in rows[:2]]
    needed = [small / large * row.d_omega for (small, large), row in zip(damping, rows[:2], strict=True)]
    assert needed == pytest.approx([27.0997, 58.7161], abs=5e-5)


def test_fleets_lie_on_both_sides_of_every_edge_and_on_it() -> None:
    trials = [soundness.draw(seed, condition) for condition in ("(16*)", "psi_bar") for seed in range(30)]
    outcomes = [soundness.judged(trial) for trial in trials]
    assert {outcome.truth for outcome in outcomes} == {True, False}
    assert {outcome.trial.condition for outcome in outcomes if outcome.trial.on_the_edge} == {"(16*)", "psi_bar"}
    on_torque = [one for one in outcomes if one.trial.on_the_edge and one.trial.condition == "(16*)"]
    assert all(one.verdict.valid and one.limits for one in on_torque)


# -- a weaker kernel is found out -------------------------------------------------------------------------------------


def changed_condition(condition: str, change: Callable[..., Any]) -> Callable[[Patch], None]:
    """The kernel with (vehicle, psi_bar) or the sides of a condition changed."""

    def apply(patch: Patch) -> None:
        rule = kernel.CONDITIONS[condition]
        patch.setitem(kernel.CONDITIONS, condition, lambda vehicle, psi_bar: change(rule, vehicle, psi_bar))

    return apply


def without_sqrt2(rule: Any, vehicle: Any, psi_bar: Fraction) -> Any:
    sides = rule(vehicle, psi_bar)
    return sides._replace(square=sides.square / 2)


def rounded_down(rule: Any, vehicle: Any, psi_bar: Fraction) -> Any:
    decimal = Context(prec=3, rounding=ROUND_FLOOR).divide(Decimal(psi_bar.numerator), Decimal(psi_bar.denominator))
    return rule(vehicle, Fraction(decimal))


def with_tolerance(rule: Any, vehicle: Any, psi_bar: Fraction) -> Any:
    sides = rule(vehicle, psi_bar)
    return sides._replace(large=sides.large * (1 + Fraction(1, 10**14)))


def without_heading(rule: Any, vehicle: Any, psi_bar: Fraction) -> Any:
    return rule(vehicle._replace(p_omega=Fraction(0)), psi_bar)


def tanh_rounded_up(patch: Patch) -> None:
    below = kernel.tanh_below
    patch.setattr(kernel, "tanh_below", lambda q: below(q) + Fraction(1, 10**16))


def psi_not_bounded(patch: Patch) -> None:
    patch.setattr(kernel, "psi_bounded", lambda _: None)


def margins_ignored(patch: Patch) -> None:
    holds = kernel.holds_with_margin
    patch.setattr(kernel, "holds_with_margin", lambda where, sides, _: holds(where, sides, Fraction(0)))


def nominal_radius(patch: Patch) -> None:
    read = kernel.read_vehicle

    def with_middle(row: Any, *rest: Any) -> Any:
        radius = row["wheel_radius"]
        least, most = map(Fraction, radius if isinstance(radius, list) else [radius, radius])
        return read(row, *rest)._replace(r=(least + most) / 2)

    patch.setattr(kernel, "read_vehicle", with_middle)


WEAKER = {
    "(16*) without sqrt2": ("(16*)", changed_condition("(16*)", without_sqrt2)),
    "(16) without sqrt2": ("(16)", changed_condition("(16)", without_sqrt2)),
    "(15) with psi_bar rounded down": ("(15)", changed_condition("(15)", rounded_down)),
    "(15') without p_omega D": ("(15')", changed_condition("(15')", without_heading)),
    "(16*) with a tolerance": ("(16*)", changed_condition("(16*)", with_tolerance)),
    "tanh rounded up": ("speed limit", tanh_rounded_up),
    "psi_bar taken on trust": ("psi_bar", psi_not_bounded),
    "margins not checked": ("turn rate limit", margins_ignored),
    "the nominal wheel radius": ("(16)", nominal_radius),
}


@pytest.mark.parametrize("fault", WEAKER)
def test_a_weaker_kernel_is_found_to_accept_what_is_false(fault: str, monkeypatch: Patch) -> None:
    condition, apply = WEAKER[fault]
    apply(monkeypatch)
    tally = soundness.run(30, condition=condition, scale_every=0)
    assert tally.falsely_accepted > 0
    assert any("accepts what is false" in line for line in tally.failures)


def test_a_kernel_that_refuses_too_much_is_found(monkeypatch: Patch) -> None:
    holds = kernel.holds_with_margin

    def strict(where: str, sides: Any, margin: Fraction) -> None:
        holds(where, sides._replace(large=sides.large * (1 - Fraction(1, 10**9))), margin)

    monkeypatch.setattr(kernel, "holds_with_margin", strict)
    tally = soundness.run(30, condition="(16*)", scale_every=0)
    assert tally.falsely_accepted == 0
    assert any("refuses what is true" in line for line in tally.failures)


def test_rounding_in_limits_py_is_found(monkeypatch: Patch) -> None:
    exact = conditions.exact_numbers()
    loose = conditions.Numbers(lambda *parts: exact.sqrt2_norm(*parts) * (1 - Fraction(1, 10**13)), exact.tanh)
    monkeypatch.setattr(soundness, "exact_numbers", lambda: loose)
    tally = soundness.run(30, condition="(15')", scale_every=0)
    assert any("limits.py says True" in line for line in tally.failures)
    assert soundness.main(["40"]) == 1


def test_a_verdict_that_depends_on_the_units_is_found(monkeypatch: Patch) -> None:
    holds = kernel.holds_with_margin

    def with_absolute_tolerance(where: str, sides: Any, margin: Fraction) -> None:
        holds(where, sides._replace(large=sides.large + Fraction(1, 10**6)), margin)

    monkeypatch.setattr(kernel, "holds_with_margin", with_absolute_tolerance)
    tally = soundness.run(20, condition="(16*)", scale_every=2)
    assert any("changes the verdict of the kernel" in line for line in tally.failures)
