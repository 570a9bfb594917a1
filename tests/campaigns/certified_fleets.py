"""Three fleets with gains that satisfy a condition set, for the tests of certificates."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cache, cached_property
from math import sqrt, tanh
from typing import Any

from gaincert.models.arrays import column
from gaincert.models.conditions import ConditionData
from gaincert.models.excitation import Excitation
from gaincert.models.fleet import Fleet
from gaincert.models.gains import Gains
from gaincert.models.paper import paper_fleet, paper_gains
from gaincert.verify.certificates.certify import Certificate, certify

ROBOTS = [  # mass, inertia, half track, wheel radius, torque limit
    ("10", "3", "0.3", "0.05", "55"),
    (["34", "38"], ["15", "16"], "0.35", "0.15", "160"),
    ("23", "9.3125", ["0.22", "0.23"], ["0.099", "0.101"], ["54", "58"]),
    ("1.8", "0.02", "0.08", "0.033", {"left": "1.5", "right": "1.4"}),
    ("1.2", "0.011", "0.0725", "0.0325", "1.1"),
]
KEYS = ("mass", "inertia", "half_track", "wheel_radius", "torque_limit")


@dataclass(frozen=True, eq=False)
class Case:
    fleet: Fleet
    psi: Excitation
    gains: Gains
    conditions: str

    @cached_property
    def certificate(self) -> Certificate:
        return certify(self.fleet, self.psi, self.gains, self.conditions, seed=7)


def vehicle(i: int, **more: Any) -> dict[str, Any]:
    return {"name": f"r{i}", **dict(zip(KEYS, ROBOTS[i % 5], strict=True)), "offset": [i, -i], **more}


def fleet_of(vehicles: list[dict[str, Any]], edges: list[Any], led: dict[str, Any], **more: Any) -> Fleet:
    return Fleet.model_validate(
        {
            "name": "test",
            "leader": {"position": [0, 0], "heading": 0},
            "excitation": {"family": "harmonics", "frequency": "0.7", "sin": ["1.2071", "0", "0.2803"], "cos": ["0.1"]},
            "graph": {"edges": edges, "leader_links": led},
            "vehicle": vehicles,
            **more,
        }
    )


def gains_at(share: float, limits: ConditionData) -> Gains:
    """Four-digit gains under (15') and speed limits with T at most a share of the torque limit."""
    rows = []
    for D, r, arm, torque, speed, turn in zip(
        limits.degree, limits.r, limits.arm, limits.torque, limits.speed, limits.turn_rate, strict=True
    ):
        d, lever, bar = float(D), float(arm), float(limits.psi_bar)
        pull = 0.9 * tanh(min(float(speed), 1.0)) / (sqrt(2) * d)
        turning = 0.45 * tanh(min(float(turn), 1.0)) / d
        shape = (pull, 1.0, turning * lever, lever, turning * lever / (sqrt(2) * bar))
        # T is at most (r/2) [d_v + sqrt2 D p_v + (d_omega + p_omega D + c) / arm].
        bound = float(r) / 2 * (1 + sqrt(2) * d * pull + 1 + 2 * turning * d)
        rows.append([Fraction(f"{share * float(torque) / bound * gain:.4g}") for gain in shape])
    return Gains(*(column(entries) for entries in zip(*rows, strict=True)))


@cache
def paper() -> Case:
    fleet = paper_fleet()
    assert fleet.psi is not None
    return Case(fleet, fleet.psi, paper_gains(), "paper")


@cache
def mixed_ring() -> Case:
    """Ten robots of five kinds, some known by intervals, two led, with speed and turn-rate limits."""
    vehicles = [vehicle(i, limits={"speed": "0.8"} if i % 3 == 0 else {}) for i in range(10)]
    vehicles[4]["limits"] = {"speed": "1.5", "turn_rate": "0.9"}
    edges = [[f"r{i}", f"r{(i + 1) % 10}", f"{1 + i % 3}.5"] for i in range(10)]
    fleet = fleet_of(vehicles, edges, {"r0": "2", "r5": "0.25", "r7": "0"})
    assert fleet.psi is not None
    return Case(fleet, fleet.psi, gains_at(0.95, fleet.condition_data(fleet.psi)), "rate-bounded")


@cache
def line() -> Case:
    """Five robots in a row, led at one end, psi designed."""
    fleet = fleet_of([vehicle(i) for i in range(5)], [[f"r{i}", f"r{i + 1}"] for i in range(4)], {"r0": "1.5"})
    psi = Excitation(Fraction(0), Fraction(1, 2), (Fraction(1), Fraction(0), Fraction(1, 4)))
    return Case(fleet, psi, gains_at(0.999, fleet.condition_data(psi)), "corrected")


CASES = {"paper": paper, "mixed_ring": mixed_ring, "line": line}
