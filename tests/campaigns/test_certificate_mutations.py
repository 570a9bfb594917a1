"""Changed certificates: no false one is accepted, and no file crashes the kernel."""

from __future__ import annotations

import copy
import json
import random
import re
from typing import Any

import pytest
from gaincert.verify import kernel
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.campaigns.certificate_rows import column
from tests.campaigns.certificate_truth import statement_is_true
from tests.campaigns.certified_fleets import CASES
from tests.verify.certificate_documents import check

CHANGES = 300


def verdict(document: Any) -> str:
    """valid, invalid or refused."""
    try:
        return "valid" if check(document).valid else "invalid"
    except kernel.UnreadableError:
        return "refused"


def fields(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """The paths of all fields: keys of tables and entries of lists, at every depth, without the provenance."""
    if path == ("provenance",):
        return []
    keys = value.keys() if isinstance(value, dict) else range(len(value)) if isinstance(value, list) else []
    return [deep for key in keys for deep in [(*path, key), *fields(value[key], (*path, key))]]


def changed(document: Any, path: tuple[Any, ...], rng: random.Random) -> Any:
    """A copy with one changed field: a number moved a little or much, or a text, table or list spoiled."""
    result = copy.deepcopy(document)
    parent = result
    for key in path[:-1]:
        parent = parent[key]
    parent[path[-1]] = _other(parent[path[-1]], rng)
    return result


def _other(value: Any, rng: random.Random) -> Any:
    if isinstance(value, bool) or value is None:
        return rng.choice(["1", 0, [], {}])
    if isinstance(value, int):
        return value + rng.choice([-1, 1, -value, 1000, value // 1000 + 1])
    if isinstance(value, str) and NUMBERS.fullmatch(value) and rng.random() < 0.9:
        return _other_column(value, rng)
    if isinstance(value, str):
        place = rng.randrange(len(value) + 1)
        return value[:place] + rng.choice("vx07'( .-") + value[place + 1 :] if rng.random() < 0.8 else value[:-1]
    if isinstance(value, list):
        spoiled = list(value)
        rng.choice([spoiled.reverse, spoiled.clear, lambda: spoiled.append("1"), lambda: spoiled and spoiled.pop()])()
        return spoiled
    spoiled_table = dict(value)
    if spoiled_table and rng.random() < 0.5:
        spoiled_table.pop(rng.choice(list(spoiled_table)))
    else:
        spoiled_table["extra"] = "1"
    return spoiled_table


NUMBERS = re.compile(r"-?[0-9.]+( -?[0-9.]+)*")


def _other_column(value: str, rng: random.Random) -> str:
    """One number of a column changed, or two exchanged, with all places written out again."""
    texts = value.split(" ")
    place = rng.randrange(len(texts))
    if len(texts) > 1 and rng.random() < 0.2:
        other = rng.randrange(len(texts))
        texts[place], texts[other] = texts[other], texts[place]
        return " ".join(texts)
    texts[place] = _other_number(texts[place], rng)
    return column(texts)


def _other_number(value: str, rng: random.Random) -> str:
    digits = [place for place, letter in enumerate(value) if letter.isdigit()]
    place = rng.choice(digits)
    if "." not in value and rng.random() < 0.5:  # an index or a count too
        return str(int(value) + rng.choice([-1, 1]))
    return rng.choice(
        [
            value[:place] + str((int(value[place]) + rng.randint(1, 9)) % 10) + value[place + 1 :],
            "-" + value if not value.startswith("-") else value[1:],
            value.replace(".", ""),
            value + "1" if "." in value else value + ".0000000001",
            "0",
            f"{float(value) * 1.001:.12f}",
            f"{float(value) * 0.999:.12f}",
        ]
    )


@pytest.mark.parametrize("name", CASES)
def test_no_false_statement_is_accepted(name: str) -> None:
    original = json.loads(CASES[name]().certificate.to_json())
    rng = random.Random(f"mutations of {name}")  # noqa: S311
    paths = fields(original)
    # The fleet holds most of the fields; half of the changes go to what the kernel has to compute.
    decided = [path for path in paths if path[0] not in ("fleet", "tree")]
    found = {"valid": 0, "invalid": 0, "refused": 0}
    while sum(found.values()) < CHANGES:
        mutant = changed(original, rng.choice(rng.choice([paths, decided])), rng)
        if mutant == original:
            continue
        outcome = verdict(mutant)
        found[outcome] += 1
        if outcome == "valid":
            assert statement_is_true(mutant), json.dumps(mutant)
    print(name, found)
    assert found["invalid"] + found["refused"] > CHANGES / 2


@pytest.mark.parametrize("name", CASES)
def test_no_false_statement_about_another_fleet_is_accepted(name: str) -> None:
    original = json.loads(CASES[name]().certificate.to_json())
    rng = random.Random(f"fleets like {name}")  # noqa: S311
    paths = [("fleet", *path) for path in fields(original["fleet"])]
    for _ in range(CHANGES // 3):
        mutant = changed(original, rng.choice(paths), rng)
        if verdict(mutant) == "valid":
            assert statement_is_true(mutant), json.dumps(mutant)


@pytest.mark.parametrize("name", CASES)
def test_the_independent_evaluation_accepts_the_original_and_sees_what_is_false(name: str) -> None:
    original = json.loads(CASES[name]().certificate.to_json())
    assert statement_is_true(original)
    for gain, factor in (("d_v", 10), ("speed_scale", 100), ("heading_scale", 100)):
        spoiled = copy.deepcopy(original)
        texts = spoiled["gains"][gain].split()
        spoiled["gains"][gain] = column([f"{factor * float(texts[0]):f}", *texts[1:]])
        if gain != "speed_scale" or name == "mixed_ring":  # whose first vehicle has a speed limit
            assert not statement_is_true(spoiled), gain


def test_every_field_of_the_fleet_is_bound_by_the_digest() -> None:
    original = json.loads(CASES["paper"]().certificate.to_json())
    digest = CASES["paper"]().fleet.digest
    rng = random.Random(5)  # noqa: S311
    for path in fields(original["fleet"]):
        mutant = changed(original, ("fleet", *path), rng)
        try:
            assert mutant == original or not check(mutant, digest).valid, path
        except kernel.UnreadableError:
            continue


def test_a_change_of_the_provenance_changes_no_claim() -> None:
    original = json.loads(CASES["line"]().certificate.to_json())
    facts = check(original).theorem
    original["provenance"] = {"versions": "whatever"}
    assert check(original).theorem == facts


anything = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text()
    | st.sampled_from(["0", "1", "-1", "0.5", "1e5"]),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner, max_size=4),
    max_leaves=12,
)


@settings(max_examples=300, deadline=None)
@given(data=st.data(), value=anything)
def test_any_value_in_any_place_gets_a_verdict_or_a_refusal(data: st.DataObject, value: Any) -> None:
    document = json.loads(CASES["mixed_ring"]().certificate.to_json())
    path = data.draw(st.sampled_from(fields(document)))
    parent = document
    for key in path[:-1]:
        parent = parent[key]
    parent[path[-1]] = value
    assert "\n" not in _reason(document)


@settings(max_examples=300, deadline=None)
@given(st.text() | st.binary().map(lambda data: data.decode("latin-1")) | anything.map(json.dumps))
def test_any_text_gets_a_refusal(text: str) -> None:
    with pytest.raises(kernel.UnreadableError):
        kernel.check_data(("{" + text).encode("utf-8", "surrogatepass"))


@settings(max_examples=200, deadline=None)
@given(st.data())
def test_any_change_of_a_byte_gets_a_verdict_or_a_refusal(data: st.DataObject) -> None:
    text = CASES["line"]().certificate.to_json().encode()
    place = data.draw(st.integers(1, len(text) - 1))
    letter = data.draw(st.binary(min_size=0, max_size=2))
    try:
        kernel.check_data(text[:place] + letter + text[place + 1 :])
    except kernel.UnreadableError as error:
        assert len(str(error)) < 500


def _reason(document: Any) -> str:
    try:
        return check(document).reason
    except kernel.UnreadableError as error:
        return str(error)
