"""Lemmas L1, L6, L7, L8: what bounds the rates, and the function Y_s that falls."""

from __future__ import annotations

from typing import Any

import sympy as sp

from .claim import Claim
from .energies import modified_rate, vehicles
from .generic_fleet import generic, parameter, symbol
from .names import Names, first, second
from .normal_form import Expr, majorant
from .saturation import error_ranges, folded_inputs, psi_bar
from .steps import Cited, Identity, NonNegative, Step
from .verdicts import lemma


def claims() -> list[Claim]:
    """L1, L6, L7, L8."""
    return [l1(), l6(), l7(), l8()]


def _rate_majorants(n: Names) -> dict[Expr, Expr]:
    """|phi^T e_z'| <= D V_i + a V_j as symbols: majorants for the parts of L5's right side."""
    other = second() if n.index == 1 else first()
    size, other_size = speed(n), speed(other)
    return {n.v: size, sp.tanh(n.v): size, n.w: sp.S.Zero, symbol("rate", n.index): n.D * size + edge() * other_size}


def edge() -> Expr:
    """a_12."""
    return generic().graph.weight[0]


def speed(n: Names) -> Expr:
    """|v_i| as a nonnegative symbol."""
    return symbol("V", n.index, nonnegative=True)


def projected_rate(text: str, x: Expr, y: Expr) -> list[Step]:
    """u^T e_z' with every sech^2 in [0, 1]: linear in them, so the corners {0, 1}^2 decide; each <= |u| |phi| = 1."""
    f_x, f_y = symbol("f_x"), symbol("f_y")
    inner = (x * f_x + y * f_y) ** 2 + (x * f_y - y * f_x) ** 2
    return [
        Identity(f"{text}: (u_x f_x + u_y f_y)^2 <= |u|^2 |f|^2", (x**2 + y**2) * (f_x**2 + f_y**2), inner),
        Identity(
            f"{text}: (u_x f_x)^2 <= |u|^2 |f|^2",
            (x * f_x) ** 2 + x**2 * f_y**2 + y**2 * (f_x**2 + f_y**2),
            (x**2 + y**2) * (f_x**2 + f_y**2),
        ),
    ]


def l1() -> Claim:
    """Bounds of the errors, of the accelerations and of the rates of the errors."""
    u_v, u_w = folded_inputs()
    one, g = first(), generic()
    D, root = one.D, sp.sqrt(2)
    q, b = symbol("q", 1), symbol("b", 1)
    compact_v = -one.p_v * q - one.d_v * sp.tanh(one.v)
    compact_w = -one.p_w * one.e_theta - one.d_w * sp.tanh(one.w) + one.k * one.psi * b
    limits = {q: root * D, b: root * D, one.e_theta: D, sp.tanh(one.v): 1, sp.tanh(one.w): 1, one.psi: psi_bar()}
    return lemma(
        "L1",
        "|e_z| < sqrt2 D, |e_theta| < D, |v'| < B = (sqrt2 p_v D + d_v)/m, |omega'| < A = (p_w D + d_w + c)/I; "
        "for unit u: |u^T e_zi'| <= D_i |v_i| + sum_j a_ij |v_j|",
        *error_ranges(),
        Identity("q^2 + b^2 = |e_z|^2, so |q|, |b| < sqrt2 D", one.q**2 + one.b**2, one.e_x**2 + one.e_y**2),
        Identity("m v' in q", compact_v.subs(q, one.q), u_v),
        Identity("I omega' in b", compact_w.subs(b, one.b), u_w),
        Identity("|m v'| < sqrt2 p_v D + d_v", root * one.p_v * D + one.d_v, majorant(compact_v, limits)),
        Identity(
            "|I omega'| < p_w D + d_w + c",
            one.p_w * D + one.d_w + root * one.k * psi_bar() * D,
            majorant(compact_w, limits),
        ),
        Identity("e_x' = a_il sech^2 x_i' + a_ij sech^2 (x_i' - x_j')", _error_rate(), g.dt(g.errors["e_x"][0])),
        *projected_rate("unit u", symbol("u_x"), symbol("u_y")),
        needs=("L0", "eq-1", "eq-8", "eq-10", "eq-13", "eq-14"),
        note="|tanh| < 1, 0 < sech^2 <= 1 and Cauchy-Schwarz",
    )


def _error_rate() -> Expr:
    one, two, g = first(), second(), generic()
    to_leader = one.x - one.delta_x - symbol("x", "l")
    between = one.x - one.delta_x - two.x + two.delta_x
    x_1, x_2 = one.v * one.cos, two.v * two.cos
    return g.graph.leader_weight[0] * sp.sech(to_leader) ** 2 * x_1 + edge() * sp.sech(between) ** 2 * (x_1 - x_2)


def existence() -> Claim:
    """(a): unique solutions for all time, forwards and backwards."""
    one, g = first(), generic()
    return lemma(
        "thm-a",
        "(a) every state has a unique solution for all time, forwards and backwards",
        Cited(
            "existence and uniqueness",
            "Picard-Lindelof theorem and continuation of solutions",
            (
                _smooth(g),
                Identity(
                    "theta' = omega, so |omega(t)| <= |omega(t0)| + A|t - t0| keeps the state finite",
                    one.w,
                    g.closed_loop.theta[0],
                ),
            ),
        ),
        needs=("L1",),
        note="the right side is smooth in the state; accelerations are bounded (L1), so no escape in finite time",
    )


def _smooth(g: Any) -> Step:
    from .steps import Check

    def compute() -> tuple[bool, str]:
        smooth = {sp.tanh, sp.sin, sp.cos, sp.Add, sp.Mul, sp.Pow, sp.Symbol}
        state = {s for part in g.state for s in part}
        for rate in (r for part in g.closed_loop for r in part):
            for node in sp.preorder_traversal(rate):
                if node.free_symbols & state and node.func not in smooth:
                    return False, f"{node.func}"
                if node.is_Pow and node.free_symbols & state and not node.exp.is_nonnegative:
                    return False, f"{node}"
        return True, "sums and products of tanh, sin, cos and speeds"

    return Check(
        "the right side is smooth in the state and continuous in t", compute, "walk over the model's expression"
    )


def g_coefficient(n: Names) -> Expr:
    """g_i of L6."""
    other = second() if n.index == 1 else first()
    own = n.k / n.p_w * ((n.m * p2(n) + n.d_v * p1(n)) / n.p_v + p0(n) * n.D)
    return own + edge() * other.k * p0(other) / other.p_w


def p0(n: Names) -> Expr:
    """psi0_i >= |psi_i|."""
    return parameter("psi0", n.index)


def p1(n: Names) -> Expr:
    """psi1_i >= |psi_i'|."""
    return parameter("psi1", n.index)


def p2(n: Names) -> Expr:
    """psi2_i >= |psi_i''|."""
    return parameter("psi2", n.index)


def l6() -> Claim:
    """What' <= -P_w + sum g_i |v_i|, by the triangle inequality on L5."""
    pair = vehicles(generic())
    damping = sum(n.d_w / n.p_w * n.w * sp.tanh(n.w) for n in pair)
    compact = modified_rate(generic()) + damping
    bounds: dict[Expr, Expr] = {}
    for n in pair:
        rate = symbol("rate", n.index)
        compact = compact.subs(n.q_of_rate, rate)
        bounds |= {n.psi: p0(n), n.psi_dot: p1(n), n.psi_ddot: p2(n)} | _rate_majorants(n)
    return lemma(
        "L6",
        "What' <= -P_w + sum g_i |v_i|, g_i = (k_i/p_wi)[(m_i psi2 + d_vi psi1)/p_vi + psi0 D_i] + sum_j a_ij k_j "
        "psi0_j/p_wj",
        Identity(
            "the majorant of What' + P_w", sum(g_coefficient(n) * speed(n) for n in pair), majorant(compact, bounds)
        ),
        needs=("L0", "L1", "L5"),
        note="triangle inequality term by term, |tanh v| <= |v|, and the sum over j read from the other end of the "
        "edge",
    )


def l7() -> Claim:
    """The two cases of |v| against s/(N g)."""
    g, p, d, s, N = (parameter(name) for name in ("g", "p", "d", "s", "N"))
    share, level, rise, more = (
        symbol("f", nonnegative=True),
        parameter("h"),
        symbol("r", nonnegative=True),
        symbol("K", nonnegative=True),
    )
    V = symbol("V", nonnegative=True)
    K = g * p / (d * level) + more  # level = tanh(s/(N g)); K_s is the largest over the vehicles
    slow = s / N - g * (s / (N * g)) / (1 + share)
    fast = K * d / p * V * (level + rise) - g * V
    return lemma(
        "L7",
        "for s > 0 and K_s := max_i g_i p_vi/(d_vi tanh(s/(N g_i))): Y_s := What + (K_s + 1) V has Y_s' <= -(P_w + "
        "P_v) + s",
        NonNegative("|v| <= s/(N g): g |v| <= s/N", slow, reach="|v| = s/(N g (1 + f)), f >= 0"),
        NonNegative(
            "|v| >= s/(N g): g |v| <= K_s (d_v/p_v) |v| tanh|v|", fast, reach="tanh|v| = tanh(s/(N g)) + r, r >= 0"
        ),
        needs=("L0", "L3", "L6"),
        note="sum g_i |v_i| <= s + K_s P_v; then V' = -P_v removes (K_s + 1) P_v",
    )


def l8() -> Claim:
    """W + K V - C0 <= Y_s <= W + (K + 2) V + C0."""
    m, p, k, psi1, p_w = (parameter(name) for name in ("m", "p", "k", "psi1", "p_w"))
    v = symbol("v")
    size, excess = k * psi1 / p_w, symbol("s", nonnegative=True)
    slow = symbol("V", nonnegative=True)
    gap = m / (2 * p) * v**2 + m / (2 * p) * size**2 - m / p * size * v
    one = first()
    return lemma(
        "L8",
        "W + K_s V - C0 <= Y_s <= W + (K_s + 2) V + C0, C0 = sum [c_i/p_wi + (m_i/2p_vi)(k_i psi1/p_wi)^2]; "
        "V and W are radially unbounded",
        NonNegative(
            "(k/p_w)(m/p_v) psi1 |v| <= (m/2p_v) v^2 + (m/2p_v)(k psi1/p_w)^2 (Young: a square)",
            gap,
            ({v: size + excess},),
        ),
        NonNegative("the same for |v| below k psi1/p_w", gap, ({k: slow * p_w / psi1 + excess, v: slow},)),
        Identity(
            "(k/p_w) psi0 sqrt2 D = c/p_w",
            sp.sqrt(2) * one.k * psi_bar() * one.D / one.p_w,
            majorant(one.k / one.p_w * one.psi * symbol("q"), {one.psi: psi_bar(), symbol("q"): sp.sqrt(2) * one.D}),
        ),
        needs=("L0", "L1", "eq-17", "eq-19", "lemma-1"),
        note="Young's inequality per vehicle, and log cosh s >= |s| - ln 2 along a path to the leader",
    )
