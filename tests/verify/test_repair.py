"""Gains that are not certified: which condition is broken, by how much, and the smallest repair."""

from __future__ import annotations

from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from typing import Any

import pytest
from gaincert.models.arrays import column
from gaincert.models.conditions import condition_16_star, exact_numbers
from gaincert.models.gains import GAIN_NAMES, Gains
from gaincert.models.paper import paper_excitation, paper_fleet, paper_gains
from gaincert.verify import kernel
from gaincert.verify.certificates.certificate import Certificate
from gaincert.verify.certificates.certify import certify
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.campaigns.certified_fleets import CASES
from tests.verify.certificate_documents import check


def paper(conditions: str, **changed: Any) -> Certificate:
    columns = {name: column(map(Fraction, values)) for name, values in changed.items()}
    return certify(paper_fleet(), paper_excitation(), replace(paper_gains(), **columns), conditions)


def applied(certificate: Certificate) -> Gains:
    """The gains with the repair of every broken vehicle."""
    columns = {name: getattr(certificate.gains, name).copy() for name in GAIN_NAMES}
    for violation in certificate.violations:
        assert violation.repair
        columns[violation.repair.gain][violation.index] = violation.repair.new
    return Gains(**columns)


@pytest.mark.parametrize(
    ("conditions", "changed"),
    [
        ("paper", {"d_omega": ["27"] * 6}),
        ("paper", {"d_v": ["842"] * 6}),
        ("paper", {"d_v": ["841.5"] * 6, "k_alpha": ["3.1", "1", "3", "1", "3", "3"]}),
        ("corrected", {"p_v": ["1000"] * 6}),
        ("rate-bounded", {}),
        ("rate-bounded", {"k_alpha": ["0.00001"] * 6}),
    ],
)
def test_the_smallest_repair_makes_the_gains_valid_and_less_does_not(conditions: str, changed: dict[str, Any]) -> None:
    broken = paper(conditions, **changed)
    assert not broken.valid
    gains = applied(broken)
    assert certify(paper_fleet(), paper_excitation(), gains, conditions).valid
    for violation in broken.violations:
        repair = violation.repair
        assert repair
        columns = {name: getattr(gains, name).copy() for name in GAIN_NAMES}
        columns[repair.gain][violation.index] = repair.old + Fraction(98, 100) * (repair.new - repair.old)
        nearly = certify(paper_fleet(), paper_excitation(), Gains(**columns), conditions)
        assert violation.vehicle in {left.vehicle for left in nearly.violations}


def test_where_no_single_gain_helps_the_report_says_so() -> None:
    broken = paper("paper", d_v=["60000"] * 6, d_omega=["1"] * 6)
    assert not broken.valid
    assert "no change of one gain repairs this vehicle" in str(broken.violations[0])


def test_margins_of_1e_15_are_decided_and_repaired() -> None:
    limits = CASES["line"]().fleet.condition_data(CASES["line"]().psi)
    gains = CASES["line"]().gains
    room = condition_16_star(exact_numbers(), limits, gains).margin[0] * 2 / limits.r[0]
    unit = Fraction(1, 10**15)
    fits = gains.d_v[0] + room // unit * unit
    for d_v, valid in ((fits, True), (fits + unit, False)):
        columns = gains.d_v.copy()
        columns[0] = d_v
        certificate = certify(CASES["line"]().fleet, CASES["line"]().psi, replace(gains, d_v=columns), "corrected")
        assert certificate.valid == valid
    repair = certificate.violations[0].repair
    assert repair and repair.relative < Fraction(1, 10**12)


@settings(max_examples=30, deadline=None)
@given(st.lists(st.decimals("0.001", "2000", places=4), min_size=5, max_size=5), st.sampled_from(list(kernel.SETS)))
def test_the_kernel_and_the_diagnosis_never_disagree(values: list[Decimal], conditions: str) -> None:
    certificate = paper(conditions, **{n: [str(v)] * 6 for n, v in zip(GAIN_NAMES, values, strict=True)})
    assert certificate.valid == (not certificate.violations)
    content = {**certificate.content, "rates": {"gamma_omega": None, "gamma_v": None}}
    assert check(content).valid == certificate.valid
