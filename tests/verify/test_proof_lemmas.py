"""The lemmas' inequalities tried on random states in floating point: a net under the words between the checks."""

from fractions import Fraction

import numpy as np
import pytest
from gaincert.models import energy
from gaincert.models.algebra.ops import numpy_ops
from gaincert.models.equations import State, across, along, closed_loop, consensus_errors
from gaincert.models.excitation import Excitation
from gaincert.models.gains import Gains
from gaincert.models.paper import paper_excitation, paper_fleet, paper_gains
from gaincert.models.saturation import Saturation
from gaincert.verify.proof import constants
from gaincert.verify.proof.this_fleet.excitation import variance
from gaincert.verify.proof.this_fleet.graph import least_cut
from gaincert.verify.proof.trajectories import simulate

from tests.verify.light_fleets import line_of, undamped_gains

OPS = numpy_ops()


def scaled(gains, seed):
    """The gains with random saturation scales."""
    rng = np.random.default_rng(seed)
    position, heading = rng.uniform(0.2, 2, 2)
    scales = Saturation(position, heading, *rng.uniform(0.2, 2, (2, len(gains.p_v))))
    return Gains(gains.p_v, gains.d_v, gains.p_omega, gains.d_omega, gains.k_alpha, scales)


CASES = [(paper_fleet(), paper_gains(), paper_excitation())]
CASES += [(fleet := line_of(n), undamped_gains(fleet, fleet.psi), fleet.psi) for n in (1, 2, 5)]
CASES += [(fleet, scaled(gains, seed), psi) for seed, (fleet, gains, psi) in enumerate(CASES)]


CASES_FLOAT = [(fleet.plant(), gains.map(lambda g: np.asarray(g, dtype=float)), psi) for fleet, gains, psi in CASES]


@pytest.fixture(params=CASES, ids=lambda case: f"{case[0].name}, scale {float(case[1].saturation.position):.1f}")
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


def setting(plant, gains, psi):
    """What the constants of the lemmas take, in floats."""
    bounds = (np.full(len(plant.m), float(bound)) for bound in (psi.bound, *psi.derivative_bounds))
    return constants.Setting(OPS, np.sqrt(2), plant, gains, *bounds)


def test_l1_rates(case):
    _, plant, gains, psi = case
    c = setting(plant, gains, psi)
    for t, state in enumerate(states(plant, 40)):
        rate = closed_loop(OPS, plant, gains, psi.value(OPS, float(t)), state)
        assert (np.abs(rate.v) < constants.acceleration_bound(c)).all()
        assert (np.abs(rate.omega) < constants.turn_acceleration_bound(c)).all()


def what(plant, gains, psi, t, state):
    return energy.modified(OPS, plant, gains, psi.value(OPS, t), psi.derivative().value(OPS, t), state)


def what_rate(plant, gains, psi, t, state, h=1e-5):
    """The central difference of What along the flow, to second order in h."""
    slope = closed_loop(OPS, plant, gains, psi.value(OPS, t), state)
    ahead, behind = (State(*(a + s * h * b for a, b in zip(state, slope, strict=True))) for s in (1, -1))
    return (what(plant, gains, psi, t + h, ahead) - what(plant, gains, psi, t - h, behind)) / (2 * h)


def test_l6_and_l7(case):
    fleet, plant, gains, psi = case
    c = setting(plant, gains, psi)
    g = constants.speed_weight(c)
    for t, state in enumerate(states(plant, 40)):
        rate = what_rate(plant, gains, psi, float(t), state)
        p_w = energy.rotational_dissipation(OPS, gains, state)
        p_v = energy.translational_dissipation(OPS, gains, state)
        slack = 1e-5 * (1 + abs(rate))
        assert rate <= -p_w + (g * np.abs(state.v)).sum() + slack
        for e in (0.1, 10.0):
            K = constants.damping_share(c, g, e, len(fleet)).max()
            assert rate - (K + 1) * p_v <= -(p_w + p_v) + e + slack


def test_l8(case):
    _, plant, gains, psi = case
    C0 = constants.energy_offset(setting(plant, gains, psi)).sum()
    for t, state in enumerate(states(plant, 40)):
        V, W = energy.translational(OPS, plant, gains, state), energy.rotational(OPS, plant, gains, state)
        Y = what(plant, gains, psi, float(t), state) + 4.0 * V  # K_e = 3
        assert W + 3 * V - C0 <= Y <= W + 5 * V + C0


def test_l9(case):
    fleet, plant, gains, psi = case
    c, cut, scale = setting(plant, gains, psi), float(least_cut(fleet.graph)[0]), gains.saturation
    tried = 0
    for state in states(plant, 200, scale=1.0):
        e = consensus_errors(OPS, plant, scale, state)
        rows = (
            (state.theta - plant.leader_theta, e.theta, scale.heading),
            (state.x - plant.offset_x - plant.leader_x, e.x, scale.position),
            (state.y - plant.offset_y - plant.leader_y, e.y, scale.position),
        )
        for error, pull, length in rows:
            largest = np.abs(error).max()
            # Were |e_i| <= level(M) for an M below the largest error, L9 would be false.
            level = constants.level_for(c, largest * (1 - 1e-9), length, cut, len(fleet))
            assert np.abs(pull).max() > level
            tried += 1
    assert tried > 20


def test_l12_over_windows_near_the_formation(case):
    fleet, plant, gains, psi = case
    c, period = setting(plant, gains, psi), 2 * np.pi / float(psi.frequency)
    q, power = variance(psi)
    beta = constants.across_bound(c, period, float(q) * np.pi**power)
    eps, xi = constants.heading_bound(c, period, beta), constants.along_bound(c, period)
    for start in [*states(plant, 4, scale=0.2)][1:]:
        at_rest = start._replace(v=0 * start.v, omega=0 * start.omega)
        state = simulate(fleet, gains, psi, at_rest, period).state
        eta = max(np.abs(state.v).max(), np.abs(state.omega).max())
        e = consensus_errors(OPS, plant, gains.saturation, state)
        assert (np.abs(across(OPS, state.theta, e.x, e.y)) <= beta * eta).all()
        assert (np.abs(along(OPS, state.theta, e.x, e.y)) <= xi * eta).all()
        assert (np.abs(e.theta) <= eps * eta).all()


def test_l11():
    rng = np.random.default_rng(3)
    t = np.linspace(0, 2.0, 4001)
    for _ in range(50):
        coefficients, frequencies = rng.standard_normal(4), rng.uniform(0.2, 6, 4)
        f, scale = (coefficients[:, None] * np.sin(frequencies[:, None] * t)).sum(0), rng.uniform(0.2, 2)
        A, eta = np.abs(coefficients * frequencies).sum(), np.abs(f).max()
        length = min(2.0, constants.spike_length(eta, A))
        least = constants.spike_energy(setting(*CASES_FLOAT[0]), eta, length, scale)
        assert np.trapezoid(f * np.tanh(f / scale), t) >= least - 1e-6


def test_l10_on_random_excitations():
    """nu over windows of one period, by quadrature, against the bound of L10."""
    rng = np.random.default_rng(5)
    for _ in range(10):
        sin = tuple(Fraction(int(k), 8) for k in rng.integers(-8, 9, 3))
        psi = Excitation(Fraction(1, 2), Fraction(2), (*sin, Fraction(1)))
        q, j = psi.power()
        T, mu = np.pi, float(q) * np.pi**j
        stretch = min(T / 2, constants.steep_stretch(T, mu, float(psi.derivative_bounds[1])))
        value = psi.value(OPS, np.linspace(0, T, 2001)[:-1])
        assert value.var() * T >= constants.variance_bound(T, mu, stretch)


def test_l18_levels(case):
    """Above the level of (15') every |omega| falls, whatever the rest of the state."""
    _, plant, gains, psi = case
    c = setting(plant, gains, psi)
    ratio = (gains.p_omega * plant.graph.degree + constants.excitation_bound(c)) / gains.d_omega
    held = ratio < 1
    level = gains.saturation.turn_rate * np.arctanh(np.where(held, ratio, 0))
    for t, state in enumerate(states(plant, 100, scale=20.0)):
        for sign in (1, -1):
            at = state._replace(omega=sign * (level + 1e-9))
            assert (sign * closed_loop(OPS, plant, gains, psi.value(OPS, float(t)), at).omega[held] < 0).all()


def test_l18_holds_four_vehicles_of_the_paper():
    plant, gains, psi = CASES_FLOAT[0]
    c = setting(plant, gains, psi)
    assert np.sum(gains.p_omega * plant.graph.degree + constants.excitation_bound(c) < gains.d_omega) == 4
