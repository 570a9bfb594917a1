"""kappa_cut = min over nonempty vehicle sets S of a_l(S) + cut(S), exactly: the least cut with the leader as a node.

Every cut of the graph with the leader node has one side without the leader, which is such an S. Stoer and Wagner's
algorithm finds the least cut in exact rationals; max-flow duality confirms it: a flow of that value from the leader to
every vehicle, each checked for capacity and conservation, shows that no cut is smaller.
"""

from __future__ import annotations

from collections import deque
from fractions import Fraction
from typing import Any

from ...models.graph import Graph

Weights = list[dict[int, Fraction]]  # symmetric adjacency; the last node is the leader


def with_leader(graph: Graph) -> Weights:
    """The adjacency of vehicles 0..N-1 and the leader N, in exact rationals."""
    nodes: Weights = [{} for _ in range(graph.vehicles + 1)]
    links = [(int(i), int(j), w) for i, j, w in zip(graph.tail, graph.head, graph.weight, strict=True)]
    links += [(i, graph.vehicles, w) for i, w in enumerate(graph.leader_weight) if w]
    for i, j, w in links:
        nodes[i][j] = nodes[i].get(j, Fraction(0)) + Fraction(w)
        nodes[j][i] = nodes[j].get(i, Fraction(0)) + Fraction(w)
    return nodes


def global_minimum_cut(weights: Weights) -> Fraction:
    """Stoer-Wagner: each phase orders the nodes by attraction and merges the last two."""
    nodes = {i: dict(row) for i, row in enumerate(weights)}
    best: Fraction | None = None
    while len(nodes) > 1:
        before, last, cut = _phase(nodes)
        best = cut if best is None else min(best, cut)
        _merge(nodes, before, last)
    return best or Fraction(0)


def _phase(nodes: dict[int, dict[int, Fraction]]) -> tuple[int, int, Fraction]:
    order = [next(iter(nodes))]
    pull = {i: nodes[order[0]].get(i, Fraction(0)) for i in nodes if i != order[0]}
    cut = Fraction(0)
    while pull:
        chosen = max(pull, key=lambda i: pull[i])
        cut = pull.pop(chosen)
        order.append(chosen)
        for j, w in nodes[chosen].items():
            if j in pull:
                pull[j] += w
    return order[-2], order[-1], cut


def _merge(nodes: dict[int, dict[int, Fraction]], keep: int, gone: int) -> None:
    for j, w in nodes.pop(gone).items():
        nodes[j].pop(gone, None)
        if j != keep:
            nodes[keep][j] = nodes[keep].get(j, Fraction(0)) + w
            nodes[j][keep] = nodes[keep][j]


def supports_flow(weights: Weights, target: int, value: Fraction) -> bool:
    """Whether `value` can flow from the leader to the target: augmenting paths, then the flow itself is checked."""
    source = len(weights) - 1
    flow: list[dict[int, Fraction]] = [{} for _ in weights]
    sent = Fraction(0)
    while sent < value:
        path = _augmenting_path(weights, flow, source, target)
        if path is None:
            return False
        step = min([value - sent, *(weights[i][j] - flow[i].get(j, Fraction(0)) for i, j in path)])
        for i, j in path:
            flow[i][j] = flow[i].get(j, Fraction(0)) + step
            flow[j][i] = -flow[i][j]
        sent += step
    return _is_flow(weights, flow, source, target, value)


def _augmenting_path(weights: Weights, flow: Any, source: int, target: int) -> list[tuple[int, int]] | None:
    came: dict[int, int] = {source: source}
    queue = deque([source])
    while queue and target not in came:
        i = queue.popleft()
        for j, capacity in weights[i].items():
            if j not in came and flow[i].get(j, Fraction(0)) < capacity:
                came[j] = i
                queue.append(j)
    if target not in came:
        return None
    path, node = [], target
    while node != source:
        path.append((came[node], node))
        node = came[node]
    return path[::-1]


def _is_flow(weights: Weights, flow: Any, source: int, target: int, value: Fraction) -> bool:
    within = all(
        f <= weights[i][j] and flow[j].get(i, Fraction(0)) == -f for i, row in enumerate(flow) for j, f in row.items()
    )
    excess = [sum(row.values(), Fraction(0)) for row in flow]
    balanced = all(e == 0 for i, e in enumerate(excess) if i not in (source, target))
    return within and balanced and excess[source] == value and excess[target] == -value


def tree_bound(graph: Graph) -> Fraction:
    """A lower bound of kappa_cut in O(N log N + E): every cut meets the leader's spanning tree of largest weights.

    Kruskal's tree has the largest least edge of all spanning trees; 0 where no spanning tree exists.
    """
    links = [(Fraction(w), int(i), int(j)) for i, j, w in zip(graph.tail, graph.head, graph.weight, strict=True)]
    links += [(Fraction(w), i, graph.vehicles) for i, w in enumerate(graph.leader_weight) if w]
    parent = list(range(graph.vehicles + 1))

    def root(i: int) -> int:
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    joined, least = 0, Fraction(0)
    for w, i, j in sorted(links, reverse=True):
        a, b = root(i), root(j)
        if a != b:
            parent[a], joined, least = b, joined + 1, w
    return least if joined == graph.vehicles else Fraction(0)
