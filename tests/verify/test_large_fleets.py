"""Certificates of large fleets: floats where they suffice, fractions where it is close; size and time."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from gaincert.models.conditions import condition_16_star, condition_set, exact_numbers
from gaincert.verify import kernel
from gaincert.verify.certificates import margins as margins_module
from gaincert.verify.certificates.certify import certify

from tests.campaigns.certified_fleets import CASES


def test_numbers_stay_short_as_fleets_grow() -> None:
    from benchmarks.certificate_scale import large_fleet, scaled_gains

    places = []
    for n in (100, 2000):
        fleet = large_fleet(n)
        assert fleet.psi
        certificate = certify(fleet, fleet.psi, scaled_gains(fleet), "corrected")
        assert certificate.valid and all(certificate.rates.values())
        places.append(kernel.places_of({**certificate.content, "provenance": ""}))
    assert places[1] <= places[0] + 1 <= 13


@pytest.mark.parametrize("conditions", ["paper", "rate-bounded"])
def test_floats_and_fractions_state_the_same_margins(conditions: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is close in floats is decided in fractions, in a large fleet too; the rest is a little more cautious."""
    case = CASES["mixed_ring"]()
    exact = certify(case.fleet, case.psi, case.gains, conditions)
    monkeypatch.setattr(margins_module, "EXACT_UP_TO", 0)
    floats = certify(case.fleet, case.psi, case.gains, conditions)
    assert exact.valid == floats.valid
    assert [str(a) for a in exact.violations] == [str(a) for a in floats.violations]
    data = case.fleet.condition_data(case.psi)
    for sides in condition_set(conditions).inequalities(exact_numbers(), data, case.gains):
        if sides.source not in exact.margins:  # a limit that no vehicle asks for
            continue
        stated = exact.margins[sides.source], floats.margins[sides.source]
        for true, one, other in zip(sides.margin, *stated, strict=True):
            assert (one is None) == (other is None)
            if one:
                assert max(one, other) <= true
                assert float(other) == pytest.approx(float(one), rel=2e-5)


def test_what_is_close_is_decided_exactly_in_a_large_fleet(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(margins_module, "EXACT_UP_TO", 0)
    case = CASES["line"]()
    data = case.fleet.condition_data(case.psi)
    room = condition_16_star(exact_numbers(), data, case.gains).margin[0] * 2 / data.r[0]
    unit = Fraction(1, 10**15)
    fits = case.gains.d_v[0] + room // unit * unit
    for d_v, valid in ((fits, True), (fits + unit, False)):
        columns = case.gains.d_v.copy()
        columns[0] = d_v
        certificate = certify(case.fleet, case.psi, replace(case.gains, d_v=columns), "corrected")
        assert certificate.valid == valid
        assert [v.vehicle for v in certificate.violations] == ([] if valid else ["r0"])


@pytest.mark.slow
def test_a_hundred_thousand_vehicles_are_certified_and_verified_within_a_minute() -> None:
    from benchmarks.certificate_scale import measure

    found = measure(100_000)
    assert found["valid"]
    assert found["certify_s"] + found["write_s"] + found["verify_s"] < 60
    assert max(found["certify_GB"], found["verify_GB"]) < 4
