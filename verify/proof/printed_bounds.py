"""The bound of alpha, the inequalities after (20), and what the paper concludes from them: omega bounded, (15)."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import chain, combinations

import sympy as sp
from flint import arb

from .ball import ball, text
from .claim import Claim
from .generic_fleet import parameter, symbol
from .names import first
from .normal_form import Expr
from .printed_saturation import condition_holds
from .saturation import damping_letters, error_ranges
from .steps import Check, Identity, NonNegative
from .verdicts import inference, printed
from .witness import Instance, paper, paper_peak

TANH_1 = sp.tanh(1)


def claims() -> list[Claim]:
    """Every claim of this file."""
    return [alpha_bound(), *after_20(), *boundedness()]


def alpha_bound() -> Claim:
    """|alpha| <= c."""
    one, size, k, D = first(), parameter("psi_bar"), parameter("k"), parameter("D")
    s, t = symbol("s", nonnegative=True), symbol("t", nonnegative=True)
    gap = 2 * (k * size * D) ** 2 - k**2 * (size**2 / (1 + t)) * (2 * D**2 / (1 + s))
    return printed(
        "alpha-bound",
        "bound of alpha after (20)",
        "|alpha| <= sqrt2 k psibar (a_il + l_ii)",
        Identity("(phi^T e)^2 + (phi_perp^T e)^2 = |e|^2", one.q**2 + one.b**2, one.e_x**2 + one.e_y**2),
        *error_ranges(),
        NonNegative("k^2 psi^2 |e|^2 <= 2 k^2 psibar^2 D^2 where |e|^2 <= 2 D^2, psi^2 <= psibar^2", gap),
        note="two components of size < D each; strict",
        needs=("L0", "eq-8", "eq-11"),
        quantity=symbol("|e_z|^2"),
    )


def bound_gap(size_of_omega: Expr) -> Expr:
    """(the bound after (20), with `size_of_omega` beside c) - W', for one vehicle: (size c - omega alpha)/p."""
    w, alpha, c, p = symbol("omega"), symbol("alpha"), parameter("c"), parameter("p")
    return (size_of_omega * c - w * alpha) / p


def bound_cases() -> tuple[dict[Expr, Expr], ...]:
    """omega = +-u and alpha = +-c: the gap is linear in alpha, so its least value lies at an end of [-c, c]."""
    w, alpha, c, u = symbol("omega"), symbol("alpha"), parameter("c"), parameter("u")
    return tuple({w: turn * u, alpha: push * c, symbol("size"): u} for turn in (1, -1) for push in (1, -1))


def after_20() -> list[Claim]:
    """The two displayed inequalities after (20) and the sentence that follows them."""
    d, c, p, s = parameter("d"), parameter("c"), parameter("p"), parameter("s")
    u, size, w = parameter("u"), symbol("size"), symbol("omega")
    stronger = (d * u * (TANH_1 + s) - u * c) / p - (d * TANH_1 - c) * u / p
    return [
        printed(
            "after-20",
            "inequality after (20)",
            "W' <= -sum (1/p_w)[d_w omega tanh omega - omega sqrt2 k psibar D]",
            Check(
                "the bound holds on the paper's data at omega_2 = -1, alpha_2 = -c_2",
                _after_20_on_paper,
                "ball arithmetic",
            ),
            NonNegative("omega alpha <= omega c for |alpha| <= c", bound_gap(w), bound_cases()),
            truth="W' <= -sum (1/p_w)[d_w omega tanh omega - |omega| sqrt2 k psibar D]",
            truth_steps=(NonNegative("omega alpha <= |omega| c", bound_gap(size), bound_cases()),),
            note="omega alpha <= |omega| c, and |omega| is not omega where omega < 0",
            needs=("eq-20", "alpha-bound"),
        ),
        printed(
            "after-20-b",
            "second inequality after (20)",
            "if |omega_i| >= 1 for all i: W' <= -sum (1/p_w)[d_w tanh(1) - sqrt2 k psibar D] |omega|",
            NonNegative("|omega| tanh|omega| >= |omega| tanh 1 for |omega| >= 1, tanh|omega| = tanh 1 + s", stronger),
            note="tanh increases; it needs every |omega_i| >= 1, and |omega| in the inequality before it",
            needs=("L0", "after-20"),
        ),
        printed(
            "after-20-c",
            "(15) gives W' <= 0",
            "if (15) holds and |omega_i| >= 1 for all i, then W' <= 0",
            NonNegative("d tanh 1 - c >= 0", (d * TANH_1 - c) * u / p, ({d: (c + s) / TANH_1},)),
            note="holds, for all |omega_i| >= 1 at once; it says nothing where one |omega_j| < 1",
            needs=("after-20-b",),
        ),
    ]


def _after_20_on_paper() -> tuple[bool, str]:
    data, c = paper(), paper().excitation_bounds(paper_peak())
    p, d = data.exact_gains.p_omega[1], data.exact_gains.d_omega[1]
    damping, push = d * arb(1).tanh() / p, c[1] / p  # omega tanh omega at omega = -1; omega alpha = c_2
    rate, stated = push - damping, -(damping + push)
    return bool(
        rate <= stated
    ), f"omega_2 = -1, alpha_2 = -c_2: W' = {text(rate, 3)} > {text(stated, 5)} = the printed upper bound"


def boundedness() -> list[Claim]:
    """'omega is bounded' and 'uniformly bounded under any bounded alpha': both false, by states and by trajectories."""
    return [falls(), any_alpha(), cuts(), damping_bounds_speed()]


def falls() -> Claim:
    """W can rise while some |omega_i| >= 1."""
    return printed(
        "boundedness-of-omega",
        "'for all |omega_i| >= 1, W' <= 0, hence omega_i is bounded'",
        "at every t with |omega_i(t)| >= 1 for some i: W'(t) <= 0",
        Check(
            "W' <= 0 at the witness, with the controller's own alpha",
            _rise_on_paper,
            "the model's equations in ball arithmetic",
        ),
        note="the neighbours with |omega_j| < 1 are not damped enough: W' > 0 although |omega_1| >= 1",
        needs=("eq-20", "after-20-c"),
    )


def rising_state(data: Instance) -> object:
    """The state of docs/theory.md 6 at which W rises."""
    return data.state(
        {0: (40, -40), 1: (-40, 40)}, {0: -3 * arb.pi() / 4, 1: arb.pi() / 4}, omega={0: 1, 1: Fraction(1, 2)}
    )


def _rise_on_paper() -> tuple[bool, str]:
    rate = paper().energy_rate(paper_peak(), rising_state(paper()))  # type: ignore[arg-type]
    where = (
        "paper's gains and graph, z_1 - z_l = (40,-40), z_2 - z_l = (-40,40), other errors 0, theta_1 = -3pi/4, "
        "theta_2 = pi/4, psi = psibar (t = pi/5), omega = (1, 0.5, 0, 0, 0, 0)"
    )
    return bool(rate <= 0), f"{where}: W' = {text(rate, 4)}"


def any_alpha() -> Claim:
    """A constant alpha_1 = c_1 makes theta_1 run away: {omega_1 >= level} is invariant."""
    d, u, c = damping_letters()
    e = parameter("e")
    outward = c - (u - e) - d * ((c - u) / d)
    return inference(
        "any-bounded-alpha",
        "'uniformly globally bounded under any bounded alpha'",
        "under (15), (13)-(14) is uniformly globally bounded for every bounded alpha_i, |alpha_i| <= c_i",
        (
            Check("c_1 > p_omega1 D_1 on the paper's data", _drift_on_paper, "ball arithmetic"),
            Check(
                "(15) holds on the paper's data", lambda: condition_holds("condition_15"), "exact rational arithmetic"
            ),
            NonNegative("I omega' > 0 where tanh omega = (c - p D)/d and alpha = c, since e_theta < D", outward),
        ),
        "paper's gains, alpha_1 = c_1 constant: {omega_1 >= atanh((c_1 - p_1 D_1)/d_1)} is invariant, so theta_1 grows "
        "without bound at that rate or faster",
        "a constant push that the bounded heading error cannot hold lets the angle run away",
        needs=("alpha-bound", "eq-14"),
    )


def _drift_on_paper() -> tuple[bool, str]:
    data = paper()
    c, pull = data.excitation_bounds(paper_peak())[0], (data.exact_gains.p_omega * data.plant.graph.degree)[0]
    return bool(c > pull), f"c_1 = {text(c)}, p_omega1 D_1 = {text(pull)}"


def broken_cuts(data: Instance, psi_bar: object) -> tuple[int, int]:
    """(broken, all): the vehicle sets S with sum_S c_i/p_wi > a_l(S) + cut(S)."""
    graph, push = data.plant.graph, data.excitation_bounds(psi_bar) / data.exact_gains.p_omega
    edges = list(zip(graph.tail, graph.head, graph.weight, strict=True))
    broken = total = 0
    for chosen in _subsets(len(data.fleet)):
        cut = sum((w for i, j, w in edges if (i in chosen) != (j in chosen)), arb(0))
        room = sum((graph.leader_weight[i] for i in chosen), cut)
        total += 1
        broken += bool(sum((push[i] for i in chosen), arb(0)) > room)
    return broken, total


def _subsets(n: int) -> Iterator[set[int]]:
    return map(set, chain.from_iterable(combinations(range(n), size) for size in range(1, n + 1)))


def cuts() -> Claim:
    """What boundedness under any |alpha_i| <= c_i would need, and how far the paper's gains are from it."""

    def count() -> tuple[bool, str]:
        broken, total = broken_cuts(paper(), paper_peak())
        return (
            broken == 0,
            f"the paper's gains break {broken} of {total} cut conditions sum_S c_i/p_i <= a_l(S) + cut(S)",
        )

    return printed(
        "cuts",
        "boundedness under any alpha, what it needs",
        "sum_S c_i/p_omega_i <= a_l(S) + cut(S) for every set S of vehicles on the paper's data",
        Check("no cut is broken", count, "enumeration of all vehicle sets in ball arithmetic"),
        note="with alpha_i = c_i on S a bounded solution would settle where sum_S e_i = sum_S c_i/p_i, above what S "
        "can hold",
        needs=("any-bounded-alpha", "L2", "L11"),
    )


def damping_bounds_speed() -> Claim:
    """(15) alone does not bound omega: drift far out, then swing back; every phase by one-sided bounds."""
    d, u, c = damping_letters()
    e, slack, rate = parameter("e"), parameter("s"), parameter("g")
    swing = (c + u * TANH_1 - d) + d * slack + u * e
    return inference(
        "eq-15",
        "(15)",
        "d_omega >= sqrt2 k psibar D / tanh(1) keeps omega bounded for every alpha with |alpha| <= c",
        (
            Check(
                "I=1, p=.5, a=1, d=1, c=.76: (15) holds, d > max(pD, c), c > pD and c + pD tanh 1 > d",
                _swing_numbers,
                "ball arithmetic",
            ),
            NonNegative(
                "drift (alpha = c): I omega' > 0 where tanh omega = (c - pD)/d, since e_theta < D",
                c - (u - e) - d * ((c - u) / d),
            ),
            NonNegative(
                "swing back (alpha = -c): -I omega' = c + p e_theta + d tanh omega >= c + pD tanh 1 - d > 0 while "
                "theta >= 1",
                swing - rate,
                ({c: d - u * TANH_1 + rate},),
            ),
            Check(
                "omega^2/2 at theta = 1 is at least g (L - 1), g = c + pD tanh 1 - d, for a turn at L",
                _swing_energy,
                "energy",
            ),
        ),
        "single vehicle I=1, p=.5, a=1, d=1, c=.76: alpha = c carries theta to any L > 1; then alpha = -c brings it "
        "back to "
        "theta = 1 with |omega| >= sqrt(2 * 0.1408 (L - 1)); repeating with growing L, sup |omega| is infinite",
        "well formed, but insufficient for the step it serves: (15') d > pD + c is what bounds omega (L18); the "
        "result needs neither",
        needs=("alpha-bound",),
    )


def _swing_numbers() -> tuple[bool, str]:
    p, d, c = ball(Fraction(1, 2)), arb(1), ball(Fraction(76, 100))
    swing = c + p * arb(1).tanh() - d
    return bool(
        c <= d * arb(1).tanh() and d > p and d > c > p and swing > 0
    ), f"c - pD = {text(c - p)}, c + pD tanh 1 - d = {text(swing)}"


def _swing_energy() -> tuple[bool, str]:
    # d(omega^2/2)/dtheta = omega'; omega' <= -g on [1, L] gives omega(1)^2/2 = -int_1^L omega' dtheta >= g (L - 1).
    theta, g, L = symbol("theta"), parameter("g"), parameter("L")
    gained = sp.integrate(g, (theta, 1, L))
    return sp.expand(gained - g * (L - 1)) == 0, "omega(1)^2 / 2 >= g (L - 1)"
