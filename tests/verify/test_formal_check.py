"""What `make formal` refuses: gaps in the sources, missing theorems, assumptions that are not standard, no Coq."""

import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from gaincert.verify.formal import check
from gaincert.verify.formal.check import CLAIMS, STANDARD_AXIOMS, NotProvedError, assumptions, digest, gaps, theorems

FORMAL = Path(check.__file__).parent
STATEMENT = "sha256:362fc641e2001a45d686406003aeda235efddd07845de419d913ede6beddd926"


def test_the_statement_is_the_one_that_was_claimed():
    """A change of Statement.v is a change of the claim: it belongs into the changelog and here."""
    assert "sha256:" + hashlib.sha256((FORMAL / "Statement.v").read_bytes()).hexdigest() == STATEMENT


def test_every_claim_is_a_statement():
    text = (FORMAL / "Statement.v").read_text()
    for statement in CLAIMS.values():
        assert f"Definition {statement} : Prop" in text


@pytest.fixture
def sources(tmp_path):
    """The text of Proofs.v -> a folder with it."""

    def write(text):
        (tmp_path / "Proofs.v").write_text(text)
        return tmp_path

    return write


@pytest.mark.parametrize(
    "text",
    [
        "Theorem t : False. Admitted.",
        "Axiom t : False.",
        "Parameter x : nat.",
        "Conjecture t : False.",
        "Lemma t : False. Proof. admit. Admitted.",
        "Unset Guard Checking.",
        "#[bypass_check(guard)] Fixpoint f (n : nat) : False := f n.",
        "(* a comment (* inside another *) *) Axiom t : False.",
        '(* "*) Axiom t : False.',
    ],
)
def test_a_gap_is_found(sources, text):
    assert gaps(sources(text))


@pytest.mark.parametrize(
    "text",
    [
        "(* No Axiom, nothing Admitted. (* Nor here: Parameter. *) *) Lemma t : True. Proof. exact I. Qed.",
        "Section S. Variable x : nat. Hypothesis H : x = x. End S.",
        "Lemma Axiomatic_start : True. Proof. exact I. Qed.",
    ],
)
def test_comments_and_sections_are_no_gap(sources, text):
    assert not gaps(sources(text))


def test_the_sources_have_no_gap():
    assert not gaps()


def test_a_source_with_a_gap_is_not_compiled(sources):
    with pytest.raises(NotProvedError, match=r"Proofs\.v: Admitted"):
        check.check(sources("Theorem t : False. Admitted."))


def test_a_claim_whose_assumptions_are_not_printed_is_named(tmp_path):
    names = [name for _, name in CLAIMS]
    (tmp_path / "Assumptions.v").write_text("\n".join(f"Print Assumptions {name}." for name in names[1:]))
    with pytest.raises(NotProvedError, match="no Print Assumptions for corrected_theorem_holds in"):
        theorems(tmp_path)
    (tmp_path / "Assumptions.v").write_text("\n".join(f"Print Assumptions {name}." for name in names))
    assert theorems(tmp_path) == names


def test_names_of_assumptions_are_read_from_what_coq_prints():
    answer = """Axioms:
ClassicalDedekindReals.sig_not_dec : forall P : Prop, {~ ~ P} + {~ P}
FunctionalExtensionality.functional_extensionality_dep
  : forall (A : Type) (B : A -> Type) (f g : forall x : A, B x),
    (forall x : A, f x = g x) -> f = g
Closed under the global context
Axioms:
loop is assumed to be guarded.
"""
    standard = ["ClassicalDedekindReals.sig_not_dec", "FunctionalExtensionality.functional_extensionality_dep"]
    assert assumptions(answer) == [standard, [], ["loop"]]


def test_the_digest_follows_names_and_contents(sources, tmp_path):
    first = digest(sources("a"))
    second = digest(sources("b"))
    (tmp_path / "Proofs.v").rename(tmp_path / "Other.v")
    assert len({first, second, digest(tmp_path)}) == 3
    (tmp_path / "Proofs.vo").write_text("compiled")
    assert digest(tmp_path) == digest(tmp_path)


def test_without_coq_the_packages_are_named():
    command = [sys.executable, FORMAL / "check.py"]
    done = subprocess.run(command, env={**os.environ, "PATH": ""}, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    for package in ("libcoq-coquelicot", "libcoq-interval", "opam install"):
        assert package in done.stderr


@pytest.fixture(scope="module")
def record():
    return json.loads(check.RECORD.read_text())


def test_the_record_is_of_these_sources(record):
    """After a change of a source, run `make formal` again."""
    assert record["digest"] == digest()
    assert list(record["theorems"]) == theorems()


def test_nothing_but_the_standard_axioms_is_assumed(record):
    assert all(set(axioms) <= STANDARD_AXIOMS for axioms in record["theorems"].values())
    for _, name in CLAIMS:
        assert record["theorems"][name] == sorted(STANDARD_AXIOMS)


@pytest.mark.needs("coqc")
def test_another_axiom_a_missing_proof_and_another_statement_are_refused(tmp_path, monkeypatch):
    """On a small development that stands for the whole: the same steps, in a few seconds."""
    monkeypatch.setattr(check, "LIBRARIES", ())
    (tmp_path / "Makefile").write_text((FORMAL / "Makefile").read_text())
    statements = "".join(f"Definition {statement} : Prop := True.\n" for statement in CLAIMS.values())
    (tmp_path / "Statement.v").write_text(statements)
    for (module, name), statement in CLAIMS.items():
        text = f"From Gaincert Require Import Statement.\nTheorem {name} : {statement}. Proof. exact I. Qed.\n"
        (tmp_path / f"{module}.v").write_text(text)
    asked = "".join(f"Require Import Gaincert.{module}.\nPrint Assumptions {name}.\n" for module, name in CLAIMS)
    (tmp_path / "Assumptions.v").write_text(asked)
    assert set(map(tuple, check.check(tmp_path)["theorems"].values())) == {()}

    theorem = tmp_path / "Theorem.v"
    proved = theorem.read_text()
    theorem.write_text(proved.replace(" : corrected_theorem", " : 0 = 0").replace("exact I", "reflexivity"))
    with pytest.raises(NotProvedError, match=r"Comparison\.v"):
        check.check(tmp_path)
    theorem.write_text(proved.replace("exact I", "idtac"))
    with pytest.raises(NotProvedError, match="make"):
        check.check(tmp_path)
    section = "Variable wrong : False."  # outside a section: an axiom under another name
    theorem.write_text(section + "\n" + proved.replace("exact I", "destruct wrong"))
    with pytest.raises(NotProvedError, match="wrong"):
        check.check(tmp_path)
