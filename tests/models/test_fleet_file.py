"""Fleet files: every class of bad input has one line, all mistakes come at once, written fleets read back."""

import copy
import csv
import math
import string
import tomllib
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
from gaincert.models.errors import InputError
from gaincert.models.files.fleet_file import load_fleet as load
from gaincert.models.files.fleet_file import parse
from gaincert.models.files.fleet_text import dumps
from gaincert.models.files.templates import template_text
from gaincert.models.numbers import decimal_text, exact
from gaincert.models.paper import paper_fleet
from hypothesis import example, given, settings
from hypothesis import strategies as st

GOOD = """
name = "three"
[leader]
position = [-25, -25]
heading_deg = 225
[excitation]
family = "square-wave"
mean = 1.25
terms = 5
frequency = 0.5
[graph]
edges = [["a", "b"], ["b", "c", 2.5]]
leader_links = { b = 10 }
[[vehicle]]
name = "a"
mass = 10
inertia = 3
half_track = 0.3
wheel_radius = 0.05
torque_limit = 55
offset = [-5, -3]
start = { position = [-3, 0], heading_deg = 180, v = 0, omega = 0 }
limits = { speed = 1.0, turn_rate = 2.0 }
[[vehicle]]
name = "b"
mass = 11
inertia = [3, 3.5]
half_track = 0.31
wheel_radius = 0.06
torque_limit = { left = 55, right = [49, 51] }
offset = [-2.5, 2]
start = { position = [0, 5], heading = 1.5 }
[[vehicle]]
name = "c"
mass = 12
inertia = 4
half_track = 0.32
wheel_radius = 0.07
torque_limit = 160
offset = [0, 7]
start = { position = [1, 5], heading_deg = -90, v = 0.1, omega = -0.2 }
"""

POSITIVE = "must be a number > 0, or [low, high] with 0 < low <= high"
LOST = "so L_l is singular (Lemma 1); add an edge or a leader link"
SIZE = "has more than 60 digits or an exponent beyond 60; it must be a number > 0"


def mistakes(text, tmp_path):
    """The lines of the refusal of a file with this content."""
    path = tmp_path / "fleet.toml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(InputError) as refusal:
        load(path)
    lines = refusal.value.mistakes
    assert str(refusal.value).split("\n") == list(lines)
    assert all(line.isprintable() and line for line in lines)
    return [line.removeprefix(f"{tmp_path}/") for line in lines]


def test_the_good_file_is_good(tmp_path):
    (tmp_path / "fleet.toml").write_text(GOOD)
    fleet = load(tmp_path / "fleet.toml")
    assert fleet == load(str(tmp_path / "fleet.toml"))
    assert (fleet.name, fleet.drive, fleet.names) == ("three", "physical", ["a", "b", "c"])
    assert [v.mass for v in fleet.vehicles] == [10, 11, 12]
    assert fleet.vehicles[1].inertia == (3, Fraction("3.5"))
    assert fleet.vehicles[1].torque_limit.right == (49, 51)
    assert fleet.links.edges == (("a", "b", 1), ("b", "c", Fraction("2.5")))
    assert fleet.leader.theta == math.radians(225)
    start = fleet.start()
    assert np.allclose(start.theta, [math.pi, 1.5, -math.pi / 2])
    assert np.allclose([start.x, start.y], [[-3, 0, 1], [0, 5, 5]])
    assert np.allclose([start.v, start.omega], [[0, 0, 0.1], [0, 0, -0.2]])


def test_numbers_are_the_decimals_of_the_file():
    """0.1 is one tenth, not the float beside it."""
    content = paper_fleet().model_dump(by_alias=True)
    content["vehicle"][0]["mass"] = Decimal("0.1")
    assert parse(content).vehicles[0].mass == Fraction(1, 10)
    assert exact(0.1) == Fraction(1, 10) != Fraction(0.1)


# (what is replaced, by what, the lines that come of it)
TABLE = {
    # numbers
    "negative": ("mass = 10", "mass = -10", [f"vehicle 'a': mass = -10 {POSITIVE}"]),
    "zero": ("wheel_radius = 0.05", "wheel_radius = 0.0", [f"vehicle 'a': wheel_radius = 0.0 {POSITIVE}"]),
    "NaN": ("mass = 10", "mass = nan", ["vehicle 'a': mass = NaN is not finite; it must be a number > 0"]),
    "infinite": ("mass = 10", "mass = +inf", ["vehicle 'a': mass = Infinity is not finite; it must be a number > 0"]),
    "NaN offset": (
        "offset = [0, 7]",
        "offset = [0, -nan]",
        ["vehicle 'c': offset.1 = -NaN is not finite; it must be a finite number"],
    ),
    "text": ("mass = 10", 'mass = "heavy"', ["vehicle 'a': mass = 'heavy' is not a number; it must be a number > 0"]),
    "code": (
        "mass = 10",
        "mass = \"__import__('os').getpid()\"",
        ["vehicle 'a': mass = \"__import__('os').getpid()\" is not a number; it must be a number > 0"],
    ),
    "boolean": ("mass = 10", "mass = true", ["vehicle 'a': mass = True is not a number; it must be a number > 0"]),
    "date": (
        "mass = 10",
        "mass = 2020-01-01",
        ["vehicle 'a': mass = 2020-01-01 is not a number; it must be a number > 0"],
    ),
    "huge exponent": ("mass = 10", "mass = 1e999999999", [f"vehicle 'a': mass = 1E+999999999 {SIZE}"]),
    "tiny exponent": ("mass = 10", "mass = 1e-999999999", [f"vehicle 'a': mass = 1E-999999999 {SIZE}"]),
    "huge zero": ("mass = 10", "mass = 0e999999999", [f"vehicle 'a': mass = 0E+999999999 {POSITIVE}"]),
    "exponent beyond reading": (
        "mass = 10",
        "mass = 1e99999999999999999999",
        ["fleet.toml: holds a number whose exponent is beyond all reading; correct it"],
    ),
    "too many digits": ("mass = 10", f"mass = 1.{'1' * 61}", [f"vehicle 'a': mass = 1.{'1' * 55}... {SIZE}"]),
    "huge integer": (
        "mass = 10",
        f"mass = {10**61}",
        [f"vehicle 'a': mass = 1{'0' * 56}... is larger than 1e60; it must be a number > 0"],
    ),
    "unprintable integer": (
        "mass = 10",
        f"mass = 0x{'F' * 9000}",
        ["vehicle 'a': mass = (too long to show) is larger than 1e60; it must be a number > 0"],
    ),
    "empty interval": ("inertia = [3, 3.5]", "inertia = []", [f"vehicle 'b': inertia = [] {POSITIVE}"]),
    "interval of one": ("inertia = [3, 3.5]", "inertia = [3]", [f"vehicle 'b': inertia = [3] {POSITIVE}"]),
    "interval of three": (
        "inertia = [3, 3.5]",
        "inertia = [3, 4, 5]",
        [f"vehicle 'b': inertia = [3, 4, 5] {POSITIVE}"],
    ),
    "turned interval": (
        "inertia = [3, 3.5]",
        "inertia = [3.5, 3]",
        [f"vehicle 'b': inertia = [Decimal('3.5'), 3] {POSITIVE}"],
    ),
    "interval from 0": ("inertia = [3, 3.5]", "inertia = [0, 3]", [f"vehicle 'b': inertia = [0, 3] {POSITIVE}"]),
    "torque of a wheel": ("left = 55", "left = -1", [f"vehicle 'b': torque_limit.left = -1 {POSITIVE}"]),
    "speed limit": ("speed = 1.0", "speed = 0", ["vehicle 'a': limits.speed = 0 must be a number > 0"]),
    "negative link": ("b = 10", "b = -10", ["graph: leader_links.b = -10 must be a number >= 0"]),
    "weight": ('"c", 2.5]', '"c", 0]', ["graph: edges.1.2 = 0 must be a number > 0"]),
    "terms": ("terms = 5", "terms = 0", ["excitation: terms = 0 is not valid: "]),
    "half a term": ("terms = 5", "terms = 5.5", ["excitation: terms = 5.5 is not valid: "]),
    "frequency": ("frequency = 0.5", "frequency = 0", ["excitation: frequency = 0 must be a number > 0"]),
    # keys
    "unknown key": (
        "mass = 10",
        "mass = 10\nmas = 1",
        ["vehicle 'a': unknown key 'mas' (did you mean 'mass'?); correct or remove it"],
    ),
    "unknown key without likeness": (
        "mass = 10",
        "mass = 10\nzzz = 1",
        ["vehicle 'a': unknown key 'zzz'; correct or remove it"],
    ),
    "unknown key at the top": (
        'name = "three"',
        'name = "three"\ndrve = "paper"',
        ["unknown key 'drve' (did you mean 'drive'?); correct or remove it"],
    ),
    "unknown key in the leader": (
        "heading_deg = 225",
        "heading_deg = 225\nhedding = 1",
        ["leader: unknown key 'hedding' (did you mean 'heading'?); correct or remove it"],
    ),
    "unknown key in the excitation": (
        "terms = 5",
        "terms = 5\nmeen = 1",
        ["excitation: unknown key 'meen' (did you mean 'mean'?); correct or remove it"],
    ),
    "unknown key in the graph": (
        "[graph]",
        "[graph]\nedge = 1",
        ["graph: unknown key 'edge' (did you mean 'edges'?); correct or remove it"],
    ),
    "unknown key in a start": (
        "omega = -0.2",
        "omga = -0.2",
        ["vehicle 'c': unknown key 'start.omga' (did you mean 'omega'?); correct or remove it"],
    ),
    "unknown key of a wheel": (
        "left = 55, ",
        "left = 55, rigt = 1, ",
        ["vehicle 'b': unknown key 'torque_limit.rigt' (did you mean 'right'?); correct or remove it"],
    ),
    "a key of the code, not of the file": (
        "[graph]",
        "[links]",
        ["unknown key 'links' (did you mean 'graph'?); correct or remove it"],
    ),
    "missing": ("mass = 10\n", "", ["vehicle 'a': mass is missing"]),
    "no graph": (GOOD[GOOD.index("[graph]") : GOOD.index("[[vehicle]]")], "", ["graph is missing"]),
    "no leader": (GOOD[GOOD.index("[leader]") : GOOD.index("[excitation]")], "", ["leader is missing"]),
    "no vehicle": (GOOD[GOOD.index("[[vehicle]]") :], "", ["vehicle is missing"]),
    "no name": ('name = "a"\n', "", ["vehicle number 1: name is missing"]),
    "no family": ('family = "square-wave"', "", ["excitation must say its family: 'square-wave' or 'harmonics'"]),
    "no heading": ("heading_deg = 225", "", ["leader must have exactly one of heading (rad) and heading_deg"]),
    "two headings": (
        "heading = 1.5",
        "heading = 1.5, heading_deg = 90",
        ["vehicle 'b': start must have exactly one of heading (rad) and heading_deg"],
    ),
    # kinds
    "name is a number": ('name = "a"\n', "name = 5\n", ["vehicle number 1: name = 5 must be a text in quotes"]),
    "empty name": ('name = "three"', 'name = ""', ["name = '' is not valid: "]),
    "long name": ('name = "three"', f'name = "{"x" * 65}"', [f"name = '{'x' * 56}... is not valid: "]),
    "drive": ('name = "three"', 'name = "three"\ndrive = "papr"', ["drive = 'papr' is not valid: "]),
    "family": ('"square-wave"', '"triangle"', ["excitation must have the family 'square-wave' or 'harmonics'"]),
    "constant psi": (
        'family = "square-wave"\nmean = 1.25\nterms = 5',
        'family = "harmonics"\nmean = 1.25\nsin = [0, 0]',
        ["excitation is constant, so (12) fails; give at least one sin or cos that is not 0"],
    ),
    "too many harmonics": (
        'family = "square-wave"\nmean = 1.25\nterms = 5',
        f'family = "harmonics"\nsin = {[1] * 201}',
        ["excitation: sin is not valid: "],
    ),
    "point of one": ("position = [-25, -25]", "position = [-25]", ["leader: position.1 is missing"]),
    "point of three": ("position = [-25, -25]", "position = [1, 2, 3]", ["leader: position is not valid: "]),
    "point": ("position = [-25, -25]", "position = 4", ["leader: position = 4 must be a list"]),
    "one vehicle table": (
        GOOD[GOOD.index("[[vehicle]]") :],
        '[vehicle]\nname = "a"\n',
        ["vehicle must be a list: [..., ...], or tables under [[...]]"],
    ),
    "edge of one": ('["a", "b"]', '["a"]', ["graph: edges.0 = ['a'] must be [from, to] or [from, to, weight]"]),
    "edge of four": ('["a", "b"]', '["a", "b", 1, 2]', ["graph: edges.0 = ['a', 'b', 1, 2] must be [from, to] or "]),
    "edge of numbers": ('["a", "b"]', '[1, "b"]', ["graph: edges.0.0 = 1 must be a text in quotes"]),
    # the graph
    "unknown end": (
        '["a", "b"]',
        '["a", "b"], ["a", "vb"]',
        ["graph: edge 'a' - 'vb': there is no vehicle 'vb' (did you mean 'b'?)"],
    ),
    "unknown led": ("b = 10", "b = 10, nobody = 1", ["graph: leader link of 'nobody': there is no such vehicle"]),
    "loop": ('["a", "b"]', '["a", "b"], ["c", "c"]', ["graph: edge 'c' - 'c' joins a vehicle to itself; remove it"]),
    "twice": (
        '["a", "b"]',
        '["a", "b"], ["b", "a", 3]',
        ["graph: edge 'b' - 'a' is listed twice; keep one, with the sum of the weights"],
    ),
    "one name twice": (
        'name = "c"',
        'name = "a"',
        [
            "vehicle 'a': two vehicles have this name; names must differ",
            "graph: edge 'b' - 'c': there is no vehicle 'c'",
        ],
    ),
    "unled": ("b = 10", "b = 0", [f"graph: no path joins 'a', 'b', 'c' to the leader, {LOST}"]),
    "unled part": ('["a", "b"], ', "", [f"graph: no path joins 'a' to the leader, {LOST}"]),
    # the text
    "not TOML": ("mass = 10", "mass = ten", ["fleet.toml: is not TOML: Invalid value (at line 16, column 8)"]),
    "key twice": ("mass = 10", "mass = 10\nmass = 10", ["fleet.toml: is not TOML: Cannot overwrite a value"]),
    "nested too deeply": ("mass = 10", f"mass = {'[' * 50000}", ["fleet.toml: is nested too deeply"]),
    "nested deeply by dots": (
        "mass = 10",
        f"mass{'.a' * 1500} = 1",
        ["vehicle 'a': mass = (too long to show) is not a number; it must be a number > 0"],
    ),
    "endless integer": ("mass = 10", f"mass = {'9' * 5000}", ["fleet.toml: is not TOML: Exceeds the limit"]),
    "escape codes in a name": (
        "b = 10",
        'b = 10, "x\\n\\u001b[31m" = 1',
        ["graph: leader link of 'x\\n\\x1b[31m': there is no such vehicle"],
    ),
    "line break in a key": (
        "b = 10",
        'b = 10, "x\\ny" = -1',
        ["graph: leader_links.x\\ny = -1 must be a number >= 0", "graph: leader link of 'x\\ny': "],
    ),
    "NUL in a file name": (
        'edges = [["a", "b"], ["b", "c", 2.5]]',
        'edges = "e\\u0000.csv"',
        ["e\\x00.csv: cannot be read: the name of a file holds no NUL character"],
    ),
    "no such table": (
        'edges = [["a", "b"], ["b", "c", 2.5]]',
        'edges = "none.csv"',
        ["none.csv: cannot be read: No such file or directory"],
    ),
    "no such robot": ("mass = 10", 'urdf = "no.urdf"', ["no.urdf: cannot be read: No such file or directory"]),
    "tables and a table of vehicles": (
        'name = "three"',
        'name = "three"\nvehicles = "v.csv"',
        ["vehicles = CSV file and [[vehicle]] tables exclude each other; keep one"],
    ),
}


@pytest.mark.parametrize("case", TABLE)
def test_each_mistake_has_its_line(case, tmp_path):
    old, new, expected = TABLE[case]
    assert GOOD.count(old) == 1, "the table must change one place"
    lines = mistakes(GOOD.replace(old, new), tmp_path)
    assert len(lines) == len(expected), lines
    for line, beginning in zip(lines, expected, strict=True):
        assert line.startswith(beginning)


def test_all_mistakes_of_a_file_come_at_once(tmp_path):
    text = GOOD.replace("half_track = 0.31\n", "").replace('name = "three"\n', "")
    expected = ["name is missing", "vehicle 'b': half_track is missing"]
    for case in ("negative", "NaN offset", "unknown key in the leader", "half a term", "unknown led", "loop"):
        old, new, (line,) = TABLE[case]
        text = text.replace(old, new)
        expected.append(line)
    lines = sorted(mistakes(text, tmp_path))
    assert len(lines) == 8
    assert all(line.startswith(beginning) for line, beginning in zip(lines, sorted(expected), strict=True))


def test_an_empty_file_lacks_everything(tmp_path):
    assert mistakes("", tmp_path) == [f"{key} is missing" for key in ("name", "leader", "graph", "vehicle")]


def test_a_fleet_of_none_is_refused(tmp_path):
    text = "vehicle = []\n" + GOOD[: GOOD.index("[[vehicle]]")]
    assert "the fleet has no vehicles; add a [[vehicle]] table" in mistakes(text, tmp_path)


def test_a_lost_crowd_is_not_listed_whole():
    keys = ("mass", "inertia", "half_track", "wheel_radius", "torque_limit")
    vehicles = [{"name": f"v{i}", **dict.fromkeys(keys, 1), "offset": [0, 0]} for i in range(40)]
    leader = {"position": [0, 0], "heading": 0}
    with pytest.raises(InputError) as refusal:
        parse({"name": "crowd", "leader": leader, "graph": {"leader_links": {"v7": 1}}, "vehicle": vehicles})
    (line,) = refusal.value.mistakes
    assert line == f"graph: no path joins 'v0', 'v1', 'v2', 'v3', 'v4' and 34 more to the leader, {LOST}"


def test_files_that_are_no_text(tmp_path):
    assert mistakes(GOOD.replace("three", "tr\xeas").encode("latin-1"), tmp_path) == ["fleet.toml: is not UTF-8 text"]
    assert mistakes(GOOD.encode("utf-16"), tmp_path) == ["fleet.toml: is not UTF-8 text"]
    with pytest.raises(InputError, match=r"^[^\n]*: cannot be read: Is a directory$"):
        load(tmp_path)
    with pytest.raises(InputError, match=r"^[^\n]*none\.toml: cannot be read: No such file or directory$"):
        load(tmp_path / "none.toml")


def test_a_file_too_large_is_not_read(tmp_path, monkeypatch):
    monkeypatch.setattr("gaincert.models.files.fleet_file.MAX_TOML_BYTES", 2**20)
    (line,) = mistakes(GOOD + "#" * 2**20, tmp_path)
    assert line == "fleet.toml: is larger than 1 MiB; put large fleets into CSV tables"


@pytest.mark.parametrize("change", [lambda b: b"\xef\xbb\xbf" + b, lambda b: b.replace(b"\n", b"\r\n")])
def test_windows_files_are_read(change, tmp_path):
    (tmp_path / "a.toml").write_bytes(change(GOOD.encode()))
    (tmp_path / "b.toml").write_text(GOOD)
    assert load(tmp_path / "a.toml") == load(tmp_path / "b.toml")


def test_a_spoiled_file_is_refused_and_nothing_else(tmp_path, random):
    """Whatever happens to the text: a fleet or an InputError, never another exception."""
    path, refused = tmp_path / "fleet.toml", 0
    alphabet = (string.printable + "\x00\u2028é😀").encode()
    for _ in range(400):
        data = bytearray(GOOD.encode())
        for _ in range(int(random.integers(1, 4))):
            at = int(random.integers(len(data)))
            match random.integers(3):
                case 0:
                    data[at : at + int(random.integers(1, 30))] = b""
                case 1:
                    data[at] = alphabet[random.integers(len(alphabet))]
                case 2:
                    other = int(random.integers(len(data)))
                    data[at:at] = data[other : other + int(random.integers(1, 60))]
        path.write_bytes(data)
        try:
            fleet = load(path)
        except InputError as error:
            refused += 1
            assert all(line.isprintable() for line in error.mistakes)
        else:
            assert parse_text(dumps(fleet), tmp_path) == fleet
    assert 100 < refused < 400


# -- CSV tables -------------------------------------------------------------------------------------------------------

HEADER = "name,mass,inertia,half_track,wheel_radius,torque_limit,offset_x,offset_y,x,y,heading_deg,v,omega"


def write_tables(tmp_path, **changes):
    fleet = paper_fleet()
    files = {
        "fleet.toml": dumps(fleet)[: dumps(fleet).index("[graph]")].replace(
            'drive = "paper"', 'drive = "paper"\nvehicles = "vehicles.csv"'
        )
        + '[graph]\nedges = "edges.csv"\nleader_links = "leaders.csv"\n',
        "edges.csv": "from,to,weight\n" + "".join(f"{a},{b},{w}\n" for a, b, w in fleet.links.edges),
        "leaders.csv": "vehicle,weight\nv2,10\nv4,10\n",
        "vehicles.csv": HEADER
        + "\n"
        + "".join(
            ",".join(
                [v.name]
                + [
                    decimal_text(q)
                    for q in (
                        v.mass,
                        v.inertia,
                        v.half_track,
                        v.wheel_radius,
                        v.torque_limit.left,
                        *v.offset,
                        *v.start.position,
                        v.start.heading_deg,
                        v.start.v,
                        v.start.omega,
                    )
                ]
            )
            + "\n"
            for v in fleet.vehicles
        ),
    }
    for name, (old, new) in changes.items():
        key = f"{name}.csv"
        assert old in files[key]
        files[key] = files[key].replace(old, new, 1)
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    return tmp_path / "fleet.toml"


def test_csv_tables_say_what_the_toml_tables_say(tmp_path):
    assert load(write_tables(tmp_path)) == paper_fleet()


def test_csv_tables_of_a_spreadsheet_are_read(tmp_path):
    path = write_tables(tmp_path)
    for name in ("vehicles", "edges", "leaders"):
        table = tmp_path / f"{name}.csv"
        table.write_bytes(b"\xef\xbb\xbf" + table.read_bytes().replace(b"\n", b"\r\n"))
    assert load(path) == paper_fleet()


@pytest.mark.parametrize(
    ("table", "old", "new", "lines"),
    [
        ("vehicles", "name,mass", "mass,name", [f"vehicles.csv: the first line must be {HEADER}"]),
        ("vehicles", HEADER, "", [f"vehicles.csv: the first line must be {HEADER}"]),
        ("vehicles", "v2,10", "v2,-10", [f"vehicle 'v2': mass = '-10' {POSITIVE}"]),
        ("vehicles", "v2,10", "v2,", ["vehicle 'v2': mass = '' is not a number; it must be a number > 0"]),
        ("vehicles", "v2,10", "v2,nan", ["vehicle 'v2': mass = 'nan' is not finite; it must be a number > 0"]),
        ("vehicles", "v2,10", "v2,1e99", [f"vehicle 'v2': mass = '1e99' {SIZE}"]),
        ("vehicles", "v2,10", "v2,10,10", [f"vehicles.csv: row 3 must have 13 columns: {HEADER}"]),
        ("vehicles", "v2,10,", "v2,", [f"vehicles.csv: row 3 must have 13 columns: {HEADER}"]),
        ("vehicles", "v2,10", "v2," + "9" * 200_000, ["vehicles.csv: line 3: field larger than field limit (131072)"]),
        ("edges", "v1,v2,1", "v1,v2", ["edges.csv: row 2 must have 3 columns: from,to,weight"]),
        ("edges", "v1,v2,1", "v1,v2,0", ["graph: edges.0.2 = '0' must be a number > 0"]),
        ("edges", "v1,v2,1", "v1,v9,1", ["graph: edge 'v1' - 'v9': there is no vehicle 'v9'"]),
        ("edges", "from,to", "to,from", ["edges.csv: the first line must be from,to,weight"]),
        ("leaders", "v2,10", "v2,x", ["graph: leader_links.v2 = 'x' is not a number; it must be a number >= 0"]),
        ("leaders", "v2,10", "v9,10", ["graph: leader link of 'v9': there is no such vehicle"]),
        ("leaders", "v4,10", "v2,10", ["leaders.csv: vehicle 'v2' is listed twice; keep one row"]),
        ("leaders", "vehicle,weight", "vehicle;weight", ["leaders.csv: the first line must be vehicle,weight"]),
    ],
)
def test_mistakes_in_csv_tables(table, old, new, lines, tmp_path):
    path = write_tables(tmp_path, **{table: (old, new)})
    with pytest.raises(InputError) as refusal:
        load(path)
    assert [line.removeprefix(f"{tmp_path}/") for line in refusal.value.mistakes] == lines


def test_the_columns_are_those_of_the_contract(tmp_path):
    write_tables(tmp_path)
    with (tmp_path / "vehicles.csv").open() as file:
        assert next(csv.reader(file)) == HEADER.split(",")


# -- out and in again -------------------------------------------------------------------------------------------------


def parse_text(text, tmp_path):
    path = tmp_path / "again.toml"
    path.write_text(text, encoding="utf-8")
    return load(path)


def test_a_fleet_reads_back_as_it_was(fleet, psi, tmp_path):
    again = parse_text(dumps(fleet), tmp_path)
    assert again == fleet
    assert again.digest == fleet.digest
    assert dumps(again) == dumps(fleet)
    driven = parse({**fleet.model_dump(by_alias=True), "excitation": psi.table()})
    assert parse_text(dumps(driven), tmp_path) == driven != fleet


def test_a_fleet_with_everything_in_it_reads_back(tmp_path):
    for fleet in (paper_fleet(), parse_text(GOOD, tmp_path)):
        assert parse_text(dumps(fleet), tmp_path) == fleet


@given(st.text(min_size=1, max_size=64).filter(lambda name: name.encode("utf-8", "ignore").decode() == name))
@example("\x7f")
@example("😀")
@example('\u2028\x85\x00\n"\\')
@settings(max_examples=150, deadline=None)
def test_any_name_reads_back(tmp_path_factory, name):
    content = copy.deepcopy(paper_fleet().model_dump(by_alias=True))
    content["name"] = content["vehicle"][5]["name"] = name
    content["graph"]["edges"] = [
        [name if end == "v6" else end for end in edge[:2]] + [edge[2]] for edge in content["graph"]["edges"]
    ]
    content["graph"]["leader_links"][name] = 1
    fleet = parse(content)
    assert parse_text(dumps(fleet), tmp_path_factory.getbasetemp()) == fleet


# -- the digest -------------------------------------------------------------------------------------------------------


def digest(content):
    return parse(content).digest


@pytest.fixture
def dictionary():
    import tomllib

    return tomllib.loads(GOOD, parse_float=Decimal)


@pytest.mark.parametrize(
    "change",
    [
        lambda c: c.update(name="another"),
        lambda c: c["leader"].update(position=[1, 2]),
        lambda c: c["leader"].update(heading_deg=1),
        lambda c: c["vehicle"][0]["start"].update(position=[9, 9]),
        lambda c: c["vehicle"][0].pop("start"),
        lambda c: c["vehicle"][0].update(mass="10.000"),
        lambda c: c["vehicle"][0].update(mass=[10, 10]),
        lambda c: c["vehicle"][0].update(torque_limit={"left": 55, "right": 55}),
        lambda c: c["graph"]["edges"][0].append(Decimal("1.0")),
        lambda c: c.update(drive="physical"),
    ],
)
def test_the_digest_does_not_see_what_no_certificate_speaks_of(change, dictionary):
    before = digest(dictionary)
    assert before.startswith("sha256:")
    changed = copy.deepcopy(dictionary)
    change(changed)
    assert changed != dictionary
    assert digest(changed) == before


def nudged(path):
    """A change of the number at a path by one part in 1e15."""

    def change(content):
        table = content
        for key in path[:-1]:
            table = table[key]
        table[path[-1]] = Decimal(table[path[-1]]) + Decimal("1e-15")

    return change


@pytest.mark.parametrize(
    "change",
    [
        lambda c: c.update(drive="paper"),
        lambda c: c.pop("excitation"),
        lambda c: c["excitation"].update(terms=4),
        lambda c: c["vehicle"][0].pop("limits"),
        lambda c: c["graph"]["edges"].append(["a", "c"]),
        lambda c: c["graph"]["leader_links"].update(c=1),
        lambda c: c["vehicle"].reverse(),
        lambda c: c["vehicle"][0].update(torque_limit={"left": 55, "right": 54}),
        *(nudged(("vehicle", 2, key)) for key in ("mass", "inertia", "half_track", "wheel_radius", "torque_limit")),
        *(
            nudged(path)
            for path in (
                ("vehicle", 1, "inertia", 0),
                ("vehicle", 1, "inertia", 1),
                ("vehicle", 1, "torque_limit", "left"),
                ("vehicle", 1, "torque_limit", "right", 1),
                ("vehicle", 0, "offset", 0),
                ("vehicle", 0, "offset", 1),
                ("vehicle", 0, "limits", "speed"),
                ("vehicle", 0, "limits", "turn_rate"),
                ("excitation", "mean"),
                ("excitation", "frequency"),
                ("graph", "edges", 1, 2),
                ("graph", "leader_links", "b"),
            )
        ),
    ],
)
def test_the_digest_sees_every_change_of_the_fleet(change, dictionary):
    changed = copy.deepcopy(dictionary)
    change(changed)
    assert digest(changed) != digest(dictionary)


# -- numbers ----------------------------------------------------------------------------------------------------------


@given(st.decimals(allow_nan=False, allow_infinity=False, min_value=-(10**20), max_value=10**20, places=25))
@settings(max_examples=200, deadline=None)
def test_decimal_text_is_exact(decimal):
    text = decimal_text(Fraction(decimal))
    assert Fraction(text) == Fraction(decimal) == exact(text)
    assert "e" not in text.lower()


def test_a_third_is_no_decimal():
    with pytest.raises(ValueError, match="1/3 is no decimal number"):
        decimal_text(Fraction(1, 3))


@pytest.mark.parametrize("value", [True, None, [1], {}, b"1", "", "one", "1/3", "nan", "-inf", math.nan, math.inf, 1j])
def test_what_is_no_number(value):
    with pytest.raises(ValueError, match=r"^is not (a number|finite)$"):
        exact(value)


# -- templates --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["line", "ring", "turtlebot3"])
@pytest.mark.parametrize("count", [1, 2, 3, 7])
def test_a_template_of_any_size_is_a_fleet(kind, count):
    assert len(parse(tomllib.loads(template_text(kind, count), parse_float=Decimal))) == count


def test_the_papers_template_has_the_papers_vehicles():
    assert parse(tomllib.loads(template_text("paper", 6), parse_float=Decimal)).digest != paper_fleet().digest
    with pytest.raises(InputError, match="--vehicles 5: the paper's fleet has 6"):
        template_text("paper", 5)


def test_saturation_scales_are_read_and_written(tmp_path):
    text = GOOD + "[saturation]\nposition = 0.3\nspeed = 2\n"
    (tmp_path / "fleet.toml").write_text(text)
    fleet = load(tmp_path / "fleet.toml")
    assert fleet.saturation is not None
    scales = fleet.saturation.scales
    assert (scales.position, scales.heading, scales.speed, scales.turn_rate) == (Fraction("0.3"), 1, 2, 1)
    (tmp_path / "again.toml").write_text(dumps(fleet))
    assert load(tmp_path / "again.toml") == fleet
    (tmp_path / "plain.toml").write_text(GOOD)
    assert fleet.digest == load(tmp_path / "plain.toml").digest  # scales belong to the gains


def test_a_scale_must_be_positive(tmp_path):
    (tmp_path / "fleet.toml").write_text(GOOD + "[saturation]\nheading = 0\n")
    with pytest.raises(InputError, match="saturation: heading = 0 must be a number > 0"):
        load(tmp_path / "fleet.toml")
