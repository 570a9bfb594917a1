"""The graph vehicle by vehicle: the neighbours that each one hears."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...models.graph import Graph


class Neighbours(NamedTuple):
    """The neighbours of vehicle i are entries first[i] to first[i + 1] of the other two arrays."""

    first: NDArray[np.int64]  # (N + 1,)
    vehicle: NDArray[np.int64]  # (2E,), ascending for each i
    weight: NDArray[np.float64]  # (2E,), a_ij

    def of(self, i: int) -> list[tuple[int, float]]:
        """(j, a_ij) of every neighbour of vehicle i."""
        part = slice(self.first[i], self.first[i + 1])
        return list(zip(self.vehicle[part].tolist(), self.weight[part].tolist(), strict=True))


def neighbours(graph: Graph) -> Neighbours:
    """The neighbours of every vehicle of a graph with float weights. O(N + E log E)."""
    ends = np.concatenate([graph.tail, graph.head])
    others = np.concatenate([graph.head, graph.tail])
    weights = np.concatenate([graph.weight, graph.weight])
    order = np.lexsort((others, ends))
    first = np.searchsorted(ends[order], np.arange(graph.vehicles + 1))
    return Neighbours(first, others[order], weights[order])
