"""The kernel as a program: exit codes, faults of the machine, memory."""

from __future__ import annotations

import io
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from gaincert.verify import kernel

from tests.campaigns.certified_fleets import CASES
from tests.verify.certificate_documents import document, reason, single

SOURCE = Path(kernel.__file__)
TEXT = json.dumps(document())


def run(*arguments: str, **more: Any) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-I", str(SOURCE), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=60, **more)


def test_it_runs_alone(tmp_path: Path) -> None:
    path = tmp_path / "certificate.json"
    path.write_text(TEXT)
    done = run(str(path))
    assert done.returncode == 0 and done.stdout.startswith("VALID") and "asymptotically stable" in done.stdout
    assert run(str(path), "sha256:0").returncode == 1
    path.write_text(TEXT.replace('"2.43232821109"', '"2.43"'))
    done = run(str(path))
    assert done.returncode == 1 and done.stdout.startswith("INVALID: psi_bounded")
    path.write_bytes(b"\xff\xfe{")
    done = run(str(path))
    assert done.returncode == 2 and "REFUSED" in done.stderr and "Traceback" not in done.stderr
    for arguments in ([str(tmp_path / "absent")], [str(tmp_path)], [], ["a", "b", "c"], ["a\nb"]):
        assert run(*arguments).returncode == 2


def test_its_exit_code_is_its_verdict(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, digest = tmp_path / "certificate.json", CASES["paper"]().fleet.digest
    path.write_text(TEXT)
    for arguments, code, said, refused in (
        ([str(path)], 0, "VALID\nfleet sha256:", ""),
        ([str(path), digest], 0, "VALID\nfleet sha256:", ""),
        ([str(path), "sha256:0"], 1, "INVALID: same_fleet: the certificate is of the fleet sha256:", ""),
    ):
        assert kernel.main(arguments) == code
        out, err = capsys.readouterr()
        assert out.startswith(said) and err.startswith(refused) and bool(err) == bool(refused)


@pytest.mark.parametrize("arguments", [[], ["a", "b", "c"]])
def test_the_command_line_has_one_or_two_arguments(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert kernel.main(arguments) == 2
    assert capsys.readouterr().err == "REFUSED: usage: python -I kernel.py CERTIFICATE.json [DIGEST OF THE FLEET]\n"


class Disk(io.StringIO):
    """Standard output on a full disk: what is written fails when it is flushed."""

    closings = 0

    def flush(self) -> None:
        raise OSError(28, "No space left on device")

    def close(self) -> None:
        self.closings += 1
        raise OSError(28, "No space left on device")


def test_what_is_not_written_is_a_fault(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path, disk = tmp_path / "certificate.json", Disk()
    path.write_text(TEXT)
    monkeypatch.setattr(sys, "stdout", disk)
    assert kernel.main([str(path)]) == 5 and disk.closings == 1
    said = capsys.readouterr().err
    assert said.startswith("FAULT: OSError") and said.endswith("nothing is said of the certificate\n")
    monkeypatch.setattr(sys, "stderr", None)
    assert kernel.main([str(path)]) == 5
    assert kernel.main([str(tmp_path / "absent")]) == 2


FAULTS = {
    "no memory": "ulimit -v 60000; ",
    "a full disk": "exec > /dev/full; ",
    "no standard output": "exec >&-; ",
}


@pytest.mark.parametrize("kind", FAULTS)
def test_a_fault_is_no_verdict(kind: str, tmp_path: Path) -> None:
    """Exit code 5 and no traceback; nothing else than VALID or INVALID is 0 or 1."""
    path = tmp_path / "certificate.json"
    path.write_text(TEXT)
    if kind == "no memory":
        path.write_text(TEXT.replace('"notes": [', '"padding": "' + "x" * 40_000_000 + '", "notes": ['))
    command = f"{FAULTS[kind]}{sys.executable} -I {SOURCE} {path}"
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 5, (done.returncode, done.stdout[:200], done.stderr[:500])
    assert "FAULT: " in done.stderr and "nothing is said of the certificate" in done.stderr
    assert "Traceback" not in done.stderr and "Exception ignored" not in done.stderr


def test_a_reader_that_leaves_is_a_fault(tmp_path: Path) -> None:
    path = tmp_path / "certificate.json"
    path.write_text(TEXT)
    command = f"({sys.executable} -I {SOURCE} {path}; echo code $? >&2) | true"
    done = subprocess.run(
        ["bash", "-c", f"sleep 0; {command}"], capture_output=True, text=True, check=False, timeout=60
    )
    assert "Traceback" not in done.stderr and "Exception ignored" not in done.stderr
    assert "code 5" in done.stderr or "code 0" in done.stderr


def test_an_ordinary_certificate_needs_little_memory(tmp_path: Path) -> None:
    path = tmp_path / "certificate.json"
    path.write_text(TEXT)
    command = f"ulimit -v 200000; {sys.executable} -I {SOURCE} {path}"
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 0, done.stderr


def test_a_file_is_read_in_pieces(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "certificate.json"
    path.write_bytes(b"x" * 3_000_000)
    assert kernel.read(path) == b"x" * 3_000_000
    for most, pieces in ((10, 1), (2**20, 2)):  # more than MAX_BYTES, so that it is seen to be too large
        monkeypatch.setattr(kernel, "MAX_BYTES", most)
        assert len(kernel.read(path)) == pieces * 2**20
    for absent in (tmp_path, str(tmp_path / "absent"), "a\0b"):
        with pytest.raises(kernel.UnreadableError, match="cannot be read"):
            kernel.read(absent)


def test_want_of_memory_is_not_a_verdict(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def exhausted(_: Any) -> Any:
        raise MemoryError

    path = tmp_path / "certificate.json"
    path.write_text(TEXT)
    monkeypatch.setattr(kernel, "read_claims", exhausted)
    with pytest.raises(MemoryError):
        kernel.check_data(TEXT.encode())
    monkeypatch.setattr(sys, "stdout", io.StringIO())  # which a fault closes
    assert kernel.main([str(path)]) == 5


def test_deep_nesting_is_refused() -> None:
    deep = json.dumps({**document(), "fleet": json.loads("[" * 900 + "]" * 900)})
    for text in ("[" * 19_000, '{"a":' * 4_000, deep):
        with pytest.raises(kernel.UnreadableError):
            kernel.check_data(text.encode())


def test_a_rule_that_fails_is_named() -> None:
    assert reason(single("5")).startswith("INVALID: conditions: (16*): vehicle 1: 6 exceeds 5 by 1")
