"""Fleets and gains made in Python: the same messages as from files, and one readable line for each object."""

import tomllib
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from gaincert import build_fleet
from gaincert.models.conditions import condition_set
from gaincert.models.errors import InputError
from gaincert.models.files.fleet_text import dumps
from gaincert.models.fleet import Fleet
from gaincert.models.gain_checks import exact_gains
from gaincert.models.gains import GAIN_NAMES, Gains
from gaincert.models.paper import paper_excitation, paper_fleet, paper_gains
from gaincert.models.saturation import Saturation
from gaincert.models.tolerance import Tolerance
from gaincert.synthesis.design import Design
from gaincert.synthesis.rates import Rates
from gaincert.verify.certificates.certify import certify
from gaincert.verify.simulation.simulate import simulate

NAMES = ["a", "b"]
HALF = Fraction(1, 2)


def of(value: Any) -> Gains:
    """Gains that are all this."""
    return Gains(**dict.fromkeys(GAIN_NAMES, value))


@pytest.mark.parametrize(
    "value",
    [
        0.5,
        "0.5",
        Decimal("0.5"),
        HALF,
        np.float64(0.5),
        [0.5, 0.5],
        (HALF, "0.5"),
        np.array([0.5, 0.5]),
        np.array([HALF, HALF], dtype=object),
        [np.float32(0.5), 0.5],
    ],
    ids=repr,
)
def test_any_kind_of_number_is_a_gain(value: Any) -> None:
    exact = exact_gains(of(value), NAMES)
    for name in GAIN_NAMES:
        assert list(getattr(exact, name)) == [HALF, HALF]
        assert all(isinstance(entry, Fraction) for entry in getattr(exact, name))
    assert exact.saturation.unit


def test_integers_are_gains_and_scales_are_checked_with_them() -> None:
    gains = replace(of(3), saturation=Saturation(0.25, 1, [1, 2], np.int64(3)))
    exact = exact_gains(gains, NAMES)
    assert list(exact.p_v) == [3, 3]
    assert exact.saturation.position == Fraction(1, 4)
    assert list(exact.saturation.speed) == [1, 2] and list(exact.saturation.turn_rate) == [3, 3]


@pytest.mark.parametrize(
    ("value", "line"),
    [
        ([1], "gains: p_v must be a list of 2 numbers, one per vehicle in file order"),
        ({1, 2}, "gains: p_v must be a list of 2 numbers, one per vehicle in file order"),
        (None, "gains: p_v must be a list of 2 numbers, one per vehicle in file order"),
        ([1, True], "gains: vehicle 'b': p_v = True is not a number; it must be a number > 0"),
        ([1, "x"], "gains: vehicle 'b': p_v = 'x' is not a number; it must be a number > 0"),
        ([1, float("nan")], "gains: vehicle 'b': p_v = nan is not finite; it must be a number > 0"),
        ([-1.5, 1], "gains: vehicle 'a': p_v = -1.5 must be > 0"),
        (0, "gains: vehicle 'a': p_v = 0 must be > 0"),
    ],
    ids=repr,
)
def test_wrong_gains_get_the_messages_of_files(value: Any, line: str) -> None:
    with pytest.raises(InputError) as caught:
        exact_gains(of(value), NAMES)
    assert caught.value.mistakes[0] == line
    assert len(caught.value.mistakes) >= len(GAIN_NAMES)  # every mistake at once


def test_certify_and_simulate_take_plain_numbers_and_refuse_others() -> None:
    fleet, psi = paper_fleet(), paper_excitation()
    plain = Gains(56, 840.0, [2.8, 5.9, 2.8, 5.9, 2.8, 2.8], (28, 59, 28, 59, 28, 28), [3, 1, 3, 1, 3, 3])
    assert certify(fleet, psi, plain, "paper").content == certify(fleet, psi, paper_gains(), "paper").content
    runs = [simulate(fleet, gains, psi, horizon=0.5) for gains in (plain, paper_gains())]
    assert np.array_equal(runs[0].state.x, runs[1].state.x)
    for wrong in (replace(plain, p_v=[56] * 5), replace(plain, p_v="many"), {"p_v": 56}):
        for use in (lambda gains: certify(fleet, psi, gains, "paper"), lambda gains: simulate(fleet, gains, psi)):
            with pytest.raises(InputError, match="gains: "):
                use(wrong)


def test_a_fleet_is_built_without_a_file() -> None:
    content = tomllib.loads(dumps(paper_fleet()))
    assert build_fleet(**content) == paper_fleet()
    content["vehicle"] = tuple(content["vehicle"])
    content["vehicle"][0]["mass"] = np.float64(10)
    assert build_fleet(**content) == paper_fleet()


def test_mistakes_of_a_built_fleet_are_said_like_those_of_a_file() -> None:
    content = tomllib.loads(dumps(paper_fleet()))
    content["vehicle"][0]["mass"] = -1.5
    content["graph"]["edges"] += [["v1", "v9"]]
    del content["vehicle"][1]["inertia"]
    with pytest.raises(InputError) as caught:
        build_fleet(**content, colour="red")
    text = str(caught.value)
    for part in (
        "vehicle 'v1': mass = -1.5 must be",
        "vehicle 'v2': inertia is missing",
        "'v9'",
        "unknown key 'colour'",
    ):
        assert part in text


def designed() -> Design:
    """The paper's gains as a design."""
    return Design(
        fleet=paper_fleet(),
        links=None,
        conditions=condition_set("paper"),
        excitation=paper_excitation(),
        excitation_designed=False,
        gains=paper_gains(),
        origin="the paper",
        rates=Rates(1.0, 1.0, 1.0, 1.0),
        settling=(40.0, float("inf"), 30.0),
        settling_held=(40.0, float("inf"), 30.0),
        sample_time=0.02,
        largest_sample_time=None,
        tolerance=Tolerance(),
        torque_factor=1.0,
        mode="fast",
        seed=0,
        digits=4,
    )


def test_objects_are_one_readable_line() -> None:
    certificate = certify(paper_fleet(), paper_excitation(), paper_gains(), "paper")
    broken = certify(paper_fleet(), paper_excitation(), paper_gains(), "rate-bounded")
    assert repr(paper_fleet()) == str(paper_fleet()) == "Fleet('paper': 6 vehicles, 7 links, 2 to the leader)"
    assert repr(designed()) == "Design('paper': 6 vehicles, conditions paper, 2 of 3 starts settle, median 40 s)"
    assert repr(certificate) == "Certificate(VALID; conditions paper, 6 vehicles)"
    assert repr(broken).startswith("Certificate(INVALID: vehicle 'v")
    for shown in (paper_fleet(), designed(), certificate, broken):
        assert "\n" not in repr(shown)


def test_notebooks_show_tables_whose_texts_are_escaped() -> None:
    fleet = Fleet.model_validate({**paper_fleet().model_dump(by_alias=True), "name": "<b>&"})
    certificate = certify(paper_fleet(), paper_excitation(), paper_gains(), "paper")
    tables = [shown._repr_html_() for shown in (fleet, designed(), certificate)]
    for table in tables:
        assert table.startswith("<table>") and table.endswith("</table>")
    assert "<b>" not in tables[0] and "&lt;b&gt;&amp;" in tables[0]
    assert tables[1].count("<tr>") == 7 and "<td>154." in tables[1]  # T of vehicle 4, N m
    assert tables[2].count("<td>") == len(certificate.facts)
