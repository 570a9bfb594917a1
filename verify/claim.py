"""What is claimed and what was found: a `Claim` and its `Status`."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


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
    witness: str | None = None  # the counterexample with its values, where the status is REFUTED
    needs: tuple[str, ...] = ()  # ids of the claims that this one rests on
