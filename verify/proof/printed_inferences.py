"""The inferences of the paper's convergence proof: invalid ones with functions that meet the premise only.

A counterexample refutes the rule that the paper applies, not the conclusion: the corrected theorem proves the latter.
"""

from __future__ import annotations

import sympy as sp

from .ball import evaluate
from .claim import Claim
from .energies import rotational
from .generic_fleet import generic, parameter, symbol
from .names import first, second
from .normal_form import Expr, majorant, normal_form
from .steps import Check, Identity, NonNegative
from .verdicts import inference, printed


def claims() -> list[Claim]:
    """Every claim of this file."""
    return [*speeds(), *position(), *orientation(), remark_limit()]


def _equal(text: str, left: Expr, right: Expr) -> Identity:
    return Identity(text, left, right)


def speeds() -> list[Claim]:
    """v in L_inf and L_2, v' bounded, (22)."""
    s, t, k = symbol("s", nonnegative=True), symbol("t", nonnegative=True), parameter("k")
    return [
        printed(
            "v-in-L2",
            "text after (18)",
            "v is in L_infinity and in L_2; v' is in L_infinity",
            NonNegative(
                "|v| <= M gives v tanh v >= k v^2 with k = tanh(M)/M, as tanh s / s decreases",
                (k + t) * s**2 - k * s**2,
            ),
            note="V bounds v; the integral of v tanh v is at most V(0) max(p_v/d_v); v' by L1",
            needs=("L0", "L1", "L3", "eq-18"),
        ),
        printed(
            "eq-22",
            "(22)",
            "phi^T e_z tends to 0",
            _projection_bounded(),
            note="true: it follows from the theorem; the paper's own route needs omega bounded first",
            needs=("thm-c",),
        ),
        printed(
            "eq-23-true",
            "(23), corrected",
            "omega phi_perp^T e_z tends to 0",
            _projection_bounded(),
            note="true: it follows from the theorem",
            needs=("thm-c", "eq-23"),
        ),
        printed(
            "eq-3-4",
            "(3) and (4)",
            "v, omega tend to 0, zbar_i to z_l, theta_i to theta_l, from every initial state",
            note="the control goal; it is part (c) of the corrected theorem",
            needs=("thm-c",),
        ),
    ]


def _projection_bounded() -> Identity:
    one = first()
    return _equal("(phi^T e)^2 + (phi_perp^T e)^2 = |e|^2", one.q**2 + one.b**2, one.e_x**2 + one.e_y**2)


def position() -> list[Claim]:
    """The case distinction after (23) and what it is built on."""
    return [not_to_zero(), alpha_rate_vanishes(), excitation_rate()]


def not_to_zero() -> Claim:
    """omega b -> 0 and omega not -> 0 do not give b -> 0: two slow functions that take turns."""
    s = symbol("s")
    w, b = (s + sp.Abs(s)) ** 3 / 8, (sp.Abs(s) - s) ** 3 / 8
    quarter = sp.sin(sp.pi / 2)

    def product() -> tuple[bool, str]:
        size = symbol("u", nonnegative=True)
        zero = all(normal_form((w * b).subs(s, sign * size)) == 0 for sign in (1, -1))
        return zero, "w b = 0 for s >= 0 and for s < 0"

    def peaks() -> tuple[bool, str]:
        reached = w.subs(s, quarter), b.subs(s, -quarter)
        return reached == (1, 1), "w = 1 where s = 1, b = 1 where s = -1"

    return inference(
        "omega-not-to-0",
        "'omega does not tend to 0, so e_z -> 0'",
        "omega b -> 0 and omega does not tend to 0 imply b -> 0",
        (
            Check("w b = 0 identically", product, "normal form on s >= 0 and s < 0"),
            Check("neither w nor b tends to 0", peaks, "exact values"),
        ),
        "w = max(0, s)^3, b = max(0, -s)^3 with s = sin(ln(1 + t)), twice differentiable, all derivatives tending to 0",
        "'does not tend to 0' is not 'bounded away from 0': the two may take turns",
        needs=("eq-23",),
    )


def alpha_rate_vanishes() -> Claim:
    """From (24), omega_i, omega_i', omega_i'' -> 0 leave alpha' = p_omega e_theta', with the neighbours' omega_j."""
    one, two, g = first(), second(), generic()
    own_rest = {one.w: 0, one.w_dot: 0, symbol("omega_ddot", 1): 0}
    jerk = g.dt(g.fold(g.closed_loop.omega[0]))
    balance = sp.expand(one.I * jerk).xreplace({one.w_dot: 0})
    left_over = sp.expand(balance - g.dt(one.alpha)).subs({one.w_dot: 0})
    remainder = normal_form(g.unfold(-left_over).xreplace(own_rest))
    expected = -one.p_w * g.graph.weight[0] * (1 - sp.tanh(one.theta - two.theta) ** 2) * two.w
    return inference(
        "alpha-rate",
        "'alpha' -> 0'",
        "omega_i, omega_i', omega_i'' -> 0 and (24) imply alpha_i' -> 0",
        (
            _equal(
                "alpha_1' = p_omega1 e_theta1' = -p_omega1 a_12 sech^2(theta_1 - theta_2) omega_2", expected, remainder
            ),
            Check("it is not 0 where omega_2 = 1", lambda: _nonzero(expected), "ball arithmetic"),
        ),
        "vehicle 1 at rest, neighbour with omega_2 = 1: alpha_1' = -p_omega1 a_12 sech^2(theta_1 - theta_2)",
        "e_theta' contains the neighbours' omega_j, about which the case omega_i -> 0 says nothing",
        needs=("eq-24",),
    )


def _nonzero(expression: Expr) -> tuple[bool, str]:
    from .ball import sample, text

    value = evaluate(expression, sample(expression.free_symbols))
    return bool(abs(value) > 0), f"value {text(value)}"


def excitation_rate() -> Claim:
    """psi' persistently exciting and psi' b -> 0 do not give b -> 0: b may live at the zeros of psi'."""
    x, k, s = parameter("x"), parameter("k"), parameter("s")
    support = {x: 1 / (k + s)}  # the support of the k-th bump: |t - k pi| < 1/k
    t = symbol("t")
    return inference(
        "psi-rate-not-to-0",
        "'psi' does not tend to 0, so phi_perp^T e_z -> 0'",
        "psi' b -> 0 and psi' does not tend to 0 imply b -> 0",
        (
            NonNegative("|sin t| b <= |t - k pi| <= 1/k on the k-th bump, as 0 <= b <= 1", 1 / k - x, (support,)),
            _equal("b(k pi) = 1 for every k", sp.S.One, (1 - k * x).subs(x, 0)),
            _equal(
                "the integral of psi'^2 over 2 pi is pi > 0", sp.pi, sp.integrate(sp.sin(t) ** 2, (t, 0, 2 * sp.pi))
            ),
        ),
        "psi' = sin t, which satisfies (12), and b = sum over k of max(0, 1 - k |t - k pi|)",
        "'does not tend to 0' is not 'bounded away from 0': b may live where psi' vanishes (it needs b slow: L12)",
        needs=("eq-25",),
    )


def orientation() -> list[Claim]:
    """The orientation paragraph: W' for W'', omega' for omega'', and the cascade."""
    t = symbol("t")
    f = sp.sin(t)
    return [
        inference(
            "orientation",
            "orientation paragraph",
            "alpha = 0: W' and omega' bounded give W' -> 0 and omega' -> 0 by Barbalat's lemma",
            (
                _equal("sin^2 + cos^2 = 1, so sin and its derivative are bounded", sp.S.One, f**2 + sp.diff(f, t) ** 2),
                Check(
                    "f' = 1 at t = 2 k pi: f' does not tend to 0",
                    lambda: (sp.diff(f, t).subs(t, 0) == 1, "cos 0 = 1"),
                    "exact value",
                ),
            ),
            "f = sin t: f and f' are bounded, f' does not tend to 0",
            "Barbalat's lemma needs the next derivative bounded: read W'' for W' and omega'' for omega'",
            truth="alpha = 0: W'' and omega'' bounded give W' -> 0 and omega' -> 0",
            truth_steps=(_second_derivative_bounded(),),
        ),
        cascade(),
    ]


def _second_derivative_bounded() -> Check:
    """W'' for alpha = 0 is bounded by a polynomial in |omega| and the parameters: every tanh by 1."""

    def compute() -> tuple[bool, str]:
        g = generic()
        quiet = dict.fromkeys(g.psi, sp.S.Zero)
        rate = normal_form(g.unfold(g.dt(rotational(g))).xreplace(quiet))
        second_rate = normal_form(g.unfold(g.dt(rate)).xreplace(quiet))
        bounds = dict.fromkeys(second_rate.atoms(sp.tanh), sp.S.One) | {w: parameter("w_max") for w in g.state.omega}
        left = majorant(second_rate, bounds).free_symbols
        states = {s for part in g.state for s in part}
        return not left & states, "every state of W'' is inside a tanh or an omega_i, |omega_i| <= w_max"

    return Check("W'' is bounded where omega is", compute, "majorant by the triangle inequality")


def cascade() -> Claim:
    """The cascade argument uses the false boundedness claim; its conclusion is part (c)."""
    return printed(
        "cascade",
        "cascade argument",
        "alpha -> 0 and bounded solutions give theta_i -> theta_l",
        note="the conclusion is part (c); its premise in the paper is the refuted claim on boundedness, which L13 "
        "replaces",
        needs=("thm-b", "thm-c"),
    )


def remark_limit() -> Claim:
    """'e -> 0 implies errors -> 0' does not follow from 'e = 0 only at 0'."""
    x = parameter("x")
    f = x / (1 + x**2)
    return inference(
        "remark-1-limit",
        "Remark 1 used for limits",
        "e_z = 0 only at zbar_i = z_l, hence e_z -> 0 implies zbar_i -> z_l",
        (
            NonNegative("f(x) = x/(1 + x^2) > 0 for x > 0", f),
            NonNegative("f(x) <= 1/x, so f -> 0 as x -> infinity", 1 / x - f),
        ),
        "f(x) = x/(1 + x^2) vanishes only at 0 and tends to 0 as x tends to infinity",
        "an error map that is 0 only at 0 may still vanish at infinity; the inverse bound L9 excludes that here",
        truth="|e| <= chi < kappa_cut/N implies |z_i - z_l| <= N atanh(N chi/kappa_cut) per coordinate (L9)",
        truth_steps=(_equal("atanh(0) = 0: the bound of L9 tends to 0 with chi", sp.S.Zero, sp.atanh(sp.S.Zero)),),
        needs=("remark-1", "L9"),
    )
