"""Certificates: what they claim for which gains, repairs, intervals, files."""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gaincert.models.arrays import column
from gaincert.models.conditions import condition_16_star, exact_numbers
from gaincert.models.errors import FaultError, InputError
from gaincert.models.excitation import Excitation
from gaincert.models.files.fleet_file import parse
from gaincert.models.files.fleet_text import dumps
from gaincert.models.fleet import Fleet
from gaincert.models.fleet_tables import Links
from gaincert.models.gains import GAIN_NAMES, Gains
from gaincert.models.numbers import Interval
from gaincert.models.paper import paper_excitation, paper_fleet, paper_gains
from gaincert.models.saturation import Saturation
from gaincert.verify import kernel
from gaincert.verify.certificates import certify as module
from gaincert.verify.certificates import margins as margins_module
from gaincert.verify.certificates.certificate import Certificate, verify
from gaincert.verify.certificates.certify import certify
from gaincert.verify.certificates.remarks import broken_cuts
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.campaigns.certified_fleets import CASES, fleet_of, gains_at, vehicle
from tests.verify.certificate_documents import check


def paper(conditions: str, **changed: Any) -> Certificate:
    columns = {name: column(map(Fraction, values)) for name, values in changed.items()}
    return certify(paper_fleet(), paper_excitation(), replace(paper_gains(), **columns), conditions)


# -- the paper's own gains --------------------------------------------------------------------------------------------


def test_the_papers_gains_are_certified_under_its_own_conditions() -> None:
    certificate = paper("paper")
    assert certificate.valid and not certificate.violations
    notes = " ".join(certificate.notes)
    assert "(15') holds for 4 of 6 vehicles, not for v2, v4" in notes
    assert "53 of 63 cuts" in notes
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


# -- repairs ----------------------------------------------------------------------------------------------------------


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


# -- intervals, limits, drives, designed parts ------------------------------------------------------------------------


def test_intervals_are_certified_for_every_value_in_them() -> None:
    case = CASES["mixed_ring"]()
    assert case.certificate.valid
    assert any(isinstance(v.mass, Interval) for v in case.fleet.vehicles)
    for pick in (0, -1):
        fixed = _with_values(case.fleet, lambda interval, pick=pick: interval[pick])  # type: ignore[misc]
        assert certify(fixed, case.psi, case.gains, case.conditions).valid
    assert sum("intervals" in note for note in case.certificate.notes) == 3


def _with_values(fleet: Fleet, value: Any) -> Fleet:
    keys = ("mass", "inertia", "half_track", "wheel_radius")
    vehicles = []
    for v in fleet.vehicles:
        limit = {side: value(getattr(v.torque_limit, side)) for side in ("left", "right")} if isinstance(
            v.torque_limit.left, Interval
        ) else v.torque_limit  # fmt: skip
        chosen = {key: value(q) if isinstance(q := getattr(v, key), Interval) else q for key in keys}
        kept = {key: getattr(v, key) for key in ("name", "offset", "start", "limits")}
        vehicles.append({**kept, **chosen, "torque_limit": limit})
    kept_fleet = {key: getattr(fleet, key) for key in ("name", "drive", "leader", "excitation", "links")}
    return Fleet(vehicles=vehicles, **kept_fleet)


def test_the_worst_corner_of_the_intervals_counts() -> None:
    fleet = fleet_of([vehicle(0, half_track=["0.2", "0.4"], wheel_radius=["0.05", "0.06"])], [], {"r0": "1"})
    assert fleet.psi
    limits = fleet.condition_data(fleet.psi)
    assert limits.arm[0] == Fraction("0.2") and limits.r[0] == Fraction("0.06")
    gains = gains_at(0.9, limits)
    assert certify(fleet, fleet.psi, gains, "corrected").valid
    sides = condition_16_star(exact_numbers(), limits, gains)
    over = Fraction(f"{float(sides.large[0] / sides.small[0]):.6f}") + Fraction("0.00001")
    more = gains.map(lambda values: values * over)
    assert not certify(fleet, fleet.psi, more, "corrected").valid
    nominal = _with_values(fleet, lambda interval: sum(interval) / 2)
    assert certify(nominal, fleet.psi, more, "corrected").valid


def test_intervals_survive_the_fleet_file() -> None:
    import tomllib

    fleet = CASES["mixed_ring"]().fleet
    again = parse(tomllib.loads(dumps(fleet), parse_float=Decimal))
    assert again == fleet and again.digest == fleet.digest


def test_a_vehicle_without_a_limit_is_not_held_to_one() -> None:
    vehicles = [vehicle(0, limits={"speed": "1"}), vehicle(4)]
    fleet = fleet_of(vehicles, [["r0", "r4"]], {"r0": "1", "r4": "1"})
    assert fleet.psi
    gains = gains_at(0.2, fleet.condition_data(fleet.psi))
    gains.p_v[1] *= 3
    certificate = certify(fleet, fleet.psi, gains, "corrected")
    assert certificate.valid and certificate.margins["speed"][0] > 0 and certificate.margins["speed"][1] is None
    assert "speed limit 1 m/s of 1 vehicles" in " ".join(certificate.facts)


def test_designed_parts_are_embedded_and_said() -> None:
    fleet = CASES["paper"]().fleet
    edges = [
        (a, b, Fraction("0.5") if "v6" in (a, b) and "v5" in (a, b) else weight) for a, b, weight in fleet.links.edges
    ]
    links = Links(edges=tuple(edges), leader_links=fleet.links.leader_links)
    psi = Excitation(Fraction(0), Fraction(1), (Fraction("0.9"),))
    gains = paper_gains().map(lambda values: values * Fraction("0.8"))
    certificate = certify(fleet, psi, gains, "corrected", links=links)
    assert certificate.valid
    weights = {"edges": "1.0 1.0 1.0 1.0 1.0 1.0 0.5", "leader_links": "10 10"}
    assert certificate.content["designed"]["weights"] == weights
    assert certificate.content["fleet"] == fleet.content
    assert certificate.verdict.digests and certificate.verdict.digests["fleet"] == fleet.digest
    assert (
        "weights from the gains file, 1 of them changed" in certificate.facts[1]
        and ": from the gains file, " in certificate.facts[3]
    )
    assert CASES["paper"]().certificate.content["designed"] == {"excitation": None, "weights": None}
    again = certificate.links(fleet)
    assert again and fleet.with_links(again).digest == fleet.with_links(links).digest
    assert certificate.excitation == psi


@pytest.mark.parametrize(
    "change",
    [
        {"edges": [["v1", "v2"], ["v2", "v3"], ["v3", "v4"], ["v4", "v5"], ["v5", "v6"], ["v1", "v4"]]},
        {"leader_links": {"v1": "1", "v2": "10", "v4": "10"}},
    ],
)
def test_designed_weights_stand_on_the_fleets_own_links(change: dict[str, Any]) -> None:
    fleet = CASES["paper"]().fleet
    links = Links.model_validate({**fleet.links.model_dump(mode="json"), **change})
    with pytest.raises(InputError, match="on links that the fleet does not have"):
        certify(fleet, paper_excitation(), paper_gains(), "corrected", links=links)


def test_a_link_that_is_not_used_has_the_weight_0() -> None:
    fleet = CASES["paper"]().fleet
    edges = [edge for edge in fleet.links.edges if set(edge[:2]) != {"v2", "v4"}]
    links = Links(edges=tuple(edges[::-1]), leader_links=fleet.links.leader_links)
    certificate = certify(fleet, paper_excitation(), paper_gains(), "corrected", links=links)
    assert certificate.valid and certificate.content["designed"]["weights"]["edges"] == "1 1 1 0 1 1 1"
    found = certificate.links(fleet)
    assert found and {frozenset(edge[:2]) for edge in found.edges} == {frozenset(edge[:2]) for edge in edges}


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
    with pytest.raises(InputError, match="gains: d_v of vehicle 'v3'"):
        certify(paper_fleet(), paper_excitation(), gains, "paper")


def test_a_psi_that_no_fleet_file_can_give_is_an_input_error() -> None:
    with pytest.raises(InputError, match="coefficients carry 1/pi"):
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


# -- scale ------------------------------------------------------------------------------------------------------------


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
    for name, margins in exact.margins.items():
        for one, other in zip(margins, floats.margins[name], strict=True):
            assert (one is None) == (other is None)
            if one:
                assert other <= one and float(other) == pytest.approx(float(one), rel=2e-5)


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


LIMITED = {"wheel_speed": "400", "acceleration": "30", "turn_acceleration": "200", "speed": "1.5", "turn_rate": "9"}


@pytest.mark.parametrize("count", [1, 3])
def test_all_limits_are_certified_together(count: int) -> None:
    """With wheel inertia and intervals; the rim speeds leave what the stated margins promise."""
    vehicles = [vehicle(i, limits=LIMITED if i < count else {}, wheel_inertia=["0.0001", "0.0002"]) for i in range(4)]
    fleet = fleet_of(vehicles, [["r0", "r1"], ["r1", "r2"], ["r2", "r3"]], {"r0": "1", "r2": "1"})
    assert fleet.psi
    gains = gains_at(0.1, fleet.condition_data(fleet.psi))
    certificate = certify(fleet, fleet.psi, gains, "rate-bounded")
    assert certificate.valid, [*map(str, certificate.violations), str(certificate.verdict)]
    text = "\n".join(certificate.facts)
    for name, value in LIMITED.items():
        assert f"with the {name.replace('_', ' ')} limit {value} " in text
    assert certificate.content["rim_speed"].count(" ") == count - 1


def test_a_wheel_speed_that_is_too_low_is_a_violation_with_a_repair() -> None:
    vehicles = [vehicle(0, limits={"wheel_speed": "0.5"})]
    fleet = fleet_of(vehicles, [], {"r0": "1"})
    assert fleet.psi
    broken = certify(fleet, fleet.psi, gains_at(0.9, fleet.condition_data(fleet.psi)), "rate-bounded")
    assert [v.condition for v in broken.violations] == ["wheel speed limit"]


def test_scales_are_certified() -> None:
    case = CASES["paper"]()
    scale = Saturation(
        Fraction("0.3"), Fraction("0.1"), column([Fraction(2)] * 6), column([Fraction(n) for n in range(1, 7)])
    )
    gains = replace(case.gains, saturation=scale)
    certificate = certify(case.fleet, case.psi, gains, "corrected")
    assert certificate.valid
    table = certificate.content["gains"]
    assert (table["position_scale"], table["heading_scale"]) == ("0.3", "0.1")
    assert (table["speed_scale"], table["turn_rate_scale"]) == ("2 2 2 2 2 2", "1 2 3 4 5 6")
    again = certificate.gains.saturation
    assert (again.position, again.heading) == (scale.position, scale.heading)
    assert list(again.turn_rate) == list(scale.turn_rate)
    broken = replace(scale, heading=Fraction(0))
    with pytest.raises(InputError, match="gains: heading_scale of vehicle 'v1' = 0 must be > 0"):
        certify(case.fleet, case.psi, replace(case.gains, saturation=broken), "corrected")


@pytest.mark.slow
def test_a_hundred_thousand_vehicles_are_certified_and_verified_within_a_minute() -> None:
    from benchmarks.certificate_scale import measure

    found = measure(100_000)
    assert found["valid"]
    assert found["certify_s"] + found["write_s"] + found["verify_s"] < 60
    assert max(found["certify_GB"], found["verify_GB"]) < 4


def test_a_centre_of_mass_off_the_axle_is_a_note() -> None:
    """(2) does not know it, so the certificate is the same, and says so beside it."""
    content = paper_fleet().model_dump(by_alias=True)
    content["vehicle"][0]["com_offset"] = ["-0.1", 0]
    off = certify(parse(content), paper_excitation(), paper_gains(), "paper")
    assert off.valid and off.content["fleet"] == paper("paper").content["fleet"]
    assert any(note.startswith("the centre of mass is off the middle of the axle: 'v1' 10 cm") for note in off.notes)
    assert not any("centre of mass" in note for note in paper("paper").notes)
