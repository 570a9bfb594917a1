"""Laws of the equations and energies: over every graph family x drive x scheme (x algebra)."""

import math
from dataclasses import replace
from fractions import Fraction

import casadi as ca
import numpy as np
import pytest
import sympy as sp
from gaincert.models import energy, equations
from gaincert.models.algebra.log_cosh import log_cosh
from gaincert.models.algebra.ops import casadi_ops, numpy_ops, sympy_ops
from gaincert.models.equations import Plant, State
from gaincert.models.gains import GAIN_NAMES, Gains
from gaincert.models.graph import Graph
from gaincert.models.saturation import Saturation

TIME = 0.83  # s, some instant


def everything(ops, plant, gains, psi, t, state):
    """The results of all functions of models.equations and models.energy, as one list of arrays."""
    now, rate = psi.value(ops, t), psi.derivative().value(ops, t)
    return [
        *equations.closed_loop(ops, plant, gains, now, state),
        *equations.control(ops, plant, gains, now, state),
        *(errors := equations.consensus_errors(ops, plant, gains.saturation, state)),
        equations.excitation_input(ops, gains, now, state, errors),
        energy.translational(ops, plant, gains, state),
        energy.rotational(ops, plant, gains, state),
        energy.translational_dissipation(ops, gains, state),
        energy.rotational_dissipation(ops, gains, state),
        energy.rotational_input(ops, plant, gains, now, state),
        energy.modified(ops, plant, gains, now, rate, state),
    ]


def flat(arrays):
    return np.concatenate([np.ravel(np.asarray(array, dtype=float)) for array in arrays])


def close(actual, expected, relative=1e-12):
    return np.max(np.abs(actual - expected)) <= relative * max(1.0, np.max(np.abs(expected)))


def high_precision(array):
    """The same numbers, to 30 digits, as SymPy's."""
    return np.frompyfunc(lambda x: sp.Float(float(x), 30), 1, 1)(array)


def symbols(n):
    """A state of CasADi symbols, and time."""
    return State(*(ca.MX.sym(name, n) for name in State._fields)), ca.MX.sym("t")


def evaluate(expressions, symbolic, t, state, time=TIME):
    values = ca.Function("f", [*symbolic, t], expressions).call([*(ca.DM(part) for part in state), ca.DM(time)])
    return [np.array(value).ravel() for value in values]


def rate_of(quantity, symbolic, t, rates):
    """The derivative of a quantity along the closed loop, by automatic differentiation."""
    arguments, direction = ca.vertcat(*symbolic, t), ca.vertcat(*rates, 1)
    return ca.jtimes(quantity, arguments, direction)


def test_the_algebras_agree(fleet, gains, psi, scheme, draw_state):
    plant, state = fleet.plant(), draw_state(len(fleet))
    by_numpy = flat(everything(scheme(numpy_ops()), plant, gains, psi, TIME, state))

    exact_state = State(*map(high_precision, state))
    exact = everything(
        scheme(sympy_ops()),
        plant.map(high_precision),
        gains.map(high_precision),
        psi,
        sp.Float(TIME, 30),
        exact_state,
    )
    by_sympy = flat([np.frompyfunc(lambda e: float(sp.N(e, 25)), 1, 1)(part) for part in exact])
    assert close(by_numpy, by_sympy)

    symbolic, t = symbols(len(fleet))
    columns = everything(scheme(casadi_ops()), plant.map(ca.DM), gains.map(ca.DM), psi, t, symbolic)
    assert close(flat(evaluate(columns, symbolic, t, state)), by_sympy)


def as_printed(fleet, gains, psi, state, saturation):
    """(1), (2), (5)-(11) typed once more, vehicle by vehicle, from the paper; the physical drive from mechanics."""
    n, names = len(fleet), fleet.names
    a = np.zeros((n, n))
    for i, j, weight in fleet.links.edges:
        a[names.index(i), names.index(j)] = a[names.index(j), names.index(i)] = weight
    led = [float(fleet.links.leader_links.get(name, 0)) for name in names]
    goal, theta_l = np.array(fleet.leader.position, dtype=float), float(fleet.leader.heading)
    z_bar = [np.array([state.x[i], state.y[i]]) - np.array(fleet.vehicles[i].offset, dtype=float) for i in range(n)]
    rates = np.zeros((5, n))
    for i, vehicle in enumerate(fleet.vehicles):
        m, inertia, R, r = (
            float(value) for value in (vehicle.mass, vehicle.inertia, vehicle.half_track, vehicle.wheel_radius)
        )
        phi = np.array([math.cos(state.theta[i]), math.sin(state.theta[i])])
        perp = np.array([-math.sin(state.theta[i]), math.cos(state.theta[i])])
        e_z = led[i] * saturation(z_bar[i] - goal)
        e_theta = led[i] * saturation(state.theta[i] - theta_l)
        for j in range(n):
            e_z = e_z + a[i, j] * saturation(z_bar[i] - z_bar[j])
            e_theta = e_theta + a[i, j] * saturation(state.theta[i] - state.theta[j])
        u_v = -gains.p_v[i] * phi @ e_z - gains.d_v[i] * saturation(state.v[i])
        alpha = gains.k_alpha[i] * psi * perp @ e_z
        u_w = -gains.p_omega[i] * e_theta - gains.d_omega[i] * saturation(state.omega[i]) + alpha
        if fleet.drive == "paper":
            left, right = r / 2 * (u_v + u_w / (2 * R)), r / 2 * (u_v - u_w / (2 * R))
            moment = 2 * R * (left - right) / r
        else:
            left, right = r / 2 * (u_v - u_w / R), r / 2 * (u_v + u_w / R)
            moment = R * (right - left) / r
        rates[:, i] = *(phi * state.v[i]), state.omega[i], (left + right) / r / m, moment / inertia
    return rates


@pytest.mark.parametrize("saturation", [np.tanh, lambda s: s], ids=["bounded", "unbounded"])
def test_the_closed_loop_is_the_paper_s(fleet, gains, psi, saturation, draw_state):
    from gaincert.models.algebra.ops import unbounded

    ops = numpy_ops() if saturation is np.tanh else unbounded(numpy_ops())
    state, gains = draw_state(len(fleet)), replace(gains, saturation=Saturation())
    rates = equations.closed_loop(ops, fleet.plant(), gains, psi.value(ops, TIME), state)
    expected = as_printed(fleet, gains, psi.value(numpy_ops(), TIME), state, saturation)
    assert close(flat(rates), expected.ravel())


def test_the_energies_are_the_paper_s(fleet, gains, draw_state):
    """(17) and (19), double sums and their 1/2 included."""
    state, plant, n = draw_state(len(fleet)), fleet.plant(), len(fleet)
    a = np.diag(fleet.plant().graph.degree) - plant.graph.composed_laplacian().toarray()
    led = plant.graph.leader_weight

    length, rho = gains.saturation.position, gains.saturation.heading

    def potential(scale, z, leader):
        def well(distance):
            return scale * math.log(math.cosh(distance / scale))

        pairs = sum(a[i, j] * well(z[i] - z[j]) for i in range(n) for j in range(n) if i != j)
        return 0.5 * (pairs + 2 * sum(led[i] * well(z[i] - leader) for i in range(n)))

    V = 0.5 * sum(plant.m / gains.p_v * state.v**2)
    V += potential(length, state.x - plant.offset_x, plant.leader_x)
    V += potential(length, state.y - plant.offset_y, plant.leader_y)
    W = 0.5 * sum(plant.inertia / gains.p_omega * state.omega**2) + potential(rho, state.theta, plant.leader_theta)
    ops = numpy_ops()
    assert energy.translational(ops, plant, gains, state) == pytest.approx(V, rel=1e-12)
    assert energy.rotational(ops, plant, gains, state) == pytest.approx(W, rel=1e-12)


def test_the_energies_fall_as_18_20_and_lemma_l5_say(fleet, gains, psi, scheme, draw_state):
    ops, plant, gains = scheme(casadi_ops()), fleet.plant().map(ca.DM), gains.map(ca.DM)
    state, t = symbols(len(fleet))
    rates = equations.closed_loop(ops, plant, gains, psi.value(ops, t), state)
    slope = psi.derivative()
    now, first, second = (part.value(ops, t) for part in (psi, slope, slope.derivative()))

    V = energy.translational(ops, plant, gains, state)
    W = energy.rotational(ops, plant, gains, state)
    W_hat = energy.modified(ops, plant, gains, now, first, state)
    errors = equations.consensus_errors(ops, plant, gains.saturation, state)
    e_rate = [rate_of(e, state, t, rates) for e in errors[:2]]
    forced = (
        -plant.m / gains.p_v * second * state.v
        + gains.d_v / gains.p_v * first * ops.tanh(state.v / gains.saturation.speed)
        - now * equations.along(ops, state.theta, *e_rate)
    )
    loss_v = energy.translational_dissipation(ops, gains, state)
    loss_w = energy.rotational_dissipation(ops, gains, state)
    laws = {
        "(18)": (rate_of(V, state, t, rates), -loss_v),
        "(20)": (rate_of(W, state, t, rates), -loss_w + energy.rotational_input(ops, plant, gains, now, state)),
        "L5": (rate_of(W_hat, state, t, rates), -loss_w + ca.sum1(gains.k_alpha / gains.p_omega * forced)),
    }
    for _ in range(3):
        sides = evaluate([side for law in laws.values() for side in law], state, t, draw_state(len(fleet)))
        for name, left, right in zip(laws, sides[::2], sides[1::2], strict=True):
            assert right[0] != 0
            assert left == pytest.approx(right, rel=1e-9, abs=1e-9), name


def test_the_energies_fall_symbolically():
    """(18) and (20) for a generic edge and two generic vehicles: SymPy, no numbers at all."""
    ops = sympy_ops()

    def column(name, n=2):
        return np.array(sp.symbols(f"{name}:{n}", positive=True), dtype=object)

    graph = Graph(np.array([0]), np.array([1]), column("a", 1), column("b"))
    scalars = sp.symbols("x_l y_l theta_l", real=True)
    plant = Plant(graph, *(column(name) for name in ("m", "J", "r", "arm", "dx", "dy")), *scalars)
    gains = Gains(*(column(name) for name in GAIN_NAMES))
    state = State(*(np.array(sp.symbols(f"{name}:2", real=True), dtype=object) for name in State._fields))
    psi = sp.Symbol("psi")

    rates = equations.closed_loop(ops, plant, gains, psi, state)
    V, W = energy.translational(ops, plant, gains, state), energy.rotational(ops, plant, gains, state)
    P_v = energy.translational_dissipation(ops, gains, state)
    P_w = energy.rotational_dissipation(ops, gains, state)
    forced = energy.rotational_input(ops, plant, gains, psi, state)

    def along_the_flow(quantity):
        pairs = zip(np.ravel(state), np.ravel(rates), strict=True)
        return sum(sp.diff(quantity, variable) * rate for variable, rate in pairs)

    assert sp.expand(along_the_flow(V) + P_v) == 0
    assert sp.expand(along_the_flow(W) + P_w - forced) == 0
    assert sp.expand(along_the_flow(V)) != 0
    assert sp.expand(forced) != 0


def exact_plant(fleet):
    def array(key):
        return np.array([getattr(vehicle, key) for vehicle in fleet.vehicles], dtype=object)

    zero = Fraction(0)
    nothing = np.full(len(fleet), zero)
    physical = (array(key) for key in ("mass", "inertia", "wheel_radius"))
    return Plant(fleet.graph, *physical, fleet.arm, nothing, nothing, zero, zero, zero)


def test_6_inverts_2_exactly(fleet, random):
    """m v' = u_v and I omega' = u_omega, over fractions: no rounding error is left."""
    plant = exact_plant(fleet)
    u_v, u_w = (np.array([Fraction(int(u), 64) for u in random.integers(-999, 999, len(fleet))]) for _ in range(2))
    v_rate, w_rate = equations.accelerations(plant, *equations.wheel_torques(plant, u_v, u_w))
    assert (plant.m * v_rate == u_v).all()
    assert (plant.inertia * w_rate == u_w).all()


@pytest.mark.parametrize(("drive", "moment"), [("physical", "R (tau_r - tau_l)"), ("paper", "2 R (tau_l - tau_r)")])
def test_the_drive_turns_as_its_convention_says(content, moment):
    """On a physical vehicle the right wheel turns it to the left, with lever arm R; (2) as printed says otherwise."""
    from gaincert.models.fleet import Fleet

    fleet = Fleet.model_validate(content)
    plant = exact_plant(fleet)
    R = np.array([vehicle.half_track for vehicle in fleet.vehicles])
    left, right = Fraction(2), Fraction(5)
    printed = {"R (tau_r - tau_l)": R * (right - left), "2 R (tau_l - tau_r)": 2 * R * (left - right)}[moment]
    v_rate, w_rate = equations.accelerations(plant, left, right)
    assert (plant.inertia * w_rate * plant.r == printed).all()
    assert (plant.m * v_rate * plant.r == left + right).all()


def test_a_batch_is_its_members(fleet, gains, psi, scheme, draw_state):
    ops, plant = scheme(numpy_ops()), fleet.plant()
    batch = draw_state(len(fleet), (2, 3))
    together = everything(ops, plant, gains, psi, TIME, batch)
    for index in np.ndindex(2, 3):
        alone = everything(ops, plant, gains, psi, TIME, State(*(part[index] for part in batch)))
        for whole, single in zip(together, alone, strict=True):
            assert whole.shape == (2, 3, *np.shape(single))
            assert np.allclose(whole[index], single, rtol=1e-11, atol=1e-11)


def test_wheels_roll_without_slipping(fleet, gains, psi, scheme, draw_state):
    state = draw_state(len(fleet), (50,))
    rates = equations.closed_loop(
        scheme(numpy_ops()), fleet.plant(), gains, psi.value(scheme(numpy_ops()), TIME), state
    )
    assert np.allclose(rates.x * np.sin(state.theta) - rates.y * np.cos(state.theta), 0, atol=1e-14)
    assert np.allclose(rates.x * np.cos(state.theta) + rates.y * np.sin(state.theta), state.v, atol=1e-14)
    assert (rates.theta == state.omega).all()


def test_the_formation_is_at_rest_and_nothing_else_nearby(fleet, gains, psi, scheme):
    ops, plant, rest = scheme(numpy_ops()), fleet.plant(), np.zeros(len(fleet))
    goal = State(
        plant.leader_x + plant.offset_x, plant.leader_y + plant.offset_y, rest + plant.leader_theta, rest, rest
    )
    rates = equations.closed_loop(ops, plant, gains, psi.value(ops, TIME), goal)
    assert np.allclose(flat(rates), 0, atol=1e-12)
    assert energy.translational(ops, plant, gains, goal) == pytest.approx(0, abs=1e-12)
    assert energy.rotational(ops, plant, gains, goal) == pytest.approx(0, abs=1e-12)
    for coordinate in range(5):
        moved = State(*(part + 0.1 * (index == coordinate) for index, part in enumerate(goal)))
        assert np.max(np.abs(flat(equations.closed_loop(ops, plant, gains, psi.value(ops, TIME), moved)))) > 1e-4
        assert energy.translational(ops, plant, gains, moved) + energy.rotational(ops, plant, gains, moved) > 1e-4


def test_only_relative_positions_count(fleet, gains, psi, scheme, draw_state):
    from dataclasses import replace

    ops, plant, state = scheme(numpy_ops()), fleet.plant(), draw_state(len(fleet))
    here = equations.closed_loop(ops, plant, gains, psi.value(ops, TIME), state)
    moved_plant = replace(plant, leader_x=plant.leader_x + 8, leader_y=plant.leader_y - 16)
    moved = state._replace(x=state.x + 8, y=state.y - 16)
    assert close(flat(equations.closed_loop(ops, moved_plant, gains, psi.value(ops, TIME), moved)), flat(here))


def test_the_direction_in_which_an_edge_is_written_does_not_count(fleet, gains, psi, scheme, draw_state):
    from dataclasses import replace

    ops, plant, state = scheme(numpy_ops()), fleet.plant(), draw_state(len(fleet))
    graph = plant.graph
    turned = replace(plant, graph=Graph(graph.head, graph.tail, graph.weight, graph.leader_weight))
    there, back = (everything(ops, p, gains, psi, TIME, state) for p in (plant, turned))
    assert close(flat(back), flat(there), 1e-14)


@pytest.mark.parametrize("size", [0.0, 1e-9, 1e-3, 1.0, 30.0, 1e3, 1e300])
@pytest.mark.parametrize("sign", [1, -1])
def test_log_cosh_is_accurate_and_never_overflows(size, sign):
    s = sign * size
    s_exact = sp.Rational(Fraction(s))
    expected = float(sp.log(sp.cosh(s_exact)).evalf(60, maxn=2000)) if size < 100 else size - math.log(2)
    values = [
        numpy_ops().log_cosh(np.array([s]))[0],
        float(casadi_ops().log_cosh(ca.DM(s))),
        float(sp.N(sympy_ops().log_cosh(np.array([s_exact], dtype=object))[0], 40)),
    ]
    assert values == pytest.approx([expected] * 3, rel=1e-12, abs=1e-15)


def test_log_cosh_is_even_and_its_slope_is_tanh():
    s = sp.Symbol("s", real=True)
    assert log_cosh(0) == 0
    assert log_cosh(-s) == log_cosh(s)
    assert sp.diff(log_cosh(3 * s), s) == 3 * sp.tanh(3 * s)
    assert log_cosh(s).rewrite(sp.log) == sp.log(sp.cosh(s))
    x = ca.MX.sym("x")
    slope = ca.Function("slope", [x], [ca.gradient(casadi_ops().log_cosh(x), x)])
    for point in (-40.0, -1.5, 0.0, 0.3, 7.0, 800.0):
        assert float(slope(point)) == pytest.approx(math.tanh(point), abs=1e-15)
