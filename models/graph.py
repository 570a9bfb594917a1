"""The interconnection graph: a_ij between followers, a_il to the leader, and the test of Lemma 1."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .arrays import Array

Indices = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Graph:
    """An undirected weighted graph on N vehicles with E edges, and its links to the leader.

    The weights may be floats, `Fraction`s, SymPy numbers or CasADi symbols; results keep that type.
    """

    tail: Indices  # (E,), i of every edge (i, j)
    head: Indices  # (E,), j
    weight: Array  # (E,), a_ij = a_ji > 0
    leader_weight: Array  # (N,), a_il >= 0

    @property
    def vehicles(self) -> int:
        """N."""
        return int(self.leader_weight.shape[0])

    @property
    def edges(self) -> int:
        """E."""
        return int(self.tail.shape[0])

    def map(self, convert: Callable[[Array], Array]) -> Graph:
        """The same graph with its weight arrays converted."""
        return Graph(self.tail, self.head, convert(self.weight), convert(self.leader_weight))

    @cached_property
    def degree(self) -> Array:
        """D_i = a_il + l_ii, (N,): the sum of the weights at vehicle i, (5)."""
        total = self.leader_weight.copy()
        np.add.at(total, self.tail, self.weight)
        np.add.at(total, self.head, self.weight)
        return total

    def composed_laplacian(self) -> Any:
        """L_l = L + diag(a_il) of Lemma 1, as a sparse (N, N) float matrix."""
        from scipy.sparse import coo_array

        weight = np.asarray(self.weight, dtype=float)
        diagonal = np.arange(self.vehicles)
        rows = np.concatenate([self.tail, self.head, diagonal])
        columns = np.concatenate([self.head, self.tail, diagonal])
        entries = np.concatenate([-weight, -weight, np.asarray(self.degree, dtype=float)])
        return coo_array((entries, (rows, columns)), shape=(self.vehicles, self.vehicles)).tocsr()

    def leader_tree(self) -> Indices:
        """A spanning forest rooted at the leader links, (N,): the parent of each vehicle.

        A parent of N is the leader itself; -1 marks a vehicle that no path joins to the leader, so that (A1) of the
        theorem (and with it Lemma 1) holds if and only if no entry is -1. O(N + E).
        """
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import breadth_first_order

        leader = self.vehicles
        led = np.flatnonzero(np.asarray(self.leader_weight, dtype=float))
        rows = np.concatenate([self.tail, np.full(led.shape, leader)])
        columns = np.concatenate([self.head, led])
        links = coo_array((np.ones(rows.shape), (rows, columns)), shape=(leader + 1, leader + 1))
        _, parent = breadth_first_order(links.tocsr(), leader, directed=False)
        tree: Indices = np.maximum(parent[:leader], -1).astype(np.int64)
        return tree

    def roles(self) -> Indices:
        """The role of every vehicle, (N,), numbered from 0 in file order.

        Vehicles that the weighted graph does not tell apart share a role: the coarsest equitable partition, by colour
        refinement that starts from the leader links.
        """
        met: list[list[tuple[Any, int]]] = [[] for _ in range(self.vehicles)]
        for i, j, weight in zip(self.tail.tolist(), self.head.tolist(), self.weight.tolist(), strict=True):
            met[i].append((weight, j))
            met[j].append((weight, i))
        role = _numbered(self.leader_weight.tolist())
        while True:
            finer = _numbered(
                [(role[i], *sorted((weight, role[j]) for weight, j in near)) for i, near in enumerate(met)]
            )
            if finer == role:
                return np.array(role)
            role = finer

    def ldl_pivots(self) -> list[Fraction]:
        """The pivots of the exact L D L^T of L_l; all are positive if and only if L_l > 0 (Lemma 1). O(N^3)."""
        exact = self.map(np.frompyfunc(Fraction, 1, 1))
        matrix = np.diag(exact.degree)
        np.subtract.at(matrix, (exact.tail, exact.head), exact.weight)
        np.subtract.at(matrix, (exact.head, exact.tail), exact.weight)
        pivots = []
        while matrix.size:
            pivots.append(matrix[0, 0])
            if matrix[0, 0] <= 0:
                break  # not positive definite, as the last pivot shows
            matrix = matrix[1:, 1:] - np.outer(matrix[1:, 0], matrix[0, 1:]) / matrix[0, 0]
        return pivots


def _numbered(signs: Sequence[Hashable]) -> list[int]:
    """The number of every sign, in the order in which they first appear."""
    numbers: dict[Hashable, int] = {}
    return [numbers.setdefault(sign, len(numbers)) for sign in signs]
