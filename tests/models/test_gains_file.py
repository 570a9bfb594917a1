"""Gains from files: the three kinds give the same gains, and every mistake has its line."""

import csv
import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from gaincert.models.digests import Digests
from gaincert.models.errors import InputError
from gaincert.models.excitation import Excitation
from gaincert.models.files.gains_file import GainsFile, load_gains
from gaincert.models.files.psi_file import psi_path, write_psi
from gaincert.models.fleet import Fleet
from gaincert.models.fleet_tables import Links
from gaincert.models.gains import GAIN_NAMES
from gaincert.models.paper import paper_fleet

GAINS = {name: [f"{i + 1}.{row + 1}" for row in range(6)] for i, name in enumerate(GAIN_NAMES)}
PSI = {"family": "harmonics", "frequency": "2", "sin": ["1"]}


def design(folder: Path, **changed: Any) -> Path:
    path = folder / "design.json"
    path.write_text(json.dumps({"gains": GAINS, "excitation": PSI, **changed}))
    return path


def table(folder: Path, rows: list[list[str]] | None = None, columns: tuple[str, ...] = GAIN_NAMES) -> Path:
    path = folder / "gains.csv"
    own = [[name, *(GAINS[gain][i] for gain in GAIN_NAMES)] for i, name in enumerate(paper_fleet().names)]
    with path.open("w", newline="") as file:
        csv.writer(file).writerows([["vehicle", *columns], *(own if rows is None else rows)])
    return path


def toml(folder: Path, text: str) -> Path:
    path = folder / "gains.toml"
    path.write_text(text)
    return path


def columns_of(content: GainsFile) -> dict[str, list[Fraction]]:
    return {name: list(getattr(content.gains, name)) for name in GAIN_NAMES}


def refusal(path: Path, fleet: Fleet | None = None) -> list[str]:
    """The lines of the refusal, without the file's name."""
    with pytest.raises(InputError) as caught:
        load_gains(path, fleet or paper_fleet())
    assert all(line.startswith(f"{path}: ") for line in caught.value.mistakes)
    return [line.removeprefix(f"{path}: ") for line in caught.value.mistakes]


def test_the_three_kinds_of_file_say_the_same(tmp_path: Path) -> None:
    lines = [f"{name} = [{', '.join(values)}]" for name, values in GAINS.items()]
    files = [design(tmp_path), table(tmp_path), toml(tmp_path, "\n".join(lines))]
    exact = {name: [Fraction(value) for value in values] for name, values in GAINS.items()}
    assert [columns_of(load_gains(path, paper_fleet())) for path in files] == [exact] * 3


def test_one_number_of_a_toml_file_is_for_all(tmp_path: Path) -> None:
    content = load_gains(toml(tmp_path, "".join(f"{name} = 0.1\n" for name in GAIN_NAMES)), paper_fleet())
    assert columns_of(content) == {name: [Fraction("0.1")] * 6 for name in GAIN_NAMES}


def test_the_files_own_psi_goes_before_the_fleets(tmp_path: Path) -> None:
    psi = load_gains(design(tmp_path), paper_fleet()).excitation
    assert (psi.frequency, psi.sin) == (2, (1,))
    assert load_gains(table(tmp_path), paper_fleet()).excitation == paper_fleet().psi


def test_what_a_design_says_of_itself_is_kept(tmp_path: Path) -> None:
    fleet = paper_fleet()
    weights = fleet.links.model_dump(mode="json") | {"leader_links": {"v1": "3"}}
    path = design(tmp_path, conditions="corrected", fleet_digest=fleet.digest, weights=weights)
    content = load_gains(path, fleet)
    assert content.conditions == "corrected"
    assert content.links is not None and content.links.leader_links == {"v1": 3}
    plain = load_gains(design(tmp_path, conditions=7), fleet)
    assert plain.conditions is None and plain.links is None


def test_a_file_of_another_kind_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "gains.yaml"
    path.write_text("p_v: 1")
    assert refusal(path) == ["gains are read from .json, .csv and .toml files; give it the suffix of its format"]


def test_a_design_of_another_fleet_is_refused(tmp_path: Path) -> None:
    (line,) = refusal(design(tmp_path, fleet_digest="sha256:0"))
    assert line.startswith("was designed for another fleet (sha256:0, this is sha256:")


def test_gains_need_a_psi(tmp_path: Path) -> None:
    fleet = paper_fleet().model_copy(update={"excitation": None})
    assert refusal(table(tmp_path), fleet) == [
        "neither it nor the fleet file has an [excitation] table; add one to either"
    ]


@pytest.mark.parametrize(
    "text", ["", "[1]", "{}", '{"gains": [1]}', "{", "[" * 100_000, '{"gains": 1e9999999999999999999}']
)
def test_what_is_no_design_is_refused(text: str, tmp_path: Path) -> None:
    path = tmp_path / "design.json"
    path.write_text(text)
    (line,) = refusal(path)
    assert line.startswith(("is not JSON: ", "is not a design.json: ", "holds a number whose exponent"))


def test_an_unknown_key_of_a_toml_file_is_named(tmp_path: Path) -> None:
    assert refusal(toml(tmp_path, "p_w = 1")) == [
        "unknown key 'p_w'; a gains file has p_v, d_v, p_omega, d_omega, k_alpha, saturation, excitation"
    ]


def test_mistakes_in_a_table_of_gains(tmp_path: Path) -> None:
    row = ["1"] * 5
    names = paper_fleet().names
    assert refusal(table(tmp_path, columns=("p_v", "d_v", "p_omega", "d_omega", "k"))) == [
        "has no column 'k_alpha'; a gains.csv has the columns vehicle,p_v,d_v,p_omega,d_omega,k_alpha"
    ]
    assert refusal(table(tmp_path, [["v1", *row], ["v1", *row]])) == ["vehicle 'v1' is listed twice; keep one row"]
    assert refusal(table(tmp_path, [[name, *row] for name in (*names, "v7")])) == ["vehicle 'v7' is not in the fleet"]
    assert refusal(table(tmp_path, [[name, *row] for name in names[:5]])) == ["has no row for vehicle 'v6'"]


def test_all_mistakes_in_the_numbers_come_at_once(tmp_path: Path) -> None:
    wrong = {**GAINS, "p_v": ["1"], "d_v": ["1", "0", "-2", "x", "4", "5"], "k_alpha": "3"}
    lines = refusal(design(tmp_path, gains=wrong))
    assert lines[0] == "p_v must be a list of 6 numbers, one per vehicle in file order"
    assert [line.split(":")[0] for line in lines[1:4]] == ["vehicle 'v2'", "vehicle 'v3'", "vehicle 'v4'"]
    assert all("d_v = " in line and "> 0" in line for line in lines[1:4])
    assert lines[4] == "k_alpha must be a list of 6 numbers, one per vehicle in file order"


def test_a_psi_that_is_none_is_refused(tmp_path: Path) -> None:
    lines = refusal(design(tmp_path, excitation={**PSI, "frequency": "-1"}))
    assert len(lines) == 1 and lines[0].startswith("excitation: ")


def test_designed_weights_must_lie_on_the_fleets_own_links(tmp_path: Path) -> None:
    own = paper_fleet().links.model_dump(mode="json")
    for changed in ({"leader_links": {"v9": "1"}}, {"edges": own["edges"][1:]}):
        (line,) = refusal(design(tmp_path, weights={**own, **changed}))
        assert line.startswith("weights: ") and line.endswith("; design them again")


NUMBERED = list(enumerate(paper_fleet().names))
SCALES = {"position": "0.2", "heading": "0.05", "speed": [f"1.{i}" for i in range(6)], "turn_rate": ["2.5"] * 6}


def test_the_three_kinds_of_file_say_the_same_scales(tmp_path: Path) -> None:
    lines = [f"{name} = [{', '.join(values)}]" for name, values in GAINS.items()]
    scales = [f"position = 0.2\nheading = 0.05\nspeed = [{', '.join(SCALES['speed'])}]\nturn_rate = 2.5"]
    rows = [
        [name, *(GAINS[gain][i] for gain in GAIN_NAMES), "0.2", "0.05", SCALES["speed"][i], "2.5"]
        for i, name in enumerate(paper_fleet().names)
    ]
    columns = (*GAIN_NAMES, "position_scale", "heading_scale", "speed_scale", "turn_rate_scale")
    files = [
        design(tmp_path, saturation=SCALES),
        table(tmp_path, rows, columns),
        toml(tmp_path, "\n".join([*lines, "[saturation]", *scales])),
    ]
    for path in files:
        scales = load_gains(path, paper_fleet()).gains.saturation
        assert (scales.position, scales.heading) == (Fraction("0.2"), Fraction("0.05")), path
        assert list(scales.speed) == [Fraction(value) for value in SCALES["speed"]]
        assert list(scales.turn_rate) == [Fraction("2.5")] * 6


def test_without_scales_they_are_1(tmp_path: Path) -> None:
    for path in (design(tmp_path), table(tmp_path)):
        assert load_gains(path, paper_fleet()).gains.saturation.unit


def test_a_network_scale_that_differs_between_vehicles_is_refused_by_name(tmp_path: Path) -> None:
    rows = [
        [name, *(GAINS[gain][i] for gain in GAIN_NAMES), f"0.{i + 1}"] for i, name in enumerate(paper_fleet().names)
    ]
    said = refusal(table(tmp_path, rows, (*GAIN_NAMES, "heading_scale")))
    assert said == ["the heading scale must be the same for all vehicles, but is 0.1 for one and 0.6 for another"]


@pytest.mark.parametrize(
    ("scales", "said"),
    [
        ({"position": "0"}, "vehicle 'v1': position scale = '0' must be > 0"),
        ({"speed": ["1"]}, "speed scale must be a list of 6 numbers, one per vehicle in file order"),
        ({"posture": "1"}, "saturation: unknown key 'posture'; it has position, heading, speed, turn_rate"),
        (7, "saturation must be a table with position, heading, speed, turn_rate"),
    ],
)
def test_mistakes_in_scales(tmp_path: Path, scales: Any, said: str) -> None:
    assert refusal(design(tmp_path, saturation=scales))[0] == said


def test_a_fleet_that_gives_scales_wants_them_in_the_file(tmp_path: Path) -> None:
    from gaincert.models.fleet_tables import SaturationTable

    scaled = paper_fleet().model_copy(update={"saturation": SaturationTable(position="0.3")})
    said = refusal(table(tmp_path), scaled)
    assert said == ["has no scales, which means 1, but the fleet file's [saturation] asks for others; add them"]


# -- psi beside a gains.csv --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("designed", [False, True])
def test_psi_and_designed_weights_beside_a_table_are_read_with_it(designed: bool, tmp_path: Path) -> None:
    psi, fleet = Excitation(Fraction(1, 4), Fraction(2), (Fraction(1),), (Fraction(0), Fraction(-3, 2))), paper_fleet()
    weights = {name: weight / 2 for name, weight in fleet.links.leader_links.items()}
    links = Links(edges=fleet.links.edges, leader_links=weights) if designed else None
    for excitation in (psi, Excitation.square_wave(Fraction(5, 4), 5, Fraction(1, 2))):
        write_psi(table(tmp_path), excitation, links, Digests("fleet", "gains"))
        content = load_gains(table(tmp_path), fleet.model_copy(update={"excitation": None}))
        assert content.excitation == excitation
        assert content.links == links
        assert load_gains(table(tmp_path), fleet).excitation == excitation  # the file's own comes first


def test_a_mistake_in_the_file_beside_a_table_is_said_of_that_file(tmp_path: Path) -> None:
    path = psi_path(table(tmp_path))
    for text, line in (
        ("[excitation]\nfamily = 'harmonics'\nfrequency = -1\nsin = [1]", "excitation: frequency"),
        ("psi = 3", "unknown key 'psi'; it has the tables excitation, weights"),
        ("[weights]\nleader_links = { v1 = 1 }", "weights: "),
    ):
        path.write_text(text)
        with pytest.raises(InputError) as caught:
            load_gains(table(tmp_path), paper_fleet())
        assert caught.value.mistakes[0].startswith(f"{path}: {line}")
