"""Designs the weights a_ij, a_il on the given edges: the largest slowest mode of the degree-normalised L_l."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np

from ...models.errors import UndecidedError
from ...models.fleet import Fleet
from ...models.fleet_tables import Links
from ..rounding import decimal_places
from ..settings import FAST
from .solvers import clarabel_finds_optimum

SPREAD = 10.0  # a weight may be divided or multiplied by this
LARGEST = 1.01 * SPREAD  # a weight beyond it is wrong, whatever Clarabel reports
BISECTIONS = 12
DIGITS = 3  # significant digits of a weight
DENSE_VEHICLES = 150  # above this size the semidefinite program takes too long


def design_weights(fleet: Fleet, seconds: float = FAST.clarabel_seconds) -> Links:
    """The links with weights, each within SPREAD of the given one, that maximise lambda_min(D^-1/2 L_l D^-1/2).

    The slowest mode sets the tail and the exponential rates (docs/theory.md 7); scaling all weights together changes
    nothing if the gains are designed for them. For a fixed lambda, L_l - lambda D >= 0 is linear in the weights: a
    bisection on semidefinite programs of at most `seconds` each. Raises UndecidedError if the fleet is too large or
    Clarabel finds nothing.
    """
    if len(fleet) > DENSE_VEHICLES:
        raise UndecidedError(
            f"weights = designed: the fleet has {len(fleet)} vehicles, the program takes up to {DENSE_VEHICLES}; "
            "use given weights"
        )
    low, high, best = 0.0, 1.0, None
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        found = _weights(fleet, middle, seconds)
        low, high, best = (low, middle, best) if found is None else (middle, high, found)
    if best is None:
        raise UndecidedError("weights = designed: Clarabel found no weights that it calls optimal; use given weights")
    return _links(fleet, *best)


def _weights(fleet: Fleet, slowest: float, seconds: float) -> tuple[Any, Any] | None:
    """(edge weights, leader weights) with lambda_min >= slowest, None if not possible."""
    import cvxpy as cp

    graph = fleet.graph.map(lambda column: np.asarray(column, dtype=float))
    count, edges = graph.vehicles, graph.edges
    led = np.flatnonzero(graph.leader_weight)
    incidence = np.zeros((count, edges))
    incidence[graph.tail, np.arange(edges)], incidence[graph.head, np.arange(edges)] = 1.0, -1.0
    leads = np.eye(count)[:, led]
    edge, leader, room = cp.Variable(edges), cp.Variable(len(led)), cp.Variable()
    degree = np.abs(incidence) @ edge + leads @ leader
    composed = incidence @ cp.diag(edge) @ incidence.T + leads @ cp.diag(leader) @ leads.T
    constraints = [composed - slowest * cp.diag(degree) >> room * np.eye(count)]
    for weight, given in ((edge, graph.weight), (leader, graph.leader_weight[led])):
        constraints += [weight >= given / SPREAD, weight <= given * SPREAD]
    problem = cp.Problem(cp.Maximize(room), constraints)
    if not clarabel_finds_optimum(problem, seconds) or room.value < 0:
        return None
    pairs = ((edge.value, graph.weight), (leader.value, graph.leader_weight[led]))
    within = all(np.all((weight > given / LARGEST) & (weight < given * LARGEST)) for weight, given in pairs)
    return (edge.value, leader.value) if within else None


def _links(fleet: Fleet, edge: Any, leader: Any) -> Links:
    """The weights, rounded, on the fleet's own links. Rounding cannot disconnect: no weight becomes 0."""
    led = [name for name in fleet.names if fleet.links.leader_links.get(name, Fraction(0))]
    rounded = [decimal_places(float(weight), DIGITS) for weight in (*edge, *leader)]
    ends = [(a, b) for a, b, _ in fleet.links.edges]
    return Links(
        edges=tuple((a, b, weight) for (a, b), weight in zip(ends, rounded[: len(ends)], strict=True)),
        leader_links=dict(zip(led, rounded[len(ends) :], strict=True)),
    )
