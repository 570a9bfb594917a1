"""What VALID says, and how the kernel ends as a program."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from gaincert.models.files.fleet_file import parse
from gaincert.models.fleet import Fleet, digest_of
from gaincert.models.fleet_content import excitation_content
from gaincert.verify import kernel

from tests.campaigns.certified_fleets import CASES
from tests.verify.certificate_documents import check, document, harmonics, single, with_limit

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
    first, fleet = check(document()).digests, document()["fleet"]
    edges, led = fleet["edges"], fleet["leader_links"]
    assert first == {
        "fleet": digest_of(fleet),
        "graph": digest_of(
            {
                "vehicles": 6,
                "edges": [edges["tail"], edges["head"], edges["weight"]],
                "leader_links": [led["vehicle"], led["weight"]],
            }
        ),
        "gains": digest_of(document()["gains"]),
        "psi": digest_of(fleet["excitation"]),
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
    assert kernel.each(1, range(20), list(range(20))).count("(vehicle") == 20
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
