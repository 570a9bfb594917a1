"""What an adversarial review of the kernel and its producer found: each was wrong once."""

import json
import time
from fractions import Fraction
from math import comb
from pathlib import Path

import pytest
from gaincert.models.arrays import column
from gaincert.models.errors import InputError
from gaincert.models.excitation import Excitation
from gaincert.models.fleet import Fleet
from gaincert.models.gains import Gains
from gaincert.verify import kernel
from gaincert.verify.certificates.arcs import arcs
from gaincert.verify.certificates.certificate import Certificate, verify
from gaincert.verify.certificates.certify import certify

from tests.verify.certificate_documents import check, harmonics, single


def lone_robot(torque: int = 100) -> Fleet:
    vehicle = {"name": "a", "mass": 1, "inertia": 1, "half_track": 1, "wheel_radius": 1, "offset": [0, 0]}
    return Fleet.model_validate(
        {
            "name": "one",
            "leader": {"position": [0, 0], "heading": 0},
            "graph": {"leader_links": {"a": 1}},
            "vehicle": [{**vehicle, "torque_limit": torque}],
        }
    )


def gains(d_v: str = "1") -> Gains:
    return Gains(*(column([Fraction(value)]) for value in ("1", d_v, "1", "1", "1")))


def tone(amplitude: str, frequency: str = "1") -> Excitation:
    return Excitation(Fraction(0), Fraction(frequency), (Fraction(amplitude),))


def test_the_theorem_states_psi_bar_and_rates_as_they_stand_in_the_certificate() -> None:
    """Twelve rounded digits would be another, false, statement."""
    document = json.loads(certify(lone_robot(), tone("1.0000000000004"), gains(), "corrected").to_json())
    document["psi_bar"] = "1.00000000000040000001"
    document["arcs"] = arcs(document["designed"]["excitation"], document["psi_bar"])
    document["rates"]["gamma_v"] = None
    verdict = check(document)
    assert verdict.valid, verdict
    assert any("|psi| <= 1.00000000000040000001 = psi_bar" in line for line in verdict.theorem)
    certificate = certify(lone_robot(), tone("1"), gains("1.9999999999998"), "corrected")
    stated = certificate.content["rates"]["gamma_v"]["rate"].rstrip("0")
    assert any(f"-{stated} " in line for line in certificate.verdict.theorem)


def test_the_rate_of_the_headings_is_claimed_without_the_excitation() -> None:
    """With psi the linearised headings are driven by the cross-track errors, which do not fall at all."""
    (line,) = (line for line in certify(lone_robot(), tone("1"), gains(), "corrected").facts if "omega' +" in line)
    assert "where alpha is 0" in line


def test_the_work_on_a_bound_near_the_supremum_is_limited() -> None:
    """200 harmonics and arcs that are as narrow as they may be."""
    document = single()
    document["fleet"]["excitation"] = harmonics(" ".join(["0"] * 199 + ["1"]))
    begin = time.process_time()
    for count, refused in ((360, False), (380, True)):
        document["arcs"] = {"here": " ".join(["79"] * count), "opposite": "0 0"}
        try:
            assert not check(document).valid and not refused
        except kernel.UnreadableError as error:
            assert "arcs: too many" in str(error) and refused
    assert time.process_time() - begin < 10  # seconds of a busy machine; 1 on a quiet one


def test_a_flat_topped_psi_is_bounded_and_certified_in_bounded_time() -> None:
    """psi = 3/2 - cos(t/2)^40 has so flat a top that its supremum is hard to approach; a looser bound serves."""
    n = 20
    powers = [Fraction(comb(2 * n, n - k), 4**n) for k in range(n + 1)]
    cos = tuple(-Fraction(round(2 * value * 10**12), 10**12) for value in powers[1:])
    psi = Excitation(Fraction(3, 2) - Fraction(round(powers[0] * 10**12), 10**12), Fraction(1), (), cos)
    begin = time.process_time()
    certificate = certify(lone_robot(), psi, gains(), "corrected")
    assert time.process_time() - begin < 20
    assert certificate.valid, certificate.verdict


@pytest.mark.parametrize(("amplitude", "frequency"), [("1e-60", "1"), ("1e-30", "1e-60")])
def test_a_tiny_psi_is_certified_or_refused_in_words(amplitude: str, frequency: str) -> None:
    try:
        assert certify(lone_robot(), tone(amplitude, frequency), gains(), "corrected").valid
    except InputError as error:
        assert "digits" in str(error) or "refused" in str(error)


def test_a_certificate_is_read_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The content that is used is the content that the kernel saw."""
    path = tmp_path / "certificate.json"
    certify(lone_robot(), tone("1"), gains(), "corrected").write(path)
    true_check = kernel.check_data

    def check_then_swap(data: bytes | bytearray, digest: str | None = None) -> kernel.Verdict:
        verdict = true_check(data, digest)
        path.write_text(path.read_text().replace('"k_alpha": "1"', '"k_alpha": "300"'))
        return verdict

    monkeypatch.setattr(kernel, "check_data", check_then_swap)
    certificate = Certificate.read(path)
    assert '"k_alpha": "300"' in path.read_text()
    assert certificate.valid
    assert certificate.gains.k_alpha[0] == 1


@pytest.mark.parametrize("digits", [61, 100])
def test_long_numbers_are_exported_or_refused_in_words(digits: int, tmp_path: Path) -> None:
    """Numbers that the kernel reads and the fleet file does not."""
    path = tmp_path / "certificate.json"
    certificate = certify(lone_robot(), tone("1"), gains(), "corrected")
    content = json.loads(certificate.to_json())
    content["gains"]["k_alpha"] = "1." + "0" * (digits - 1) + "1"
    content["designed"]["excitation"]["sin"] = "0." + "9" * digits
    content["margins"] = {"(16*)": "0"}
    content["rates"] = {"gamma_omega": None, "gamma_v": None}
    path.write_text(json.dumps(content))
    found = Certificate.read(path, lone_robot())
    assert found.valid, found.verdict
    assert found.gains.k_alpha[0] == 1 + Fraction(1, 10**digits)
    assert found.excitation.sin == (1 - Fraction(1, 10**digits),)


def test_a_byte_order_mark_is_refused_by_all_who_read(tmp_path: Path) -> None:
    path = tmp_path / "certificate.json"
    certify(lone_robot(), tone("1"), gains(), "corrected").write(path)
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    for reader in (Certificate.read, verify):
        with pytest.raises(InputError, match="BOM"):
            reader(path)
    assert kernel.main([str(path)]) == 2


def test_values_of_one_hash_do_not_stall_the_kernel() -> None:
    """Integers 1 + k (2^61 - 1) have one hash: a table keyed by them would take a quadratic time."""
    count = 20_000
    content = json.loads(certify(lone_robot(), tone("1"), gains(), "corrected").to_json())
    prime = 2**61 - 1
    values = [1 + k * prime for k in range(1, count + 1)]
    fleet = content["fleet"]
    fleet["vehicles"] = count
    for name in ("mass", "inertia", "half_track", "wheel_radius", "torque_left", "torque_right"):
        fleet[name] = " ".join(map(str, values))
    for name in ("offset_x", "offset_y", "wheel_inertia"):
        fleet[name] = " ".join("0" * count)
    fleet["leader_links"] = {"vehicle": " ".join(map(str, range(count))), "weight": " ".join(map(str, values))}
    fleet["limits"]["speed"] = {"vehicle": " ".join(map(str, range(count))), "value": " ".join(map(str, values))}
    for name in ("p_v", "d_v", "p_omega", "d_omega", "k_alpha", "speed_scale", "turn_rate_scale"):
        content["gains"][name] = " ".join(map(str, values))
    content["tree"] = {"link": " ".join(["-1"] * count), "depth": " ".join("0" * count)}
    content["margins"] = {"(16*)": " ".join("0" * count), "speed": " ".join("0" * count)}
    content["rates"] = {"gamma_omega": None, "gamma_v": None}
    begin = time.process_time()
    assert check(content).rule == "conditions"
    assert time.process_time() - begin < 5
