"""What `make formal` refuses: another claim, gaps, missing proofs, assumptions that are not standard, no Coq."""

import hashlib
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from gaincert.verify.formal import check
from gaincert.verify.formal.check import STANDARD_AXIOMS, NotProvedError, assumptions, claims, digest, gaps, sources

FORMAL = Path(check.__file__).parent
THEOREMS = ["corrected_theorem", "existence", "uniqueness", "torque_sharp", "not_exponential"]


def sha256(text):
    return f"sha256:{hashlib.sha256(text.encode()).hexdigest()}"


def test_the_statement_is_the_one_that_was_claimed():
    """A change of Statement.v is a change of the claim: it belongs into the changelog, into CLAIM and here."""
    assert check.CLAIM["Statement"] == "sha256:362fc641e2001a45d686406003aeda235efddd07845de419d913ede6beddd926"
    assert claims(sources())[:5] == [f"{name}_holds" for name in THEOREMS]


def test_the_theorems_are_proved_as_they_are_stated():
    texts = sources()
    for name in THEOREMS:
        assert f"Definition {name} : Prop" in texts["Statement"]
        assert re.search(rf"Definition {name}_holds : S\.{name}\n  := @Gaincert\.\w+\.{name}_holds\.", texts["Claims"])


def test_the_assumptions_of_every_claim_are_printed():
    text = sources()["Claims"]
    claimed = set(re.findall(r"^Definition (\w+)", text, re.MULTILINE)) - {"claims_of_the_paper"}
    together = (
        re.search(r"Definition claims_of_the_paper :=\s*\((.*?)\)\.", text, re.DOTALL)[1].replace(",", " ").split()
    )
    assert claimed == set(claims(sources())) - {"claims_of_the_paper"} | set(together)


@pytest.mark.parametrize("name", ["Statement", "Definitions", "Claims"])
def test_another_claim_is_refused(name):
    texts = sources()
    with pytest.raises(NotProvedError, match=rf"{name}\.v has sha256:\w+, another claim than that of"):
        claims(texts | {name: texts[name].replace("0 <", "0 <=", 1) + " "})
    del texts[name]
    with pytest.raises(NotProvedError, match=rf"{name}\.v is missing"):
        claims(texts)


@pytest.mark.parametrize(
    "text",
    [
        "Theorem t : False. Admitted.",
        "Axiom t : False.",
        "Axiom(**)t : False.",
        "Parameter x : nat.",
        "Conjecture t : False.",
        "Lemma t : False. Proof. admit. Admitted.",
        "Lemma t : False. Proof. (intros *). Admitted.",
        "Unset Guard Checking.",
        "Unset(**)Guard Checking.",
        "#[bypass_check(guard)] Fixpoint f (n : nat) : False := f n.",
        "(* a comment (* inside another *) *) Axiom t : False.",
        '(* "*) Axiom t : False.',
        'Declare ML Module "other".',
        "Lemma t : False. Proof. admit. Defined.",
        "Lemma t : False. Proof. give_up. Defined.",
        "Primitive add := #int63_add.",
        'Add ML Path "folder".',
        'Load "elsewhere".',
        'Notation "x |(* y" := (x + y). Declare ML Module "other". Ltac done := (intros *).',
        "Timeout 10Axiom t : False.",
        "Module Hidden : Interface. Definition x := 0. End Hidden.",
        "Module\u00a0Hidden : Interface.",
        "Module Type Interface. End Interface.",
        "Declare Module Given : Interface.",
    ],
)
def test_a_gap_is_found(text):
    assert gaps({"Proofs": text})


@pytest.mark.parametrize(
    "text",
    [
        "Module Short := Gaincert.Statement. (* another name *)",
        "Module Numbers := Make Whole.\n",
        "Section S. Variable x : nat. Hypothesis H : x = x. End S.",
        "Lemma Axiomatic_start : True. Proof. exact I. Qed.",
    ],
)
def test_sections_and_other_names_are_no_gap(text):
    assert not gaps({"Proofs": text})


def test_the_sources_have_no_gap():
    assert not gaps(sources())


def test_no_lemma_is_left_over():
    """Every lemma and definition is used by another one, by a claim or by the report."""
    texts = {name: check.without_comments(text) for name, text in sources().items() if name != "Statement"}
    named = re.findall(r"^(?:Lemma|Theorem|Definition|Fixpoint|Ltac) (\w+)", "\n".join(texts.values()), re.MULTILINE)
    words = re.findall(r"[\w']+", "\n".join(texts.values()))
    proof = "\n".join(path.read_text() for path in sorted((FORMAL.parent / "proof").rglob("*.py")))
    lonely = {name for name in named if words.count(name) == 1} - {"claims_of_the_paper"}
    assert not {name for name in lonely if not re.search(rf"\b{name}\b", proof)}


@pytest.mark.parametrize("name", ["a b.v", "A`date`.v", "1.v", "Ä.v"])
def test_a_source_has_a_plain_name(tmp_path, name):
    (tmp_path / name).write_text("")
    with pytest.raises(NotProvedError, match="letters, digits and _"):
        sources(tmp_path)


def test_a_source_that_is_no_text_is_named(tmp_path):
    (tmp_path / "Proofs.v").write_bytes(b"\xff")
    with pytest.raises(NotProvedError, match=r"Proofs\.v cannot be read"):
        sources(tmp_path)


def test_a_folder_is_no_source(tmp_path):
    (tmp_path / "Proofs.v").mkdir()
    with pytest.raises(NotProvedError, match=r"'Proofs\.v': a source is a file"):
        check.check(tmp_path)


def test_names_of_assumptions_are_read_from_what_coq_prints():
    answer = """Axioms:
ClassicalDedekindReals.sig_not_dec : forall P : Prop, {~ ~ P} + {~ P}
FunctionalExtensionality.functional_extensionality_dep
  : forall (A : Type) (B : A -> Type) (f g : forall x : A, B x),
    (forall x : A, f x = g x) -> f = g
Closed under the global context
Axioms:
loop is assumed to be guarded.
Classical_Prop.classic\u00a0M.x : False
"""
    standard = ["ClassicalDedekindReals.sig_not_dec", "FunctionalExtensionality.functional_extensionality_dep"]
    assert assumptions(answer) == [standard, [], ["Classical_Prop.classic\u00a0M.x", "loop"]]


def test_the_digest_follows_names_and_contents():
    one, other, renamed = digest({"A": "a"}), digest({"A": "b"}), digest({"B": "a"})
    assert len({one, other, renamed, digest({"A": "a", "B": ""})}) == 4
    assert digest({"A": "a", "B": "b"}) == digest({"B": "b", "A": "a"})


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
    assert record["digest"] == digest(sources())
    assert list(record["theorems"]) == claims(sources())


def test_nothing_but_the_standard_axioms_is_assumed(record):
    assert all(set(axioms) <= STANDARD_AXIOMS for axioms in record["theorems"].values())
    for name in THEOREMS:
        assert record["theorems"][f"{name}_holds"] == sorted(STANDARD_AXIOMS)


THEOREM = "From Gaincert Require Import Statement.\nTheorem holds : claim. Proof. exact I. Qed.\n"
CLAIMS = """Require Gaincert.Statement Gaincert.Theorem.
Definition claim_holds : Gaincert.Statement.claim := @Gaincert.Theorem.holds.
Print Assumptions claim_holds.
"""
PRETENDED = "From Gaincert Require Import Statement.\n{}Theorem holds : claim. Proof. exact cheat. Qed.\n"


@pytest.fixture
def small(tmp_path, monkeypatch):
    """{name: text} -> the record of a small development that stands for the whole; its claim is False."""
    monkeypatch.setattr(check, "LIBRARIES", ())

    def checked(theorem, claim="False", *, libraries=False, **more):
        texts = {"Statement": f"Definition claim : Prop := {claim}.\n", "Theorem": theorem, "Claims": CLAIMS, **more}
        monkeypatch.setattr(check, "CLAIM", {name: sha256(texts[name]) for name in ("Statement", "Claims")})
        for name, text in texts.items():
            (tmp_path / f"{name}.v").write_text(text)
        return check.check(tmp_path, libraries=libraries)

    return checked


@pytest.mark.needs("coqc")
def test_a_proof_is_accepted(small):
    for libraries in (False, True):
        assert small(THEOREM, "True", libraries=libraries)["theorems"] == {"claim_holds": []}


# What tries to prove False, and the words in which it is refused.
CLASS = """Class Cheat := falsity : False.
Theorem holds {h : Cheat} : claim. Proof. exact h. Qed.
Variable cheat : False.
#[global] Instance given : Cheat := cheat.
"""
CHEATS = {
    "an axiom by another name": (PRETENDED.format("Variable cheat : False.\n"), "cheat"),
    "no proof": (THEOREM.replace("exact I", "idtac"), r"Theorem\.v failed"),
    "another statement": (THEOREM.replace(": claim", ": True"), r"Claims\.v failed"),
    "an instance that is found silently": ("From Gaincert Require Import Statement.\n" + CLASS, r"Claims\.v failed"),
}


@pytest.mark.needs("coqc")
@pytest.mark.parametrize("cheat", CHEATS)
def test_what_does_not_prove_is_refused(small, cheat):
    theorem, said = CHEATS[cheat]
    with pytest.raises(NotProvedError, match=said):
        small(theorem)


@pytest.mark.needs("coqc")
def test_an_axiom_with_the_name_of_a_standard_one_is_refused(small):
    """Print Assumptions writes Classical_Prop.classic for it; coqchk writes the whole name."""
    theorem = PRETENDED.format("Definition cheat := Gaincert.Classical_Prop.classic.\n")
    with pytest.raises(NotProvedError, match=r"Gaincert\.Classical_Prop\.classic"):
        small("Require Gaincert.Classical_Prop.\n" + theorem, Classical_Prop="Variable classic : False.\n")


@pytest.mark.needs("coqc")
def test_an_axiom_in_a_sealed_module_is_refused(small, monkeypatch):
    """coqchk does not list it, and Coq's name for it begins like a standard one; the word Module is refused first."""
    name = "classic\u00a0M"
    hidden = f"""Module Type E. Variable x : False. End E.
Module Type TM. Declare Module N : E. End TM.
Module {name} : TM.
  Module K. Variable x : False. End K.
  Definition aux : False := K.x.
  Module N : E with Definition x := aux := K.
End {name}.
"""
    theorem = PRETENDED.format(f"Definition cheat := Gaincert.Classical_Prop.{name}.N.x.\n")
    with pytest.raises(NotProvedError, match="assume instead of proving"):
        small("Require Gaincert.Classical_Prop.\n" + theorem, Classical_Prop=hidden)
    monkeypatch.setattr(check, "GAPS", re.compile("nothing"))
    with pytest.raises(NotProvedError, match=f"assumes Classical_Prop.{name}.N.x"):
        small("Require Gaincert.Classical_Prop.\n" + theorem, Classical_Prop=hidden)


@pytest.mark.needs("coqc")
def test_files_that_need_each_other_are_named(small):
    with pytest.raises(NotProvedError, match=r"need each other: (Theorem|Other)"):
        small("Require Gaincert.Other.\n" + THEOREM, Other="Require Gaincert.Theorem.\n")


@pytest.mark.needs("coqc")
@pytest.mark.parametrize("name", ["COQPATH", "XDG_DATA_HOME"])
def test_the_environment_brings_in_nothing(small, monkeypatch, tmp_path, name):
    """A file in a folder that Coq would search is not among the sources."""
    elsewhere = tmp_path / "elsewhere"
    for folder in (elsewhere, elsewhere / "coq"):
        folder.mkdir(exist_ok=True)
        (folder / "Cheat.v").write_text("Variable cheat : False.\n")
        subprocess.run(["coqc", "-q", "Cheat.v"], cwd=folder, check=True, capture_output=True)
    monkeypatch.setenv(name, str(elsewhere))
    with pytest.raises(NotProvedError, match="Cheat"):
        small("Require Import Cheat.\n" + PRETENDED.format(""))
