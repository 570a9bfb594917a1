"""The statement that Coq proves speaks of the equations and conditions that the program uses.

The definitions of verify/formal/Statement.v are evaluated over floats by a reader of their own and compared with
models/equations.py and models/conditions.py on every graph family and both drives.
"""

import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from gaincert.models.algebra.ops import numpy_ops
from gaincert.models.arrays import floats
from gaincert.models.conditions import (
    excitation_bound,
    float_numbers,
    speed_condition,
    torque_bound,
    turn_rate_condition,
)
from gaincert.models.equations import angular_input, closed_loop, consensus_errors, control, linear_input
from gaincert.models.graph import Graph
from gaincert.models.saturation import Saturation

from tests.verify.gallina import Source

TEXT = (Path(__file__).parents[2] / "verify" / "formal" / "Statement.v").read_text()
STATEMENT = Source(TEXT)
T = 0.7  # s, when inputs are compared


def indexed(values, n):
    """Numbers of every vehicle, or one for all, as a function of the vehicle."""
    return np.broadcast_to(np.asarray(values, dtype=float), n).tolist().__getitem__


def record_of_fleet(fleet, gains, psi):
    """The record `fleet` of Statement.v; the excitation is the same for all vehicles."""
    plant, ops, scale, n = fleet.plant(), numpy_ops(), gains.saturation, len(fleet)
    weights = np.zeros((n, n))
    weights[plant.graph.tail, plant.graph.head] = weights[plant.graph.head, plant.graph.tail] = plant.graph.weight
    per_vehicle = {
        "al": plant.graph.leader_weight,
        "offx": plant.offset_x,
        "offy": plant.offset_y,
        "m": plant.m,
        "J": plant.inertia,
        "wr": plant.r,
        "arm": np.abs(plant.arm),
        "pv": gains.p_v,
        "dv": gains.d_v,
        "pw": gains.p_omega,
        "dw": gains.d_omega,
        "k": gains.k_alpha,
        "ss": scale.speed,
        "ws": scale.turn_rate,
    }
    return {
        "N": n,
        "a": lambda i: lambda j: weights[i, j],
        "leadx": float(plant.leader_x),
        "leady": float(plant.leader_y),
        "leadth": float(plant.leader_theta),
        "ls": float(scale.position),
        "rs": float(scale.heading),
        "psi": lambda _: lambda t: float(psi.value(ops, t)),
        "psi0": float(fleet.condition_data(psi).psi_bar),
        **{name: indexed(values, n) for name, values in per_vehicle.items()},
    }


@pytest.fixture
def gains(fleet, gains, random):
    """Random gains with random scales: the statement is about all of them."""
    position, heading = random.uniform(0.2, 3, 2)
    speed, turn_rate = random.uniform(0.2, 3, (2, len(fleet)))
    return replace(gains, saturation=Saturation(position, heading, speed, turn_rate))


@pytest.fixture
def here(fleet, gains, psi, draw_state):
    """(plant, gains, psi(T), state) as the model takes them, and (F, s) as the statement does."""
    plant, state = fleet.plant(), draw_state(len(fleet))
    names = dict(zip(("px", "py", "th", "v", "om"), state, strict=True))
    s = {name: indexed(values, len(fleet)) for name, values in names.items()}
    return plant, gains, psi.value(numpy_ops(), T), state, record_of_fleet(fleet, gains, psi), s


def same(n, stated, modelled):
    assert [stated(i) for i in range(n)] == pytest.approx(modelled, rel=1e-12, abs=1e-12)


def test_the_errors_and_inputs_are_those_of_the_equations(here):
    plant, gains, psi_now, state, F, s = here
    errors, ops, n = consensus_errors(numpy_ops(), plant, gains.saturation, state), numpy_ops(), F["N"]
    for name, error in zip(("ex", "ey", "eth"), errors, strict=True):
        same(n, STATEMENT.value(name, F, s), error)
    same(n, STATEMENT.value("u_v", F, s), linear_input(ops, gains, state, errors))
    same(n, STATEMENT.value("u_w", F, T, s), angular_input(ops, gains, psi_now, state, errors))


def test_the_wheel_torques_are_those_of_the_controller(here):
    """The statement does not say which wheel is the left one: on a physical drive it is the one with the minus."""
    plant, gains, psi_now, state, F, s = here
    left, right = control(numpy_ops(), plant, gains, psi_now, state)
    stated = [STATEMENT.value(name, F, T, s) for name in ("torque_plus", "torque_minus")]
    plus, minus = (left, right) if plant.arm[0] > 0 else (right, left)
    same(F["N"], stated[0], plus)
    same(F["N"], stated[1], minus)


def test_a_solution_follows_the_closed_loop(here):
    plant, gains, psi_now, state, F, s = here
    rates = STATEMENT.derivatives("solution")
    assert list(rates) == ["px", "py", "th", "v", "om"]
    modelled = closed_loop(numpy_ops(), plant, gains, psi_now, state)
    for rate, values in zip(rates.values(), modelled, strict=True):
        same(F["N"], lambda i, rate=rate: STATEMENT.evaluate(rate, {"F": F, "X": lambda _: s, "t": T, "i": i}), values)


def test_degree_excitation_bound_and_torque_limit_are_those_of_the_conditions(here, fleet, psi):
    _, gains, _, _, F, _ = here
    data, numbers, n = fleet.condition_data(psi).map(floats), float_numbers(), len(fleet)
    same(n, STATEMENT.value("deg", F), data.degree)
    same(n, STATEMENT.value("cmax", F), excitation_bound(numbers, data, gains))
    same(n, STATEMENT.value("torque_limit", F), torque_bound(numbers, data, gains))


@pytest.mark.parametrize(
    ("bound", "name", "condition", "limit"),
    [("speed_bound", "vmax", speed_condition, "speed"), ("turn_rate_bound", "wmax", turn_rate_condition, "turn_rate")],
)
def test_speed_and_turn_rate_limits_ask_for_what_the_conditions_ask(here, fleet, psi, bound, name, condition, limit):
    _, gains, _, _, F, _ = here
    n, asked = len(fleet), 1.3
    data = replace(fleet.condition_data(psi).map(floats), **{limit: np.full(n, asked)})
    inequality = condition(float_numbers(), data, gains)
    ((small, large),) = [sides for sides in STATEMENT.comparisons(bound, "<=") if "tanh" in str(sides)]
    same(n, lambda i: STATEMENT.evaluate(small, {"F": F, "i": i}), inequality.small)
    same(n, lambda i: STATEMENT.evaluate(large, {"F": F, "i": i, name: asked}), inequality.large)


def test_a_set_of_vehicles_without_a_tie_is_one_that_no_path_joins_to_the_leader(random):
    """(A1): the weights that tie a set are positive for every nonempty set, or the program refuses the graph."""
    ((_, tie),) = [sides for sides in STATEMENT.comparisons("A1", "<") if "sum" in str(sides)]
    verdicts = set()
    for _ in range(200):
        n = int(random.integers(1, 6))
        pairs = [(i, j) for i in range(n) for j in range(i) if random.random() < 0.3]
        leader_weight = np.where(random.random(n) < 0.4, 1.5, 0.0)
        tail, head = np.array(pairs, dtype=int).reshape(-1, 2).T
        graph = Graph(tail, head, np.full(len(pairs), 0.5), leader_weight)
        weights = np.zeros((n, n))
        weights[tail, head] = weights[head, tail] = 0.5
        F = {"N": n, "a": lambda i, w=weights: w[i].__getitem__, "al": leader_weight.__getitem__}
        chosen = [np.array(ones, dtype=bool) for ones in itertools.product([0, 1], repeat=n) if any(ones)]
        tied = all(STATEMENT.evaluate(tie, {"F": F, "S": ones.__getitem__}) > 0 for ones in chosen)
        assert tied == bool(np.all(graph.leader_tree() >= 0))
        verdicts.add(tied)
    assert verdicts == {True, False}


def test_bounds_window_and_level_of_psi_are_those_that_the_program_states(psi):
    """(A3), with the period of psi for T and its power for mu: the integral is exactly that."""
    ops, rate = numpy_ops(), psi.derivative()
    factor, power = psi.power()
    functions = {"psi": psi, "dpsi": rate, "ddpsi": rate.derivative()}
    F = {name: lambda _, f=f: lambda t: f.value(ops, t) for name, f in functions.items()}
    F |= {f"psi{n}": float(bound) for n, bound in enumerate((psi.bound, *psi.derivative_bounds))}
    F |= {"T": 2 * np.pi / float(psi.frequency), "mu": float(factor) * np.pi**power}
    *bounds, (level, integral) = STATEMENT.comparisons("A3", "<=")[1:]
    for t in np.linspace(0, F["T"], 50):
        here = {"F": F, "i": 0, "t": t}
        for value, bound in bounds:
            assert STATEMENT.evaluate(value, here) <= STATEMENT.evaluate(bound, here)
        assert STATEMENT.evaluate(integral, here) == pytest.approx(STATEMENT.evaluate(level, here), rel=1e-12)
    assert len(bounds) == 3


def test_the_distance_is_the_sum_of_all_errors(here):
    plant, _, _, state, F, s = here
    x, y = state.x - plant.offset_x - plant.leader_x, state.y - plant.offset_y - plant.leader_y
    errors = (x, y, state.theta - plant.leader_theta, state.v, state.omega)
    assert STATEMENT.value("err", F, s) == pytest.approx(sum(np.abs(error).sum() for error in errors), rel=1e-12)


def test_the_formation_has_no_error_and_stands_still(here):
    plant, _, _, _, F, _ = here
    n = F["N"]
    zero = indexed(0.0, n)
    place = {
        "px": indexed(plant.leader_x + plant.offset_x, n),
        "py": indexed(plant.leader_y + plant.offset_y, n),
        "th": indexed(plant.leader_theta, n),
        "v": zero,
        "om": zero,
    }
    for name in ("zx", "zy", "tha", "u_v"):
        same(n, STATEMENT.value(name, F, place), np.zeros(n))
    same(n, STATEMENT.value("u_w", F, T, place), np.zeros(n))


@pytest.mark.parametrize("family", ["weighted"])
@pytest.mark.parametrize(
    ("old", "new"),
    [("+ sin (th s i)", "- sin (th s i)"), ("tanh (v s i / ss F i)", "tanh (v s i)"), ("(ls F)", "(rs F)")],
)
def test_a_changed_statement_is_noticed(here, old, new):
    """A sign or a scale that is not the model's moves a value."""
    plant, gains, _, state, F, s = here
    errors = consensus_errors(numpy_ops(), plant, gains.saturation, state)
    modelled = linear_input(numpy_ops(), gains, state, errors)
    assert old in TEXT
    with pytest.raises(AssertionError):
        same(F["N"], Source(TEXT.replace(old, new)).value("u_v", F, s), modelled)
