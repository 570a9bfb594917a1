"""The search is anytime: an interrupt ends it with the best so far, and its clock is kept."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from gaincert.models.paper import paper_fleet
from gaincert.synthesis import search as search_module
from gaincert.synthesis.design import design
from gaincert.synthesis.measure import Measured, cost
from gaincert.synthesis.rollout import Settling
from gaincert.verify.dispatch import local

ROOT = Path(__file__).parent.parent


@pytest.mark.slow
def test_the_search_never_ends_worse_than_it_began(monkeypatch: pytest.MonkeyPatch) -> None:
    """The incumbents are ranked with the finds, on starts that the search has not tuned to; same seed, same gains."""
    monkeypatch.setattr(search_module, "GENERATIONS", 2)
    monkeypatch.setattr(search_module, "SHORT_GENERATIONS", 2)
    monkeypatch.setattr(search_module, "TRAINING_STARTS", 2)
    asked = {"conditions": "corrected", "excitation": "designed", "time_limit": 300}
    with local() as (executor, _):
        fast = design(paper_fleet(), executor=executor, **asked)  # type: ignore[arg-type]
        best, again = (design(paper_fleet(), mode="best", executor=executor, **asked) for _ in range(2))  # type: ignore[arg-type]
    assert max(best.settling) <= 1.5 * max(fast.settling)
    assert sum(best.settling) <= 1.2 * sum(fast.settling)
    assert all((a == b).all() for a, b in zip(best.gains.__dict__.values(), again.gains.__dict__.values(), strict=True))


@pytest.mark.slow
def test_an_interrupted_search_writes_the_best_so_far(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "gaincert", "design", "examples/paper.toml", "-o", str(tmp_path)]
    options = ["--conditions", "corrected", "--mode", "best", "--time-limit", "500"]
    with subprocess.Popen(
        [*command, *options],
        cwd=ROOT,
        stderr=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as running:
        time.sleep(30)
        os.killpg(running.pid, signal.SIGINT)  # as a terminal does: to every process
        out, err = running.communicate(timeout=120)
    assert running.returncode == 0, err
    assert "Traceback" not in err
    assert "settles within" in out
    assert (tmp_path / "design.json").exists()


def test_a_start_that_never_settles_costs_more_than_any_that_does() -> None:
    good = Measured([Settling(10.0, 0.5), Settling(90.0, 0.9)], [50.0])
    bad = Measured([Settling(10.0, 0.5), Settling(float("inf"), 2.0)], [50.0])
    assert cost(good, 100.0) < cost(bad, 100.0)
    endless = Measured(good.runs, [float("inf")])
    assert cost(good, 100.0) < cost(endless, 100.0) < float("inf")
