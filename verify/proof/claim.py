"""What is claimed and what was found: a `Claim` and its `Status`."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Any


class Status(Enum):
    """The verdict on a claim; the value is the sentence that a report prints."""

    PROVED = "proved: the machine check named under method succeeded"
    CORRECTED = "corrected: false as printed, true in the corrected form"
    REFUTED = "refuted: false, with a witness that was evaluated rigorously"
    CITED = "cited: a theorem of analysis whose hypotheses were checked here"
    OPEN = "open: not decided here, for the reason given"


@dataclass(frozen=True)
class Claim:
    """One statement, what was found of it and how."""

    id: str  # short and stable: "eq-18", "L5"
    source: str  # "(18)" or "inequality after (20)"
    statement: str
    status: Status
    method: str
    reason: str  # one line in plain words
    corrected: str | None = None  # the true form, where the status is CORRECTED
    witness: str | None = None  # the counterexample with its values, where the claim is false
    needs: tuple[str, ...] = ()  # ids of the claims that this one rests on
    second: str | None = None  # an independent second method, where one was run
    group: str = "printed"  # "printed", "theorem", "cited" or "fleet"
    quantity: Any = None  # the left side of the formulas below, a SymPy expression
    stated: Any = None  # as printed, a SymPy expression
    derived: Any = None  # as algebra derives it
    residual: Any = None  # stated - derived in normal form; 0 if and only if the two agree
