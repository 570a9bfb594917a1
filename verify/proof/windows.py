"""Lemmas L9-L13: from small errors to small states, and from a window of small dissipation to small errors."""

from __future__ import annotations

from typing import Any

import sympy as sp
from flint import arb

from .ball import ball, text
from .claim import Claim
from .energies import projections
from .excitation_facts import times_power_of_pi, variance
from .generic_fleet import generic, parameter, symbol
from .names import first, second
from .normal_form import Expr, majorant
from .saturation import folded_inputs
from .steps import Check, Identity, NonNegative, Step
from .verdicts import lemma
from .witness import paper

ETA, PERIOD = parameter("eta"), parameter("T")


def claims() -> list[Claim]:
    """L9-L13."""
    return [l9(), l10(), l11(), l12(), l13()]


def l9() -> Claim:
    """The inverse bound: a cut across the largest gap of the sorted values."""
    weight, level, N, M = parameter("a"), parameter("h"), parameter("N"), parameter("M")
    rise, g, short = symbol("r", nonnegative=True), symbol("g"), parameter("s")
    kappa, chi = parameter("kappa_cut"), parameter("chi")
    return lemma(
        "L9",
        "|e_thi| <= chi < kappa_cut/N for all i implies max |theta_i - theta_l| <= N atanh(N chi/kappa_cut); "
        "per coordinate the same for z",
        Identity("inside the set the edges cancel: a g + a (-g) = 0", sp.S.Zero, weight * g + weight * -g),
        Identity(
            "N gaps shorter than M/N add up to less than M: some gap is M/N or longer",
            M - N * short,
            N * (M / N - short),
        ),
        NonNegative(
            "a link across the gap pulls at least a tanh(M/N), as tanh increases",
            weight * (level + rise) - weight * level,
        ),
        NonNegative(
            "N chi >= sum over the set of e_i >= kappa_cut tanh(M/N), so tanh(M/N) <= N chi/kappa_cut",
            N * chi / kappa - level,
            ({chi: kappa * (level + rise) / N},),
        ),
        needs=("L0", "L2"),
        note="sort the leader's value and all values on one side of it; the set lies beyond a gap of at least M/N; "
        "kappa_cut "
        "is the least a_l(S) + cut(S) over vehicle sets, so every set is held by it",
    )


def l10() -> Claim:
    """nu > 0: psi differs from every constant on every window."""
    a, b, length, c = parameter("a"), parameter("b"), parameter("l"), symbol("c")
    s_1, s_2, mu, T = symbol("S_1"), symbol("S_2"), parameter("mu"), PERIOD
    h, psi2, f = parameter("h"), parameter("psi2"), symbol("f", nonnegative=True)
    double = sp.integrate(sp.integrate((a - b) ** 2, (a, 0, length)), (b, 0, length))
    slope = sp.sqrt(mu / T) / 2
    return lemma(
        "L10",
        "nu := inf_t min_c int_t^{t+T} (psi - c)^2 >= mu l^3/(48 T), l = min(T/2, sqrt(mu/T)/(2 psi2))",
        NonNegative("|psi'| >= h within h/psi2 of a point where |psi'| >= 2h", 2 * h - psi2 * h / (psi2 * (1 + f)) - h),
        Identity("int int (a - b)^2 = l^4/6", length**4 / 6, double),
        Identity(
            "int (psi - c)^2 = (1/2l) int int (psi(a) - psi(b))^2 + l (c - mean)^2",
            s_2 - 2 * c * s_1 + c**2 * length,
            (2 * length * s_2 - 2 * s_1**2) / (2 * length) + length * (c - s_1 / length) ** 2,
        ),
        Identity(
            "h^2 l^4/6/(2l) = mu l^3/(48 T) with h = sqrt(mu/T)/2",
            mu * length**3 / (48 * T),
            slope**2 * length**4 / 6 / (2 * length),
        ),
        Check(
            "the paper's psi: the exact nu over one period exceeds the bound",
            _nu_of_paper,
            "orthogonality in exact rationals",
        ),
        note="some s has psi'(s)^2 >= mu/T; psi' keeps its sign and half that size on an interval of length l; mean "
        "value theorem",
    )


def nu_bound(mu: Any, period: Any, psi2: Any) -> Any:
    """mu l^3/(48 T) as a ball."""
    length = min(period / 2, (mu / period).sqrt() / (2 * psi2))
    return mu * length**3 / (48 * period)


def _nu_of_paper() -> tuple[bool, str]:
    psi = paper().psi
    exact = times_power_of_pi(variance(psi))
    least = nu_bound(times_power_of_pi(psi.power()), 2 * arb.pi() / ball(psi.frequency), ball(psi.derivative_bounds[1]))
    return bool(exact > least > 0), f"nu = {text(exact)} >= {text(least)} over T = 4 pi"


def l11() -> Claim:
    """A Lipschitz function that is large once dissipates."""
    rate, f, T = parameter("A"), symbol("f", nonnegative=True), PERIOD
    delta, left, right = parameter("delta"), symbol("L", nonnegative=True), symbol("R", nonnegative=True)
    x, t, y = symbol("x", nonnegative=True), symbol("t", nonnegative=True), parameter("y")
    return lemma(
        "L11",
        "f A-Lipschitz with sup|f| >= eta on a window of length T: int f tanh f >= min(T, eta/2A)(eta/2) tanh(eta/2)",
        NonNegative("|f| >= eta/2 within eta/(2A) of the peak", ETA - rate * ETA / (2 * rate * (1 + f)) - ETA / 2),
        NonNegative(
            "both sides shorter than delta: L + R = T >= min(T, delta)", left + right - T, ({T: left + right},)
        ),
        NonNegative("one side longer than delta: delta + min(R, delta) >= min(T, delta)", delta + right - delta),
        NonNegative(
            "(x tanh x)' = tanh x + x sech^2 x >= 0", t + x * (1 - t**2), ({t: 1 / (1 + y)},), "0 <= t = tanh x < 1"
        ),
        needs=("L0",),
        note="the part of the window within eta/(2A) of the peak is at least min(T, eta/2A) long",
    )


def _rate_bounds() -> tuple[Expr, Expr, Expr]:
    """rho, sigma and l_ii of the generic vehicle."""
    one, a = first(), generic().graph.weight[0]
    return (sp.sqrt(2) + 1) * one.D + a, one.D + a, a


def rate_steps() -> tuple[Step, ...]:
    """|b'|, |q'| <= rho eta and |e_theta'| <= sigma eta while |v|, |omega| <= eta."""
    one, two, g = first(), second(), generic()
    rho, sigma, weight = _rate_bounds()
    q, rate = symbol("q"), symbol("rate")
    led, s_1, s_2 = g.graph.leader_weight[0], symbol("s_1"), symbol("s_2")
    turning = led * s_1 * one.w + weight * s_2 * (one.w - two.w)
    sech = {s_1: sp.sech(one.theta - symbol("theta", "l")) ** 2, s_2: sp.sech(one.theta - two.theta) ** 2}
    bounds = {one.w: ETA, two.w: ETA, s_1: 1, s_2: 1, q: sp.sqrt(2) * one.D, rate: sigma * ETA}
    return (
        *projections(),
        Identity(
            "e_theta' = a_il sech^2 omega_i + a_ij sech^2 (omega_i - omega_j)",
            turning.subs(sech),
            g.dt(g.errors["e_theta"][0]),
        ),
        Identity("|e_theta'| <= sigma eta", sigma * ETA, majorant(turning, bounds)),
        Identity("|b'|, |q'| <= rho eta", rho * ETA, majorant(-one.w * q + rate, bounds)),
    )


def window_sums() -> tuple[Step, ...]:
    """beta, eps and xi: the terms of the integrated equations, each bounded, add up to the stated constants."""
    one, T = first(), PERIOD
    p0, p1, nu, beta, tau = (parameter(n) for n in ("psi0", "psi1", "nu", "beta", "tau"))
    rho, sigma = parameter("rho"), parameter("sigma")
    ramp = sp.integrate(tau, (tau, 0, T))  # int |t - s| dt <= T^2/2 for s in the window
    by_parts = one.I * (2 * 2 * p0 + p1 * T)
    rest = one.p_w * 2 * p0 * sigma * ramp + one.d_w * 2 * p0 * T + one.k * 2 * p0 * p0 * rho * ramp
    stated_b = (
        one.I * (4 * p0 + T * p1) + one.p_w * p0 * sigma * T**2 + 2 * p0 * T * one.d_w + one.k * p0**2 * rho * T**2
    )
    stated_e = (2 * one.I + one.p_w * sigma * T**2 / 2 + one.d_w * T + one.k * p0 * T * beta) / (
        one.p_w * T
    ) + sigma * T
    stated_q = (2 * one.m + one.p_v * rho * T**2 / 2 + one.d_v * T) / (one.p_v * T) + rho * T
    found_e = (2 * one.I + one.d_w * T + one.k * p0 * beta * T + one.p_w * sigma * ramp) / (one.p_w * T) + sigma * T
    found_q = (2 * one.m + one.d_v * T + one.p_v * rho * ramp) / (one.p_v * T) + rho * T
    return (
        Identity(
            "beta k nu = I(4psi0 + T psi1) + p_w psi0 sigma T^2 + 2 psi0 T d_w + k psi0^2 rho T^2 (+ rho T k nu)",
            stated_b,
            by_parts + rest,
        ),
        Identity("eps", stated_e, found_e),
        Identity("xi", stated_q, found_q),
        NonNegative("the bounds are positive", stated_b / (one.k * nu) + rho * T),
    )


def l12() -> Claim:
    """The window lemma: where nothing moves for a window, every error is small."""
    one = first()
    u_v, u_w = folded_inputs()
    w, psi, c = sp.Function("w")(symbol("t")), sp.Function("f")(symbol("t")), symbol("c")
    t = symbol("t")
    by_parts = sp.diff((psi - c) * w, t) - sp.diff(psi, t) * w
    mean, square, T = symbol("S_1"), symbol("S_2"), PERIOD
    return lemma(
        "L12",
        "|v|, |omega| <= eta on [t, t+T] implies |b_i| <= beta_i eta, |e_thi| <= eps_i eta, |q_i| <= xi_i eta there",
        Identity(
            "k psi b = I omega' + p_w e_theta + d_w tanh omega",
            one.k * one.psi * one.b,
            u_w + one.p_w * one.e_theta + one.d_w * sp.tanh(one.w),
        ),
        Identity("p_v q = -(m v' + d_v tanh v)", one.p_v * one.q, -u_v - one.d_v * sp.tanh(one.v)),
        Identity(
            "(psi - c) omega' = ((psi - c) omega)' - psi' omega",
            sp.expand((psi - c) * sp.diff(w, t)),
            sp.expand(by_parts),
        ),
        Identity(
            "int (psi - mean) psi = int (psi - mean)^2 >= nu",
            square - mean**2 / T,
            square - 2 * mean / T * mean + mean**2 / T**2 * T,
        ),
        *rate_steps(),
        *window_sums(),
        needs=("L0", "L1", "L4", "L10"),
        note="multiply the omega equation by psi minus its window mean, integrate by parts; the mean-free weight "
        "removes "
        "the constant part of e_theta; then the unweighted integrals give e_theta and q",
    )


def l13() -> Claim:
    """The dichotomy: over a window either Y_s falls by a fixed amount, or every error is small on it."""
    gamma, s, K = parameter("gamma"), parameter("s"), symbol("K", nonnegative=True)
    W, V, C = symbol("W", nonnegative=True), symbol("V", nonnegative=True), parameter("C0")
    n, start, T = parameter("n"), symbol("Y0"), PERIOD
    more = parameter("z")
    return lemma(
        "L13",
        "with J(t) = int_t^{t+T} (P_w + P_v): either J >= gamma(eta) and Y_s falls by gamma/2 over the window (s = "
        "gamma/2T), or "
        "|v|, |omega|, |e_th|, |q|, |b| <= chi on it; hence boundedness and, within a uniform time, a window of the "
        "second kind",
        Identity("Y_s(t+T) - Y_s(t) <= -gamma + s T = -gamma/2", -gamma / 2, (-gamma + s * T).subs(s, gamma / (2 * T))),
        NonNegative("Y_s >= -C0, since W + K V >= 0 (L8)", W + K * V - C + C),
        NonNegative(
            "more than 2 (Y_s(t0) + C0)/gamma windows of the first kind would bring Y_s below -C0",
            -C - (start - n * gamma / 2),
            ({n: 2 * (start + C) / gamma + more},),
        ),
        Check("chi = max(eta, beta eta, eps eta, xi eta) tends to 0 with eta", _linear_in_eta, "degree in eta"),
        needs=("L7", "L8", "L9", "L11", "L12"),
        note="if some |omega_i| or |v_i| reaches eta, L11 with A, B of L1 gives J >= gamma; otherwise L12. Y_s "
        "starts at most at its "
        "value on a window of the second kind (bounded by L8, L9) or falls, and rises by at most s T inside a window",
    )


def _linear_in_eta() -> tuple[bool, str]:
    largest = sum(parameter(name) * ETA for name in ("beta", "eps", "xi")) + ETA
    return bool(sp.limit(largest, ETA, 0) == 0 and sp.degree(largest, ETA) == 1), "chi is linear in eta"
