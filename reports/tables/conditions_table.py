"""The condition sets side by side for one fleet and its gains."""

from __future__ import annotations

import math
from typing import NamedTuple

from ...models.conditions import CONDITION_SETS, Inequality, exact_numbers
from ..deployment import Deployment

MOST = 2000  # only fleets up to so many vehicles get this table


class ConditionRow(NamedTuple):
    """One condition set: whether the gains meet it, and its tightest condition."""

    name: str
    theorem: str  # the theorem that the set is sufficient for
    conditions: str  # their equation numbers
    holds: bool
    requested: bool  # the set that the gains were designed or certified for
    used: float  # small / large of the tightest condition
    where: str  # the tightest condition and its vehicle


def condition_rows(deployed: Deployment) -> list[ConditionRow]:
    """One row per condition set, exact; none for a fleet of more than MOST vehicles."""
    if len(deployed.fleet) > MOST:
        return []
    data = deployed.fleet.condition_data(deployed.excitation)
    rows = []
    for conditions in CONDITION_SETS.values():
        sides = conditions.inequalities(exact_numbers(), data, deployed.gains)
        used, source, vehicle = max(_tightest(side) for side in sides)
        rows.append(
            ConditionRow(
                name=conditions.name,
                theorem=conditions.theorem,
                conditions=", ".join(side.source for side in sides),
                holds=all(bool(holds) for side in sides for holds in side.holds),
                requested=conditions.name == deployed.conditions,
                used=used,
                where=f"{source}, vehicle {deployed.fleet.names[vehicle]}",
            )
        )
    return rows


def _tightest(side: Inequality) -> tuple[float, str, int]:
    """The largest ratio small / large over the vehicles, with its source and vehicle."""
    pairs = zip(side.small, side.large, strict=True)
    shares = [float(small / large) if large != math.inf else 0.0 for small, large in pairs]
    vehicle = max(range(len(shares)), key=shares.__getitem__)
    return shares[vehicle], side.source, vehicle
