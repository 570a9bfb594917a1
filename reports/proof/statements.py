"""Facts and claims as text, LaTeX and MathML."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from html import escape
from typing import Any

from ...verify.proof.claim import Claim, Fact, Implication, Method, Quotation, Relation, Statement, Walk
from ..escapes import markdown_text, tex_text
from .inline import inline_tex
from .notation import latex, mathml, text

_LATEX = {"=": "=", "!=": r"\ne", "<": "<", ">": ">", "<=": r"\le", ">=": r"\ge", "->": r"\to", "-/>": r"\not\to"}
_WORDS = {"bounded": "is bounded", "unbounded": "is not bounded"}
_MATHML = {"<": "&lt;", ">": "&gt;", "<=": "≤", ">=": "≥", "!=": "≠", "->": "→", "-/>": "↛"}


def in_text(statement: Statement) -> str:
    """One line of plain text."""
    if isinstance(statement, Quotation):
        return statement.text
    if isinstance(statement, Implication):
        return f"{' and '.join(map(in_text, statement.premises))} imply {in_text(statement.conclusion)}"
    if statement.sign in _WORDS:
        return f"{text(statement.left)} {_WORDS[statement.sign]}"
    return f"{text(statement.left)} {statement.sign} {text(statement.right)}"


def in_latex(statement: Statement) -> str:
    """LaTeX; mathematics in dollars."""
    if isinstance(statement, Quotation):
        return rf"\texttt{{{tex_text(statement.text)}}}" if statement.is_source else inline_tex(statement.text)
    if isinstance(statement, Implication):
        premises = ", ".join(map(in_latex, statement.premises))
        return rf"{premises} $\;\Longrightarrow\;$ {in_latex(statement.conclusion)}"
    if statement.sign in _WORDS:
        return f"${latex(statement.left)}$ {_WORDS[statement.sign]}"
    return f"${latex(statement.left)} {_LATEX[statement.sign]} {latex(statement.right)}$"


def in_mathml(statement: Statement) -> str:
    """One <math> element; a theorem of Coq, which is no formula, has none and raises ValueError."""
    if isinstance(statement, Quotation):
        raise ValueError(f"{statement.name} is text, not a formula")
    return f'<math display="inline" displaystyle="true"><mrow>{_row(statement)}</mrow></math>'


def _row(statement: Relation | Implication) -> str:
    if isinstance(statement, Implication):
        premises = "<mo>,</mo><mspace width='1em'/>".join(map(_row, statement.premises))
        return f"{premises}<mspace width='1em'/><mo>⟹</mo><mspace width='1em'/>{_row(statement.conclusion)}"
    if statement.sign in _WORDS:
        return f"{mathml(statement.left)}<mspace width='0.5em'/><mtext>{_WORDS[statement.sign]}</mtext>"
    return f"{mathml(statement.left)}<mo>{_MATHML.get(statement.sign, statement.sign)}</mo>{mathml(statement.right)}"


Printer = Callable[[Any], str]


def witness_in_text(fact: Fact) -> str:
    """The point at which a statement fails and its two sides there."""
    return _witness(fact, text, str)


def witness_in_latex(fact: Fact) -> str:
    """The same in LaTeX."""
    return _witness(fact, lambda expression: f"${latex(expression)}$", tex_text)


def witness_in_markdown(fact: Fact) -> str:
    """The same in Markdown."""
    return _witness(fact, lambda expression: f"${latex(expression)}$", markdown_text)


def witness_in_html(fact: Fact) -> str:
    """The same in HTML with MathML."""
    return _witness(fact, lambda expression: f'<math display="inline">{mathml(expression)}</math>', escape)


def _witness(fact: Fact, typeset: Printer, escaped: Printer) -> str:
    found = fact.witness
    if found is None:
        return ""
    point = ((s, escaped(value) if isinstance(value, str) else typeset(value)) for s, value in found.point)
    where = ", ".join(f"{typeset(s)} = {value}" for s, value in point)
    sides = f"left side {escaped(found.left)}, right side {escaped(found.right)}" if found.left else ""
    sides = sides or (f"left side minus right side {escaped(found.gap)}" if found.gap else "")
    return "; ".join(filter(None, (sides, f"at {where}" if where else "")))


def refuting(claim: Claim) -> list[Fact]:
    """The false facts of a claim that have a witness, those with the fewest letters first, each witness once."""
    false = [fact for fact in claim.facts if fact.holds is False and fact.witness]
    by_witness = {fact.witness: fact for fact in sorted(false, key=lambda fact: -len(fact.witness.point))}  # type: ignore[union-attr]
    return list(by_witness.values())[::-1]


def inner_steps(claim: Claim) -> list[Fact]:
    """The steps that the facts of a claim were made from and that belong to no claim, deepest first, each once."""
    found: dict[str, Fact] = {}

    def visit(fact: Fact) -> None:
        for below in fact.by:
            if below.origin is None and below.method is not Method.ASSUMED:
                visit(below)
                found.setdefault(in_text(below.statement), below)

    for fact in (*claim.facts, *claim.truth):
        visit(fact)
    shown = {in_text(fact.statement) for fact in (*claim.facts, *claim.truth)}
    return [fact for words, fact in found.items() if words not in shown and not _says_nothing(fact)]


def true_form(claim: Claim) -> list[Fact]:
    """The truth of a claim; where both sides of a fact read the same, the left one is the letter of what they are."""
    named = [
        replace(fact, statement=Relation(claim.quantity, "=", fact.right))
        if _says_nothing(fact) and claim.quantity is not None
        else fact
        for fact in claim.truth
    ]
    return [fact for fact in named if not _says_nothing(fact)]


def _says_nothing(fact: Fact) -> bool:
    """Whether a fact reads x = x once SymPy has evaluated it."""
    return isinstance(fact.statement, Relation) and fact.left == fact.right


def expressions(claims: Iterable[Claim]) -> Iterator[Any]:
    """Every expression that a report of the claims shows."""
    for claim in claims:
        if claim.quantity is not None:
            yield claim.quantity
        for fact in (*claim.facts, *claim.truth, *inner_steps(claim)):
            yield from of_statement(fact.statement)
            yield from (s for relation in fact.assumptions for s in of_statement(relation))
            yield from (
                e for pair in (fact.witness.point if fact.witness else ()) for e in pair if not isinstance(e, str)
            )
        for walk in claim.walks:
            yield from _of_walk(walk)


def of_statement(statement: Statement) -> Iterator[Any]:
    """The sides of its relations; none of a theorem of Coq."""
    if isinstance(statement, Implication):
        for relation in (*statement.premises, statement.conclusion):
            yield from of_statement(relation)
    elif isinstance(statement, Relation):
        yield from (statement.left, statement.right)


def cancelling(walk: Walk) -> list[tuple[int, int]]:
    """The numbers, from 1, of the terms of a walk that cancel in pairs, each number once."""
    waiting = list(enumerate(walk.after, 1))
    found = []
    for pair in walk.pairs:
        numbers = [next(place for place in waiting if place[1] == term) for term in pair]
        waiting = [place for place in waiting if place not in numbers]
        found.append((numbers[0][0], numbers[1][0]))
    return found


def _of_walk(walk: Walk) -> Iterator[Any]:
    yield from (walk.energy, walk.before, *walk.after, walk.left_over)
