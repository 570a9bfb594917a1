"""The tree that joins every vehicle to the leader, (A1), and the weights that were designed for its links."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...models.errors import InputError
from ...models.fleet_content import fixed_point
from ...models.graph import Graph

Indices = NDArray[np.int64]


def tree(own: Graph, used: Graph) -> dict[str, str]:
    """For every vehicle the link to the one before it, by its place among the fleet's sorted edges, and its depth.

    The link is -1 for the leader. `own` has the fleet's links, `used` those of them that are used.
    """
    n, parents = own.vehicles, used.leader_tree()
    links = np.searchsorted(np.sort(codes(own)), pair_codes(np.arange(n), np.minimum(parents, n - 1), n))
    links = np.where(parents == n, -1, links)
    return {"link": " ".join(map(str, links.tolist())), "depth": " ".join(map(str, depths(parents.tolist())))}


def depths(parents: list[int]) -> list[int]:
    """How many links away the leader is, minus one; a parent of N or beyond is the leader."""
    depth = [-1] * len(parents)
    for vehicle in range(len(parents)):
        path = [vehicle]
        while depth[path[-1]] < 0 and 0 <= parents[path[-1]] < len(parents):
            path.append(parents[path[-1]])
        base = max(depth[path[-1]], 0)
        for steps, member in enumerate(reversed(path)):
            depth[member] = base + steps
    return depth


def designed_weights(own: Graph, used: Graph) -> dict[str, str]:
    """The used weight of each of the fleet's links, sorted; 0 where a link is not used.

    Raises InputError for a link that the fleet does not have.
    """
    order = np.argsort(codes(own))
    weights = dict(zip(codes(used).tolist(), used.weight, strict=True))
    columns = [weights.pop(code, 0) for code in codes(own)[order].tolist()]
    led = np.flatnonzero(own.leader_weight.astype(bool))
    if weights or np.any(np.delete(used.leader_weight, led)):
        raise InputError("links: the designed weights are on links that the fleet does not have; design them again")
    return {"edges": fixed_point(columns), "leader_links": fixed_point(used.leader_weight[led])}


def codes(graph: Graph) -> Indices:
    """A number for every edge, in the order in which edges are sorted, (E,)."""
    return pair_codes(graph.tail, graph.head, graph.vehicles)


def pair_codes(one: Indices, other: Indices, n: int) -> Indices:
    """The same for pairs of vehicles."""
    found: Indices = np.minimum(one, other) * n + np.maximum(one, other)
    return found
