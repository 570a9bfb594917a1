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
from gaincert.verify.simulation.chaos_aware import NOT_CHAOTIC, TAIL, TRANSIENT_PIECE, ChaosAware
from gaincert.verify.simulation.closed_loop import ClosedLoop
from gaincert.verify.simulation.integrators import Adams
from gaincert.verify.simulation.simulate import simulate, summarize
from gaincert.verify.validation.results_file import ResultsFile
from gaincert.verify.validation.spread import Spread
from gaincert.verify.validation.start_result import StartResult
from gaincert.verify.validation.statistics import SENSITIVE, ValidationResults
from gaincert.verify.validation.validate import ValidationSpec, make_spec, origin_of_states, replay, run_start, validate

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


def spec_of(fleet, chosen, horizon=60.0, tolerance=Tolerance(1.0, 1.0), engine="auto", seed=3) -> ValidationSpec:  # noqa: B008
    loop = ClosedLoop.of(fleet, chosen.gains, chosen.excitation)
    origin = {"random": {"seed": seed, "box_m": 40.0}}
    return make_spec(fleet, loop, origin, horizon=horizon, tolerance=tolerance, engine=engine, versions={})


def gaincert(*arguments: object) -> list[str]:
    return [sys.executable, "-m", "gaincert", *map(str, arguments)]


def test_one_start_settles_when_simulate_says_so(paper, chosen) -> None:
    spec = spec_of(paper, chosen)
    start = random_starts(paper, 2, 3, 20.0)[1]
    result = run_start(spec, 1, start)
    shown = simulate(paper, chosen.gains, chosen.excitation, start=start, horizon=60)
    summary = summarize(paper, shown, spec.tolerance)
    assert result.settling_time == pytest.approx(summary.settling_time, abs=1e-4)
    assert result.measurement.torque_ratio.value == pytest.approx(summary.peak_torque_ratio, rel=1e-5)
    assert result.violations == summary.violations == ()
    assert 0 < result.measurement.physical_limit < result.settling_time
    assert StartResult.from_json(json.loads(json.dumps(result.to_json()))) == result


def test_an_independent_integrator_gives_the_same_numbers(paper, chosen) -> None:
    start = random_starts(paper, 1, 3, 20.0)[0]
    one, other = (run_start(spec_of(paper, chosen, engine=name), 0, start) for name in ("auto", "dop853"))
    assert one.settling_time == pytest.approx(other.settling_time, rel=0.02)
    assert one.measurement.torque_ratio.value == pytest.approx(other.measurement.torque_ratio.value, rel=0.02)


def test_a_start_that_is_not_chaotic_is_integrated_loosely(paper, gains_of_paper) -> None:
    """Where two loose runs agree, the loose integration is used; its error is far below their difference."""
    loop = ClosedLoop.of(paper, gains_of_paper, paper.psi)
    chaos_aware = ChaosAware(loop, step=0.25, piece=60.0, tolerance=1e-8)
    start = random_starts(paper, 1, 777, 30.0)[0]
    t, states = next(chaos_aware.pieces(start))
    _, reference = next(Adams(loop, step=0.25, piece=60.0, tolerance=1e-15).pieces(start))
    assert t[-1] == 60.0
    assert 0 < np.abs(states.x - reference.x).max() < 0.01 * chaos_aware.sensitivity < 0.01 * NOT_CHAOTIC


def test_a_chaotic_start_is_integrated_accurately_until_the_transient_is_over(paper, chosen) -> None:
    loop = ClosedLoop.of(paper, chosen.gains, chosen.excitation)
    chaos_aware = ChaosAware(loop, step=0.25, piece=100.0, tolerance=1e-8)
    start = random_starts(paper, 5, 3, 30.0)[4]
    times, lengths = [0.0], []
    for t, states in chaos_aware.pieces(start):
        times += t.tolist()
        lengths.append(round(t[-1] - times[-len(t) - 1]))
        if lengths[-1] > TRANSIENT_PIECE:
            break
        near = loop.excess(State(*(column[-1] for column in states)), TAIL) < 1
        assert near == (lengths == [TRANSIENT_PIECE, TRANSIENT_PIECE])
    assert lengths == [TRANSIENT_PIECE, TRANSIENT_PIECE, 100]
    assert np.diff(times) == pytest.approx(0.25)
    assert 0 < chaos_aware.sensitivity < 1e-3


@pytest.mark.slow
def test_a_chaotic_start_has_the_same_time_in_both_integrators_or_is_called_sensitive(paper, chosen) -> None:
    """From 60 m a difference of 1e-12 can grow to metres: only runs at the limit of doubles agree."""
    starts = random_starts(paper, 5, 3, 30.0)
    results = []
    for number in (1, 2, 4):
        specs = (spec_of(paper, chosen, horizon=80.0, engine=name) for name in ("auto", "dop853"))
        one, other = (run_start(spec, number, starts[number]) for spec in specs)
        results.append(one)
        if one.measurement.sensitivity < SENSITIVE:
            assert one.settling_time == pytest.approx(other.settling_time, abs=0.01)
    validation = ValidationResults(spec_of(paper, chosen), results, 3)
    assert validation.sensitive == [2]
    assert "1 of 3 starts are chaotic at first" in "\n".join(validation.sentences())


def test_results_are_the_same_in_any_process_and_order(paper, chosen, tmp_path: Path) -> None:
    spec, starts = spec_of(paper, chosen, horizon=20.0), random_starts(paper, 5, 3, 20.0)
    here = validate(spec, starts, tmp_path / "here", Here(), 1)
    with local(2) as (pool, workers):
        there = validate(spec, starts, tmp_path / "there", pool, workers)
    assert here == there
    again, stored, run = replay(spec, 3, starts[3], tmp_path / "there")
    assert again == stored == here[3]
    assert run.t[-1] == pytest.approx(20.0)


def test_what_is_stored_is_not_run_again_and_a_torn_line_is(paper, chosen, tmp_path: Path) -> None:
    spec, starts = spec_of(paper, chosen, horizon=5.0), random_starts(paper, 4, 3, 20.0)
    whole = validate(spec, starts, tmp_path, Here(), 1)
    path = tmp_path / f"validation-{spec.key}.jsonl"
    lines = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(b"".join(lines[:3]) + lines[3][:40])
    ran = []

    class Counting(Here):
        def submit(self, function, /, *args, **kwargs):
            ran.append(args[1])
            return super().submit(function, *args, **kwargs)

    assert validate(spec, starts, tmp_path, Counting(), 1) == whole
    assert sorted(ran) == sorted(set(range(4)) - {json.loads(line)["start"] for line in lines[1:3]})
    assert sorted(path.read_bytes().splitlines(keepends=True)) == sorted(lines)


def test_another_specification_has_another_results_file(paper, chosen) -> None:
    keys = {
        spec_of(paper, chosen, **change).key
        for change in (
            {},
            {"seed": 4},
            {"horizon": 61.0},
            {"tolerance": Tolerance(1.0, 1.1)},
            {"engine": "dop853"},
            {"engine": "cvodes"},
        )
    }
    assert len(keys) == 6
    moved = paper.model_copy(update={"leader": paper.leader.model_copy(update={"heading_deg": 224})})
    assert spec_of(moved, chosen).key not in keys
    assert origin_of_states(random_starts(paper, 1, 0)) != origin_of_states(random_starts(paper, 1, 1))


def test_a_damaged_or_foreign_results_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "validation-k.jsonl").write_text('{"a": 1}\nnonsense\n')
    with pytest.raises(InputError, match="is damaged"):
        ResultsFile(tmp_path, "k", {"a": 1})
    (tmp_path / "validation-k.jsonl").write_text('{"a": 2}\n')
    with pytest.raises(InputError, match="another validation"):
        ResultsFile(tmp_path, "k", {"a": 1})


def die(number: int) -> int:
    if number == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def test_a_worker_that_dies_is_one_message() -> None:
    with pytest.raises(UndecidedError, match="run the same command again"), local(1) as (pool, workers):
        list(in_turn(pool, die, ((k,) for k in range(8)), workers))


def test_a_start_on_which_the_integrator_gives_up_is_a_failure_of_its_own(paper, chosen, monkeypatch) -> None:
    monkeypatch.setattr("gaincert.verify.simulation.cvodes.MAX_STEPS", 3)
    spec = spec_of(paper, chosen, horizon=7.0)
    result = run_start(spec, 0, paper.start())
    assert StartResult.from_json(result.to_json()) == result
    assert result.to_json()["gave_up"]
    validation = ValidationResults(spec, [result], 0)
    document = validation.to_json()
    assert document["settled"] == 0
    assert document["failures"][0]["gave_up"]
    assert document["peak_torque_ratio"] is None
    assert validation.sentences()


def test_spread_counts_the_unsettled_as_later_than_all_others() -> None:
    assert Spread.of([3.0, 1.0, 2.0]) == (2.0, pytest.approx(2.8), 3.0)
    assert Spread.of([3.0, 1.0, None]) == (3.0, None, None)
    assert Spread.of([None]) == (None, None, None)


@pytest.mark.slow
def test_a_run_that_was_killed_goes_on_where_it_stopped(tmp_path: Path) -> None:
    gains = fast_gains(tmp_path)
    arguments = [ROOT / "examples" / "paper.toml", "--gains", gains, "--starts", 16, "--box", 60, "--workers", 2]
    arguments += ["--horizon", 60, "--seed", 11]
    broken = tmp_path / "broken"
    process = subprocess.Popen(gaincert("validate", *arguments, "-o", broken), start_new_session=True)
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline and sum(path.read_bytes().count(b"\n") for path in broken.glob("*.jsonl")) < 4:
        time.sleep(0.05)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    stored = next(broken.glob("*.jsonl")).read_bytes()
    assert 4 <= stored.count(b"\n") < 17
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
        gaincert("validate", *arguments, "-o", broken, "--replay", 9, "--json"),
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
    assert document["failures"][0]["failure"] == "not settled within 2 s (still closing in)"
    beyond = subprocess.run([*command, "--replay", "1"], capture_output=True, text=True, check=False)
    assert beyond.returncode == 2
    assert "--replay 1: the file has the starts 0 to 0" in beyond.stderr
    nobody = subprocess.run([*command, "--scheduler", "tcp://127.0.0.1:1"], capture_output=True, text=True, check=False)
    assert nobody.returncode == 2
    assert "Traceback" not in nobody.stderr


@pytest.mark.slow
@pytest.mark.needs("distributed")
def test_a_dask_cluster_gives_the_same_numbers_though_a_worker_is_killed(paper, chosen, tmp_path: Path) -> None:
    import distributed

    spec, starts = spec_of(paper, chosen, horizon=40.0), random_starts(paper, 16, 3, 20.0)
    with local(2) as (pool, workers):
        expected = validate(spec, starts, tmp_path / "local", pool, workers)
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as machines:
        victim = next(iter(machines.workers.values())).process.process.pid
        killed = []

        def progress(_what: str, fraction: float) -> None:
            if fraction > 0.2 and not killed:
                killed.append(os.kill(victim, signal.SIGKILL))

        with cluster(machines.scheduler_address) as (executor, workers):
            found = validate(spec, starts, tmp_path / "dask", executor, workers, progress)
    assert killed
    assert found == expected
