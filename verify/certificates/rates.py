"""Decay rates with their positive vectors: found in floats, rounded, checked by the kernel."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...models.arrays import Array, floats
from ...models.fleet import Fleet
from ...models.gains import Gains
from ...models.graph import Graph
from ...models.numbers import decimal_text
from .rounding import rounded

Floats = NDArray[np.float64]

BANDED_ENTRIES = 4 * 10**7  # a banded Cholesky factor may have so many entries; beyond, conjugate gradients
VECTOR_DIGITS = 15  # digits of the largest entry of a positive vector
EXACT_STEPS, LOOSE_STEPS = 40, 5  # inverse iterations with a factor, and with conjugate gradients
NO_RATES: dict[str, Any] = {"gamma_omega": None, "gamma_v": None}


def certified_rates(fleet: Fleet, gains: Gains) -> dict[str, Any]:
    """Both rates with their vectors, as a certificate states them; None where none was found."""
    local = gains.map(floats).local()
    inertia = bounds(vehicle.inertia_bounds(fleet.arm_factor) for vehicle in fleet.vehicles)
    mass = bounds(vehicle.mass_bounds() for vehicle in fleet.vehicles)
    found = {
        "gamma_omega": rate(fleet.graph, inertia, local.p_omega, local.d_omega),
        "gamma_v": rate(fleet.graph, mass, local.p_v, local.d_v),
    }
    return {
        name: stated and {"rate": decimal_text(stated[0]), "vector": " ".join(map(str, stated[1]))}
        for name, stated in found.items()
    }


def bounds(pairs: Any) -> tuple[Array, Array]:
    """The least and the greatest values, floats, (N,) each."""
    least, most = np.array([(float(low), float(high)) for low, high in pairs]).T
    return least, most


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
