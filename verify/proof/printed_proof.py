"""The identities of the paper's proof: Remark 1, (17)-(21), (23)-(25), each typed as it is printed.

`identities()` is what the claims decide and what the mutants are made from.
"""

from __future__ import annotations

from functools import cache

import sympy as sp

from ...models.algebra.log_cosh import log_cosh
from .claim import Claim
from .energies import energy_rate, rotational, translational, vehicles
from .generic_fleet import generic, symbol
from .names import Names, first, sech2, second
from .normal_form import Expr
from .steps import Identity, NonNegative
from .verdicts import printed


def claims() -> list[Claim]:
    """Every claim of this file."""
    return [*remark(), *energy_claims(), *rate_claims()]


@cache
def identities() -> dict[str, Identity]:
    """The printed identities by the id of their claim."""
    g, one = generic(), first()
    return {
        "remark-1": Identity("sum (z_i - z_l) e_i as printed", remark_sum(), remark_derived(), g),
        "eq-17": Identity("V as printed", printed_potential("xy", "v"), translational(g), g),
        "eq-18": energy_rate("V'"),
        "eq-19": Identity("W as printed", printed_potential("theta", "w"), rotational(g), g),
        "eq-20": energy_rate("W'"),
        "eq-21": Identity("v'' as printed", jerk_as_printed(one), g.dt(g.fold(g.closed_loop.v[0])), g),
        "eq-23": Identity("the vanishing term as printed", one.w * one.q, vanishing_term(), g),
        "eq-24": Identity("omega'' as printed", turn_jerk(one), turn_jerk_derived(), g),
        "eq-25": Identity("alpha' as printed", alpha_rate(one), g.dt(one.alpha), g),
    }


def _pair(base: str) -> tuple[Expr, Expr, Expr]:
    """The errors to the leader of vehicles 1 and 2, and their difference, in one coordinate."""
    one, two = first(), second()
    shift = {"x": "delta_x", "y": "delta_y"}.get(base)
    a, b = getattr(one, base), getattr(two, base)
    if shift:
        a, b = a - getattr(one, shift), b - getattr(two, shift)
    leader = symbol(base, "l")
    return a - leader, b - leader, a - b


def remark_sum() -> Expr:
    """Remark 1 as printed, in x: (1/2) sum over ordered pairs, plus the leader terms."""
    g = generic()
    to_1, to_2, between = _pair("x")
    a, (led_1, led_2) = g.graph.weight[0], g.graph.leader_weight
    pairs = a * between * sp.tanh(between) + a * (-between) * sp.tanh(-between)
    return pairs / 2 + led_1 * to_1 * sp.tanh(to_1) + led_2 * to_2 * sp.tanh(to_2)


def remark_derived() -> Expr:
    """sum_i (z_i - z_l) e_i from the model, in x."""
    to_1, to_2, _ = _pair("x")
    errors = generic().errors["e_x"]
    return to_1 * errors[0] + to_2 * errors[1]


def printed_potential(coordinates: str, speed: str) -> Expr:
    """(17) or (19) as printed: every edge twice, and 1/2 in front."""
    g = generic()
    total: Expr = sp.S.Zero
    for n in vehicles(g):
        mass, gain = (n.m, n.p_v) if speed == "v" else (n.I, n.p_w)
        total += mass / gain * getattr(n, speed) ** 2
    for base in coordinates if coordinates == "xy" else (coordinates,):
        to_1, to_2, between = _pair(base)
        a, (led_1, led_2) = g.graph.weight[0], g.graph.leader_weight
        total += (
            2 * led_1 * log_cosh(to_1) + 2 * led_2 * log_cosh(to_2) + a * log_cosh(between) + a * log_cosh(-between)
        )
    return total / 2


def jerk_as_printed(n: Names) -> Expr:
    """(21) as printed, its left side read as v''."""
    inner = n.d_v * n.v_dot * sech2(n.v) + n.p_v * n.w * n.q
    return -inner / n.m + n.p_v * n.q_of_rate / n.m


def jerk_corrected(n: Names) -> Expr:
    """(21) with its three errors put right."""
    return -(n.d_v * n.v_dot * sech2(n.v) + n.p_v * n.w * n.b + n.p_v * n.q_of_rate) / n.m


def vanishing_term() -> Expr:
    """What tends to 0 with v', v'' and e_z': -[m v'' + d_v v' sech^2 v + p_v phi^T e_z'] / p_v."""
    g, n = generic(), first()
    jerk = g.dt(g.fold(g.closed_loop.v[0]))
    return sp.expand(-(n.m * jerk + n.d_v * n.v_dot * (1 - sp.tanh(n.v) ** 2)) / n.p_v - n.q_of_rate)


def turn_jerk(n: Names) -> Expr:
    """(24) as printed."""
    return -(n.d_w * n.w_dot * sech2(n.w) + n.p_w * n.e_theta_dot - alpha_rate(n)) / n.I


def turn_jerk_derived() -> Expr:
    """omega'' from the model."""
    g = generic()
    return g.dt(g.fold(g.closed_loop.omega[0]))


def alpha_rate(n: Names) -> Expr:
    """(25), with phi^perp read as its transpose."""
    return n.k * n.psi_dot * n.b - n.k * n.w * n.psi * n.q + n.k * n.psi * n.b_of_rate


def remark() -> list[Claim]:
    """Remark 1: the identity, and what follows where e is exactly 0."""
    s, t = symbol("s", nonnegative=True), symbol("t", nonnegative=True)
    return [
        printed(
            "remark-1",
            "Remark 1",
            "sum (z_i - z_l)^T e_zi = (1/2) sum a_ij (z_i - z_j)^T tanh(z_i - z_j) + sum a_il (z_i - z_l)^T tanh(z_i "
            "- z_l); "
            "so e_z = 0 implies z_i = z_l",
            identities()["remark-1"],
            NonNegative("s tanh s >= 0, a sum of nonnegative terms", s * t, reach="t = tanh s, s and t of one sign"),
            note="every term vanishes only where its difference does; then Lemma 1",
            needs=("L0", "L2", "lemma-1"),
        )
    ]


def energy_claims() -> list[Claim]:
    """(17)-(20)."""
    found = identities()
    floor = "log cosh s >= |s| - ln 2 (L0): positive definite and radially unbounded in its arguments"
    u, v = symbol("s", nonnegative=True), symbol("t", nonnegative=True)
    decreasing = NonNegative("v tanh v >= 0", u * v, reach="t = tanh v, v and t of one sign")
    return [
        printed("eq-17", "(17)", "V is the energy of (13), positive definite and radially unbounded", found["eq-17"],
                note=f"the 1/2 undoes the double count of edges; {floor}", needs=("L0",), quantity=symbol("V")),
        printed("eq-18", "(18)", "V' = -sum (d_v/p_v) v tanh v <= 0", found["eq-18"], decreasing,
                note="the pull and the potential cancel edge by edge", needs=("L2", "L3"), quantity=symbol("V_dot")),
        printed("eq-19", "(19)", "W is the energy of (14), positive definite and radially unbounded", found["eq-19"],
                note=f"the 1/2 undoes the double count of edges; {floor}", needs=("L0",), quantity=symbol("W")),
        printed("eq-20", "(20)", "W' = -sum (1/p_w)[d_w omega tanh omega - omega alpha]", found["eq-20"],
                note="holds as printed", needs=("L2", "L4"), quantity=symbol("W_dot")),
    ]  # fmt: skip


def rate_claims() -> list[Claim]:
    """(21), (23), (24), (25)."""
    found = identities()
    return [
        printed(
            "eq-21",
            "(21)",
            "v'' = -(1/m)[d_v v' sech^2 v + p_v omega phi^T e_z] + (1/m) p_v phi^T e_z', printed with v' on the left",
            found["eq-21"],
            note="differentiating (13): the left side is v'', phi' = omega phi_perp, and the last term keeps its minus"
            if found["eq-21"].residual() != 0
            else "differentiating (13)",
            needs=("eq-13",),
            quantity=symbol("v_ddot", 1),
        ),
        printed(
            "eq-23",
            "(23)",
            "the term of (21) that vanishes in the limit is omega phi^T e_z",
            found["eq-23"],
            note="what is left of (21) when v'', v' and e_z' vanish",
            needs=("eq-21",),
            quantity=symbol("limit term"),
        ),
        printed(
            "eq-24",
            "(24)",
            "omega'' = -(1/I)[d_w omega' sech^2 omega + p_w e_theta' - alpha']",
            found["eq-24"],
            note="differentiating (14)",
            needs=("eq-14", "eq-25"),
            quantity=symbol("omega_ddot", 1),
        ),
        printed(
            "eq-25",
            "(25)",
            "alpha' = k psi' phi_perp^T e_z - k omega psi phi^T e_z + k psi phi_perp^T e_z'",
            found["eq-25"],
            note="read phi_perp^T for the printed phi^perp",
            needs=("eq-11",),
            quantity=symbol("alpha_dot", 1),
        ),
    ]
