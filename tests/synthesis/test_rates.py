"""The averaged cross-track flow against simulation of the equations themselves."""

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from gaincert.models.algebra.ops import numpy_ops
from gaincert.models.arrays import floats
from gaincert.models.equations import State, closed_loop
from gaincert.models.errors import UndecidedError
from gaincert.models.excitation import Excitation
from gaincert.models.fleet import Fleet
from gaincert.models.gains import Gains
from gaincert.models.paper import paper_fleet
from gaincert.models.saturation import Saturation
from gaincert.synthesis.modes import modes
from gaincert.synthesis.programs.averaged import LocalScalars, _Flow
from gaincert.synthesis.rates import CrossTrack, rates
from gaincert.synthesis.scaled_gains import Scalars, structured
from scipy.integrate import solve_ivp

PSI = Excitation(Fraction(0), Fraction(1), (Fraction("1.2"), Fraction(0), Fraction("0.3")))
TIME = 0.3**0.5  # s
UNIT = Saturation()
SCALED = Saturation(0.5, 0.4, 0.7, 1.3)
SATURATIONS = pytest.mark.parametrize("saturation", [UNIT, SCALED], ids=["unit", "scaled"])


def good(saturation: Saturation) -> Scalars:
    """Scalars with given scales and always the same local gains: those that the numbers say at unit scales."""
    length, heading, speed, turn_rate = (
        saturation.position,
        saturation.heading,
        saturation.speed,
        saturation.turn_rate,
    )
    return Scalars(
        length=length,
        time=TIME,
        mu=0.2 / (0.3 * heading),
        c=0.6 * turn_rate / heading,
        h=1.0 * length / heading,
        e=0.8 * speed / length,
        tempo=TIME,
        heading=heading,
        speed=speed * TIME / length,
        turn_rate=turn_rate * TIME,
    )


def good_gains(fleet: Fleet, saturation: Saturation = UNIT) -> Gains:
    """The gains of those scalars."""
    plant = fleet.plant()
    return structured(good(saturation), plant.m, plant.inertia, floats(fleet.graph.degree))


def one_vehicle() -> Fleet:
    return Fleet.model_validate(
        {
            "name": "one",
            "leader": {"position": [0, 0], "heading": 0},
            "graph": {"leader_links": {"a": "1.5"}},
            "vehicle": [
                {
                    "name": "a",
                    "mass": 2,
                    "inertia": "0.5",
                    "half_track": "0.2",
                    "wheel_radius": "0.1",
                    "torque_limit": 100,
                    "offset": [0, 0],
                }
            ],
        }
    )


def simulated_decay(fleet: Fleet, gains: Gains, y: np.ndarray, periods: int) -> np.ndarray:
    """y after some periods of psi, averaged over the last one, from a start on the slow manifold."""
    plant, ops = fleet.plant(), numpy_ops()
    n = len(fleet)
    aside = State(plant.offset_x + plant.leader_x, plant.offset_y + plant.leader_y, *(np.zeros(n) for _ in range(3)))
    theta = plant.leader_theta
    start = State(aside.x - y * np.sin(theta), aside.y + y * np.cos(theta), np.full(n, theta), aside.v, aside.omega)

    def rate(t: float, x: np.ndarray) -> np.ndarray:
        return np.concatenate(closed_loop(ops, plant, gains, PSI.value(ops, t), State(*x.reshape(5, n))))

    period = 2 * np.pi
    ends = np.linspace(0, periods * period, 64 * periods + 1)
    run = solve_ivp(rate, (0, ends[-1]), np.concatenate(start), "LSODA", ends, rtol=1e-11, atol=1e-13).y.reshape(
        5, n, -1
    )
    across = (run[1] - aside.y[:, None]) * np.cos(theta) - (run[0] - aside.x[:, None]) * np.sin(theta)
    return across[:, :-1].reshape(n, periods, 64).mean(axis=2)


@pytest.mark.slow
@SATURATIONS
@pytest.mark.parametrize("make", [one_vehicle, paper_fleet])
def test_the_averaged_flow_is_that_of_the_simulation(make: Callable[[], Fleet], saturation: Saturation) -> None:
    """Period means of y fall at the averaged rate within 1 %: a ratio of times, taken after transients have died."""
    fleet = make()
    plant = fleet.plant()
    gains = good_gains(fleet, saturation)
    flow = CrossTrack(plant, gains.local(), PSI)
    means = simulated_decay(fleet, gains, np.full(len(fleet), 0.02), 60)
    first, last = means[:, 20], means[:, 59]
    averaged = solve_ivp(lambda _, y: -flow.flow(y), (0, 39 * 2 * np.pi), first, "LSODA", rtol=1e-10, atol=1e-14)
    assert np.max(np.abs(last - first)) > 1e-5  # something moved
    assert last - first == pytest.approx(averaged.y[:, -1] - first, rel=0.01)


def test_one_vehicle_has_the_closed_form_kappa() -> None:
    """docs/theory.md 7.2: kappa = 1/2 sum |G A|^2 Re(i w F)."""
    fleet = one_vehicle()
    plant = fleet.plant()
    gains = good_gains(fleet)
    a, kappa = 1.5, 0.0
    p_w, d_w, k, p_v, d_v = (float(getattr(gains, key)[0]) for key in ("p_omega", "d_omega", "k_alpha", "p_v", "d_v"))
    for w, A in ((1.0, 1.2), (3.0, 0.3)):
        G = k * a / (p_w * a - 0.5 * w**2 + 1j * d_w * w)
        F = p_v * a / (p_v * a - 2 * w**2 + 1j * d_v * w)
        kappa += 0.5 * abs(G * A) ** 2 * (1j * w * F).real
    assert CrossTrack(plant, gains, PSI).flow(np.array([1.0]))[0] == pytest.approx(kappa, rel=1e-12)


def test_the_flow_is_cubic_and_the_tail_time_follows_it() -> None:
    fleet = one_vehicle()
    plant = fleet.plant()
    track = CrossTrack(plant, good_gains(fleet), PSI)
    kappa = track.flow(np.array([1.0]))[0]
    assert track.flow(np.array([0.1]))[0] == pytest.approx(kappa / 1000, rel=1e-12)
    time, coefficient = track.time_to(np.array([1.0]), 0.1, 10.0)
    assert coefficient == pytest.approx(kappa, rel=1e-3)
    assert time == pytest.approx((1 / 0.1**2 - 1) / (2 * kappa), rel=1e-3)
    slower, _ = track.time_to(np.array([1.0]), 0.1, 0.1 * float(track.swing(np.array([0.05]))[0]) / 0.05 / 2)
    assert slower > time  # a tighter heading tolerance takes longer
    assert track.time_to(np.array([0.05]), 0.1, 10.0)[0] == 0  # it is there already


@SATURATIONS
def test_the_programs_flow_is_the_flow(saturation: Saturation) -> None:
    """The modal form that IPOPT sees equals the vehicle form, in every direction."""
    fleet = paper_fleet()
    plant = fleet.plant()
    D = floats(fleet.graph.degree)
    slow = modes(plant.graph)
    flow = _Flow(slow, D, PSI, LocalScalars.of(good(saturation), good(saturation).frequency))
    track = CrossTrack(plant, good_gains(fleet, saturation).local(), PSI)
    for direction in np.random.default_rng(0).normal(size=(5, 6)):
        y = slow.vectors @ direction
        expected = (y * D) @ track.flow(y) * D.sum() / (y @ (D * y)) ** 2
        assert float(flow.decay(direction)) == pytest.approx(expected, rel=1e-9)


def test_rates_are_those_of_the_local_gains() -> None:
    """Near the goal scales only divide gains: rates do not change with them, while with the same raw gains they do."""
    fleet = paper_fleet()
    plant = fleet.plant()
    unit, scaled = (rates(plant, good_gains(fleet, one), PSI) for one in (UNIT, SCALED))
    for name in ("gamma_omega", "gamma_v", "kappa", "tail_time"):
        assert getattr(scaled, name) == pytest.approx(getattr(unit, name), rel=1e-4), name
    raw = rates(plant, replace(good_gains(fleet), saturation=SCALED), PSI)
    assert abs(raw.gamma_v / unit.gamma_v - 1) > 0.1
    assert abs(raw.gamma_omega / unit.gamma_omega - 1) > 0.1


@SATURATIONS
def test_scalars_of_a_fleet_are_its_local_scalars(saturation: Saturation) -> None:
    """The six numbers of the averaged program say the local gains of every vehicle."""
    fleet = paper_fleet()
    plant, D = fleet.plant(), floats(fleet.graph.degree)
    local, near = good_gains(fleet, saturation).local(), LocalScalars.of(good(saturation), 1.0)
    assert plant.inertia / (local.p_omega * D) == pytest.approx(np.full(len(fleet), near.mu_omega))
    assert local.d_omega / (local.p_omega * D) == pytest.approx(np.full(len(fleet), near.c))
    assert local.k_alpha / local.p_omega == pytest.approx(np.full(len(fleet), near.h))
    assert plant.m / (local.p_v * D) == pytest.approx(np.full(len(fleet), near.mu_v))
    assert local.d_v / (local.p_v * D) == pytest.approx(np.full(len(fleet), near.e))
    assert tuple(near) == pytest.approx((0.2, 0.6, 1.0, 0.3, 0.8, 1.0))


def test_numbers_beyond_floating_point_are_undecided_and_no_crash() -> None:
    one = one_vehicle().model_dump(by_alias=True)
    vehicles = [{**one["vehicle"][0], "name": name} for name in "ab"]
    graph = {"edges": [["a", "b"]], "leader_links": {"a": "1e-50"}}
    weak = Fleet.model_validate({**one, "graph": graph, "vehicle": vehicles})
    psi = Excitation(Fraction(1), Fraction(1), (Fraction(1),))
    with pytest.raises(UndecidedError, match="the response to psi at 0 rad/s is singular in floating point"):
        CrossTrack(weak.plant(), Gains(*(np.ones(2) for _ in range(5))), psi)
