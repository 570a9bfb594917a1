"""What the kernel reads and what it refuses: strictly, and before anything is believed."""

from __future__ import annotations

import copy
import json
from contextlib import suppress
from typing import Any

import pytest
from gaincert.verify import kernel

from tests.campaigns.certified_fleets import CASES
from tests.verify.certificate_documents import Change, Document, check, document, harmonics, reason, refusal, single


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('{"a": {"b": 1, "b": 1}}', "a key is listed twice in one table"),
        ('{"a": ' + "1" * 5000 + "}", "the file is not JSON: Exceeds the limit"),
        ("{", "the file is not JSON: "),
        ("\udcff", "the file is not JSON: "),
        ("\ufeff{}", "the file is not JSON: Unexpected UTF-8 BOM"),
    ],
)
def test_what_no_file_may_hold_is_refused(text: str, words: str) -> None:
    with pytest.raises(kernel.UnreadableError) as caught:
        kernel.load(text.encode("utf-8", "surrogateescape"))
    assert str(caught.value).startswith(words)


@pytest.mark.parametrize(
    ("value", "found"), [({"b": 1, "a": 2, "c": 3}, "'a, b, c'"), ({"b": 1}, "'b'"), (5, "5"), (None, "None")]
)
def test_a_table_has_exactly_the_keys_that_are_asked_for(value: Any, found: str) -> None:
    assert kernel.table({"b": 1, "a": 2}, ("a", "b")) == [2, 1]
    with pytest.raises(kernel.UnreadableError) as caught:
        kernel.table(value, ("a", "b"))
    assert str(caught.value) == f"expected a table with the keys a, b, not {found}"


# -- the document ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("schema", ["gaincert-certificate-1", "x", None, 2, ["gaincert-certificate-2"]])
def test_another_schema_is_refused_with_the_word_to_certify_again(schema: Any) -> None:
    words = refusal({**single(), "schema": schema})
    assert f"schema {schema!a}, not {kernel.SCHEMA}: certify again (gaincert certify" in words


OTHER_FORMS: list[tuple[str, Change]] = [
    (
        "must be one of paper, corrected, rate-bounded, and drive one of physical, paper",
        lambda c: c.update(conditions=["corrected"]),
    ),
    (
        "must be one of paper, corrected, rate-bounded, and drive one of physical, paper",
        lambda c: c.update(conditions="(16*)"),
    ),
    ("keys excitation, weights, not []", lambda c: c.update(designed=[])),
    ("keys excitation, weights, not 'excitation'", lambda c: c.update(designed={"excitation": None})),
    (
        "keys excitation, weights, not 'excitation, vehicle, weights'",
        lambda c: c.update(designed={"excitation": None, "weights": None, "vehicle": None}),
    ),
    ("keys edges, leader_links, not 'edges'", lambda c: c["designed"].update(weights={"edges": ""})),
    (
        "designed weight: expected a string of 0 decimals",
        lambda c: c["designed"].update(weights={"edges": "1", "leader_links": "1"}),
    ),
    (
        "designed leader weight: expected a string of 1 decimals",
        lambda c: c["designed"].update(weights={"edges": "", "leader_links": ""}),
    ),
    ("keys family, mean, frequency, sin, cos, not []", lambda c: c["designed"].update(excitation=[])),
    ("drive one of physical, paper", lambda c: c["fleet"].update(drive="other")),
    ("drive one of physical, paper", lambda c: c["fleet"].update(drive=["paper"])),
    (
        "keys drive, vehicles, limits, edges, leader_links, excitation, offset_x, offset_y, mass, inertia,",
        lambda c: c["fleet"].update(more="1"),
    ),
    ("torque_left, torque_right, not 'drive, edges", lambda c: c["fleet"].pop("mass")),
    ("mass: expected a string of 1 decimals of one form, not 5", lambda c: c["fleet"].update(mass=5)),
    ("offset: expected a string of 1 decimals of one form, not 'x'", lambda c: c["fleet"].update(offset_x="x")),
    (
        "offset: expected a string of 1 decimals of one form, not ['0', '0']",
        lambda c: c["fleet"].update(offset_y=["0", "0"]),
    ),
    ("keys tail, head, weight, not 5", lambda c: c["fleet"].update(edges=5)),
    ("1 links between 1 vehicles are too many", lambda c: c["fleet"]["edges"].update(tail="0")),
    ("keys vehicle, weight, not 'vehicle'", lambda c: c["fleet"].update(leader_links={"vehicle": "0"})),
    (
        "leader weight: expected a string of 1 decimals",
        lambda c: c["fleet"].update(leader_links={"vehicle": "0", "weight": "1 1"}),
    ),
    (
        "keys speed, turn_rate, wheel_speed, acceleration, turn_acceleration, not ''",
        lambda c: c["fleet"].update(limits={}),
    ),
    ("keys vehicle, value, not 'vehicle'", lambda c: c["fleet"]["limits"].update(speed={"vehicle": "0"})),
    (
        "speed: expected a string of 1 decimals",
        lambda c: c["fleet"]["limits"].update(speed={"vehicle": "0", "value": ""}),
    ),
    ("keys vehicle, value, not '1'", lambda c: c["fleet"]["limits"].update(speed="1")),
    (
        "keys speed, turn_rate, wheel_speed, acceleration, turn_acceleration, not 'acceleration, fast,",
        lambda c: c["fleet"]["limits"].update(fast=None),
    ),
    ("p_v: expected a string of 1 decimals", lambda c: c["gains"].update(p_v="1 1")),
    ("position_scale: expected a string of 1 decimals", lambda c: c["gains"].update(position_scale="1 1")),
    (
        "keys position_scale, speed_scale, p_v, d_v, heading_scale, turn_rate_scale, p_omega, d_omega, k_alpha, not",
        lambda c: c["gains"].pop("p_v"),
    ),
    ("keys position_scale, speed_scale, p_v", lambda c: c["gains"].pop("speed_scale")),
    ("psi_bar: expected a string of 1 decimals of one form, not 1", lambda c: c.update(psi_bar=1)),
    ("psi_bar: expected a string of 1 decimals of one form, not '1 1'", lambda c: c.update(psi_bar="1 1")),
    ("keys here, opposite, not []", lambda c: c.update(arcs=[])),
    ("keys here, opposite, not 'opposite'", lambda c: c["arcs"].pop("here")),
    ("arcs: expected a string of 0 decimals of one form, not []", lambda c: c["arcs"].update(here=[])),
    ("keys link, depth, not ''", lambda c: c.update(tree={})),
    ("tree: link: expected a string of 1 decimals", lambda c: c["tree"].update(link="-1 -1")),
    ("tree: depth: expected a string of 1 decimals", lambda c: c["tree"].update(depth="1.5")),
    ("keys gamma_omega, gamma_v, not ''", lambda c: c.update(rates={})),
    ("(16*): margin: expected a string of 1 decimals", lambda c: c.update(margins={"(16*)": "0 0"})),
    ("keys (16*), not ''", lambda c: c.update(margins={})),
    ("keys (16*), not '(16), (16*)'", lambda c: c["margins"].update({"(16)": "0"})),
    (
        "keys schema, conditions, fleet, designed, gains, psi_bar, arcs, tree, margins, rim_speed, rates, not 'arcs,",
        lambda c: c.update(more=1),
    ),
    ("keys schema, conditions, fleet, designed, gains", lambda c: c.pop("arcs")),
    ("keys family, mean, frequency, sin, cos, not None", lambda c: c["fleet"].update(excitation=None)),
    ("excitation: expected a string of 1 decimals", lambda c: c["fleet"]["excitation"].update(sin="x")),
    ("excitation: mean: expected a string of 1 decimals", lambda c: c["fleet"]["excitation"].update(mean="1 2")),
    ("frequency: expected a string of 1 decimals", lambda c: c["fleet"]["excitation"].update(frequency="x")),
]


@pytest.mark.parametrize("number", range(len(OTHER_FORMS)))
def test_a_document_of_another_form_is_refused(number: int) -> None:
    content = single()
    assert check(content).valid
    words, change = OTHER_FORMS[number]
    change(content)
    assert words in refusal(content)


@pytest.mark.parametrize("content", [[1], "x", 5, None, {}])
def test_a_document_is_a_table(content: Any) -> None:
    refusal(content)


BROKEN: list[tuple[str, Change]] = [
    ("p_v: all must be > 0 (A2)", lambda c: c["gains"].update(p_v="-1 56 56 56 56 56")),
    ("p_v: all must be > 0 (A2)", lambda c: c["gains"].update(p_v="0 56 56 56 56 56")),
    ("speed_scale: all must be > 0 (A2)", lambda c: c["gains"].update(speed_scale="1 1 1 1 1 0")),
    ("position_scale: all must be > 0 (A2)", lambda c: c["gains"].update(position_scale="0")),
    ("mass: an interval must have low <= high (A2)", lambda c: c["fleet"].update(mass=["2 1 1 1 1 1", "1 1 1 1 1 1"])),
    ("half_track: all must be > 0 (A2)", lambda c: c["fleet"].update(half_track="-1 1 1 1 1 1")),
    ("wheel_inertia: all must be >= 0", lambda c: c["fleet"].update(wheel_inertia="-1 1 1 1 1 1")),
    ("edges must be in rising order", lambda c: c["fleet"]["edges"].update(tail="0 0 1 1 2 3 3", head="1 5 2 3 3 4 4")),
    ("well_formed: edges must be in rising order", lambda c: c["fleet"]["edges"].update(tail="0 1 0 1 2 3 4")),
    ("an edge must join a vehicle to a later", lambda c: c["fleet"]["edges"].update(tail="0 0 1 1 3 3 4")),
    ("an edge must join a vehicle to a later", lambda c: c["fleet"]["edges"].update(tail="0 0 1 1 4 3 4")),
    ("edges: all must be from 0 to 5", lambda c: c["fleet"]["edges"].update(head="1 5 2 3 3 4 6")),
    ("edges: all must be from 0 to 5", lambda c: c["fleet"]["edges"].update(tail="-1 0 1 1 2 3 4")),
    ("weight: all must be > 0", lambda c: c["fleet"]["edges"].update(weight="1 1 1 1 1 1 0")),
    ("leader weight: all must be > 0", lambda c: c["fleet"]["leader_links"].update(weight="10 -10")),
    ("leader_links must be in rising order", lambda c: c["fleet"]["leader_links"].update(vehicle="3 1")),
    ("leader_links must be in rising order", lambda c: c["fleet"]["leader_links"].update(vehicle="1 1")),
    ("leader_links: all must be from 0 to 5", lambda c: c["fleet"]["leader_links"].update(vehicle="1 6")),
    ("leader_links: all must be from 0 to 5", lambda c: c["fleet"]["leader_links"].update(vehicle="-1 1")),
    ("connected: vehicle 2", lambda c: c["fleet"]["leader_links"].update(vehicle="3", weight="10")),
    ("connected: vehicle 1", lambda c: c["tree"].update(link="-1 -1 2 -1 5 1")),
    ("connected: vehicle 1", lambda c: c["tree"].update(link="2 -1 2 -1 5 1")),
    ("connected: vehicle 1", lambda c: c["tree"].update(depth="0 0 1 0 1 2")),
    ("connected: vehicle 6", lambda c: c["tree"].update(depth="1 0 1 0 1 1")),
    ("tree: link: all must be from -1 to 6", lambda c: c["tree"].update(link="7 -1 2 -1 5 1")),
    ("tree: link: all must be from -1 to 6", lambda c: c["tree"].update(link="-2 -1 2 -1 5 1")),
    ("tree: depth: all must be from 0 to 5", lambda c: c["tree"].update(depth="1 0 1 0 1 6")),
    ("tree: depth: all must be from 0 to 5", lambda c: c["tree"].update(depth="1 -1 1 0 1 2")),
    ("psi_bounded: psi has the mean", lambda c: c["fleet"]["excitation"].update(mean="2.5")),
    ("(15): vehicle 1", lambda c: c["gains"].update(d_omega="27.09 59.00 28.00 59.00 28.00 28.00")),
    ("(16): vehicle 5", lambda c: c["gains"].update(d_v="840 840 840 840 841 841")),
    ("C >= 2 gamma M", lambda c: c["rates"]["gamma_v"].update(rate="1000000")),
    ("gamma_omega: vehicle", lambda c: c["rates"]["gamma_omega"].update(rate="0.06")),
    ("gamma_v: vehicle", lambda c: c["rates"]["gamma_v"].update(vector="1 1 1 1 1 1")),
]


@pytest.mark.parametrize("number", range(len(BROKEN)))
def test_each_rule_names_what_fails(number: int) -> None:
    content = document()
    words, change = BROKEN[number]
    change(content)
    assert words in reason(content)


@pytest.mark.parametrize(
    ("vehicle", "words"),
    [
        ("0 3 3 6 9", "speed must be in rising order, each once"),
        ("3 0 4 6 9", "speed must be in rising order, each once"),
        ("0 3 4 6 10", "speed: all must be from 0 to 9"),
        ("-1 3 4 6 9", "speed: all must be from 0 to 9"),
    ],
)
def test_a_limit_is_of_vehicles_in_order(vehicle: str, words: str) -> None:
    content = document("mixed_ring")
    assert content["fleet"]["limits"]["speed"]["vehicle"] == "0 3 4 6 9"
    content["fleet"]["limits"]["speed"]["vehicle"] = vehicle
    assert words in reason(content)


def links_of(reader: kernel.Reader, *pairs: tuple[int, int]) -> kernel.Graph:
    """Edges of weight 1, and none to the leader."""
    tail, head = (" ".join([str(pair[end]) for pair in pairs]) for end in (0, 1))
    edges = {"tail": tail, "head": head, "weight": " ".join("1" * len(pairs))}
    return kernel.read_graph(reader, edges, {"vehicle": "", "weight": ""}, None)[0]


def test_each_pair_has_one_link_at_most() -> None:
    all_pairs = (0, 1), (0, 2), (1, 2)
    assert links_of(kernel.Reader(0, 3), *all_pairs).degree == [2, 2, 2]
    with pytest.raises(kernel.UnreadableError, match="4 links between 3 vehicles are too many"):
        links_of(kernel.Reader(0, 3), *all_pairs, (1, 2))
    with pytest.raises(kernel.FalseError, match="edges must be in rising order"):
        links_of(kernel.Reader(0, 4), *all_pairs, (1, 2))


@pytest.mark.parametrize("places", [0, 1, 3])
def test_many_links_have_fewer_places(places: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Vehicles times places, and links times places, are bounded: five vehicles here and six links."""
    reader, pairs = kernel.Reader(places, 5), [(0, 1), (0, 2), (1, 2), (1, 3), (2, 3), (3, 4)]
    monkeypatch.setattr(kernel, "MAX_SIZE", 6 * max(1, places))
    assert len(links_of(reader, *pairs).tail) == 6
    monkeypatch.setattr(kernel, "MAX_SIZE", 6 * max(1, places) - 1)
    with pytest.raises(kernel.UnreadableError, match="6 links between 5 vehicles are too many"):
        links_of(reader, *pairs)


def test_a_designed_weight_of_0_is_no_link() -> None:
    content = document()
    weights = {"edges": "1 1 1 1 1 1 1", "leader_links": "10 10"}
    content["designed"]["weights"] = dict(weights)
    assert check(content).valid
    content["designed"]["weights"] = {**weights, "edges": "0 1 1 1 1 1 1"}
    assert "connected: vehicle 1" in reason(content)
    content["designed"]["weights"] = {**weights, "leader_links": "0 10"}
    assert "connected: vehicle 2" in reason(content)
    content["designed"]["weights"] = {**weights, "edges": "-1 1 1 1 1 1 1"}
    assert "designed weight: all must be >= 0" in reason(content)
    content["designed"]["weights"] = {**weights, "leader_links": "-1 10"}
    assert "designed leader weight: all must be >= 0" in reason(content)


def test_designed_parts_are_used_in_place_of_the_fleets() -> None:
    content = single()
    content["designed"] = {"excitation": harmonics("0.25"), "weights": {"edges": "", "leader_links": "1.5"}}
    claims = kernel.read_claims(content)
    assert claims.graph.degree == claims.graph.leader == [15 * claims.unit // 10]
    assert claims.psi.terms == [(1, claims.unit // 4, 0)]
    plain = kernel.read_claims(single())
    assert plain.graph.degree == [plain.unit] and plain.psi.terms == [(1, 9 * plain.unit // 10, 0)]


GARBAGE: list[Change] = [
    lambda c: c["fleet"].update(excitation={"family": "none"}),
    lambda c: c["fleet"].update(excitation=7),
    lambda c: c["fleet"]["excitation"].update(frequency="0"),
    lambda c: c["fleet"]["leader_links"].update(weight="-1"),
    lambda c: c["fleet"]["leader_links"].update(weight="x"),
    lambda c: c["fleet"]["leader_links"].update(weight="0"),
]


@pytest.mark.parametrize("number", range(len(GARBAGE)))
def test_what_a_designed_part_replaces_is_read_all_the_same(number: int) -> None:
    content = single()
    content["designed"] = {"excitation": harmonics("0.5"), "weights": {"edges": "", "leader_links": "1"}}
    assert check(content).valid
    GARBAGE[number](content)
    with suppress(kernel.UnreadableError):
        assert not check(content).valid


def test_degrees_count_every_edge_at_both_ends_and_the_leader() -> None:
    claims = kernel.read_claims(document("mixed_ring"))
    u, graph = claims.unit, claims.graph
    edges = list(zip(graph.tail, graph.head, graph.weight, strict=True))
    assert len(edges) == 10 and edges[0] == (0, 1, 15 * u // 10)
    assert graph.leader == [2 * u, 0, 0, 0, 0, u // 4, 0, 0, 0, 0]
    for i, degree in enumerate(graph.degree):
        assert degree == graph.leader[i] + sum(w for a, b, w in edges if i in (a, b))
    assert claims.columns[0] == graph.degree


def turned(value: Any) -> Any:
    """The same tables with their keys in the other order."""
    if isinstance(value, dict):
        return {key: turned(value[key]) for key in reversed(value)}
    return value


@pytest.mark.parametrize("name", CASES)
def test_the_order_of_keys_does_not_count(name: str) -> None:
    content = document(name)
    assert json.dumps(turned(content)) != json.dumps(content)
    assert check(turned(content)) == check(content)


def test_too_many_values_are_refused_before_they_are_read(monkeypatch: pytest.MonkeyPatch) -> None:
    data = json.dumps(document()).encode()
    marks = sum(map(data.count, (b'"', b",", b":", b"[", b"{")))
    for limit, size in (("MAX_BYTES", len(data)), ("MAX_MARKS", marks)):
        monkeypatch.setattr(kernel, limit, size)
        assert kernel.check_data(data).valid
        monkeypatch.setattr(kernel, limit, size - 1)
        with pytest.raises(kernel.UnreadableError, match="larger"):
            kernel.check_data(data)
        monkeypatch.undo()


def test_provenance_is_not_read() -> None:
    content: Document = single(provenance={"float": 1.5, "deep": [[[]]], "places": "1.23456789"})
    assert check(content) == check(single())
    without = copy.deepcopy(content)
    without.pop("provenance")
    assert check(without).valid


@pytest.mark.parametrize(
    ("limit", "value"),
    [("MAX_BYTES", 2**30), ("MAX_MARKS", 20_000), ("MAX_WHOLE", 60), ("MAX_PLACES", 100), ("MAX_HARMONIC", 200),
     ("MAX_SIZE", 20_000_000), ("SCHEMA", "gaincert-certificate-2")],
)  # fmt: skip
def test_the_limits_are_those_of_the_documentation(limit: str, value: Any) -> None:
    assert getattr(kernel, limit) == value
