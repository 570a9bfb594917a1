"""The integrators: order of accuracy, the energy identity, and that all engines give one and the same run."""

from collections.abc import Callable

import numpy as np
import pytest
from gaincert.models import energy
from gaincert.models.algebra.ops import flat_ops, numpy_ops
from gaincert.models.equations import State
from gaincert.models.fleet import Fleet
from gaincert.models.starts import random_starts
from gaincert.synthesis.rollouts.runge_kutta import DORMAND_PRINCE, Accuracy, Stepper
from gaincert.verify.simulation.closed_loop import ClosedLoop
from gaincert.verify.simulation.engines import ENGINES, LARGE, engine_name, make_integrator
from gaincert.verify.simulation.integrators import Adams, Cvodes, Dop853
from gaincert.verify.simulation.large_fleet import Dopri5, rate_function

KINDS = {"bdf": Cvodes, "adams": Adams, "dop853": Dop853, "scale": Dopri5}


@pytest.fixture
def loop(fleet: Fleet, gains, psi) -> ClosedLoop:
    """Every graph family and both drives, random gains and psi."""
    return ClosedLoop.of(fleet, gains, psi)


@pytest.fixture
def paper_loop(paper: Fleet, gains_of_paper) -> ClosedLoop:
    return ClosedLoop.of(paper, gains_of_paper, paper.psi)


def end(kind, loop: ClosedLoop, start: State, horizon: float, tolerance: float) -> np.ndarray:
    _, states = next(kind(loop, step=horizon, piece=horizon, tolerance=tolerance).pieces(start))
    return np.concatenate([column[-1] for column in states])


def test_all_engines_give_the_same_run(loop: ClosedLoop, draw_state) -> None:
    start = draw_state(loop.vehicles)
    ends = {name: end(kind, loop, start, 1.0, 1e-11) for name, kind in KINDS.items()}
    for x in ends.values():
        assert np.abs(x - ends["dop853"]).max() < 1e-7


@pytest.mark.slow
@pytest.mark.parametrize("name", KINDS)
def test_the_error_falls_with_the_tolerance(paper: Fleet, paper_loop: ClosedLoop, name: str) -> None:
    """Against a reference at 1e-13: 25 s of the paper's fleet, error nearly proportional to the tolerance."""
    reference = end(Dop853, paper_loop, paper.start(), 25.0, 1e-13)
    tolerances = np.array([1e-5, 1e-6, 1e-7, 1e-8, 1e-9])
    runs = [end(KINDS[name], paper_loop, paper.start(), 25.0, tolerance) for tolerance in tolerances]
    errors = [np.abs(x - reference).max() for x in runs]
    assert np.polyfit(np.log(tolerances), np.log(errors), 1)[0] > 0.7
    assert errors[-1] < 2e-6


def test_the_explicit_method_is_of_order_five(paper: Fleet, paper_loop: ClosedLoop) -> None:
    """Fixed steps: the error of one second falls as h^5, that of the continuous extension as h^4 or faster."""
    rate, x0 = rate_function(paper_loop), np.concatenate(random_starts(paper, 1, 0, 5.0)[0])
    reference = end(Dop853, paper_loop, State(*x0.reshape(5, -1)), 1.0, 1e-13)
    errors, counts = [], np.array([400, 800, 1600])

    def problem(state: np.ndarray, slopes: np.ndarray) -> Callable[[np.ndarray], None]:
        return lambda t: rate(float(t[0]), state[:, 0], slopes[:, 0])

    for count in counts:
        loose = Accuracy(1e9, 1e9, 1.0 / count)
        stepper = Stepper(DORMAND_PRINCE, problem, np.zeros(1), x0[:, None], np.array([1.0 / count]), loose)
        for _ in range(count):
            stepper.step()
        assert stepper.t[0] == pytest.approx(1.0)
        errors.append(np.abs(stepper.y[:, 0] - reference).max())
    assert np.polyfit(np.log(counts), np.log(errors), 1)[0] == pytest.approx(-5, abs=0.6)


def test_dense_output_is_as_good_as_the_steps(paper: Fleet, paper_loop: ClosedLoop) -> None:
    start = random_starts(paper, 1, 0, 5.0)[0]
    fine = Dopri5(paper_loop, step=0.013, piece=2.6, tolerance=1e-9)
    times, states = next(fine.pieces(start))
    _, reference = next(Dop853(paper_loop, step=0.013, piece=2.6, tolerance=1e-13).pieces(start))
    assert times[-1] == pytest.approx(2.6)
    for one, other in zip(states, reference, strict=True):
        assert np.abs(one - other).max() < 1e-7


@pytest.mark.parametrize("number", range(3))
def test_v_falls_by_what_is_dissipated(paper: Fleet, paper_loop: ClosedLoop, number: int) -> None:
    """The energy identity V(t) - V(0) = -integral of P_v to 1e-7 of V(0), by Simpson's rule on a fine grid."""
    from scipy.integrate import simpson

    start = random_starts(paper, 3, 7, 20.0)[number]
    t, states = next(Adams(paper_loop, step=0.002, piece=20.0, tolerance=1e-12).pieces(start))
    t, states = np.r_[0.0, t], State(*(np.vstack([a, b]) for a, b in zip(start, states, strict=True)))
    V = paper_loop.translational_energy(states)
    power = energy.translational_dissipation(numpy_ops(), paper_loop.gains, states)
    assert abs(V[-1] - V[0] + simpson(power, x=t)) < 1e-7 * V[0]
    assert np.diff(V).max() < 1e-9


def test_flat_ops_are_numpy_ops(loop: ClosedLoop, draw_state) -> None:
    flat, plain, state = flat_ops(loop.plant.graph), numpy_ops(), draw_state(loop.vehicles)
    theta = np.concatenate([state.theta, np.pi * np.array([-2.0, -1.0, 0.0, 1.0, 3.0]), [1e6]])
    for name in ("sin", "cos"):
        assert np.abs(getattr(flat, name)(theta) - getattr(plain, name)(theta)).max() < 1e-9 * 1e-6 + 1e-14
    f = np.arange(loop.plant.graph.edges, dtype=float)
    assert flat.edge_sum(loop.plant.graph, f) == pytest.approx(plain.edge_sum(loop.plant.graph, f))


@pytest.mark.slow
def test_the_scale_engine_agrees_with_cvodes_at_a_hundred_vehicles() -> None:
    import tomllib
    from decimal import Decimal

    from gaincert.models.files.fleet_file import parse
    from gaincert.models.files.templates import template_text

    fleet = parse(tomllib.loads(template_text("ring", 100), parse_float=Decimal))
    from fractions import Fraction

    from gaincert.models.excitation import Excitation
    from gaincert.models.gains import Gains

    columns = [[Fraction(value)] * 100 for value in ("1", "5", "1/10", "1", "1/20")]
    gains = Gains(*(np.array(column, dtype=object) for column in columns))
    psi = Excitation(Fraction(0), Fraction(2), (Fraction(1), Fraction(0), Fraction(1, 4)))
    loop, start = ClosedLoop.of(fleet, gains, psi), random_starts(fleet, 1, 0)[0]
    found = [end(ENGINES[name][0], loop, start, 20.0, ENGINES[name][1]) for name in ("scale", "cvodes")]
    assert np.abs(found[0] - found[1]).max() < 1e-6


def test_the_engine_is_chosen_from_the_number_of_vehicles(paper_loop: ClosedLoop) -> None:
    assert engine_name("auto", 6) == "cvodes"
    assert engine_name("auto", 6, "chaos-aware") == "chaos-aware"
    assert engine_name("auto", LARGE) == "scale"
    assert engine_name("dop853", LARGE) == "dop853"
    from gaincert.models.errors import InputError

    with pytest.raises(InputError, match="engine 'euler' is not known"):
        make_integrator("euler", paper_loop, step=1.0, piece=1.0)
