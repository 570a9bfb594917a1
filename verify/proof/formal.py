"""The machine-checked theorem: its sources in `verify/formal`, the record of their last check, and what it says.

A theorem counts where the digest that `make formal` recorded is that of the sources that are there.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from ..formal import check
from .claim import Fact, Method, Quotation

STATEMENT = "Statement"  # the file that says what is proved
DEFINITIONS = "Definitions"  # what the claims beside the theorem speak of


@dataclass(frozen=True)
class Record:
    """What the last check was of, and what it found."""

    digest: str  # "sha256:..." of the sources
    coq: str  # version
    theorems: Mapping[str, Sequence[str]]  # the axioms that each main theorem assumes


@dataclass(frozen=True)
class Development:
    """The sources of the proof, and the record of their check."""

    sources: Mapping[str, str]  # text by file name without .v
    digest: str
    gaps: Sequence[str]  # places that assume instead of proving
    record: Record | None

    @cached_property
    def checked(self) -> bool:
        """Whether these very sources were checked, assume no more than the standard axioms and have no gap."""
        if self.record is None or self.record.digest != self.digest or self.gaps:
            return False
        return check.STANDARD_AXIOMS.issuperset(axiom for found in self.record.theorems.values() for axiom in found)

    def theorem(self, name: str) -> Quotation:
        """A theorem in the words of its source, a name of Statement.v written out. Raises KeyError where it is not."""
        head = re.compile(rf"^(?:Theorem|Lemma)\s+{re.escape(name)}\b(.*?)\.\s*^Proof\.", re.MULTILINE | re.DOTALL)
        for file, text in self.sources.items():
            if found := head.search(check.without_comments(text)):
                return Quotation(name, f"{file}.v", self.written_out(found.group(1)))
        raise KeyError(f"verify/formal proves no theorem {name!r}")

    def written_out(self, statement: str) -> str:
        """A statement on one line; where it is a name, what the name is defined as."""
        text = " ".join(statement.split())
        binders, words = re.split(r":(?![^(]*\))", text, maxsplit=1)  # the first colon outside parentheses
        words = f"forall {binders.strip()}, {words.strip()}" if binders.strip() else words.strip()
        body = re.compile(rf"^Definition {re.escape(words)} : Prop := (.*?)\.\s*$", re.MULTILINE | re.DOTALL)
        defined = body.search(check.without_comments(self.sources[STATEMENT]))
        return " ".join(defined.group(1).split()) if defined else words

    def required(self, file: str) -> set[str]:
        """The files that a file rests on, directly or not, with their ending."""
        found: set[str] = set()
        waiting = [file]
        while waiting:
            text = check.without_comments(self.sources[waiting.pop().removesuffix(".v")])
            lines = re.findall(r"^(?:From Gaincert )?Require (?:Import|Export) (.*)\.\s*$", text, re.MULTILINE)
            named = {f"{word.removeprefix('Gaincert.')}.v" for line in lines for word in line.split()}
            new = {name for name in named if name.removesuffix(".v") in self.sources} - found
            found |= new
            waiting += new
        return found


def development(folder: Path = check.FOLDER) -> Development:
    """The sources that are there, and the record beside them if there is one."""
    sources = check.sources(folder)
    path = folder / check.RECORD.name
    row = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else None
    record = Record(row["digest"], row["coq"], row["theorems"]) if row else None
    return Development(sources, check.digest(sources), check.gaps(sources), record)


def proved_by(theorem: str, formal: Development, among: Sequence[Fact] = ()) -> Fact:
    """A theorem that the proof assistant checked; it rests on those facts of `among` whose files its own requires."""
    quotation = formal.theorem(theorem)
    required = formal.required(quotation.source)
    by = [fact for fact in among if isinstance(fact.statement, Quotation) and fact.statement.source in required]
    values = (formal.record.digest, formal.record.coq) if formal.checked and formal.record else ()
    return Fact(quotation, formal.checked or None, Method.COQ, tuple(by), values=values)
