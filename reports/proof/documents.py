"""The proof report: proof.json, proof.md, proof.html, proof.tex with its preamble, and the graph proof_graph.svg."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from ...models.files.text import write_text
from ...verify.proof import theorem_proved
from ...verify.proof.claim import Claim, Fact, Implication, Kind, Quotation, Relation, Status
from ...verify.proof.formal import DEFINITIONS, STATEMENT, development
from .. import rendering
from . import graph as proof_graph
from .inline import inline_html, inline_markdown, inline_tex
from .notation import latex, mathml, meanings
from .statements import (
    cancelling,
    expressions,
    in_latex,
    in_mathml,
    in_text,
    inner_steps,
    refuting,
    true_form,
    witness_in_html,
    witness_in_latex,
    witness_in_markdown,
    witness_in_text,
)
from .words import ALL, FLEET, LEMMAS, LETTERS_NOTE, PAPER, method_of, note_of, place_of

FALSE = (Status.REFUTED, Status.CORRECTED)
CLOSED_LOOP = ("eq-1", "eq-8", "eq-10", "eq-11", "eq-13", "eq-14")
ENERGIES = ("eq-17", "eq-18", "eq-19", "eq-20")


def write_documents(claims: Sequence[Claim], folder: Path) -> list[Path]:
    """Write the files into a folder, each whole or not at all; returns their paths."""
    graph = proof_graph.draw(claims)
    contents = {
        "proof.json": json.dumps(claims_to_json(claims), indent=2, ensure_ascii=False) + "\n",
        "proof.md": render("proof.md", claims),
        "proof.html": render("proof.html", claims, graph=graph),
        "proof.tex": render("proof.tex", claims),
        **{name: rendering.render(name) for name in ("proof_preamble.tex", "proof_article.tex")},
        "proof_graph.svg": graph,
    }
    return [write_text(folder / name, content) for name, content in contents.items()]


# -- proof.json -------------------------------------------------------------------------------------------------------


def claims_to_json(claims: Sequence[Claim]) -> list[dict[str, Any]]:
    """The list that proof.json holds and `gaincert prove --json` prints; optional keys are left out where empty."""
    return [_as_dict(claim) for claim in in_order(claims)]


def in_order(claims: Sequence[Claim]) -> list[Claim]:
    """The claims in the paper's order, then lemmas, then the fleet. Raises KeyError for a claim without words."""
    order = {id_: number for number, id_ in enumerate(ALL)}
    return sorted(claims, key=lambda claim: order[claim.id])


def summary_line(claim: Claim) -> str:
    """A claim in one line: where it stands and what was found."""
    return f"{claim.status.name:9} {place_of(claim)}: {note_of(claim)}"


def _as_dict(claim: Claim) -> dict[str, Any]:
    row: dict[str, Any] = {
        "id": claim.id,
        "source": place_of(claim),
        "kind": claim.kind.name,
        "statement": "; ".join(in_text(fact.statement) for fact in claim.facts),
        "status": claim.status.name,
        "method": "; ".join(dict.fromkeys(method_of(fact) for fact in claim.facts)),
        "reason": note_of(claim),
        "needs": list(claim.rests_on),
        "facts": [_fact_as_dict(fact) for fact in claim.facts],
    }
    optional = {
        "given": [in_text(relation) for relation in claim.assumptions],
        "corrected": "; ".join(in_text(fact.statement) for fact in true_form(claim)) if claim.status in FALSE else "",
        "witness": "; ".join(map(witness_in_text, refuting(claim))) if claim.status in FALSE else "",
        "latex": [in_latex(fact.statement) for fact in claim.facts],
        "mathml": _typeset(claim),  # for report.html, which has no SymPy
    }
    return row | {key: value for key, value in optional.items() if value}


def _fact_as_dict(fact: Fact) -> dict[str, Any]:
    row = {"statement": in_text(fact.statement), "holds": fact.holds, "method": method_of(fact)}
    more = {"values": " ".join(fact.values), "witness": witness_in_text(fact)}
    return row | {key: value for key, value in more.items() if value}


def _typeset(claim: Claim) -> dict[str, str]:
    """MathML of what is stated and what is derived: of the first fact that is a formula."""
    fact = next((f for f in claim.facts if not isinstance(f.statement, Quotation)), None)
    if fact is None:
        return {}
    if claim.quantity is None or not isinstance(fact.statement, Relation):
        return {"stated": in_mathml(fact.statement)}
    sides = {"quantity": claim.quantity, "stated": fact.left, "derived": fact.right}
    return {name: f'<math display="inline">{mathml(side)}</math>' for name, side in sides.items()}


# -- the documents ----------------------------------------------------------------------------------------------------


def render(name: str, claims: Sequence[Claim], graph: str = "") -> str:
    """One of the three documents from its template."""
    ordered = in_order(claims)
    paper = [claim for claim in ordered if claim.kind is Kind.PAPER]
    by_id = {claim.id: claim for claim in ordered}
    parts = {"The paper, in its order": PAPER, "The corrected theorem": LEMMAS, "This fleet": FLEET}
    formal = development()
    return rendering.render(
        name,
        claims=ordered,
        proved=theorem_proved(ordered),
        theorem=by_id.get("theorem"),
        closed_loop=[by_id[id_] for id_ in CLOSED_LOOP],
        energies=[by_id[id_] for id_ in ENERGIES],
        paper=paper,
        counts=Counter(claim.status.name for claim in paper),
        mistakes=[claim for claim in paper if claim.status in FALSE],
        readings=[claim for claim in ordered if claim.kind is Kind.READING],
        undecided=[claim for claim in ordered if claim.status is Status.OPEN],
        sections=[(title, [claim for claim in ordered if claim.id in ids]) for title, ids in parts.items()],
        letters=meanings(expressions(ordered)),
        statuses=[status for status in Status if any(claim.status is status for claim in ordered)],
        formal=formal,
        formal_words={
            f"{STATEMENT}.v: what exactly is proved": formal.sources[STATEMENT],
            f"{DEFINITIONS}.v: what the claims beside the theorem speak of": formal.sources[DEFINITIONS],
        },
        graph=graph,
        letters_note=LETTERS_NOTE,
        words=_WORDS,
    )


_WORDS: dict[str, Callable[..., Any]] = {
    "place": place_of,
    "note": note_of,
    "effect": lambda claim: ALL[claim.id].effect,
    "method": method_of,
    "name": lambda id_: ALL[id_].place,
    "steps": inner_steps,
    "truth": true_form,
    "cancelling": cancelling,
    "given": lambda fact: "in its steps" if isinstance(fact.statement, Implication) else "given",
    "is_formula": lambda fact: not isinstance(fact.statement, Quotation),
    "refuting": refuting,
    "witness_html": lambda fact: _markup(witness_in_html(fact)),
    "witness_tex": witness_in_latex,
    "witness_md": witness_in_markdown,
    "inline_html": lambda sentence: _markup(inline_html(sentence)),
    "inline_tex": inline_tex,
    "inline_md": inline_markdown,
    "latex": latex,
    "tex": in_latex,
    "mathml": lambda expression: _markup(f'<math display="inline" displaystyle="true">{mathml(expression)}</math>'),
    "math": lambda statement: _markup(in_mathml(statement)),
}


def _markup(built: str) -> Any:
    from markupsafe import Markup

    return Markup(built)  # noqa: S704 -- built from our own symbols by an XML writer, which escapes
