"""Certificates of intervals, designed parts, limits and scales."""

from __future__ import annotations

from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from typing import Any

import pytest
from gaincert.models.arrays import column
from gaincert.models.conditions import condition_16_star, exact_numbers
from gaincert.models.errors import InputError
from gaincert.models.excitation import Excitation
from gaincert.models.files.fleet_file import parse
from gaincert.models.files.fleet_text import dumps
from gaincert.models.fleet import Fleet
from gaincert.models.fleet_tables import Links
from gaincert.models.numbers import Interval
from gaincert.models.paper import paper_excitation, paper_fleet, paper_gains
from gaincert.models.saturation import Saturation
from gaincert.verify.certificates.certify import certify

from tests.campaigns.certified_fleets import CASES, fleet_of, gains_at, vehicle


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
    with pytest.raises(InputError, match="gains: vehicle 'v1': heading scale = 0 must be > 0"):
        certify(case.fleet, case.psi, replace(case.gains, saturation=broken), "corrected")


def test_a_centre_of_mass_off_the_axle_is_a_note() -> None:
    """(2) does not know it, so the certificate is the same, and says so beside it."""
    content = paper_fleet().model_dump(by_alias=True)
    content["vehicle"][0]["com_offset"] = ["-0.1", 0]
    off = certify(parse(content), paper_excitation(), paper_gains(), "paper")
    assert off.valid and off.content["fleet"] == CASES["paper"]().certificate.content["fleet"]
    assert any(note.startswith("the centre of mass is off the middle of the axle: 'v1' 10 cm") for note in off.notes)
    assert not any("centre of mass" in note for note in CASES["paper"]().certificate.notes)
