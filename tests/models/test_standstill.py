"""Where friction may stop a fleet: every vehicle's pull equals its friction there, and no standstill is farther."""

import numpy as np
import pytest
from gaincert.models.algebra.ops import numpy_ops
from gaincert.models.arrays import floats
from gaincert.models.equations import consensus_error
from gaincert.models.graph import Graph
from gaincert.models.standstill import farthest_standstill


def pulls(graph, z):
    return consensus_error(numpy_ops(), graph.map(floats), 1.0, z, 0.0)


def some_friction(graph, random):
    """(friction, the errors at which the pulls are equal to it): errors of all signs of curvature, up to 0.2."""
    z = np.linalg.solve(graph.map(floats).composed_laplacian().toarray(), random.uniform(0.2, 1, graph.vehicles))
    z *= 0.2 / z.max()
    friction = pulls(graph, z)
    assert (friction > 0).all()
    return friction, z


def test_pulls_equal_friction_there(fleet, random):
    friction, z = some_friction(fleet.graph, random)
    assert farthest_standstill(fleet.graph, friction) == pytest.approx(z, rel=1e-6)


def test_no_standstill_is_farther(fleet, random):
    """Whatever pulls up to friction hold the vehicles, in either direction, they are nearer."""
    friction, farthest = some_friction(fleet.graph, random)
    laplacian = fleet.graph.map(floats).composed_laplacian().toarray()
    held = 0
    for _ in range(20):
        z = np.linalg.solve(laplacian, random.uniform(-1, 1, len(fleet)) * friction)
        if np.all(np.abs(pulls(fleet.graph, z)) <= friction):
            held += 1
            assert np.all(np.abs(z) <= farthest)
    assert held > 5


def test_one_vehicle():
    alone = Graph(np.array([], int), np.array([], int), np.array([]), np.array([2.0]))
    assert farthest_standstill(alone, np.array([1.0])) == pytest.approx([np.arctanh(0.5)])
    assert farthest_standstill(alone, np.array([2.5])) == pytest.approx([np.inf])
    assert farthest_standstill(alone, np.array([np.inf])) == pytest.approx([np.inf])
    assert farthest_standstill(alone, np.array([0.0])) == pytest.approx([0.0])


def test_errors_add_up_along_a_line_with_one_led_vehicle():
    """The link to the leader carries all frictions, the next one all but the first, and so on."""
    line = Graph(np.arange(3), np.arange(1, 4), np.ones(3), np.array([1.0, 0, 0, 0]))
    shares = np.arctanh([0.8, 0.6, 0.4, 0.2])
    assert farthest_standstill(line, np.full(4, 0.2)) == pytest.approx(np.cumsum(shares))
    assert farthest_standstill(line, np.full(4, 0.26)) == pytest.approx([np.inf] * 4)
