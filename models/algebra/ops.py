"""The small algebra over which the paper's equations are written once.

An `Ops` holds the elementwise functions and the two graph verbs that the equations need. NumPy, SymPy and
CasADi each have a member, so the same code is proved, simulated and exported.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from typing import Any

from ..arrays import Array
from ..graph import Graph

Elementwise = Callable[[Array], Array]
GraphVerb = Callable[[Graph, Array], Array]


@dataclass(frozen=True)
class Ops:
    """Elementwise functions over arrays of shape (..., N), and the graph verbs between (..., N) and (..., E)."""

    number: Callable[[Fraction], Any]  # a rational constant of this algebra
    pi: Any
    sin: Elementwise
    cos: Elementwise
    tanh: Elementwise
    log_cosh: Elementwise  # the integral of tanh from 0
    edge_difference: GraphVerb  # (..., N) -> (..., E): z_i - z_j on every edge (i, j)
    edge_sum: GraphVerb  # (..., E) -> (..., N): the signed sum back at the vehicles, + at i and - at j


def unbounded(ops: Ops) -> Ops:
    """The comparison scheme of Section 4: tanh(s) is replaced by its argument, log cosh(s) by s^2 / 2."""
    return replace(ops, tanh=lambda s: s, log_cosh=lambda s: s * s / 2)


@cache
def numpy_ops() -> Ops:
    """Ops over NumPy float arrays."""
    import numpy as np

    def log_cosh(s: Array) -> Array:
        # cosh s = e^|s| (1 + e^(-2|s|)) / 2; nothing here overflows.
        size = np.abs(s)
        return size + np.log1p(np.exp(-2 * size)) - np.log(2)

    return Ops(float, math.pi, np.sin, np.cos, np.tanh, log_cosh, _edge_difference, _edge_sum)


def sparse_ops(graph: Graph, number: type[Any] = float) -> Ops:
    """Ops over NumPy arrays of type `number`, with compiled sparse sums over one large graph, for many states."""
    import numpy as np
    from scipy.sparse import csr_array

    signs = np.repeat(np.array([1, -1], dtype=number), graph.edges)
    edges, ends = np.tile(np.arange(graph.edges), 2), np.concatenate([graph.tail, graph.head])
    incidence = csr_array((signs, (ends, edges)), shape=(graph.vehicles, graph.edges))
    return replace(numpy_ops(), number=number, edge_sum=lambda _graph, f: (incidence @ f.T).T)


def flat_ops(graph: Graph) -> Ops:
    """Ops over NumPy float arrays for one large graph: sparse sums at the vehicles, sin and cos by one vectorised tan.

    An array must not change while it is in use: results for the last array are kept.
    """
    turn = _kept(_half_angle)
    return replace(sparse_ops(graph), sin=lambda s: turn(s)[0], cos=lambda s: turn(s)[1])


def _kept(function: Callable[[Array], Any]) -> Callable[[Array], Any]:
    """The function with its last result kept: the same array is computed once."""
    last: list[Any] = [None, None]

    def apply(s: Array) -> Any:
        if s is not last[0]:
            last[:] = s, function(s)
        return last[1]

    return apply


def _half_angle(s: Array) -> tuple[Array, Array]:
    """(sin s, cos s), from u = tan(s / 2): 2u / (1 + u^2) and 2 / (1 + u^2) - 1, within 4e-16.

    NumPy vectorises tan of doubles, but not sin and cos: this is six times faster.
    """
    import numpy as np

    u = np.tan(s / 2)
    share = 2 / (1 + u * u)
    return u * share, share - 1


@cache
def sympy_ops() -> Ops:
    """Ops over NumPy object arrays of SymPy expressions."""
    import numpy as np
    import sympy as sp

    from .log_cosh import log_cosh

    def elementwise(function: Any) -> Elementwise:
        apply: Elementwise = np.frompyfunc(function, 1, 1)
        return apply

    return Ops(
        sp.Rational,
        sp.pi,
        elementwise(sp.sin),
        elementwise(sp.cos),
        elementwise(sp.tanh),
        elementwise(log_cosh),
        _edge_difference,
        _edge_sum,
    )


@cache
def casadi_ops() -> Ops:
    """Ops over CasADi columns (SX, MX or DM of shape (N, 1))."""
    import casadi as ca
    import numpy as np

    def log_cosh(s: Array) -> Array:
        size = ca.fabs(s)
        return size + ca.log1p(ca.exp(-2 * size)) - np.log(2)

    def incidence(graph: Graph) -> Array:
        rows = np.concatenate([graph.tail, graph.head]).tolist()
        columns = np.tile(np.arange(graph.edges), 2).tolist()
        signs = np.repeat([1.0, -1.0], graph.edges)
        return ca.DM.triplet(rows, columns, ca.DM(signs), graph.vehicles, graph.edges)

    return Ops(
        float,
        math.pi,
        ca.sin,
        ca.cos,
        ca.tanh,
        log_cosh,
        lambda graph, z: ca.mtimes(incidence(graph).T, z),
        lambda graph, f: ca.mtimes(incidence(graph), f),
    )


def casadi_column(values: Any) -> Any:
    """Numbers as a CasADi column."""
    import casadi as ca
    import numpy as np

    return ca.DM(np.asarray(values, dtype=float))


def _edge_difference(graph: Graph, z: Array) -> Array:
    # Transposed, to gather whole rows: arrays over many states have the vehicles outermost.
    return (z.T[graph.tail] - z.T[graph.head]).T


def _edge_sum(graph: Graph, f: Array) -> Array:
    import numpy as np

    total = np.zeros((*f.shape[:-1], graph.vehicles), dtype=f.dtype)
    np.add.at(total.T, graph.tail, f.T)  # transposed, so that the vehicles are the first axis
    np.subtract.at(total.T, graph.head, f.T)
    return total
