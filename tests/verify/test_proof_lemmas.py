"""The lemmas' inequalities tried on random states in floating point: a net under the words between the checks."""

from fractions import Fraction

import numpy as np
import pytest
from gaincert.models import energy
from gaincert.models.algebra.ops import numpy_ops
from gaincert.models.equations import State, closed_loop, consensus_errors
from gaincert.models.paper import paper_excitation, paper_fleet, paper_gains
from gaincert.models.saturation import Saturation
from gaincert.verify.proof.mincut import global_minimum_cut, with_leader
from gaincert.verify.proof.witness_runs import small_fleet, undamped_gains

OPS = numpy_ops()
CASES = [(paper_fleet(), paper_gains(), paper_excitation())]
CASES += [(fleet := small_fleet(n), undamped_gains(fleet, fleet.psi), fleet.psi) for n in (1, 2, 5)]


@pytest.fixture(params=CASES, ids=lambda case: case[0].name)
def case(request):
    fleet, gains, psi = request.param
    return fleet, fleet.plant(), gains.map(lambda g: np.asarray(g, dtype=float)), psi


def states(plant, count, scale=3.0):
    rng = np.random.default_rng(7)
    for k in range(count):
        spread = scale * 4.0 ** -(k % 4)
        x, y, theta, v, omega = spread * rng.standard_normal((5, plant.m.size))
        yield State(
            x + plant.offset_x + plant.leader_x,
            y + plant.offset_y + plant.leader_y,
            theta + plant.leader_theta,
            v,
            omega,
        )


def bounds(psi):
    return float(psi.bound), *(float(b) for b in psi.derivative_bounds)


def test_l1_rates(case):
    _, plant, gains, psi = case
    D, psi0 = plant.graph.degree, bounds(psi)[0]
    c = np.sqrt(2) * gains.k_alpha * psi0 * D
    for t, state in enumerate(states(plant, 40)):
        rate = closed_loop(OPS, plant, gains, psi.value(OPS, float(t)), state)
        assert (np.abs(rate.v) < (np.sqrt(2) * gains.p_v * D + gains.d_v) / plant.m).all()
        assert (np.abs(rate.omega) < (gains.p_omega * D + gains.d_omega + c) / plant.inertia).all()


def what(plant, gains, psi, t, state):
    return energy.modified(OPS, plant, gains, psi.value(OPS, t), psi.derivative().value(OPS, t), state)


def what_rate(plant, gains, psi, t, state, h=1e-5):
    """The central difference of What along the flow, to second order in h."""
    slope = closed_loop(OPS, plant, gains, psi.value(OPS, t), state)
    ahead, behind = (State(*(a + s * h * b for a, b in zip(state, slope, strict=True))) for s in (1, -1))
    return (what(plant, gains, psi, t + h, ahead) - what(plant, gains, psi, t - h, behind)) / (2 * h)


def g_coefficients(plant, gains, psi):
    psi0, psi1, psi2 = bounds(psi)
    graph = plant.graph
    push = gains.k_alpha * psi0 / gains.p_omega
    own = gains.k_alpha / gains.p_omega * ((plant.m * psi2 + gains.d_v * psi1) / gains.p_v + psi0 * graph.degree)
    np.add.at(own, graph.tail, graph.weight * push[graph.head])
    np.add.at(own, graph.head, graph.weight * push[graph.tail])
    return own


def test_l6_and_l7(case):
    fleet, plant, gains, psi = case
    g = g_coefficients(plant, gains, psi)
    for t, state in enumerate(states(plant, 40)):
        rate = what_rate(plant, gains, psi, float(t), state)
        p_w = energy.rotational_dissipation(OPS, gains, state)
        p_v = energy.translational_dissipation(OPS, gains, state)
        slack = 1e-5 * (1 + abs(rate))
        assert rate <= -p_w + (g * np.abs(state.v)).sum() + slack
        for s in (0.1, 10.0):
            K = (g * gains.p_v / (gains.d_v * np.tanh(s / (len(fleet) * g)))).max()
            assert rate - (K + 1) * p_v <= -(p_w + p_v) + s + slack


def test_l8(case):
    _, plant, gains, psi = case
    psi0, psi1, _ = bounds(psi)
    c = np.sqrt(2) * gains.k_alpha * psi0 * plant.graph.degree
    C0 = (c / gains.p_omega + plant.m / (2 * gains.p_v) * (gains.k_alpha * psi1 / gains.p_omega) ** 2).sum()
    for t, state in enumerate(states(plant, 40)):
        V, W = energy.translational(OPS, plant, gains, state), energy.rotational(OPS, plant, gains, state)
        Y = what(plant, gains, psi, float(t), state) + 4.0 * V  # K_s = 3
        assert W + 3 * V - C0 <= Y <= W + 5 * V + C0


def test_l9(case):
    fleet, plant, _, _ = case
    N, kappa = len(fleet), float(global_minimum_cut(with_leader(fleet.graph)))
    tried = 0
    for state in states(plant, 200, scale=1.0):
        chi = np.abs(consensus_errors(OPS, plant, Saturation(), state).theta).max()
        for error, e in ((state.theta - plant.leader_theta, chi), *coordinates(plant, state)):
            if e < kappa / N:
                tried += 1
                assert np.abs(error).max() <= N * np.arctanh(N * e / kappa) + 1e-12
    assert tried > 20


def coordinates(plant, state):
    e_x, e_y, _ = consensus_errors(OPS, plant, Saturation(), state)
    yield state.x - plant.offset_x - plant.leader_x, np.abs(e_x).max()
    yield state.y - plant.offset_y - plant.leader_y, np.abs(e_y).max()


def test_l11():
    rng = np.random.default_rng(3)
    t = np.linspace(0, 2.0, 4001)
    for _ in range(50):
        coefficients, frequencies = rng.standard_normal(4), rng.uniform(0.2, 6, 4)
        f = (coefficients[:, None] * np.sin(frequencies[:, None] * t)).sum(0)
        A, eta = np.abs(coefficients * frequencies).sum(), np.abs(f).max()
        assert np.trapezoid(f * np.tanh(f), t) >= min(2.0, eta / (2 * A)) * eta / 2 * np.tanh(eta / 2) - 1e-6


def test_l10_on_random_excitations():
    """nu over windows of one period, by quadrature, against the bound of L10."""
    from gaincert.models.excitation import Excitation

    rng = np.random.default_rng(5)
    for _ in range(10):
        sin = tuple(Fraction(int(k), 8) for k in rng.integers(-8, 9, 3))
        psi = Excitation(Fraction(1, 2), Fraction(2), (*sin, Fraction(1)))
        q, j = psi.power()
        T, mu, psi2 = np.pi, float(q) * np.pi**j, bounds(psi)[2]
        length = min(T / 2, np.sqrt(mu / T) / (2 * psi2))
        value = psi.value(OPS, np.linspace(0, T, 2001)[:-1])
        assert value.var() * T >= mu * length**3 / (48 * T)


def test_l18_levels():
    """Above the level of (15') every |omega| falls, whatever the rest of the state."""
    fleet, gains, psi = paper_fleet(), paper_gains().map(lambda g: np.asarray(g, dtype=float)), paper_excitation()
    plant = fleet.plant()
    c = np.sqrt(2) * gains.k_alpha * float(psi.bound) * plant.graph.degree
    ratio = (gains.p_omega * plant.graph.degree + c) / gains.d_omega
    held = ratio < 1
    assert held.sum() == 4
    level = np.arctanh(np.where(held, ratio, 0))
    for t, state in enumerate(states(plant, 100, scale=20.0)):
        for sign in (1, -1):
            at = state._replace(omega=sign * (level + 1e-9))
            assert (sign * closed_loop(OPS, plant, gains, psi.value(OPS, float(t)), at).omega[held] < 0).all()
