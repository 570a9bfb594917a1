"""Verbs together: they fail before the work begins, leave matching files, and end with the right exit code."""

import contextlib
import io
import json
import math
from dataclasses import replace
from pathlib import Path

import pytest
from gaincert.console import Printer
from gaincert.models.errors import InputError
from gaincert.models.files.templates import template_text
from gaincert.reports.deployment import load_deployment
from gaincert.reports.results import current_digests, stale_files
from gaincert.synthesis import design as design_module
from gaincert.synthesis.settings import MODES
from gaincert.verify import proof
from gaincert.workflows.design import DesignOptions, design_fleet, spread
from gaincert.workflows.inputs import read_fleet

from tests.cli.command_line import Done, gaincert

ROOT = Path(__file__).parents[2]
PAPER = (ROOT / "examples" / "paper.toml", "--gains", ROOT / "examples" / "paper_gains.toml")
UNCHECKED = "the work began before the folder was looked at"


def stop(*_: object, **_options: object) -> None:
    raise AssertionError(UNCHECKED)


@pytest.fixture(scope="module")
def designed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Done]:
    """A design for one robot, and the printed text."""
    folder = tmp_path_factory.mktemp("designed")
    (folder / "fleet.toml").write_text(template_text("line", 1))
    done = gaincert("design", "fleet.toml", "-o", "out", "--conditions", "corrected", "--mode", "draft", cwd=folder)
    assert done.returncode == 0, done.stderr
    return folder, done


# -- fail before the work ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("verb", ["design", "run", "simulate", "prove", "certify", "validate"])
def test_a_folder_that_cannot_be_written_is_refused_before_the_work(
    verb: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("")
    for place, name in ((design_module, "prepare"), (proof, "prove")):
        monkeypatch.setattr(place, name, stop)
    for work in ("simulation.simulate.simulate", "certificates.certify.certify", "validation.validate.validate"):
        monkeypatch.setattr(f"gaincert.verify.{work}", stop)
    arguments = {"prove": (), "design": PAPER[:1], "run": PAPER[:1]}.get(verb, PAPER)
    done = gaincert(verb, *arguments, "-o", tmp_path / "file" / "out")
    assert done.returncode == 2
    assert "cannot be written" in done.stderr
    assert UNCHECKED not in done.stderr


def test_a_file_where_a_folder_should_be_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    done = gaincert("simulate", *PAPER, "-o", tmp_path / "file" / "out")
    assert done.returncode == 2
    words = f"cannot be written: {tmp_path / 'file'} is a file, not a folder; choose another folder"
    assert f"{tmp_path / 'file' / 'out'}: {words}" in done.stderr


def test_robots_that_collide_end_a_simulation_with_1(tmp_path: Path) -> None:
    fleet = tmp_path / "fleet.toml"
    fleet.write_text(PAPER[0].read_text().replace("torque_limit", "footprint = 2\ntorque_limit"))
    done = gaincert("simulate", fleet, *PAPER[1:], "-o", tmp_path / "out", "--horizon", 2)
    assert done.returncode == 1
    assert done.stdout.splitlines()[-1].startswith("NOT USABLE: 'v2' and 'v3' come within")


def test_slips_are_said_before_the_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def never(*_: object, **_options: object) -> None:
        raise InputError(UNCHECKED)

    monkeypatch.setattr(design_module, "prepare", never)
    done = gaincert("design", PAPER[0], "-o", tmp_path)
    assert UNCHECKED in done.stderr
    assert "warning: vehicles 'v1', 'v2': torque_limit = 55 N m could accelerate" in done.stdout


@pytest.mark.parametrize("verb", ["simulate", "validate"])
def test_slips_of_a_run_are_said(tmp_path: Path, verb: str) -> None:
    starts = ("--starts", 1) if verb == "validate" else ()
    done = gaincert(verb, *PAPER, "-o", tmp_path, "--horizon", 1, "--delay", 40, *starts)
    words = "warning: disturbance: delay = 40 s is late for any robot: it is a time in s, not in ms"
    assert done.stdout.splitlines()[0] == words


def test_trying_a_folder_leaves_nothing(tmp_path: Path) -> None:
    done = gaincert("design", PAPER[0], "-o", tmp_path / "a" / "b", "--excitation", "given")
    assert done.returncode == 2
    assert list(tmp_path.iterdir()) == []


# -- what belongs together ---------------------------------------------------------------------------------------------


def test_a_design_is_certified(designed: tuple[Path, Done]) -> None:
    folder, done = designed
    assert f"certificate: {Path('out') / 'certificate.json'}" in done.stdout
    fleet = read_fleet(folder / "fleet.toml")
    deployed = load_deployment(folder / "out", fleet)
    assert deployed.certificate_digest is not None
    assert deployed.digests == current_digests(folder / "out")
    assert stale_files(folder / "out", deployed.digests) == []


def test_every_file_of_a_run_carries_the_digests_of_fleet_and_gains(designed: tuple[Path, Done]) -> None:
    folder, _ = designed
    for verb, options in (("simulate", ("--horizon", 5)), ("validate", ("--starts", 1, "--horizon", 5))):
        done = gaincert(
            verb, "fleet.toml", "--gains", "out/design.json", "-o", "out", *options, "--json", "-q", cwd=folder
        )
        assert done.returncode == 0, done.stderr
    expected = current_digests(folder / "out")
    for name in ("design", "summary", "validation"):
        content = json.loads((folder / "out" / f"{name}.json").read_text())
        assert (content["fleet_digest"], content["controller_digest"]) == expected
    for path in (folder / "out" / "figures").iterdir():
        assert expected.controller.encode() in path.read_bytes(), path
    assert stale_files(folder / "out", expected) == []


def test_a_design_into_a_folder_with_older_runs_says_so(
    designed: tuple[Path, Done], options: DesignOptions, tmp_path: Path
) -> None:
    folder, _ = designed
    out = tmp_path / "out"
    out.mkdir()
    for name in ("summary", "validation"):
        (out / f"{name}.json").write_text(json.dumps({"fleet_digest": "sha256:a", "controller_digest": "sha256:b"}))
    printer = Printer(False, False, False)
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        design_fleet(
            printer, read_fleet(folder / "fleet.toml"), replace(options, conditions="corrected", digits=3), out
        )
    line = "note: summary.json, validation.json are from other gains or another fleet: run gaincert simulate, "
    assert line + "gaincert validate again" in printed.getvalue()


def test_a_design_keeps_to_its_share_of_the_torque_limits(
    designed: tuple[Path, Done], options: DesignOptions, tmp_path: Path
) -> None:
    folder, _ = designed
    printer = Printer(False, True, False)
    made = design_fleet(
        printer,
        read_fleet(folder / "fleet.toml"),
        replace(options, conditions="corrected", torque_factor=0.3),
        tmp_path,
    )
    assert made.document["torque_factor"] == 0.3
    used = max(float(bound) for bound in load_deployment(tmp_path, read_fleet(folder / "fleet.toml")).torque_bounds)
    assert 0 < used <= 0.3 * 12
    refused = gaincert("design", folder / "fleet.toml", "-o", tmp_path, "--torque-factor", 1.5)
    assert refused.returncode == 2


# -- exit codes and words ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("scheme", "code"), [("bounded", 0), ("unbounded", 1)])
def test_a_torque_above_its_limit_is_false_for_both_schemes(scheme: str, code: int, tmp_path: Path) -> None:
    done = gaincert("simulate", *PAPER, "--scheme", scheme, "--horizon", 5, "-o", tmp_path)
    assert done.returncode == code
    assert ("FALSE: the largest wheel torque is 7.5" in done.stdout) == (code == 1)


def test_a_bug_is_a_fault_and_no_verdict(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> None:
        raise KeyError("x")

    monkeypatch.setattr("gaincert.cli.check_fleet", broken)
    done = gaincert("check", PAPER[0])
    assert done.returncode == 5
    assert "error: this is a fault of gaincert (KeyError)" in done.stderr
    assert "Traceback" in done.stderr


def test_no_memory_is_a_fault_without_a_traceback(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> None:
        raise MemoryError

    monkeypatch.setattr("gaincert.cli.check_fleet", broken)
    done = gaincert("check", PAPER[0])
    assert done.returncode == 5
    assert "Traceback" not in done.stderr


def test_settling_times_are_said_in_words() -> None:
    assert spread([3.2, math.inf, 1.0]) == "median 3 s, worst not settled"
    assert spread([math.inf, math.inf]) == "median not settled, worst not settled"


def test_the_modes_are_those_of_the_search() -> None:
    from gaincert.cli_options import Mode

    assert {mode.value for mode in Mode} == set(MODES)


# -- run with given gains ----------------------------------------------------------------------------------------------


@pytest.fixture
def quick_proof(monkeypatch: pytest.MonkeyPatch) -> None:
    """The proof check has tests of its own."""
    monkeypatch.setattr("gaincert.workflows.prove.prove_claims", lambda *_arguments, **_options: [])
    monkeypatch.setattr("gaincert.workflows.prove.theorem_holds", lambda _claims: True)


@pytest.mark.usefixtures("quick_proof")
def test_run_takes_gains_and_designs_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(design_module, "prepare", stop)
    done = gaincert("run", *PAPER, "-o", tmp_path, "--horizon", 5, "--json")
    assert done.returncode == 0, done.stderr
    document = json.loads(done.stdout)
    assert document["certificate"]["conditions"] == "paper"
    assert "design" not in document
    names = {"certificate.json", "summary.json", "trajectory.npz", "report.html"}
    assert names <= {path.name for path in tmp_path.iterdir()}
    assert not (tmp_path / "design.json").exists()
    assert b"unbounded scheme" in (tmp_path / "figures" / "paths.svg").read_bytes()
    (line,) = (line for line in done.stderr.splitlines() if line.startswith("the unbounded scheme for comparison: "))
    assert "not settled within 5 s" in line and "peak torque 75" in line


@pytest.mark.usefixtures("quick_proof")
def test_a_run_whose_robots_cannot_move_ends_with_1_and_says_what_to_change(tmp_path: Path) -> None:
    fleet = tmp_path / "fleet.toml"
    fleet.write_text(PAPER[0].read_text() + "\n[disturbance]\ncoulomb = 60\nsample_time = 0.02\n")
    done = gaincert("run", fleet, *PAPER[1:], "-o", tmp_path / "out", "--horizon", 2)
    assert done.returncode == 1
    assert done.stdout.splitlines()[-1].startswith("NOT USABLE: ")
    assert "friction of 60 N m at every wheel is more than the motors of" in done.stdout
    assert "correct torque_limit or coulomb, or take stronger motors" in done.stdout
    checked = gaincert("check", fleet)
    assert checked.returncode == 0
    assert checked.stdout.splitlines()[-1].startswith("NOT USABLE: friction of 60 N m")


# -- disturbances and names --------------------------------------------------------------------------------------------


def test_simulate_takes_the_disturbance_options_of_validate(tmp_path: Path) -> None:
    options = (
        "--sample-time",
        0.02,
        "--delay",
        0.04,
        "--noise",
        0.005,
        0.01,
        "--noise-speed",
        0.02,
        "--mismatch",
        0.1,
        "--friction",
        0.2,
        0.01,
    )
    lost = ("--lost-link", "v1", "v2", 1, "--seed", 3)
    done = gaincert("simulate", *PAPER, "-o", tmp_path, "--horizon", 2, *options, *lost)
    assert done.returncode == 0, done.stderr
    assert json.loads((tmp_path / "summary.json").read_text())["disturbance"] == {
        "sample_time": 0.02,
        "delay": 0.04,
        "noise_position": 0.005,
        "noise_heading": 0.01,
        "noise_speed": 0.02,
        "mismatch": 0.1,
        "coulomb": 0.2,
        "viscous": 0.01,
        "lost_link": ["v1", "v2"],
        "lost_at": 1.0,
        "seed": 3,
    }
    words = (
        "with the disturbance (torques held for 20 ms, 40 ms of delay, noise of 0.005 m, 0.01 rad, 0.02 m/s and rad/s, "
        "parameters off by up to 10 %, friction of 0.2 N m, 0.01 N m s at every wheel, the link v1 - v2"
    )
    assert words in done.stdout


@pytest.mark.parametrize(
    ("lost", "message"),
    [
        (("v1", "v22"), "the fleet has no vehicle 'v22' (did you mean 'v2'?)"),
        (("v1", "v3"), "the fleet has no edge 'v1' - 'v3'; 'v1' is linked to 'v2', 'v6'"),
    ],
)
def test_a_wrong_name_of_a_robot_gets_the_likely_one(lost: tuple[str, str], message: str, tmp_path: Path) -> None:
    done = gaincert("simulate", *PAPER, "-o", tmp_path / "out", "--lost-link", *lost, 1)
    assert done.returncode == 2
    assert message in done.stderr
    starts = tmp_path / "starts.csv"
    starts.write_text("start,vehicle,x,y,theta,v,omega\n0,v22,0,0,0,0,0\n")
    done = gaincert("validate", *PAPER, "-o", tmp_path / "out", "--starts-file", starts)
    assert "'v22': the fleet has no such vehicle (did you mean 'v2'?)" in done.stderr
