"""The scripts of the gallery run and print the expected results."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

GALLERY = Path(__file__).parents[2] / "examples" / "gallery"


def output(script: str, folder: Path) -> str:
    done = subprocess.run([sys.executable, GALLERY / script], capture_output=True, text=True, cwd=folder, check=True)
    return done.stdout


def test_every_script_of_the_gallery_is_tested() -> None:
    assert {path.name for path in GALLERY.glob("*.py")} == {"repair_gains.py", "leaders.py", "tail.py"}


def test_repair_gains(tmp_path: Path) -> None:
    text = output("repair_gains.py", tmp_path)
    assert "the paper's gains: True" in text
    assert "twice the excitation: False" in text
    assert "vehicle 'v1': (15) is broken by" in text


def test_more_leaders_are_faster(tmp_path: Path) -> None:
    values = [float(value) for value in re.findall(r"(\d\.\d+)$", output("leaders.py", tmp_path), re.MULTILINE)]
    assert values[:4] == sorted(values[:4])
    assert values[5] > values[4]


@pytest.mark.slow
def test_the_tail_is_that_of_the_averaged_flow(tmp_path: Path) -> None:
    simulated, averaged = map(float, re.findall(r"([\d.]+) m\b", output("tail.py", tmp_path)))
    assert simulated == pytest.approx(averaged, rel=0.01)
    assert (tmp_path / "tail.png").stat().st_size > 0
