"""The whole proof check: printed claims, lemmas, the chain, and what follows for one fleet."""

from __future__ import annotations

from collections.abc import Iterable

from ...models.fleet import Fleet
from ...models.gains import Gains
from ...models.paper import paper_fleet, paper_gains
from . import (
    bounds,
    energies,
    fleet_facts,
    printed_bounds,
    printed_inferences,
    printed_model,
    printed_numbers,
    printed_proof,
    printed_saturation,
    saturation,
    stability,
    windows,
)
from .chain import beneath, resolve
from .claim import Claim, Status
from .steps import Check
from .verdicts import printed

_PARTS = (
    printed_model,
    printed_proof,
    printed_bounds,
    printed_saturation,
    printed_inferences,
    printed_numbers,
    energies,
    bounds,
    windows,
    stability,
    saturation,
)


def prove(fleet: Fleet | None = None, gains: Gains | None = None) -> list[Claim]:
    """Every claim with its verdict, for a fleet and its gains (None: the paper's).

    The printed claims and the lemmas do not depend on the fleet; the claims of group "fleet" do. Where a fleet comes
    without gains, what would need them is left out.
    """
    if fleet is None:
        fleet, gains = paper_fleet(), gains or paper_gains()
    return resolve([*symbolic(), *fleet_facts.claims(fleet, gains)])


def symbolic() -> list[Claim]:
    """The claims that hold for every fleet: the printed ones and the lemmas."""
    found = [claim for part in _PARTS for claim in part.claims()]
    return [proposition(), unneeded(found), *found]


def proposition() -> Claim:
    """Proposition 1: true, though its proof is not."""
    return printed(
        "prop-1",
        "Proposition 1",
        "under (15) and (16) the controller (6), (7), (9) achieves (3)-(4) under Constraint 1",
        note="true: the theorem gives the goal without (15), and (16) implies (16*); the printed proof has the false "
        "steps below",
        needs=("thm-c", "thm-d", "eq-16"),
    )


def unneeded(found: list[Claim]) -> Claim:
    """(15) does not appear beneath the theorem."""

    def compute() -> tuple[bool, str]:
        support = beneath(found, "theorem")
        return "eq-15" not in support, f"{len(support)} claims beneath the theorem, (15) not among them"

    return printed(
        "eq-15-unneeded",
        "(15), its role",
        "the theorem is proved without (15)",
        Check("(15) is not beneath the theorem", compute, "walk over the dependency graph"),
        note="unnecessary for the result",
        needs=("theorem",),
    )


def theorem_proved(claims: Iterable[Claim]) -> bool:
    """Whether the corrected theorem came out PROVED: the exit code of `gaincert prove`."""
    return any(claim.id == "theorem" and claim.status is Status.PROVED for claim in claims)
