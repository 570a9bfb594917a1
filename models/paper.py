"""The paper's example: Tables 1 and 2, Section 4, and the graph of Fig. 2 as docs/theory.md 6 has it."""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from typing import Any

from .arrays import column
from .excitation import Excitation
from .fleet import Fleet
from .gains import Gains

# Table 1: mass kg, inertia kg m^2, half track m, wheel radius m, torque limit N m
_TABLE_1 = {
    (1, 2): ("10", "3", "0.3", "0.05", "55"),
    (3, 4): ("36", "15.625", "0.35", "0.15", "160"),
    (5, 6): ("23", "9.3125", "0.225", "0.1", "56"),
}
# Table 2: x m, y m, heading deg, delta_x m, delta_y m
_TABLE_2 = {
    1: ("-3", "0", "180", "-5", "-3"),
    2: ("0", "5", "90", "-2.5", "2"),
    3: ("-1", "5", "90", "0", "7"),
    4: ("2", "0", "0", "2.5", "2"),
    5: ("-2", "7.5", "-45", "5", "-3"),
    6: ("-2", "-5", "-135", "0", "-3"),
}


@cache
def paper_fleet() -> Fleet:
    """The six vehicles of Section 4, with (2) as printed and the paper's psi."""
    ring = [[f"v{i}", f"v{i % 6 + 1}"] for i in range(1, 7)]
    return Fleet.model_validate(
        {
            "name": "paper",
            "drive": "paper",
            "leader": {"position": [-25, -25], "heading_deg": 225},
            "excitation": {"family": "square-wave", "mean": "1.25", "terms": 5, "frequency": "0.5"},
            "graph": {"edges": [*ring, ["v2", "v4"]], "leader_links": {"v2": 10, "v4": 10}},
            "vehicle": [_vehicle(number) for pair in _TABLE_1 for number in pair],
        }
    )


def _vehicle(number: int) -> dict[str, Any]:
    physical = next(row for pair, row in _TABLE_1.items() if number in pair)
    x, y, heading, delta_x, delta_y = _TABLE_2[number]
    keys = ("mass", "inertia", "half_track", "wheel_radius", "torque_limit")
    return {
        "name": f"v{number}",
        **dict(zip(keys, physical, strict=True)),
        "offset": [delta_x, delta_y],
        "start": {"position": [x, y], "heading_deg": heading},
    }


def paper_gains() -> Gains:
    """The gains of Section 4, exact."""
    rows: list[list[Any]] = [
        [56] * 6,
        [840] * 6,
        _alternating("2.8", "5.9"),
        _alternating("28", "59"),
        _alternating("3", "1"),
    ]
    return Gains(*(column(map(Fraction, row)) for row in rows))


def _alternating(own: str, led: str) -> list[str]:
    return [own, led, own, led, own, own]


def paper_excitation() -> Excitation:
    """psi of Section 4, with the coefficient read as 4 / ((2k-1) pi)."""
    return Excitation.square_wave(Fraction("1.25"), 5, Fraction("0.5"))
