"""Whether the trusted kernel ever accepts what is false: random fleets a hair's breadth from the edge of a condition.

    python tests/campaigns/soundness.py [COUNT] [--first N] [--show N]

Each fleet has one number (a gain, a torque limit or psi_bar) moved to a relative margin of +-1e-3 .. +-1e-15 from the
edge of one condition of one vehicle, to the nearest decimals on either side of it, or, where the edge is rational,
onto it. A margin that the certificate states counts as part of the condition. All other conditions hold with room.
Three judges decide the same certificate:

  kernel     verify/kernel.py on the JSON document
  limits.py  models/conditions.py in exact fractions, with psi_bar of models/excitation.py
  theory     `sides` below, written from the formulas of the theorem, in mpmath's interval arithmetic of 60 digits, at
             every corner of the intervals of the parameters; where the margin's interval holds 0 it is "too close"

Then the units of some fleets are changed by 1e-8 and 1e8, which must change no verdict. Exit code 1 where the kernel
accepts a false statement, or judges disagree on one farther from the edge than the stated band.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import math
import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from decimal import ROUND_CEILING, ROUND_FLOOR, ROUND_HALF_EVEN, Context, Decimal, localcontext
from fractions import Fraction
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from gaincert.models.arrays import column
from gaincert.models.conditions import condition_set, exact_numbers
from gaincert.models.fleet import Fleet
from gaincert.models.fleet_tables import ExcitationTable, Harmonics, SquareWave
from gaincert.models.gains import GAIN_NAMES, Gains
from gaincert.verify import kernel
from mpmath.ctx_iv import MPIntervalContext
from mpmath.ctx_mp import MPContext
from pydantic import TypeAdapter

SETS = {"paper": ("(15)", "(16)"), "corrected": ("(16*)",), "rate-bounded": ("(15')", "(16*)")}
SPEED, TURN_RATE, PSI_BAR = "speed limit", "turn rate limit", "psi_bar"
TORQUE = ("(16)", "(16*)")
EVERY_SET = (SPEED, TURN_RATE, PSI_BAR)
CONDITIONS = ("(15)", "(15')", *TORQUE, *EVERY_SET)

# What may be moved to the edge of a condition; small and large are affine in each of them.
KNOBS = {
    "(15)": ("d_omega", "k_alpha"),
    "(15')": ("d_omega", "p_omega", "k_alpha"),
    "(16)": ("torque", "torque", "d_v", "p_v", "d_omega", "p_omega", "k_alpha"),
    "(16*)": ("torque", "torque", "d_v", "d_omega", "p_omega"),
    SPEED: ("d_v", "p_v"),
    TURN_RATE: ("d_omega", "p_omega", "k_alpha"),
}

# Relative margins up to which a judge may refuse what is true. The kernel decides roots exactly and tanh to 1e-90, but
# not |psi| <= psi_bar at the supremum itself; conditions.py encloses roots and tanh (down to 1e-3) within 1e-40, and
# excitation.py exceeds the supremum by at most 1e-8.
KERNEL_BAND = dict.fromkeys(CONDITIONS, 1e-60) | {PSI_BAR: 1e-36}
LIMITS_BAND = dict.fromkeys(CONDITIONS, 1e-36) | {PSI_BAR: 1.1e-8}

PLACES = Context(prec=120)  # of the decimals here: enough for every product to be exact


# -- the theory, once for floats, long floats and intervals -----------------------------------------------------------


class Row(NamedTuple):
    """The numbers of one vehicle in the conditions, of any one type."""

    degree: Any  # D = a_il + l_ii
    bar: Any  # psi_bar
    r: Any  # m
    arm: Any  # m, 2R on the paper's drive, R on a physical one
    torque: Any  # N m
    speed: Any  # m/s, None where no limit is asked for
    turn_rate: Any  # rad/s
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
        """tanh q = 1 - 2 / (exp(2 q) + 1): q stands there once, so that the interval stays narrow."""
        return 1 - 2 / (self.context.exp(2 * self.mpf(q)) + 1)


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
    if condition == SPEED:
        return root2 * v.p_v * v.degree, v.d_v * numbers.tanh(v.speed)
    return v.p_omega * v.degree + c, v.d_omega * numbers.tanh(v.turn_rate)


def asked(condition: str, v: Row) -> bool:
    """Whether a condition concerns a vehicle."""
    return {SPEED: v.speed, TURN_RATE: v.turn_rate}.get(condition, 1) is not None


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
            for corner in corners if condition in TORQUE else corners[:1]:  # the others are without r, R and torque
                if asked(condition, corner):
                    small, large = sides(IV, condition, corner)
                    yield condition, vehicle["name"], (large - small - IV.mpf(stated[i])) / large


def _corners(document: dict[str, Any], used: dict[str, Any], i: int, bar: Any) -> Iterator[Row]:
    vehicle, graph = used["vehicle"][i], used["graph"]
    name, lever = vehicle["name"], 2 if used["drive"] == "paper" else 1
    degree = IV.mpf(graph["leader_links"].get(name, "0"))
    for a, b, weight in graph["edges"]:
        if name in (a, b):
            degree += IV.mpf(weight)
    limits = (value and IV.mpf(value) for value in (vehicle["limits"]["speed"], vehicle["limits"]["turn_rate"]))
    gains = [IV.mpf(document["gains"][gain][i]) for gain in GAIN_NAMES]
    radii, tracks = _ends(vehicle["wheel_radius"]), _ends(vehicle["half_track"])
    torques = _ends(vehicle["torque_limit"]["left"]) | _ends(vehicle["torque_limit"]["right"])
    first = Row(degree, bar, None, None, None, *limits, *gains)
    for r in radii:
        for half_track in tracks:
            for torque in torques:
                yield first._replace(r=IV.mpf(r), arm=lever * IV.mpf(half_track), torque=IV.mpf(torque))


def _ends(parameter: Any) -> set[str]:
    return set(parameter if isinstance(parameter, list) else [parameter])


# -- fleets at the edge -----------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Trial:
    """A certificate and where it was moved to."""

    seed: int
    document: dict[str, Any]
    condition: str
    vehicle: str
    on_the_edge: bool  # exactly, by construction: small + stated margin = large, which is true where <= is asked for


class Aim(NamedTuple):
    """Where to move a number: a relative margin from the edge, and how its decimal is rounded."""

    margin: Decimal
    digits: int
    rounding: str


class Draw:
    """Random decimals."""

    def __init__(self, seed: int) -> None:
        self.random = np.random.default_rng(seed)

    def chance(self, share: float) -> bool:
        """True in that share of the draws."""
        return bool(self.random.random() < share)

    def one_of(self, values: Iterable[Any]) -> Any:
        """One of some values."""
        listed = list(values)
        return listed[int(self.random.integers(len(listed)))]

    def power(self, low: float, high: float) -> float:
        """10 to a uniform exponent."""
        return float(10 ** self.random.uniform(low, high))

    def decimal(self, low: float, high: float) -> Decimal:
        """The same, as a decimal of two to five digits."""
        return up(self.power(low, high), int(self.random.integers(2, 6)))

    def aim(self, most_digits: int) -> Aim:
        """A margin with enough digits for it; the nearest decimals to the edge in a third of the draws."""
        if self.chance(0.33):
            digits = int(self.random.integers(12, most_digits + 1))
            return Aim(Decimal(0), digits, self.one_of([ROUND_FLOOR, ROUND_CEILING]))
        margin = self.one_of([1, -1]) * Decimal(10) ** self.one_of([-3, -6, -9, -12, -15])
        return Aim(margin, int(self.random.integers(20, most_digits + 1)), ROUND_HALF_EVEN)


def up(value: Any, digits: int) -> Decimal:
    """A positive float as a decimal of so many digits, not below it."""
    return Context(prec=digits, rounding=ROUND_CEILING).create_decimal(Decimal(value))


def rounded(value: Any, aim: Aim) -> Decimal:
    """A long float as a decimal, as aimed at."""
    text = FINE.nstr(value, 80, strip_zeros=False)
    return Context(prec=aim.digits, rounding=aim.rounding).create_decimal(text)


def text(value: Decimal) -> str:
    """A decimal without an exponent, as certificates write it."""
    return format(value, "f")


def draw(seed: int, condition: str | None = None) -> Trial:
    """A fleet at the edge of one condition; attempts where another condition stands in the way are dropped."""
    random = Draw(seed)
    chosen = condition or random.one_of(CONDITIONS)
    with localcontext(PLACES):
        while True:
            trial = _attempt(random, seed, chosen)
            if trial is not None:
                return trial


def _attempt(random: Draw, seed: int, condition: str) -> Trial | None:
    conditions = random.one_of(name for name in SETS if condition in SETS[name] + EVERY_SET)
    on_the_edge = condition in ("(16*)", PSI_BAR) and random.chance(0.15)
    drive = random.one_of(["physical", "paper"])
    psi = _psi(random, rational=on_the_edge and condition == PSI_BAR)
    bar = _bar(random, psi, moved=condition == PSI_BAR, on_the_edge=on_the_edge)
    graph, degrees, forest = _graph(random, int(random.random.integers(1, 9)))
    rows = [_row(random, degree, bar, drive) for degree in degrees]
    i = int(random.random.integers(len(rows)))
    rows[i] = _with_limit(random, rows[i], condition)
    names = [*SETS[conditions], *(name for name in (SPEED, TURN_RATE) if any(asked(name, row) for row in rows))]
    rows = [_damped(random, row, names) for row in rows]
    stated, rational = Decimal(0), on_the_edge and condition == "(16*)"
    if rational:
        rows[i] = _with_rational_torque(random, rows[i], names)
    if condition not in (*TORQUE, PSI_BAR):
        rows[i], stated = _moved(random, rows[i], condition)
    rows = [_with_torque(random, row, names) for row in rows]  # after the gains, so that it leaves room for them
    if rational:
        rows[i], stated, on_the_edge = _on_the_edge(random, rows[i])
    elif condition in TORQUE:
        rows[i], stated = _moved(random, rows[i], condition)
    if not all(_clear(row, names, condition if j == i else None) for j, row in enumerate(rows)):
        return None
    margins = {name: ["0" if asked(name, row) else None for row in rows] for name in names}
    if condition != PSI_BAR:
        margins[condition][i] = text(stated)
    document = _document(random, conditions, drive, psi, graph, rows) | {"forest": forest, "margins": margins}
    return Trial(seed, signed(document), condition, "" if condition == PSI_BAR else f"v{i}", on_the_edge)


def _psi(random: Draw, *, rational: bool) -> dict[str, Any]:
    """An excitation table; `rational`: with a rational supremum."""
    mean = text(random.one_of([1, -1]) * random.decimal(-1, 1)) if random.chance(0.5) else "0"
    frequency = text(random.decimal(-1, 1))
    if rational:  # 3^2 + 4^2 = 5^2
        unit, rest = random.decimal(-2, 1), ["0"] * int(random.random.integers(0, 4))
        sin, cos = ([*rest, text(unit * size)] for size in (3, 4))
    elif random.chance(0.4):
        terms = int(random.random.integers(1, 7))
        return {"family": "square-wave", "mean": mean, "terms": terms, "frequency": frequency}
    else:
        sizes = random.random.integers(1, 6), random.random.integers(0, 6)
        sin, cos = ([text(random.one_of([1, -1]) * random.decimal(-2, 1)) for _ in range(size)] for size in sizes)
    return {"family": "harmonics", "mean": mean, "frequency": frequency, "sin": sin, "cos": cos}


def _bar(random: Draw, psi: dict[str, Any], *, moved: bool, on_the_edge: bool) -> Decimal:
    """psi_bar: at the supremum, the bound that the product computes, or a looser one."""
    if on_the_edge and moved:
        return abs(Decimal(psi["mean"])) + 5 * Decimal(psi["sin"][-1]) / 3
    if moved:
        aim = random.aim(34)
        return rounded(supremum(json.dumps(psi)) / (1 - FINE.mpf(str(aim.margin))), aim)
    bound = certified_bound(json.dumps(psi))
    decimal = Decimal(bound.numerator) / Decimal(bound.denominator)
    return decimal if random.chance(0.5) else up(decimal * Decimal(1 + random.power(-6, 0)), 14)


@lru_cache(maxsize=8)
def certified_bound(table: str) -> Fraction:
    """psi_bar as models/excitation.py proves it."""
    given: SquareWave | Harmonics = TypeAdapter(ExcitationTable).validate_python(json.loads(table))
    return given.psi.bound


def _graph(random: Draw, n: int) -> tuple[dict[str, Any], list[Decimal], list[list[int]]]:
    """A random tree below the leader with some more links, weights from 1e-3 to 1e3; degrees; the tree."""
    forest = [[j, int(random.random.integers(-1, j)) if j else -1] for j in range(n)]
    pairs = {(j, parent) for j, parent in forest}
    pairs |= {(j, k) for j in range(n) for k in range(-1, j) if random.chance(0.2)}
    degrees, edges, led = [Decimal(0)] * n, [], {}
    for j, k in sorted(pairs):
        weight = random.decimal(-3, 3)
        degrees[j] += weight
        if k < 0:
            led[f"v{j}"] = text(weight)
        else:
            degrees[k] += weight
            edges.append([f"v{j}", f"v{k}", text(weight)])
    return {"edges": edges, "leader_links": led}, degrees, forest


def _row(random: Draw, degree: Decimal, bar: Decimal, drive: str) -> Row:
    """The worst case of one vehicle, without its damping and torque limit."""
    half_track, lever = random.decimal(-2, 0), 2 if drive == "paper" else 1
    speed, turn_rate = (random.decimal(-3, 1) if random.chance(0.2) else None for _ in range(2))
    pull, heading, swing = (random.power(-2, 2) / float(degree) for _ in range(3))
    p_v, p_omega, k = (up(value, 6) for value in (pull, heading, swing / float(bar)))
    one = Decimal(1)
    r, arm = random.decimal(-2, 0), lever * half_track
    return Row(degree, bar, r, arm, one, speed, turn_rate, p_v, one, p_omega, one, k)


def _with_limit(random: Draw, row: Row, condition: str) -> Row:
    if condition == SPEED:
        return row._replace(speed=random.decimal(-3, 1))
    return row._replace(turn_rate=random.decimal(-3, 1)) if condition == TURN_RATE else row


def _loose(random: Draw, row: Row, names: Iterable[str], knob: str) -> Decimal:
    """A value of a number on which `large` alone depends, linearly, so that the conditions hold with room."""
    one = row.map(float)._replace(**{knob: 1.0})
    needs = [small / large for small, large in (sides(math, name, one) for name in names if asked(name, row))]
    return up(max([random.power(-2, 2) if knob != "torque" else 0.0, *needs]) * random.power(0.03, 1), 6)


def _damped(random: Draw, row: Row, names: list[str]) -> Row:
    turning = [name for name in names if name not in (*TORQUE, SPEED)]
    d_v = _loose(random, row, [SPEED], "d_v")
    return row._replace(d_v=d_v, d_omega=_loose(random, row, turning, "d_omega"))


def _with_torque(random: Draw, row: Row, names: list[str]) -> Row:
    return row._replace(torque=_loose(random, row, [name for name in names if name in TORQUE], "torque"))


def _stated(random: Draw, condition: str, row: Row) -> Decimal:
    """A margin that the certificate states; mostly none."""
    small, _ = sides(math, condition, row.map(float))
    return up(small * random.power(-6, 0), 4) if random.chance(0.25) else Decimal(0)


def _moved(random: Draw, row: Row, condition: str) -> tuple[Row, Decimal]:
    """The row with one number at the edge, and the margin to be stated."""
    knob, aim, stated = random.one_of(KNOBS[condition]), random.aim(50), _stated(random, condition, row)
    long = row.map(lambda value: FINE.mpf(str(value)))

    def excess(value: int) -> Any:
        small, large = sides(FINE, condition, long._replace(**{knob: FINE.mpf(value)}))
        return large * (1 - FINE.mpf(str(aim.margin))) - small - FINE.mpf(str(stated))

    at_0, at_1 = excess(0), excess(1)  # affine in between and beyond
    return row._replace(**{knob: rounded(at_0 / (at_0 - at_1), aim)}), stated


def _with_rational_torque(random: Draw, row: Row, names: list[str]) -> Row:
    """Gains with the ratio a : b of p_v to k psi_bar / arm, 2 (a^2 + b^2) a square, and no division by arm left."""
    a, b = random.one_of([(1, 1), (1, 7), (7, 1), (7, 17), (17, 7)])
    unit = up(float(row.k_alpha / row.arm), 3)
    row = row._replace(p_v=a * row.bar * unit, k_alpha=b * row.arm * unit)
    row = row._replace(p_omega=row.arm * up(float(row.p_omega / row.arm), 3))
    row = _damped(random, row, names)
    return row._replace(d_omega=row.arm * up(float(row.d_omega / row.arm), 4))


def _on_the_edge(random: Draw, row: Row) -> tuple[Row, Decimal, bool]:
    """The torque limit equal to the bound of (16*), plus the stated margin, or one unit of the 50th digit beside it."""
    stated = _stated(random, "(16*)", row)
    # sqrt2 sqrt(..) = sqrt(2 ..) is rational here, so that these decimals are exact
    pull = row.degree * (2 * (row.p_v**2 + (row.k_alpha * row.bar / row.arm) ** 2)).sqrt()
    bound = row.r / 2 * (row.d_v + pull + row.d_omega / row.arm + row.p_omega / row.arm * row.degree) + stated
    beside = random.one_of([0, 0, 1, -1])
    return row._replace(torque=bound + beside * Decimal(10) ** (bound.adjusted() - 49)), stated, beside == 0


def _clear(row: Row, names: list[str], moved: str | None) -> bool:
    """Whether all numbers are positive and all conditions but the moved one hold with room."""
    if min(value for value in row if value is not None) <= 0:
        return False
    number = row.map(float)
    pairs = (sides(math, name, number) for name in names if name != moved and asked(name, row))
    return all(large - small > 0.01 * large for small, large in pairs)


_DECOY_PSI = {"family": "harmonics", "mean": "0", "frequency": "1", "sin": ["1000"], "cos": []}


def _document(
    random: Draw, conditions: str, drive: str, psi: dict[str, Any], graph: dict[str, Any], rows: list[Row]
) -> dict[str, Any]:
    """The certificate without forest and margins; in some, psi and links stand as designed beside a decoy."""
    vehicles = [_vehicle(random, f"v{j}", row, 2 if drive == "paper" else 1) for j, row in enumerate(rows)]
    fleet = {"drive": drive, "excitation": psi, "graph": graph, "vehicle": vehicles}
    designed = {}
    if random.chance(0.2):
        designed["excitation"], fleet["excitation"] = psi, _DECOY_PSI
    if random.chance(0.2):
        decoy = {"edges": [], "leader_links": {vehicle["name"]: "0.001" for vehicle in vehicles}}
        designed["graph"], fleet["graph"] = graph, decoy
    return {
        "schema": kernel.SCHEMA,
        "conditions": conditions,
        "fleet": fleet,
        "designed": designed,
        "gains": {name: [text(getattr(row, name)) for row in rows] for name in GAIN_NAMES},
        "psi_bar": text(rows[0].bar),
        "psi_point": {"half_tangent": "0", "half_turn": 0, "at_least": "0"},
        "psi_power": "0." + "0" * 20 + "1",
        "rates": {"gamma_omega": None, "gamma_v": None},
        "provenance": {},
    }


def _vehicle(random: Draw, name: str, row: Row, lever: int) -> dict[str, Any]:
    """A vehicle whose worst case is the row, some of its parameters as intervals."""

    def parameter(low: Decimal, high: Decimal, worst: Decimal) -> Any:
        return [text(low), text(high)] if random.chance(0.2) else text(worst)

    def more(value: Decimal) -> Decimal:
        return up(value * Decimal(1 + random.power(-3, 0)), 8)

    half_track, mass, inertia = row.arm / lever, random.decimal(-1, 2), random.decimal(-2, 1)
    other = more(row.torque) if random.chance(0.5) else row.torque
    torque = [parameter(side, more(side), side) for side in (row.torque, other)]
    left, right = torque if random.chance(0.5) else torque[::-1]
    return {
        "name": name,
        "mass": parameter(mass, more(mass), mass),
        "inertia": parameter(inertia, more(inertia), inertia),
        "half_track": parameter(half_track, more(half_track), half_track),
        "wheel_radius": parameter(row.r * Decimal("0.875"), row.r, row.r),
        "torque_limit": {"left": left, "right": right},
        "offset": ["0", "0"],
        "limits": {"speed": row.speed and text(row.speed), "turn_rate": row.turn_rate and text(row.turn_rate)},
    }


def signed(document: dict[str, Any]) -> dict[str, Any]:
    """With the digest of its fleet."""
    canonical = json.dumps(document["fleet"], sort_keys=True, separators=(",", ":"))
    return {**document, "digest": "sha256:" + hashlib.sha256(canonical.encode()).hexdigest()}


# -- the judges -------------------------------------------------------------------------------------------------------


def limits_hold(document: dict[str, Any]) -> bool:
    """The verdict of models/conditions.py and models/excitation.py on a certificate's conditions and psi_bar."""
    leader = {"position": ["0", "0"], "heading": "0"}
    fleet = Fleet.model_validate({"name": "drawn", "leader": leader, **document["fleet"], **document["designed"]})
    assert fleet.psi is not None
    bar, own = Fraction(document["psi_bar"]), fleet.condition_data(fleet.psi)
    gains = Gains(*(column(map(Fraction, document["gains"][name])) for name in GAIN_NAMES))
    found = condition_set(document["conditions"]).inequalities(exact_numbers(), replace(own, psi_bar=bar), gains)
    stated = {name: [Fraction(margin or 0) for margin in entries] for name, entries in document["margins"].items()}
    return own.psi_bar <= bar and all(
        bool(np.all(one.holds)) and bool(np.all(one.margin >= stated[one.source])) for one in found
    )


class Outcome(NamedTuple):
    """What the judges say of one fleet."""

    trial: Trial
    truth: bool | None  # None: nobody knows
    theory: Judgement  # of the statement at the edge; all others are clearly true
    verdict: kernel.Verdict
    limits: bool

    @property
    def margin(self) -> float:
        """How far from the edge."""
        return 0.0 if self.trial.on_the_edge else abs(self.theory.margin)

    @property
    def falsely_accepted(self) -> bool:
        """The kernel accepts what is false."""
        return self.truth is False and self.verdict.valid

    @property
    def refused(self) -> bool:
        """The kernel refuses what is true."""
        return self.truth is True and not self.verdict.valid

    @property
    def undecided_by_limits(self) -> bool:
        """limits.py does not confirm what is true, within its band."""
        return self.truth is True and not self.limits and self.margin <= LIMITS_BAND[self.trial.condition]

    @property
    def limits_disagree(self) -> bool:
        """limits.py confirms what is false, or refuses what is true beyond its band."""
        return self.truth is not None and self.limits != self.truth and not self.undecided_by_limits

    @property
    def refused_elsewhere(self) -> bool:
        """The kernel refuses what is false for another vehicle or condition than the false one."""
        if self.truth is not False or self.verdict.valid:
            return False
        if self.trial.condition == PSI_BAR:
            return self.verdict.rule != "psi_bounded"
        return not self.verdict.reason.startswith(f"{self.trial.condition}: vehicle {self.trial.vehicle!r}")

    def failures(self) -> list[str]:
        """What must not be, in words."""
        trial = self.trial
        found = {
            "the kernel accepts what is false": self.falsely_accepted,
            "the kernel refuses what is true": self.refused and self.margin > KERNEL_BAND[trial.condition],
            f"the kernel refuses for another reason: {self.verdict.reason}": self.refused_elsewhere,
            f"limits.py says {self.limits}": self.limits_disagree,
            "60 digits decide what is exactly on the edge": trial.on_the_edge and self.theory.true is not None,
        }
        where = f"fleet {trial.seed}, {trial.condition} {trial.vehicle}, margin {self.theory.margin:.2e}"
        return [f"{where}: {what}" for what, holds in found.items() if holds]


def judged(trial: Trial) -> Outcome:
    """The three judges on one fleet."""
    found = theory(trial.document)
    moved = found.pop((trial.condition, trial.vehicle))
    if not all(other.true for other in found.values()):
        raise ArithmeticError(f"fleet {trial.seed}: more than {trial.condition} of {trial.vehicle} is in question")
    truth = True if trial.on_the_edge and moved.true is None else moved.true
    return Outcome(trial, truth, moved, kernel.check(json.dumps(trial.document)), limits_hold(trial.document))


# -- other units ------------------------------------------------------------------------------------------------------

_GAINS = dict.fromkeys(GAIN_NAMES, 1)
_TURNING = dict.fromkeys(("p_omega", "d_omega", "k_alpha"), 1)
_TURNING_MARGINS = dict.fromkeys(("(15)", "(15')", TURN_RATE), 1)
# Powers of the factor by which the entries under a key are multiplied; the truth does not change, because ...
SCALINGS: dict[str, dict[str, int]] = {
    # ... both sides of every condition are forces, moments or torques
    "force": {"mass": 1, "inertia": 1, "torque_limit": 1, **_GAINS, **dict.fromkeys(CONDITIONS[:6], 1)},
    # ... p_v, p_omega and k_alpha come with D alone
    "weights": {"edges": 1, "leader_links": 1, "p_v": -1, "p_omega": -1, "k_alpha": -1},
    # ... torque comes with 1 / r alone
    "wheels": {"wheel_radius": 1, "torque_limit": 1, "(16*)": 1},
    # ... p_omega, d_omega and k_alpha come with 1 / arm alone, or with each other
    "arm": {"half_track": 1, **_TURNING, **_TURNING_MARGINS, "(16)": 1},
    # ... k_alpha comes with psi_bar alone
    "psi": {"mean": 1, "sin": 1, "cos": 1, "psi_bar": 1, "psi_power": 2, "k_alpha": -1},
}
SHIFTS = (-8, 8)


def rescaled(document: dict[str, Any], scaling: str, shift: int) -> dict[str, Any]:
    """The certificate with its numbers times 10^shift, as the scaling says."""
    powers = SCALINGS[scaling]

    def times(value: Any, power: int) -> Any:
        if isinstance(value, list):
            return [times(entry, power) for entry in value]
        if isinstance(value, dict):
            return {key: times(entry, power) for key, entry in value.items()}
        named = value is None or value.startswith("v")  # a vehicle's name in an edge
        return value if named else text(Decimal(value).scaleb(power * shift))

    def walk(value: Any) -> Any:
        if isinstance(value, list):
            return [walk(entry) for entry in value]
        if not isinstance(value, dict):
            return value
        return {k: times(entry, powers[k]) if k in powers else walk(entry) for k, entry in value.items()}

    with localcontext(PLACES):
        return signed(walk(document))


class Rescaled(NamedTuple):
    """How the judges see a certificate in other units."""

    outcome: Outcome
    scaling: str
    shift: int
    same: bool  # to the kernel
    limits_same: bool  # to limits.py

    def failures(self) -> list[str]:
        """A verdict that changed; limits.py may, so near to the edge that it need not decide."""
        trial, decided = self.outcome.trial, self.outcome.margin > LIMITS_BAND[self.outcome.trial.condition]
        where = f"fleet {trial.seed}, {trial.condition}: {self.scaling} times 1e{self.shift} changes the verdict of"
        found = {"the kernel": not self.same, "limits.py": decided and not self.limits_same}
        return [f"{where} {judge}" for judge, holds in found.items() if holds]


def in_other_units(outcome: Outcome) -> Iterator[Rescaled]:
    """The same fleet in every other unit."""
    document = outcome.trial.document
    given = (document["fleet"] | document["designed"])["excitation"]
    for scaling in SCALINGS:
        if scaling == "psi" and given["family"] == "square-wave":  # whose amplitude is fixed
            continue
        for shift in SHIFTS:
            other = rescaled(document, scaling, shift)
            verdict = kernel.check(json.dumps(other))
            same = (verdict.valid, verdict.rule) == (outcome.verdict.valid, outcome.verdict.rule)
            yield Rescaled(outcome, scaling, shift, same, limits_hold(other) == outcome.limits)


# -- the table --------------------------------------------------------------------------------------------------------


@dataclass
class Tally:
    """What was found."""

    outcomes: list[Outcome] = field(default_factory=list)
    scaled: list[Rescaled] = field(default_factory=list)

    @property
    def failures(self) -> list[str]:
        """One line for everything that must not be."""
        lines = [line for outcome in self.outcomes for line in outcome.failures()]
        return lines + [line for one in self.scaled for line in one.failures()]

    @property
    def falsely_accepted(self) -> int:
        """How many false statements the kernel accepts."""
        return sum(outcome.falsely_accepted for outcome in self.outcomes)


def run(count: int, first: int = 0, scale_every: int = 10, condition: str | None = None) -> Tally:
    """Judge so many fleets, and each tenth in other units too."""
    tally = Tally()
    for seed in range(first, first + count):
        outcome = judged(draw(seed, condition))
        tally.outcomes.append(outcome)
        if scale_every and seed % scale_every == 0:
            tally.scaled += in_other_units(outcome)
    return tally


HEADER = (
    "condition",
    "true",
    "false",
    "of these exactly on the edge",
    "too close for 60 digits",
    "least margin decided, true / false",
    "kernel accepts false",
    "kernel refuses true (largest margin)",
    "limits.py disagrees",
    "limits.py undecided (largest margin)",
)


def table(tally: Tally) -> str:
    """The findings as a markdown table, one row per condition."""
    rows = [HEADER, ("---",) * len(HEADER)]
    rows += [_line(name, [o for o in tally.outcomes if o.trial.condition == name]) for name in CONDITIONS]
    rows.append(_line("all", tally.outcomes))
    return "\n".join("| " + " | ".join(map(str, row)) + " |" for row in rows)


def _line(name: str, outcomes: list[Outcome]) -> tuple[Any, ...]:
    right = [o for o in outcomes if o.truth is o.verdict.valid and not o.trial.on_the_edge]
    least = (min((o.margin for o in right if o.truth is truth), default=math.nan) for truth in (True, False))
    return (
        name,
        sum(o.truth is True for o in outcomes),
        sum(o.truth is False for o in outcomes),
        sum(o.trial.on_the_edge for o in outcomes),
        sum(o.theory.true is None and not o.trial.on_the_edge for o in outcomes),
        " / ".join(f"{margin:.0e}" for margin in least),
        sum(o.falsely_accepted for o in outcomes),
        _with_largest([o for o in outcomes if o.refused]),
        sum(o.limits_disagree for o in outcomes),
        _with_largest([o for o in outcomes if o.undecided_by_limits]),
    )


def _with_largest(outcomes: list[Outcome]) -> str:
    return f"{len(outcomes)} ({max(o.margin for o in outcomes):.0e})" if outcomes else "0"


def report(tally: Tally) -> str:
    """All that is printed of the findings but the time."""
    fleets = len({one.outcome.trial.seed for one in tally.scaled})
    within = sum(not one.limits_same and not one.failures() for one in tally.scaled)
    scaling = (
        f"Other units: {fleets} fleets, {len(tally.scaled)} certificates ({', '.join(SCALINGS)}; times 1e-8 and 1e8): "
        f"{sum(not one.same for one in tally.scaled)} verdicts of the kernel change, {within} of limits.py within its "
        f"band, {sum(bool(one.failures()) for one in tally.scaled)} failures."
    )
    bands = (
        f"What is true may be refused up to a margin of {KERNEL_BAND[PSI_BAR]:.0e} by the kernel and "
        f"{LIMITS_BAND[PSI_BAR]:.0e} by excitation.py for psi_bar, {KERNEL_BAND['(16*)']:.0e} by the kernel and "
        f"{LIMITS_BAND['(16*)']:.0e} by limits.py else."
    )
    failures = tally.failures
    lines = [table(tally), "", bands, scaling]
    return "\n".join([*lines, f"{len(failures)} failures.", *(f"- {line}" for line in failures[:20])])


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("count", nargs="?", type=int, default=10_000, help="how many fleets")
    parser.add_argument("--first", type=int, default=0, help="number of the first fleet")
    parser.add_argument("--show", type=int, help="print the certificate of this fleet and what the judges say of it")
    options = parser.parse_args(arguments)
    if options.show is not None:
        outcome = judged(draw(options.show))
        print(json.dumps(outcome.trial.document, indent=1))
        print(f"theory {outcome.theory}\nkernel {outcome.verdict}\nlimits.py {outcome.limits}")
        return bool(outcome.failures())
    begin = time.perf_counter(), time.process_time()
    tally = run(options.count, options.first)
    print(report(tally))
    spent, worked = time.perf_counter() - begin[0], time.process_time() - begin[1]
    print(f"{options.count} fleets in {spent:.0f} s, {worked:.0f} s of them on the processor.")
    return bool(tally.failures)


if __name__ == "__main__":
    sys.exit(main())
