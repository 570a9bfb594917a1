"""The campaign formal_mutation.py: it finds every lemma and every hypothesis, and Coq refuses what it makes of them."""

import re

import pytest
from gaincert.verify.formal.check import compiled, sources, without_comments

from tests.campaigns.formal_mutation import HYPOTHESES, file_survives, without_hypothesis, without_proof


def test_every_proof_is_emptied_once():
    for text in sources().values():
        changed = list(without_proof(text))
        assert len(changed) == len(re.findall(r"\bQed\.", without_comments(text)))
        assert len({other for _, other in changed} | {text}) == len(changed) + 1


def test_every_hypothesis_is_left_out_once():
    """What is left of (A1) to (A3) without them says nothing."""
    statement = sources()["Statement"]
    assert [hypothesis for hypothesis, _ in without_hypothesis(statement)] == list(HYPOTHESES)
    left = statement[statement.index("(** ** Hypotheses *)") : statement.index("(** ** Conclusions *)")]
    for hypothesis in HYPOTHESES:
        left = left.replace(hypothesis, "True")
    quantified = r"\(\w+ < N F\)%nat|S i = true|0 <= t\b|:="
    assert not re.search(r"<|=|is_derive|RInt", re.sub(quantified, "", without_comments(left)))


@pytest.mark.needs("coqc")
def test_coq_refuses_a_lemma_without_its_proof(tmp_path):
    texts = {name: sources()[name] for name in ("Statement", "Sums")}
    compiled(texts | {"Claims": "Require Gaincert.Sums."}, tmp_path)
    assert file_survives(tmp_path, "Sums", texts["Sums"])
    _, changed = next(without_proof(texts["Sums"]))
    assert not file_survives(tmp_path, "Sums", changed)
