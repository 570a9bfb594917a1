"""The README agrees with the program."""

import json
import re
import statistics
import subprocess
import sys
import tomllib
from dataclasses import replace
from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest
from gaincert.models.arrays import floats
from gaincert.models.conditions import float_numbers, torque_bound
from gaincert.models.files.fleet_file import parse
from gaincert.models.fleet import Fleet
from gaincert.models.gains import Gains

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text()


def block(language: str) -> str:
    (found,) = re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)
    return found


def test_the_fleet_in_the_readme_is_a_fleet() -> None:
    fleet = parse(tomllib.loads(block("toml"), parse_float=Decimal))
    assert [vehicle.name for vehicle in fleet.vehicles] == ["a", "b"]


def test_every_command_in_the_readme_is_a_command() -> None:
    """Each `gaincert` line parses: its verb and its options exist."""
    helps: dict[str, str] = {}
    for verb, rest in re.findall(
        r"gaincert (init|check|prove|design|certify|verify|simulate|validate|export|report|run)\b([^|\n`]*)", README
    ):
        if verb not in helps:
            done = subprocess.run([sys.executable, "-m", "gaincert", verb, "--help"], capture_output=True, text=True)
            helps[verb] = done.stdout
        for option in re.findall(r"(?<!\S)--?[a-z][a-z-]*", rest):
            assert option in helps[verb], (verb, option)


def test_every_file_that_the_readme_names_is_there() -> None:
    for path in re.findall(r"(?:examples|docs|verify|models)/[\w./]+", README):
        assert (ROOT / path.rstrip(".")).exists(), path


def test_the_python_example_runs() -> None:
    """With a short search."""
    script = block("python").replace('conditions="corrected")', 'conditions="corrected", mode="draft")', 1)
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    assert "VALID" in done.stdout
    assert re.search(r"^\d[\d.]* s$", done.stdout, re.MULTILINE)


def printed_table() -> list[tuple[str, list[float]]]:
    rows = [line.split() for line in block("text").splitlines() if re.match(r" v\d", line)]
    return [(name, [float(value) for value in values]) for name, *values in rows]


def test_the_bounds_in_the_gain_table_follow_from_its_gains(paper: Fleet) -> None:
    assert [name for name, _ in printed_table()] == list(paper.names)
    columns = np.array([values for _, values in printed_table()]).T
    (psi_bar,) = re.findall(r"\|psi\| <= (\S+),", block("text"))
    limits = replace(paper.condition_data(paper.psi).map(floats), psi_bar=float(psi_bar))
    gains = Gains(*columns[:5])
    bound, limit, margin = columns[-3:]  # between them the scales s and o, which are in no torque condition
    assert bound == pytest.approx(torque_bound(float_numbers(), limits, gains), rel=2e-3)
    assert limit == pytest.approx(limits.torque)
    assert margin == pytest.approx(limit - bound, abs=0.05)


@pytest.mark.slow
def test_the_design_settles_as_the_readme_says(tmp_path: Path) -> None:
    """On another processor the search may end at other gains; they settle the fleet as fast, to a quarter."""
    command = [sys.executable, "-m", "gaincert", "design", "examples/paper.toml", "-o", str(tmp_path), "--json"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=True)
    times = json.loads(done.stdout)["measured_settling_s"]
    ((starts, median),) = re.findall(r"from (\d+) starts: median (\d+) s", block("text"))
    assert len(times) == int(starts)
    assert statistics.median(times) == pytest.approx(float(median), rel=0.25)
