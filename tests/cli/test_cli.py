"""The command line: its files, exit codes, messages, and modules that it must not load."""

import csv
import json
import os
import resource
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from gaincert import __version__
from gaincert.cli_app import app
from gaincert.cli_options import Template
from gaincert.models.files.gains_file import GainsFile
from gaincert.models.paper import paper_excitation, paper_fleet, paper_gains
from gaincert.models.saturation import Saturation
from gaincert.models.tolerance import Tolerance
from gaincert.verify.simulation.settling import Approach
from gaincert.verify.simulation.summary import IntegrationError, Summary
from gaincert.workflows.compare import variants_of
from gaincert.workflows.design import DesignOptions
from gaincert.workflows.simulate import hints, sentence
from gaincert.workflows.validate import default_horizon
from typer.main import get_command

from tests.cli.command_line import gaincert

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"
HEAVY = ("casadi", "cvxpy", "clarabel", "sympy", "matplotlib", "jax")


def test_run_leaves_every_file_of_the_contract(out: Path) -> None:
    for name in ("design.json", "gains.csv", "certificate.json", "proof.json", "proof.md", "proof.html", "proof.tex"):
        assert (out / name).stat().st_size > 0, name
    for name in ("trajectory.npz", "summary.json", "report.html"):
        assert (out / name).stat().st_size > 0, name
    for name in ("paths", "poses", "torques", "energies"):
        assert (out / "figures" / f"{name}.svg").read_bytes().startswith(b"<?xml")
        assert (out / "figures" / f"{name}.png").read_bytes().startswith(b"\x89PNG")
    assert not [path.name for path in out.rglob(".*")]  # no temporary file is left


def test_run_prints_one_document_and_the_fleet_settles(out: Path) -> None:
    document = json.loads((out / "stdout.json").read_text())
    summary = json.loads((out / "summary.json").read_text())
    assert document["summary"] == summary
    assert summary["settling_time_s"] < 600
    assert summary["peak_torque_ratio"] < 1
    assert summary["max_V_increase"] < 1e-9
    assert document["certificate"]["valid"]


def test_gains_csv_and_design_json_agree_and_can_be_read_back(out: Path) -> None:
    design = json.loads((out / "design.json").read_text())
    with (out / "gains.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["vehicle"] for row in rows] == design["vehicles"]
    for key, column in design["gains"].items():
        assert [row[key] for row in rows] == column
    for row in rows:
        assert float(row["torque_bound"]) <= float(row["torque_limit"])
        assert float(row["margin"]) >= 0
    runs = []
    for gains in ("design.json", "gains.csv"):  # psi of the table lies beside it
        done = gaincert(
            *(
                "simulate",
                EXAMPLES / "paper.toml",
                "--gains",
                out / gains,
                "-o",
                out / gains[:4],
                "--horizon",
                30,
                "--json",
            )
        )
        assert done.returncode == 0, done.stderr
        runs.append(json.loads(done.stdout))
    assert runs[0]["final_position_error_m"] == runs[1]["final_position_error_m"]
    assert runs[0]["controller_digest"] == runs[1]["controller_digest"]
    assert runs[0]["controller_digest"] in (out / "gains.psi.toml").read_text()


def test_the_certificate_verifies_and_belongs_to_its_fleet(out: Path) -> None:
    certificate = out / "certificate.json"
    assert gaincert("verify", certificate).returncode == 0
    assert gaincert("verify", certificate, "--fleet", EXAMPLES / "paper.toml").returncode == 0
    other = gaincert("verify", certificate, "--fleet", EXAMPLES / "mixed_ring.toml")
    assert other.returncode == 1
    assert "not of the fleet" in other.stdout
    alone = subprocess.run(
        [sys.executable, "-I", ROOT / "verify" / "kernel.py", certificate], capture_output=True, text=True, check=False
    )
    assert alone.returncode == 0, alone.stdout + alone.stderr


def test_trajectory_has_the_arrays_of_the_contract(out: Path) -> None:
    with np.load(out / "trajectory.npz", allow_pickle=False) as run:
        count = len(run["t"])
        for name in ("x", "y", "theta", "v", "omega", "tau_left", "tau_right"):
            assert run[name].shape == (count, 6)
        assert run["V"].shape == run["W"].shape == (count,)


def test_the_papers_gains_are_certified_under_its_own_conditions_only(tmp_path: Path) -> None:
    gains = EXAMPLES / "paper_gains.toml"
    good = gaincert("certify", EXAMPLES / "paper.toml", "--gains", gains, "-o", tmp_path)
    assert good.returncode == 0, good.stderr
    assert (tmp_path / "certificate.json").exists()
    bad = gaincert(
        "certify", EXAMPLES / "paper.toml", "--gains", gains, "-o", tmp_path / "bad", "--conditions", "rate-bounded"
    )
    assert bad.returncode == 1
    assert "vehicle 'v2'" in bad.stdout
    assert "(15')" in bad.stdout
    assert not (tmp_path / "bad" / "certificate.json").exists()


@pytest.mark.parametrize("template", [template.value for template in Template])
def test_init_writes_what_check_accepts(template: str, tmp_path: Path) -> None:
    fleet = tmp_path / "fleet.toml"
    assert gaincert("init", fleet, "--template", template).returncode == 0
    done = gaincert("check", fleet, "--json")
    assert done.returncode == 0
    assert json.loads(done.stdout)["vehicles"] in (5, 6)
    again = gaincert("init", fleet)
    assert again.returncode == 2
    assert "already there" in again.stderr


@pytest.mark.parametrize("example", sorted(path.name for path in EXAMPLES.glob("*.toml") if "gains" not in path.name))
def test_every_example_is_a_fleet(example: str) -> None:
    assert gaincert("check", EXAMPLES / example).returncode == 0


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (["check", "absent.toml"], 2, "absent.toml: cannot be read"),
        (["check", EXAMPLES], 2, "cannot be read"),
        (["design", EXAMPLES / "paper.toml", "-o", "x", "--conditions", "none"], 2, "none"),
        (["design", EXAMPLES / "paper.toml", "-o", "x", "--excitation", "given"], 2, "no [excitation] table"),
        (["simulate", EXAMPLES / "paper.toml", "--gains", "absent.csv", "-o", "x"], 2, "absent.csv"),
        (["simulate", EXAMPLES / "paper.toml", "--gains", "gains.txt", "-o", "x"], 2, ".toml"),
        (
            ["certify", EXAMPLES / "mixed_ring.toml", "--gains", EXAMPLES / "paper_gains.toml", "-o", "x"],
            2,
            "10 numbers",
        ),
        (["verify", EXAMPLES / "paper.toml"], 2, "paper.toml"),
        (["report", "absent"], 2, "absent"),
        (["design", EXAMPLES / "paper.toml", "-o", "x", "--tolerance", "-1", "0.1"], 2, "--tolerance -1 0.1"),
    ],
)
def test_bad_input_is_one_message_and_never_a_traceback(
    arguments: list[object], code: int, message: str, tmp_path: Path
) -> None:
    done = gaincert(*arguments, cwd=tmp_path)
    assert done.returncode == code
    assert message in done.stderr
    assert "Traceback" not in done.stderr
    assert not list(tmp_path.iterdir())  # nothing is left behind


def test_an_infeasible_fleet_is_exit_3(tmp_path: Path) -> None:
    text = (EXAMPLES / "turtlebot3_line.toml").read_text().replace("v = 0,", "v = 1,", 1)
    (tmp_path / "fast.toml").write_text(text)
    done = gaincert("design", tmp_path / "fast.toml", "-o", tmp_path / "out")
    assert done.returncode == 3
    assert "vehicle 'v1': start v = 1 is beyond its certified limit 0.22" in done.stderr


def test_no_folder_can_be_made_where_a_file_is(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    arguments = ["simulate", EXAMPLES / "paper.toml", "--gains", EXAMPLES / "paper_gains.toml", "--horizon", 1]
    done = gaincert(*arguments, "-o", tmp_path / "file" / "out")
    assert done.returncode == 2
    assert "cannot be written" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("arguments", [["--help"], ["check", str(EXAMPLES / "paper.toml")], ["verify", "--help"]])
def test_light_verbs_load_no_solver_no_sympy_and_no_plotting(arguments: list[str]) -> None:
    script = (
        "import sys\nsys.argv = ['gaincert', *sys.argv[1:]]\n"
        "from gaincert.cli import main\n"
        "try:\n    main()\nexcept SystemExit as end:\n    assert not end.code, end.code\n"
        f"print('LOADED', [name for name in {HEAVY!r} if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", script, *arguments], capture_output=True, text=True, check=True)
    assert done.stdout.strip().endswith("LOADED []")


def test_import_gaincert_is_light() -> None:
    script = f"import gaincert, sys; print([n for n in {(*HEAVY, 'numpy', 'pydantic')!r} if n in sys.modules])"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_help_takes_less_than_ten_times_bare_python() -> None:
    """Processor time, the best of some interleaved runs of each, so that machine load does not matter."""

    def seconds(*arguments: str) -> float:
        begin = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, *arguments], check=True, capture_output=True)
        end = resource.getrusage(resource.RUSAGE_CHILDREN)
        return end.ru_utime - begin.ru_utime + end.ru_stime - begin.ru_stime

    pairs = [(seconds("-m", "gaincert", "--help"), seconds("-c", "pass")) for _ in range(7)]
    assert min(pair[0] for pair in pairs) < 10 * min(pair[1] for pair in pairs)


def test_a_sampled_simulation_is_reported_against_the_nominal_one(tmp_path: Path) -> None:
    gains = EXAMPLES / "paper_gains.toml"
    options = ("--sample-time", "0.02", "--horizon", "10", "--json")
    done = gaincert("simulate", EXAMPLES / "paper.toml", "--gains", gains, "-o", tmp_path, *options)
    assert done.returncode == 0, done.stderr
    summary = json.loads(done.stdout)
    assert summary == json.loads((tmp_path / "summary.json").read_text())
    assert summary["disturbance"] == {"sample_time": 0.02}
    apart = abs(summary["final_position_error_m"] - summary["nominal"]["final_position_error_m"])
    assert 0 < apart < 0.1
    with np.load(tmp_path / "trajectory.npz", allow_pickle=False) as stored:
        assert stored["x"].shape == (100, 6)


@pytest.mark.slow
def test_a_design_is_compared_with_other_gains_from_the_same_starts(tmp_path: Path) -> None:
    fleet = tmp_path / "fleet.toml"
    assert gaincert("init", fleet, "--template", "line", "--vehicles", "1").returncode == 0
    gains = tmp_path / "mine.toml"
    gains.write_text("p_v = 0.4\nd_v = 1\np_omega = 0.1\nd_omega = 0.3\nk_alpha = 0.1\n")
    options = ("--conditions", "corrected", "--mode", "draft", "--against", gains, "--json")
    done = gaincert("design", fleet, "-o", tmp_path / "out", *options)
    assert done.returncode == 2  # gains need the psi that they are for
    assert not (tmp_path / "out").exists()
    gains.write_text(gains.read_text() + '[excitation]\nfamily = "harmonics"\nfrequency = 1\nsin = [1]\n')
    done = gaincert("design", fleet, "-o", tmp_path / "out", *options)
    assert done.returncode == 0, done.stderr
    rows = json.loads(done.stdout)["compared"]
    assert [row["name"] for row in rows] == ["this design", "mine"]
    assert rows[0]["settled"] == "20 of 20"
    assert (tmp_path / "out" / "mine" / "validation.json").is_file()


@pytest.mark.parametrize("given", [True, False])
def test_a_comparison_takes_every_choice_but_the_one_that_was_made(given: bool) -> None:
    fleet = SimpleNamespace(psi=object() if given else None)
    gains = SimpleNamespace(saturation=Saturation(position=0.3))
    made = SimpleNamespace(conditions=SimpleNamespace(name="paper"), excitation_designed=True, links=None, gains=gains)
    options = DesignOptions("best", "paper", "designed", None, "given", 0, 4, 600.0, Tolerance(), 1.0, None)
    *others, unit = variants_of(fleet, made, options)
    variants = [(v.conditions, v.excitation, v.weights) for v in others]
    assert len(set(variants)) == len(variants) == (11 if given else 5)
    assert ("paper", "designed", "given") not in variants
    assert any(choice[1] == "given" for choice in variants) == given
    assert (unit.conditions, unit.excitation, unit.weights, unit.saturation) == ("paper", "designed", "given", "unit")


# -- the application ---------------------------------------------------------------------------------------------------


def test_the_version_is_printed() -> None:
    assert gaincert("--version").stdout == f"gaincert {__version__}\n"


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_a_shell_gets_its_completion(shell: str) -> None:
    environment = {**os.environ, "_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION": "1"}
    command = [sys.executable, "-m", "gaincert", "--show-completion", shell]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
    assert "_GAINCERT_COMPLETE" in done.stdout or "COMPLETE" in done.stdout


def test_completion_knows_the_verbs() -> None:
    environment = {**os.environ, "_GAINCERT_COMPLETE": "complete_bash", "COMP_WORDS": "gaincert va", "COMP_CWORD": "1"}
    script = "import sys; sys.argv[0] = 'gaincert'; from gaincert.cli import main; main()"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True, env=environment)
    assert done.stdout.split() == ["validate"]


@pytest.mark.parametrize("verb", [command.name or command.callback.__name__ for command in app.registered_commands])
def test_every_verb_and_every_option_says_what_it_does(verb: str) -> None:
    command = get_command(app).commands[verb]
    assert command.help
    names = {name for parameter in command.params for name in parameter.opts}
    assert {"--json", "-q", "-v"} <= names
    for parameter in command.params:
        assert parameter.help, parameter.name


def test_a_chaotic_run_is_called_sensitive_and_not_wrong() -> None:
    calm = Summary(
        settling_time=400.0,
        approach=Approach.CLOSING_IN,
        tolerance=Tolerance(),
        horizon=600.0,
        peak_torque_ratio=0.5,
        final_position_error=0.01,
        final_heading_error=0.01,
        max_V_increase=0.0,
        peak_speed=1.0,
        peak_turn_rate=1.0,
        violations=(),
        integration_error=IntegrationError(1e-9, 1e-9),
    )
    chaotic = replace(calm, integration_error=IntegrationError(9.0, 1.0))
    assert "error below" not in sentence(chaotic)
    assert "sensitive" in " ".join(hints(chaotic))
    assert "integration error below 1e-09 m" in sentence(calm)
    assert hints(calm) == []


def test_validate_runs_long_enough_to_see_the_fleet_settle() -> None:
    """The paper's gains need some thousand seconds, more than a fixed default of 300 s."""
    fleet = paper_fleet()
    gains = GainsFile(paper_gains(), paper_excitation(), "paper")
    horizon = default_horizon(fleet, gains, Tolerance())
    assert 3000 < horizon <= 20_000
    assert horizon == float(f"{horizon:.1e}")  # two digits: no processor changes it
    assert 300 <= default_horizon(fleet, gains, Tolerance(5.0, 3.0)) < horizon
