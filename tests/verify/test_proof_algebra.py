"""The algebra under the proof checker: normal form, balls, signs, minimum cuts, exact facts about psi."""

import random
from fractions import Fraction
from itertools import chain, combinations

import numpy as np
import pytest
import sympy as sp
from flint import arb
from gaincert.models.algebra.log_cosh import log_cosh
from gaincert.models.arrays import column
from gaincert.models.excitation import Excitation
from gaincert.models.graph import Graph
from gaincert.models.paper import paper_excitation, paper_fleet
from gaincert.verify.proof.ball import evaluate, precise
from gaincert.verify.proof.claim import Status
from gaincert.verify.proof.excitation_facts import rate_power, telescopes, variance
from gaincert.verify.proof.fleet_facts import assumption_1, kappa
from gaincert.verify.proof.generic_fleet import generic
from gaincert.verify.proof.mincut import global_minimum_cut, supports_flow, tree_bound, with_leader
from gaincert.verify.proof.normal_form import equal, majorant, normal_form
from gaincert.verify.proof.signs import counterexample, nonnegative

x, y, p = sp.symbols("x y p", real=True)


@pytest.mark.parametrize(
    ("left", "right"),
    [
        (sp.sech(x) ** 2, 1 - sp.tanh(x) ** 2),
        (sp.sin(x) ** 4, (1 - sp.cos(x) ** 2) ** 2),
        (sp.tanh(x - y) + sp.tanh(y - x), 0),
        (sp.diff(log_cosh(x - y), y), -sp.tanh(x - y)),
        ((x + y) ** 2 / p, (x**2 + 2 * x * y + y**2) / p),
        (1 / (1 + x) - 1, -x / (1 + x)),
    ],
)
def test_normal_form_decides_identities(left, right):
    assert equal(left, right)


@pytest.mark.parametrize("wrong", [sp.sech(x) ** 2 - 1 - sp.tanh(x) ** 2, sp.sin(x) ** 2 + sp.cos(x), sp.tanh(x) - x])
def test_normal_form_keeps_what_is_not_zero(wrong):
    assert normal_form(wrong) != 0


def test_odd_powers_of_sech_are_refused():
    with pytest.raises(ValueError, match="odd power"):
        normal_form(sp.sech(x))


def test_majorant_is_the_triangle_inequality():
    a, b = sp.symbols("a b", positive=True)
    assert majorant(a * sp.tanh(x) - b * sp.sin(y), {sp.tanh(x): 1, sp.sin(y): 1}) == a + b


def test_fold_and_unfold_are_inverse():
    g = generic()
    for rate in (*g.closed_loop.v, *g.closed_loop.omega):
        folded = g.fold(rate)
        assert not folded.free_symbols & set(g.state.x)
        assert equal(g.unfold(folded), rate)


def test_balls_contain_the_value():
    with precise():
        value = evaluate(sp.sqrt(2) * sp.tanh(x) + sp.pi * sp.Abs(y), {x: Fraction(1), y: Fraction(-1, 3)})
    assert abs(float(value) - (2**0.5 * np.tanh(1) + np.pi / 3)) < 1e-12
    assert value.rad() < 1e-60


def test_signs_prove_and_refute():
    a, b = sp.symbols("a b", positive=True)
    assert nonnegative(a - b, {a: b + sp.Symbol("s", nonnegative=True)})
    assert not nonnegative(a - b, {})
    assert counterexample(a - b, {}) is not None
    assert counterexample((a - b) ** 2 + 1, {}) is None


def brute_force_cut(graph: Graph) -> Fraction:
    n = graph.vehicles
    edges = list(zip(graph.tail, graph.head, graph.weight, strict=True))
    subsets = chain.from_iterable(combinations(range(n), k) for k in range(1, n + 1))
    return min(
        sum((graph.leader_weight[i] for i in s), Fraction(0))
        + sum((w for i, j, w in edges if (i in s) != (j in s)), Fraction(0))
        for s in map(set, subsets)
    )


def random_graph(seed: int) -> Graph:
    rng = random.Random(seed)  # noqa: S311 -- test data
    n = rng.randint(1, 8)
    edges = [(i, j) for i in range(n) for j in range(i) if rng.random() < 0.5]
    tail, head = (np.array([e[k] for e in edges], dtype=np.int64) for k in (0, 1))
    return Graph(
        tail,
        head,
        column(Fraction(rng.randint(1, 9), 4) for _ in edges),
        column(Fraction(rng.randint(0, 3)) for _ in range(n)),
    )


@pytest.mark.parametrize("seed", range(40))
def test_minimum_cut_against_enumeration(seed):
    graph = random_graph(seed)
    weights, exact = with_leader(graph), brute_force_cut(graph)
    assert global_minimum_cut(weights) == exact
    assert all(supports_flow(weights, i, exact) for i in range(graph.vehicles))
    assert not all(supports_flow(weights, i, exact + 1) for i in range(graph.vehicles))
    assert tree_bound(graph) <= exact
    assert (tree_bound(graph) > 0) == (exact > 0) == (assumption_1(graph).status is Status.PROVED)


def test_kappa_of_the_paper_and_of_a_large_ring():
    assert "kappa_cut = 2" in kappa(paper_fleet().graph).reason
    n = 500
    index = np.arange(n)
    ring = Graph(index, (index + 1) % n, column([Fraction(1)] * n), column([Fraction(1), *[Fraction(0)] * (n - 1)]))
    assert "1 <= kappa_cut <= 2" in kappa(ring).reason


def test_excitation_facts_of_the_paper():
    psi = paper_excitation()
    assert rate_power(psi, Fraction(1)) == (Fraction(20), -1)
    assert rate_power(psi, 2 * Fraction(1)) == psi.power()
    assert rate_power(psi, Fraction(1, 2)) is None
    squares = sum(Fraction(1, (2 * k - 1) ** 2) for k in range(1, 6))
    assert variance(psi) == (32 * squares, -1)


def test_variance_by_quadrature():
    psi = Excitation(Fraction(1, 3), Fraction(2), (Fraction(1), Fraction(1, 2)), (Fraction(0), Fraction(1, 5)))
    t = np.linspace(0, np.pi, 20001)[:-1]
    value = 1 / 3 + np.sin(2 * t) + 0.5 * np.sin(4 * t) + 0.2 * np.cos(4 * t)
    q, j = variance(psi)
    assert abs(float(q) * np.pi**j - value.var() * np.pi) < 1e-9


@pytest.mark.parametrize("terms", range(1, 8))
def test_telescoping_sum(terms):
    assert telescopes(terms)
    with precise():
        u = arb("0.7")
        total = sum(((2 * k - 1) * u).cos() for k in range(1, terms + 1))
        assert abs(2 * u.sin() * total - (2 * terms * u).sin()) < arb("1e-60")
