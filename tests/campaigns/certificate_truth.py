"""An evaluation of a certificate's statements that shares nothing with the kernel: mpmath, NumPy."""

from __future__ import annotations

from typing import Any

import mpmath as mp
import numpy as np

from tests.campaigns.certificate_rows import to_rows

mp.mp.dps = 110


def statement_is_true(document: dict[str, Any]) -> bool:
    """Whether all that a certificate states of its own fleet holds in truth."""
    rows = to_rows(document)
    fleet = rows["fleet"]
    psi = Wave(rows["designed"].get("excitation", fleet["excitation"]))
    graph = rows["designed"].get("graph", fleet["graph"])
    names = [vehicle["name"] for vehicle in fleet["vehicle"]]
    laplacian = composed_laplacian(graph, names)
    return (
        float(np.linalg.eigvalsh(laplacian).min()) > 1e-9
        and psi.persistent
        and bool(psi.supremum() <= mp.mpf(rows["psi_bar"]) + mp.mpf(10) ** -50)
        and all(margin_holds(condition, i, rows, graph) for condition in required(rows) for i in range(len(names)))
        and all(rate_holds(name, rows, laplacian) for name in ("gamma_omega", "gamma_v"))
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

    @property
    def persistent(self) -> bool:
        """Whether the integral of psi'^2 over one period is positive."""
        return self.w > 0 and any(s or c for _, s, c in self.terms)


def composed_laplacian(graph: dict[str, Any], names: list[str]) -> Any:
    index = {name: i for i, name in enumerate(names)}
    matrix = np.diag([float(graph["leader_links"].get(name, 0)) for name in names])
    for a, b, weight in graph["edges"]:
        e = np.zeros(len(names))
        e[index[a]], e[index[b]] = 1, -1
        matrix += float(weight) * np.outer(e, e)
    return matrix


def required(rows: dict[str, Any]) -> list[str]:
    sets = {"paper": ["(15)", "(16)"], "corrected": ["(16*)"], "rate-bounded": ["(15')", "(16*)"]}
    vehicles = rows["fleet"]["vehicle"]
    return sets[rows["conditions"]] + [
        name for name in vehicles[0]["limits"] if any(vehicle["limits"][name] for vehicle in vehicles)
    ]


def ends(parameter: Any) -> list[Any]:
    values = parameter if isinstance(parameter, list) else [parameter]
    return [mp.mpf(value) for value in values]


def margin_holds(condition: str, i: int, rows: dict[str, Any], graph: dict[str, Any]) -> bool:
    """The condition holds with the stated margin for every corner of the intervals of the parameters."""
    vehicle, margin = rows["fleet"]["vehicle"][i], rows["margins"][condition][i]
    limit = vehicle["limits"].get(condition, "1")
    if limit is None or margin is None:
        return limit is None and margin is None
    least = min(slack(condition, i, rows, graph, corner) for corner in corners(vehicle))
    gains = [mp.mpf(values[i if len(values) > 1 else 0]) for values in rows["gains"].values()]
    return bool(min(gains) > 0 and 0 <= mp.mpf(margin) <= least + mp.mpf(10) ** -60)


def corners(vehicle: dict[str, Any]) -> list[dict[str, Any]]:
    """Every choice of the ends of the intervals: of the controller's r and R, and of the vehicle's own values."""
    found: list[dict[str, Any]] = [{}]
    parts = {
        "r": vehicle["wheel_radius"],
        "own_r": vehicle["wheel_radius"],
        "R": vehicle["half_track"],
        "own_R": vehicle["half_track"],
        "m": vehicle["mass"],
        "I": vehicle["inertia"],
        "J": vehicle["wheel_inertia"],
    }
    for name, parameter in parts.items():
        found = [{**corner, name: value} for corner in found for value in ends(parameter)]
    return found


def slack(condition: str, i: int, rows: dict[str, Any], graph: dict[str, Any], corner: dict[str, Any]) -> Any:
    """large - small of a condition; (16) is divided by r and its arm's worst corner is the same."""
    vehicle, gains = rows["fleet"]["vehicle"][i], rows["gains"]
    name = vehicle["name"]
    D = mp.mpf(graph["leader_links"].get(name, "0"))
    D += sum(mp.mpf(weight) for a, b, weight in graph["edges"] if name in (a, b))
    keys = ("p_v", "d_v", "p_omega", "d_omega", "k_alpha", "speed_scale", "turn_rate_scale")
    p, d, pw, dw, k, s, o = (mp.mpf(gains[key][i]) for key in keys)
    bar, lever = mp.mpf(rows["psi_bar"]), 2 if rows["fleet"]["drive"] == "paper" else 1
    tau = min(ends(vehicle["torque_limit"]["left"]) + ends(vehicle["torque_limit"]["right"]))
    arm, own_arm, r, own_r = lever * corner["R"], lever * corner["own_R"], corner["r"], corner["own_r"]
    c, pull = mp.sqrt(2) * k * bar * D, mp.sqrt(2) * p * D
    if condition == "(15)":
        return dw * mp.tanh(1) - c
    if condition == "(15')":
        return dw - pw * D - c
    if condition == "(16)":
        least_arm, largest_r = lever * min(ends(vehicle["half_track"])), max(ends(vehicle["wheel_radius"]))
        return 2 * least_arm * tau / largest_r - least_arm * (d + pull) - dw - pw * D - c
    if condition == "(16*)":
        return tau - r / 2 * (d + mp.sqrt(2) * D * mp.hypot(p, k * bar / arm) + (dw + pw * D) / arm)
    limit = mp.mpf(vehicle["limits"][condition])
    if condition == "speed":
        return d * mp.tanh(limit / s) - pull
    if condition == "turn_rate":
        return dw * mp.tanh(limit / o) - pw * D - c
    if condition == "wheel_speed":
        if pull >= d or pw * D + c >= dw:
            return mp.mpf(-1)
        return own_r * limit - s * mp.atanh(pull / d) - own_arm * o * mp.atanh((pw * D + c) / dw)
    mass = (corner["m"] + 2 * corner["J"] / own_r**2) * own_r / r
    if condition == "acceleration":
        return limit * mass - d - pull
    inertia = (corner["I"] + 2 * corner["J"] * (own_arm / own_r) ** 2) * own_r / r * arm / own_arm
    return limit * inertia - dw - pw * D - c


def rate_holds(name: str, rows: dict[str, Any], laplacian: Any) -> bool:
    """The spectral abscissa of the linearisation is at most -gamma, with the middle of every interval."""
    stated = rows["rates"][name]
    if stated is None:
        return True
    turning, gains = name == "gamma_omega", rows["gains"]
    network, own = ("heading_scale", "turn_rate_scale") if turning else ("position_scale", "speed_scale")
    scales = np.array([float(value) for value in gains[own]])
    p, d = (np.array([float(q) for q in gains[f"{letter}_{'omega' if turning else 'v'}"]]) for letter in "pd")
    p, d = p / float(gains[network][0]), d / scales
    mass = np.array([middle(vehicle, rows["fleet"]["drive"], turning) for vehicle in rows["fleet"]["vehicle"]])
    n = len(mass)
    linear = np.block([[np.zeros((n, n)), np.eye(n)], [-(p / mass)[:, None] * laplacian, -np.diag(d / mass)]])
    return bool(0 < float(stated["rate"]) <= -np.linalg.eigvals(linear).real.max() + 1e-9)


def middle(vehicle: dict[str, Any], drive: str, turning: bool) -> float:
    """The effective mass or inertia with the middle of every interval."""
    value = {name: float(sum(ends(vehicle[name])) / len(ends(vehicle[name]))) for name in (
        "mass", "inertia", "half_track", "wheel_radius", "wheel_inertia"
    )}  # fmt: skip
    arm = (2 if drive == "paper" else 1) * value["half_track"] if turning else 1.0
    own = value["inertia"] if turning else value["mass"]
    return own + 2 * value["wheel_inertia"] * (arm / value["wheel_radius"]) ** 2
