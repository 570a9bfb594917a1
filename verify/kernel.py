"""The trusted checker of gain certificates: `python -I verify/kernel.py CERTIFICATE.json [DIGEST OF THE FLEET]`.

It prints VALID and what follows for which object, or INVALID and the first rule that fails. It imports the standard
library alone, computes with integers alone and calls no solver. A certificate states the fleet, the gains with their
saturation scales, psi, and hints (arcs, tree, margins, vectors); a hint is checked, never believed. The rules:

  well_formed   every column has one number per vehicle, link or limit; edges join two vehicles, each pair once;
                what must be positive is (A2); parts that a designed one replaces are read as strictly as those used
  same_fleet    the fleet's digest is the one asked for
  connected     (A1): each vehicle names a link of positive weight, to the leader or to a vehicle of smaller depth
  excited       (12): psi is not constant; a Fourier sum is then persistently exciting, with its derivative
  psi_bounded   |psi| <= psi_bar, see below
  conditions    (15), (15'), (16), (16*) and the limits asked for: root + rest + margin <= large, with the square root
                of an integer, which is compared by squaring: root <= b if and only if b >= 0 and root^2 <= b^2
  rates         every eigenvalue of M s^2 + C s + K (headings, along-track errors) has real part <= -gamma, see below

Numbers. Every decimal x is read as the integer u x, u = 10^places, with one u for the whole certificate. A product of
n numbers carries u^n; where terms of an inequality have fewer factors, they are multiplied by u (and it by a
denominator > 0) until both sides carry the same power. Intervals [low, high] count with their worst value.

|psi| <= psi_bar: write psi = mean + trig(x), x = w t. On an arc of length h a function with |f''| <= B lies above the
smaller of its values at the ends minus B h^2 / 8 (it differs from the chord by no more). The points x = 2 atan(t) have
rational sine and cosine for rational t, so f = psi_bar -/+ psi is evaluated there exactly; an arc [t, t + e] of them is
not longer than 2 e. t in [-1, 1] covers half the circle, x + pi the other half: the certificate lists arcs that cover
both. A square wave has coefficients 4 / (n pi): all is multiplied by pi, and psi_bar -/+ mean >= 0 by less than pi.

Rates: let A = K - gamma C + gamma^2 M, x > 0 and A x >= 0 row by row. As K has no positive entry off its diagonal, the
matrix S_ij = x_i A_ij x_j has row sums >= 0 and off-diagonal entries <= 0, and
    y^T S y = sum_i (row sum i) y_i^2 + sum_(i<j) (-S_ij) (y_i - y_j)^2 >= 0;   so A >= 0.
If also C - 2 gamma M >= 0, shift s = sigma - gamma: an eigenvector v of the shifted pencil gives m sigma^2 + c sigma
+ k = 0 with m = v*Mv > 0, c = v*(C - 2 gamma M)v >= 0 and k = v*Av >= 0, whose roots have real part <= 0.

tanh(q) = (E - 1) / (E + 1) with E = exp(2 q), and rises with E: a partial sum of the exponential series at 2 q / 2^h,
squared h times and rounded down throughout, is below E.

What follows from the rules is a theorem (corrected Proposition 1), which `gaincert prove` checks. This program checks
its hypotheses for the numbers of one certificate. To trust VALID is to trust that theorem, this file and Python.
"""

from __future__ import annotations

import hashlib
import json
import re
import sys
from collections import namedtuple
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from decimal import Context
from itertools import pairwise, zip_longest
from math import gcd, isqrt, lcm
from pathlib import Path
from typing import Any, NamedTuple, NoReturn

SCHEMA = "gaincert-certificate-2"
MAX_BYTES, MAX_MARKS = 2**30, 20_000  # of a file; marks are quotes, commas, colons, brackets: columns are one string
MAX_WHOLE, MAX_PLACES = 60, 100  # digits of a number before and after the point
MAX_SIZE = 2 * 10**7  # vehicles or links, times places
MAX_HARMONIC, MAX_DEPTH = 200, 80  # of psi; an arc spans at least 2^-80
MAX_WORK = 10**6  # microseconds, about, that the arcs of half a period may cost
MAX_CLOSE = 10**4  # conditions that only the fine tanh decides
LISTED = 20  # limits up to this many are printed one by one

COARSE, FINE = 10**15, 10**80  # units of tanh_below; the fine one where the coarse one does not decide

KEYS = "schema", "conditions", "fleet", "designed", "gains", "psi_bar", "arcs", "tree", "margins", "rim_speed", "rates"
FLEET_KEYS = ("drive", "vehicles", "limits", "edges", "leader_links", "excitation", "offset_x", "offset_y")
PARAMETERS = ("mass", "inertia", "half_track", "wheel_radius", "wheel_inertia", "torque_left", "torque_right")
NETWORK = ("position_scale", "heading_scale")  # one number each, the others one per vehicle
LEADER = -1
HALVES = ("here", "opposite")
SETS = {"paper": ("(15)", "(16)"), "corrected": ("(16*)",), "rate-bounded": ("(15')", "(16*)")}
STRICT = ("(15')", "(16)")
LIMITS = {  # as in the fleet file: what follows, and its unit
    "speed": ("|v_i(t)| <= max(|v_i(t0)|, limit)", "m/s"),
    "turn_rate": ("|omega_i(t)| <= max(|omega_i(t0)|, limit)", "rad/s"),
    "wheel_speed": ("From rest, no wheel turns faster than the limit", "rad/s"),
    "acceleration": ("|v_i'(t)| <= limit from every state", "m/s^2"),
    "turn_acceleration": ("|omega_i'(t)| <= limit from every state", "rad/s^2"),
}
RATES = {
    "gamma_omega": "the headings where alpha is 0, I omega' + (d_omega / o) omega + (p_omega / rho) L_l theta~ = 0",
    "gamma_v": "the along-track errors, m v' + (d_v / s) v + (p_v / l) L_l x~ = 0",
}
STABLE = (
    "From every initial state, the closed loop (13)-(14) has a unique solution for all time; the solutions are "
    "uniformly globally bounded, and the formation (z_i - delta_i = z_l, theta_i = theta_l, v_i = omega_i = 0) is "
    "uniformly globally asymptotically stable."
)
DRIVES = {
    "physical": "I omega' = (R / r) (tau_right - tau_left)",
    "paper": "(2) as printed, I omega' = (2 R / r) (tau_left - tau_right). On a robot that turns left when its right "
    "wheel drives forward these torques are positive feedback: NOTHING is certified for it",
}
PI_BELOW = 314159265358979323846264338327950288419716939937510, 10**50  # 50 decimals of pi

Column = list[int]
Bound = int | None


class UnreadableError(Exception):
    """The file is not a certificate, or too large to be checked: nothing is said about its claims."""


class FalseError(Exception):
    """A rule fails; the message gives the place and both sides."""


class Verdict(NamedTuple):
    """What the kernel found."""

    valid: bool
    rule: str | None  # the first rule that fails
    reason: str  # one line: why, with both sides
    theorem: tuple[str, ...] = ()  # what follows, where valid
    digests: dict[str, str] | None = None  # of the fleet, the graph, the gains and the psi that are used; where valid

    def __str__(self) -> str:
        return "\n".join(["VALID", *self.theorem]) if self.valid else f"INVALID: {self.rule}: {self.reason}"


# -- the certificate in integers ---------------------------------------------------------------------------------------

# One vehicle: D, the least and the greatest value of each parameter, the least torque limit, gains and scales.
Vehicle = namedtuple(
    "Vehicle",
    "degree mass_low mass_high inertia_low inertia_high arm_low arm_high r_low r_high wheel_low wheel_high torque "
    "position_scale speed_scale p_v d_v heading_scale turn_rate_scale p_omega d_omega k_alpha",
)
GAINS = Vehicle._fields[12:]


class Graph(NamedTuple):
    """Links by index: tail[e] < head[e], sorted, so that no pair is there twice."""

    tail: Column
    head: Column
    weight: Column  # a_ij
    leader: Column  # (N,), a_il, 0 where there is no link
    degree: Column  # (N,), D_i = a_il + sum_j a_ij
    redesigned: int | None  # how many weights differ from those of the fleet; None where none were designed


class Psi(NamedTuple):
    """psi = mean + share * sum s_n sin(n w t) + c_n cos(n w t), where share <= times / over."""

    mean: int
    terms: list[tuple[int, int, int]]  # n, s_n, c_n
    times: int
    over: int


class Claims(NamedTuple):
    """A certificate with its numbers as integers in units of 1 / unit."""

    unit: int
    conditions: str
    drive: str
    columns: list[Column]  # (N,) each, the fields of Vehicle
    intervals: dict[str, int]  # parameter: how many vehicles have an interval of it
    limits: dict[str, tuple[Column, Column]]  # vehicles, values
    graph: Graph
    psi: Psi
    designed: bool  # whether psi is designed
    psi_bar: int
    arcs: list[Column]
    tree: list[Column]  # (N,) each: the link to the vehicle before, the depth
    margins: dict[str, Column]
    rates: dict[str, tuple[int, Column]]
    rim_speed: Column  # of the vehicles with a wheel-speed limit: which speed V it leaves to v
    digests: dict[str, str]  # SHA-256 of what is certified; the names of vehicles do not count

    def vehicles(self, chosen: Sequence[int]) -> Iterator[Any]:
        """These vehicles, in rising order."""
        some = len(chosen) < len(self.columns[0])
        columns = [map(column.__getitem__, chosen) for column in self.columns] if some else self.columns
        return map(Vehicle._make, zip(*columns, strict=True))


def load(data: bytes | bytearray) -> Any:
    """JSON of few values, without duplicate keys."""
    if len(data) > MAX_BYTES or sum(map(data.count, (b'"', b",", b":", b"[", b"{"))) > MAX_MARKS:
        unreadable(f"the file is larger than {MAX_BYTES} bytes or {MAX_MARKS} quotes, commas, colons and brackets")
    try:
        return json.loads(data.decode("utf-8"), object_pairs_hook=_without_duplicates)
    except ValueError as error:  # not UTF-8, not JSON, an integer of thousands of digits
        unreadable(f"the file is not JSON: {str(error)[:200]}")


def _without_duplicates(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    return dict(pairs) if len(dict(pairs)) == len(pairs) else unreadable("a key is listed twice in one table")


def unreadable(message: str) -> NoReturn:
    """Refuse the file."""
    raise UnreadableError(message)


def table(value: Any, keys: Iterable[str]) -> list[Any]:
    """The values of a table with exactly these keys."""
    if not isinstance(value, dict) or value.keys() != set(keys):
        found = ", ".join(sorted(value)) if isinstance(value, dict) else value
        unreadable(f"expected a table with the keys {', '.join(keys)}, not {ascii(found)[:200]}")
    return [value[key] for key in keys]


def places_of(value: Any) -> int:
    """The most digits after the point of any number in a document; in a column, the first number decides."""
    if isinstance(value, str):
        return len(value[: 2 * MAX_PLACES].partition(" ")[0].partition(".")[2])
    entries = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return max(map(places_of, entries), default=0)


def count_of(text: Any) -> int:
    """How many numbers a column seems to have."""
    return text.count(" ") + 1 if isinstance(text, str) and text else 0


def integers(text: str, factor: int) -> Iterator[int]:
    """The numbers of a column, times a factor; piece by piece, since texts take more memory than numbers."""
    for piece in re.finditer("(?:-?[0-9]+ ?){1,20000}+", text):
        texts = piece[0].split()
        if 2 * len(distinct := set(texts)) < len(texts):  # shared by text, whose hashes nobody can foresee
            yield from map({one: int(one) * factor for one in distinct}.__getitem__, texts)
        else:
            yield from [int(one) * factor for one in texts]


class Reader:
    """Reads the columns of one certificate as integers in units of 10^-places."""

    def __init__(self, places: int, vehicles: Any) -> None:
        """Bound the size of all numbers together."""
        if type(vehicles) is not int or not 1 <= vehicles * max(1, places) <= MAX_SIZE or places > MAX_PLACES:
            unreadable(f"{ascii(vehicles)[:20]} vehicles with {places} digits after the point are not checked")
        self.places, self.vehicles, self.unit = places, vehicles, 10**places

    def column(self, text: Any, what: str, count: Bound = None, least: Bound = 1, below: Bound = None) -> Column:
        """So many numbers (one per vehicle unless `count` says how many), all with the places of the first one.

        They are > 0, (A2), unless `least` is 0 or None (of any sign). With `below` they are integers from `least`.
        """
        count, own = self.vehicles if count is None else count, places_of(text)
        if text == "" and count == 0:
            return []
        number = rf"-?(?:0|[1-9][0-9]{{0,{MAX_WHOLE - 1}}})" + (rf"\.[0-9]{{{own}}}" if own and below is None else "")
        column = rf"{number}(?: {number}){{{count - 1}}}+"
        if not isinstance(text, str) or own > self.places or count < 1 or not re.fullmatch(column, text):
            unreadable(f"{what}: expected a string of {count} decimals of one form, not {ascii(text)[:80]}")
        factor = 10 ** (self.places - own) if below is None else 1
        found = list(integers(text.replace(".", ""), factor))
        low, high, unit = min(found), max(found), factor * 10**own
        if (least is not None and low < least) or (below is not None and high >= below):
            wanted = ("> 0 (A2)" if least else ">= 0") if below is None else f"from {least} to {below - 1}"
            raise FalseError(f"{what}: all must be {wanted}, not {shown(low, unit)} to {shown(high, unit)}")
        return found

    def ends(self, value: Any, what: str, least: int) -> list[Column]:
        """The least and the greatest values of a parameter: a column for both, or a list of two."""
        texts = value if isinstance(value, list) and len(value) == 2 else [value]
        found = [self.column(text, what, None, least) for text in texts]
        if any(map(int.__gt__, found[0], found[-1])):
            raise FalseError(f"{what}: an interval must have low <= high (A2)")
        return [found[0], found[-1]]


def shown(numerator: int, denominator: int) -> str:
    """A ratio in twelve digits, for people to read; no verdict rests on it."""
    return format(Context(prec=12).divide(numerator, denominator), "g")


def exact(value: int, unit: int) -> str:
    """A number of the certificate in full."""
    return format(Context(prec=MAX_WHOLE + MAX_PLACES).divide(value, unit), "f")


def digest(part: Any) -> str:
    """SHA-256 of a part as JSON with sorted keys, without spaces; the texts of columns as they are in the file."""
    return "sha256:" + hashlib.sha256(json.dumps(part, sort_keys=True, separators=(",", ":")).encode()).hexdigest()


def read_claims(document: Any) -> Claims:
    """The certificate in integers. Raises UnreadableError, or FalseError where (A2) or the graph is broken."""
    schema = document.get("schema") if isinstance(document, dict) else document
    if schema != SCHEMA:
        unreadable(f"schema {schema!a:.60}, not {SCHEMA}: certify again (gaincert certify FLEET.toml --gains GAINS)")
    claimed = {key: value for key, value in document.items() if key != "provenance"}
    _, conditions, fleet, designed, gains, psi_bar, arcs, tree, margins, rim_speed, rates = table(claimed, KEYS)
    drive, count, limits, edges, led, excitation, offset_x, offset_y, *texts = table(fleet, FLEET_KEYS + PARAMETERS)
    if conditions not in list(SETS) or drive not in list(DRIVES):
        unreadable(f"conditions must be one of {', '.join(SETS)}, and drive one of {', '.join(DRIVES)}")
    reader = Reader(places_of(claimed), count)
    column = reader.column
    for offset in (offset_x, offset_y):
        column(offset, "offset", None, None)
    ends = [reader.ends(text, name, name != "wheel_inertia") for text, name in zip(texts, PARAMETERS, strict=True)]
    intervals = {name: n for name, pair in zip(PARAMETERS, ends, strict=True) if (n := sum(map(int.__ne__, *pair)))}
    mass, inertia, half_track, radius, wheel, left, right = ends
    arm = [[(2 if drive == "paper" else 1) * half for half in values] for values in half_track]
    new_psi, weights = table(designed, ("excitation", "weights"))
    graph, used = read_graph(reader, edges, led, weights)
    psi = [read_psi(reader, one) for one in (excitation, new_psi) if one is not None] or [read_psi(reader, None)]
    chosen = zip(table(gains, GAINS), GAINS, strict=True)
    own = [column(text, name, 1) * count if name in NETWORK else column(text, name) for text, name in chosen]
    asked = read_limits(reader, limits)
    counts = dict.fromkeys(SETS[conditions], count) | {name: len(values) for name, (_, values) in asked.items()}
    stated = zip(counts.items(), table(margins, counts), strict=True)
    link, depth = table(tree, ("link", "depth"))
    return Claims(
        reader.unit, conditions, drive,
        [graph.degree, *mass, *inertia, *arm, *radius, *wheel, list(map(min, left[0], right[0])), *own],
        intervals, asked, graph, psi[-1], new_psi is not None, column(psi_bar, "psi_bar", 1)[0],
        [column(text, "arcs", min(count_of(text), MAX_WORK // 4), 0, MAX_DEPTH) for text in table(arcs, HALVES)],
        [column(link, "tree: link", None, LEADER, len(graph.tail)), column(depth, "tree: depth", None, 0, count)],
        {name: column(text, f"{name}: margin", own, 0) for (name, own), text in stated}, read_rates(reader, rates),
        column(rim_speed, "rim_speed", counts.get("wheel_speed", 0)),
        {"fleet": digest(fleet), "graph": digest(used), "gains": digest(gains), "psi": digest(new_psi or excitation)},
    )  # fmt: skip


def rising(values: Iterable[Any], what: str) -> None:
    """Refuse what is not sorted, or is there twice."""
    if any(a >= b for a, b in pairwise(values)):
        raise FalseError(f"{what} must be in rising order, each once")


def read_graph(reader: Reader, edges: Any, leader_links: Any, designed: Any) -> tuple[Graph, Any]:
    """The links with the weights that are used, and the same as they are in the file, for the digest."""
    n = reader.vehicles
    tails, heads, weights = table(edges, ("tail", "head", "weight"))
    vehicles, leader_weights = table(leader_links, ("vehicle", "weight"))
    count, led_count = count_of(tails), count_of(vehicles)
    if count * max(1, reader.places) > MAX_SIZE or count > n * (n - 1) // 2:
        unreadable(f"{count} links between {n} vehicles are too many")
    tail, head = (reader.column(text, "edges", count, 0, n) for text in (tails, heads))
    led = reader.column(vehicles, "leader_links", led_count, 0, n)
    if not all(map(int.__lt__, tail, head)):
        raise FalseError("edges: an edge must join a vehicle to a later one")
    rising(zip(tail, head, strict=True), "edges")
    rising(led, "leader_links")
    own = used = reader.column(weights, "weight", count) + reader.column(leader_weights, "leader weight", led_count)
    if designed is not None:
        weights, leader_weights = table(designed, ("edges", "leader_links"))
        used = reader.column(weights, "designed weight", count, 0)
        used += reader.column(leader_weights, "designed leader weight", led_count, 0)
    leader = [0] * n
    for i, weight in zip(led, used[count:], strict=True):
        leader[i] = weight
    degree = leader.copy()
    for i, j, weight in zip(tail, head, used, strict=False):
        degree[i] += weight
        degree[j] += weight
    redesigned = None if designed is None else sum(map(int.__ne__, own, used))
    links = {"vehicles": n, "edges": [tails, heads, weights], "leader_links": [vehicles, leader_weights]}
    return Graph(tail, head, used[:count], leader, degree, redesigned), links


def read_psi(reader: Reader, excitation: Any) -> Psi:
    """The Fourier sum of an excitation table."""
    if isinstance(excitation, dict) and excitation.get("family") == "square-wave":
        _, mean, count, frequency = table(excitation, ("family", "mean", "terms", "frequency"))
        if type(count) is not int or not 1 <= count <= MAX_HARMONIC // 2:
            unreadable(f"excitation: terms must be 1 to {MAX_HARMONIC // 2}")
        common, (below, power) = lcm(*range(1, 2 * count, 2)), PI_BELOW
        terms = [(n, common // n, 0) for n in range(1, 2 * count, 2)]  # 4 / (n pi) <= 4 power / (n below)
        times, over = 4 * power * reader.unit, below * common
    else:
        family, mean, frequency, *texts = table(excitation, ("family", "mean", "frequency", "sin", "cos"))
        counts = list(map(count_of, texts))
        if family != "harmonics" or max(counts) > MAX_HARMONIC:
            unreadable(f"excitation: family must be square-wave or harmonics, of at most {MAX_HARMONIC} harmonics")
        waves = (reader.column(text, "excitation", count, None) for text, count in zip(texts, counts, strict=True))
        terms = [(n, s, c) for n, (s, c) in enumerate(zip_longest(*waves, fillvalue=0), 1) if s or c]
        times = over = 1
    reader.column(frequency, "frequency", 1)
    return Psi(reader.column(mean, "excitation: mean", 1, None)[0], terms, times, over)


def read_limits(reader: Reader, limits: Any) -> dict[str, tuple[Column, Column]]:
    """The limits that vehicles ask for, by name: which vehicles, and what."""
    found = {}
    for name, columns in zip(LIMITS, table(limits, LIMITS), strict=True):
        if columns is not None:
            vehicles, values = table(columns, ("vehicle", "value"))
            count = count_of(vehicles)
            found[name] = reader.column(vehicles, name, count, 0, reader.vehicles), reader.column(values, name, count)
            rising(found[name][0], name)
    return found


def read_rates(reader: Reader, rates: Any) -> dict[str, tuple[int, Column]]:
    """The stated rates, each with its positive vector."""
    found = {}
    for name, stated in zip(RATES, table(rates, RATES), strict=True):
        if stated is not None:
            rate, vector = table(stated, ("rate", "vector"))
            found[name] = reader.column(rate, name, 1)[0], reader.column(vector, name, None, 1, 10**MAX_WHOLE)
    return found


# -- the rules ---------------------------------------------------------------------------------------------------------


def connected(claims: Claims) -> None:
    """(A1): along the stated links depth falls, so that every vehicle is joined to the leader by positive weights."""
    graph, (links, depths) = claims.graph, claims.tree
    for vehicle, (link, depth) in enumerate(zip(links, depths, strict=True)):
        ends = (graph.tail[link], graph.head[link]) if link != LEADER else (vehicle,)
        weight = graph.weight[link] if link != LEADER else graph.leader[vehicle]
        if not (weight > 0 and vehicle in ends and (link == LEADER or depths[sum(ends) - vehicle] < depth)):
            raise FalseError(f"vehicle {vehicle + 1} has no link to the leader or to a vehicle of smaller depth")


def excited(claims: Claims) -> None:
    """(12): a harmonic is present, so that the integral of psi'^2 over one period is positive."""
    if not claims.psi.terms:
        raise FalseError("psi is constant")


def psi_bounded(claims: Claims) -> None:
    """|psi| <= psi_bar on both halves of a period."""
    psi, bar = claims.psi, claims.psi_bar
    if bar < abs(psi.mean):
        raise FalseError(f"psi has the mean {shown(psi.mean, claims.unit)}, beyond psi_bar = {shown(bar, claims.unit)}")
    for half_turn, depths in enumerate(claims.arcs):
        bounded_on_half(psi, bar, half_turn, depths)


def bounded_on_half(psi: Psi, bar: int, half_turn: int, depths: Column) -> None:
    """|psi| <= bar for x = 2 atan(t) + pi half_turn, t in [-1, 1], over arcs of width 2^-depth from left to right."""
    deepest = max(depths, default=0)
    if len(depths) * (3 + (highest := max(psi.terms)[0]) + (highest * deepest) ** 2 // 10**5) > MAX_WORK:
        unreadable("arcs: too many to be checked; state a larger psi_bar")
    left, width = -(1 << deepest), 1 << deepest
    end = slack(psi, bar, half_turn, left, width)
    for depth in depths:
        left += width >> depth
        begin, end = end, slack(psi, bar, half_turn, left, width)
        if end[0] < 0:
            raise FalseError(f"|psi| > psi_bar at w t = 2 atan({shown(left, width)}) + {half_turn} pi")
        if not settled(psi, depth, begin, end):
            raise FalseError(f"the arc of width 2^-{depth} that ends at {shown(left, width)} is too wide")
    if left != width:
        raise FalseError("the arcs do not cover half a period")


def slack(psi: Psi, bar: int, half_turn: int, p: int, q: int) -> tuple[int, int]:
    """The smaller of bar - psi and bar + psi at x = 2 atan(p / q) + pi half_turn: a numerator and its denominator."""
    common = gcd(p, q)
    terms = {n: (-s, -c) if half_turn and n % 2 else (s, c) for n, s, c in psi.terms}  # odd ones turn with x + pi
    value, scale = harmonic_sum(terms, p // common, q // common)
    wave, unit = psi.times * value, psi.over * scale
    return min(unit * (bar - psi.mean) - wave, unit * (bar + psi.mean) + wave), scale


def settled(psi: Psi, depth: int, *ends: tuple[int, int]) -> bool:
    """Whether the slack at both ends of an arc of width e is at least B h^2 / 8, where h <= 2 e and |psi''| <= B."""
    curvature = psi.times * sum(n * n * (abs(s) + abs(c)) for n, s, c in psi.terms)
    return all(least << (2 * depth + 1) >= curvature * scale for least, scale in ends)


def harmonic_sum(terms: dict[int, tuple[int, int]], p: int, q: int) -> tuple[int, int]:
    """sum s_n sin(n x) + c_n cos(n x) at x = 2 atan(p / q), terms {n: (s_n, c_n)}, as a numerator and a denominator.

    With e^ix = w / r, w = (q + ip)^2, r = q^2 + p^2, it is Re sum (c_n - i s_n) w^n / r^n: Horner's rule times r^n.
    """
    re_w, im_w, r = q * q - p * p, 2 * p * q, q * q + p * p
    re, im, scale = 0, 0, 1
    for n in range(max(terms), 0, -1):
        s, c = terms.get(n, (0, 0))
        re, im = re + c * scale, im - s * scale
        re, im, scale = re * re_w - im * im_w, re * im_w + im * re_w, scale * r
    return re, scale


def tanh_below(p: int, q: int, one: int) -> tuple[int, int]:
    """(a, b) with 0 <= a / b <= tanh(p / q) for p, q > 0, from a partial sum of exp in units of 1 / one."""
    p, q = (p, q) if p < 100 * q else (100, 1)
    halvings = max(0, (2 * p).bit_length() - q.bit_length() + 1)  # 2 p / q < 2^halvings
    term = total = one
    n = 0
    while term:
        n += 1
        term = 2 * p * term // (n * q << halvings)
        total += term
    for _ in range(halvings):
        total = total * total // one
    return total - one, total + one


# -- the conditions: each says root + rest + margin <= large for a vehicle, with root^2 = square -----------------------

Sides = tuple[int, int, int, int]  # square, rest, large, per_margin: sqrt(square) + rest + margin per_margin <= large


def condition_15(c: Claims, v: Any, _limit: int, one: int) -> Sides:
    """(15): sqrt2 k psi_bar D <= d_omega tanh(1), times u^3 b with tanh(1) >= a / b."""
    a, b = tanh_below(1, 1, one)
    return 2 * (v.k_alpha * c.psi_bar * v.degree * b) ** 2, 0, v.d_omega * a * c.unit**2, b * c.unit**2


def condition_15_prime(c: Claims, v: Any, _limit: int, _one: int) -> Sides:
    """(15'): sqrt2 k psi_bar D + p_omega D < d_omega, times u^3."""
    return 2 * (v.k_alpha * c.psi_bar * v.degree) ** 2, v.p_omega * v.degree * c.unit, v.d_omega * c.unit**2, c.unit**2


def condition_16(c: Claims, v: Any, _limit: int, _one: int) -> Sides:
    """(16): arm (d_v + sqrt2 p_v D) + d_omega + p_omega D + sqrt2 k psi_bar D < 2 arm torque / r, times r u^4."""
    return torque_sides(c, v, (v.arm_low * v.p_v + v.k_alpha * c.psi_bar) ** 2, v.r_high)


def condition_16_star(c: Claims, v: Any, _limit: int, _one: int) -> Sides:
    """(16*): (r / 2) [d_v + sqrt2 D sqrt(p_v^2 + (k psi_bar / arm)^2) + (d_omega + p_omega D) / arm] <= torque.

    It is multiplied by 2 arm u^4.
    """
    return torque_sides(c, v, (v.arm_low * v.p_v) ** 2 + (v.k_alpha * c.psi_bar) ** 2, 2 * v.arm_low)


def torque_sides(c: Claims, v: Any, pull: int, per_margin: int) -> Sides:
    """r [arm d_v + d_omega + p_omega D + sqrt2 D sqrt(pull)] <= 2 arm torque, times u^4; pull carries u^4."""
    u = c.unit
    rest = v.r_high * u * (v.arm_low * v.d_v + v.d_omega * u + v.p_omega * v.degree)
    return 2 * (v.r_high * v.degree) ** 2 * pull, rest, 2 * v.arm_low * v.torque * u * u, per_margin * u * u


def speed(c: Claims, v: Any, limit: int, one: int) -> Sides:
    """sqrt2 p_v D <= d_v tanh(limit / s), times u^2 b with tanh >= a / b."""
    a, b = tanh_below(limit, v.speed_scale, one)
    return 2 * (v.p_v * v.degree * b) ** 2, 0, v.d_v * a * c.unit, b * c.unit


def turn_rate(c: Claims, v: Any, limit: int, one: int, over: int = 1) -> Sides:
    """p_omega D + sqrt2 k psi_bar D <= d_omega tanh((limit / over) / o), times u^3 b with tanh >= a / b."""
    a, b = tanh_below(limit, over * v.turn_rate_scale, one)
    rest, large = v.p_omega * v.degree * c.unit * b, v.d_omega * a * c.unit**2
    return 2 * (v.k_alpha * c.psi_bar * v.degree * b) ** 2, rest, large, b * c.unit**2


def acceleration(c: Claims, v: Any, limit: int, _one: int) -> Sides:
    """d_v + sqrt2 p_v D <= limit m, times u^2 and the denominator of m."""
    m, over, _, _ = effective_mass(v, c.unit)
    return 2 * (v.p_v * v.degree * over) ** 2, v.d_v * over * c.unit, limit * m, over * c.unit


def turn_acceleration(c: Claims, v: Any, limit: int, _one: int) -> Sides:
    """d_omega + p_omega D + sqrt2 k psi_bar D <= limit I, times u^3 and the denominator of I."""
    inertia, over, _, _ = effective_inertia(v)
    rest = over * c.unit * (v.d_omega * c.unit + v.p_omega * v.degree)
    return 2 * (v.k_alpha * c.psi_bar * v.degree * over) ** 2, rest, limit * inertia * c.unit, over * c.unit**2


def wheel_speed(c: Claims, v: Any, shares: tuple[int, int, int], one: int) -> Sides:
    """V + arm Omega + margin = r limit: |v| stays within V, |omega| within Omega, so the wheels within the limit."""
    limit, rim, margin = shares
    within, left = speed(c, v, rim, one), v.r_low * limit - (rim + margin) * c.unit  # arm Omega, times u^2
    return turn_rate(c, v, max(left, 0), one, v.arm_high) if holds(within, 0) else within


CONDITIONS: dict[str, Callable[[Claims, Any, Any, int], Sides]] = {
    "(15)": condition_15, "(15')": condition_15_prime, "(16)": condition_16, "(16*)": condition_16_star,
    **{limit.__name__: limit for limit in (speed, turn_rate, wheel_speed, acceleration, turn_acceleration)},
}  # fmt: skip


def conditions(claims: Claims) -> None:
    """Every condition of the set and every limit holds, with its stated margin to spare."""
    close = 0  # conditions that take the fine tanh
    for name, margins in claims.margins.items():
        who, values = claims.limits.get(name, (range(len(margins)), margins))
        wheels = name == "wheel_speed"  # whose margin is taken from what is left to |omega|
        limits: Iterable[Any] = zip(values, claims.rim_speed, margins, strict=True) if wheels else values
        condition, strict, stated = CONDITIONS[name], name in STRICT, [0] * len(who) if wheels else margins
        for i, vehicle, limit, margin in zip(who, claims.vehicles(who), limits, stated, strict=True):
            if not holds(condition(claims, vehicle, limit, COARSE), margin, strict):
                sides, close = condition(claims, vehicle, limit, FINE), close + 1
                if not holds(sides, margin, strict):
                    explain(claims.unit, f"{name}: vehicle {i + 1}", sides, margin)
                if close > MAX_CLOSE:
                    unreadable(f"more than {MAX_CLOSE} conditions hold by less than 1e-14: state smaller margins")


def holds(sides: Sides, margin: int, strict: bool = False) -> bool:
    """Whether root + rest + margin <= large, or < where the condition is strict and states no margin."""
    square, rest, large, per_margin = sides
    room = large - rest - margin * per_margin
    return room >= 0 and (square < room * room or (square == room * room and (margin > 0 or not strict)))


def explain(unit: int, where: str, sides: Sides, margin: int) -> NoReturn:
    """Raise what fails: the condition, or the margin that is stated."""
    square, rest, large, per_margin = sides
    small, scale = isqrt(square) + rest, per_margin * unit
    if margin and small <= large:
        raise FalseError(f"{where}: the stated margin {shown(margin, unit)} is more than {shown(large - small, scale)}")
    raise FalseError(f"{where}: {shown(small, scale)} exceeds {shown(large, scale)} by {shown(small - large, scale)}")


# -- rates -------------------------------------------------------------------------------------------------------------


def effective_mass(v: Any, u: int) -> tuple[int, int, int, int]:
    """The least and the greatest effective mass, (numerator, denominator) each, in units of 1 / u.

    Controller and vehicle may each have any r of its interval, r and r': the vehicle then moves as one of mass
    (m + 2 J / r'^2) r' / r, J being the inertia of one wheel.
    """
    radii, j = v.r_low * v.r_high, 2 * u * u
    least, most = v.mass_low * radii + j * v.wheel_low, v.mass_high * radii + j * v.wheel_high
    return least, v.r_high**2, most, v.r_low**2


def effective_inertia(v: Any) -> tuple[int, int, int, int]:
    """The same for the moment of inertia, (I + 2 J arm'^2 / r'^2) (r' / r) (arm / arm')."""
    arms, radii = v.arm_low * v.arm_high, v.r_low * v.r_high
    least, most = v.inertia_low * radii + 2 * v.wheel_low * arms, v.inertia_high * radii + 2 * v.wheel_high * arms
    return v.arm_low * least, v.arm_high * v.r_high**2, v.arm_high * most, v.arm_low * v.r_low**2


def rates(claims: Claims) -> None:
    """The stated rates, by C - 2 gamma M >= 0 and (K - gamma C + gamma^2 M) x >= 0 with the local gains.

    M = m l / p and C = d l / (p s), with p, d, their scales l, s, and K = L_l; row i is multiplied by p s u^2 / l and
    the denominator of m.
    """
    graph, u, u2 = claims.graph, claims.unit, claims.unit**2
    for name, (gamma, x) in claims.rates.items():
        turning, rows = name == "gamma_omega", list(map(int.__mul__, claims.columns[0], x))  # L_l x
        for i, j, weight in zip(graph.tail, graph.head, graph.weight, strict=True):
            rows[i] -= weight * x[j]
            rows[j] -= weight * x[i]
        for i, (v, row, own) in enumerate(zip(claims.vehicles(range(len(x))), rows, x, strict=True)):
            scale, s, p, d = v[16:20] if turning else v[12:16]
            least, below, most, over = effective_inertia(v) if turning else effective_mass(v, u)
            if d * over * u2 < 2 * gamma * most * s:
                raise FalseError(f"{name}: vehicle {i + 1}: C >= 2 gamma M fails")
            if below * u2 * (p * s * row - gamma * d * scale * own) + gamma * gamma * least * scale * s * own < 0:
                raise FalseError(f"{name}: vehicle {i + 1}: (K - gamma C + gamma^2 M) x is negative")


# -- the verdict -------------------------------------------------------------------------------------------------------


def theorem(c: Claims) -> Iterator[str]:
    """What follows when every rule holds, and for which object."""
    graph, vehicles, everybody = c.graph, Vehicle(*c.columns), range(len(c.graph.leader))
    led, bar, of_file = sum(weight > 0 for weight in graph.leader), exact(c.psi_bar, c.unit), "of the fleet file"
    weights = of_file if graph.redesigned is None else f"from the gains file, {graph.redesigned} of them changed"
    yield f"fleet {c.digests['fleet']}: {len(everybody)} vehicles, numbered from 1 in the order of the fleet file"
    yield f"graph {c.digests['graph']}: {len(graph.tail)} links of vehicles, {led} to the leader, weights {weights}"
    yield f"gains {c.digests['gains']}: five gains of every vehicle, and the saturation scales"
    yield f"psi   {c.digests['psi']}: {'from the gains file' if c.designed else of_file}, |psi| <= {bar} = psi_bar"
    yield f"Drive {c.drive!r}: {DRIVES[c.drive]}."
    yield f"Conditions {c.conditions!r}: {', '.join(SETS[c.conditions])}."
    torque, position, speed, heading, turn_rate = (each(c.unit, everybody, vehicles[k]) for k in (11, 12, 13, 16, 17))
    yield f"Saturation scales: {position} m, {heading} rad; of v {speed} m/s; of omega {turn_rate} rad/s."
    yield STABLE
    yield f"From every initial state and at all times, no wheel torque exceeds its limit (Constraint 1): {torque} N m."
    if c.conditions == "rate-bounded":
        yield "|omega_i(t)| <= max(|omega_i(t0)|, o_i atanh((p_omega D + sqrt2 k psi_bar D) / d_omega)), t >= t0."
    for name, limit in c.limits.items():
        words = f"{name.replace('_', ' ')} limit {each(c.unit, *limit)} {LIMITS[name][1]} of {len(limit[0])} vehicles"
        yield f"{LIMITS[name][0]}, t >= t0, with the {words}."
    for name, uncertain in c.intervals.items():
        yield f"Covered: every value in its interval of {name.replace('_', ' ')}, which {uncertain} vehicles have."
    for name, (gamma, _) in c.rates.items():
        yield f"Linearised at the formation, {RATES[name]}, have no exponent above -{exact(gamma, c.unit)} 1/s."


def each(unit: int, vehicles: Sequence[int], values: Column) -> str:
    """A value for each of a few vehicles; the least and the greatest value of many."""
    least, most = exact(min(values), unit), exact(max(values), unit)
    if least == most or len(values) > LISTED:
        return least if least == most else f"{least} to {most}"
    return ", ".join(f"{exact(value, unit)} (vehicle {i + 1})" for i, value in zip(vehicles, values, strict=True))


def check_data(data: bytes | bytearray, digest: str | None = None) -> Verdict:
    """The verdict on a certificate; `digest` is that of the fleet it must be of.

    Raises UnreadableError where it is no certificate, MemoryError where this machine has too little memory.
    """
    rule = "well_formed"
    try:
        claims = read_claims(load(data))
        rule = "same_fleet"
        if digest not in (None, claims.digests["fleet"]):
            raise FalseError(f"the certificate is of the fleet {claims.digests['fleet']}, not of the fleet {digest!a}")
        for check_rule in (connected, excited, psi_bounded, conditions, rates):
            rule = check_rule.__name__
            check_rule(claims)
    except FalseError as error:
        return Verdict(False, rule, str(error))
    except RecursionError:
        unreadable("the file is nested too deeply")
    return Verdict(True, None, "every rule holds", tuple(theorem(claims)), claims.digests)


def read(path: str | Path) -> bytearray:
    """The bytes of a file, up to a little more than the largest certificate."""
    data = bytearray()
    try:
        with Path(path).open("rb") as file:
            while len(data) <= MAX_BYTES and (piece := file.read(2**20)):
                data += piece
    except (OSError, ValueError) as error:
        unreadable(f"{str(path)[:200]!a} cannot be read: {error}")
    return data


def main(arguments: Sequence[str]) -> int:
    """Command line: FILE [DIGEST]. Exit code 0: valid, 1: invalid, 2: refused, 5: this program failed."""
    try:
        if len(arguments) not in (1, 2):
            unreadable("usage: python -I kernel.py CERTIFICATE.json [DIGEST OF THE FLEET]")
        verdict = check_data(read(arguments[0]), *arguments[1:])
        sys.stdout.write(f"{verdict}\n")
        sys.stdout.flush()
        return 0 if verdict.valid else 1
    except UnreadableError as error:
        message, code = f"REFUSED: {error}", 2
    except Exception as error:  # no memory, a full disk, a reader that left, a bug: no verdict
        message, code = f"FAULT: {type(error).__name__} {str(error)[:200]!a}: nothing is said of the certificate", 5
        with suppress(OSError, ValueError, AttributeError):
            sys.stdout.close()  # so that what a full disk did not take is not tried again
    with suppress(OSError, ValueError, AttributeError):
        sys.stderr.write(f"{message}\n")
    return code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
