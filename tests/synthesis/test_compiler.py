"""Compiled loops agree with CasADi and with the equations."""

import math
from dataclasses import replace
from fractions import Fraction
from functools import cache

import casadi as ca
import llvmlite.binding as llvm
import numpy as np
import pytest
from gaincert.models.algebra.ops import numpy_ops
from gaincert.models.equations import Plant, State, closed_loop, motion
from gaincert.models.fleet import Fleet
from gaincert.models.gains import GAIN_NAMES, Gains
from gaincert.models.paper import paper_fleet
from gaincert.models.saturation import Saturation
from gaincert.synthesis.programs.excitation import flat_tones
from gaincert.synthesis.rollouts import compiler
from gaincert.synthesis.rollouts.closed_loop import (
    Controls,
    controller_arrays,
    controller_loops,
    controller_parts,
    edge_ends,
    phases,
)
from gaincert.synthesis.rollouts.compiler import (
    Double,
    Program,
    Single,
    compiled,
    compiled_programs,
    pointer,
)
from gaincert.synthesis.rollouts.loops import At, LoopNest, Part
from gaincert.synthesis.rollouts.runge_kutta import BOGACKI_SHAMPINE, DORMAND_PRINCE, Accuracy, Stepper, Tableau
from gaincert.synthesis.rollouts.single_functions import single_ops

SYMBOL = ca.SX.sym


def applied(function: ca.Function, *arguments: np.ndarray) -> np.ndarray:
    """A function of scalars over arrays (items, columns)."""
    items, columns = arguments[0].shape
    arrays = {f"argument{k}": np.ascontiguousarray(array, dtype=Single) for k, array in enumerate(arguments)}
    loop = LoopNest(function, [(name, At.EACH) for name in arrays], [("result", At.EACH)])
    arrays["result"] = np.empty((items, columns), Single)
    compiled({"loop": loop})["loop"].bind(items, columns, {name: pointer(array) for name, array in arrays.items()})()
    return arrays["result"]


@pytest.mark.parametrize("name", ["sin", "cos", "tanh"])
def test_the_replacements_of_sin_cos_and_tanh_are_accurate_enough(name: str) -> None:
    s = np.concatenate([np.linspace(-12, 12, 4001), np.linspace(-100, 100, 4001), [math.nan]]).astype(Single)[None]
    x = SYMBOL("x")
    found = applied(ca.Function("f", [x], [getattr(single_ops(), name)(x)]), s)
    true = getattr(np, name)(s.astype(float))
    assert np.abs(found - true)[:, :-1].max() < 1e-5
    assert np.isnan(found[0, -1])


@pytest.mark.parametrize("name", ["sin", "tanh"])
def test_near_zero_they_are_near_in_proportion(name: str) -> None:
    s = np.geomspace(1e-20, 0.1, 500).astype(Single)[None]
    x = SYMBOL("x")
    found = applied(ca.Function("f", [x], [getattr(single_ops(), name)(x)]), s)
    assert found == pytest.approx(getattr(np, name)(s), rel=1e-6)


def test_every_operation_is_that_of_casadi() -> None:
    x, y = SYMBOL("x"), SYMBOL("y")
    parts = [x + y, x - y, x * y, x / y, -x, x * x, 2 * x, 1 / x, ca.fabs(x), ca.floor(x), ca.fmax(x, y), ca.fmin(x, y)]
    parts += [ca.if_else(ca.fmax(x, 0), y, x), x + 0.125]
    a, b = np.random.default_rng(0).uniform(-3, 3, (2, 3, 37)).astype(Single)
    for part in parts:
        function = ca.Function("f", [x, y], [part])
        true = np.vectorize(lambda p, q, f=function: float(f(p, q)))(a, b)
        assert applied(function, a, b) == pytest.approx(true, rel=1e-6), part


def single_precision_bound(plant: Plant, gains: Gains, tones: float) -> State:
    """How far the compiled rates may be from the exact ones, each (N,), for |psi| <= tones.

    Write d for the error of one sin, cos or tanh: 1e-5 of the function itself (the first test of this file) and 5e-6
    because its argument is rounded (a few times 2^-24 of lengths up to 50 m over scales of at least 0.5, and of the
    angles in psi): twice that.
    To first order in d, with |tanh| <= 1 and |cos| + |sin| <= sqrt2:
    each component of (8) and (10) is within D d; phi^T e_z and phi_perp^T e_z are within (2 + sqrt2) D d, and at most
    sqrt2 D; psi is within tones d. Hence u_v of (7) and u_omega of (9) are within the first two lines below. The
    torques (6) mix both inputs and (2) separates them again: each then carries a few roundings of the other.
    """
    d, rounding = 2e-5, 16 * 2.0**-24
    degree, arm = plant.graph.degree, np.abs(plant.arm)
    u_v = d * ((2 + math.sqrt(2)) * gains.p_v * degree + gains.d_v)
    u_omega = d * (gains.p_omega * degree + gains.d_omega + (2 + 2 * math.sqrt(2)) * gains.k_alpha * tones * degree)
    force = math.sqrt(2) * gains.p_v * degree + gains.d_v  # N, the largest |u_v|
    moment = gains.p_omega * degree + gains.d_omega + math.sqrt(2) * gains.k_alpha * tones * degree
    v_rate = (u_v + rounding * (force + moment / arm)) / plant.m
    omega_rate = (u_omega + rounding * (moment + force * arm)) / plant.inertia
    speed = np.full_like(arm, 2 * d * SPREAD[3])
    return State(speed, speed, np.zeros_like(arm), v_rate, omega_rate)


SPREAD = np.array([20, 20, 4, 3, 2])  # the states of the next test, either way


PSI = replace(flat_tones(), frequency=Fraction(7, 5))


@cache
def controller() -> dict[str, Program]:
    """The compiled rates and torques of any fleet."""
    parts = {f"find {name}": controller_parts("measured", "phase", name, name) for name in ("rates", "torques")}
    return compiled_programs(controller_loops(PSI), parts)


def evaluated(
    name: str, plant: Plant, controls: Controls, states: np.ndarray, times: np.ndarray, lost: int | None = None
) -> np.ndarray:
    """The rates or torques of states (5, N, B) at times (B,); every other column has lost the edge `lost`."""
    arrays = controller_arrays(plant, controls)
    arrays["measured"], arrays["phase"] = states, phases(controls.frequency, times)
    arrays[name] = np.full((5 if name == "rates" else 2, *states.shape[1:]), math.nan, Single)
    if lost is not None:
        arrays["losable"][lost] = 1
        arrays["connected"][::2] = 0
    sizes = {"one": 1, "vehicles": plant.graph.vehicles, "edges": plant.graph.edges}
    pointers = {key: pointer(array) for key, array in arrays.items()}
    controller()[f"find {name}"].bind(sizes, len(times), pointers, edge_ends(plant.graph))(1)
    return arrays[name]


def drawn_gains(random: np.random.Generator, vehicles: int) -> Gains:
    """Random gains and scales that singles hold exactly, as doubles."""
    gains = random.uniform(0.3, 3, (len(GAIN_NAMES), vehicles)).astype(Single).astype(float)
    network = random.uniform(0.5, 2, 2).astype(Single).astype(float)
    scales = random.uniform(0.5, 2, (2, vehicles)).astype(Single).astype(float)
    return Gains(*gains, Saturation(*network, *scales))


@pytest.mark.parametrize("columns", [1, 7, 8, 100])
def test_the_closed_loop_is_that_of_the_equations(fleet: Fleet, columns: int) -> None:
    """Every fleet of the tests, every column with its own gains, scales and psi: rates within single precision."""
    random = np.random.default_rng(columns)
    vehicles = len(fleet)
    plant = fleet.plant().map(lambda values: np.asarray(values, dtype=float))
    gains = [drawn_gains(random, vehicles) for _ in range(columns)]
    frequency = random.uniform(0.5, 2, columns).astype(Single).astype(float)
    spread = SPREAD[:, None, None]
    starts = random.uniform(-spread, spread, (5, vehicles, columns)).astype(Single)
    times = random.uniform(0, 20, columns)
    found = evaluated("rates", plant, Controls.of(gains, frequency.tolist()), starts, times)
    tones = sum(abs(float(value)) for value in PSI.sin)
    for k, t in enumerate(times):
        psi = replace(PSI, frequency=Fraction(frequency[k]))
        now, state = psi.value(numpy_ops(), t), State(*starts[..., k].astype(float))
        exact = closed_loop(numpy_ops(), plant, gains[k], now, state)
        bound = single_precision_bound(plant, gains[k], tones)
        for rate, true, within in zip(found[..., k], exact, bound, strict=True):
            assert (np.abs(rate - true) <= within).all()


def test_torques_are_those_whose_motion_the_rates_are(fleet: Fleet) -> None:
    """What a robot's computer sends to the wheels moves the vehicles as the closed loop says."""
    random, vehicles = np.random.default_rng(1), len(fleet)
    plant = fleet.plant().map(lambda values: np.asarray(values, dtype=float))
    gains, spread = drawn_gains(random, vehicles), SPREAD[:, None, None]
    starts, times = random.uniform(-spread, spread, (5, vehicles, 9)).astype(Single), random.uniform(0, 20, 9)
    controls = Controls.of([gains] * 9, [1.4] * 9)
    torques = evaluated("torques", plant, controls, starts, times)
    bound = single_precision_bound(plant, gains, sum(abs(float(value)) for value in PSI.sin))
    for k, t in enumerate(times):
        now, state = PSI.value(numpy_ops(), t), State(*starts[..., k].astype(float))
        moved = motion(numpy_ops(), plant, state, *torques[..., k].astype(float))
        exact = closed_loop(numpy_ops(), plant, gains, now, state)
        for rate, true, within in zip(moved[3:], exact[3:], bound[3:], strict=True):
            assert (np.abs(rate - true) <= within).all()


def test_a_lost_edge_is_missing_in_the_columns_that_have_lost_it() -> None:
    """They move as a fleet without that edge, and the others as before."""
    random, fleet = np.random.default_rng(2), paper_fleet()
    plant = fleet.plant().map(lambda values: np.asarray(values, dtype=float))
    spread, lost = SPREAD[:, None, None], 2
    starts, times = random.uniform(-spread, spread, (5, len(fleet), 6)).astype(Single), random.uniform(0, 20, 6)
    controls = Controls.of([drawn_gains(random, len(fleet))] * 6, [1.4] * 6)
    weight = plant.graph.weight.copy()
    weight[lost] = 0
    without = replace(plant, graph=replace(plant.graph, weight=weight))
    found = evaluated("rates", plant, controls, starts, times, lost)
    whole, less = (evaluated("rates", one, controls, starts, times) for one in (plant, without))
    assert (found[..., ::2] == less[..., ::2]).all()
    assert (found[..., 1::2] == whole[..., 1::2]).all()
    assert (less != whole).any(axis=(0, 1)).all()


def test_a_program_runs_its_loops_in_order_again_and_again() -> None:
    """Every step reads the next of what moves, from the first that is asked for; arrays go by their new names."""
    y, kick = SYMBOL("y"), SYMBOL("kick")
    loops = {
        "add": LoopNest(ca.Function("f", [y, kick], [y + kick]), [("y", At.EACH), ("k", At.ITEM)], [("y", At.EACH)]),
        "twice": LoopNest(ca.Function("f", [y], [2 * y]), [("here", At.EACH)], [("there", At.EACH)]),
    }
    parts = [
        Part("add", "vehicles", (("k", "kicks"),), moving=("k",)),
        Part("twice", "vehicles", (("here", "y"), ("there", "z"))),
        Part("twice", "vehicles", (("here", "z"), ("there", "y"))),
    ]
    random = np.random.default_rng(0)
    kicks, start = (random.integers(-4, 5, shape).astype(Double) for shape in ((7, 1, 3), (3, 10)))
    arrays = {"kicks": kicks, "y": start.copy(), "z": np.zeros((3, 10))}
    pointers = {name: pointer(array, Double) for name, array in arrays.items()}
    program = compiled_programs(loops, {"program": parts}, Double)["program"]
    program.bind({"vehicles": 3}, 10, pointers)(4, 2)
    expected = start
    for step in range(2, 6):
        expected = 4 * (expected + kicks[step, 0][:, None])
    assert (arrays["y"] == expected).all()


@pytest.mark.parametrize("tableau", [BOGACKI_SHAMPINE, DORMAND_PRINCE], ids=["single", "double"])
def test_columns_follow_their_equation(tableau: Tableau) -> None:
    """y' = -rate y, from every rate its own steps."""
    rates = np.geomspace(0.01, 10, 20)

    def problem(y: np.ndarray, slope: np.ndarray):
        return lambda _: np.copyto(slope, -rates * y)

    accuracy, first = Accuracy(1e-5, 1e-7, math.inf), np.full(20, 0.01)
    stepper = Stepper(tableau, problem, np.zeros(20), np.ones((3, 20)), first, accuracy)
    for _ in range(80):
        stepper.step()
    assert stepper.t[0] > 10 * stepper.t[-1] > 0
    assert stepper.y.dtype == tableau.real
    assert stepper.y == pytest.approx(np.tile(np.exp(-rates * stepper.t), (3, 1)), abs=1e-4)
    stepper.attempt()
    halfway, taken = np.exp(-rates * (stepper.t + stepper.h / 2)), stepper.taken > 0
    assert stepper.inside(0.5)[:, taken] == pytest.approx(np.tile(halfway[taken], (3, 1)), abs=1e-4)


def test_a_plain_processor_finds_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """To the last bit: wider registers only change how many columns are computed at once."""
    x, y = SYMBOL("x"), SYMBOL("y")
    ops = single_ops()
    function = ca.Function("f", [x, y], [ops.tanh(x) * ops.sin(y) + ops.cos(x) * y / (1 + x * x)])
    a, b = np.random.default_rng(0).uniform(-9, 9, (2, 3, 1000)).astype(Single)
    here = applied(function, a, b)
    monkeypatch.setattr(compiler.llvm, "get_host_cpu_name", lambda: "")
    monkeypatch.setattr(compiler.llvm, "get_host_cpu_features", lambda: llvm.FeatureMap())
    assert (applied(function, a, b) == here).all()


def test_a_plain_processor_finds_the_same_rates(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where a program inlines and joins loops."""
    random, fleet = np.random.default_rng(3), paper_fleet()
    plant = fleet.plant().map(lambda values: np.asarray(values, dtype=float))
    spread = SPREAD[:, None, None]
    starts, times = random.uniform(-spread, spread, (5, len(fleet), 50)).astype(Single), random.uniform(0, 20, 50)
    controls = Controls.of([drawn_gains(random, len(fleet)) for _ in times], [1.4] * 50)
    here = evaluated("rates", plant, controls, starts, times)
    monkeypatch.setattr(compiler.llvm, "get_host_cpu_name", lambda: "")
    monkeypatch.setattr(compiler.llvm, "get_host_cpu_features", lambda: llvm.FeatureMap())
    controller.cache_clear()
    assert (evaluated("rates", plant, controls, starts, times) == here).all()
    controller.cache_clear()


def test_nothing_is_fused() -> None:
    """A product is rounded before it is added: so all processors agree."""
    x, y = SYMBOL("x"), SYMBOL("y")
    a, b = np.random.default_rng(0).uniform(-3, 3, (2, 1, 1000)).astype(Single)
    assert (applied(ca.Function("f", [x, y], [x * y + y * y * x]), a, b) == a * b + b * b * a).all()


def test_ends_of_edges_are_gathered_and_summed_up() -> None:
    """As the graph verbs of NumPy do it."""
    at_tail, at_head, sum_at_tail, sum_at_head = (SYMBOL(name) for name in ("z_i", "z_j", "s_i", "s_j"))
    f = at_tail - at_head
    function = ca.Function("f", [at_tail, at_head, sum_at_tail, sum_at_head], [sum_at_tail + f, sum_at_head - f])
    sums = [("sums", At.TAIL), ("sums", At.HEAD)]
    loop = LoopNest(function, [("z", At.TAIL), ("z", At.HEAD), *sums], sums)
    graph = paper_fleet().graph
    arrays = {name: np.zeros((graph.vehicles, 11), Single) for name in ("z", "sums")}
    arrays["z"][:] = np.random.default_rng(0).integers(-9, 9, arrays["z"].shape)
    ends = [pointer(graph.tail, np.int64), pointer(graph.head, np.int64)]
    pointers = {name: pointer(array) for name, array in arrays.items()}
    compiled({"loop": loop})["loop"].bind(graph.edges, 11, pointers, ends, graph.vehicles)()
    ops = numpy_ops()
    assert (ops.edge_sum(graph, ops.edge_difference(graph, arrays["z"].T)) == arrays["sums"].T).all()


def test_arrays_of_another_type_are_refused() -> None:
    with pytest.raises(TypeError, match="float64"):
        pointer(np.zeros((2, 3)))
    with pytest.raises(TypeError, match="is not a contiguous array"):
        pointer(np.zeros((3, 2), Single).T)
