"""The proof report: proof.json, proof.md, proof.html, proof.tex and the dependency graph proof_graph.svg."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ...models.files.text import write_text
from ...verify.proof.claim import Claim, Status
from .. import rendering
from . import graph as proof_graph
from .notation import latex, mathml

ORDER = (Status.REFUTED, Status.CORRECTED, Status.OPEN, Status.PROVED, Status.CITED)  # what is false heads the report
HEADINGS = {
    Status.REFUTED: "Refuted",
    Status.CORRECTED: "Corrected",
    Status.OPEN: "Open",
    Status.PROVED: "Proved",
    Status.CITED: "Cited",
}


def write_documents(claims: Sequence[Claim], folder: Path) -> list[Path]:
    """Write the five files into a folder, each whole or not at all; returns their paths."""
    graph = proof_graph.draw(claims)
    contents = {
        "proof.json": json.dumps(claims_to_json(claims), indent=2, ensure_ascii=False) + "\n",
        "proof.md": render("proof.md", claims),
        "proof.html": render("proof.html", claims, graph=graph),
        "proof.tex": render("proof.tex", claims),
        "proof_graph.svg": graph,
    }
    return [write_text(folder / name, content) for name, content in contents.items()]


def claims_to_json(claims: Sequence[Claim]) -> list[dict[str, Any]]:
    """The list that proof.json holds and `gaincert prove --json` prints; optional keys are left out where empty."""
    return [_as_dict(claim) for claim in claims]


def _as_dict(claim: Claim) -> dict[str, Any]:
    row: dict[str, Any] = {
        "id": claim.id,
        "source": claim.source,
        "statement": claim.statement,
        "status": claim.status.name,
        "method": f"{claim.method}; second method: {claim.second}" if claim.second else claim.method,
        "reason": claim.reason,
        "group": claim.group,
        "needs": list(claim.needs),
    }
    optional = {"corrected": claim.corrected, "witness": claim.witness, "second_method": claim.second}
    row |= {key: value for key, value in optional.items() if value}
    row |= {name: latex(value) for name, value in formulas(claim)}
    if found := formulas(claim):
        row["mathml"] = {name: mathml(value) for name, value in found}  # for report.html, which has no SymPy
    return row


def formulas(claim: Claim) -> list[tuple[str, Any]]:
    """(name, expression) of the formulas that the claim carries."""
    names = ("quantity", "stated", "derived", "residual")
    return [(name, getattr(claim, name)) for name in names if getattr(claim, name) is not None]


def render(name: str, claims: Sequence[Claim], graph: str = "") -> str:
    """One of the three documents from its template."""
    groups = [(HEADINGS[status], status, [c for c in claims if c.status is status]) for status in ORDER]
    return rendering.render(
        name,
        groups=[group for group in groups if group[2]],
        claims=claims,
        theorem=next((c for c in claims if c.id == "theorem"), None),
        graph=graph,
        latex=latex,
        mathml=_safe_mathml,
    )


def _safe_mathml(expression: Any) -> Any:
    from markupsafe import Markup

    return Markup(mathml(expression))  # noqa: S704 -- built from our own symbols by an XML writer, which escapes
