"""The kernel alone on hostile files of up to 36 MB: a verdict or a refusal in words, in bounded time and memory."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.verify.certificate_documents import Document, harmonics, single

KERNEL = Path(__file__).parents[2] / "verify" / "kernel.py"
MANY = 10**6
SIZE = 36 * MANY  # bytes
SECONDS = 10.0  # of processor time on a quiet machine
BUSY = 3  # times as long where other programs take the caches
MEGABYTES = 600

# The largest memory of this program alone: what getrusage says of a child counts the parent's before it began.
PROGRAM = """
import re, resource, runpy, sys
sys.argv = sys.argv[1:]
try:
    runpy.run_path(sys.argv[0], run_name="__main__")
finally:
    used = resource.getrusage(resource.RUSAGE_SELF)
    with open("/proc/self/status") as status:
        largest = int(re.search(r"VmHWM:\\s+(\\d+)", status.read())[1]) / 1024
    print("\\nUSED", used.ru_utime + used.ru_stime, largest)
"""


def with_number(number: str) -> str:
    """The certificate with other characters where psi_bar is."""
    return json.dumps(single()).replace('"psi_bar": "1"', f'"psi_bar": {number}', 1)


def with_fleet(**change: Any) -> str:
    content = single()
    content["fleet"].update(change)
    return json.dumps(content)


def repeated(text: str, count: int) -> str:
    return " ".join([text] * count)


def many_vehicles(count: int, value: str, **more: str) -> Document:
    """A certificate of vehicles that are all alike, each led."""
    content = single()
    fleet, gains = content["fleet"], content["gains"]
    fleet["vehicles"] = count
    for name in ("mass", "inertia", "half_track", "wheel_radius", "torque_left", "torque_right"):
        fleet[name] = repeated(value, count)
    for name in ("offset_x", "offset_y", "wheel_inertia"):
        fleet[name] = repeated("0", count)
    fleet["leader_links"] = {"vehicle": " ".join(map(str, range(count))), "weight": repeated(value, count)}
    for name in gains:
        gains[name] = value if name in ("position_scale", "heading_scale") else repeated(more.get(name, value), count)
    content["tree"] = {"link": repeated("-1", count), "depth": repeated("0", count)}
    content["margins"] = {"(16*)": repeated("0", count)}
    return content


def with_edges(vehicles: int, tail: str, head: str, weight: str) -> str:
    content = many_vehicles(vehicles, "9")
    content["fleet"]["edges"] = {"tail": tail, "head": head, "weight": weight}
    return json.dumps(content)


def large_and_true() -> str:
    """As many vehicles as 36 MB hold, all conditions true, with two rates."""
    count = 620_000
    content = many_vehicles(count, "9")
    content["fleet"] |= dict.fromkeys(("torque_left", "torque_right"), repeated("9999999", count))
    for name in ("gamma_v", "gamma_omega"):
        content["rates"][name] = {"rate": "0.001", "vector": repeated("1", count)}
    text = json.dumps(content)
    assert SIZE * 0.9 < len(text) < SIZE * 1.1, len(text)
    return text


def large_with_long_numbers() -> str:
    """One number of many places makes all the others long."""
    count = 190_000
    content = many_vehicles(count, "9")
    content["fleet"] |= dict.fromkeys(("torque_left", "torque_right"), repeated("9999999", count))
    content["psi_bar"] = "1." + "0" * 99 + "1"
    for name in ("gamma_v", "gamma_omega"):
        content["rates"][name] = {"rate": "0.001", "vector": repeated("9" * 40, count)}
    return json.dumps(content)


def large_with_limits() -> str:
    """As many vehicles as 36 MB hold with speed and turn-rate limits, all true."""
    count = 400_000
    content = many_vehicles(count, "9", d_v="9999999", d_omega="9999999")
    content["fleet"] |= dict.fromkeys(("torque_left", "torque_right"), repeated("9999999999", count))
    for name in ("speed", "turn_rate"):
        values = " ".join([str(1 + i % 900) for i in range(count)])
        content["fleet"]["limits"][name] = {"vehicle": " ".join(map(str, range(count))), "value": values}
        content["margins"][name] = repeated("0", count)
    return json.dumps(content)


def large_graph() -> str:
    """As many links as 36 MB hold, between 3000 vehicles."""
    count = 3000
    pairs = [(i, j) for i in range(count) for j in range(i + 1, count)][:2_400_000]
    content = many_vehicles(count, "9")
    tail, head = (" ".join([str(pair[end]) for pair in pairs]) for end in (0, 1))
    content["fleet"]["edges"] = {
        "tail": tail,
        "head": head,
        "weight": " ".join([str(i) for i in range(1, len(pairs) + 1)]),
    }
    return json.dumps(content)


Write = Callable[[], str]
HOSTILE: dict[str, tuple[Write, str]] = {
    "deep lists": (lambda: '{"a":' + "[" * MANY + "]" * MANY + "}", "20000 quotes, commas, colons and brackets"),
    "deep tables": (lambda: '{"a":' * MANY + "1" + "}" * MANY, "20000 quotes, commas, colons and brackets"),
    "deep and not finished": (lambda: "[" * SIZE, "20000 quotes"),
    "just not too deep": (lambda: "[" * 20_000, "nested too deeply"),
    "an integer of a million digits": (lambda: with_number("9" * MANY), "not JSON: Exceeds the limit"),
    "a decimal of a million digits": (lambda: with_number('"0.' + "9" * MANY + '"'), "digits after the point"),
    "a number of a million digits": (lambda: with_number('"' + "9" * MANY + '"'), "expected a string of 1 decimals"),
    "an exponent": (lambda: with_number("1e999999999"), "expected a string of 1 decimals"),
    "a negative exponent": (lambda: with_number("-1e-999999999"), "expected a string of 1 decimals"),
    "an exponent in a string": (lambda: with_number('"1e999999999"'), "expected a string of 1 decimals"),
    "an edge ten million times": (
        lambda: with_edges(10_000, repeated("0", 9 * MANY), repeated("1", 9 * MANY), "1"),
        "edges must be in rising order",
    ),
    "an edge of two vehicles often": (
        lambda: with_edges(2, *[repeated("1", 6 * MANY)] * 3),
        "6000000 links between 2 vehicles are too many",
    ),
    "distinct keys": (
        lambda: "{" + ",".join([f'"{i:08}":"1234567890123456789012345678901"' for i in range(700_000)]) + "}",
        "20000 quotes",
    ),
    "a key a million times": (lambda: "{" + ",".join(['"a":1'] * MANY) + "}", "20000 quotes"),
    "a key a thousand times": (lambda: "{" + ",".join(['"a":1'] * 1000) + "}", "a key is listed twice"),
    "a thousand unknown keys": (lambda: "{" + ",".join(f'"a{i}":1' for i in range(1000)) + "}", "certify again"),
    "vehicles without end": (lambda: with_fleet(vehicles=10**100), "vehicles with 1 digits"),
    "vehicles without columns": (lambda: with_fleet(vehicles=9 * MANY), "expected a string of 9000000 decimals"),
    "a million harmonics": (lambda: with_fleet(excitation=harmonics(repeated("1", MANY))), "at most 200 harmonics"),
    "terms without end": (
        lambda: with_fleet(excitation={"family": "square-wave", "mean": "0", "frequency": "1", "terms": 10**100}),
        "terms must be 1 to 100",
    ),
    "arcs without end": (
        lambda: json.dumps(single(arcs={"here": repeated("20", 6 * MANY), "opposite": repeated("20", 6 * MANY)})),
        "arcs: expected a string of 750000 decimals",
    ),
    "a string without end": (lambda: '{"a":"' + "x" * SIZE, "not JSON"),
    "a long column": (lambda: with_fleet(mass=repeated("1", SIZE // 2)), "mass: expected a string of 1 decimals"),
    "a long text": (lambda: with_fleet(drive="x" * SIZE), "drive one of"),
    "a long schema": (lambda: json.dumps({"schema": "x" * SIZE}), "certify again"),
    "much white space": (lambda: json.dumps(single()) + " " * SIZE, "VALID"),
    "as many vehicles as it holds": (large_and_true, "VALID"),
    "long numbers": (large_with_long_numbers, "VALID"),
    "limits for all": (large_with_limits, "VALID"),
    "as many links as it holds": (large_graph, "INVALID"),
}


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="memory is read from /proc")
@pytest.mark.parametrize("kind", HOSTILE)
def test_hostile_files_cost_little(kind: str, tmp_path: Path) -> None:
    write, words = HOSTILE[kind]
    path = tmp_path / "certificate.json"
    path.write_text(write())
    command = [sys.executable, "-I", "-c", PROGRAM, str(KERNEL), str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=240)
    verdict, _, used = done.stdout.rpartition("USED")
    seconds, megabytes = map(float, used.split())
    said = (verdict + done.stderr).strip()
    assert done.returncode == {"VALID": 0, "INVALID": 1, "REFUSED": 2}[said.partition("\n")[0].partition(":")[0]]
    assert words in said, said[:300]
    assert "Traceback" not in done.stderr
    assert len(done.stderr) < 1000 and len(verdict) < 5000
    assert seconds < BUSY * SECONDS
    assert megabytes < MEGABYTES
