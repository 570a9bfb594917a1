"""Validation over many starts: stored as it goes, resumed, replayed to the last bit, the same on a cluster."""

import json
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import Executor, Future
from pathlib import Path

import numpy as np
import pytest
from gaincert.models.equations import State
from gaincert.models.errors import InputError, UndecidedError
from gaincert.models.starts import random_starts
from gaincert.models.tolerance import Tolerance
from gaincert.parallel import cluster, in_turn, local
from gaincert.verify.simulation.chaos_aware import CALM, GATHERED, OPENING, Staged
from gaincert.verify.simulation.integrators import Adams
from gaincert.verify.simulation.loop import Loop
from gaincert.verify.simulation.simulate import simulate, summarize
from gaincert.verify.validation.results_file import Ledger
from gaincert.verify.validation.statistics import SENSITIVE, sentences, spread
from gaincert.verify.validation.statistics import summarize as summarize_all
from gaincert.verify.validation.validate import Question, ask, origin_of_states, replay, run_start, validate

ROOT = Path(__file__).parents[2]
FAST = {  # a design under (16*) alone
    "excitation": {"family": "harmonics", "frequency": "2.318", "sin": ["1.2071", "0", "0.2803", "0", "0.0732"]},
    "gains": {
        "p_v": ["93.73", "14.42", "337.4", "51.91", "215.5", "215.5"],
        "d_v": ["43.74", "43.74", "157.4", "157.4", "100.6", "100.6"],
        "p_omega": ["8.649", "1.33", "45.05", "6.93", "26.85", "26.85"],
        "d_omega": ["6.826", "6.826", "35.55", "35.55", "21.19", "21.19"],
        "k_alpha": ["30.55", "4.701", "159.1", "24.48", "94.85", "94.85"],
    },
}


class Here(Executor):
    """Runs a job where it is submitted."""

    def submit(self, function, /, *args, **kwargs):
        future: Future = Future()
        future.set_result(function(*args, **kwargs))
        return future


def fast_gains(folder: Path) -> Path:
    path = folder / "fast.json"
    path.write_text(json.dumps(FAST))
    return path


@pytest.fixture(scope="module")
def chosen(tmp_path_factory):
    from gaincert.models.files.gains_file import load_gains
    from gaincert.models.paper import paper_fleet

    return load_gains(fast_gains(tmp_path_factory.mktemp("gains")), paper_fleet())


def question(fleet, chosen, horizon=60.0, tolerance=Tolerance(1.0, 1.0), method="auto", seed=3) -> Question:  # noqa: B008
    origin = {"random": {"seed": seed, "box_m": 40.0}}
    return ask(
        fleet,
        chosen.gains,
        chosen.excitation,
        origin,
        horizon=horizon,
        tolerance=tolerance,
        method=method,
        versions={},
    )


def gaincert(*arguments: object) -> list[str]:
    return [sys.executable, "-m", "gaincert", *map(str, arguments)]


def test_one_start_settles_when_simulate_says_so(paper, chosen) -> None:
    asked = question(paper, chosen)
    start = random_starts(paper, 2, 3, 20.0)[1]
    result = run_start(asked, 1, start)
    shown = simulate(paper, chosen.gains, chosen.excitation, start=start, horizon=60)
    summary = summarize(paper, shown, asked.tolerance)
    assert result["settling_time_s"] == pytest.approx(summary["settling_time_s"], abs=1e-4)
    assert result["peak_torque_ratio"]["value"] == pytest.approx(summary["peak_torque_ratio"], rel=1e-5)
    assert result["violations"] == summary["violations"] == []
    assert 0 < result["physical_limit_s"] < result["settling_time_s"]


def test_an_independent_integrator_gives_the_same_numbers(paper, chosen) -> None:
    start = random_starts(paper, 1, 3, 20.0)[0]
    one, other = (run_start(question(paper, chosen, method=name), 0, start) for name in ("auto", "dop853"))
    assert one["settling_time_s"] == pytest.approx(other["settling_time_s"], rel=0.02)
    assert one["peak_torque_ratio"]["value"] == pytest.approx(other["peak_torque_ratio"]["value"], rel=0.02)


def test_a_calm_start_is_integrated_economically(paper, gains_of_paper) -> None:
    """Where two rough runs agree nothing is spent on accuracy; the error is far below what they differ by."""
    loop = Loop.of(paper, gains_of_paper, paper.psi)
    staged = Staged(loop, step=0.25, piece=60.0, tolerance=1e-8)
    start = random_starts(paper, 1, 777, 30.0)[0]
    t, states = next(staged.pieces(start))
    _, reference = next(Adams(loop, step=0.25, piece=60.0, tolerance=1e-15).pieces(start))
    assert t[-1] == 60.0
    assert 0 < np.abs(states.x - reference.x).max() < 0.01 * staged.apart < 0.01 * CALM


def test_a_chaotic_start_is_integrated_accurately_until_the_fleet_has_gathered(paper, chosen) -> None:
    loop = Loop.of(paper, chosen.gains, chosen.excitation)
    staged = Staged(loop, step=0.25, piece=100.0, tolerance=1e-8)
    start = random_starts(paper, 5, 3, 30.0)[4]
    times, lengths = [0.0], []
    for t, states in staged.pieces(start):
        times += t.tolist()
        lengths.append(round(t[-1] - times[-len(t) - 1]))
        away = loop.offsets(State(*(column[-1] for column in states)))
        if lengths[-1] > OPENING:
            break
        near = max(np.hypot(away.x, away.y).max(), np.abs(away.theta).max()) < GATHERED
        assert near == (lengths == [OPENING, OPENING])
    assert lengths == [OPENING, OPENING, 100]
    assert np.diff(times) == pytest.approx(0.25)
    assert 0 < staged.apart < 1e-3


@pytest.mark.slow
def test_a_chaotic_start_has_the_same_time_in_both_integrators_or_is_called_sensitive(paper, chosen) -> None:
    """From 60 m a difference of 1e-12 can grow to metres: only runs at the limit of doubles agree."""
    starts = random_starts(paper, 5, 3, 30.0)
    results = []
    for number in (1, 2, 4):
        asked = (question(paper, chosen, horizon=80.0, method=name) for name in ("auto", "dop853"))
        one, other = (run_start(each, number, starts[number]) for each in asked)
        results.append(one)
        if one["sensitivity_m"] < SENSITIVE:
            assert one["settling_time_s"] == pytest.approx(other["settling_time_s"], abs=0.01)
    document = summarize_all(question(paper, chosen), results, 3)
    assert document["sensitive"] == [2]
    assert "1 of 3 starts are chaotic at first" in "\n".join(sentences(document))


def test_results_are_the_same_in_any_process_and_order(paper, chosen, tmp_path: Path) -> None:
    asked, starts = question(paper, chosen, horizon=20.0), random_starts(paper, 5, 3, 20.0)
    here = validate(asked, starts, tmp_path / "here", Here(), 1)
    with local(2) as (pool, workers):
        there = validate(asked, starts, tmp_path / "there", pool, workers)
    assert here == there
    again, stored, run = replay(asked, 3, starts[3], tmp_path / "there")
    assert again == stored == here[3]
    assert run.t[-1] == pytest.approx(20.0)


def test_what_is_stored_is_not_run_again_and_a_torn_line_is(paper, chosen, tmp_path: Path) -> None:
    asked, starts = question(paper, chosen, horizon=5.0), random_starts(paper, 4, 3, 20.0)
    whole = validate(asked, starts, tmp_path, Here(), 1)
    path = tmp_path / f"validation-{asked.key}.jsonl"
    lines = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(b"".join(lines[:3]) + lines[3][:40])
    ran = []

    class Counting(Here):
        def submit(self, function, /, *args, **kwargs):
            ran.append(args[1])
            return super().submit(function, *args, **kwargs)

    assert validate(asked, starts, tmp_path, Counting(), 1) == whole
    assert sorted(ran) == sorted(set(range(4)) - {json.loads(line)["start"] for line in lines[1:3]})
    assert sorted(path.read_bytes().splitlines(keepends=True)) == sorted(lines)


def test_another_question_has_another_ledger(paper, chosen) -> None:
    keys = {
        question(paper, chosen, **change).key
        for change in (
            {},
            {"seed": 4},
            {"horizon": 61.0},
            {"tolerance": Tolerance(1.0, 1.1)},
            {"method": "dop853"},
            {"method": "cvodes"},
        )
    }
    assert len(keys) == 6
    moved = paper.model_copy(update={"leader": paper.leader.model_copy(update={"heading_deg": 224})})
    assert question(moved, chosen).key not in keys
    assert origin_of_states(random_starts(paper, 1, 0)) != origin_of_states(random_starts(paper, 1, 1))


def test_a_damaged_or_foreign_ledger_is_refused(tmp_path: Path) -> None:
    (tmp_path / "validation-k.jsonl").write_text('{"a": 1}\nnonsense\n')
    with pytest.raises(InputError, match="is damaged"):
        Ledger(tmp_path, "k", {"a": 1})
    (tmp_path / "validation-k.jsonl").write_text('{"a": 2}\n')
    with pytest.raises(InputError, match="another question"):
        Ledger(tmp_path, "k", {"a": 1})


def die(number: int) -> int:
    if number == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def test_a_worker_that_dies_is_one_message() -> None:
    with pytest.raises(UndecidedError, match="run the same command again"), local(1) as (pool, workers):
        list(in_turn(pool, die, ((k,) for k in range(8)), workers))


def test_a_start_on_which_the_integrator_gives_up_is_a_failure_of_its_own(paper, chosen, monkeypatch) -> None:
    monkeypatch.setattr("gaincert.verify.simulation.cvodes.MAX_STEPS", 3)
    asked = question(paper, chosen, horizon=7.0)
    result = run_start(asked, 0, paper.start())
    assert result["gave_up"]
    document = summarize_all(asked, [result], 0)
    assert document["settled"] == 0
    assert document["failures"][0]["gave_up"]
    assert document["peak_torque_ratio"] is None
    assert sentences(document)


def test_spread_counts_the_unsettled_as_later_than_all_others() -> None:
    assert spread([3.0, 1.0, 2.0]) == {"median": 2.0, "p90": pytest.approx(2.8), "max": 3.0}
    assert spread([3.0, 1.0, None]) == {"median": 3.0, "p90": None, "max": None}
    assert spread([None]) == {"median": None, "p90": None, "max": None}


@pytest.mark.slow
def test_a_run_that_was_killed_goes_on_where_it_stopped(tmp_path: Path) -> None:
    gains = fast_gains(tmp_path)
    arguments = [ROOT / "examples" / "paper.toml", "--gains", gains, "--starts", 40, "--box", 60, "--workers", 2]
    arguments += ["--horizon", 150, "--seed", 11]
    broken = tmp_path / "broken"
    process = subprocess.Popen(gaincert("validate", *arguments, "-o", broken), start_new_session=True)
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline and sum(path.read_bytes().count(b"\n") for path in broken.glob("*.jsonl")) < 5:
        time.sleep(0.05)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    stored = next(broken.glob("*.jsonl")).read_bytes()
    assert 5 <= stored.count(b"\n") < 41
    documents = []
    for folder in (broken, tmp_path / "whole"):
        done = subprocess.run(
            gaincert("validate", *arguments, "-o", folder, "--json"), capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
        documents.append(json.loads(done.stdout))
        assert json.loads((folder / "validation.json").read_text()) == documents[-1]
    assert {key: (old, documents[1][key]) for key, old in documents[0].items() if old != documents[1][key]} == {}
    assert next(broken.glob("*.jsonl")).read_bytes().startswith(stored[: stored.rfind(b"\n") + 1])
    again = subprocess.run(
        gaincert("validate", *arguments, "-o", broken, "--replay", 17, "--json"),
        capture_output=True,
        text=True,
        check=True,
    )
    assert json.loads(again.stdout)["same"] is True


@pytest.mark.slow
def test_a_starts_file_and_its_mistakes(tmp_path: Path) -> None:
    gains = fast_gains(tmp_path)
    rows = ["start,vehicle,x,y,theta,v,omega"] + [f"a,v{i},{i},0,0,0,0" for i in range(1, 7)]
    (tmp_path / "starts.csv").write_text("\n".join(rows) + "\n")
    common = ["validate", ROOT / "examples" / "paper.toml", "--gains", gains, "-o", tmp_path / "out", "--horizon", 2]
    command = gaincert(*common, "--starts-file", tmp_path / "starts.csv", "--json", "--workers", 1)
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    document = json.loads(done.stdout)
    assert document["starts"] == 1
    assert document["seed"] is None
    assert document["failures"][0]["failure"] == "not settled by 2 s"
    beyond = subprocess.run([*command, "--replay", "1"], capture_output=True, text=True, check=False)
    assert beyond.returncode == 2
    assert "--replay 1: the file has the starts 0 to 0" in beyond.stderr
    nobody = subprocess.run([*command, "--scheduler", "tcp://127.0.0.1:1"], capture_output=True, text=True, check=False)
    assert nobody.returncode == 2
    assert "Traceback" not in nobody.stderr


@pytest.mark.slow
def test_a_dask_cluster_gives_the_same_numbers_though_a_worker_is_killed(paper, chosen, tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    asked, starts = question(paper, chosen, horizon=100.0), random_starts(paper, 24, 3, 20.0)
    with local(2) as (pool, workers):
        expected = validate(asked, starts, tmp_path / "local", pool, workers)
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as machines:
        victim = next(iter(machines.workers.values())).process.process.pid
        killed = []

        def progress(_what: str, fraction: float) -> None:
            if fraction > 0.2 and not killed:
                killed.append(os.kill(victim, signal.SIGKILL))

        with cluster(machines.scheduler_address) as (executor, workers):
            found = validate(asked, starts, tmp_path / "dask", executor, workers, progress)
    assert killed
    assert found == expected
