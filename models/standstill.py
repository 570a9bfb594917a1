"""How far from its place friction may stop a fleet."""

from __future__ import annotations

import numpy as np

from .algebra.ops import numpy_ops
from .arrays import Array, floats
from .energy import potential
from .equations import consensus_error
from .graph import Graph

NEWTON_STEPS = 100
SATURATED = 18.0  # tanh of more is 1 to the last digits
ACCURACY = 1e-9  # of the friction


def farthest_standstill(graph: Graph, friction: Array) -> Array:
    """The largest errors of one coordinate at which the vehicles may stand still, (N,), as multiples of its scale.

    `friction` (N,) is that of each vehicle, divided by the gain of its pulls. The vehicles stand if |e_i| <= friction_i
    in (8) or (10). There e_i grows with the error of vehicle i and falls with those of the others, so all errors are
    largest where e_i = friction_i for all. inf for all if the pulls cannot reach that.
    """
    from scipy.sparse.linalg import splu

    ops, graph, unreachable = numpy_ops(), graph.map(floats), np.full(graph.vehicles, np.inf)
    if not friction.any():
        return np.zeros(graph.vehicles)
    if not np.isfinite(friction).all():
        return unreachable

    def work(z: Array) -> float:
        """The convex function whose gradient is e - friction."""
        return float(potential(ops, graph, 1.0, z, 0.0) - friction @ z)

    z = np.zeros(graph.vehicles)
    for _ in range(NEWTON_STEPS):
        excess = consensus_error(ops, graph, 1.0, z, 0.0) - friction
        if np.abs(excess).max() <= ACCURACY * friction.max():
            return z
        if np.abs(z).max() > SATURATED:
            break
        edges = graph.weight / np.cosh(z[graph.tail] - z[graph.head]) ** 2
        slopes = Graph(graph.tail, graph.head, edges, graph.leader_weight / np.cosh(z) ** 2)
        step = splu(slopes.composed_laplacian().tocsc()).solve(excess)
        step /= max(1.0, float(np.abs(step).max()))
        while work(z - step) > work(z) and np.abs(step).max() > ACCURACY:
            step = step / 2
        z = z - step
    return unreachable
