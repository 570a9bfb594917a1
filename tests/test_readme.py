"""What README says is what the program does."""

import json
import re
import subprocess
import sys
import tomllib
from decimal import Decimal
from pathlib import Path

import pytest
from gaincert.models.fleet_file import parse

ROOT = Path(__file__).parent.parent
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
    """Without the search, which other tests run."""
    script = f"import gaincert.synthesis.design as part; part.SEARCHED_VEHICLES = 0\n{block('python')}"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    assert "VALID" in done.stdout
    assert "settling_time_s" in done.stdout


@pytest.mark.slow
def test_the_gain_table_is_the_programs(tmp_path: Path) -> None:
    """The last digits may move with the solvers' versions; the table is the program's to 2 %."""
    command = [sys.executable, "-m", "gaincert", "design", "examples/paper.toml", "-o", str(tmp_path), "--json"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=True)
    gains = json.loads(done.stdout)["gains"]
    rows = [line.split() for line in block("text").splitlines() if re.match(r" v\d", line)]
    for i, (name, *printed) in enumerate(rows):
        assert name == f"v{i + 1}"
        assert [float(value) for value in printed[:5]] == pytest.approx(
            [float(column[i]) for column in gains.values()], rel=0.02
        )
