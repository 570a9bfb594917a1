"""The chain: which claim rests on which, and what that leaves standing."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from .claim import Claim, Status

SOUND = (Status.PROVED, Status.CITED)


def resolve(claims: Iterable[Claim]) -> list[Claim]:
    """The claims with every PROVED one demoted to OPEN that rests, however deep, on something unproved.

    A printed claim may also rest on a corrected one, of which it uses the true form. Raises ValueError for a claim that
    rests on itself or on nothing known.
    """
    by_id = {claim.id: claim for claim in claims}
    done: dict[str, Claim] = {}
    for id_ in _order(by_id):
        done[id_] = _judge(by_id[id_], done)
    return [done[id_] for id_ in by_id]


def _judge(claim: Claim, done: dict[str, Claim]) -> Claim:
    if claim.status not in SOUND:
        return claim
    sound = (*SOUND, Status.CORRECTED) if claim.group == "printed" else SOUND
    weak = [need for need in claim.needs if done[need].status not in sound]
    if not weak:
        return claim
    return replace(
        claim,
        status=Status.OPEN,
        reason=f"rests on {', '.join(weak)}, which {'is' if len(weak) == 1 else 'are'} not proved",
    )


def _order(claims: dict[str, Claim]) -> list[str]:
    """Every claim after what it needs."""
    order: list[str] = []
    state: dict[str, int] = {}

    def visit(id_: str, above: tuple[str, ...]) -> None:
        if id_ not in claims:
            raise ValueError(f"claim {above[-1]!r} needs {id_!r}, which is no claim")
        if state.get(id_) == 1:
            raise ValueError(f"claims rest on each other: {' -> '.join((*above, id_))}")
        if id_ not in state:
            state[id_] = 1
            for need in claims[id_].needs:
                visit(need, (*above, id_))
            state[id_] = 2
            order.append(id_)

    for id_ in claims:
        visit(id_, ())
    return order


def beneath(claims: Iterable[Claim], id_: str) -> set[str]:
    """The ids of all that a claim rests on."""
    by_id = {claim.id: claim for claim in claims}
    found: set[str] = set()
    waiting = list(by_id[id_].needs)
    while waiting:
        need = waiting.pop()
        if need not in found:
            found.add(need)
            waiting.extend(by_id[need].needs)
    return found
