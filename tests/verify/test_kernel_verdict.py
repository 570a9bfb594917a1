"""What VALID says, and how the kernel ends as a program."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from gaincert.models.files.fleet_file import parse
from gaincert.models.fleet import Fleet, digest_of
from gaincert.models.fleet_content import excitation_content
from gaincert.verify import kernel

from tests.campaigns.certified_fleets import CASES
from tests.verify.certificate_documents import check, document, harmonics, reason, single, with_limit

SOURCE = Path(kernel.__file__)
OBJECTS = (
    "fleet sha256:",
    "graph sha256:",
    "gains sha256:",
    "psi   sha256:",
    "Drive ",
    "Conditions ",
    "Saturation scales: ",
)
ALWAYS = ("From every initial state, the closed loop", "From every initial state and at all times, no wheel torque")
TURNING = "|omega_i(t)| <= max(|omega_i(t0)|, o_i atanh"
FAST, QUICK = "|v_i(t)| <= max(|v_i(t0)|, limit)", "|omega_i(t)| <= max(|omega_i(t0)|, limit)"
COVERED = "Covered: every value in its interval of "
HEADINGS, ALONG = "Linearised at the formation, the headings", "Linearised at the formation, the along-track"


@pytest.mark.parametrize(
    ("name", "own"),
    [
        ("paper", (HEADINGS, ALONG)),
        ("mixed_ring", (TURNING, FAST, QUICK, *[COVERED] * 6, HEADINGS, ALONG)),
        ("line", (*[COVERED] * 6, HEADINGS, ALONG)),
    ],
)
def test_the_theorem_has_a_sentence_for_each_claim_and_no_other(name: str, own: tuple[str, ...]) -> None:
    content = document(name)
    lines = check(content).theorem
    begins = (*OBJECTS, *ALWAYS, *own)
    assert len(lines) == len(begins), lines
    assert all(line.startswith(begin) for line, begin in zip(lines, begins, strict=True))
    for line, key in zip(lines[-2:], ("gamma_omega", "gamma_v"), strict=True):
        assert line.endswith(f"no exponent above -{content['rates'][key]['rate']} 1/s.")
        less = {**content, "rates": {**content["rates"], key: None}}
        assert check(less).theorem == tuple(kept for kept in lines if kept != line)


def test_every_object_is_named_by_its_digest() -> None:
    """Another number anywhere changes the digest of its part, and of no other part."""
    first = check(document()).digests
    assert first == {
        "fleet": digest_of(document()["fleet"]),
        "graph": first and first["graph"],
        "gains": digest_of(document()["gains"]),
        "psi": digest_of(document()["fleet"]["excitation"]),
    }
    assert all(f"sha256:{line[13:77]}" in first.values() for line in check(document()).theorem[:4])

    def changed(content: dict[str, Any]) -> set[str]:
        found = kernel.read_claims(content).digests
        return {name for name in found if found[name] != first[name]}

    content = document()
    content["gains"]["k_alpha"] = "2 1 3 1 3 3"
    assert changed(content) == {"gains"}
    content = document()
    content["gains"]["heading_scale"] = "2"
    assert changed(content) == {"gains"}
    content = document()
    content["fleet"]["mass"] = "11 10 36 36 23 23"
    assert changed(content) == {"fleet"}
    content = document()
    content["fleet"]["edges"]["weight"] = "1 1 1 1 1 1 2"
    assert changed(content) == {"fleet", "graph"}
    content = document()
    content["designed"]["weights"] = {"edges": "1 1 1 1 1 1 2", "leader_links": "10 10"}
    assert changed(content) == {"graph"}
    content = document()
    content["designed"]["excitation"] = harmonics("1")
    assert changed(content) == {"psi"}
    content = document()
    content["psi_bar"] = "3"
    assert changed(content) == set()


def test_names_do_not_count() -> None:
    fleet = CASES["line"]().fleet
    renamed = fleet.model_dump(mode="json", by_alias=True)
    text = json.dumps(renamed)
    for vehicle in fleet.names:
        text = text.replace(f'"{vehicle}"', f'"robot {vehicle}"')
    other = Fleet.model_validate(json.loads(text))
    assert other.names != fleet.names and other.digest == fleet.digest
    assert check(document("line"), other.digest).valid


def test_a_digest_that_is_not_the_fleets_is_refused() -> None:
    content, fleet = document(), CASES["paper"]().fleet
    assert check(content, fleet.digest).valid
    assert "is of the fleet sha256:" in check(content, "sha256:" + "0" * 64).reason
    assert check(content, "sha256:" + "0" * 64).rule == "same_fleet"
    assert not check(document("line"), fleet.digest).valid


@pytest.mark.parametrize("name", CASES)
def test_the_fleets_digest_is_that_of_the_fleet_file(name: str) -> None:
    import tomllib
    from decimal import Decimal

    from gaincert.models.files.fleet_text import dumps

    fleet = CASES[name]().fleet
    again = parse(tomllib.loads(dumps(fleet), parse_float=Decimal))
    verdict = check(document(name))
    assert verdict.digests and verdict.digests["fleet"] == again.digest
    assert verdict.digests["psi"] == digest_of(excitation_content(CASES[name]().psi))


@pytest.mark.parametrize(
    ("drive", "words"),
    [
        ("physical", "Drive 'physical': I omega' = (R / r) (tau_right - tau_left)."),
        ("paper", "these torques are positive feedback: NOTHING is certified for it."),
    ],
)
def test_the_drive_is_said_in_words(drive: str, words: str) -> None:
    content = single()
    content["fleet"]["drive"] = drive
    (line,) = (line for line in check(content).theorem if line.startswith("Drive"))
    assert line.endswith(words)


LIMITS = {
    "speed": ("|v_i(t)| <= max(|v_i(t0)|, limit)", "m/s"),
    "turn_rate": ("|omega_i(t)| <= max(|omega_i(t0)|, limit)", "rad/s"),
    "wheel_speed": ("From rest, no wheel turns faster than the limit", "rad/s"),
    "acceleration": ("|v_i'(t)| <= limit from every state", "m/s^2"),
    "turn_acceleration": ("|omega_i'(t)| <= limit from every state", "rad/s^2"),
}


@pytest.mark.parametrize("name", LIMITS)
def test_every_certified_limit_is_printed_with_its_number(name: str) -> None:
    content = with_limit(single(), name, "1.25")
    content["gains"] |= {"d_v": "3", "d_omega": "9"}
    content["fleet"] |= {"mass": "100", "inertia": "100"}
    content["rim_speed"] = "0.9" if name == "wheel_speed" else ""
    claim, unit = LIMITS[name]
    words = f"{claim}, t >= t0, with the {name.replace('_', ' ')} limit 1.25 {unit} of 1 vehicles."
    assert words in check(content).theorem


def test_limits_and_torques_of_few_vehicles_are_printed_one_by_one() -> None:
    text = "\n".join(check(document("mixed_ring")).theorem)
    assert (
        "speed limit 0.8 (vehicle 1), 0.8 (vehicle 4), 1.5 (vehicle 5), 0.8 (vehicle 7), 0.8 (vehicle 10) m/s" in text
    )
    assert "turn rate limit 0.9 rad/s of 1 vehicles" in text
    assert "Constraint 1): 55 (vehicle 1), 160 (vehicle 2), 54 (vehicle 3), 1.4 (vehicle 4), 1.1 (vehicle 5), " in text
    assert kernel.each(10, range(2), [5, 15]) == "0.5 (vehicle 1), 1.5 (vehicle 2)"
    assert kernel.each(10, range(30), [5] * 30) == "0.5"
    assert kernel.each(10, range(21), list(range(21))) == "0 to 2"


def test_intervals_that_are_covered_are_named() -> None:
    text = "\n".join(check(document("mixed_ring")).theorem)
    for name in ("mass", "inertia", "half track", "wheel radius", "torque left", "torque right"):
        assert f"Covered: every value in its interval of {name}, which 2 vehicles have." in text
    assert "Covered" not in "\n".join(check(document()).theorem)


def test_designed_parts_are_said_and_counted() -> None:
    content = document()
    lines = check(content).theorem
    assert lines[1].endswith(": 7 links of vehicles, 2 to the leader, weights of the fleet file")
    assert lines[3].endswith(": of the fleet file, |psi| <= 2.43232821109 = psi_bar")
    content["designed"]["weights"] = {"edges": "1.0 1.0 1.0 0.5 1.0 1.0 0.5", "leader_links": "10.0 9.0"}
    content["designed"]["excitation"] = content["fleet"]["excitation"]
    content["rates"] = dict.fromkeys(kernel.RATES)
    lines = check(content).theorem
    assert lines[1].endswith(": 7 links of vehicles, 2 to the leader, weights from the gains file, 3 of them changed")
    assert ": from the gains file, |psi| <= " in lines[3]


def test_the_scales_are_printed() -> None:
    content = single()
    content["gains"] |= {
        "position_scale": "0.25",
        "heading_scale": "0.5",
        "speed_scale": "2",
        "turn_rate_scale": "3.50",
    }
    assert "Saturation scales: 0.25 m, 0.5 rad; of v 2 m/s; of omega 3.5 rad/s." in check(content).theorem


def test_numbers_are_printed_in_full() -> None:
    """Twelve rounded digits would be another, false, statement."""
    assert kernel.exact(10**70 + 1, 10**60) == "1" + "0" * 10 + "." + "0" * 59 + "1"
    assert kernel.exact(-15, 10) == "-1.5" and kernel.exact(0, 10) == "0" and kernel.exact(1500, 1) == "1500"
    content = single(psi_bar="1.00000000000040000001")
    content["fleet"]["torque_left"] = "9"
    assert any("|psi| <= 1.00000000000040000001 = psi_bar" in line for line in check(content).theorem)


# -- as a program ------------------------------------------------------------------------------------------------------

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
    monkeypatch.setattr(kernel, "MAX_BYTES", 10)
    assert len(kernel.read(path)) == 2**20
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


def test_deep_nesting_is_refused() -> None:
    deep = json.dumps({**document(), "fleet": json.loads("[" * 900 + "]" * 900)})
    for text in ("[" * 19_000, '{"a":' * 4_000, deep):
        with pytest.raises(kernel.UnreadableError):
            kernel.check_data(text.encode())


def test_a_rule_that_fails_is_named() -> None:
    assert reason(single("5")).startswith("INVALID: conditions: (16*): vehicle 1: 6 exceeds 5 by 1")
