"""The condition sets side by side for one fleet and its gains."""

from __future__ import annotations

import math
from typing import Any

from ...models.conditions import CONDITION_SETS, Inequality, exact_numbers
from ..export.deployment import Deployment

MOST = 2000  # vehicles up to which all sets are evaluated exactly


def condition_rows(deployed: Deployment) -> list[dict[str, Any]]:
    """One row per condition set: whether these gains meet it, and its tightest condition and vehicle."""
    if len(deployed.fleet) > MOST:
        return []
    limits = deployed.fleet.condition_data(deployed.excitation)
    rows = []
    for conditions in CONDITION_SETS.values():
        sides = conditions.inequalities(exact_numbers(), limits, deployed.gains)
        used, source, vehicle = max(_tightest(side) for side in sides)
        rows.append(
            {
                "name": conditions.name,
                "theorem": conditions.theorem,
                "conditions": ", ".join(side.source for side in sides),
                "holds": all(bool(holds) for side in sides for holds in side.holds),
                "asked": conditions.name == deployed.conditions,
                "used": used,
                "where": f"{source}, vehicle {deployed.fleet.names[vehicle]}",
            }
        )
    return rows


def _tightest(side: Inequality) -> tuple[float, str, int]:
    """The largest small / large over the vehicles, with its source and vehicle."""
    pairs = zip(side.small, side.large, strict=True)
    shares = [float(small / large) if large != math.inf else 0.0 for small, large in pairs]
    vehicle = max(range(len(shares)), key=shares.__getitem__)
    return shares[vehicle], side.source, vehicle
