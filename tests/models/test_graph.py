"""The graph: Lemma 1 in its equivalent forms, exact pivots, the tree that reaches every vehicle."""

import math
from fractions import Fraction

import casadi as ca
import numpy as np
import pytest
import sympy as sp
from gaincert.models.algebra.ops import casadi_ops, numpy_ops
from gaincert.models.errors import InputError
from gaincert.models.files.fleet_file import parse
from gaincert.models.graph import Graph


def random_graph(random):
    """A graph that is connected to the leader or not, about as often."""
    n = int(random.integers(1, 9))
    pairs = [(i, j) for j in range(n) for i in range(j) if random.random() < 1.5 / n]
    random.shuffle(pairs)
    tail, head = np.array(pairs, dtype=np.int64).reshape(-1, 2).T

    def weights(count):
        return np.array([Fraction(int(w), 100) for w in random.integers(1, 500, count)], dtype=object)

    led = weights(n) * (random.random(n) < 0.5)
    return Graph(tail, head, weights(len(pairs)), np.array([Fraction(w) for w in led], dtype=object))


def dense(graph):
    """L_l of Lemma 1 by its definition, exact."""
    n = graph.vehicles
    a = sp.zeros(n, n)
    for i, j, weight in zip(graph.tail, graph.head, graph.weight, strict=True):
        a[int(i), int(j)] = a[int(j), int(i)] = sp.Rational(weight)
    return sp.diag(*(sum(a.row(i)) + sp.Rational(graph.leader_weight[i]) for i in range(n))) - a


def reached(graph):
    """The vehicles that a path joins to the leader, by repeated relaxation."""
    connected = {i for i in range(graph.vehicles) if graph.leader_weight[i] > 0}
    for _ in range(graph.vehicles):
        for i, j in zip(graph.tail, graph.head, strict=True):
            if {int(i), int(j)} & connected:
                connected |= {int(i), int(j)}
    return connected


def test_the_paper_s_graph(paper):
    assert list(paper.graph.degree) == [2, 13, 2, 13, 2, 2]
    pivots = paper.graph.ldl_pivots()
    assert pivots == [Fraction(text) for text in ("2", "25/2", "48/25", "197/16", "378/197", "20/21")]
    assert math.prod(pivots) == 1080 == dense(paper.graph).det()
    assert np.linalg.det(paper.graph.composed_laplacian().toarray()) == pytest.approx(1080)


def test_the_composed_laplacian_and_the_degree_are_5(fleet):
    expected = np.array(dense(fleet.graph), dtype=float)
    assert np.allclose(fleet.graph.composed_laplacian().toarray(), expected, rtol=1e-15)
    assert np.allclose(fleet.graph.degree.astype(float), np.diag(expected), rtol=1e-15)
    assert all(isinstance(D, Fraction) for D in fleet.graph.degree)


def test_the_pivots_are_those_of_the_exact_factorisation(fleet):
    pivots = fleet.graph.ldl_pivots()
    _, D = dense(fleet.graph).LDLdecomposition(hermitian=False)
    assert pivots == [Fraction(int(d.p), int(d.q)) for d in D.diagonal()]
    assert all(pivot > 0 for pivot in pivots)


def test_the_tree_leads_every_vehicle_to_the_leader(fleet):
    graph, n = fleet.graph, len(fleet)
    tree = graph.leader_tree()
    linked = {frozenset(pair) for pair in zip(graph.tail.tolist(), graph.head.tolist(), strict=True)}
    assert tree.shape == (n,)
    for vehicle in range(n):
        at, steps = vehicle, 0
        while at != n:
            parent = int(tree[at])
            assert graph.leader_weight[at] > 0 if parent == n else frozenset((at, parent)) in linked
            at, steps = parent, steps + 1
            assert steps <= n


def test_the_forms_of_lemma_1_are_equivalent(random):
    """Reachable leader = tree without -1 = positive pivots = positive definite = a kernel of 0 only, both ways."""
    verdicts = []
    for _ in range(150):
        graph = random_graph(random)
        tree, pivots, matrix = graph.leader_tree(), graph.ldl_pivots(), graph.composed_laplacian().toarray()
        lost = set(range(graph.vehicles)) - reached(graph)
        assert {int(i) for i in np.flatnonzero(tree == -1)} == lost
        holds = not lost
        assert (len(pivots) == graph.vehicles and min(pivots) > 0) == holds
        assert (np.linalg.eigvalsh(matrix)[0] > 1e-9) == holds
        assert (dense(graph).rank() == graph.vehicles) == holds
        verdicts.append(holds)
    assert 30 < sum(verdicts) < 120


def test_a_fleet_is_refused_exactly_where_lemma_1_fails(random):
    for _ in range(60):
        graph = random_graph(random)
        n = graph.vehicles
        edges = [[f"v{i}", f"v{j}", w] for i, j, w in zip(graph.tail, graph.head, graph.weight, strict=True)]
        keys = ("mass", "inertia", "half_track", "wheel_radius", "torque_limit")
        content = {
            "name": "random",
            "leader": {"position": [0, 0], "heading": 0},
            "graph": {"edges": edges, "leader_links": {f"v{i}": w for i, w in enumerate(graph.leader_weight) if w}},
            "vehicle": [{"name": f"v{i}", **dict.fromkeys(keys, 1), "offset": [0, 0]} for i in range(n)],
        }
        lost = sorted(set(range(n)) - reached(graph))
        if not lost:
            assert len(parse(content)) == n
            continue
        with pytest.raises(InputError) as refusal:
            parse(content)
        (line,) = refusal.value.mistakes
        assert "Lemma 1" in line
        assert all(repr(f"v{i}") in line for i in lost[:5])
        assert (f"and {len(lost) - 5} more" in line) == (len(lost) > 5)


def test_a_float_would_not_see_that_this_graph_is_singular():
    """0.1 + 0.2 - 0.3: exact arithmetic says 0."""
    weight = np.array([Fraction("0.1"), Fraction("0.2"), Fraction("0.3")])
    graph = Graph(np.array([0, 1, 2]), np.array([1, 2, 0]), weight, np.array([Fraction(0)] * 3))
    assert graph.ldl_pivots()[-1] == 0
    assert len(graph.ldl_pivots()) == 3


def test_l2_the_two_graph_verbs_are_transposes(fleet, random):
    """sum_i y_i (edge_sum f)_i = sum over edges of f (y_i - y_j): lemma L2, for an f that is not antisymmetric."""
    ops, graph = numpy_ops(), fleet.graph
    y, f = random.normal(size=(4, graph.vehicles)), random.normal(size=(4, graph.edges))
    left = (y * ops.edge_sum(graph, f)).sum(axis=-1)
    right = (f * ops.edge_difference(graph, y)).sum(axis=-1)
    assert np.allclose(left, right, atol=1e-12)
    assert np.allclose(ops.edge_sum(graph, f).sum(axis=-1), 0, atol=1e-12)


def test_the_graph_verbs_are_the_same_in_casadi(fleet, random):
    graph = fleet.plant().graph
    z, f = random.normal(size=graph.vehicles), random.normal(size=graph.edges)
    difference = casadi_ops().edge_difference(graph, ca.DM(z))
    signed_sum = casadi_ops().edge_sum(graph, ca.DM(f))
    assert np.array(difference).ravel() == pytest.approx(z[graph.tail] - z[graph.head])
    assert np.array(signed_sum).ravel() == pytest.approx(numpy_ops().edge_sum(graph, f))


def test_l_l_is_the_linear_part_of_the_consensus_error(fleet, random):
    from gaincert.models.algebra.ops import unbounded
    from gaincert.models.equations import consensus_error

    z = random.normal(size=len(fleet))
    graph = fleet.plant().graph
    linear = consensus_error(unbounded(numpy_ops()), graph, 1, z, 0.0)
    assert np.allclose(graph.composed_laplacian() @ z, linear, atol=1e-12)
    near = consensus_error(numpy_ops(), graph, 1, 1e-5 * z, 0.0)
    assert np.allclose(1e-5 * linear, near, rtol=1e-6, atol=1e-13)


def test_the_roles_of_the_paper_s_graph(paper):
    """v2 and v4 are led, v1 and v5 stand beside one of them, v3 between both, v6 opposite."""
    assert paper.graph.roles().tolist() == [0, 1, 2, 1, 0, 3]


def test_vehicles_of_one_role_see_the_same():
    """Equitable: one role has one leader link and the same weights to every role, whatever the order of the file."""
    for seed in range(60):
        random = np.random.default_rng(seed)
        graph = random_graph(random).map(lambda weights: np.ceil(weights.astype(float)))
        role = graph.roles()
        seen = [(graph.leader_weight[i], seen_by(graph, role, i)) for i in range(graph.vehicles)]
        for i, j in np.argwhere(role[:, None] == role):
            assert seen[i] == seen[j]
        order = random.permutation(graph.vehicles)  # vehicle i becomes vehicle order[i]
        moved = Graph(order[graph.tail], order[graph.head], graph.weight, graph.leader_weight[np.argsort(order)])
        again = moved.roles()[order]
        assert ((role[:, None] == role) == (again[:, None] == again)).all()


def test_roles_tell_apart_no_more_than_they_must():
    """Without leader links a ring and a complete graph have one role; one led vehicle splits a ring by distance."""
    ring = Graph(np.arange(6), np.roll(np.arange(6), -1), np.ones(6), np.zeros(6))
    assert ring.roles().tolist() == [0] * 6
    led = Graph(ring.tail, ring.head, ring.weight, np.eye(6)[0])
    assert led.roles().tolist() == [0, 1, 2, 3, 2, 1]


def seen_by(graph, role, i):
    """The weights of the edges of vehicle i with the role at the other end, sorted."""
    ends = zip(graph.tail, graph.head, graph.weight, strict=True)
    return sorted((weight, role[j if i == k else k]) for k, j, weight in ends if i in (k, j))
