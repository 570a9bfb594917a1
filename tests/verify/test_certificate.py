"""Certificates: what they claim for which gains, and how they are written and read."""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gaincert.models.arrays import column
from gaincert.models.errors import FaultError, InputError
from gaincert.models.excitation import Excitation
from gaincert.models.gains import GAIN_NAMES
from gaincert.models.paper import paper_excitation, paper_fleet, paper_gains
from gaincert.verify.certificates import certify as module
from gaincert.verify.certificates.certificate import Certificate, verify
from gaincert.verify.certificates.certify import certify
from gaincert.verify.certificates.remarks import broken_cuts

from tests.campaigns.certified_fleets import CASES


def paper(conditions: str, **changed: Any) -> Certificate:
    columns = {name: column(map(Fraction, values)) for name, values in changed.items()}
    return certify(paper_fleet(), paper_excitation(), replace(paper_gains(), **columns), conditions)


# -- the paper's own gains --------------------------------------------------------------------------------------------


def test_the_papers_gains_are_certified_under_its_own_conditions() -> None:
    certificate = paper("paper")
    assert certificate.valid and not certificate.violations
    notes = " ".join(certificate.notes)
    assert "nothing is claimed of the turn rates of v2, v4: a bound of |omega| needs (15')" in notes
    assert "all 63 sets S of vehicles, and 10 of them meet it" in notes
    # The left sides of (16) on the paper's data: 653.27 against 1320, ..., 503.52 against 504.
    margins = certificate.margins["(16)"].astype(float)
    assert margins == pytest.approx([666.73, 17.85, 740.22, 4.23, 0.48, 0.48], abs=0.01)
    assert certificate.margins["(15)"].astype(float) == pytest.approx([0.6856, 0.2162] * 2 + [0.6856] * 2, abs=1e-4)


def test_the_papers_gains_are_certified_under_the_exact_torque_condition() -> None:
    assert paper("corrected").valid


def test_gains_that_break_15_tenfold_are_certified_by_the_corrected_theorem() -> None:
    d_omega = ["2.8", "5.9", "2.8", "5.9", "2.8", "2.8"]
    assert paper("corrected", d_omega=d_omega).valid
    broken = paper("paper", d_omega=d_omega)
    assert not broken.valid and len(broken.violations) == 6


def test_the_papers_gains_break_15_prime_for_two_vehicles() -> None:
    certificate = paper("rate-bounded")
    assert not certificate.valid
    assert [(v.vehicle, v.condition) for v in certificate.violations] == [("v2", "(15')"), ("v4", "(15')")]
    assert str(certificate.violations[0]).startswith(
        "vehicle 'v2': (15') is broken by 62.4178 N m (121.4178101 >= 59); lower p_omega from 5.9 to 1.0986"
    )


def test_the_rates_are_the_spectral_abscissas() -> None:
    rates = paper("paper").rates
    assert float(rates["gamma_omega"]) == pytest.approx(0.0543529142, rel=1e-4)
    assert float(rates["gamma_v"]) == pytest.approx(0.0357239954, rel=1e-4)


def test_rates_that_the_kernel_refuses_cost_nothing_else(monkeypatch: pytest.MonkeyPatch) -> None:
    """The search for them is in floats; what it overstates is left out, and the rest is certified."""
    too_fast = {"rate": "1000000", "vector": "1 1 1 1 1 1"}
    monkeypatch.setattr(module, "certified_rates", lambda *_: {"gamma_omega": None, "gamma_v": too_fast})
    certificate = paper("paper")
    assert certificate.valid
    assert certificate.content["rates"] == {"gamma_omega": None, "gamma_v": None}
    assert not any("exponent" in fact for fact in certificate.facts)


# -- files ------------------------------------------------------------------------------------------------------------


def listed(folder: Path) -> list[str]:
    return [path.name for path in folder.iterdir()]


@pytest.mark.parametrize("name", CASES)
def test_a_certificate_is_read_as_it_was_written(name: str, tmp_path: Path) -> None:
    case = CASES[name]()
    path = tmp_path / "certificate.json"
    case.certificate.write(path)
    again = Certificate.read(path, case.fleet)
    assert again.valid and again.content == case.certificate.content and again.facts == case.certificate.facts
    assert again.file_digest == "sha256:" + hashlib.sha256(path.read_bytes()).hexdigest()
    assert all(np.array_equal(getattr(again.gains, gain), getattr(case.gains, gain)) for gain in GAIN_NAMES)
    assert verify(path, case.fleet).valid
    assert listed(tmp_path) == ["certificate.json"]


def test_a_certificate_of_one_fleet_is_refused_for_another(tmp_path: Path) -> None:
    path = tmp_path / "certificate.json"
    CASES["line"]().certificate.write(path)
    other = verify(path, CASES["mixed_ring"]().fleet)
    assert not other.valid and other.rule == "same_fleet" and "not of the fleet" in other.reason


def test_a_certificate_that_is_not_valid_is_not_written(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="vehicle 'v2'"):
        paper("rate-bounded").write(tmp_path / "certificate.json")
    assert listed(tmp_path) == []


def test_a_file_is_written_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "certificate.json"
    path.write_text("old")
    monkeypatch.setattr(Path, "replace", lambda *_: (_ for _ in ()).throw(OSError(28, "No space left on device")))
    with pytest.raises(FaultError, match="No space left"):
        CASES["line"]().certificate.write(path)
    assert path.read_text() == "old" and listed(tmp_path) == ["certificate.json"]


def test_a_false_file_is_read_with_the_reason(tmp_path: Path) -> None:
    path = tmp_path / "certificate.json"
    path.write_text(json.dumps({**CASES["paper"]().certificate.content, "psi_bar": "0.1"}))
    found = Certificate.read(path)
    assert not found.valid and found.verdict.rule == "psi_bounded" and found.facts == ()
    with pytest.raises(InputError, match="psi_bounded"):
        found.write(tmp_path / "again.json")


def test_an_unreadable_file_is_an_input_error(tmp_path: Path) -> None:
    path = tmp_path / "certificate.json"
    path.write_text("{")
    with pytest.raises(InputError, match="not JSON"):
        verify(path)
    with pytest.raises(InputError, match="not JSON"):
        Certificate.read(path)
    with pytest.raises(InputError, match="cannot be read"):
        verify(tmp_path / "absent.json")


@pytest.mark.parametrize("value", [Fraction(1, 3), Fraction(0), Fraction(-1), Fraction(1, 10**200)])
def test_gains_that_no_certificate_can_state_are_input_errors(value: Fraction) -> None:
    gains = paper_gains()
    gains.d_v[2] = value
    with pytest.raises(InputError, match="gains: vehicle 'v3': d_v = "):
        certify(paper_fleet(), paper_excitation(), gains, "paper")


def test_a_psi_that_no_fleet_file_can_give_is_an_input_error() -> None:
    with pytest.raises(InputError, match="coefficients have a factor 1/pi"):
        certify(paper_fleet(), paper_excitation().derivative(), paper_gains(), "corrected")
    third = Excitation(Fraction(0), Fraction(1), (Fraction(1, 3),))
    with pytest.raises(InputError, match="denominator 3 is no decimal number"):
        certify(paper_fleet(), third, paper_gains(), "corrected")


def test_too_few_gains_are_an_input_error() -> None:
    gains = paper_gains()
    with pytest.raises(InputError, match="one per vehicle"):
        certify(paper_fleet(), paper_excitation(), replace(gains, d_v=gains.d_v[:5]), "paper")


def test_cuts_are_counted_exactly() -> None:
    graph = paper_fleet().graph
    assert broken_cuts(graph, column([Fraction(0)] * 6)) == (0, 63)
    assert broken_cuts(graph, column([Fraction(10**6)] * 6)) == (63, 63)
