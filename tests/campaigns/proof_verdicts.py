"""What the proof check says, as data: what a mutant of it has to change to be noticed."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Sequence
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
from gaincert.verify.proof.lemmas.bounds import l1, l6, l8
from gaincert.verify.proof.lemmas.energies import l2, l3, l4, l5
from gaincert.verify.proof.lemmas.functions import l0
from gaincert.verify.proof.lemmas.torques import conditions_as_proved, l16, l16_sufficient, l18
from gaincert.verify.proof.this_fleet import graph

from tests.campaigns.proof_mutants import named
from tests.campaigns.proof_rules import unsupported
from tests.verify.light_fleets import line_of, undamped_gains

# An index is that of a vehicle, a link, an axis, the leader or a number, or says which of several.
INDEX = re.compile(r"|[0-9]+|[ijl]|ij|[ij]l|x|y|v|omega|min|lmin")
LEMMAS = (l0, l1, l2, l3, l4, l5, conditions_as_proved, l18, l16, l16_sufficient, l6, l8)


def parts(*, formulas: bool) -> Iterator[str]:
    """What the check says, piece by piece: verdicts, numbers, witnesses and supports, and formulas where asked for.

    What is computed soonest comes first, so that most mutants are noticed early.
    """
    yield from (json.dumps([name, _accepted(judge)]) for name, judge in unsupported().items())
    yield from (json.dumps(_piece(lemma(), formulas)) for lemma in LEMMAS)
    yield from (json.dumps([mutant.name, _found(mutant.judge())]) for mutant in named())
    claims = prove()
    strained = [claim for claim in prove(*strained_fleet()) if claim.kind is Kind.FLEET]
    crowd = graph.kappa(line_of(graph.EXACT_VEHICLES + 1).graph)
    yield json.dumps(["proved", theorem_proved(claims)])
    yield from (json.dumps(_piece(claim, formulas)) for claim in claims)
    yield from (json.dumps(_piece(claim, formulas=False)) for claim in (*strained, crowd))
    yield json.dumps(_letters([*claims, *strained, crowd]))


def strained_fleet() -> tuple[Fleet, Gains]:
    """Three robots with scales of their own, the last a wheel torque beyond its limit, limits met, missed and equal.

    No two weights are the same, and psi has two tones of a frequency other than 1.
    """
    table = line_of(3).model_dump(mode="json", by_alias=True)
    table["excitation"] = {"family": "harmonics", "frequency": "1.5", "sin": [1, "0.5"], "cos": [0, "0.25"]}
    table["graph"] = {"edges": [["r1", "r2", "0.1"], ["r2", "r3", "0.2"]], "leader_links": {"r1": 1, "r2": 2, "r3": 3}}
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
    facts = {id(fact): fact for claim in claims for fact in claim.steps()}.values()
    statements = [said for fact in facts for said in (fact.statement, *fact.assumptions)]
    points = [pair for fact in facts if fact.witness for pair in fact.witness.point]
    shown = [side for said in statements for side in of_statement(said)]
    shown += [e for pair in points for e in pair if not isinstance(e, str)]
    names = {s.name for e in shown for s in e.free_symbols}
    unknown = sorted(name for name in names if not INDEX.fullmatch(letter_of(name)[1]))
    return [*unknown, *sorted({letter_of(name)[0].meaning for name in names})]


def _piece(claim: Claim, formulas: bool) -> list[Any]:
    return [_verdict(claim), [str(fact.statement) for fact in claim.steps()] if formulas else []]


def _verdict(claim: Claim) -> list[Any]:
    facts = [_found(fact) for fact in (*claim.facts, *claim.truth)]
    walks = [[len(walk.after), len(walk.pairs), str(walk.residual)] for walk in claim.walks]
    names = _names(claim) if claim.kind is Kind.FLEET else []  # which vehicle a number is of
    return [claim.id, claim.kind.name, claim.status.name, claim.rests_on, len(claim.assumptions), facts, walks, names]


def _names(claim: Claim) -> list[list[str]]:
    sides = (of_statement(fact.statement) for fact in claim.facts)
    return [sorted({s.name for side in found for s in side.free_symbols}) for found in sides]


def _found(fact: Fact) -> list[Any]:
    found = fact.witness
    witness = found and [[str(value) for _, value in found.point], found.left, found.right, found.gap]
    return [fact.holds, fact.method.name, len(fact.by), list(fact.values), witness]
