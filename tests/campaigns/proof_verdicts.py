"""What the proof check says, as data: what a mutant of it has to change to be noticed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
from gaincert.models import conditions
from gaincert.models.arrays import column
from gaincert.models.fleet import Fleet
from gaincert.models.gains import Gains
from gaincert.models.saturation import Saturation
from gaincert.reports.proof.letters import letter_of
from gaincert.reports.proof.statements import of_statement
from gaincert.verify.proof import prove, theorem_proved
from gaincert.verify.proof.claim import Claim, Fact, Kind

from tests.campaigns.proof_mutants import named
from tests.campaigns.proof_rules import unsupported
from tests.verify.light_fleets import line_of, undamped_gains


def report(*, formulas: bool) -> dict[str, Any]:
    """What the check says: verdicts, numbers, witnesses and supports, and formulas where asked for."""
    claims = prove()
    strained = [claim for claim in prove(*strained_fleet()) if claim.kind is Kind.FLEET]
    return {
        "proved": theorem_proved(claims),
        "claims": [_verdict(claim) for claim in (*claims, *strained)],
        "letters": _letters([*claims, *strained]),
        "planted": [_found(mutant.judge()) for mutant in named()],
        "unsupported": [_accepted(judge) for judge in unsupported().values()],
        "formulas": [_formulas(claim) for claim in claims] if formulas else [],
    }


def strained_fleet() -> tuple[Fleet, Gains]:
    """Three robots with scales of their own, the last a wheel torque beyond its limit, limits met, missed and equal."""
    table = line_of(3).model_dump(mode="json", by_alias=True)
    for number, (row, torque) in enumerate(zip(table["vehicle"], (100, 100, 1), strict=True), 1):
        limits = {"speed": number, "turn_rate": number, "wheel_speed": 40 * number}
        limits |= {"acceleration": 12 * number, "turn_acceleration": 10 * number}
        row |= {
            "torque_limit": torque,
            "limits": limits,
            "half_track": f"0.{number}",
            "wheel_radius": f"0.0{4 + number}",
        }
    fleet = Fleet.model_validate(table)
    speeds, turns = (column(map(Fraction, numbers)) for numbers in ((3, 4, 5), (4, 5, 6)))
    scales = Saturation(Fraction(2), Fraction(3, 2), speeds / 2, turns / 3)
    undamped = undamped_gains(fleet, fleet.psi)
    gains = replace(undamped, d_omega=5 * undamped.d_omega, k_alpha=undamped.k_alpha / 50, saturation=scales)
    held = conditions.pulling_bound(conditions.exact_numbers(), fleet.condition_data(fleet.psi), gains)
    return fleet, replace(gains, d_v=np.where(np.arange(3) == 0, held, 2 * held))


def _accepted(judge: Callable[[], Fact]) -> bool | None:
    """What a rule says of an inference that does not follow; None where it raises what it should."""
    try:
        return judge().holds
    except (KeyError, ValueError):
        return None


def _letters(claims: Sequence[Claim]) -> list[str]:
    """What the report says of every letter in a formula; raises for one that it does not know."""
    statements = {id(fact): fact.statement for claim in claims for fact in claim.steps()}
    symbols = {s for statement in statements.values() for side in of_statement(statement) for s in side.free_symbols}
    return sorted({letter_of(s.name)[0].meaning for s in symbols})


def _formulas(claim: Claim) -> list[str]:
    return [str(fact.statement) for fact in claim.steps()]


def _verdict(claim: Claim) -> list[Any]:
    facts = [_found(fact) for fact in (*claim.facts, *claim.truth)]
    walks = [[len(walk.after), len(walk.pairs), str(walk.residual)] for walk in claim.walks]
    return [claim.id, claim.kind.name, claim.status.name, claim.rests_on, len(claim.assumptions), facts, walks]


def _found(fact: Fact) -> list[Any]:
    witness = fact.witness and [[str(value) for _, value in fact.witness.point], fact.witness.left, fact.witness.right]
    return [fact.holds, fact.method.name, len(fact.by), list(fact.values), witness]
