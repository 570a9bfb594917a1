"""The kernel alone on hostile files: a verdict or a refusal in words, in bounded time and memory."""

import json
import subprocess
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from gaincert.models.paper import paper_excitation, paper_fleet, paper_gains
from gaincert.verify.certificates.certify import certify

KERNEL = Path(__file__).parents[2] / "verify" / "kernel.py"
MANY = 10**6
SECONDS = 5.0  # of processor time: the machine may be busy
MEGABYTES = 300

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


@cache
def text() -> str:
    return certify(paper_fleet(), paper_excitation(), paper_gains(), "paper").to_json()


def with_number(number: str) -> str:
    """The certificate with other characters where psi_bar stands."""
    return text().replace(json.dumps(json.loads(text())["psi_bar"]), number, 1)


def with_graph(**change: Any) -> str:
    content = json.loads(text())
    content["fleet"]["graph"].update(change)
    return json.dumps(content)


def with_fleet(**change: Any) -> str:
    content = json.loads(text())
    content["fleet"].update(change)
    return json.dumps(content)


def with_vehicles(count: int) -> str:
    return with_fleet(vehicle=[json.loads(text())["fleet"]["vehicle"][0]] * count)


def with_tones(**change: Any) -> str:
    return with_fleet(excitation={"mean": "0", "frequency": "1", **change})


HOSTILE: dict[str, tuple[Callable[[], str], str]] = {
    "deep lists": (lambda: '{"a":' + "[" * MANY + "]" * MANY + "}", "nested too deeply"),
    "deep tables": (lambda: '{"a":' * MANY + "1" + "}" * MANY, "nested too deeply"),
    "deep and not finished": (lambda: "[" * (20 * MANY), "nested too deeply"),
    "an integer of a million digits": (lambda: with_number("9" * MANY), "an integer is too long"),
    "a decimal of a million digits": (lambda: with_number('"0.' + "9" * MANY + '"'), "not a decimal number"),
    "an exponent": (lambda: with_number("1e999999999"), "must be written as a decimal string"),
    "a negative exponent": (lambda: with_number("-1e-999999999"), "must be written as a decimal string"),
    "an exponent in a string": (lambda: with_number('"1e999999999"'), "not a decimal number"),
    "an edge a million times": (lambda: with_graph(edges=[["v1", "v2", "1"]] * MANY), "two known vehicles, and once"),
    "a million loops": (lambda: with_graph(edges=[["v1", "v1", "1"]] * MANY), "two known vehicles, and once"),
    "links of strangers": (lambda: with_graph(leader_links={f"x{i}": "1" for i in range(MANY)}), "known vehicles"),
    "a key a million times": (lambda: "{" + ",".join(['"a":1'] * MANY) + "}", "a key stands twice"),
    "a million unknown keys": (lambda: "{" + ",".join(f'"a{i}":1' for i in range(MANY)) + "}", "expected a table"),
    "a vehicle many times": (lambda: with_vehicles(MANY // 20), "two vehicles have one name"),
    "a million harmonics": (lambda: with_tones(family="harmonics", sin=["1"] * MANY, cos=[]), "at most 200 harmonics"),
    "terms without end": (lambda: with_tones(family="square-wave", terms=10**100), "terms must be 1 to 100"),
    "numbers": (lambda: "[" + "1," * (5 * MANY) + "1]", "expected a table"),
    "more values than are read": (lambda: "{" + "," * (70 * MANY), "64000000 values"),
    "a string without end": (lambda: '{"a":"' + "x" * (50 * MANY), "not JSON"),
    "a long name": (lambda: text().replace('"v1"', '"' + "v" * (5 * MANY) + '"'), "INVALID"),
}


@pytest.mark.needs("proc")
@pytest.mark.parametrize("kind", HOSTILE)
def test_hostile_files_cost_little(kind: str, tmp_path: Path) -> None:
    write, words = HOSTILE[kind]
    path = tmp_path / "certificate.json"
    path.write_text(write())
    command = [sys.executable, "-I", "-c", PROGRAM, str(KERNEL), str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
    verdict, _, used = done.stdout.rpartition("USED")
    seconds, megabytes = map(float, used.split())
    assert done.returncode in (1, 2)
    assert words in verdict + done.stderr
    assert "Traceback" not in done.stderr
    assert len(verdict + done.stderr) < 1000
    assert seconds < SECONDS
    assert megabytes < MEGABYTES
