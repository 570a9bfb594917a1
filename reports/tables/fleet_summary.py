"""The summary of a fleet for `gaincert check`."""

from __future__ import annotations

from decimal import ROUND_CEILING
from typing import Any

from ...models.fleet import Fleet
from .gain_table import decimal

EXACT_VEHICLES = 30  # up to this size Lemma 1 is also checked by the exact L D L^T


def fleet_summary(fleet: Fleet) -> dict[str, Any]:
    """Name -> value: the fleet, its graph, psi, and notes on surprising entries."""
    graph, psi = fleet.graph, fleet.psi
    led = sum(1 for weight in graph.leader_weight if weight)
    summary: dict[str, Any] = {
        "fleet": fleet.name,
        "vehicles": len(fleet),
        "drive": fleet.drive,
        "edges": graph.edges,
        "led vehicles": led,
        "Lemma 1": "every vehicle has a path to the leader, so L_l > 0",
    }
    if len(fleet) <= EXACT_VEHICLES:
        summary["L D L^T pivots"] = ", ".join(map(str, graph.ldl_pivots()))
    if psi is None:
        summary["psi"] = "to be designed"
    else:
        factor, power = psi.power()
        rate, curvature = psi.derivative_bounds
        summary["psi"] = f"{psi.table()['family']}, {float(psi.frequency):g} rad/s"
        summary["psi_bar"] = decimal(psi.bound, ROUND_CEILING)
        summary["bound of psi'"] = decimal(rate, ROUND_CEILING)
        summary["bound of psi''"] = decimal(curvature, ROUND_CEILING)
        summary["(12) over one period"] = f"{factor} pi^{power}" if power != 1 else f"{factor} pi"
    summary["simulation starts"] = "given" if all(vehicle.start for vehicle in fleet.vehicles) else "not given for all"
    summary["digest"] = fleet.digest
    return summary
