"""Lemmas L14, L15, L17: uniform stability, uniform global asymptotic stability, and that it is not exponential."""

from __future__ import annotations

import sympy as sp

from .bounds import existence
from .claim import Claim
from .energies import rotational, vehicles
from .generic_fleet import generic, parameter, symbol
from .names import Names, first
from .normal_form import Expr
from .steps import Check, Cited, Identity, NonNegative
from .verdicts import lemma

LAMBDA = parameter("lambda")


def claims() -> list[Claim]:
    """L14, L15, L17 and the parts of the theorem."""
    return [existence(), l14(), l15(), l17(), *theorem()]


def heading_errors() -> list[Expr]:
    """vtheta_i = theta_i - theta_l."""
    return [theta - symbol("theta", "l") for theta in generic().state.theta]


def strict_energy() -> Expr:
    """Z = W + lambda sum (I/p_w) omega vtheta."""
    g = generic()
    pairs = zip(vehicles(g), heading_errors(), strict=True)
    return rotational(g) + LAMBDA * sum(n.I / n.p_w * n.w * error for n, error in pairs)


def strict_rate() -> Expr:
    """Z' as L14 states it."""
    g = generic()
    pairs = list(zip(vehicles(g), heading_errors(), strict=True))
    first_error, second_error = heading_errors()
    a, led = g.graph.weight[0], g.graph.leader_weight
    pull = sum(w * e * sp.tanh(e) for w, e in zip(led, heading_errors(), strict=True))
    pull += a * (first_error - second_error) * sp.tanh(g.state.theta[0] - g.state.theta[1])
    return _damped(pairs) + LAMBDA * (sum(_cross(n, e) for n, e in pairs) - pull)


def _damped(pairs: list[tuple[Names, Expr]]) -> Expr:
    return sum((-n.d_w * n.w * sp.tanh(n.w) + n.w * n.alpha) / n.p_w for n, _ in pairs)


def _cross(n: Names, error: Expr) -> Expr:
    return (n.I * n.w**2 - n.d_w * error * sp.tanh(n.w) + error * n.alpha) / n.p_w


def l14() -> Claim:
    """Uniform stability: alpha stays as small as V started, and Z decays up to that."""
    g = generic()
    A, B, C, t, lam = (parameter(name) for name in ("A", "B", "C", "t", "lambda"))
    a, extra = symbol("r", nonnegative=True), symbol("s", nonnegative=True)
    small = {A: 2 * B * lam + a, t: lam * C**2 / (2 * B * lam + a) + extra}  # lambda <= A/2B and lambda <= tA/C^2
    x, h = parameter("x"), parameter("h")
    return lemma(
        "L14",
        "the formation is uniformly stable: V is nonincreasing, so |alpha| <= k psi0 |e_z| stays small, and "
        "Z = W + lambda sum (I/p_w) omega vtheta decays up to that bound",
        Identity("Z' as stated", strict_rate(), g.dt(strict_energy()), g),
        NonNegative("first pivot of the quadratic form of -Z': A - lambda B > 0", A - lam * B, (small,)),
        NonNegative("second pivot: 4 t (A - lambda B) - lambda C^2 > 0", 4 * t * (A - lam * B) - lam * C**2, (small,)),
        NonNegative(
            "locally s tanh s >= s^2 tanh(2)/2 for |s| <= 2: tanh s/s decreases", x**2 * (h + extra) - x**2 * h
        ),
        _positive_pivots(),
        needs=("L0", "L1", "L3", "L4", "lemma-1", "remark-1", "eq-14"),
        note="A = (d/p_w) tanh 1, B = I/p_w, C = d/p_w, t = (tanh 2/2) lambda_min(L_l), for |omega|, |vtheta| <= 1; "
        "-Z' >= quadratic - linear times sup|alpha|, so Z decreases outside a ball of that size",
    )


def _positive_pivots() -> NonNegative:
    """Z itself: (B/2) w^2 + lambda B w y + (t/2) y^2 >= 0 for lambda^2 B <= t/2, by completing the square."""
    B, t, lam, w, y = parameter("B"), parameter("t"), parameter("lambda"), symbol("omega"), symbol("y")
    u, slack = symbol("u"), symbol("s", nonnegative=True)
    form = B / 2 * w**2 + lam * B * w * y + t / 2 * y**2 - t / 4 * y**2
    return NonNegative(
        "Z is positive definite for small lambda", form, ({w: u - lam * y, t: 2 * lam**2 * B + slack},), "|vtheta| <= 1"
    )


def l15() -> Claim:
    """UGAS from a uniform visit near the goal and uniform stability there."""
    N, kappa, chi = parameter("N"), parameter("kappa_cut"), parameter("chi")
    return lemma(
        "L15",
        "the formation is uniformly globally asymptotically stable",
        Identity(
            "N atanh(N chi/kappa_cut) is 0 at chi = 0 and continuous there",
            sp.S.Zero,
            (N * sp.atanh(N * chi / kappa)).subs(chi, 0),
        ),
        needs=("L9", "L13", "L14", "thm-a"),
        note="by the definition of UGAS: bounded (L13), near the goal within a time that depends only on the size of "
        "the start "
        "(L13, L9), and there to stay (L14); uniform in t0 since every constant is",
    )


def cross_track_row() -> list[Expr]:
    """The gradient of phi_perp(theta_l)^T z_1' at the goal, one entry per state."""
    g, one = generic(), first()
    goal = symbol("theta", "l")
    drift = -sp.sin(goal) * g.closed_loop.x[0] + sp.cos(goal) * g.closed_loop.y[0]
    at_goal = {one.v: 0, one.w: 0, one.theta: goal}
    return [sp.expand(drift.diff(s).subs(at_goal)) for part in g.state for s in part]


def l17() -> Claim:
    """(e): the linearisation leaves the cross-track errors where they are."""
    return lemma(
        "L17",
        "stability is not exponential: the cross-track rows of the Jacobian at the goal are zero for every t and all "
        "gains",
        Cited(
            "exponential stability of the goal needs uniform exponential stability of the linearisation",
            "Khalil, Nonlinear Systems, Theorem 4.15",
            (
                Check("the cross-track row of the Jacobian is zero", _row_is_zero, "differentiation of the model"),
                Check(
                    "the Jacobian is bounded and Lipschitz in the state near the goal, uniformly in t",
                    _jacobian_is_tame,
                    "walk over the model's expression",
                ),
            ),
        ),
        needs=("eq-13", "eq-14"),
        note="the linearised cross-track error is constant in time, so the linearisation is not asymptotically stable "
        "(the rows vanish, not the columns: omega' feels the cross-track error through alpha)",
    )


def _row_is_zero() -> tuple[bool, str]:
    row = cross_track_row()
    return all(entry == 0 for entry in row), f"{len(row)} entries, all 0"


def _jacobian_is_tame() -> tuple[bool, str]:
    """Second derivatives are polynomials in speeds, tanh, sin, cos (bounded near the goal) and psi (bounded)."""
    g = generic()
    tame = {sp.tanh, sp.sin, sp.cos, sp.Add, sp.Mul, sp.Pow}
    states = [s for part in g.state for s in part]
    nodes = {node.func for part in g.closed_loop for rate in part for node in sp.preorder_traversal(rate) if node.args}
    powers = all(
        p.exp.is_nonnegative or not p.free_symbols & set(states)
        for part in g.closed_loop
        for r in part
        for p in r.atoms(sp.Pow)
    )
    return nodes <= tame and powers, "entire in speeds, smooth and bounded in positions and angles, linear in psi"


def theorem() -> list[Claim]:
    """(b)-(f) and the theorem."""
    parts = (
        ("thm-b", "(b) solutions are uniformly globally bounded", ("L13", "thm-a")),
        ("thm-c", "(c) the formation is uniformly globally asymptotically stable", ("L15", "thm-b")),
        (
            "thm-d",
            "(d) Constraint 1 holds from every initial state iff T_i of (16*) <= min(taubar_l, taubar_r); (16) "
            "implies it",
            ("L16", "L16b"),
        ),
        ("thm-e", "(e) stability is not exponential", ("L17",)),
        ("thm-f", "(f) d_w > p_w D + c and d_v > sqrt2 p_v D certify limits of turn rate and speed", ("L18",)),
    )
    return [
        *(lemma(id_, statement, needs=needs, note="the lemmas beneath it") for id_, statement, needs in parts),
        lemma(
            "theorem",
            "Under (A1) symmetric weights and a leader link in every component, (A2) positive parameters and gains, "
            "(A3) psi, psi', psi'' "
            "bounded and psi' persistently exciting: (a)-(f) hold. No condition of type (15) is needed",
            needs=("thm-a", *(part[0] for part in parts)),
            note="every claim beneath is proved, or cited with its hypotheses checked",
        ),
    ]
