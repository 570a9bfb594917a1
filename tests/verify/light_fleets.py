"""Small fleets of light robots, and gains for them that break (15) tenfold."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
from gaincert.models import conditions
from gaincert.models.arrays import column, floats
from gaincert.models.excitation import Excitation
from gaincert.models.fleet import Fleet
from gaincert.models.gains import Gains


def line_of(vehicles: int) -> Fleet:
    """A line of light robots, all led, near their places."""
    names = [f"r{i}" for i in range(1, vehicles + 1)]
    return Fleet.model_validate(
        {
            "name": f"line of {vehicles}",
            "leader": {"position": [0, 0], "heading": 0},
            "excitation": {"family": "harmonics", "frequency": 1, "sin": [1]},
            "graph": {
                "edges": [[a, b, "0.1"] for a, b in pairwise(names)],
                "leader_links": dict.fromkeys(names, 1),
            },
            "vehicle": [_robot(name, i) for i, name in enumerate(names)],
        }
    )


def _robot(name: str, i: int) -> dict[str, Any]:
    start = {"position": [f"{1 - 0.7 * i:.2f}", f"{0.8 - 0.5 * i:.2f}"], "heading": f"{0.5 * (-1) ** i:.1f}"}
    body = {"mass": 1, "inertia": 1, "half_track": "0.2", "wheel_radius": "0.1", "torque_limit": 100}
    return {"name": name, **body, "offset": [i, 0], "start": start}


def undamped_gains(fleet: Fleet, psi: Excitation) -> Gains:
    """Gains with c = 10 d_omega tanh(1): they break (15) tenfold, for every vehicle, and slightly more."""
    degree, ones = fleet.graph.degree, column([Fraction(1)] * len(fleet))
    inertia = column(v.inertia for v in fleet.vehicles)
    mass = column(v.mass for v in fleet.vehicles)
    p_omega, p_v = inertia / degree * 4, mass / degree * 4
    d_omega = p_omega * degree / 2
    # c = sqrt2 k psi_bar D >= 1.41 k psi_bar D; 7.7 > 10 tanh(1).
    k_alpha = d_omega * Fraction(77, 10) / (Fraction(141, 100) * psi.bound * degree)
    return Gains(p_v * ones, p_v * degree, p_omega, d_omega, k_alpha)


def damping_ratio(fleet: Fleet, gains: Gains, psi: Excitation) -> np.ndarray:
    """c / (d_omega tanh 1) per vehicle: above 1 (15) is broken, above 10 tenfold."""
    found = conditions.condition_15(conditions.exact_numbers(), fleet.condition_data(psi), gains)
    return floats(found.small) / floats(found.large)
