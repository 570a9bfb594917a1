"""The whole proof check: the paper's claims in its order, the lemmas, and what follows for one fleet."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache

from ...models.fleet import Fleet
from ...models.gains import Gains
from ...models.paper import paper_fleet, paper_gains
from .claim import Claim, Kind
from .formal import Development, development, proved_by
from .lemmas.theorem import lemmas
from .method.rules import restated
from .printed import boundedness, convergence, energies, model, saturation, section_4
from .this_fleet import excitation, graph
from .this_fleet import gains as fleet_gains


def prove(fleet: Fleet | None = None, gains: Gains | None = None) -> list[Claim]:
    """Every claim with its verdict, for a fleet and its gains (None: the paper's).

    The paper's claims and the lemmas do not depend on the fleet; those of kind FLEET do. Where a fleet comes without
    gains, what would need them is left out.
    """
    if fleet is None:
        fleet, gains = paper_fleet(), gains or paper_gains()
    general = symbolic()
    found = [*general, *this_fleet(fleet, gains, {claim.id: claim for claim in general})]
    if len({claim.id for claim in found}) < len(found):
        raise ValueError("two claims have the same id")
    return found


@cache
def symbolic() -> list[Claim]:
    """The claims that hold for every fleet: the paper's in its order, then the lemmas."""
    formal = development()
    proved = lemmas(formal)
    by_id = {claim.id: claim for claim in proved}
    _stable, attractive = by_id["thm-c"].facts
    printed = [
        *model.claims(),
        *energies.claims(by_id["L9"]),
        *boundedness.claims(),
        *convergence.claims(attractive),
        *saturation.claims(),
        *section_4.claims(formal),
        *saturation.on_the_paper(),
    ]
    proposition = _proposition({claim.id: claim for claim in printed}, formal)
    return [*printed, proposition, *model.scales(), *proved]


def _proposition(printed: dict[str, Claim], formal: Development) -> Claim:
    """Proposition 1 is true, though its proof is not: the limits (3)-(4) by the theorem, Constraint 1 by (16)."""
    facts = (*printed["eq-3-4"].facts, *printed["eq-16"].facts)
    return Claim("prop-1", Kind.PAPER, (*map(restated, facts), proved_by("proposition_1", formal)))


def this_fleet(fleet: Fleet, gains: Gains | None, proved: dict[str, Claim]) -> list[Claim]:
    """(A1)-(A3) as far as they can be judged, what follows, and that the theorem applies."""
    psi = fleet.psi
    found = [graph.assumption_1(fleet.graph), graph.kappa(fleet.graph)]
    found += [fleet_gains.assumption_2(fleet, gains)] if gains else []
    found += [excitation.assumption_3(psi), excitation.window_number(psi)] if psi else []
    assumed = [fact for claim in found for fact in claim.facts]
    if gains and psi:
        found.append(fleet_gains.torques(fleet, gains, psi, proved["thm-d"]))
        found.append(fleet_gains.limits(fleet, gains, psi, proved["thm-f"]))
        found += [fleet_gains.lemma_constants(fleet, gains, psi)] if all(fact.holds for fact in assumed) else []
    return [*found, Claim("fleet", Kind.FLEET, tuple(map(restated, (*proved["theorem"].facts, *assumed))))]


def theorem_proved(claims: Iterable[Claim]) -> bool:
    """Whether the corrected theorem and every lemma beneath it holds: exit code 0 of `gaincert prove`."""
    return all(claim.sound for claim in claims if claim.kind is Kind.LEMMA)
