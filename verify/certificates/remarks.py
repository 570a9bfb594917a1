"""Facts that accompany a certificate without being claimed by it: (15'), the cut conditions, tolerated parameters."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from ...models.arrays import Array, floats
from ...models.conditions import ConditionData, condition_15_prime, exact_numbers, excitation_bound, float_numbers
from ...models.fleet import Fleet
from ...models.gains import Gains
from ...models.graph import Graph
from ...models.numbers import Interval
from ...models.vehicle_notes import centre_of_mass_note

CUTS_UP_TO = 14  # vehicles for which all 2^N - 1 cuts are counted
EXACT_UP_TO = 20_000  # vehicles; for larger fleets floats count how many of them meet (15')
NAMED = 10  # vehicles that a note lists by name


def notes_of(fleet: Fleet, data: ConditionData, gains: Gains, conditions: str) -> list[str]:
    """The notes, one sentence each."""
    off_axle = centre_of_mass_note(fleet)
    return [
        *_strict_damping(fleet, data, gains, conditions),
        *_cuts(fleet, data, gains),
        *_robustness(fleet),
        *([off_axle] if off_axle else []),
    ]


def broken_cuts(graph: Graph, strength: Array) -> tuple[int, int]:
    """(how many vehicle sets S break sum_S strength_i <= a_l(S) + cut(S), how many sets there are); exact, O(2^N)."""
    edges = [
        (1 << int(i), 1 << int(j), weight) for i, j, weight in zip(graph.tail, graph.head, graph.weight, strict=True)
    ]
    total = (1 << graph.vehicles) - 1
    broken = 0
    for members in range(1, total + 1):
        inside = [i for i in range(graph.vehicles) if members >> i & 1]
        cut = sum((weight for a, b, weight in edges if bool(members & a) != bool(members & b)), Fraction(0))
        held = cut + sum((graph.leader_weight[i] for i in inside), Fraction(0))
        broken += sum((strength[i] for i in inside), Fraction(0)) > held
    return broken, total


def _strict_damping(fleet: Fleet, data: ConditionData, gains: Gains, conditions: str) -> list[str]:
    if conditions == "rate-bounded":
        return []
    exact = len(fleet) <= EXACT_UP_TO
    numbers, data, gains = (
        (exact_numbers(), data, gains) if exact else (float_numbers(), data.map(floats), gains.map(floats))
    )
    holds = condition_15_prime(numbers, data, gains).holds.astype(bool)
    broken = [fleet.names[i] for i in np.flatnonzero(~holds)]
    if not broken:
        return ["the turn rates are bounded, too: certify the gains under rate-bounded to have the bounds stated"]
    shown = ", ".join(broken[:NAMED]) + (f" and {len(broken) - NAMED} more" if len(broken) > NAMED else "")
    return [
        f"nothing is claimed of the turn rates of {shown}: a bound of |omega| needs (15'), which the theorem does not"
    ]


def _cuts(fleet: Fleet, data: ConditionData, gains: Gains) -> list[str]:
    if len(fleet) > CUTS_UP_TO:
        return []
    broken, total = broken_cuts(fleet.graph, excitation_bound(exact_numbers(), data, gains) / gains.p_omega)
    return [
        "the result rests on the form of alpha: under every alpha of the same size it would need sum_S c_i / p_omega_i "
        f"<= a_l(S) + cut(S) for all {total} sets S of vehicles, and {total - broken} of them meet it"
    ]


def _robustness(fleet: Fleet) -> list[str]:
    uncertain = {
        "mass": "mass and inertia stand in no torque condition and the theorem holds for every positive value; the "
        "rates are certified for the worst one",
        "half_track": "r and R count in the torque conditions with their worst value; where vehicle and controller "
        "differ in them, the vehicle moves as one of mass m r'/r and inertia I (r'/r)(R/R'), which is tolerated "
        "(both wheels having one radius)",
        "torque_limit": "torque data count with their smallest value",
    }
    found = {
        "mass": any(isinstance(q, Interval) for v in fleet.vehicles for q in (v.mass, v.inertia)),
        "half_track": any(isinstance(q, Interval) for v in fleet.vehicles for q in (v.half_track, v.wheel_radius)),
        "torque_limit": any(
            isinstance(q, Interval) for v in fleet.vehicles for q in (v.torque_limit.left, v.torque_limit.right)
        ),
    }
    return [f"intervals: {text}" for key, text in uncertain.items() if found[key]]
