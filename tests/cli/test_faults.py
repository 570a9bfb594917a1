"""If a solver fails or hangs, the next method takes over and a line says so; the design is never wrong."""

import json
import logging
import math
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import Executor, Future
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import casadi as ca
import cvxpy as cp
import numpy as np
import pytest
from gaincert import cli
from gaincert import parallel as dispatch
from gaincert.console import Printer
from gaincert.models.arrays import floats
from gaincert.models.conditions import condition_set
from gaincert.models.equations import control
from gaincert.models.errors import UndecidedError
from gaincert.models.files.fleet_file import load_fleet as load
from gaincert.models.files.templates import template_text
from gaincert.models.fleet import Fleet
from gaincert.models.gains import GAIN_NAMES, Gains
from gaincert.models.paper import paper_fleet, paper_gains
from gaincert.synthesis import rates
from gaincert.synthesis.design import Design, design, incumbents
from gaincert.synthesis.programs import averaged
from gaincert.synthesis.programs.excitation import flat_tones
from gaincert.synthesis.programs.rates import convex_designs
from gaincert.synthesis.programs.weights import SPREAD, design_weights
from gaincert.synthesis.rollouts import closed_loop as compiled_loop
from gaincert.synthesis.rollouts import continuous, sampled
from gaincert.synthesis.rounding import rounded
from gaincert.synthesis.search import halving
from gaincert.synthesis.search.cma_es import CmaEs
from gaincert.synthesis.search.search import search
from gaincert.synthesis.settings import FAST, Settings
from gaincert.synthesis.task import Options, Task, prepare
from gaincert.verify.simulation import cvodes as rollout
from gaincert.verify.simulation.simulate import simulate

from tests.campaigns import faults

SHORT = replace(FAST, work=1e6, explored=8, ranking_starts=2, generations=1, training_starts=2, heldout_starts=2)
PSI = '[excitation]\nfamily = "harmonics"\nfrequency = 1\nmean = 0\nsin = [1]\n'


@pytest.fixture
def fleet(tmp_path: Path) -> Fleet:
    """Two robots with a psi of their own."""
    path = tmp_path / "fleet.toml"
    path.write_text(template_text("line", 2) + "\n" + PSI)
    return load(path)


def designed(fleet: Fleet) -> Design:
    """A design under (16*); its exact conditions hold, whatever the solvers did."""
    made = design(fleet, conditions="corrected", settings=SHORT)
    assert all(np.all(inequality.holds) for inequality in made.inequalities())
    assert all(value > 0 for name in GAIN_NAMES for value in getattr(made.gains, name))
    return made


def task_of(fleet: Fleet, settings: Settings = SHORT) -> Task:
    return prepare(fleet, Options("corrected"), settings)


# -- Clarabel ---------------------------------------------------------------------------------------------------------

SOLVE = cp.Problem.solve


def values(number: float) -> Any:
    """A solve that ends as optimal, with one number for all variables."""

    def solve(problem: Any, **options: Any) -> None:
        SOLVE(problem, **options)
        problem._status = cp.OPTIMAL
        for variable in problem.variables():
            variable.save_value(np.full(variable.shape, number))

    return solve


def error(kind: type[Exception]) -> Any:
    def solve(*_: Any, **_options: Any) -> None:
        raise kind("the solver broke down")

    return solve


def status(name: str) -> Any:
    def solve(problem: Any, **_options: Any) -> None:
        problem._status = name

    return solve


CLARABEL = {
    "solver error": error(cp.SolverError),
    "other error": error(ZeroDivisionError),
    "infeasible": status(cp.INFEASIBLE),
    "inaccurate": status(cp.OPTIMAL_INACCURATE),
    "out of time": status(cp.USER_LIMIT),
    "optimal without values": status(cp.OPTIMAL),
    "nan": values(math.nan),
    "infinite": values(math.inf),
    "zero": values(0.0),
    "negative": values(-3.0),
    "huge": values(1e9),
    "tiny": values(1e-9),
}


@pytest.fixture(params=CLARABEL)
def clarabel(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.setattr(cp.Problem, "solve", CLARABEL[request.param])
    return str(request.param)


def test_without_clarabel_the_averaged_program_takes_over(
    clarabel: str, fleet: Fleet, caplog: pytest.LogCaptureFixture
) -> None:
    proposed = incumbents(task_of(fleet))
    assert "averaged program" in {candidate.origin for candidate in proposed}
    for candidate in proposed:
        conditions = condition_set("corrected")
        exact = rounded(conditions, task_of(fleet).exact_data, candidate.gains.map(floats), 6)
        assert all(value > 0 for name in GAIN_NAMES for value in getattr(exact, name))
    if clarabel not in ("huge", "tiny"):  # gains that are slow, but within the conditions
        assert "convex programs" not in {candidate.origin for candidate in proposed}
        assert "convex programs: left out" in caplog.text


@pytest.mark.usefixtures("clarabel")
def test_without_clarabel_there_is_no_psi() -> None:
    with pytest.raises(UndecidedError):
        flat_tones()


@pytest.mark.usefixtures("clarabel")
def test_without_clarabel_there_are_no_weights_that_were_not_asked_for() -> None:
    """Weights outside their range are refused; psi and weights have no other method."""
    given = paper_fleet()
    try:
        links = design_weights(given)
    except UndecidedError:
        return
    for (*_, new), (*_, old) in zip(links.edges, given.links.edges, strict=True):
        assert old / SPREAD / 1.02 <= new <= old * SPREAD * 1.02


def test_without_psi_the_command_ends_as_undecided(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(cp.Problem, "solve", error(cp.SolverError))
    path = tmp_path / "fleet.toml"
    path.write_text(template_text("line", 2))
    monkeypatch.setattr(sys, "argv", ["gaincert", "design", str(path), "-o", str(tmp_path / "out")])
    with pytest.raises(SystemExit) as caught:
        cli.main()
    assert caught.value.code == 4
    assert capsys.readouterr().err.startswith("error: the program for psi's tones")
    assert not (tmp_path / "out").exists()


# -- IPOPT ------------------------------------------------------------------------------------------------------------


class Ipopt:
    """A solver that answers with one number for all, and says whether that is a success."""

    def __init__(self, number: float, success: bool = True) -> None:
        self.number, self.success = number, success

    def __call__(self, **_problem: Any) -> dict[str, Any]:
        return {"x": ca.DM([self.number] * 14), "f": ca.DM(self.number)}

    def stats(self) -> dict[str, Any]:
        return {"success": self.success, "return_status": "whatever"}


class Broken:
    """An integrator or a solver that raises what CasADi raises."""

    def __call__(self, **_problem: Any) -> Any:
        raise RuntimeError(".../casadi/core/function_internal.cpp:3393:\nit broke down")


IPOPT = {
    "error": Broken(),
    "no success": Ipopt(0.0, success=False),
    "nan": Ipopt(math.nan),
    "infinite": Ipopt(math.inf),
    "nonsense": Ipopt(700.0),
    "other nonsense": Ipopt(-700.0),
}


@pytest.fixture(params=IPOPT)
def ipopt(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.setattr(averaged.ca, "nlpsol", lambda *_: IPOPT[request.param])
    return str(request.param)


def test_without_ipopt_the_convex_programs_take_over(
    ipopt: str, fleet: Fleet, caplog: pytest.LogCaptureFixture
) -> None:
    proposed = incumbents(task_of(fleet))
    assert {candidate.origin for candidate in proposed} == {"convex programs"}
    assert "averaged program: left out" in caplog.text
    assert ("it broke down" in caplog.text) == (ipopt == "error")


def test_an_ipopt_that_cannot_be_built_is_left_out(
    fleet: Fleet, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(averaged.ca, "nlpsol", lambda *_: Broken()())
    assert averaged.local_optima(task_of(fleet), 5.0) == []
    assert "it broke down" in caplog.text


def test_without_any_program_the_closed_form_is_what_is_left(fleet: Fleet, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(averaged.ca, "nlpsol", lambda *_: Broken())
    monkeypatch.setattr(cp.Problem, "solve", error(cp.SolverError))
    monkeypatch.setattr(halving, "CmaEs", error(RuntimeError))
    assert designed(fleet).origin == "closed form"


# -- the integrators ---------------------------------------------------------------------------------------------------


def test_gains_that_the_integrator_gives_up_on_count_as_never_settled(
    fleet: Fleet, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*arguments: Any) -> tuple[Any, Any]:
        return tuple(math.nan * torque for torque in control(*arguments))  # type: ignore[return-value]

    monkeypatch.setattr(continuous, "_programs", cache(continuous._programs.__wrapped__))
    monkeypatch.setattr(sampled, "_program", cache(sampled._program.__wrapped__))
    monkeypatch.setattr(compiled_loop, "control", broken)
    made = designed(fleet)
    assert {*made.settling, *made.settling_held} == {math.inf}
    assert made.largest_sample_time is None


def test_without_cvodes_nothing_is_decided(psi_of_paper: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rollout.ca, "integrator", lambda *_: Broken()())
    with pytest.raises(UndecidedError, match="cannot be built: it broke down"):
        simulate(paper_fleet(), paper_gains(), psi_of_paper)


# -- CMA-ES -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", [RuntimeError, ValueError, FloatingPointError, np.linalg.LinAlgError, AssertionError])
def test_without_cma_the_programs_candidates_are_ranked(
    kind: type[Exception], fleet: Fleet, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def broken(*_: Any) -> None:
        raise kind("it broke down")

    monkeypatch.setattr(halving, "CmaEs", broken)
    task = task_of(fleet)
    begun = [task.proposal("here", task.typical)]
    assert search(task, begun, None, lambda *_: None) == begun
    assert f"time-domain search: broken off: {kind.__name__}: it broke down" in caplog.text


def test_what_cma_has_found_is_kept_where_it_breaks_down(
    fleet: Fleet, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    told, whole = [], CmaEs.tell

    def tell_once(strategy: Any, points: Any, values: Any) -> None:
        told.append(min(values))
        if len(told) > 1:
            raise ValueError("it broke down")
        whole(strategy, points, values)

    monkeypatch.setattr(CmaEs, "tell", tell_once)
    task = task_of(fleet, replace(SHORT, work=1e9, basins=1))
    begun = [task.proposal("here", task.typical)]
    found = search(task, begun, None, lambda *_: None)
    assert len(found) > len(begun)
    assert found[-1:] == begun
    assert "time-domain search: broken off: ValueError: it broke down" in caplog.text


@pytest.mark.parametrize("failing", [1, 10_000])
def test_proposals_that_cannot_be_rounded_are_left_out_and_end_nothing(
    failing: int, fleet: Fleet, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    made, whole = [], Task.rounded

    def rounds(task: Any, proposal: Any) -> Any:
        made.append(proposal)
        if len(made) <= failing:
            raise UndecidedError("rounding to 4 digits breaks (16*)")
        return whole(task, proposal)

    monkeypatch.setattr(Task, "rounded", rounds)
    if failing == 1:
        designed(fleet)
        assert "a candidate is left out: rounding to 4 digits breaks (16*)" in caplog.text
    else:
        with pytest.raises(UndecidedError, match="rounding to 4 digits breaks"):
            designed(fleet)


# -- the last gate ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf, 0.0, -1.0])
@pytest.mark.parametrize("name", GAIN_NAMES)
def test_gains_that_are_not_positive_numbers_are_not_rounded(wrong: float, name: str) -> None:
    fleet = paper_fleet()
    columns = {key: getattr(paper_gains(), key).astype(float) for key in GAIN_NAMES}
    columns[name][2] = wrong
    with pytest.raises(UndecidedError, match="not positive numbers"):
        rounded(condition_set("paper"), fleet.condition_data(flat_tones()), Gains(**columns), 4)


# -- the clock --------------------------------------------------------------------------------------------------------


def test_clarabel_has_a_clock(fleet: Fleet, caplog: pytest.LogCaptureFixture) -> None:
    with pytest.raises(UndecidedError, match="within 1e-07 s"):
        flat_tones(1e-7)
    assert convex_designs(task_of(fleet, replace(SHORT, clarabel_seconds=1e-7))) == []
    assert "convex programs: broken off: Clarabel found no answer within 1e-07 s" in caplog.text


def test_ipopt_has_a_clock(fleet: Fleet, caplog: pytest.LogCaptureFixture) -> None:
    assert averaged.local_optima(task_of(fleet, replace(SHORT, ipopt_seconds=1e-7)), 5.0) == []
    assert "averaged program: broken off: IPOPT found no answer within 1e-07 s" in caplog.text


def test_a_tail_has_a_clock(paper: Fleet, psi_of_paper: Any) -> None:
    track = rates.CrossTrack(paper.plant(), paper_gains().map(floats), psi_of_paper)
    assert track.time_to(np.ones(6), 0.5, 0.5)[0] < math.inf
    late, kappa = track.time_to(np.ones(6), 0.5, 0.5, seconds=0.0)
    assert late == math.inf
    assert kappa > 0


def test_a_worker_that_hangs_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dispatch, "JOB_SECONDS", 5)
    begin = time.monotonic()  # the whole is waited for twice as long, so that the alarm comes first
    with pytest.raises(UndecidedError, match="took more than 5 s"), dispatch.local(1) as (pool, workers):
        list(dispatch.in_turn(pool, time.sleep, [(300.0,)], workers))
    assert time.monotonic() - begin < 60


def test_a_cluster_that_hangs_is_not_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    class Endless(Executor):
        def submit(self, _function: Any, /, *_args: Any, **_kwargs: Any) -> Future[Any]:
            return Future()

    monkeypatch.setattr(dispatch, "JOB_SECONDS", 0.05)
    with pytest.raises(UndecidedError, match="no worker was done"):
        list(dispatch.in_turn(Endless(), time.sleep, [(300.0,)], 1))


def test_an_interrupt_does_not_wait_for_the_workers() -> None:
    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt), dispatch.local(1) as (pool, _):
        running = pool.submit(time.sleep, 300.0)
        while not running.running():
            time.sleep(0.01)
        raise KeyboardInterrupt
    assert time.monotonic() - begin < 60


def test_an_interrupt_does_not_reach_a_worker_that_begins() -> None:
    """A terminal sends it to all processes, also to one that has not yet set its handler."""
    if not hasattr(signal, "pthread_sigmask"):
        pytest.skip("no signal masks here")
    with dispatch.local(1) as (pool, _):
        running = pool.submit(os.getpid)
        for pid in list(pool._processes):  # type: ignore[attr-defined]
            os.kill(pid, signal.SIGINT)
        assert running.result(60) > 0
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, [])


# -- the reader -------------------------------------------------------------------------------------------------------


def test_quiet_leaves_warnings_out() -> None:
    log = logging.getLogger("gaincert.synthesis.design")
    for quiet, shown in ((True, False), (False, True)):
        printer = Printer(False, quiet, False)
        assert printer.silent().quiet
        assert log.isEnabledFor(logging.WARNING) == shown


WARNING_FROM_A_WORKER = """
import logging
from gaincert.console import Printer
from gaincert.parallel import local

def warn(text):
    logging.getLogger("gaincert.synthesis.design").warning(text)

if __name__ == "__main__":
    Printer(False, {quiet}, False)
    warn("from here")
    with local(1) as (pool, _):
        pool.submit(warn, "from a\\nworker").result()
"""


@pytest.mark.parametrize("quiet", [False, True])
def test_warnings_of_workers_look_like_those_of_the_command_line(quiet: bool, tmp_path: Path) -> None:
    """A worker begins with Python's own format for warnings."""
    script = tmp_path / "script.py"
    script.write_text(WARNING_FROM_A_WORKER.format(quiet=quiet))
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, check=True)
    said = [] if quiet else ["warning: from here", "warning: from a\\nworker"]
    assert done.stderr.splitlines() == said


# -- kills and interrupts ---------------------------------------------------------------------------------------------

GAINS = {
    "excitation": {"family": "harmonics", "frequency": "1.84", "sin": ["1.2071", "0", "0.2803", "0", "0.0732"]},
    "gains": {
        "p_v": ["113.1", "113.1"],
        "d_v": ["33.97", "33.97"],
        "p_omega": ["3.47", "3.47"],
        "d_omega": ["3.306", "3.306"],
        "k_alpha": ["5.817", "5.817"],
    },
}


@pytest.mark.slow
@pytest.mark.needs("proc")
def test_kills_and_interrupts_leave_nothing_broken(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The campaign tests/campaigns/faults.py for one command, at fixed moments."""
    monkeypatch.setitem(faults.COMMANDS, "validate", [*faults.COMMANDS["validate"][:-3], "60", "--horizon", "300"])
    (tmp_path / "gains").mkdir()
    (tmp_path / "gains" / "design.json").write_text(json.dumps(GAINS))
    bench = faults.Bench(tmp_path)
    chosen = {fault.name: fault for fault in faults.FAULTS}
    for name, code in (("SIGKILL, the parent", -9), ("SIGINT, all processes", 130)):
        found = bench.hit("validate", chosen[name], 0.6)
        assert found.clean, found
        assert (found.hit, found.code) == (True, code)
