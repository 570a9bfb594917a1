""".ci/run installs the tools that tests need if it may, continues if it cannot, and says so in its last lines."""

import shutil
import subprocess
from pathlib import Path

import pytest

RUN = Path(__file__).parents[2] / ".ci" / "run"
PLAIN = ("bash", "cat", "chmod", "dirname", "env", "mkdir", "timeout", "touch", "tr")


@pytest.fixture
def ci(tmp_path):
    """(stub programs, environment) -> a run of .ci/run with only these and a few plain programs on the PATH."""
    programs = tmp_path / "bin"
    programs.mkdir()
    (tmp_path / ".ci").mkdir()
    shutil.copy(RUN, tmp_path / ".ci" / "run")
    for name in PLAIN:
        (programs / name).symlink_to(shutil.which(name))

    def run(stubs, **environment):
        always = {"id": "echo 0", "sleep": "exit 0", "make": 'echo "made $1"', "python3": "exit 2"}
        for name, text in {**always, **stubs}.items():
            (programs / name).write_text(f"#!/bin/sh\n{text}\n")
            (programs / name).chmod(0o755)
        return subprocess.run(
            [tmp_path / ".ci" / "run"],
            env={"PATH": str(programs), **environment},
            capture_output=True,
            text=True,
            check=False,
        )

    return run


def test_it_goes_on_where_nothing_can_be_installed(ci):
    done = ci({"apt-get": "echo $* >> calls; exit 1"}, CI="true")
    lines = done.stdout.splitlines()
    assert done.returncode == 0, done.stderr
    assert lines[:3] == ["made check", "made docs", "made test"]
    for program in ("chromium", "pdflatex", "ffmpeg", "coqc"):
        assert sum(line.startswith(f"note: {program} could not be installed") for line in lines) == 1
    assert lines[-1] == "note: the proof was not checked: Coq or one of its libraries is missing"


def test_it_tries_three_times_and_installs(ci, tmp_path):
    chromium = tmp_path / "bin" / "chromium"
    apt = f"""echo "$1" >> calls
case $(cat calls | tr -d '\\n') in
*updateinstallupdateinstallupdateinstall) touch {chromium}; chmod +x {chromium} ;;
*install) exit 1 ;;
esac"""
    others = dict.fromkeys(("pdflatex", "ffmpeg", "coqc"), "exit 0")
    done = ci({**others, "apt-get": apt, "python3": "exit 0"}, CI="true")
    assert done.returncode == 0, done.stderr
    assert "note:" not in done.stdout
    assert (tmp_path / "calls").read_text().split() == ["update", "install"] * 3


def test_nothing_is_installed_outside_ci(ci, tmp_path):
    done = ci({"apt-get": "touch called"})
    assert done.returncode == 0, done.stderr
    assert not (tmp_path / "called").exists()
    assert "note: ffmpeg is missing (apt-get install ffmpeg): its tests were skipped" in done.stdout


def test_a_failure_is_a_failure_and_the_notes_are_still_printed(ci):
    done = ci({"make": 'test "$1" != test'})
    assert done.returncode != 0
    assert done.stdout.splitlines()[-1].startswith("note: ")


def test_a_false_proof_is_a_failure(ci):
    done = ci({"python3": "exit 1"})
    assert done.returncode == 1
    assert "made test" not in done.stdout
