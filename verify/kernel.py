"""The trusted checker of gain certificates: `python kernel.py CERTIFICATE.json` says VALID or names what is false.

This file is all that has to be believed. It imports the standard library alone, computes with integers and fractions
alone (no floating point: a decimal of the file is read as the fraction it is) and calls no solver. One function checks
one rule. A certificate holds the fleet, the gains and hints (witnesses, margins); no hint is believed:

  well_formed   names differ, links join two known vehicles once, everything that must be positive is: (A2)
  same_fleet    the SHA-256 of the embedded fleet is the stated one, and the one asked for
  connected     (A1): the forest is a list of [vehicle, parent]; a parent is the leader (-1) or stands earlier in the
                list, and each pair is a link of positive weight; all vehicles are in it. So L_l > 0 (Lemma 1)
  excited       (12): by orthogonality the integral of psi'^2 over one period 2 pi / w is
                w pi sum n^2 (s_n^2 + c_n^2), and w / pi times that sum where the coefficients carry 1 / pi
  psi_bounded   |psi| <= psi_bar, see below; and |psi| >= at_least at the stated point, which shows how tight that is
  conditions    (15), (15'), (16), (16*), speed and turn-rate limits: each reads root + rest + margin <= large with a
                square root of a rational number, which is compared by squaring: root <= b iff b >= 0 and root^2 <= b^2
  rates         every eigenvalue of M s^2 + C s + K (headings or along-track errors near the goal; M, C diagonal and
                K = L_l) has real part <= -gamma, see below

|psi| <= psi_bar: write psi = mean + trig(x), x = w t. On an arc of length h a function with |f''| <= B lies above the
smaller of its values at the ends minus B h^2 / 8 (it differs from the chord by no more). The points x = 2 atan(t) have
rational sine and cosine for rational t, so f = psi_bar -/+ psi is evaluated there exactly; an arc [t, t + e] of them is
not longer than 2 e. t in [-1, 1] covers half the circle, x + pi the other half. Arcs are halved until each is settled.
Where the coefficients carry 1 / pi, all is multiplied by pi and psi_bar -/+ mean >= 0 by a lower bound of pi.

Rates: let A = K - gamma C + gamma^2 M, x > 0 and A x >= 0 row by row. As K has no positive entry off its diagonal, the
matrix S_ij = x_i A_ij x_j has row sums >= 0 and off-diagonal entries <= 0, and
    y^T S y = sum_i (row sum i) y_i^2 + sum_(i<j) (-S_ij) (y_i - y_j)^2 >= 0;   so A >= 0.
If also C - 2 gamma M >= 0, shift s = sigma - gamma: an eigenvector u of the shifted pencil gives m sigma^2 + c sigma
+ k = 0 with m = u*Mu > 0, c = u*(C - 2 gamma M)u >= 0 and k = u*Au >= 0, whose roots have real part <= 0.

Constants: pi from Machin's 16 atan(1/5) - 4 atan(1/239), whose alternating partial sums enclose it; tanh(q) >=
(S - 1) / (S + 1) for every partial sum S of the series of exp(2 q), because all its terms are positive.

Parameters given as an interval [low, high] count with their worst value. What then follows is a theorem (corrected
Proposition 1) whose proof `gaincert prove` checks; this program checks that its hypotheses hold.
"""

from __future__ import annotations

import gc
import hashlib
import json
import re
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from decimal import Context, Decimal
from fractions import Fraction
from functools import cache, lru_cache
from math import isqrt, lcm
from pathlib import Path
from typing import Any, NamedTuple, NoReturn

SCHEMA = "gaincert-certificate-1"
MAX_BYTES = 2**30  # of a certificate
MAX_VALUES = 64 * 10**6  # values in it: bounds the memory
MAX_LENGTH = 130  # characters of a number
MAX_HARMONIC = 200
MAX_WORK = 5 * 10**6  # evaluations of psi, times its highest harmonic
WIDE = 40_000  # times this many, squared bits of its point: what an evaluation costs beyond its count

KEYS: tuple[str, ...] = ("schema", "conditions", "fleet", "designed", "gains", "psi_bar")  # read at once
KEYS += ("digest", "psi_point", "psi_power", "forest", "margins", "rates", "provenance")  # read by their rules
LEADER = -1
GAINS = ("p_v", "d_v", "p_omega", "d_omega", "k_alpha")
SETS = {"paper": ("(15)", "(16)"), "corrected": ("(16*)",), "rate-bounded": ("(15')", "(16*)")}


class UnreadableError(Exception):
    """The file is not a certificate, or too large to be checked: nothing is said about its claims."""


class FalseError(Exception):
    """A rule fails; the message gives the place and both sides."""


@dataclass(frozen=True)
class Verdict:
    """What the kernel found."""

    valid: bool
    rule: str | None  # the first rule that fails
    reason: str  # one line: why, with both sides
    theorem: tuple[str, ...] = ()  # what follows, where valid

    def __str__(self) -> str:
        return "\n".join(["VALID", *self.theorem]) if self.valid else f"INVALID: {self.rule}: {self.reason}"


# -- reading: strict, bounded, exact ----------------------------------------------------------------------------------


class Vehicle(NamedTuple):
    """One row of the conditions: worst cases of the parameters, degree and gains."""

    name: str
    mass: tuple[Fraction, Fraction]  # low, high: kg, times the mismatch of r
    inertia: tuple[Fraction, Fraction]  # kg m^2, times the mismatch of r and R
    r: Fraction  # m, largest
    arm: Fraction  # m, smallest: 2R in (2) as printed, R on a physical drive
    torque: Fraction  # N m, smallest
    speed: Fraction | None  # m/s, limit asked for
    turn_rate: Fraction | None  # rad/s
    degree: Fraction  # D = a_il + l_ii
    p_v: Fraction
    d_v: Fraction
    p_omega: Fraction
    d_omega: Fraction
    k_alpha: Fraction


class Psi(NamedTuple):
    """mean + pi^-over_pi sum s_n sin(n w t) + c_n cos(n w t)."""

    mean: Fraction
    frequency: Fraction
    over_pi: bool
    terms: list[tuple[int, Fraction, Fraction]]  # n, s_n, c_n


class Claims(NamedTuple):
    """A certificate, read."""

    raw: dict[str, Any]
    vehicles: list[Vehicle]
    edges: list[tuple[int, int, Fraction]]
    led: dict[int, Fraction]  # leader links
    psi: Psi
    psi_bar: Fraction


def unreadable(message: str) -> NoReturn:
    """Refuse the file."""
    raise UnreadableError(message)


def load(data: bytes) -> Any:
    """JSON without duplicate keys, fractional numbers, NaN or deep nesting."""
    if len(data) > MAX_BYTES or sum(map(data.count, (b",", b"[", b"{"))) > MAX_VALUES:
        unreadable(f"the file is larger than {MAX_BYTES} bytes or {MAX_VALUES} values")
    try:
        return json.loads(
            data.decode("utf-8"),
            object_pairs_hook=_without_duplicates,
            parse_float=lambda text: unreadable(f"{text[:40]} must be written as a decimal string"),
            parse_constant=lambda text: unreadable(f"{text} is not a number"),
            parse_int=lambda text: int(text) if len(text) <= MAX_LENGTH else unreadable("an integer is too long"),
        )
    except ValueError as error:  # not UTF-8, not JSON
        unreadable(f"the file is not JSON: {error}")


def _without_duplicates(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    table = dict(pairs)
    return table if len(table) == len(pairs) else unreadable("a key stands twice in one table")


def table(value: Any, *keys: str) -> list[Any]:
    """The values of a table with exactly these keys."""
    if not isinstance(value, dict) or value.keys() != set(keys):
        found = sorted(value) if isinstance(value, dict) else value
        unreadable(f"expected a table with the keys {', '.join(keys)}, not {ascii(found)[:200]}")
    return [value[key] for key in keys]


def sequence(value: Any, length: int | None = None) -> list[Any]:
    """A list, of a given length."""
    if not isinstance(value, list) or length not in (None, len(value)):
        unreadable(f"expected a list{f' of {length}' if length is not None else ''}, not {ascii(value)[:80]}")
    return value


def number(value: Any) -> Fraction:
    """An integer or a decimal string, exactly."""
    return _decimal(str(value)) if isinstance(value, (str, int)) and not isinstance(value, bool) else _no_number(value)


@lru_cache(maxsize=2**16)
def _decimal(text: str) -> Fraction:
    if len(text) > MAX_LENGTH or not _DECIMAL.fullmatch(text):
        _no_number(text)
    whole, _, places = text.partition(".")
    return Fraction(int(whole + places), 10 ** len(places))


_DECIMAL = re.compile(r"-?(0|[1-9][0-9]*)(\.[0-9]+)?", re.ASCII)


def _no_number(value: Any) -> NoReturn:
    unreadable(f"{ascii(value)[:60]} is not a decimal number of at most {MAX_LENGTH} characters")


def interval(value: Any) -> tuple[Fraction, Fraction]:
    """A positive number or a pair [low, high] of them: (low, high)."""
    if not isinstance(value, list):
        exact = positive(number(value), "a parameter")
        return exact, exact
    low, high = map(number, sequence(value, 2))
    if not 0 < low <= high:
        raise FalseError(f"(A2): a parameter must satisfy 0 < low <= high, not {shown(low)}, {shown(high)}")
    return low, high


def widened(parameter: tuple[Fraction, Fraction], *others: tuple[Fraction, Fraction]) -> tuple[Fraction, Fraction]:
    """The interval of parameter times b / a for every a, b of the same other interval."""
    low, high = parameter
    for least, most in others:
        if least is not most:
            low, high = low * least / most, high * most / least
    return low, high


def read_claims(raw: Any) -> Claims:
    """The certificate with its numbers as fractions and its names as indices; well_formed in what it returns."""
    schema, conditions, fleet, designed, gains, psi_bar, *_ = table(raw, *KEYS)
    if schema != SCHEMA or not isinstance(conditions, str) or conditions not in SETS:
        unreadable(f"schema must be {SCHEMA} and conditions one of {', '.join(SETS)}")
    drive, excitation, graph, rows = table(fleet, "drive", "excitation", "graph", "vehicle")
    known = isinstance(designed, dict) and not designed.keys() - {"excitation", "graph"}
    if drive not in ("paper", "physical") or not known:
        unreadable("drive must be paper or physical; designed may hold excitation and graph")
    names = [row.get("name") if isinstance(row, dict) else None for row in sequence(rows)]
    if not names or not all(isinstance(name, str) for name in names):
        unreadable("fleet: every vehicle needs a name, and there must be a vehicle")
    edges, led = read_graph(designed.get("graph", graph), names)
    degrees = [led.get(i, Fraction(0)) for i in range(len(names))]
    for i, j, weight in edges:
        degrees[i] += weight
        degrees[j] += weight
    columns = [[positive(number(gain), name) for gain in sequence(column, len(names))] for name, column in
               zip(GAINS, table(gains, *GAINS), strict=True)]  # fmt: skip
    lever = 2 if drive == "paper" else 1
    vehicles = [read_vehicle(row, lever, *own) for row, *own in zip(rows, degrees, *columns, strict=True)]
    return Claims(raw, vehicles, edges, led, read_psi(designed.get("excitation", excitation)), number(psi_bar))


def read_vehicle(row: Any, lever: int, degree: Fraction, *gains: Fraction) -> Vehicle:
    """One vehicle with the worst case of its parameters.

    The controller and the vehicle may each have any r and R of the intervals. Torques from (6) with r, R act through
    (2) with r', R' as if the mass were m r' / r and the inertia I (r' / r) (R / R').
    """
    name, mass, inertia, half_track, radius, torque, offset, limits = table(
        row, "name", "mass", "inertia", "half_track", "wheel_radius", "torque_limit", "offset", "limits"
    )
    mass, inertia, half_track, radius = map(interval, (mass, inertia, half_track, radius))
    left, right = map(interval, table(torque, "left", "right"))
    speed, turn_rate = (
        None if limit is None else positive(number(limit), "limit") for limit in table(limits, "speed", "turn_rate")
    )
    for coordinate in sequence(offset, 2):
        number(coordinate)
    return Vehicle(
        name, widened(mass, radius), widened(inertia, radius, half_track),
        radius[1], lever * half_track[0], min(left[0], right[0]),
        speed, turn_rate, degree, *gains,
    )  # fmt: skip


def read_graph(graph: Any, names: list[Any]) -> tuple[list[tuple[int, int, Fraction]], dict[int, Fraction]]:
    """Edges (i, j, a_ij) and leader links {i: a_il}: names differ, each pair stands once, weights are positive."""
    index = {name: i for i, name in enumerate(names)}
    if len(index) != len(names):
        raise FalseError("graph: two vehicles have one name")
    listed, leader_links = table(graph, "edges", "leader_links")
    edges, seen = [], set()
    for entry in sequence(listed):
        a, b, weight = sequence(entry, 3)
        if not isinstance(a, str) or not isinstance(b, str):
            unreadable("graph: an edge is [name, name, weight]")
        i, j = index.get(a, LEADER), index.get(b, LEADER)
        pair = (i, j) if i < j else (j, i)
        if LEADER in pair or i == j or pair in seen:
            raise FalseError(f"graph: edge {a!a} - {b!a} must join two known vehicles, and once")
        seen.add(pair)
        edges.append((i, j, positive(number(weight), "edge weight")))
    if not isinstance(leader_links, dict) or leader_links.keys() - index.keys():
        raise FalseError("graph: leader_links must be a table of known vehicles")
    led = {index[name]: number(weight) for name, weight in leader_links.items()}
    if any(weight < 0 for weight in led.values()):
        raise FalseError("graph: a leader link has a negative weight")
    return edges, led


def read_psi(excitation: Any) -> Psi:
    """The Fourier sum of an excitation table."""
    if isinstance(excitation, dict) and excitation.get("family") == "square-wave":
        _, mean, terms, frequency = table(excitation, "family", "mean", "terms", "frequency")
        if not isinstance(terms, int) or isinstance(terms, bool) or not 1 <= terms <= MAX_HARMONIC // 2:
            unreadable(f"excitation: terms must be 1 to {MAX_HARMONIC // 2}")
        wave = [(n, Fraction(4, n), Fraction(0)) for n in range(1, 2 * terms, 2)]
        return Psi(number(mean), positive(number(frequency), "frequency"), True, wave)
    family, mean, frequency, *lists = table(excitation, "family", "mean", "frequency", "sin", "cos")
    sin, cos = ([number(entry) for entry in sequence(entries)] for entries in lists)
    highest = max(len(sin), len(cos))
    if family != "harmonics" or highest > MAX_HARMONIC:
        unreadable(f"excitation: family must be square-wave or harmonics, of at most {MAX_HARMONIC} harmonics")
    padded = (entries + [Fraction(0)] * (highest - len(entries)) for entries in (sin, cos))
    waves = [(n, s, c) for n, (s, c) in enumerate(zip(*padded, strict=True), 1) if s or c]
    return Psi(number(mean), positive(number(frequency), "frequency"), False, waves)


def positive(value: Fraction, name: str) -> Fraction:
    """(A2)."""
    if value.numerator <= 0:
        raise FalseError(f"(A2): {name} must be > 0, not {shown(value)}")
    return value


# -- constants, enclosed ----------------------------------------------------------------------------------------------


def _arctan_of_inverse(n: int) -> tuple[Fraction, Fraction]:
    """Below and above atan(1/n): partial sums of 1/n - 1/(3 n^3) + ..., which alternate around it."""
    below = sum((Fraction((-1) ** k, (2 * k + 1) * n ** (2 * k + 1)) for k in range(50)), Fraction(0))
    return below, below + Fraction(1, 101 * n**101)


@cache
def pi_bounds() -> tuple[Fraction, Fraction]:
    """Decimals below and above pi, 1e-60 apart, by Machin's formula."""
    (low_5, high_5), (low_239, high_239) = _arctan_of_inverse(5), _arctan_of_inverse(239)
    low, high = 16 * low_5 - 4 * high_239, 16 * high_5 - 4 * low_239
    unit = 10**60
    below, above = low.numerator * unit // low.denominator, high.numerator * unit // high.denominator + 1
    return Fraction(below, unit), Fraction(above, unit)


@lru_cache(maxsize=2**16)
def tanh_below(q: Fraction) -> Fraction:
    """A fraction at or below tanh(q), q > 0: (S - 1) / (S + 1) for a partial sum S of exp(2 q), rounded down."""
    y = 2 * min(q, Fraction(100))
    one = term = total = 10**100
    n = 0
    while term:
        n += 1
        term = term * y.numerator // (n * y.denominator)
        total += term
    return Fraction(total - one, total + one)


def shown(q: Fraction) -> str:
    """A number in twelve digits, for people to read; no verdict rests on it."""
    context = Context(prec=12)
    return format(context.divide(Decimal(q.numerator), Decimal(q.denominator)), "g")


# -- the rules --------------------------------------------------------------------------------------------------------


def same_fleet(claims: Claims, asked: str | None) -> None:
    """The digest is that of the embedded fleet and, where one is asked for, the same as that of the fleet file."""
    text = json.dumps(claims.raw["fleet"], sort_keys=True, separators=(",", ":"), ensure_ascii=True)
    found = "sha256:" + hashlib.sha256(text.encode()).hexdigest()
    if claims.raw["digest"] != found:
        raise FalseError(f"stated {ascii(claims.raw['digest'])[:80]}, but the embedded fleet has {found}")
    if asked not in (None, found):
        raise FalseError(f"the certificate is of the fleet {found}, not of the fleet {asked!a}")


def connected(claims: Claims) -> None:
    """(A1): the forest joins every vehicle to the leader over links of positive weight."""
    linked = {(i, j) for i, j, _ in claims.edges}
    reached: set[int] = set()
    for entry in sequence(claims.raw["forest"]):
        vehicle, parent = sequence(entry, 2)
        if type(vehicle) is not int or type(parent) is not int:
            unreadable("forest: an entry is [vehicle, parent], indices from 0, and -1 for the leader")
        if parent == LEADER:
            joined = claims.led.get(vehicle, 0) > 0
        else:
            joined = parent in reached and ((vehicle, parent) in linked or (parent, vehicle) in linked)
        if not joined:
            raise FalseError(f"[{vehicle}, {parent}] is not a link from a vehicle to the leader or one reached before")
        reached.add(vehicle)
    if len(reached) != len(claims.vehicles):
        raise FalseError(f"the forest reaches {len(reached)} of {len(claims.vehicles)} vehicles")


def excited(claims: Claims) -> None:
    """(12): the integral of psi'^2 over one period is at least psi_power > 0."""
    psi, (pi_low, pi_high) = claims.psi, pi_bounds()
    squares = psi.frequency * sum((n * n * (s * s + c * c) for n, s, c in psi.terms), Fraction(0))
    integral = squares / pi_high if psi.over_pi else squares * pi_low
    stated = positive(number(claims.raw["psi_power"]), "psi_power")
    if stated > integral:
        raise FalseError(f"the integral of psi'^2 over a period is {shown(integral)} < {shown(stated)} as stated")


def harmonic_sum(terms: dict[int, tuple[int, int]], p: int, q: int) -> tuple[int, int]:
    """sum s_n sin(n x) + c_n cos(n x) at x = 2 atan(p / q), terms {n: (s_n, c_n)}, as a numerator and a denominator.

    With e^ix = u / r, u = (q + ip)^2, r = q^2 + p^2, it is Re sum (c_n - i s_n) u^n / r^n: Horner's rule times r^n.
    """
    re_u, im_u, r = q * q - p * p, 2 * p * q, q * q + p * p
    re, im, scale = 0, 0, 1
    for n in range(max(terms), 0, -1):
        s, c = terms.get(n, (0, 0))
        re, im = re + c * scale, im - s * scale
        re, im, scale = re * re_u - im * im_u, re * im_u + im * re_u, scale * r
    return re, scale


def psi_bounded(claims: Claims) -> None:
    """|psi| <= psi_bar everywhere, and |psi| >= at_least at the stated point."""
    psi, bar = claims.psi, claims.psi_bar
    if bar < abs(psi.mean):
        raise FalseError(f"psi has the mean {shown(psi.mean)}, beyond psi_bar = {shown(bar)}")
    for half_turn in (0, 1):
        _bounded_on_half(psi, bar, half_turn)
    half_tangent, half_turn, at_least = table(claims.raw["psi_point"], "half_tangent", "half_turn", "at_least")
    if half_turn not in (0, 1) or isinstance(half_turn, bool):
        unreadable("psi_point: half_turn must be 0 or 1")
    t, least = number(half_tangent), number(at_least)
    common, turned = _integer_terms(psi, half_turn)
    re, scale = harmonic_sum(turned, t.numerator, t.denominator)
    trig, pis = Fraction(re, common * scale), pi_bounds() if psi.over_pi else (Fraction(1),)
    above = all(pi * (psi.mean - least) + trig >= 0 for pi in pis)
    below = all(pi * (psi.mean + least) + trig <= 0 for pi in pis)
    if least < 0 or not (above or below):
        value = abs(psi.mean + trig / pis[0])
        raise FalseError(f"at the stated point |psi| is {shown(value)} < {shown(least)} as stated")


def _integer_terms(psi: Psi, half_turn: int) -> tuple[int, dict[int, tuple[int, int]]]:
    """A common denominator and the numerators of the terms; x + pi for x turns the sign of the odd ones."""
    common = lcm(*(q.denominator for _, s, c in psi.terms for q in (s, c)))
    sign = -1 if half_turn else 1
    return common, {n: (int(s * common) * sign**n, int(c * common) * sign**n) for n, s, c in psi.terms}


def _bounded_on_half(psi: Psi, bar: Fraction, half_turn: int) -> None:
    """|psi| <= bar for x = 2 atan(t) + pi half_turn, t in [-1, 1], by halving arcs.

    The slack min(bar - psi, bar + psi), divided by a bound of |psi''|, must be >= h^2 / 8 at both ends of an arc, where
    h <= 2 e. Slacks are rounded down to multiples of 2^-200, e is a power of 2.
    """
    pi = pi_bounds()[0] if psi.over_pi else Fraction(1)
    common, terms = _integer_terms(psi, half_turn)
    curvature = sum(n * n * (abs(s) + abs(c)) for n, (s, c) in terms.items())  # of the integer terms
    unit = bar.denominator * psi.mean.denominator * pi.denominator  # what follows are then integers
    above, below = (int(pi * (bar + sign * psi.mean) * common * unit) for sign in (-1, 1))

    def slack(p: int, q: int) -> int:
        re, scale = harmonic_sum(terms, p, q)
        least = min(above * scale - re * unit, below * scale + re * unit)
        if least < 0:
            over = bar - Fraction(least, unit * common * scale) / pi
            raise FalseError(f"|psi| is {shown(over)} > {shown(bar)} = psi_bar where tan(w t / 2) is {p}/{q}"
                             + (" (plus half a period)" if half_turn else ""))  # fmt: skip
        return (least << 200) // (curvature * unit * scale)

    work = MAX_WORK // max(terms)
    arcs = [(-1, 0, slack(-1, 1), slack(0, 1)), (0, 0, slack(0, 1), slack(1, 1))]  # from p / 2^k to (p + 1) / 2^k
    while arcs:
        p, k, left, right = arcs.pop()
        if min(left, right) >= 1 << (199 - 2 * k):  # e^2 / 2 = 2^(-2k - 1)
            continue
        work -= 1 + max(terms) * k * k // WIDE  # a point of k bits makes integers of max(terms) k bits
        if work < 0 or k > 90:
            raise FalseError(f"psi_bar = {shown(bar)} is too close to the supremum to be decided; state a larger one")
        middle = slack(2 * p + 1, 2 ** (k + 1))
        arcs += [(2 * p, k + 1, left, middle), (2 * p + 1, k + 1, middle, right)]


# -- the conditions on the gains: each says root + rest + margin <= large, root^2 = square ---------------------------


class Sides(NamedTuple):
    """sqrt(square) + rest <= large, or < where strict."""

    square: Fraction
    rest: Fraction
    large: Fraction
    strict: bool = False


def damping(v: Vehicle, psi_bar: Fraction) -> Sides:
    """(15): sqrt2 k psi_bar D <= d_omega tanh(1)."""
    return Sides(2 * (v.k_alpha * psi_bar * v.degree) ** 2, Fraction(0), v.d_omega * tanh_below(Fraction(1)))


def strict_damping(v: Vehicle, psi_bar: Fraction) -> Sides:
    """(15'): p_omega D + sqrt2 k psi_bar D < d_omega."""
    return Sides(2 * (v.k_alpha * psi_bar * v.degree) ** 2, v.p_omega * v.degree, v.d_omega, strict=True)


def torque_sum(v: Vehicle, psi_bar: Fraction) -> Sides:
    """(16): arm (d_v + sqrt2 p_v D) + d_omega + p_omega D + sqrt2 k psi_bar D < (2 arm / r) torque."""
    square = 2 * ((v.arm * v.p_v + v.k_alpha * psi_bar) * v.degree) ** 2
    return Sides(square, v.arm * v.d_v + v.d_omega + v.p_omega * v.degree, 2 * v.arm * v.torque / v.r, strict=True)


def torque(v: Vehicle, psi_bar: Fraction) -> Sides:
    """(16*): (r/2) [d_v + sqrt2 D sqrt(p_v^2 + (k psi_bar / arm)^2) + (d_omega + p_omega D) / arm] <= torque."""
    half = v.r / 2
    square = 2 * (half * v.degree) ** 2 * (v.p_v**2 + (v.k_alpha * psi_bar / v.arm) ** 2)
    return Sides(square, half * (v.d_v + (v.d_omega + v.p_omega * v.degree) / v.arm), v.torque)


def speed(v: Vehicle, psi_bar: Fraction) -> Sides | None:  # noqa: ARG001
    """Speed limit: sqrt2 p_v D <= d_v tanh(limit), where one is asked for."""
    if v.speed is None:
        return None
    return Sides(2 * (v.p_v * v.degree) ** 2, Fraction(0), v.d_v * tanh_below(v.speed))


def turn_rate(v: Vehicle, psi_bar: Fraction) -> Sides | None:
    """Turn-rate limit: p_omega D + sqrt2 k psi_bar D <= d_omega tanh(limit), where one is asked for."""
    if v.turn_rate is None:
        return None
    square = 2 * (v.k_alpha * psi_bar * v.degree) ** 2
    return Sides(square, v.p_omega * v.degree, v.d_omega * tanh_below(v.turn_rate))


CONDITIONS: dict[str, Callable[[Vehicle, Fraction], Sides | None]] = {
    "(15)": damping,
    "(15')": strict_damping,
    "(16)": torque_sum,
    "(16*)": torque,
    "speed limit": speed,
    "turn rate limit": turn_rate,
}


def required(claims: Claims) -> list[str]:
    """The conditions of the set, and the limits that some vehicle asks for."""
    asked = {
        "speed limit": any(v.speed for v in claims.vehicles),
        "turn rate limit": any(v.turn_rate for v in claims.vehicles),
    }
    return [*SETS[claims.raw["conditions"]], *(name for name, some in asked.items() if some)]


def conditions(claims: Claims) -> None:
    """Every required condition holds for every vehicle, with the stated margin >= 0 to spare."""
    names = required(claims)
    for name, margins in zip(names, table(claims.raw["margins"], *names), strict=True):
        for vehicle, margin in zip(claims.vehicles, sequence(margins, len(claims.vehicles)), strict=True):
            sides = CONDITIONS[name](vehicle, claims.psi_bar)
            if (sides is None) != (margin is None):
                raise FalseError(f"{name}: vehicle {vehicle.name!a}: the margin must be null iff no limit is asked for")
            if sides is not None:
                holds_with_margin(f"{name}: vehicle {vehicle.name!a}", sides, number(margin))


def holds_with_margin(where: str, sides: Sides, margin: Fraction) -> None:
    """sqrt(square) + rest + margin <= large, margin >= 0 (and < without margin, where strict), decided by squares."""
    square, rest, large, strict = sides
    room = large - rest
    if room.numerator < 0 or square > room * room or (strict and square == room * room):
        relation, off = ("<" if strict else "<="), _root(square) - room
        raise FalseError(f"{where}: {shown(_root(square) + rest)} {relation} {shown(large)} fails by {shown(off)}")
    left = room - margin
    if margin.numerator < 0 or left.numerator < 0 or square > left * left:
        raise FalseError(f"{where}: the stated margin {shown(margin)} is not in 0 .. {shown(room - _root(square))}")


def _root(square: Fraction) -> Fraction:
    """A root to show, of 30 digits or more."""
    digits = max(30, 30 + len(str(square.denominator)) - len(str(square.numerator)))
    return Fraction(isqrt(square.numerator * 10 ** (2 * digits) // square.denominator), 10**digits)


# -- rates ------------------------------------------------------------------------------------------------------------


def rates(claims: Claims) -> None:
    """The stated rates, where there are any."""
    table(claims.raw["rates"], "gamma_omega", "gamma_v")
    for name, stated in claims.raw["rates"].items():
        if stated is not None:
            rate(claims, name, *table(stated, "rate", "vector"))


def rate(claims: Claims, name: str, stated: Any, vector: Any) -> None:
    """gamma_omega or gamma_v, by C - 2 gamma M >= 0 and (K - gamma C + gamma^2 M) x >= 0, times p row by row."""
    gamma = positive(number(stated), name)
    x = sequence(vector, len(claims.vehicles))
    if not all(type(entry) is int and entry > 0 for entry in x):
        raise FalseError(f"{name}: the vector must have positive integers as entries")
    unit = lcm(*(v.degree.denominator for v in claims.vehicles), *(weight.denominator for _, _, weight in claims.edges))
    neighbours = [0] * len(x)  # sum_j a_ij x_j, times unit
    for i, j, weight in claims.edges:
        scaled = weight.numerator * (unit // weight.denominator)
        neighbours[i] += scaled * x[j]
        neighbours[j] += scaled * x[i]
    twice, scaled_gamma = 2 * gamma, gamma * unit
    for v, own, others in zip(claims.vehicles, x, neighbours, strict=True):
        p, d, mass = (v.p_omega, v.d_omega, v.inertia) if name == "gamma_omega" else (v.p_v, v.d_v, v.mass)
        most = twice * mass[1]
        if d < most:
            raise FalseError(f"{name}: vehicle {v.name!a}: C >= 2 gamma M fails: {shown(d / p)} < {shown(most / p)}")
        pulled = v.degree.numerator * (unit // v.degree.denominator) * own - others  # of L_l x, times unit
        row = p * pulled + (gamma * mass[0] - d) * (scaled_gamma * own)
        if row.numerator < 0:
            off = shown(row / p / unit)
            raise FalseError(f"{name}: vehicle {v.name!a}: (K - gamma C + gamma^2 M) x is {off} < 0")


# -- the verdict ------------------------------------------------------------------------------------------------------


def theorem(claims: Claims) -> tuple[str, ...]:
    """What follows when every rule holds."""
    raw, vehicles = claims.raw, claims.vehicles
    lines = [
        f"{len(vehicles)} vehicles, fleet {raw['digest']}, conditions {raw['conditions']}"
        + "".join(f", designed {part}" for part in sorted(raw["designed"])),
        "From every initial state, the closed loop (13)-(14) has a unique solution for all time; the solutions are "
        "uniformly globally bounded, and the formation (z_i - delta_i = z_l, theta_i = theta_l, v_i = omega_i = 0) is "
        "uniformly globally asymptotically stable.",
        "From every initial state and at all times, no wheel torque exceeds its limit (Constraint 1).",
        f"|psi| <= {raw['psi_bar']} (psi_bar).",
    ]
    if raw["conditions"] == "rate-bounded":
        lines.append("|omega_i(t)| <= max(|omega_i(t0)|, atanh((p_omega D + sqrt2 k psi_bar D) / d_omega)), t >= t0.")
    for condition, quantity in (("speed limit", "v"), ("turn rate limit", "omega")):
        if condition in raw["margins"]:
            lines.append(f"|{quantity}_i(t)| <= max(|{quantity}_i(t0)|, its limit), t >= t0, for each limit asked for.")
    for name, motion in (
        (
            "gamma_omega",
            "the headings where alpha is 0, I omega' + d_omega omega + p_omega L_l theta~ = 0",
        ),
        ("gamma_v", "the along-track errors, m v' + d_v v + p_v L_l x~ = 0"),
    ):
        if raw["rates"][name] is not None:
            stated = raw["rates"][name]["rate"]
            lines.append(f"Linearised at the formation, {motion}, have no exponent above -{stated} 1/s ({name}).")
    return tuple(lines)


@contextmanager
def no_collections() -> Iterator[None]:
    """Fractions form no cycles; looking for some among millions of them would take a sixth of the time."""
    collecting = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collecting:
            gc.enable()


@no_collections()
def check_data(data: bytes, digest: str | None = None) -> Verdict:
    """The verdict on a certificate; `digest` is that of the fleet it must be of. Raises UnreadableError."""
    rule = "well_formed"
    try:
        claims = read_claims(load(data))
        rule = "same_fleet"
        same_fleet(claims, digest)
        for check_rule in (connected, excited, psi_bounded, conditions, rates):
            rule = check_rule.__name__
            check_rule(claims)
    except FalseError as error:
        return Verdict(False, rule, str(error))
    except RecursionError:
        unreadable("the file is nested too deeply")
    except MemoryError:
        unreadable("the memory of this machine does not suffice")
    return Verdict(True, None, "every rule holds", theorem(claims))


def check(source: str | Path, digest: str | None = None) -> Verdict:
    """The verdict on a certificate: a file, or the JSON text itself (which begins with a brace)."""
    if isinstance(source, str) and source.lstrip().startswith("{"):
        return check_data(source.encode("utf-8", "surrogatepass"), digest)
    try:
        with Path(source).open("rb") as file:
            data = file.read(MAX_BYTES + 1)
    except (OSError, ValueError) as error:
        unreadable(f"{str(source)[:200]!a} cannot be read: {error}")
    return check_data(data, digest)


def main(arguments: Sequence[str]) -> int:
    """Command line: FILE [DIGEST]. Exit code 0: valid, 1: invalid, 2: refused."""
    if len(arguments) not in (1, 2):
        sys.stderr.write("usage: python kernel.py CERTIFICATE.json [DIGEST OF THE FLEET]\n")
        return 2
    try:
        verdict = check(Path(arguments[0]), *arguments[1:])
    except UnreadableError as error:
        sys.stderr.write(f"REFUSED: {error}\n")
        return 2
    sys.stdout.write(f"{verdict}\n")
    return 0 if verdict.valid else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
