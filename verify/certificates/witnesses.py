"""Witnesses for a certificate: found here with floats and solvers, believed by nobody, checked by `kernel.py`."""

from __future__ import annotations

import math
from collections.abc import Callable
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...models.algebra.ops import numpy_ops
from ...models.excitation import Excitation
from ...models.graph import Graph
from ...models.numbers import exact

Floats = NDArray[np.float64]

BANDED_ENTRIES = 4 * 10**7  # a banded Cholesky factor may have so many entries; beyond, conjugate gradients
VECTOR_DIGITS = 15  # digits of the largest entry of a positive vector
EXACT_STEPS, LOOSE_STEPS = 40, 5  # inverse iterations with a factor, and with conjugate gradients
BELOW_PI, ABOVE_PI = Fraction("3.14159265358979"), Fraction("3.1415926535898")


def forest(graph: Graph) -> list[list[int]]:
    """[vehicle, parent] with -1 for the leader, parents first: (A1) in a form that is checked in one pass."""
    parents = graph.leader_tree()
    children: list[list[int]] = [[] for _ in range(graph.vehicles + 1)]
    for vehicle, parent in enumerate(parents.tolist()):
        if parent >= 0:
            children[parent].append(vehicle)
    order = [(vehicle, -1) for vehicle in children[graph.vehicles]]
    for vehicle, _ in order:  # grows while it is read: breadth first
        order += [(child, vehicle) for child in children[vehicle]]
    return [list(pair) for pair in order]


def psi_power(psi: Excitation) -> Fraction:
    """A decimal just below the integral of psi'^2 over one period, (12); with few places where it is tiny or huge."""
    rational, power = psi.power()
    return rounded(rational * BELOW_PI if power == 1 else rational / ABOVE_PI, 12)


def psi_point(psi: Excitation) -> dict[str, Any]:
    """The phase where |psi| is largest, by tan of half of it, and a decimal just below |psi| there.

    Phases within a quarter turn of 0 are meant as they are (half_turn 0), the others half a turn on (half_turn 1).
    """
    period = 2 * math.pi / float(psi.frequency)

    def size(phase: Any) -> Any:
        return abs(psi.value(numpy_ops(), phase / (2 * math.pi) * period))

    phases = np.linspace(-math.pi / 2, 3 * math.pi / 2, 64 * psi.harmonics + 1)
    step = phases[1] - phases[0]
    for _ in range(12):  # zooms in on the largest value, four times each
        best = phases[np.argmax(size(phases))]
        phases, step = np.linspace(best - step, best + step, 9), step / 4
    half_turn = int(math.cos(best) < 0)
    half_tangent = min(1.0, max(-1.0, round(math.tan((best - math.pi * half_turn) / 2), 9)))
    value = float(size(2 * math.atan(half_tangent) + math.pi * half_turn))
    at_least = rounded(Fraction(value) * (1 - Fraction(1, 10**12)), 13)
    return {"half_tangent": exact(half_tangent), "half_turn": half_turn, "at_least": at_least}


def rounded(q: Fraction, digits: int, *, up: bool = False) -> Fraction:
    """A decimal of so many significant digits, not above q (not below, where `up`)."""
    context = Context(prec=digits, rounding=ROUND_CEILING if up else ROUND_FLOOR)
    return Fraction(context.divide(Decimal(q.numerator), Decimal(q.denominator)))


def rate(graph: Graph, mass: tuple[Any, Any], p: Any, d: Any) -> tuple[Fraction, list[int]] | None:
    """(gamma, x) with C - 2 gamma M >= 0, x > 0 and (K - gamma C + gamma^2 M) x >= 0; None where none was found.

    C = diag(d / p), M = diag(mass / p), K = L_l, with the least and greatest mass, all floats. The second condition is
    best at the eigenvector of K x = gamma C x - gamma^2 M x; inverse iteration runs towards it, and whatever vector
    it has reached is a witness of the smallest quotient over the rows (Collatz and Wielandt).
    """
    least, most = mass
    damping = d / p
    fastest = float(np.min(d / (2 * most)))
    K = graph.map(lambda weights: np.asarray(weights, dtype=float)).composed_laplacian()
    rounding = 1e-15 * abs(K)  # times x, a bound of the error of K @ x in floats
    solve, steps = _solver(K)
    x: Floats = np.ones(graph.vehicles)
    gamma = 0.0
    for _ in range(steps):
        found = solve((damping - gamma * least / p) * x)
        if found is None or not np.all(np.isfinite(found)) or not np.all(found > 0):
            return None
        x = np.maximum(np.rint(found / found.max() * 10.0**VECTOR_DIGITS), 1.0)
        last, gamma = gamma, min(fastest, _quotient((K @ x - rounding @ x) / x, damping, least / p))
        if gamma <= last * (1 + 1e-7):
            break
    gamma *= 1 - 1e-9  # for the roundings of the quotient itself
    if not gamma > 0:
        return None
    return rounded(Fraction(gamma), 7), [int(entry) for entry in x]


def _quotient(row: Floats, c: Floats, m: Floats) -> float:
    """The largest gamma with row_i - gamma c_i + gamma^2 m_i >= 0 for every i, gamma below c / (2 m); 0 where none."""
    if not np.all(row > 0):
        return 0.0
    # The smaller root of each parabola, in the form that does not cancel; above its minimum there is no bound.
    inside = c * c - 4 * m * row
    roots = np.where(inside >= 0, 2 * row / (c + np.sqrt(np.maximum(inside, 0))), np.inf)
    return float(roots.min())


def _solver(K: Any) -> tuple[Callable[[Floats], Floats | None], int]:
    """K^-1 and how often to apply it: a banded Cholesky factor where the graph is thin, conjugate gradients else.

    In place of a vector it returns None where neither succeeds.
    """
    from scipy.linalg import cho_solve_banded, cholesky_banded
    from scipy.sparse.csgraph import reverse_cuthill_mckee

    order = reverse_cuthill_mckee(K.tocsr(), symmetric_mode=True)
    entries = K[order][:, order].tocoo()
    lower = entries.row >= entries.col
    offset = (entries.row - entries.col)[lower]
    band = int(offset.max(initial=0))
    if (band + 1) * K.shape[0] > BANDED_ENTRIES:
        return _iterative(K), LOOSE_STEPS
    bands = np.zeros((band + 1, K.shape[0]))
    bands[offset, entries.col[lower]] = entries.data[lower]
    try:
        factor = cholesky_banded(bands, lower=True, overwrite_ab=True)
    except np.linalg.LinAlgError:  # the rounding of a hair's breadth above singular
        return lambda _: None, 1

    def solve(b: Floats) -> Floats:
        x = np.empty_like(b)
        x[order] = cho_solve_banded((factor, True), b[order])
        return x

    return solve, EXACT_STEPS


def _iterative(K: Any) -> Callable[[Floats], Floats | None]:
    from scipy.sparse import diags_array
    from scipy.sparse.linalg import cg

    jacobi = diags_array(1 / K.diagonal())

    def solve(b: Floats) -> Floats | None:
        x, info = cg(K, b, rtol=1e-6, maxiter=1000, M=jacobi)
        return None if info else x

    return solve
