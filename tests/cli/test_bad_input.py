"""Bad input of every kind through the command line: the exit code, one message with the mistake, no file left.

`python tests/cli/test_bad_input.py` prints, as a table, how many inputs of each kind there are and how many behaved.
"""

from __future__ import annotations

import contextlib
import csv
import json
import os
import re
import resource
import signal
import struct
import subprocess
import sys
import tempfile
import time
import tomllib
import zipfile
from collections.abc import Callable
from dataclasses import dataclass, field
from decimal import Decimal
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from gaincert.models.errors import one_line
from gaincert.models.files.fleet_file import graph_mistakes, parse
from gaincert.models.files.gains_file import load_gains
from gaincert.reports.deployment import write_fleet_copy
from gaincert.verify.certificates.certify import certify

from tests.cli.command_line import gaincert
from tests.models.robots.robot_files import ROBOT

FLEET = """
name = "two"
[leader]
position = [0, 0]
heading_deg = 90
[excitation]
family = "harmonics"
frequency = 0.5
sin = [1.2]
[graph]
edges = [["a", "b"]]
leader_links = { a = 1 }
[[vehicle]]
name = "a"
mass = 20
inertia = 0.8
half_track = 0.25
wheel_radius = 0.08
torque_limit = 12
offset = [-1, 0]
start = { position = [-4, -6], heading_deg = 0 }
limits = { speed = 1.0 }
[[vehicle]]
name = "b"
mass = 18
inertia = 0.8
half_track = 0.25
wheel_radius = 0.08
torque_limit = 12
offset = [1, 0]
start = { position = [4, -6], heading_deg = 180 }
"""
GAINS = "p_v = 1\nd_v = 20\np_omega = 0.5\nd_omega = 10\nk_alpha = 0.5\n"
STARTS = "start,vehicle,x,y,theta,v,omega\n0,a,1,2,3,0,0\n0,b,2,2,3,0,0\n"
VEHICLES = "name,mass,inertia,half_track,wheel_radius,torque_limit,offset_x,offset_y,x,y,heading_deg,v,omega\n"
DEEP, HUGE, ENDLESS = "[" * 100_000, f"0x{'F' * 9000}", "1e99999999999999999999"
SPARSE = 200 * 2**20  # bytes
ESCAPE = "\x1b[31m"

Make = str | bytes | Callable[[Path], Any]  # the content of a file, or what puts it there

CHECK = ("check", "fleet.toml")
GIVEN = ("fleet.toml", "--gains", "gains.toml", "-o", "out")
CERTIFY = ("certify", *GIVEN)
SIMULATE = ("simulate", *GIVEN, "--horizon", "1")
VALIDATE = ("validate", *GIVEN, "--starts", "1", "--workers", "1", "--horizon", "1")
DESIGN = ("design", "fleet.toml", "-o", "out")
VERIFY = ("verify", "certificate.json")


@dataclass(frozen=True)
class Bad:
    """One bad input."""

    kind: str
    name: str
    command: tuple[str, ...]
    says: str  # a regular expression that the message matches
    code: int = 2
    files: dict[str, Make] = field(default_factory=dict)  # beside a good fleet and good gains, or in their place
    quota: int | None = None  # bytes that a file may have: a full disk
    stdout: str | None = None  # where standard output goes
    writes: bool = False  # valid, and only looks bad: files are written, into `out` and nowhere else


# -- how it is run, and what is then required -------------------------------------------------------------------------


def prepare(bad: Bad, folder: Path) -> None:
    """Write a good fleet and good gains, then the bad input."""
    for name, make in {"fleet.toml": FLEET, "gains.toml": GAINS, **bad.files}.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if callable(make):
            make(path)
        else:
            path.write_bytes(make if isinstance(make, bytes) else make.encode())


def run(bad: Bad) -> tuple[int, str, str]:
    """Exit code, standard output and standard error; in its own process if the system has to refuse."""
    if bad.quota is None and bad.stdout is None:
        return gaincert(*bad.command)

    def with_quota() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        if bad.quota is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (bad.quota, bad.quota))

    command = [sys.executable, "-m", "gaincert", *bad.command]
    with Path(bad.stdout or os.devnull).open("w") as sink:
        done = subprocess.run(
            command, stdout=sink, stderr=subprocess.PIPE, text=True, check=False, timeout=60, preexec_fn=with_quota
        )
    return done.returncode, "", done.stderr


def complaints(bad: Bad, folder: Path) -> list[str]:
    """The mistakes in the command line's reaction; empty if it behaves."""
    prepare(bad, folder)
    before = content_of(folder)
    with contextlib.chdir(folder):
        try:
            code, out, err = run(bad)
        except Exception as error:
            return [f"it raises {error!r}"]
    wrong = [f"exit code {code}, not {bad.code}"] if code != bad.code else []
    message = out + err if bad.code in (0, 1) else err  # a verdict is the answer, not an error
    if not re.search(bad.says, message):
        wrong.append(f"its message is {message[-500:]!r}, not /{bad.says}/")
    if "Traceback" in err:
        wrong.append(f"it prints a traceback: {err[-500:]}")
    if strange := {c for c in out + err if not c.isprintable() and c != "\n"}:
        wrong.append(f"it prints the control characters {strange}")
    left = {path for path in content_of(folder) ^ before if not (bad.writes and path[0].startswith("out/"))}
    return wrong + ([f"it leaves or changes {sorted(left)}"] if left else [])


def content_of(folder: Path) -> set[tuple[str, int]]:
    """Every file below a folder and the folder above it, with its size."""
    here = {(str(path.relative_to(folder)), path.lstat().st_size) for path in folder.rglob("*") if not path.is_dir()}
    return here | {(f"../{path.name}", 0) for path in folder.parent.iterdir()}


# -- what files are made of -------------------------------------------------------------------------------------------


def changed(text: str, *changes: tuple[str, str]) -> str:
    """The text with each first string, which must be in it, replaced by the second."""
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new, 1)
    return text


@cache
def certificate() -> str:
    """A valid certificate of the good fleet."""
    fleet = good_fleet()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "gains.toml"
        path.write_text(GAINS)
        chosen = load_gains(path, fleet)
    made = certify(fleet, chosen.excitation, chosen.gains, "corrected")
    assert made.valid, made.violations
    return made.to_json()


def good_fleet() -> Any:
    """The fleet that FLEET describes."""
    return parse(tomllib.loads(FLEET, parse_float=Decimal))


def forged(**changes: Any) -> str:
    """The certificate with other values under some keys."""
    return json.dumps({**json.loads(certificate()), **changes})


def sparse(path: Path) -> None:
    """A large file that uses no space on the disk."""
    with path.open("wb") as file:
        file.truncate(SPARSE)


def link_to(target: str) -> Callable[[Path], None]:
    return lambda path: path.symlink_to(target)


def certified_folder(**others: Make) -> dict[str, Make]:
    """`out` as certify leaves it, with some files replaced."""

    def copy_of_fleet(path: Path) -> None:
        write_fleet_copy(good_fleet(), path.parent)

    own: dict[str, Make] = {"out/certificate.json": certificate(), "out/fleet_copy.toml": copy_of_fleet}
    return {**own, **{f"out/{name.replace('__', '.')}": make for name, make in others.items()}}


def trajectory(shape: str) -> Make:
    """An archive whose only array has a header without data."""
    heading = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}}}\n".encode()

    def write(path: Path) -> None:
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("t.npy", b"\x93NUMPY\x01\x00" + struct.pack("<H", len(heading)) + heading)

    return write


def design(**changes: Any) -> str:
    """A design.json for the good fleet."""
    gains = {line.split(" = ")[0]: [line.split(" = ")[1]] * 2 for line in GAINS.splitlines()}
    return json.dumps({"fleet_digest": good_fleet().digest, "conditions": "corrected", "gains": gains, **changes})


# -- the inputs -------------------------------------------------------------------------------------------------------


def fleets() -> list[Bad]:
    def bad(name: str, old: str, new: str, says: str) -> Bad:
        return Bad("fleet file", name, CHECK, says, files={"fleet.toml": changed(FLEET, (old, new))})

    unled = r"no path joins 'a', 'b' to the leader, so L_l is singular \(Lemma 1\)"
    return [
        bad("a text for a number", "mass = 20", 'mass = "heavy"', r"vehicle 'a': mass = 'heavy' is not a number"),
        bad("a boolean for a number", "mass = 20", "mass = true", r"mass = True is not a number"),
        bad("a table for a number", "mass = 20", "mass = { kg = 20 }", r"'a': mass = .*must be a number > 0"),
        bad("NaN", "mass = 20", "mass = nan", r"vehicle 'a': mass = NaN is not finite; it must be a number > 0"),
        bad("an infinity", "inertia = 0.8", "inertia = inf", r"inertia = Infinity is not finite"),
        bad("minus infinity in a point", "[-1, 0]", "[-inf, 0]", r"offset\.0 = -Infinity is not finite"),
        bad("1e999999999", "mass = 20", "mass = 1e999999999", r"mass = 1E\+999999999 has more than 60 digits"),
        bad("an endless exponent", "mass = 20", f"mass = {ENDLESS}", r"fleet\.toml: .*exponent is beyond all reading"),
        bad("a huge integer", "mass = 20", f"mass = {HUGE}", r"mass = \(too long to show\) is larger than 1e60"),
        bad("a negative mass", "mass = 20", "mass = -20", r"mass = -20 must be a number > 0"),
        bad("an inertia of zero", "inertia = 0.8", "inertia = 0", r"inertia = 0 must be a number > 0"),
        bad("a wheel radius of zero", "radius = 0.08", "radius = 0.0", r"wheel_radius = 0\.0 must be a number > 0"),
        bad("a negative half track", "track = 0.25", "track = -1", r"half_track = -1 must be a number > 0"),
        bad("an interval turned round", "mass = 20", "mass = [21, 20]", r"mass = .* 0 < low <= high"),
        bad("a torque limit of zero", "limit = 12", "limit = 0", r"'a': torque_limit\.left = 0 must be a number > 0"),
        bad("a speed limit of zero", "speed = 1.0", "speed = 0", r"limits\.speed = 0 must be a number > 0"),
        bad("an unknown key", "mass = 20", "mas = 20", r"unknown key 'mas' \(did you mean 'mass'\?\)"),
        bad("a missing key", "mass = 20\n", "", r"vehicle 'a': mass is missing"),
        bad("no graph", '[graph]\nedges = [["a", "b"]]\nleader_links = { a = 1 }\n', "", r"graph is missing"),
        bad("no vehicle", FLEET[FLEET.index("[[vehicle]]") :], "", r"vehicle is missing"),
        bad("no vehicle in the list", FLEET[FLEET.index("[[vehicle]]") :], "[vehicle]\n", r"vehicle must be a list"),
        bad("one name twice", 'name = "b"', 'name = "a"', r"vehicle 'a': two vehicles have this name"),
        bad("an empty name", 'name = "b"', 'name = ""', r"vehicle '': name = '' is not valid"),
        bad("a self-loop", '["a", "b"]', '["a", "b"], ["a", "a"]', r"edge 'a' - 'a' joins a vehicle to itself"),
        bad("an edge twice", '["a", "b"]', '["a", "b"], ["b", "a"]', r"edge 'b' - 'a' is listed twice"),
        bad("an unknown vehicle", '["a", "b"]', '["a", "b"], ["a", "c"]', r"there is no vehicle 'c'"),
        bad("a part by itself", '[["a", "b"]]', "[]", r"no path joins 'b' to the leader"),
        bad("no leader link", "{ a = 1 }", "{ }", unled),
        bad("a leader link of zero", "{ a = 1 }", "{ a = 0 }", unled),
        bad("a weight of zero", '["a", "b"]', '["a", "b", 0]', r"graph: edges\.0\.2 = 0 must be a number > 0"),
        bad("a constant psi", "sin = [1.2]", "mean = 3", r"excitation is constant, so \(12\) fails"),
        bad("an unknown family", '"harmonics"', '"sawtooth"', r"family 'square-wave' or 'harmonics'"),
        bad("two headings", "heading_deg = 90", "heading_deg = 90\nheading = 1", r"leader must have exactly one of"),
        bad("a key twice", "mass = 20", "mass = 20\nmass = 20", r"fleet\.toml: is not TOML"),
        bad("truncated", FLEET[200:], "", r"fleet\.toml: is not TOML|is missing"),
        bad("nested deeply", "mass = 20", f"mass = {DEEP}", r"fleet\.toml: is nested too deeply"),
        bad(
            "a urdf that is a tower of tables",
            "mass = 20",
            f"urdf{'.a' * 1500} = 1",
            r"vehicle 'a': urdf: unknown key 'a'",
        ),
        bad("a urdf that is a huge number", "mass = 20", f"urdf = {HUGE}", r"urdf = .* must be a text in quotes"),
        bad("a disturbance below zero", "[graph]", "[disturbance]\ndelay = -1\n[graph]", r"delay = -1 must be a"),
    ]


def tables() -> list[Bad]:
    start, end = FLEET[: FLEET.index("[graph]")], "[graph]\nedges = 'e.csv'\nleader_links = 'l.csv'\n"
    good = {
        "fleet.toml": f"vehicles = 'v.csv'\n{start}{end}",
        "v.csv": f"{VEHICLES}a,20,0.8,0.25,0.08,12,-1,0,-4,-6,0,0,0\nb,18,0.8,0.25,0.08,12,1,0,4,-6,180,0,0\n",
        "e.csv": "from,to,weight\na,b,1\n",
        "l.csv": "vehicle,weight\na,1\n",
    }

    def bad(name: str, file: str, old: str, new: str, says: str) -> Bad:
        return Bad("CSV table of a fleet", name, CHECK, says, files={**good, file: changed(good[file], (old, new))})

    return [
        bad("another heading", "v.csv", "name,mass", "mass,name", r"v\.csv: the first line must be name,mass"),
        bad("a column too few", "v.csv", "a,20,", "a,", r"v\.csv: row 2 must have 13 columns"),
        bad("a column too many", "e.csv", "a,b,1", "a,b,1,1", r"e\.csv: row 2 must have 3 columns"),
        bad("no number", "v.csv", "a,20", "a,x", r"vehicle 'a': mass = 'x' is not a number"),
        bad("NaN", "v.csv", "a,20", "a,nan", r"vehicle 'a': mass = 'nan' is not finite"),
        bad("one vehicle twice", "v.csv", "\nb,", "\na,", r"vehicle 'a': two vehicles have this name"),
        bad("one leader link twice", "l.csv", "a,1", "a,1\na,2", r"l\.csv: vehicle 'a' is listed twice"),
        bad("an endless field", "e.csv", "a,b", f"{'a' * 200_000},b", r"e\.csv: line 2: field larger than"),
        bad("an unknown vehicle", "e.csv", "a,b", "a,c", r"there is no vehicle 'c'"),
        bad("a file that is not there", "fleet.toml", "'e.csv'", "'../e.csv'", r"\.\./e\.csv: cannot be read: No such"),
        bad("binary", "e.csv", "a,b,1\n", "\x00\x01\x02", r"e\.csv: row 2 must have 3 columns"),
    ]


def robots() -> list[Bad]:
    fleet = changed(FLEET, ("mass = 20\ninertia = 0.8\nhalf_track = 0.25\nwheel_radius = 0.08", 'urdf = "r.urdf"'))

    def bad(name: str, robot: Make, says: str) -> Bad:
        return Bad("URDF", name, CHECK, says, files={"fleet.toml": fleet, "r.urdf": robot})

    def but(old: str, new: str) -> str:
        return changed(ROBOT, (old, new))

    entity = '<!DOCTYPE r [<!ENTITY x SYSTEM "file:///etc/passwd">]><robot>&x;</robot>'
    return [
        bad("an external entity", entity, r"r\.urdf: is not safe XML: EntitiesForbidden"),
        bad("truncated", ROBOT[:400], r"r\.urdf: is not safe XML"),
        bad("binary", b"\xff\xfe\x00\x01", r"r\.urdf: is not UTF-8 text"),
        bad("nested deeply", "<a>" * 50_000, r"r\.urdf: is not safe XML"),
        bad("no links", "<robot/>", r"r\.urdf: has no <link>; a robot description needs a base and its wheels"),
        bad("no drive wheels", '<robot><link name="a"/></robot>', r"r\.urdf: has no drive wheels: two continuous"),
        bad(
            "a negative mass",
            but('<mass value="4"/>', '<mass value="-4"/>'),
            r"link 'base': <inertial> has the mass -4",
        ),
        bad("a mass of NaN", but('<mass value="4"/>', '<mass value="nan"/>'), r"r\.urdf: .*is not finite"),
        bad(
            "a wheel radius of zero",
            ROBOT.replace('radius="0.11"', 'radius="0"'),
            r"its wheel radius is 0 m; it must be > 0",
        ),
        bad("wheels that differ", but('radius="0.11"', 'radius="0.2"'), r"different radii, 0.11 m .* and 0.2 m"),
        bad("a loop of joints", but('link="base"/><child link="mast"', 'link="arm"/><child link="mast"'), r"a loop"),
        bad("ANSI escapes", f"<robot>{ESCAPE}", r"r\.urdf: is not safe XML"),
    ]


def gains() -> list[Bad]:
    heading, row = "vehicle,p_v,d_v,p_omega,d_omega,k_alpha\n", "1,20,0.5,10,0.5\n"

    def bad(name: str, file: str, content: Make, says: str) -> Bad:
        command = ("certify", "fleet.toml", "--gains", file, "-o", "out")
        return Bad("gains", f"{name} ({file.rpartition('.')[2]})", command, says, files={file: content})

    def toml(name: str, old: str, new: str, says: str) -> Bad:
        return bad(name, "gains.toml", changed(GAINS, (old, new)), rf"gains\.toml: .*{says}")

    def table(name: str, content: str, says: str) -> Bad:
        return bad(name, "g.csv", content, rf"g\.csv: {says}")

    other = json.dumps({"edges": [], "leader_links": {"a": 1, "b": 1}})
    return [
        toml("zero", "p_v = 1", "p_v = 0", r"vehicle 'a': p_v = 0 must be > 0"),
        toml("negative", "p_v = 1", "p_v = -1", r"p_v = -1 must be > 0"),
        toml("NaN", "p_v = 1", "p_v = nan", r"p_v = NaN is not finite"),
        toml("an infinity", "p_v = 1", "p_v = inf", r"p_v = Infinity is not finite"),
        toml("1e999999999", "p_v = 1", "p_v = 1e999999999", r"p_v = 1E\+999999999 has more than 60 digits"),
        toml("a huge integer", "p_v = 1", f"p_v = {HUGE}", r"p_v = \(too long to show\) is larger than 1e60"),
        toml("of one vehicle", "p_v = 1", "p_v = [1]", r"p_v must be a list of 2 numbers, one per vehicle"),
        toml("of three vehicles", "p_v = 1", "p_v = [1, 1, 1]", r"p_v must be a list of 2 numbers"),
        toml("a missing key", "p_v = 1\n", "", r"p_v must be a list of 2 numbers"),
        toml("an unknown key", "p_v = 1", "p_v = 1\np_w = 1", r"unknown key 'p_w'; a gains file has p_v, d_v"),
        toml("a constant psi", "k_alpha", "excitation = 3\nk_alpha", r"excitation: "),
        bad("another kind of file", "gains.txt", GAINS, r"gains\.txt: gains are read from \.json, \.csv and \.toml"),
        table("another heading", f"v,p\na,{row}", "has no column 'vehicle'"),
        table("a vehicle twice", f"{heading}a,{row}a,{row}b,{row}", "vehicle 'a' is listed twice"),
        table("an unknown vehicle", f"{heading}a,{row}b,{row}c,{row}", "vehicle 'c' is not in the fleet"),
        table("a vehicle without a row", f"{heading}a,{row}", "has no row for vehicle 'b'"),
        table("no number", f"{heading}a,x{row[1:]}b,{row}", "vehicle 'a': p_v = 'x' is not a number"),
        table("an endless field", f"{heading}a,{'1' * 200_000}\n", "line 2: field larger than field limit"),
        table("a short row", f"{heading}a,1\nb,{row}", "vehicle 'a': d_v = None is not a number"),
        bad("truncated", "design.json", design()[:-5], r"design\.json: is not JSON"),
        bad("nested deeply", "design.json", DEEP, r"design\.json: is not JSON: maximum recursion"),
        bad("an endless exponent", "design.json", f'{{"a": {ENDLESS}}}', r"design\.json: .*exponent is too large"),
        bad("no object gains", "design.json", "{}", r"design\.json: is not a design\.json: it has no object 'gains'"),
        bad("of another fleet", "design.json", design(fleet_digest="sha256:0"), r"was designed for another fleet"),
        bad("unknown conditions", "design.json", design(conditions="none"), r"conditions = 'none' is not known"),
        bad(
            "weights of other links", "design.json", design(weights=json.loads(other)), r"weights: .*design them again"
        ),
        Bad(
            *("gains", "of the paper's six vehicles", CERTIFY, r"p_omega must be a list of 2 numbers"),
            files={"gains.toml": changed(GAINS, ("p_omega = 0.5", "p_omega = [1, 2, 3, 4, 5, 6]"))},
        ),
        Bad(
            *("gains", "no psi in either file", CERTIFY, r"neither it nor the fleet file has an \[excitation\] table"),
            files={"fleet.toml": FLEET.replace(FLEET[FLEET.index("[exc") : FLEET.index("[graph")], "")},
        ),
    ]


def starts() -> list[Bad]:
    def bad(name: str, old: str, new: str, says: str) -> Bad:
        command = (*VALIDATE, "--starts-file", "s.csv")
        return Bad("starts file", name, command, rf"s\.csv: {says}", files={"s.csv": changed(STARTS, (old, new))})

    return [
        bad("empty", STARTS, "", "the first line must be start,vehicle,x,y,theta,v,omega"),
        bad("no start", STARTS[STARTS.index("0,a") :], "", "holds no start"),
        bad("a column too few", "0,a,1,", "0,a,", "row 2 must have 7 columns"),
        bad("an unknown vehicle", "0,b", "0,c", "row 3: start '0', vehicle 'c': the fleet has no such vehicle"),
        bad("a vehicle twice", "0,b", "0,a", "row 3: start '0', vehicle 'a': it is listed twice"),
        bad("a vehicle without a row", "0,b,2,2,3,0,0\n", "", "start '0' has no row for vehicle 'b'"),
        bad("NaN", "0,a,1", "0,a,nan", "row 2: a number is not finite"),
        bad("1e999999999", "0,a,1", "0,a,1e999999999", "row 2: a number has more than 60 digits"),
        bad("an endless field", "0,a,1", f"0,a,{'1' * 200_000}", "line 2: field larger than field limit"),
        bad("ANSI escapes", "0,b", f"0,{ESCAPE}b", r"row 3: start '0', vehicle '\\x1b\[31mb'"),
    ]


def certificates() -> list[Bad]:
    def bad(name: str, content: Make, says: str, code: int = 2, *more: str) -> Bad:
        return Bad("certificate", name, (*VERIFY, *more), says, code, files={"certificate.json": content})

    good = json.loads(certificate())
    other = changed(FLEET, ("mass = 20", "mass = 21"))
    return [
        bad("empty", "", r"certificate\.json.*is not JSON"),
        bad("truncated", certificate()[:-20], r"is not JSON"),
        bad("binary", bytes(range(256)), r"certificate\.json: .*is not JSON: 'utf-8' codec"),
        bad("nested deeply", DEEP, r"20000 quotes, commas, colons and brackets"),
        bad("NaN", '{"schema": NaN}', r"schema nan, not gaincert-certificate-2: certify again"),
        bad("a key twice", '{"a": 1, "a": 1}', r"a key is listed twice in one table"),
        bad("another schema", forged(schema="x"), r"schema 'x', not gaincert-certificate-2: certify again"),
        bad(
            "a number in floating point", forged(psi_bar=1.25), r"psi_bar: expected a string of 1 decimals .* not 1\.25"
        ),
        bad("a byte order mark", "\ufeff" + certificate(), r"is not JSON: Unexpected UTF-8 BOM"),
        bad("ANSI escapes", forged(conditions=ESCAPE), r"conditions must be one of paper, corrected, rate-bounded"),
        bad("a psi_bar too small", forged(psi_bar="0.1"), r"INVALID: psi_bounded: \|psi\| > psi_bar at ", 1),
        bad("no tree", forged(tree={"link": "1 1", "depth": "0 0"}), r"INVALID: well_formed: tree: link", 1),
        bad("no way to the leader", forged(tree={"link": "0 0", "depth": "0 0"}), r"INVALID: connected: vehicle 1", 1),
        bad(
            "gains beyond the torque limit",
            forged(gains={**good["gains"], "d_v": "2000 2000"}),
            r"INVALID: conditions: \(16\*\): vehicle 1: .* exceeds 12 by ",
            1,
        ),
        Bad(
            *("certificate", "of another fleet", (*VERIFY, "--fleet", "fleet.toml"), r"not of the fleet 'sha256:", 1),
            files={"certificate.json": certificate(), "fleet.toml": other},
        ),
    ]


def folders() -> list[Bad]:
    kind = "report and export folder"
    export, report = ("export", "out", "--format", "csv"), ("report", "out")
    table = "vehicle,p_v,d_v,p_omega,d_omega,k_alpha,torque_bound,torque_limit,margin\n"
    summary = '{"settling_time_s": null}'
    words = dict.fromkeys(("source", "statement", "method", "reason"), "")
    proof = json.dumps([{"id": "theorem", "status": "PROVED", **words}])
    lying = table + "a,1,1,1,1,1,1,0,1\n"
    return [
        Bad(kind, "not there", report, r"out: holds no certificate\.json, design\.json"),
        Bad(kind, "not there, to export", export, r"out: holds no fleet_copy\.toml; give the fleet file with --fleet"),
        Bad(kind, "of no design", (*export, "--fleet", "fleet.toml"), r"holds neither design\.json nor certificate"),
        Bad(kind, "a file in its place", report, r"out: holds no certificate\.json", files={"out": ""}),
        Bad(kind, "a forged certificate", export, r"certificate\.json: INVALID",
            files=certified_folder(certificate__json=forged(psi_bar="0.1"))),
        Bad(kind, "gains that were not certified", export, r"does not belong to the gains in design\.json",
            files=certified_folder(design__json=design(gains=json.loads(design())["gains"] | {"p_v": ["2", "2"]}))),
        Bad(kind, "a broken copy of the fleet", export, r"fleet_copy\.toml: is not TOML",
            files=certified_folder(fleet_copy__toml="x")),
        Bad(kind, "a summary that is no JSON", report, r"summary\.json: is not JSON", files={"out/summary.json": "{"}),
        Bad(kind, "a summary with little in it", report, r"not written by this version",
            files={"out/summary.json": summary}),
        Bad(kind, "a proof nested deeply", report, r"proof\.json: is not JSON", files={"out/proof.json": DEEP}),
        Bad(kind, "a validation of NaN", report, r"not written by this version",
            files={"out/validation.json": '{"starts": NaN}'}),
        Bad(kind, "a torque limit of zero in gains.csv", report, r"not written by this version \(ZeroDivisionError",
            files={"out/gains.csv": lying, "out/proof.json": proof}),
        Bad(kind, "an endless field in gains.csv", report, r"field larger than field limit",
            files={"out/gains.csv": table + "a" * 200_000, "out/proof.json": proof}),
        Bad(kind, "a trajectory that is no archive", report, r"trajectory\.npz: is no trajectory\.npz",
            files=certified_folder(trajectory__npz=b"PK\x03\x04")),
        Bad(kind, "a trajectory that claims 8 PB", report, r"trajectory\.npz: is no trajectory\.npz \(Unable to alloc",
            files=certified_folder(trajectory__npz=trajectory("(1000000000000000,)"))),
        Bad(kind, "a trajectory with a torn heading", report, r"trajectory\.npz: is no trajectory\.npz",
            files=certified_folder(trajectory__npz=trajectory("((((("))),
    ]  # fmt: skip


def unreadable() -> list[Bad]:
    def bad(name: str, path: str, says: str, *files: tuple[str, Make], not_for: str = "") -> list[Bad]:
        """Bad files that a command reads."""
        commands = {
            "fleet": ("check", path),
            "gains": ("certify", "fleet.toml", "--gains", path, "-o", "out"),
            "starts": (*VALIDATE, "--starts-file", path),
            "certificate": ("verify", path),
        }
        return [
            Bad("unreadable file", f"{name} ({what})", command, says, files=dict(files))
            for what, command in commands.items()
            if what != not_for
        ]

    return [
        *bad("a directory", "d.toml", r"d\.toml.*cannot be read: .*[Ii]s a directory", ("d.toml/x", "")),
        *bad("a dangling link", "l.toml", r"l\.toml.*cannot be read: .*No such file", ("l.toml", link_to("nowhere"))),
        *bad("a link to itself", "l.toml", r"l\.toml.*cannot be read: .*symbolic links", ("l.toml", link_to("l.toml"))),
        *bad("the memory of a process", "/proc/self/mem", r"/proc/self/mem.*(cannot be read|gains are read from)"),
        *bad(
            "a sparse 200 MB file",
            "s.csv",
            r"s\.csv.*(larger than 32 MiB|field larger|not JSON)",
            ("s.csv", sparse),
            not_for="starts",
        ),
        *bad("a name that no file may have", "x" * 300 + ".toml", r"cannot be read: .*File name too long"),
    ]


def outputs() -> list[Bad]:
    kind, command = "unwritable output", ("certify", "fleet.toml", "--gains", "gains.toml", "--conditions", "corrected")
    unwritable = r"{}.*: cannot be written: {}"

    def place(name: str, folder: str, says: str, **files: Make) -> Bad:
        return Bad(kind, name, (*command, "-o", folder), unwritable.format(re.escape(folder), says), files=files)

    full = r"cannot be written: File too large; free some space and try again"
    simulate = ("simulate", *GIVEN, "--horizon", "1")
    return [
        place("a file where DIR should be", "f", "f is a file, not a folder", f=""),
        place("a file above DIR", "f/out", "f is a file, not a folder", f=""),
        place("a device above DIR", "/dev/null/out", "(Not a directory|File exists)"),
        place("/proc", "/proc/out", "No such file"),
        place("a dangling link", "l", "File exists", l=link_to("nowhere/at/all")),
        place("a name too long", "x" * 300, "File name too long"),
        Bad(kind, "a directory where a file should be", (*command, "-o", "out"), r"certificate\.json: cannot be",
            files={"out/certificate.json/x": ""}),
        Bad(kind, "init over a file", ("init", "fleet.toml"), r"fleet\.toml: is already there"),
        Bad(kind, "init into /proc", ("init", "/proc/fleet.toml"), r"/proc/fleet\.toml: cannot be written"),
        Bad(kind, "full disk: certify", (*command, "-o", "out"), rf"certificate\.json: {full}", 5, quota=500),
        Bad(kind, "full disk: simulate", simulate, rf"trajectory\.npz: {full}", 5, quota=500),
        Bad(kind, "full disk: validate", VALIDATE, r"jsonl: cannot be written: File too large", 5, quota=100),
        Bad(kind, "full disk: export", ("export", "out", "--format", "csv"), full, 5, certified_folder(), 100),
        Bad(kind, "full disk: init", ("init", "new.toml"), rf"new\.toml: {full}", 5, quota=100),
        Bad(kind, "full disk: standard output", CHECK, r"standard output: .*No space left", 5, stdout="/dev/full"),
        Bad(kind, "full disk: JSON", (*CHECK, "--json", "-q"), r"output: .*No space left", 5, stdout="/dev/full"),
    ]  # fmt: skip


def options() -> list[Bad]:
    def bad(base: tuple[str, ...], more: str, says: str) -> Bad:
        return Bad("option", f"{base[0]} {more}", (*base, *more.split(" ")), says)

    def typed(base: tuple[str, ...], more: str, says: str) -> Bad:
        return bad(base, more, rf"Invalid value for '{more.split()[0]}': .*{says}")

    below, above, choice = "greater than or equal to", "less than or equal to", "is not one of"
    return [
        typed(SIMULATE, "--horizon -1", f"{below} 0.1"),
        typed(SIMULATE, "--horizon nan", "1000000"),
        typed(SIMULATE, "--horizon inf", f"{above} 1000000"),
        typed(SIMULATE, "--horizon soon", "valid number"),
        typed(SIMULATE, "--sample-time 0", f"{below} 0.0001"),
        typed(SIMULATE, "--sample-time nan", "10"),
        typed(SIMULATE, "--scheme open", f"'open' {choice} 'bounded', 'unbounded'"),
        typed(SIMULATE, "--engine steam", f"'steam' {choice} 'auto', 'cvodes', 'scale'"),
        bad(SIMULATE, "--tolerance nan 0.1", r"--tolerance nan 0\.1: both must be finite and > 0"),
        bad(SIMULATE, "--tolerance 0 0.1", r"--tolerance 0 0\.1: both must be"),
        bad(SIMULATE, "--tolerance 1e308 1", r"--tolerance 1e\+308 1: both must be finite"),
        bad(SIMULATE, "--tolerance 1", r"--tolerance'? requires 2 arguments"),
        typed(DESIGN, "--mode slow", f"'slow' {choice} 'draft', 'fast', 'best'"),
        typed(DESIGN, "--conditions none", f"'none' {choice} 'paper', 'corrected', 'rate-bounded'"),
        typed(DESIGN, "--digits 0", f"{below} 2"),
        typed(DESIGN, "--digits 99", f"{above} 15"),
        typed(DESIGN, "--seed -1", f"{below} 0"),
        typed(DESIGN, "--seed 1.5", "valid integer"),
        typed(DESIGN, "--time-limit nan", f"{below} 1"),
        bad(DESIGN, "--against none.csv", r"none\.csv: cannot be read"),
        typed(VALIDATE, "--starts 0", f"{below} 1"),
        typed(VALIDATE, "--workers 0", f"{below} 1"),
        typed(VALIDATE, "--box inf", f"{above} 1000000"),
        typed(VALIDATE, "--box -1", f"{below} 0"),
        typed(VALIDATE, "--integrator euler", f"'euler' {choice}"),
        bad(VALIDATE, "--scheduler nonsense", r"--scheduler nonsense: "),
        bad(VALIDATE, "--scheduler ", r"--scheduler : |--scheduler needs"),
        bad(VALIDATE, "--delay nan", r"delay = nan must be from 0 to 100"),
        bad(VALIDATE, "--mismatch 2", r"mismatch = 2\.0 must be from 0 to 0\.9"),
        bad(VALIDATE, "--friction -1 0", r"coulomb = -1\.0 must be from 0"),
        bad(VALIDATE, "--lost-link a c 1", r"the fleet has no vehicle 'c'"),
        bad(VALIDATE, "--lost-link a b nan", r"lost_at = nan must be from 0"),
        typed(("export", "out"), "--format word", f"'word' {choice} 'ros2', 'c'"),
        typed(("report", "out"), "--animate avi", f"'avi' {choice} 'gif', 'mp4'"),
        bad(("init", "new.toml"), "--vehicles 3", r"--vehicles 3: the paper's fleet has 6"),
        typed(("init", "new.toml"), "--vehicles 0", f"{below} 1"),
        bad(CHECK, f"--{ESCAPE}", r"No such option"),
        bad(CHECK, ESCAPE, r"unexpected extra argument"),
        bad((ESCAPE,), "x", r"No such command"),
        bad(("verify",), "--fleet fleet.toml", r"Missing argument 'CERTIFICATE\.json'"),
    ]


def verdicts() -> list[Bad]:
    """Valid input with a negative outcome: infeasible (3), false (1), undecided (4)."""
    kind = "false, infeasible or undecided"

    def fleet(*changes: tuple[str, str]) -> dict[str, Make]:
        return {"fleet.toml": changed(FLEET, *changes)}

    fast, turning = "heading_deg = 0, v = 2 }", "heading_deg = 180, omega = -3 }\nlimits = { turn_rate = 2 }"
    strong = {"gains.toml": changed(GAINS, ("d_v = 20", "d_v = 2000"))}
    return [
        Bad(kind, "a start beyond its speed limit", DESIGN, r"vehicle 'a': start v = 2 is beyond its certified limit 1",
            3, fleet(("heading_deg = 0 }", fast))),
        Bad(kind, "a start beyond its turn rate limit", DESIGN, r"vehicle 'b': start omega = -3 is beyond .* limit 2",
            3, fleet(("heading_deg = 180 }", turning))),
        Bad(kind, "gains beyond the torque limit", CERTIFY, r"'a': \(16\) is broken by .*; lower d_v", 1, strong),
        Bad(kind, "gains that break (15)", CERTIFY, r"vehicle 'a': \(15\) is broken by .*; ", 1,
            {"gains.toml": changed(GAINS, ("d_omega = 10", "d_omega = 0.1"))}),
        Bad(kind, "gains beyond a speed limit", CERTIFY, r"vehicle 'a': speed limit is broken by", 1,
            fleet(("speed = 1.0", "speed = 0.001"))),
        Bad(kind, "a mass that no integrator can follow", SIMULATE, r"the integrator gave up after t = 0 s", 4,
            fleet(("mass = 20", "mass = 1e-60"))),
    ]  # fmt: skip


def hostile_names() -> list[Bad]:
    """A vehicle may have any name: it reaches terminals and paths only as text."""
    names = {
        "path traversal": "../../evil",
        "ANSI escapes": f"{ESCAPE}red",
        "HTML": "<script>alert(1)</script>",
        "shell": "$(touch evil); `touch evil` | touch evil",
        "a CSV formula": '=HYPERLINK("http://x","y")',
        "a line break": "a\nerror: b\r",
        "markup of rich and of mathtext": "[red]$\\frac{",
    }
    kind, command = "hostile name", (*CERTIFY, "--conditions", "corrected")
    strong = changed(GAINS, ("d_v = 20", "d_v = 2000"))
    rows = []
    for what, name in names.items():
        fleet = named(name).replace('name = "two"', f"name = {json.dumps(name)}")
        lost = fleet.replace(f"{{ {json.dumps(name)} = 1 }}", "{ }")
        own: dict[str, Make] = {"fleet.toml": fleet}
        rows += [
            Bad(kind, f"{what}: check", CHECK, f"fleet +{re.escape(one_line(name))}\n", 0, own),
            Bad(kind, f"{what}: in an error", CHECK, "no path joins", files={"fleet.toml": lost}),
            Bad(kind, f"{what}: certify", command, "certificate: out", 0, own, writes=True),
            Bad(kind, f"{what}: gains", CERTIFY, "is broken by", 1, {**own, "gains.toml": strong}),
        ]
    drawn: dict[str, Make] = {"fleet.toml": named(f"[red]$\\frac{{{ESCAPE}")}
    return [*rows, Bad(kind, "drawn", SIMULATE, "figures: out", 0, drawn, writes=True)]


def named(name: str) -> str:
    """The good fleet with another name for its first vehicle."""
    quoted = json.dumps(name)
    return FLEET.replace('"a"', quoted).replace("{ a =", f"{{ {quoted} =")


KINDS = (
    *(fleets, tables, robots, gains, starts, certificates, folders),
    *(unreadable, outputs, options, verdicts, hostile_names),
)
ALL = [bad for of_kind in KINDS for bad in of_kind()]


@pytest.mark.parametrize("bad", ALL, ids=lambda bad: f"{bad.kind}: {bad.name}".encode("unicode_escape").decode()[:90])
def test_bad_input_is_one_message_an_exit_code_and_no_file(bad: Bad, tmp_path: Path) -> None:
    assert complaints(bad, tmp_path) == []


def test_every_input_has_a_name_of_its_own() -> None:
    assert len({(bad.kind, bad.name) for bad in ALL}) == len(ALL) > 110


def test_a_link_in_the_output_folder_is_replaced_and_not_followed(tmp_path: Path) -> None:
    bad = Bad("", "", (*CERTIFY, "--conditions", "corrected"), "certificate", 0, writes=True)
    (tmp_path / "out").mkdir()
    (tmp_path / "victim").write_text("mine")
    (tmp_path / "out" / "certificate.json").symlink_to(tmp_path / "victim")
    assert complaints(bad, tmp_path) == []
    assert (tmp_path / "victim").read_text() == "mine"
    assert not (tmp_path / "out" / "certificate.json").is_symlink()


@pytest.mark.parametrize("options", [(), ("--json", "-q")])
def test_a_reader_that_leaves_is_no_verdict(options: tuple[str, ...], tmp_path: Path) -> None:
    prepare(Bad("", "", (), ""), tmp_path)
    read, write = os.pipe()
    os.close(read)
    command = [sys.executable, "-m", "gaincert", *CHECK, *options]
    done = subprocess.run(command, stdout=write, stderr=subprocess.PIPE, text=True, check=False, cwd=tmp_path)
    os.close(write)
    assert (done.returncode, done.stderr) == (141, "")


def test_a_terminal_that_lacks_a_character_gets_its_escape(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "gaincert", "init", "é.toml"]
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=tmp_path, env=environment)
    assert done.stdout.startswith(r"wrote \xe9.toml")


def test_a_name_with_a_line_break_is_read_back_from_gains_csv(tmp_path: Path) -> None:
    name = 'x\r\ny\u2028z,"'
    rows = [[vehicle, "1", "20", "0.5", "10", "0.5"] for vehicle in (name, "b")]
    with (tmp_path / "gains.csv").open("w", newline="") as file:
        csv.writer(file).writerows([["vehicle", "p_v", "d_v", "p_omega", "d_omega", "k_alpha"], *rows])
    (tmp_path / "fleet.toml").write_text(named(name))
    command = ("certify", "fleet.toml", "--gains", "gains.csv", "-o", "out", "--conditions", "corrected")
    code, out, err = gaincert(*command, cwd=tmp_path)
    assert code == 0, out + err


def test_a_large_table_of_wrong_names_is_refused_soon() -> None:
    begin = time.monotonic()
    mistakes = graph_mistakes(
        [f"v{i}" for i in range(5000)], [(f"w{i}", f"w{i + 1}") for i in range(20_000)], {"v0": 1}
    )
    assert len(mistakes) == 40_000
    assert time.monotonic() - begin < 20


def markdown() -> str:
    """The table: how many inputs of each kind there are, and how many behaved."""
    counts: dict[str, list[int]] = {}
    for bad in ALL:
        with tempfile.TemporaryDirectory() as above:
            folder = Path(above) / "work"
            folder.mkdir()
            wrong = complaints(bad, folder)
        count = counts.setdefault(bad.kind, [0, 0])
        count[0] += 1
        count[1] += not wrong
        for line in wrong:
            sys.stderr.write(f"{bad.kind}: {bad.name!r}: {line}\n")
    rows = [*counts.items(), ("**all**", list(map(sum, zip(*counts.values(), strict=True))))]
    lines = [f"| {kind} | {number} | {behaved} |" for kind, (number, behaved) in rows]
    return "\n".join(["| kind | inputs | behaved |", "|---|---|---|", *lines])


if __name__ == "__main__":
    print(markdown())
