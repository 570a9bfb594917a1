"""Lemmas L13-L15 and L17, and the parts of the corrected theorem: each is a theorem of `verify/formal`."""

from __future__ import annotations

import sympy as sp

from ..claim import Claim, Fact, Kind
from ..formal import Development, proved_by
from ..method.fleet_symbols import generic
from ..method.rules import identity, restated
from ..method.symbols import symbol
from . import bounds, energies, functions, torques, windows


class _Lemmas:
    """Lemmas in order; each may rest on those before it."""

    def __init__(self, formal: Development) -> None:
        self.formal, self.claims = formal, list[Claim]()

    def add(self, id_: str, *theorems: str, facts: tuple[Fact, ...] = ()) -> None:
        """A lemma that the proof assistant checked, with what is checked here beside it."""
        known = [fact for claim in self.claims for fact in claim.facts]
        formally = (proved_by(name, self.formal, known) for name in theorems)
        self.claims.append(Claim(id_, Kind.LEMMA, (*facts, *formally)))


def lemmas(formal: Development) -> list[Claim]:
    """L0-L18, the check of the conditions, the parts (a)-(f) and the theorem."""
    found, l10, l16, l18 = _Lemmas(formal), windows.l10(formal), torques.l16(), torques.l18()
    found.claims += [functions.l0(), bounds.l1(), energies.l2(), energies.l3(), energies.l4(), energies.l5()]
    found.claims += [bounds.l6(), windows.l7(formal), bounds.l8(), windows.l9(formal)]
    found.claims += [l10, windows.l11(formal), windows.l12(formal, l10)]
    found.add("L13", "window_dichotomy", "uniform_reach")
    found.add("L14", "uniformly_stable_holds")
    found.add("L15", "uniformly_attractive_holds")
    found.claims += [l16, torques.l16_sufficient()]
    found.add("L17", "not_exponential_holds", facts=(cross_track_rate(),))
    found.claims += [l18, torques.conditions_as_proved()]
    found.add("thm-a", "existence_holds", "uniqueness_holds")
    found.add("thm-b", "uniformly_bounded_holds")
    found.add("thm-c", "uniformly_stable_holds", "uniformly_attractive_holds")
    found.add("thm-d", "torque_bound_holds", "torque_sharp_holds", facts=tuple(map(restated, l16.facts)))
    found.add("thm-e", "not_exponential_holds")
    found.add("thm-f", "speed_bound_holds", "turn_rate_bound_holds", facts=tuple(map(restated, l18.facts)))
    found.add("theorem", "corrected_theorem_holds")
    return found.claims


def cross_track_rate() -> Fact:
    """The cross-track error moves at a rate of second order: v times the sine of the heading error."""
    fleet = generic()
    i, goal = fleet[0], symbol("theta", "l")
    return identity(sp.cos(goal) * i.y_dot - sp.sin(goal) * i.x_dot, i.v * sp.sin(i.theta - goal), fleet)
