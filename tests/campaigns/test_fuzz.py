"""Every loader on changed and on arbitrary files: a value or the documented error, and nothing else.

The default run is short and always the same. GAINCERT_FUZZ_SECONDS=120 runs for about 120 s, each time on other inputs.
"""

from __future__ import annotations

import copy
import json
import os
import time
from collections.abc import Callable
from decimal import Decimal
from pathlib import Path
from typing import Any

import pytest
from gaincert.models.errors import InputError
from gaincert.models.files.fleet_file import load_fleet as load
from gaincert.models.files.fleet_file import parse
from gaincert.models.files.fleet_text import dumps
from gaincert.models.files.gains_file import load_gains
from gaincert.models.files.robots.description import read_robot
from gaincert.models.files.starts_file import load_starts
from gaincert.models.fleet import Fleet
from gaincert.models.numbers import decimal_text, exact
from gaincert.verify import kernel
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from tests.campaigns.certificate_truth import statement_is_true
from tests.campaigns.certified_fleets import CASES
from tests.cli.test_bad_input import GAINS, STARTS, design, good_fleet
from tests.models.robots.robot_files import ROBOT
from tests.models.test_fleet_file import GOOD

SECONDS = float(os.environ.get("GAINCERT_FUZZ_SECONDS", "0"))
LAWS = 9  # among which the time is shared
SLOWEST = 30.0  # s that one input may take on a busy machine


def budget(per_second: int) -> settings:
    """As many inputs as fit into a share of the time; the same ones in every short run. Nothing is stored."""
    return settings(
        max_examples=max(20, int(per_second * (SECONDS or 9) / LAWS)),
        derandomize=not SECONDS,
        database=None,
        deadline=None,
        suppress_health_check=list(HealthCheck),
    )


# -- inputs -----------------------------------------------------------------------------------------------------------

WORDS = ["0", "-1", "nan", "inf", "-inf", "1e60", "1e-60", "1e61", "1e999999999", "0e999999999", "true", "null", "NaN"]
WORDS += ["''", '""', "[", "]", "[[", "{", "}", "{}", "<", ">", "/>", "&", '"', "'", "=", ",", ".", "\n", "\r", "#"]
WORDS += ["1e99999999999999999999", f"0x{'F' * 4000}", "9" * 4400, "[" * 3000, "a." * 900, "1979-05-27"]
WORDS += ["\x00", "\x1b[31m", "\u2028", "é"]


def trees(leaves: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    """Values, and lists and tables of them."""
    inside = st.text(max_size=4)
    return st.recursive(
        leaves, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(inside, inner, max_size=3), max_leaves=8
    )


plain = st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8) | st.sampled_from(WORDS)
any_json = trees(plain | st.just(10**70))
anything = trees(plain | st.decimals() | st.dates() | st.sampled_from([10**70, Decimal("1e999999999")]))


@st.composite
def spoiled(draw: st.DrawFn, *texts: str) -> bytes:
    """One of these texts with a few pieces removed and others inserted."""
    text = draw(st.sampled_from(texts)).encode()
    for _ in range(draw(st.integers(1, 3))):
        at = draw(st.integers(0, len(text)))
        cut, begin, length = draw(st.integers(0, 12)), draw(st.integers(0, len(text))), draw(st.integers(0, 40))
        own = text[begin : begin + length]
        piece = draw(st.sampled_from(WORDS).map(str.encode) | st.binary(max_size=4) | st.just(own))
        text = text[:at] + piece + text[at + cut :]
    return text


@st.composite
def replaced(draw: st.DrawFn, content: Any, values: st.SearchStrategy[Any]) -> Any:
    """A tree of tables and lists in which one to three values, at any depth, are replaced."""
    content = copy.deepcopy(content)
    for _ in range(draw(st.integers(1, 3))):
        parent, key = None, None
        here = content
        while isinstance(here, (dict, list)) and here and (parent is None or draw(st.integers(0, 3))):
            parent, key = here, draw(st.sampled_from(list(here) if isinstance(here, dict) else range(len(here))))
            here = parent[key]
        if parent is not None:
            parent[key] = draw(values)
    return content


def outcome(loader: Callable[[], Any], error: type[Exception] = InputError) -> Any:
    """The value, or None if the loader refuses with its error, in readable lines and bounded time."""
    begin = time.monotonic()
    try:
        return loader()
    except error as refusal:
        assert str(refusal)
        assert all(line.isprintable() for line in str(refusal).split("\n"))
        return None
    finally:
        assert time.monotonic() - begin < SLOWEST


def written(folder: Path, name: str, data: bytes) -> Path:
    path = folder / name
    path.write_bytes(data)
    return path


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("fuzz")
    (folder / "robot.urdf").write_text(ROBOT)
    return folder


# -- fleets -----------------------------------------------------------------------------------------------------------


def reads_back(fleet: Fleet | None, folder: Path) -> None:
    """An accepted fleet can be written, and reads back equal."""
    if fleet is not None:
        text = dumps(fleet)
        assert load(written(folder, "again.toml", text.encode())) == fleet


@budget(90)
@given(spoiled(GOOD))
@example(GOOD.replace("mass = 10", "mass = 1e60").encode())  # which has 61 digits where it is written out
def test_a_spoiled_fleet_file_is_a_fleet_or_refused(folder: Path, data: bytes) -> None:
    reads_back(outcome(lambda: load(written(folder, "fleet.toml", data))), folder)


@budget(60)
@given(st.data())
def test_a_fleet_with_other_values_is_a_fleet_or_refused(folder: Path, data: st.DataObject) -> None:
    content = data.draw(replaced(fleet_content(), anything | st.just("robot.urdf")))
    reads_back(outcome(lambda: parse(content, folder)), folder)


def fleet_content() -> dict[str, Any]:
    """The content of GOOD as tomllib reads it, with one vehicle from a robot description."""
    import tomllib

    content = tomllib.loads(GOOD, parse_float=Decimal)
    content["vehicle"][2]["urdf"] = "robot.urdf"
    content["disturbance"] = {"delay": 1, "lost_link": ["a", "b"]}
    return content


KEYS = ("name", "drive", "leader", "excitation", "disturbance", "graph", "links", "vehicle", "vehicles")


@budget(120)
@given(st.dictionaries(st.sampled_from(KEYS) | st.text(max_size=4), anything, max_size=6))
def test_any_table_is_a_fleet_or_refused(folder: Path, content: dict[str, Any]) -> None:
    reads_back(outcome(lambda: parse(content, folder)), folder)


# -- gains, starts, robots --------------------------------------------------------------------------------------------

FLEET = good_fleet()
TABLE = "vehicle,p_v,d_v,p_omega,d_omega,k_alpha\na,1,20,0.5,10,0.5\nb,1,20,0.5,10,0.5\n"
WEIGHTS = {"edges": [["a", "b", "2"]], "leader_links": {"a": "1"}}
PSI = {"family": "harmonics", "mean": "0", "frequency": "1", "sin": ["1"]}


@budget(160)
@given(st.sampled_from([".toml", ".csv", ".json"]), spoiled(GAINS, TABLE, design(weights=WEIGHTS, excitation=PSI)))
def test_a_spoiled_gains_file_is_gains_or_refused(folder: Path, suffix: str, data: bytes) -> None:
    found = outcome(lambda: load_gains(written(folder, f"gains{suffix}", data), FLEET))
    assert found is None or all(gain > 0 for column in vars(found.gains).values() for gain in column)


@budget(120)
@given(replaced(json.loads(design(weights=WEIGHTS, excitation=PSI)), any_json))
def test_a_design_with_other_values_is_gains_or_refused(folder: Path, content: Any) -> None:
    outcome(lambda: load_gains(written(folder, "design.json", json.dumps(content).encode()), FLEET))


@budget(200)
@given(spoiled(STARTS))
def test_a_spoiled_starts_file_is_starts_or_refused(folder: Path, data: bytes) -> None:
    found = outcome(lambda: load_starts(written(folder, "starts.csv", data), FLEET))
    assert found is None or all(len(column) == 2 for start in found for column in start)


@budget(130)
@given(spoiled(ROBOT))
@example(ROBOT.replace('xyz="0.1 0 0"', 'xyz="1e60 0 0"').encode())
def test_a_spoiled_urdf_is_a_robot_or_refused(folder: Path, data: bytes) -> None:
    found = outcome(lambda: read_robot(written(folder, "spoiled.urdf", data)))
    if found is not None:
        assert found.vehicle_keys().keys() >= {"mass", "inertia", "half_track", "wheel_radius"}
        assert all(exact(decimal_text(number.value)) == number.value for number in found.numbers.values())


# -- certificates -----------------------------------------------------------------------------------------------------

LINE = json.loads(CASES["line"]().certificate.to_json())


def verdict(data: bytes) -> kernel.Verdict | None:
    found: kernel.Verdict | None = outcome(lambda: kernel.check_data(data), kernel.UnreadableError)
    assert found is None or found.valid or found.reason.isprintable()
    return found


@budget(150)
@given(replaced(LINE, any_json) | spoiled(json.dumps(LINE)))
def test_a_changed_certificate_is_valid_only_where_it_is_true(content: Any) -> None:
    found = verdict(content if isinstance(content, bytes) else json.dumps(content).encode())
    if found is not None and found.valid:
        stated = json.loads(content) if isinstance(content, bytes) else content
        assert statement_is_true(stated)


@budget(150)
@given(any_json.map(lambda content: json.dumps(content).encode()) | st.binary(max_size=60))
def test_no_other_document_is_a_certificate(data: bytes) -> None:
    assert verdict(data) is None
