"""The truth of a certificate at the edge: the formulas of the theorem in interval arithmetic of 60 digits."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from functools import lru_cache
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from gaincert.models.gains import GAIN_NAMES
from mpmath.ctx_iv import MPIntervalContext
from mpmath.ctx_mp import MPContext

SETS = {"paper": ("(15)", "(16)"), "corrected": ("(16*)",), "rate-bounded": ("(15')", "(16*)")}
SPEED, TURN_RATE, WHEEL_SPEED, PSI_BAR = "speed", "turn_rate", "wheel_speed", "psi_bar"
ACCELERATION, TURN_ACCELERATION = "acceleration", "turn_acceleration"
LIMITS = (SPEED, TURN_RATE, WHEEL_SPEED, ACCELERATION, TURN_ACCELERATION)
TORQUE = ("(16)", "(16*)")
EVERY_SET = (*LIMITS, PSI_BAR)
CONDITIONS = ("(15)", "(15')", *TORQUE, *EVERY_SET)


class Row(NamedTuple):
    """The numbers of one vehicle in the conditions, of any one type."""

    degree: Any  # D = a_il + l_ii
    bar: Any  # psi_bar
    r: Any  # m
    arm: Any  # m, 2R on the paper's drive, R on a physical one
    torque: Any  # N m
    speed: Any  # m/s, None where no limit is asked for
    turn_rate: Any  # rad/s
    wheel_speed: Any  # rad/s
    acceleration: Any  # m/s^2
    turn_acceleration: Any  # rad/s^2
    mass: Any  # kg, effective, the least
    inertia: Any  # kg m^2, effective, the least
    least_r: Any  # m
    longest_arm: Any  # m
    speed_scale: Any  # m/s
    turn_rate_scale: Any  # rad/s
    p_v: Any
    d_v: Any
    p_omega: Any
    d_omega: Any
    k_alpha: Any

    def map(self, convert: Any) -> Row:
        """The same row in another type of number."""
        return Row(*(value if value is None else convert(value) for value in self))


class Intervals:
    """Interval arithmetic of 60 digits with the two functions that the conditions need."""

    def __init__(self) -> None:
        self.context = MPIntervalContext()
        self.context.dps = 60
        self.mpf, self.sqrt = self.context.mpf, self.context.sqrt

    def tanh(self, q: Any) -> Any:
        """tanh q = 1 - 2 / (exp(2 q) + 1): q is there once, so that the interval stays narrow."""
        return 1 - 2 / (self.context.exp(2 * self.mpf(q)) + 1)

    def atanh(self, q: Any) -> Any:
        """Half the logarithm of (1 + q) / (1 - q) = 2 / (1 - q) - 1."""
        return self.context.log(2 / (1 - self.mpf(q)) - 1) / 2


IV = Intervals()
FINE = MPContext()
FINE.dps = 90


def sides(numbers: Any, condition: str, v: Row) -> tuple[Any, Any]:
    """(small, large) of a condition small <= large; `numbers` has sqrt and tanh for the type of the row."""
    root2 = numbers.sqrt(2)
    c = root2 * v.k_alpha * v.bar * v.degree
    if condition == "(15)":
        return c, v.d_omega * numbers.tanh(1)
    if condition == "(15')":
        return v.p_omega * v.degree + c, v.d_omega
    if condition == "(16)":
        u_v = v.d_v + root2 * v.p_v * v.degree
        return v.arm * u_v + v.d_omega + v.p_omega * v.degree + c, 2 * v.arm / v.r * v.torque
    if condition == "(16*)":
        pull = root2 * v.degree * numbers.sqrt(v.p_v**2 + (v.k_alpha * v.bar / v.arm) ** 2)
        return v.r / 2 * (v.d_v + pull + (v.d_omega + v.p_omega * v.degree) / v.arm), v.torque
    pull, turn = root2 * v.p_v * v.degree, v.p_omega * v.degree + c
    if condition == SPEED:
        return pull, v.d_v * numbers.tanh(v.speed / v.speed_scale)
    if condition == TURN_RATE:
        return turn, v.d_omega * numbers.tanh(v.turn_rate / v.turn_rate_scale)
    if condition == ACCELERATION:
        return v.d_v + pull, v.acceleration * v.mass
    if condition == TURN_ACCELERATION:
        return v.d_omega + turn, v.turn_acceleration * v.inertia
    rim, arm_speed = rim_speeds(numbers, v)
    return rim + arm_speed, v.least_r * v.wheel_speed


def rim_speeds(numbers: Any, v: Row) -> tuple[Any, Any]:
    """The certified bounds of |v| and of the arm times |omega|."""
    root2 = numbers.sqrt(2)
    rim = v.speed_scale * numbers.atanh(root2 * v.p_v * v.degree / v.d_v)
    turn = v.p_omega * v.degree + root2 * v.k_alpha * v.bar * v.degree
    return rim, v.longest_arm * v.turn_rate_scale * numbers.atanh(turn / v.d_omega)


def asked(condition: str, v: Row) -> bool:
    """Whether a condition concerns a vehicle."""
    return condition not in LIMITS or getattr(v, condition) is not None


@lru_cache(maxsize=8)
def supremum(table: str) -> Any:
    """sup |psi| of an excitation table (JSON), to 80 digits: Newton's method on psi' from the tops on a fine grid."""
    psi = json.loads(table)
    mean = FINE.mpf(psi["mean"])
    if psi["family"] == "square-wave":
        terms = [(n, 4 / (n * FINE.pi), FINE.mpf(0)) for n in range(1, 2 * psi["terms"], 2)]
    else:
        size = max(len(psi["sin"]), len(psi["cos"]))
        sin, cos = ([FINE.mpf(q) for q in psi[key]] + [FINE.mpf(0)] * size for key in ("sin", "cos"))
        terms = [(n + 1, sin[n], cos[n]) for n in range(size)]
    grid = np.linspace(0, 2 * math.pi, 4097)
    height: Any = abs(float(mean) + sum(float(s) * np.sin(n * grid) + float(c) * np.cos(n * grid) for n, s, c in terms))
    tops = (height >= np.roll(height, 1)) & (height >= np.roll(height, -1)) & (height > 0.999 * height.max())
    return max(abs(_top(mean, terms, FINE.mpf(float(x)))) for x in grid[tops])


def _top(mean: Any, terms: list[Any], x: Any) -> Any:
    for _ in range(9):
        waves = [(n, s, c, *FINE.cos_sin(n * x)) for n, s, c in terms]
        slope = sum(n * (s * cosine - c * sine) for n, s, c, cosine, sine in waves)
        bend = sum(n * n * (s * sine + c * cosine) for n, s, c, cosine, sine in waves)
        if abs(slope) < abs(bend) * FINE.mpf(10) ** -45:  # |psi| is then within its square of the top
            return mean + sum(s * sine + c * cosine for _, s, c, cosine, sine in waves)
        x += slope / bend
    raise ArithmeticError("Newton's method did not reach the top of psi")


class Judgement(NamedTuple):
    """One statement of a certificate."""

    true: bool | None  # None: too close for 60 digits
    margin: float  # (large - small - stated margin) / large; the least over the corners


def theory(document: dict[str, Any]) -> dict[tuple[str, str], Judgement]:
    """The truth of a certificate's conditions and psi_bar, {(condition, vehicle): ...}, from its text alone."""
    found: dict[tuple[str, str], Judgement] = {}
    for condition, vehicle, margin in _margins(document):
        true = True if margin > 0 else False if margin < 0 else None
        one, place = Judgement(true, float(margin.mid)), (condition, vehicle)
        found[place] = min(one, found.get(place, one), key=lambda other: other.margin)
    return found


def _margins(document: dict[str, Any]) -> Iterator[tuple[str, str, Any]]:
    used = document["fleet"] | document["designed"]
    bar = IV.mpf(document["psi_bar"])
    top = supremum(json.dumps(used["excitation"]))
    error = FINE.mpf(10) ** -60
    yield PSI_BAR, "", 1 - IV.mpf([top * (1 - error), top * (1 + error)]) / bar
    for i, vehicle in enumerate(used["vehicle"]):
        corners = list(_corners(document, used, i, bar))
        for condition, stated in document["margins"].items():
            for corner in corners if condition not in INDIFFERENT else corners[:1]:
                if asked(condition, corner):
                    small, large = sides(IV, condition, corner)
                    yield condition, vehicle["name"], (large - small - IV.mpf(stated[i])) / large


INDIFFERENT = ("(15)", "(15')", SPEED, TURN_RATE)  # to the parameters that may be intervals
PARAMETERS = ("wheel_radius", "half_track", "mass", "inertia", "wheel_inertia")


def _corners(document: dict[str, Any], used: dict[str, Any], i: int, bar: Any) -> Iterator[Row]:
    """Every choice of the ends of the intervals: the controller's r and R, and the vehicle's own values."""
    vehicle, graph = used["vehicle"][i], used["graph"]
    name, lever = vehicle["name"], 2 if used["drive"] == "paper" else 1
    degree = IV.mpf(graph["leader_links"].get(name, "0"))
    for a, b, weight in graph["edges"]:
        if name in (a, b):
            degree += IV.mpf(weight)
    limits = {key: value and IV.mpf(value) for key, value in vehicle["limits"].items()}
    gains = {gain: IV.mpf(document["gains"][gain][i]) for gain in (*GAIN_NAMES, "speed_scale", "turn_rate_scale")}
    ends = {key: [IV.mpf(end) for end in ends_of(vehicle[key])] for key in PARAMETERS}
    torques = {*ends_of(vehicle["torque_limit"]["left"]), *ends_of(vehicle["torque_limit"]["right"])}
    choices = product(*(ends[key] for key in (*PARAMETERS[:2], *PARAMETERS)))
    for r, R, own_r, own_R, m, inertia, J in choices:
        row = Row(
            degree=degree,
            bar=bar,
            r=r,
            arm=lever * R,
            torque=None,
            mass=(m + 2 * J / own_r**2) * own_r / r,
            inertia=(inertia + 2 * J * (lever * own_R / own_r) ** 2) * own_r / r * R / own_R,
            least_r=own_r,
            longest_arm=lever * own_R,
            **limits,
            **gains,
        )
        for torque in torques:
            yield row._replace(torque=IV.mpf(torque))


def ends_of(parameter: Any) -> list[str]:
    """The ends of an interval, or the number itself."""
    return parameter if isinstance(parameter, list) else [parameter]
