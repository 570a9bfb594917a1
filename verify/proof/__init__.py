"""The proof check: the paper's claims, the lemmas of the corrected theorem, and what follows for a fleet."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...models.fleet import Fleet
    from ...models.gains import Gains
    from .claim import Claim


def prove(fleet: Fleet | None = None, gains: Gains | None = None) -> list[Claim]:
    """Every claim with its verdict, for a fleet and its gains (None: the paper's). Loads SymPy when it is called."""
    from .checker import prove as run

    return run(fleet, gains)


def theorem_proved(claims: Iterable[Claim]) -> bool:
    """Whether the corrected theorem and every lemma holds: exit code 0 of `gaincert prove`."""
    from .checker import theorem_proved as proved

    return proved(claims)
