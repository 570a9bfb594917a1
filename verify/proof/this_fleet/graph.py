"""(A1) and kappa_cut = min over vehicle sets S of a_l(S) + cut(S), the least cut of the graph with its leader.

Every cut of that graph has one side without the leader, which is such an S. The least of the maximal flows from the
leader to each vehicle is its value; both a set S with that cut and a flow of that value to every vehicle are checked
anew, and for few vehicles all sets are enumerated.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from fractions import Fraction
from itertools import chain, combinations
from typing import NamedTuple

import numpy as np

from ....models.graph import Graph
from ..claim import Claim, Kind, Relation
from ..method.inferences import compared
from ..method.symbols import symbol

EXACT_VEHICLES = 64  # beyond this kappa_cut is enclosed, not computed
ENUMERATED_VEHICLES = 10  # up to this all sets of vehicles are tried, too

Weights = list[dict[int, Fraction]]  # symmetric adjacency; the last node is the leader


class Flow(NamedTuple):
    """A flow from the leader to a vehicle and the vehicles that it cannot reach any more."""

    value: Fraction
    edges: list[dict[int, Fraction]]
    beyond: frozenset[int]


def assumption_1(graph: Graph) -> Claim:
    """(A1): weights are positive and every vehicle hears the leader over some path."""
    lost, edge, led = symbol("vehicles_without_path"), symbol("a", "min"), symbol("a", "lmin")
    values = {
        lost: int(np.sum(graph.leader_tree() < 0)),
        edge: min([*graph.weight, Fraction(1)]),
        led: min(graph.leader_weight),
    }
    wanted = Relation(lost, "=", 0), Relation(edge, ">", 0), Relation(led, ">=", 0)
    return Claim("A1", Kind.FLEET, tuple(compared(relation, values) for relation in wanted))


def kappa(graph: Graph) -> Claim:
    """kappa_cut > 0: exact for small fleets, enclosed for large ones."""
    cut = symbol("kappa_cut")
    if graph.vehicles > EXACT_VEHICLES:
        low, high = symbol("kappa_low"), symbol("kappa_high")
        values = {low: tree_bound(graph), high: min(graph.degree)}
        wanted = [Relation(low, ">", 0), Relation(low, "<=", high)]
    else:
        value, beyond = least_cut(graph)
        at_s, fed, vehicles = symbol("cut_of_S"), symbol("vehicles_fed"), symbol("N")
        values = {cut: value, at_s: cut_weight(graph, beyond), vehicles: graph.vehicles}
        values[fed] = sum(supports_flow(graph, vehicle, value) for vehicle in range(graph.vehicles))
        wanted = [Relation(cut, ">", 0), Relation(at_s, "=", cut), Relation(fed, "=", vehicles)]
    if graph.vehicles <= ENUMERATED_VEHICLES:
        least = symbol("least_of_all_sets")
        values[least] = enumerated_cut(graph)
        wanted.append(Relation(least, "=", cut))
    return Claim("kappa-cut", Kind.FLEET, tuple(compared(relation, values) for relation in wanted))


def cut_weight(graph: Graph, chosen: Iterable[int]) -> Fraction:
    """a_l(S) + cut(S)."""
    inside = set(chosen)
    edges = zip(graph.tail.tolist(), graph.head.tolist(), graph.weight, strict=True)
    across = (w for i, j, w in edges if (i in inside) != (j in inside))
    return sum((*across, *(graph.leader_weight[i] for i in inside)), Fraction(0))


def enumerated_cut(graph: Graph) -> Fraction:
    """kappa_cut by trying every set of vehicles."""
    vehicles = range(graph.vehicles)
    sets = chain.from_iterable(combinations(vehicles, size) for size in range(1, graph.vehicles + 1))
    return min(cut_weight(graph, chosen) for chosen in sets)


def least_cut(graph: Graph) -> tuple[Fraction, frozenset[int]]:
    """kappa_cut and a set of vehicles that has it: the least of the maximal flows from the leader to each vehicle."""
    flows = (maximal_flow(with_leader(graph), vehicle) for vehicle in range(graph.vehicles))
    least = min(flows, key=lambda flow: flow.value)
    return least.value, least.beyond


def with_leader(graph: Graph) -> Weights:
    """The adjacency of vehicles 0..N-1 and the leader N, in exact rationals."""
    nodes: Weights = [{} for _ in range(graph.vehicles + 1)]
    for i, j, w in _links(graph):
        nodes[i][j] = nodes[i].get(j, Fraction(0)) + w
        nodes[j][i] = nodes[j].get(i, Fraction(0)) + w
    return nodes


def _links(graph: Graph) -> list[tuple[int, int, Fraction]]:
    """Edges and leader links, the leader as node N."""
    links = [(int(i), int(j), Fraction(w)) for i, j, w in zip(graph.tail, graph.head, graph.weight, strict=True)]
    return links + [(i, graph.vehicles, Fraction(w)) for i, w in enumerate(graph.leader_weight) if w]


def maximal_flow(weights: Weights, target: int, most: Fraction | None = None) -> Flow:
    """A flow from the leader to a vehicle along shortest augmenting paths, up to `most` where that is given."""
    source, value = len(weights) - 1, Fraction(0)
    flow: list[dict[int, Fraction]] = [dict.fromkeys(row, Fraction(0)) for row in weights]
    while most is None or value < most:
        came = _reached(weights, flow, source)
        if target not in came:
            break
        path, node = [], target
        while node != source:
            path.append((came[node], node))
            node = came[node]
        room = [weights[i][j] - flow[i][j] for i, j in path]
        step = min(room if most is None else [*room, most - value])
        for i, j in path:
            flow[i][j] += step
            flow[j][i] -= step
        value += step
    return Flow(value, flow, frozenset(range(source)) - _reached(weights, flow, source).keys())


def _reached(weights: Weights, flow: list[dict[int, Fraction]], source: int) -> dict[int, int]:
    """The nodes that more can flow to, each with the node that it comes from; breadth first."""
    came, queue = {source: source}, deque([source])
    while queue:
        i = queue.popleft()
        for j, capacity in weights[i].items():
            if j not in came and flow[i][j] < capacity:
                came[j] = i
                queue.append(j)
    return came


def supports_flow(graph: Graph, target: int, value: Fraction) -> bool:
    """Whether `value` can flow from the leader to a vehicle; the flow is checked for capacity and conservation."""
    weights = with_leader(graph)
    return carries(weights, maximal_flow(weights, target, value).edges, target, value)


def carries(weights: Weights, flow: Weights, target: int, value: Fraction) -> bool:
    """Whether a flow brings `value` from the leader to a vehicle, within the weights and without loss."""
    source = len(weights) - 1
    within = all(f <= weights[i][j] and flow[j][i] == -f for i, row in enumerate(flow) for j, f in row.items())
    excess = [sum(row.values(), Fraction(0)) for row in flow]
    balanced = all(e == 0 for i, e in enumerate(excess) if i not in (source, target))
    return within and balanced and excess[source] == value and excess[target] == -value


def tree_bound(graph: Graph) -> Fraction:
    """A lower bound of kappa_cut in O(N log N + E): every cut meets the leader's spanning tree of largest weights.

    Kruskal's tree has the largest least edge of all spanning trees; 0 where no spanning tree exists.
    """
    parent = list(range(graph.vehicles + 1))

    def root(i: int) -> int:
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    joined, least = 0, Fraction(0)
    for w, i, j in sorted(((w, i, j) for i, j, w in _links(graph)), reverse=True):
        a, b = root(i), root(j)
        if a != b:
            parent[a], joined, least = b, joined + 1, w
    return least if joined == graph.vehicles else Fraction(0)
