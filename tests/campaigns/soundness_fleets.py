"""Random fleets at the edge of one condition, as row documents."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from decimal import ROUND_CEILING, ROUND_FLOOR, ROUND_HALF_EVEN, Context, Decimal, localcontext
from fractions import Fraction
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from gaincert.models.errors import InputError
from gaincert.models.fleet_tables import ExcitationTable, Harmonics, SquareWave
from gaincert.models.gains import GAIN_NAMES
from gaincert.verify.certificates.arcs import arcs as find_arcs
from pydantic import TypeAdapter

from tests.campaigns.certificate_rows import excitation_columns
from tests.campaigns.soundness_theory import (
    ACCELERATION,
    CONDITIONS,
    EVERY_SET,
    FINE,
    LIMITS,
    PSI_BAR,
    SETS,
    SPEED,
    TORQUE,
    TURN_ACCELERATION,
    TURN_RATE,
    WHEEL_SPEED,
    Row,
    asked,
    ends_of,
    rim_speeds,
    sides,
    supremum,
)  # fmt: skip

# What may be moved to the edge of a condition; small and large are affine in each of them.
KNOBS = {
    "(15)": ("d_omega", "k_alpha"),
    "(15')": ("d_omega", "p_omega", "k_alpha"),
    "(16)": ("torque", "torque", "d_v", "p_v", "d_omega", "p_omega", "k_alpha"),
    "(16*)": ("torque", "torque", "d_v", "d_omega", "p_omega"),
    SPEED: ("d_v", "p_v"),
    TURN_RATE: ("d_omega", "p_omega", "k_alpha"),
    WHEEL_SPEED: ("wheel_speed",),
    ACCELERATION: ("acceleration", "d_v", "p_v"),
    TURN_ACCELERATION: ("turn_acceleration", "d_omega", "p_omega", "k_alpha"),
}

PLACES = Context(prec=120)  # of the decimals here: enough for every product to be exact


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
    robots = [_robot(random) for _ in degrees]
    rows = [_row(random, degree, bar, drive, robot) for degree, robot in zip(degrees, robots, strict=True)]
    i = int(random.random.integers(len(rows)))
    rows[i] = _with_limit(random, rows[i], condition)
    names = [*SETS[conditions], *(name for name in LIMITS if any(asked(name, row) for row in rows))]
    rows = [_damped(random, row, names) for row in rows]
    stated, rational = Decimal(0), on_the_edge and condition == "(16*)"
    if rational:
        rows[i] = _with_rational_torque(random, rows[i], names)
    if condition not in (*TORQUE, PSI_BAR, WHEEL_SPEED):
        rows[i], stated = _moved(random, rows[i], condition)
    for j, row in enumerate(rows):  # after the gains, so that they leave room for them
        rows[j] = _with_torque(random, _with_room(random, row, names, condition if j == i else None), names)
    if rational:
        rows[i], stated, on_the_edge = _on_the_edge(random, rows[i])
    elif condition in (*TORQUE, WHEEL_SPEED):
        rows[i], stated = _moved(random, rows[i], condition)
    if not all(_clear(row, names, condition if j == i else None) for j, row in enumerate(rows)):
        return None
    margins = {name: ["0" if asked(name, row) else None for row in rows] for name in names}
    if condition != PSI_BAR:
        margins[condition][i] = text(stated)
    vehicles = [_vehicle(random, f"v{j}", *pair) for j, pair in enumerate(zip(rows, robots, strict=True))]
    fleet = {"drive": drive, "excitation": psi, "graph": graph, "vehicle": vehicles}
    document = _document(random, conditions, fleet, rows) | {"forest": forest, "margins": margins}
    wheels = margins.get(WHEEL_SPEED, [None] * len(rows))
    document["rim_speed"] = [_rim_speed(row, margin or "0") for row, margin in zip(rows, wheels, strict=True)]
    return Trial(seed, document, condition, "" if condition == PSI_BAR else f"v{i}", on_the_edge)


def _rim_speed(row: Row, stated: str) -> str | None:
    """What a wheel-speed limit leaves to |v|: the middle of what can be certified."""
    if row.wheel_speed is None:
        return None
    long = row.map(lambda value: FINE.mpf(str(value)))
    rim, arm_speed = rim_speeds(FINE, long)
    spare = long.least_r * long.wheel_speed - FINE.mpf(stated) - rim - arm_speed
    return text(rounded(rim + spare / 2 if spare > 0 else rim, Aim(Decimal(0), 75, ROUND_HALF_EVEN)))


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


def _robot(random: Draw) -> dict[str, Any]:
    """The parameters of a vehicle but its torque limit, some as intervals: decimal texts as in a fleet file."""

    def parameter(low: Decimal, high: Decimal) -> Any:
        return [text(low), text(high)] if random.chance(0.2) else text(low)

    half_track, radius = random.decimal(-2, 0), random.decimal(-2, 0)
    mass, inertia, wheel = random.decimal(-1, 2), random.decimal(-2, 1), random.decimal(-5, -3)
    robot = {
        "mass": parameter(mass, _more(random, mass)),
        "inertia": parameter(inertia, _more(random, inertia)),
        "half_track": parameter(half_track, _more(random, half_track)),
        "wheel_radius": parameter(radius, up(radius * 8 / 7, 8)),
        "wheel_inertia": "0",
    }
    # With an interval of r or R as well, the least effective mass is bounded, not attained.
    if random.chance(0.4) and isinstance(robot["half_track"], str) and isinstance(robot["wheel_radius"], str):
        robot["wheel_inertia"] = parameter(wheel, _more(random, wheel))
    return robot


def _more(random: Draw, value: Decimal) -> Decimal:
    return up(value * Decimal(1 + random.power(-3, 0)), 8)


def _row(random: Draw, degree: Decimal, bar: Decimal, drive: str, robot: dict[str, Any]) -> Row:
    """The worst case of one vehicle, without its damping, torque limit and accelerations."""
    lever, one = 2 if drive == "paper" else 1, Decimal(1)
    ends = {key: list(map(Decimal, ends_of(value))) for key, value in robot.items()}
    (least, *_, most), R, J = ends["wheel_radius"] * 2, ends["half_track"], ends["wheel_inertia"][0]
    limits = {name: random.decimal(-3, 1) if random.chance(0.2) else None for name in (SPEED, TURN_RATE)}
    limits |= {name: one if random.chance(0.15) else None for name in (WHEEL_SPEED, ACCELERATION, TURN_ACCELERATION)}
    pull, heading, swing = (random.power(-2, 2) / float(degree) for _ in range(3))
    scales = [random.decimal(-1, 1) if random.chance(0.7) else one for _ in range(2)]
    return Row(
        degree=degree,
        bar=bar,
        r=most,
        arm=lever * R[0],
        torque=one,
        mass=(ends["mass"][0] * least + 2 * J / most) / most,
        inertia=(ends["inertia"][0] * least * most + 2 * J * lever**2 * R[0] * R[-1]) * R[0] / (R[-1] * most**2),
        least_r=least,
        longest_arm=lever * R[-1],
        speed_scale=scales[0],
        turn_rate_scale=scales[1],
        p_v=up(pull, 6),
        d_v=one,
        p_omega=up(heading, 6),
        d_omega=one,
        k_alpha=up(swing / float(bar), 6),
        **limits,
    )


def _with_limit(random: Draw, row: Row, condition: str) -> Row:
    """The limit that is moved to the edge; no limit of the wheels beside it, which weak damping would break."""
    if condition != WHEEL_SPEED:
        row = row._replace(wheel_speed=None)
    return row._replace(**{condition: random.decimal(-3, 1)}) if condition in LIMITS else row


def _loose(random: Draw, row: Row, names: Iterable[str], knob: str) -> Decimal:
    """A value of a number on which `large` alone depends, linearly, so that the conditions hold with room."""
    one = row.map(float)._replace(**{knob: 1.0})
    needs = [small / large for small, large in (sides(math, name, one) for name in names if asked(name, row))]
    return up(max([random.power(-2, 2) if knob != "torque" else 0.0, *needs]) * random.power(0.03, 1), 6)


def _damped(random: Draw, row: Row, names: list[str]) -> Row:
    turning = [name for name in names if name in ("(15)", "(15')", TURN_RATE)]
    d_v, d_omega = _loose(random, row, [SPEED], "d_v"), _loose(random, row, turning, "d_omega")
    if row.wheel_speed is not None:  # there is no bound of the speeds unless damping is stronger than the pull
        limited = row._replace(speed=1, turn_rate=1).map(float)
        pull, turn = (sides(math, name, limited)[0] for name in (SPEED, TURN_RATE))
        d_v, d_omega = max(d_v, up(pull * 1.5, 6)), max(d_omega, up(turn * 1.5, 6))
    return row._replace(d_v=d_v, d_omega=d_omega)


def _with_room(random: Draw, row: Row, names: list[str], moved: str | None) -> Row:
    """Limits of accelerations and wheel speeds that leave room, but for the one that is moved to the edge."""
    for name in (ACCELERATION, TURN_ACCELERATION, WHEEL_SPEED):
        if name in names and asked(name, row) and name != moved:
            row = row._replace(**{name: _loose(random, row, [name], name)})
    return row


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


def _document(random: Draw, conditions: str, fleet: dict[str, Any], rows: list[Row]) -> dict[str, Any]:
    """The row document without forest, margins and rim speeds; in some, psi and weights are designed beside a decoy."""
    psi, graph, bar = fleet["excitation"], fleet["graph"], text(rows[0].bar)
    designed = {}
    if random.chance(0.2):
        designed["excitation"], fleet["excitation"] = psi, _DECOY_PSI
    if random.chance(0.2):
        edges = [[a, b, "0.001"] for a, b, _ in graph["edges"]]
        decoy = {"edges": edges, "leader_links": dict.fromkeys(graph["leader_links"], "0.001")}
        designed["graph"], fleet["graph"] = graph, decoy
    network = {name: [text(random.decimal(-1, 1))] for name in ("position_scale", "heading_scale")}
    own = (*GAIN_NAMES, "speed_scale", "turn_rate_scale")
    return {
        "conditions": conditions,
        "fleet": fleet,
        "designed": designed,
        "gains": {**network, **{name: [text(getattr(row, name)) for row in rows] for name in own}},
        "psi_bar": bar,
        "arcs": _arcs(json.dumps(psi), bar),
        "rates": {"gamma_omega": None, "gamma_v": None},
    }


@lru_cache(maxsize=64)
def _arcs(psi: str, bar: str) -> dict[str, str]:
    """Arcs for the kernel: those that the producer finds, or some that cannot do."""
    for factor in ("1", "1.000001"):
        with suppress(InputError):  # psi_bar at the supremum or below it: arcs for a bound a little above
            return find_arcs(excitation_columns(json.loads(psi)), text(Decimal(bar) * Decimal(factor)))
    return dict.fromkeys(("here", "opposite"), " ".join(["8"] * 2**9))


def _vehicle(random: Draw, name: str, row: Row, robot: dict[str, Any]) -> dict[str, Any]:
    """A vehicle whose worst case is the row."""

    def parameter(low: Decimal, high: Decimal) -> Any:
        return [text(low), text(high)] if random.chance(0.2) else text(low)

    other = _more(random, row.torque) if random.chance(0.5) else row.torque
    torque = [parameter(side, _more(random, side)) for side in (row.torque, other)]
    left, right = torque if random.chance(0.5) else torque[::-1]
    limits = {key: None if getattr(row, key) is None else text(getattr(row, key)) for key in LIMITS}
    torques = {"left": left, "right": right}
    return {"name": name, **robot, "torque_limit": torques, "offset": ["0", "0"], "limits": limits}
