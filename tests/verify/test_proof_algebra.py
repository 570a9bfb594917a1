"""The algebra under the proof checker: normal form, balls, signs, minimum cuts, exact facts about psi."""

import random
from fractions import Fraction
from itertools import chain, combinations

import numpy as np
import pytest
import sympy as sp
from gaincert.models.algebra.log_cosh import log_cosh
from gaincert.models.arrays import column
from gaincert.models.excitation import Excitation
from gaincert.models.graph import Graph
from gaincert.models.paper import paper_excitation, paper_fleet
from gaincert.verify.proof.claim import Relation, Status
from gaincert.verify.proof.method.ball import evaluate, precise
from gaincert.verify.proof.method.fleet_symbols import generic, generic_physical, generic_unit
from gaincert.verify.proof.method.normal_form import equal, majorant, normal_form
from gaincert.verify.proof.method.rules import ordered
from gaincert.verify.proof.this_fleet.excitation import assumption_3, rate_power, variance, window_number
from gaincert.verify.proof.this_fleet.graph import (
    assumption_1,
    cut_weight,
    enumerated_cut,
    kappa,
    least_cut,
    supports_flow,
    tree_bound,
)

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


def test_what_has_a_sum_below_the_line_is_kept():
    assert normal_form(1 / (1 + x)) == 1 / (1 + x)
    assert majorant(y / (1 + x), {}) == sp.Abs(y) / sp.Abs(1 + x)


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
    assert ordered(b, "<=", a, (Relation(a, ">=", b),)).holds is True
    wrong = ordered(b, "<=", a)
    assert wrong.holds is False
    assert wrong.witness
    assert ordered(0, "<=", (a - b) ** 2 + 1).holds is None  # true, and beyond sign patterns: undecided


def test_hypotheses_become_true_by_construction():
    a, b = sp.symbols("a b", positive=True)
    assert ordered(a * x, "<=", a * b, (Relation(sp.Abs(x), "<=", b),)).holds is True
    assert ordered(a * x, "<=", a * b).holds is False
    with pytest.raises(ValueError, match="may be negative"):
        ordered(a * x, "<=", a * b, (Relation(x, "<=", b),))


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
    exact = brute_force_cut(graph)
    value, beyond = least_cut(graph)
    assert value == enumerated_cut(graph) == exact
    assert cut_weight(graph, beyond) == exact
    assert all(supports_flow(graph, i, exact) for i in range(graph.vehicles))
    assert not all(supports_flow(graph, i, exact + 1) for i in range(graph.vehicles))
    assert tree_bound(graph) <= exact
    assert (tree_bound(graph) > 0) == (exact > 0) == (assumption_1(graph).status is Status.PROVED)
    assert kappa(graph).status is (Status.PROVED if exact > 0 else Status.REFUTED)


def values(claim, letter):
    """The numbers that a claim compares for a letter."""
    return next(fact.values for fact in claim.facts if str(fact.left) == letter)


def test_kappa_of_the_paper_and_of_a_large_ring():
    assert values(kappa(paper_fleet().graph), "kappa_cut")[0] == "2"
    n = 500
    index = np.arange(n)
    ring = Graph(index, (index + 1) % n, column([Fraction(1)] * n), column([Fraction(1), *[Fraction(0)] * (n - 1)]))
    assert [fact.values for fact in kappa(ring).facts] == [("1", ">", "0"), ("1", "<=", "2")]


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


@pytest.mark.parametrize("seed", range(5))
def test_numbers_of_random_excitations_are_computed_twice(seed):
    rng = np.random.default_rng(seed)
    sin, cos = (tuple(Fraction(int(k), 8) for k in rng.integers(-8, 9, 3)) for _ in range(2))
    psi = Excitation(Fraction(1, 2), Fraction(3, 4), (*sin, Fraction(1)), cos)
    assert assumption_3(psi).status is Status.PROVED
    assert window_number(psi).status is Status.PROVED


def test_a_bound_of_psi_that_is_too_small_or_too_large_is_refuted(monkeypatch):
    psi = paper_excitation()
    for factor in (Fraction(999, 1000), Fraction(1001, 1000)):
        monkeypatch.setitem(vars(psi), "bound", psi.bound)
        vars(psi)["bound"] = psi.bound * factor
        assert assumption_3(psi).status is Status.REFUTED
        monkeypatch.undo()
        psi = paper_excitation()


@pytest.mark.parametrize("fleet", [generic(), generic_unit(), generic_physical()], ids=["scaled", "unit", "physical"])
def test_exchanging_the_vehicles_twice_changes_nothing(fleet):
    for name in ("v", "omega"):
        here, there = getattr(fleet.closed_loop, name)
        assert equal(fleet.exchange(here), there)
        assert equal(fleet.exchange(fleet.exchange(here)), here)
