"""The conditions: the paper's numbers, exactness to the last place, and their promises about torque and speed."""

import itertools
import math
from dataclasses import replace
from fractions import Fraction

import casadi as ca
import numpy as np
import pytest
import sympy as sp
from gaincert.models import conditions
from gaincert.models.algebra.cvxpy_arrays import Elementwise, plain
from gaincert.models.algebra.ops import numpy_ops
from gaincert.models.conditions import (
    ConditionData,
    Inequality,
    casadi_numbers,
    cvxpy_numbers,
    exact_numbers,
    float_numbers,
    sympy_numbers,
)
from gaincert.models.enclosures import atanh_above, sqrt_above, tanh_below
from gaincert.models.equations import State, closed_loop, control
from gaincert.models.excitation import Excitation
from gaincert.models.fleet import Fleet
from gaincert.models.gains import GAIN_NAMES, Gains
from scipy.integrate import solve_ivp

ALL = (
    conditions.condition_15,
    conditions.condition_15_prime,
    conditions.condition_16,
    conditions.condition_16_star,
    conditions.speed_condition,
    conditions.turn_rate_condition,
    conditions.acceleration_condition,
    conditions.turn_acceleration_condition,
)
PRINTED = (conditions.condition_15, conditions.condition_16, conditions.condition_16_star)  # (15), (16), (16*)
LAST_PLACE = Fraction(1, 10**36)  # relative; the enclosures are tighter than that


def column(values):
    array = np.empty(len(values := list(values)), dtype=object)
    array[:] = values
    return array


def floats(values):
    return np.asarray(values, dtype=float)


def with_gain(gains, name, values):
    return replace(gains, **{name: values})


@pytest.fixture
def data(fleet, psi, random):
    """The exact data of the conditions for every graph family and drive, with random limits of speed."""

    def some():
        return column(Fraction(int(q), 100) for q in random.integers(5, 300, len(fleet)))

    names = ("speed", "turn_rate", "wheel_speed", "acceleration", "turn_acceleration")
    return replace(fleet.condition_data(psi), **{name: some() for name in names})


@pytest.fixture
def exact_gains(fleet, draw_gains):
    return draw_gains(len(fleet))


# -- the paper's numbers ----------------------------------------------------------------------------------------------


@pytest.fixture
def paper_data(paper, psi_of_paper):
    return paper.condition_data(psi_of_paper)


def test_the_numbers_of_15_on_the_paper_s_data(paper_data, gains_of_paper):
    c = floats(conditions.excitation_bound(exact_numbers(), paper_data, gains_of_paper))
    needed = c / math.tanh(1)
    assert needed == pytest.approx([27.0997, 58.7161, 27.0997, 58.7161, 27.0997, 27.0997], abs=5e-5)


def test_the_numbers_of_16_on_the_paper_s_data(paper_data, gains_of_paper):
    sums = conditions.condition_16(exact_numbers(), paper_data, gains_of_paper)
    assert floats(sums.small) == pytest.approx([653.27, 1302.15, 753.11, 1489.10, 503.52, 503.52], abs=5e-3)
    assert list(sums.large) == [1320, 1320, Fraction(4480, 3), Fraction(4480, 3), 504, 504]


def test_16_is_a_few_percent_conservative_on_the_paper_s_data(paper_data, gains_of_paper):
    numbers = exact_numbers()
    torque_of_16 = conditions.condition_16(numbers, paper_data, gains_of_paper).small
    torque_of_16 = torque_of_16 * paper_data.r / (2 * paper_data.arm)
    excess = floats(torque_of_16 / conditions.torque_bound(numbers, paper_data, gains_of_paper)) - 1
    assert [excess.min(), excess.max()] == pytest.approx([0.02551, 0.03646], abs=5e-6)


def test_the_saturation_paragraph_omits_a_term(paper_data, gains_of_paper):
    """ubar_omega of vehicles 2 and 4: 180.42 by Proposition 1; the proof's closing paragraph prints 146.02."""
    turning = conditions.turning_bound(exact_numbers(), paper_data, gains_of_paper)
    proposition = floats(gains_of_paper.d_omega + turning)
    led = floats([0, 10, 0, 10, 0, 0])
    omitted = math.sqrt(2) * floats(gains_of_paper.k_alpha) * float(paper_data.psi_bar) * led
    assert proposition[[1, 3]] == pytest.approx(180.42, abs=5e-3)
    assert (proposition - omitted)[[1, 3]] == pytest.approx(146.02, abs=5e-3)


def test_the_paper_s_gains_are_accepted(paper_data, gains_of_paper):
    for condition in PRINTED:
        assert condition(exact_numbers(), paper_data, gains_of_paper).holds.all()


@pytest.mark.parametrize("vehicle", range(6))
def test_each_tightened_limit_is_refused_for_that_vehicle_alone(vehicle, paper_data, gains_of_paper):
    numbers = exact_numbers()

    def refused(condition, data, gains):
        return list(np.flatnonzero(~condition(numbers, data, gains).holds.astype(bool)))

    needed = conditions.excitation_bound(numbers, paper_data, gains_of_paper) / tanh_below(Fraction(1))
    d_omega = gains_of_paper.d_omega.copy()
    d_omega[vehicle] = needed[vehicle] * (1 - LAST_PLACE)
    assert refused(conditions.condition_15, paper_data, with_gain(gains_of_paper, "d_omega", d_omega)) == [vehicle]
    d_omega[vehicle] = needed[vehicle]
    assert refused(conditions.condition_15, paper_data, with_gain(gains_of_paper, "d_omega", d_omega)) == []

    sums = conditions.condition_16(numbers, paper_data, gains_of_paper).small
    for condition, least, at_equality in (
        (conditions.condition_16, sums * paper_data.r / (2 * paper_data.arm), [vehicle]),  # strict
        (conditions.condition_16_star, conditions.torque_bound(numbers, paper_data, gains_of_paper), []),
    ):
        torque = paper_data.torque.copy()
        for factor, expected in ((1 - LAST_PLACE, [vehicle]), (1, at_equality), (1 + LAST_PLACE, [])):
            torque[vehicle] = least[vehicle] * factor
            assert refused(condition, replace(paper_data, torque=torque), gains_of_paper) == expected


def test_the_smaller_of_the_two_torque_limits_counts(paper, psi_of_paper):
    content = paper.model_dump(by_alias=True)
    content["vehicle"][0]["torque_limit"] = {"left": 55, "right": 50}
    content["vehicle"][1]["torque_limit"] = {"left": 40, "right": 70}
    assert list(Fleet.model_validate(content).condition_data(psi_of_paper).torque[:3]) == [50, 40, 160]


def test_a_physical_drive_has_half_the_arm(content, psi):
    arms = {
        drive: Fleet.model_validate({**content, "drive": drive}).condition_data(psi).arm
        for drive in ("physical", "paper")
    }
    half_track = [Fraction(vehicle["half_track"]) for vehicle in content["vehicle"]]
    assert list(arms["physical"]) == half_track
    assert list(arms["paper"]) == [2 * R for R in half_track]


# -- the theorem's own words -------------------------------------------------------------------------------------------


def as_printed(D, bar, r, arm, torque, speed, turn_rate, a, a_turn, m, inertia, p_v, d_v, p_omega, d_omega, k, s, o):
    """Both sides of every condition for one vehicle, typed once more from the theorem."""
    c = math.sqrt(2) * k * bar * D
    cone = d_v + math.sqrt(2) * D * math.hypot(p_v, k * bar / arm) + (d_omega + p_omega * D) / arm
    return {
        "(15)": (c, d_omega * math.tanh(1)),
        "(15')": (p_omega * D + c, d_omega),
        "(16)": (arm * (d_v + math.sqrt(2) * p_v * D) + d_omega + p_omega * D + c, 2 * arm * torque / r),
        "(16*)": (r / 2 * cone, torque),
        "speed limit": (math.sqrt(2) * p_v * D, d_v * math.tanh(speed / s)),
        "turn rate limit": (p_omega * D + c, d_omega * math.tanh(turn_rate / o)),
        "acceleration limit": (d_v + math.sqrt(2) * p_v * D, a * m),
        "turn acceleration limit": (d_omega + p_omega * D + c, a_turn * inertia),
    }


def test_the_conditions_are_those_of_the_theorem(data, exact_gains):
    numbers = {
        **{field: floats(values) for field, values in vars(data).items()},
        **{name: floats(getattr(exact_gains, name)) for name in GAIN_NAMES},
        "s": floats(exact_gains.saturation.speed),
        "o": floats(exact_gains.saturation.turn_rate),
    }
    bar = float(numbers.pop("psi_bar"))
    inequalities = [condition(float_numbers(), data.map(floats), exact_gains.map(floats)) for condition in ALL]
    motion = ("speed", "turn_rate", "acceleration", "turn_acceleration")
    names = ("degree", "r", "arm", "torque", *motion, "m", "inertia", *GAIN_NAMES, "s", "o")
    for i, (D, *own) in enumerate(zip(*(numbers[name] for name in names), strict=True)):
        expected = as_printed(D, bar, *own)
        assert [sides.source for sides in inequalities] == list(expected)
        for sides, (small, large) in zip(inequalities, expected.values(), strict=True):
            assert (sides.small[i], sides.large[i]) == pytest.approx((small, large), rel=1e-13)


# -- one law, five algebras -------------------------------------------------------------------------------------------


def in_sympy(condition, data, gains):
    rational = np.frompyfunc(sp.Rational, 1, 1)
    exact = condition(sympy_numbers(), data.map(rational), gains.map(rational))
    return exact.small, exact.large


def in_casadi(condition, data, gains):
    columns = (ca.MX.sym(name, len(data.degree)) for name in GAIN_NAMES)
    symbols = Gains(*columns, gains.saturation.map(floats).map(ca.DM))
    inequality = condition(casadi_numbers(), data.map(floats).map(ca.DM), symbols)
    arguments = [getattr(symbols, name) for name in GAIN_NAMES]
    values = ca.Function("f", arguments, [inequality.small, ca.MX(inequality.large)]).call(
        [ca.DM(floats(getattr(gains, name))) for name in GAIN_NAMES]
    )
    return [np.array(value).ravel() for value in values]


def in_cvxpy(condition, data, gains):
    import cvxpy as cp

    n = len(data.degree)
    columns = (Elementwise(cp.Variable(n, pos=True)) for _ in GAIN_NAMES)
    variables = Gains(*columns, gains.saturation.map(floats))
    for name in GAIN_NAMES:
        getattr(variables, name).expression.value = floats(getattr(gains, name))
    inequality = condition(cvxpy_numbers(), data.map(floats), variables)
    constraint = inequality.small <= inequality.large
    assert constraint.is_dcp()
    small, large = plain(inequality.small), plain(inequality.large)
    return small.value, large.value if hasattr(large, "value") else large


@pytest.mark.parametrize("condition", ALL, ids=lambda condition: condition.__name__)
def test_every_algebra_gives_the_same_numbers(condition, data, exact_gains):
    small, large = in_sympy(condition, data, exact_gains)
    fractions = condition(exact_numbers(), data, exact_gains)
    for exact, safe, sign in ((small, fractions.small, 1), (large, fractions.large, -1)):
        for truth, enclosure in zip(exact, safe, strict=True):
            excess = sign * (sp.Rational(enclosure) - truth)  # fractions err in the direction that refuses
            assert excess.evalf(20, maxn=200) >= 0 or excess.equals(0)
            assert abs(excess.evalf(20, maxn=200)) <= truth.evalf() * sp.Rational(LAST_PLACE)
    expected = [floats([sp.N(truth, 20) for truth in side]) for side in (small, large)]
    by_float = condition(float_numbers(), data.map(floats), exact_gains.map(floats))
    for sides in (
        (by_float.small, by_float.large),
        in_casadi(condition, data, exact_gains),
        in_cvxpy(condition, data, exact_gains),
    ):
        for side, truth in zip(sides, expected, strict=True):
            assert np.broadcast_to(side, truth.shape) == pytest.approx(truth, rel=1e-13)


@pytest.mark.parametrize("condition", ALL, ids=lambda condition: condition.__name__)
def test_small_is_homogeneous_in_the_gains_it_names(condition, data, exact_gains):
    numbers = float_numbers()
    data, gains = data.map(floats), exact_gains.map(floats)
    before = condition(numbers, data, gains)
    scaled = replace(gains, **{name: 3 * getattr(gains, name) for name in before.scaled})
    after = condition(numbers, data, scaled)
    assert after.small == pytest.approx(3 * before.small, rel=1e-13)
    assert after.large == pytest.approx(before.large, rel=1e-15)
    for name in GAIN_NAMES:
        moved = condition(numbers, data, with_gain(gains, name, 2 * getattr(gains, name)))
        assert (name in before.scaled) == bool((moved.small != before.small).any())


def test_without_a_limit_none_is_imposed(fleet, psi, exact_gains):
    """If one vehicle has a limit, the others have none, whatever their gains."""
    data = fleet.condition_data(psi)
    one = replace(data, speed=data.speed.copy(), turn_rate=data.turn_rate.copy())
    one.speed[0] = one.turn_rate[0] = Fraction(1, 100)
    wild = replace(exact_gains, p_v=exact_gains.p_v * 10**9, p_omega=exact_gains.p_omega * 10**9)
    for numbers, convert in ((exact_numbers(), lambda a: a), (float_numbers(), floats)):
        for condition in (conditions.speed_condition, conditions.turn_rate_condition):
            holds = condition(numbers, one.map(convert), wild.map(convert)).holds
            assert not holds[0]
            assert all(holds[1:])


def test_elementwise_arithmetic_is_that_of_arrays(random):
    import cvxpy as cp

    x, y = random.uniform(1, 2, (2, 4))
    constant = Elementwise(cp.Constant(x))
    pairs = [(constant + y, x + y), (y + constant, y + x), (constant - y, x - y), (y - constant, y - x)]
    pairs += [(constant * y, x * y), (y * constant, y * x), (constant / y, x / y), (constant + constant, 2 * x)]
    for affine, expected in pairs:
        assert affine.expression.value == pytest.approx(expected, rel=1e-15)


# -- exactness --------------------------------------------------------------------------------------------------------


def one_vehicle(torque, **changes):
    """D = 1, arm 1, r = 2, psi_bar = 1: T of (16*) is d_v + sqrt(2 (p_v^2 + k^2)) + d_omega + p_omega."""
    one = column([Fraction(1)])
    names = ("degree", "arm", "speed", "turn_rate", "wheel_speed", "acceleration", "turn_acceleration", "m", "inertia")
    values = {**dict.fromkeys((*names, "longest_arm", "smallest_r"), one), "r": 2 * one, **changes}
    return ConditionData(psi_bar=Fraction(1), torque=column([Fraction(torque)]), **values)


# sqrt(2 (1 + 49)) = 10, so T = 0.1 + 10 + 0.3 + 0.2 = 10.6 exactly.
RATIONAL_GAINS = Gains(*(column([Fraction(text)]) for text in ("1", "0.1", "0.2", "0.3", "7")))


def test_16_star_accepts_equality_and_refuses_one_unit_in_the_last_place_beyond():
    numbers = exact_numbers()
    assert list(conditions.torque_bound(numbers, one_vehicle("10.6"), RATIONAL_GAINS)) == [Fraction("10.6")]
    for beyond in (Fraction("1e-15"), Fraction("1e-60"), Fraction(1, 10**300)):
        for limit, holds in (("10.6", True), (Fraction("10.6") - beyond, False), (Fraction("10.6") + beyond, True)):
            assert list(conditions.condition_16_star(numbers, one_vehicle(limit), RATIONAL_GAINS).holds) == [holds]


def test_floats_cannot_tell():
    """Verdicts never use floats: they miss 1e-17 N m beyond the limit."""
    data = one_vehicle(Fraction("10.6") - Fraction("1e-17")).map(floats)
    assert conditions.condition_16_star(float_numbers(), data, RATIONAL_GAINS.map(floats)).holds.all()


@pytest.mark.parametrize(("strict", "at_equality"), [(False, True), (True, False)])
def test_a_strict_inequality_refuses_equality(strict, at_equality):
    a, more = column([Fraction(1, 3)]), column([Fraction(1, 3) + Fraction(1, 10**300)])
    assert list(Inequality("", "", a, a, (), strict).holds) == [at_equality]
    assert list(Inequality("", "", a, more, (), strict).holds) == [True]
    assert list(Inequality("", "", more, a, (), strict).holds) == [False]
    assert list(Inequality("", "", a, more, (), strict).margin) == [Fraction(1, 10**300)]


def test_which_conditions_are_strict(paper_data, gains_of_paper):
    strict = [condition(exact_numbers(), paper_data, gains_of_paper).strict for condition in ALL]
    assert strict == [False, True, True, False, False, False, False, False]


@pytest.mark.parametrize(
    ("condition", "gain"),
    [
        (conditions.condition_15, "d_omega"),
        (conditions.condition_15_prime, "d_omega"),
        (conditions.speed_condition, "d_v"),
        (conditions.turn_rate_condition, "d_omega"),
    ],
    ids=lambda value: getattr(value, "__name__", value),
)
def test_verdicts_flip_at_the_true_threshold(condition, gain, data, exact_gains):
    """The threshold in the damping gain by SymPy to 60 digits; 1e-36 of it to either side decides."""
    small, large = in_sympy(condition, data, exact_gains)
    for factor, holds in ((1 + LAST_PLACE, True), (1 - LAST_PLACE, False)):
        values = [
            Fraction(str(sp.N(needed / (room / sp.Rational(own)), 60))) * factor
            for needed, room, own in zip(small, large, getattr(exact_gains, gain), strict=True)
        ]
        verdict = condition(exact_numbers(), data, with_gain(exact_gains, gain, column(values)))
        assert (verdict.holds == holds).all()


ROOTS = ["0", "4", "9/16", "2", "1/3", "1e-60", "1e60", "123456789.123456789", "2e-7", "1.1", "1e90", "1e91", "3e120"]


@pytest.mark.parametrize("text", ROOTS)
def test_roots_are_rounded_up_or_exact(text):
    q = Fraction(text)
    root = sqrt_above(q)
    assert root**2 >= q
    assert (root * (1 - Fraction(1, 10**40))) ** 2 <= q
    exact = math.isqrt(q.numerator) ** 2 == q.numerator and math.isqrt(q.denominator) ** 2 == q.denominator
    assert (root**2 == q) == exact
    if not exact:  # and in no more digits than that takes
        assert len(str(root.numerator)) <= max(41, len(str(math.isqrt(q.numerator * q.denominator))))


@pytest.mark.parametrize("q", [Fraction(1), Fraction("0.22"), Fraction("1e-9"), Fraction("20"), Fraction(10**60), 0.5])
def test_tanh_is_rounded_down(q):
    import mpmath

    with mpmath.workdps(150):
        below, exact = tanh_below(q), mpmath.tanh(mpmath.mpf(Fraction(q).numerator) / Fraction(q).denominator)
        low = mpmath.mpf(below.numerator) / below.denominator
        assert low <= exact
        assert exact - low <= mpmath.mpf("1.01e-40")
    assert below < 1


def test_no_limit_is_infinity():
    assert tanh_below(math.inf) == math.inf


# -- what the conditions promise --------------------------------------------------------------------------------------


@pytest.fixture
def wild(fleet, random):
    """States near, far and very far from the goal, fast and slow: (5000, N)."""
    size = np.exp(random.uniform(-3, 6, (5, 5000, 1)))
    return State(*(size * random.uniform(-1, 1, (5, 5000, len(fleet)))))


def torques(fleet, gains, psi, t, state):
    """Both wheel torques; t is an array of times, one per member of the batch."""
    ops, plant = numpy_ops(), fleet.plant()
    now = psi.value(ops, np.asarray(t)[..., None])
    return control(ops, plant, gains, now, state)


def test_the_torque_never_passes_its_bound(fleet, gains, psi, wild, random):
    bound = conditions.torque_bound(float_numbers(), fleet.condition_data(psi).map(floats), gains)
    for torque in torques(fleet, gains, psi, random.uniform(0, 10, 5000), wild):
        assert (np.abs(torque) <= bound * (1 + 1e-12)).all()


def test_the_torque_comes_arbitrarily_close_to_its_bound(fleet, gains, psi):
    """T_i is the supremum: both wheels, both signs, every vehicle, by the state that the proof of (16*) names."""
    bound = conditions.torque_bound(float_numbers(), fleet.condition_data(psi).map(floats), gains)
    plant, n = fleet.plant(), len(fleet)
    period = 2 * math.pi / float(psi.frequency)
    grid = np.linspace(0, period, 200_001)
    values = psi.value(numpy_ops(), grid)
    peak = np.argmax(np.abs(values))
    instant, top = grid[peak], values[peak]
    goal = (plant.leader_x + plant.offset_x, plant.leader_y + plant.offset_y)
    for i in range(n):
        far = 60.0 * (np.arange(n) == i)
        for side, turn in ((0, 1 / plant.arm[i]), (1, -1 / plant.arm[i])):
            # The torque is r/2 [ -p_v phi^T e_z + turn k psi phi_perp^T e_z + ... ]; it pairs e_z = D (1, 1) with the
            # vector (-p_v, turn k psi) turned by theta, and is largest where that points along (1, 1).
            lean = math.atan2(turn * gains.k_alpha[i] * top, -gains.p_v[i])
            heading = math.pi / 4 - lean
            for sign in (1, -1):
                # Far to one side in heading as well; whole turns leave phi as it is.
                theta = plant.leader_theta + np.zeros(n)
                theta[i] = heading + (sign < 0) * math.pi - sign * np.sign(turn) * 40 * math.pi
                v = -sign * far
                omega = -sign * np.sign(turn) * far
                state = State(goal[0] + far, goal[1] + far, theta, v, omega)
                torque = torques(fleet, gains, psi, instant, state)[side][i]
                assert sign * torque == pytest.approx(bound[i], rel=1e-7)
                assert sign * torque <= bound[i] * (1 + 1e-12)


@pytest.mark.parametrize(
    "mutant",
    [
        lambda d_v, d_w, p_v, p_w, kappa, D, arm: d_v + math.sqrt(2) * D * max(p_v, kappa) + (d_w + p_w * D) / arm,
        lambda d_v, d_w, p_v, p_w, kappa, D, arm: d_v + D * math.hypot(p_v, kappa) + (d_w + p_w * D) / arm,
    ],
    ids=["max for the root", "without sqrt2"],
)
def test_weaker_forms_of_16_star_are_broken(mutant):
    """Witnesses for mutants of docs/theory.md 8: one vehicle, a torque above the bound that they claim."""
    gains = Gains(*(np.array([value]) for value in (1.0, 0.1, 0.2, 0.3, 1.0)))
    psi = Excitation(Fraction(0), Fraction(1), (Fraction(1),))
    data = one_vehicle("1").map(floats)
    assert conditions.torque_bound(float_numbers(), data, gains)[0] == pytest.approx(0.1 + 2 + 0.5)
    keys = ("mass", "inertia", "half_track", "wheel_radius", "torque_limit")
    fleet = Fleet.model_validate(
        {
            "name": "one",
            "leader": {"position": [0, 0], "heading": 0},
            "graph": {"leader_links": {"v": 1}},
            "vehicle": [{"name": "v", **dict.fromkeys(keys, 1), "wheel_radius": 2, "offset": [0, 0]}],
        }
    )
    state = State(*(np.array([value]) for value in (60.0, 60.0, 41 * math.pi, -60.0, 60.0)))
    reached = max(np.abs(torque).max() for torque in torques(fleet, gains, psi, math.pi / 2, state))
    claimed = mutant(0.1, 0.3, 1.0, 0.2, 1.0, 1.0, 1.0)
    assert claimed < reached <= 2.6


def test_16_implies_16_star(data, exact_gains):
    """Even where (16) holds by a hair, (16*) holds with room; and (16*) does not imply (16)."""
    numbers = exact_numbers()
    sums = conditions.condition_16(numbers, data, exact_gains).small
    least = sums * data.r / (2 * data.arm)
    just = replace(data, torque=least * (1 + LAST_PLACE))
    assert conditions.condition_16(numbers, just, exact_gains).holds.all()
    assert (conditions.condition_16_star(numbers, just, exact_gains).margin > 0).all()
    exact = replace(data, torque=conditions.torque_bound(numbers, data, exact_gains))
    assert conditions.condition_16_star(numbers, exact, exact_gains).holds.all()
    assert not conditions.condition_16(numbers, exact, exact_gains).holds.any()


def test_intervals_are_judged_by_their_worst_case(content, psi, random, draw_gains):
    """A vehicle known within 5 percent: a condition that holds for the interval holds for every vehicle in it."""
    numbers = exact_numbers()
    keys = ("mass", "inertia", "half_track", "wheel_radius", "torque_limit")

    def around(text):
        return [Fraction(text) * Fraction(95, 100), Fraction(text) * Fraction(105, 100)]

    vehicles = [{**vehicle, **{key: around(vehicle[key]) for key in keys}} for vehicle in content["vehicle"]]
    fleet = Fleet.model_validate({**content, "vehicle": vehicles})
    gains = draw_gains(len(fleet))
    worst = fleet.condition_data(psi)
    hit = False
    for corner in range(8):
        inside = [
            {
                **vehicle,
                **{
                    key: vehicle[key][(corner >> place) & 1]
                    for place, key in enumerate(("half_track", "wheel_radius", "torque_limit"))
                },
                "mass": random.choice(vehicle["mass"]),
            }
            for vehicle in vehicles
        ]
        point = Fleet.model_validate({**content, "vehicle": inside}).condition_data(psi)
        for condition, room in (
            (conditions.condition_16_star, 1),
            (conditions.condition_16, point.r / (2 * point.arm)),
        ):
            margin = condition(numbers, point, gains).margin * room
            bound = condition(numbers, worst, gains).margin * (room if condition is conditions.condition_16_star else 1)
            if condition is conditions.condition_16:
                bound = bound * worst.r / (2 * worst.arm)
            assert (margin >= bound).all()
            hit = hit or bool((margin == bound).all())
    assert hit  # the worst case is one of the corners, so it is not overdone


def run(fleet, gains, psi, state, horizon):
    """Speeds and turn rates along the closed loop, (samples, N) each."""
    plant, n = fleet.plant(), len(fleet)

    ops = numpy_ops()

    def rhs(t, y):
        return np.concatenate(closed_loop(ops, plant, gains, psi.value(ops, t), State(*y.reshape(5, n))))

    done = solve_ivp(rhs, (0, horizon), np.concatenate(state), method="LSODA", rtol=1e-8, atol=1e-10, max_step=0.1)
    assert done.success
    _, _, _, v, omega = done.y.reshape(5, n, -1)
    return np.abs(v).max(axis=1), np.abs(omega).max(axis=1)


@pytest.mark.parametrize("family", ["single", "line", "weighted", "paper"], indirect=True)
def test_speed_and_turn_rate_limits_are_invariant(fleet, psi, draw_gains, draw_state, random):
    """Gains that meet both limits with equality: from within them, at them or at rest, no vehicle passes them."""
    n, data, gains = len(fleet), fleet.condition_data(psi).map(floats), draw_gains(len(fleet)).map(floats)
    speed, turn_rate = random.uniform(0.2, 1.5, (2, n))
    numbers = float_numbers()
    gains = replace(
        gains,
        d_v=conditions.pulling_bound(numbers, data, gains) / np.tanh(speed / gains.saturation.speed),
        d_omega=conditions.turning_bound(numbers, data, gains) / np.tanh(turn_rate / gains.saturation.turn_rate),
    )
    for share in (0.0, 1.0):
        state = draw_state(n)
        away = State(
            40 * state.x,
            40 * state.y,
            3 * state.theta,
            share * speed * np.sign(state.v),
            share * turn_rate * np.sign(state.omega),
        )
        fastest, quickest = run(fleet, gains, psi, away, 2.0)
        assert (fastest <= speed * (1 + 1e-7)).all()
        assert (quickest <= turn_rate * (1 + 1e-7)).all()


@pytest.mark.parametrize("family", ["single"], indirect=True)
def test_the_speed_limit_is_approached(fleet, psi, draw_gains):
    """A vehicle that heads straight for a far goal runs at the limit, so the limit is not idle."""
    data, gains = fleet.condition_data(psi).map(floats), draw_gains(1).map(floats)
    gains = replace(
        gains, d_v=conditions.pulling_bound(float_numbers(), data, gains) / np.tanh(0.7 / gains.saturation.speed)
    )
    plant = fleet.plant()
    ahead = replace(plant, leader_theta=math.pi / 4)
    start = State(
        plant.leader_x + plant.offset_x - 500,
        plant.leader_y + plant.offset_y - 500,
        np.array([math.pi / 4]),
        np.zeros(1),
        np.zeros(1),
    )

    ops = numpy_ops()

    def rhs(t, y):
        return np.concatenate(closed_loop(ops, ahead, gains, psi.value(ops, t), State(*y.reshape(5, 1))))

    horizon = 50 * float(plant.m[0] / gains.d_v[0])
    done = solve_ivp(rhs, (0, horizon), np.concatenate(start), rtol=1e-9, atol=1e-12)
    assert 0.7 * (1 - 1e-6) < done.y[3].max() <= 0.7 * (1 + 1e-9)


# -- limits of wheels and accelerations --------------------------------------------------------------------------------


def test_the_wheel_speed_condition_is_that_of_its_parts(data, exact_gains):
    """s atanh(sqrt2 p_v D / d_v) + arm o atanh((p_omega D + c) / d_omega) <= r W, in floats and in fractions."""
    gains = replace(exact_gains, p_v=exact_gains.p_v / 10**4, p_omega=exact_gains.p_omega / 10**4)
    gains = replace(gains, k_alpha=exact_gains.k_alpha / 10**4)
    by_float = conditions.wheel_speed_condition(float_numbers(), data.map(floats), gains.map(floats))
    exact = conditions.wheel_speed_condition(exact_numbers(), data, gains)
    assert floats(exact.small) == pytest.approx(by_float.small, rel=1e-12)
    V = floats(gains.saturation.speed) * np.arctanh(math.sqrt(2) * floats(gains.p_v * data.degree / gains.d_v))
    moment = floats(gains.p_omega * data.degree) + math.sqrt(2) * float(data.psi_bar) * floats(
        gains.k_alpha * data.degree
    )
    Omega = floats(gains.saturation.turn_rate) * np.arctanh(moment / floats(gains.d_omega))
    assert by_float.small == pytest.approx(V + floats(data.longest_arm) * Omega, rel=1e-12)
    assert by_float.large == pytest.approx(floats(data.smallest_r * data.wheel_speed), rel=1e-15)


def test_a_wheel_that_the_controller_can_drive_without_bound_keeps_no_limit(data, exact_gains):
    wild = replace(exact_gains, p_v=exact_gains.p_v * 10**9)
    assert not conditions.wheel_speed_condition(exact_numbers(), data, wild).holds.any()


def test_lowering_the_named_gains_lowers_the_wheel_speed_in_proportion_or_more(data, exact_gains):
    small = {}
    for factor in (Fraction(1, 10**5), Fraction(1, 10**6)):
        names = ("p_v", "p_omega", "k_alpha")
        gains = replace(exact_gains, **{name: getattr(exact_gains, name) * factor for name in names})
        small[factor] = floats(conditions.wheel_speed_condition(exact_numbers(), data, gains).small)
    assert (small[Fraction(1, 10**6)] <= small[Fraction(1, 10**5)] / 10 * (1 + 1e-12)).all()


@pytest.mark.parametrize("q", [Fraction(1, 10**30), Fraction(1, 3), Fraction("0.999"), 1 - Fraction(1, 10**50)])
def test_atanh_from_above(q):
    import mpmath

    with mpmath.workdps(150):
        above, exact = atanh_above(q), mpmath.atanh(mpmath.mpf(q.numerator) / q.denominator)
        assert 0 <= mpmath.mpf(above.numerator) / above.denominator - exact <= mpmath.mpf(10) ** -39
    assert atanh_above(Fraction(1)) == atanh_above(Fraction(3, 2)) == math.inf


def with_wheels(content, radius, half_track):
    """A fleet whose first vehicle has wheels of unknown inertia, and the factor of R in its lever arm."""
    vehicle = content["vehicle"][0]
    vehicle |= {"mass": "3", "inertia": "0.05", "half_track": half_track, "wheel_radius": radius}
    vehicle["wheel_inertia"] = ["0.001", "0.003"]
    fleet = Fleet.model_validate(content)
    data = fleet.condition_data(Excitation(Fraction(0), Fraction(1), (Fraction(1),)))
    return fleet, data, 2 if fleet.drive == "paper" else 1


def test_spinning_wheels_count_as_mass_and_inertia(content):
    """m + 2 J / r^2 and I + 2 J (arm / r)^2, in the plant and, as the least ones, in the conditions."""
    fleet, data, factor = with_wheels(content, "0.05", "0.2")
    plant = fleet.plant()
    assert plant.m[0] == pytest.approx(3 + 2 * 0.002 / 0.05**2)
    assert plant.inertia[0] == pytest.approx(0.05 + 2 * 0.002 * (factor * 0.2 / 0.05) ** 2)
    assert data.m[0] == 3 + 2 * Fraction("0.001") / Fraction("0.05") ** 2
    assert data.inertia[0] == Fraction("0.05") + 2 * Fraction("0.001") * (factor * Fraction(4)) ** 2


def test_a_vehicle_may_have_other_wheels_than_its_controller_takes_it_to_have(content):
    """It then moves as one of mass (m + 2 J / r'^2) r' / r, and of another inertia: the conditions take the least."""
    _, data, factor = with_wheels(content, ["0.04", "0.05"], ["0.18", "0.2"])
    assert (data.longest_arm[0], data.smallest_r[0]) == (factor * Fraction("0.2"), Fraction("0.04"))
    ends = itertools.product((0.04, 0.05), (0.04, 0.05), (factor * 0.18, factor * 0.2), (factor * 0.18, factor * 0.2))
    r, r_true, arm, arm_true = np.array(list(ends)).T
    masses = (3 + 2 * 0.001 / r_true**2) * r_true / r
    inertias = (0.05 + 2 * 0.001 * (arm_true / r_true) ** 2) * (r_true / r) * (arm / arm_true)
    assert 0.85 * masses.min() < data.m[0] <= masses.min()  # each term has its own worst case: a little too small
    assert 0.85 * inertias.min() < data.inertia[0] <= inertias.min()


@pytest.mark.parametrize("inertia", [["0.1"], ["0.2", "0.1"], -1])
def test_an_interval_has_two_numbers_in_order(content, inertia):
    content["vehicle"][0]["wheel_inertia"] = inertia
    with pytest.raises(ValueError, match=r"0 <= low <= high"):
        Fleet.model_validate(content)


def test_accelerations_of_runs_stay_below_their_bounds(fleet, psi, draw_gains, draw_state):
    """|v'| < (d_v + sqrt2 p_v D) / m and |omega'| < (d_omega + p_omega D + c) / I at random states."""
    gains, data, ops = draw_gains(len(fleet)).map(floats), fleet.condition_data(psi).map(floats), numpy_ops()
    force = conditions.acceleration_condition(float_numbers(), data, gains).small
    moment = conditions.turn_acceleration_condition(float_numbers(), data, gains).small
    state = draw_state(len(fleet), (200,))
    rates = closed_loop(ops, fleet.plant(), gains, psi.value(ops, np.linspace(0, 9, 200)[:, None]), state)
    assert (np.abs(rates.v) < force / data.m).all()
    assert (np.abs(rates.omega) < moment / data.inertia).all()
