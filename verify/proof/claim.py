"""What is claimed and what was found of it: relations, facts and claims.

A `Fact` is made by a rule of `method/rules.py`, which checks it; a `Claim` is made of facts. What a claim rests on is
read off the facts that its own facts were made from, and its status is computed from what the checks found: neither can
be typed.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import Enum, auto
from typing import Any

Expr = Any  # a SymPy expression


class Status(Enum):
    """The verdict on a claim; the value is the sentence that a report prints."""

    PROVED = "proved: every step was checked here by computer algebra or rigorous arithmetic"
    FORMAL = "formal: at least one step was checked by the proof assistant Coq, all others here"
    CORRECTED = "corrected: false as it stands, true in the corrected form"
    REFUTED = "refuted: false, with a witness that was evaluated rigorously"
    CITED = "cited: rests on a textbook theorem whose hypotheses were checked here"
    OPEN = "open: not decided here"


class Kind(Enum):
    """Whose statement a claim is."""

    PAPER = "the paper"
    READING = "the paper, where the text at hand is illegible: read so, and no error of the paper"
    REMARK = "a remark on the paper, not a statement of it"
    LEMMA = "the corrected theorem"
    FLEET = "this fleet"


class Method(Enum):
    """How a fact was checked."""

    ASSUMED = auto()
    INSTANCE = auto()
    NORMAL_FORM = auto()
    TRIANGLE = auto()
    CAUCHY_SCHWARZ = auto()
    SIGNS = auto()
    POSITIVE = auto()
    SQUARES = auto()
    GROWTH = auto()
    PARITY = auto()
    SATURATED = auto()
    WINDOW = auto()
    ENVELOPE = auto()
    RETURNS = auto()
    COMPARISON = auto()
    COUNTEREXAMPLE = auto()
    CONSEQUENCE = auto()
    BALLS = auto()
    EXACT = auto()
    COQ = auto()
    CITED = auto()


SIGNS = frozenset({"=", "!=", "<", "<=", ">", ">=", "->", "-/>", "bounded", "unbounded"})


@dataclass(frozen=True)
class Relation:
    """left sign right. The sign "->" is a limit for t to infinity, "-/>" its negation; "bounded" has no right side."""

    left: Expr
    sign: str
    right: Expr

    def __post_init__(self) -> None:
        if self.sign not in SIGNS:
            raise ValueError(f"a relation has one of the signs {sorted(SIGNS)}, not {self.sign!r}")

    def subs(self, values: Any) -> Relation:
        """The relation with expressions replaced."""
        return Relation(self.left.subs(values), self.sign, self.right.subs(values))


@dataclass(frozen=True)
class Implication:
    """All premises together imply the conclusion."""

    premises: tuple[Relation, ...]
    conclusion: Relation


@dataclass(frozen=True)
class Quotation:
    """A theorem in the words of the source that the proof assistant compiled, or of a textbook."""

    name: str
    source: str
    text: str

    @property
    def is_source(self) -> bool:
        """Whether the text is in the language of the proof assistant."""
        return self.source.endswith(".v")


Statement = Relation | Implication | Quotation


@dataclass(frozen=True)
class Witness:
    """A point at which a statement fails, with the values of its two sides there, or of their difference alone."""

    point: tuple[tuple[Expr, Expr], ...]  # a decimal for a number that is not exact
    left: str = ""
    right: str = ""
    gap: str = ""  # left - right


@dataclass(frozen=True)
class Fact:
    """A statement with the verdict of the rule that checked it."""

    statement: Statement
    holds: bool | None  # None: not decided
    method: Method
    by: tuple[Fact, ...] = ()  # the facts that the rule used
    residual: Expr | None = None  # left - right in normal form, where that is what decided
    witness: Witness | None = None
    values: tuple[str, ...] = ()  # numbers that the check computed
    discharged: tuple[Relation, ...] = ()  # hypotheses of the facts it was made from that others of them supply
    origin: str | None = None  # id of the claim that it belongs to

    @property
    def assumptions(self) -> tuple[Relation, ...]:
        """The hypotheses that it was made under."""
        if self.method is Method.ASSUMED and isinstance(self.statement, Relation):
            return (self.statement,)
        found = dict.fromkeys(relation for fact in self.by for relation in fact.assumptions)
        return tuple(relation for relation in found if relation not in self.discharged)

    @property
    def left(self) -> Expr:
        """The left side of a relation."""
        return self.relation.left

    @property
    def sign(self) -> str:
        """The sign of a relation."""
        return self.relation.sign

    @property
    def right(self) -> Expr:
        """The right side of a relation."""
        return self.relation.right

    @property
    def relation(self) -> Relation:
        """The statement, where it is a relation. Raises TypeError for any other."""
        if not isinstance(self.statement, Relation):
            raise TypeError(f"{self.statement} has no sides")
        return self.statement

    def beneath(self) -> Iterator[Fact]:
        """The fact, and all that it was made from down to the claims that it rests on."""
        yield self
        for fact in self.by:
            if fact.origin is None:
                yield from fact.beneath()
            else:
                yield fact


@dataclass(frozen=True)
class Walk:
    """The derivative of an energy, line by line: what a reader follows with a finger."""

    vehicles: int
    energy: Expr
    before: Expr  # the derivative by the chain rule, rates as symbols
    after: tuple[Expr, ...]  # its terms, (13)-(14) put in for the rates
    pairs: tuple[tuple[Expr, Expr], ...]  # those that cancel
    left_over: Expr
    residual: Expr  # left over - stated, in normal form


@dataclass(frozen=True)
class Claim:
    """One statement of the paper, of the corrected theorem or about a fleet, and what was found of it."""

    id: str  # short and stable: "eq-18", "L5"
    kind: Kind
    facts: tuple[Fact, ...]
    truth: tuple[Fact, ...] = ()  # the corrected form, where the facts are false
    quantity: Expr | None = None  # what the left sides of the identities are
    walks: tuple[Walk, ...] = ()

    def __post_init__(self) -> None:
        if not self.facts:
            raise ValueError(f"claim {self.id!r} has no fact, so it cannot have a verdict; add a step that is checked")
        for name in ("facts", "truth"):
            object.__setattr__(self, name, tuple(replace(fact, origin=self.id) for fact in getattr(self, name)))

    @property
    def status(self) -> Status:
        """From the facts alone."""
        found = [fact.holds for fact in self.facts]
        if all(found):
            return self._ground()
        if None in found and False not in found:
            return Status.OPEN
        corrected = self.truth and all(fact.holds for fact in self.truth)
        return Status.CORRECTED if corrected else Status.REFUTED

    def _ground(self) -> Status:
        methods = {fact.method for fact in self.steps()}
        if Method.CITED in methods:
            return Status.CITED
        return Status.FORMAL if Method.COQ in methods else Status.PROVED

    def steps(self) -> Iterator[Fact]:
        """Every fact beneath the claim's own, through other claims as well."""
        waiting, seen = list(self.facts), set[int]()
        while waiting:
            fact = waiting.pop()
            if id(fact) not in seen:
                seen.add(id(fact))
                waiting += fact.by
                yield fact

    @property
    def sound(self) -> bool:
        """Whether other claims may rest on it."""
        return self.status in (Status.PROVED, Status.FORMAL, Status.CITED)

    @property
    def rests_on(self) -> tuple[str, ...]:
        """The ids of the claims whose facts were used, in the order of use."""
        used = [step.origin for fact in (*self.facts, *self.truth) for step in _inside(fact) if step.origin != self.id]
        return tuple(dict.fromkeys(id_ for id_ in used if id_))

    @property
    def assumptions(self) -> tuple[Relation, ...]:
        """The hypotheses that its facts were made under."""
        return tuple(dict.fromkeys(relation for fact in self.facts for relation in fact.assumptions))

    def about(self, left: Expr, sign: str = "", right: Expr = None) -> Fact:
        """The fact of this claim with these sides, as a ground for others; undecided where the claim is not sound.

        Raises KeyError where there is none.
        """
        for fact in (*self.facts, *self.truth):
            relation = fact.statement
            if not isinstance(relation, Relation) or relation.left != left:
                continue
            if sign in ("", relation.sign) and right in (None, relation.right):
                return fact if self.sound or fact in self.truth else replace(fact, holds=None)
        raise KeyError(f"claim {self.id!r} says nothing about {left}")


def _inside(fact: Fact) -> Iterator[Fact]:
    for ground in fact.by:
        yield from ground.beneath()
