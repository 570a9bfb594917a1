"""The README agrees with the program."""

import re
import subprocess
import sys
import tomllib
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from gaincert.models.arrays import floats
from gaincert.models.conditions import float_numbers, torque_bound
from gaincert.models.files.fleet_file import parse
from gaincert.models.fleet import Fleet
from gaincert.models.gains import Gains
from gaincert.models.paper import paper_fleet
from gaincert.models.saturation import Saturation
from gaincert.models.starts import Draw
from gaincert.synthesis.measurement import StartSet, controls_of, measure_all
from gaincert.synthesis.programs.excitation import at_frequency, flat_tones
from gaincert.synthesis.settings import FAST
from gaincert.synthesis.task import Candidate, Options, prepare

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


def rows_of_gains() -> list[list[str]]:
    """The rows of the printed table without the names of the vehicles."""
    return [line.split()[1:] for line in block("text").splitlines() if re.match(r" v\d", line)]


def test_the_bounds_in_the_gain_table_follow_from_its_gains(paper: Fleet) -> None:
    columns = np.array(rows_of_gains(), dtype=float).T
    assert columns.shape[1] == len(paper)
    (psi_bar,) = re.findall(r"\|psi\| <= (\S+),", block("text"))
    limits = replace(paper.condition_data(paper.psi).map(floats), psi_bar=float(psi_bar))
    gains = Gains(*columns[:5])
    bound, limit, margin = columns[-3:]  # between them the scales s and o, which are in no torque condition
    assert bound == pytest.approx(torque_bound(float_numbers(), limits, gains), rel=2e-3)
    assert limit == pytest.approx(limits.torque)
    assert margin == pytest.approx(limit - bound, abs=0.05)


def test_the_gains_in_the_readme_settle_the_fleet_as_it_says() -> None:
    """From the starts of its ranking; all digits of the gains and scales are printed."""
    columns = [np.array([Fraction(str(value)) for value in column]) for column in zip(*rows_of_gains(), strict=True)]
    text = block("text")
    (scales,) = re.findall(r"scales: position (\S+) m, heading (\S+) rad", text)
    gains = Gains(*columns[:5], saturation=Saturation(*map(Fraction, scales), columns[5], columns[6]))
    (frequency,) = re.findall(r"(\S+) rad/s$", text, re.MULTILINE)[-1:]
    psi = at_frequency(flat_tones(), Fraction(frequency))
    task = prepare(paper_fleet(), Options("paper", "designed"), FAST)
    starts = StartSet.both(task.far_starts(Draw.RANKING, FAST.ranking_starts))
    controls = controls_of([Candidate("README", gains, psi)])
    measured = measure_all(task.setup, controls, starts, 1000.0, None).time.reshape(2, -1)
    printed = np.array(re.findall(r"median (\d+) s, worst (\d+) s", text), dtype=float)
    assert np.median(measured, axis=1) == pytest.approx(printed[:, 0], abs=1)
    assert measured.max(axis=1) == pytest.approx(printed[:, 1], rel=0.1)
