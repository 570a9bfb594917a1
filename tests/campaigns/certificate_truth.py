"""An evaluation of a certificate's statements that shares nothing with the kernel: mpmath, NumPy."""

from __future__ import annotations

import json
from typing import Any

import mpmath as mp
import numpy as np

mp.mp.dps = 80


def statement_is_true(document: dict[str, Any], original: dict[str, Any]) -> bool:
    """Whether all statements of a changed certificate are true; fleet and digest must be the original ones."""
    unchanged = ("schema", "digest", "fleet")
    if any(json.dumps(document[key]) != json.dumps(original[key]) for key in unchanged):
        return False
    fleet = document["fleet"]
    psi = Wave(document["designed"].get("excitation", fleet["excitation"]))
    graph = document["designed"].get("graph", fleet["graph"])
    names = [vehicle["name"] for vehicle in fleet["vehicle"]]
    laplacian = composed_laplacian(graph, names)
    return (
        float(np.linalg.eigvalsh(laplacian).min()) > 1e-9
        and psi_statements(psi, document)
        and all(
            margin_holds(condition, i, document, graph) for condition in required(document) for i in range(len(names))
        )
        and all(rate_holds(name, document, laplacian) for name in ("gamma_omega", "gamma_v"))
    )


class Wave:
    """psi, from the table of a fleet file."""

    def __init__(self, table: dict[str, Any]) -> None:
        self.mean, self.w = mp.mpf(table["mean"]), mp.mpf(table["frequency"])
        if table["family"] == "square-wave":
            self.terms = [(n, 4 / (n * mp.pi), mp.mpf(0)) for n in range(1, 2 * table["terms"], 2)]
        else:
            size = max(len(table["sin"]), len(table["cos"]))
            sin, cos = ([mp.mpf(q) for q in table[key]] + [mp.mpf(0)] * size for key in ("sin", "cos"))
            self.terms = [(n + 1, sin[n], cos[n]) for n in range(size)]

    def __call__(self, x: Any) -> Any:
        return self.mean + sum(s * mp.sin(n * x) + c * mp.cos(n * x) for n, s, c in self.terms)

    def slope(self, x: Any) -> Any:
        return sum(n * (s * mp.cos(n * x) - c * mp.sin(n * x)) for n, s, c in self.terms)

    def supremum(self) -> Any:
        """max |psi|, to 50 digits: the best of a fine grid, polished by Newton's method on psi'."""
        grid = np.linspace(0, 2 * np.pi, 20001)
        value = float(self.mean) + sum(
            float(s) * np.sin(n * grid) + float(c) * np.cos(n * grid) for n, s, c in self.terms
        )
        best = grid[np.argmax(abs(value))]
        return abs(self(mp.findroot(self.slope, best, tol=1e-60)))

    def power(self) -> Any:
        """The integral of psi'^2 over one period."""
        return self.w * mp.pi * sum(n * n * (s * s + c * c) for n, s, c in self.terms)


def composed_laplacian(graph: dict[str, Any], names: list[str]) -> Any:
    index = {name: i for i, name in enumerate(names)}
    matrix = np.diag([float(graph["leader_links"].get(name, 0)) for name in names])
    for a, b, weight in graph["edges"]:
        e = np.zeros(len(names))
        e[index[a]], e[index[b]] = 1, -1
        matrix += float(weight) * np.outer(e, e)
    return matrix


def psi_statements(psi: Wave, document: dict[str, Any]) -> bool:
    point = document["psi_point"]
    x = 2 * mp.atan(mp.mpf(str(point["half_tangent"]))) + mp.pi * point["half_turn"]
    return bool(
        psi.supremum() <= mp.mpf(str(document["psi_bar"])) + mp.mpf(10) ** -50
        and mp.mpf(str(point["at_least"])) <= abs(psi(x)) + mp.mpf(10) ** -50
        and 0 < mp.mpf(str(document["psi_power"])) <= psi.power()
    )


def required(document: dict[str, Any]) -> list[str]:
    sets = {"paper": ["(15)", "(16)"], "corrected": ["(16*)"], "rate-bounded": ["(15')", "(16*)"]}
    limits = [vehicle["limits"] for vehicle in document["fleet"]["vehicle"]]
    asked = [("speed", "speed limit"), ("turn_rate", "turn rate limit")]
    return sets[document["conditions"]] + [name for key, name in asked if any(entry[key] for entry in limits)]


def ends(parameter: Any) -> list[Any]:
    values = parameter if isinstance(parameter, list) else [parameter, parameter]
    return [mp.mpf(str(value)) for value in values]


def margin_holds(condition: str, i: int, document: dict[str, Any], graph: dict[str, Any]) -> bool:
    """The condition holds with the stated margin for every corner of the intervals of r, R and the torque limits."""
    vehicle, margin = document["fleet"]["vehicle"][i], document["margins"][condition][i]
    limit = {"speed limit": vehicle["limits"]["speed"], "turn rate limit": vehicle["limits"]["turn_rate"]}.get(
        condition, 1
    )
    if limit is None or margin is None:
        return limit is None and margin is None
    name = vehicle["name"]
    D = mp.mpf(graph["leader_links"].get(name, "0"))
    D += sum(mp.mpf(str(weight)) for a, b, weight in graph["edges"] if name in (a, b))
    p, d, pw, dw, k = (
        mp.mpf(str(document["gains"][key][i])) for key in ("p_v", "d_v", "p_omega", "d_omega", "k_alpha")
    )
    bar, lever = mp.mpf(str(document["psi_bar"])), 2 if document["fleet"]["drive"] == "paper" else 1
    tau = min(ends(vehicle["torque_limit"]["left"]) + ends(vehicle["torque_limit"]["right"]))
    c = mp.sqrt(2) * k * bar * D
    slacks = []
    for r in ends(vehicle["wheel_radius"]):
        for R in ends(vehicle["half_track"]):
            arm = lever * R
            whole = arm * (d + mp.sqrt(2) * p * D) + dw + pw * D + c
            cone = r / 2 * (d + mp.sqrt(2) * D * mp.hypot(p, k * bar / arm) + (dw + pw * D) / arm)
            slacks.append(
                {
                    "(15)": dw * mp.tanh(1) - c,
                    "(15')": dw - pw * D - c,
                    "(16)": 2 * arm * tau / r - whole,
                    "(16*)": tau - cone,
                    "speed limit": d * mp.tanh(mp.mpf(str(limit))) - mp.sqrt(2) * p * D,
                    "turn rate limit": dw * mp.tanh(mp.mpf(str(limit))) - pw * D - c,
                }[condition]
            )
    # (16) in its own units does not scale with r, R alike: its worst corner is the smallest arm and the largest r.
    slack = slacks[2] if condition == "(16)" else min(slacks)
    gains_positive = min(p, d, pw, dw, k) > 0
    return bool(gains_positive and 0 <= mp.mpf(str(margin)) <= slack + mp.mpf(10) ** -60)


def rate_holds(name: str, document: dict[str, Any], laplacian: Any) -> bool:
    """The spectral abscissa of the linearisation is at most -gamma, with nominal parameters."""
    stated = document["rates"][name]
    if stated is None:
        return True
    key, gain = ("inertia", "omega") if name == "gamma_omega" else ("mass", "v")
    mass = np.array([float(sum(ends(vehicle[key])) / 2) for vehicle in document["fleet"]["vehicle"]])
    p, d = (np.array([float(q) for q in document["gains"][f"{letter}_{gain}"]]) for letter in "pd")
    n = len(mass)
    linear = np.block([[np.zeros((n, n)), np.eye(n)], [-(p / mass)[:, None] * laplacian, -np.diag(d / mass)]])
    return bool(0 < float(stated["rate"]) <= -np.linalg.eigvals(linear).real.max() + 1e-9)
