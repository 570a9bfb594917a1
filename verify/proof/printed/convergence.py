"""(21)-(25) and the inferences of the convergence proof; false ones by functions that meet the premises only.

A counterexample refutes the rule that the paper applies, not the conclusion: the corrected theorem proves the latter.
"""

from __future__ import annotations

from dataclasses import replace

import sympy as sp

from ..claim import Claim, Expr, Fact, Implication, Kind, Quotation, Relation
from ..lemmas.bounds import l1
from ..lemmas.energies import l4
from ..lemmas.functions import sech2, sech2_within, tanh_below_1
from ..method.fleet_symbols import generic_unit
from ..method.inferences import cited, counterexample, keeps_returning, tends_to_zero, vanishes
from ..method.normal_form import normal_form
from ..method.rules import (
    assumed,
    chained,
    grows,
    identity,
    instance,
    majorized,
    restated,
    root,
    scaled,
    sized,
    squares,
)
from ..method.symbols import nonnegative_symbol, parameter, symbol

U = generic_unit()
VI, VJ = U.vehicles
TIME, NUMBER = parameter("t"), sp.Symbol("n", integer=True, positive=True)


def claims(attractive: Fact) -> list[Claim]:
    """In the paper's order; `attractive` is the theorem's part (c)."""
    vanish = {id_: _vanish(id_, attractive, *what) for id_, what in _LIMITS.items()}
    return [
        eq_21(), vanish["eq-22"], eq_23(attractive), omega_not_to_0(), eq_24(), eq_25(), alpha_rate(), psi_rate(),
        orientation(), vanish["cascade"], vanish["eq-3-4"],
    ]  # fmt: skip


_LIMITS = {
    "eq-22": (VI.q,),
    "cascade": (VI.theta - symbol("theta", "l"),),
    "eq-3-4": (VI.v, VI.w, VI.error("x"), VI.error("y"), VI.error("theta")),
}


def _vanish(id_: str, attractive: Fact, *what: Expr) -> Claim:
    return Claim(id_, Kind.PAPER, tuple(vanishes(expression, U, attractive) for expression in what))


# -- (21)-(25) --------------------------------------------------------------------------------------------------------


def second_rate(dot: Expr) -> Expr:
    """The derivative of (13) or (14), with q' and b' by L4."""
    i_q, i_b = (l4().about(rate) for rate in (VI.q_dot, VI.b_dot))
    return U.dt(U.fold(U.definitions[dot])).subs({i_q.left: i_q.right, i_b.left: i_b.right})


def jerk(pull: Expr, sign: int) -> Expr:
    """-(1/m)[d_v v' sech^2 v + p_v omega pull] + sign (1/m) p_v phi^T e_z'."""
    return -(VI.d_v * VI.v_dot * sp.sech(VI.v) ** 2 + VI.p_v * VI.w * pull) / VI.m + sign * VI.p_v * VI.e_along / VI.m


def eq_21(stated: Expr | None = None) -> Claim:
    """v'' as printed: with phi for phi_perp and a plus before the last term."""
    printed = jerk(VI.q, 1) if stated is None else stated
    derived = second_rate(VI.v_dot)
    truth = identity(jerk(VI.b, -1), derived, U)
    return Claim("eq-21", Kind.PAPER, (identity(printed, derived, U),), truth=(truth,), quantity=VI.v_ddot)


def eq_23(attractive: Fact, stated: Expr | None = None) -> Claim:
    """What is left of (21) where v'', v' and e_z' vanish, divided by -p_v/m."""
    printed = VI.w * VI.q if stated is None else stated
    left = second_rate(VI.v_dot) + VI.d_v * VI.v_dot * sech2(VI.v) / VI.m + VI.p_v * VI.e_along / VI.m
    derived = sp.expand(-left * VI.m / VI.p_v)
    truth = (identity(VI.w * VI.b, derived, U), vanishes(VI.w * VI.b, U, attractive))
    return Claim("eq-23", Kind.PAPER, (identity(printed, derived, U),), truth=truth, quantity=symbol("limit"))


def eq_24() -> Claim:
    """omega''."""
    stated = -(VI.d_w * VI.w_dot * sp.sech(VI.w) ** 2 + VI.p_w * VI.e_theta_dot - printed_alpha_rate()) / VI.I
    return Claim("eq-24", Kind.PAPER, (identity(stated, second_rate(VI.w_dot), U),), quantity=VI.w_ddot)


def printed_alpha_rate() -> Expr:
    """(25), with phi^perp read as its transpose."""
    return VI.k * VI.psi_dot * VI.b - VI.k * VI.w * VI.psi * VI.q + VI.k * VI.psi * VI.e_across


def eq_25() -> Claim:
    """alpha'."""
    derived = U.dt(VI.k * VI.psi * VI.b)
    same = identity(printed_alpha_rate(), derived, U)
    return Claim("eq-25", Kind.READING, (same, identity(VI.alpha, VI.k * VI.psi * VI.b, U)), quantity=VI.alpha_dot)


# -- inferences -------------------------------------------------------------------------------------------------------


def fading_bumps() -> tuple[Expr, Expr, tuple[Fact, ...]]:
    """f = sin t and b = exp(-t sin^2 t): f b tends to 0, and neither f nor b does.

    With y = |sin t| the product is y exp(-t y^2) <= y/(1 + t y^2) <= 1/(2 sqrt t).
    """
    s, y = nonnegative_symbol("s"), nonnegative_symbol("y")
    f, b, peak = sp.sin(TIME), sp.exp(-TIME * sp.sin(TIME) ** 2), 1 / (2 * sp.sqrt(TIME))
    above = instance(grows(1 + s, sp.exp(s), s, (grows(sp.S.One, sp.exp(s), s),)), {s: TIME * y**2})
    wide = squares(y, (1 + TIME * y**2) * peak, [(peak, 1 - sp.sqrt(TIME) * y)])
    size = instance(scaled(chained(wide, scaled(above, peak)), sp.exp(-TIME * y**2)), {y: sp.Abs(f)})
    returns = keeps_returning(f, TIME, 2 * sp.pi * NUMBER + sp.pi / 2), keeps_returning(b, TIME, sp.pi * NUMBER)
    return f, b, (tends_to_zero(size, TIME, f * b), *returns)


def omega_not_to_0() -> Claim:
    """'omega does not tend to 0, so e_z -> 0': not to tend to 0 is not to be bounded away from 0."""
    f, b, facts = fading_bumps()
    rule = Implication(
        (Relation(VI.w * VI.b, "->", sp.S.Zero), Relation(VI.w, "-/>", sp.S.Zero)), Relation(VI.b, "->", sp.S.Zero)
    )
    return Claim("omega-not-to-0", Kind.PAPER, (counterexample(rule, {VI.w: f, VI.b: b}, facts),))


def psi_rate() -> Claim:
    """'psi' does not tend to 0, so phi_perp^T e_z -> 0': b may live where psi' vanishes, unless b' -> 0 as here."""
    f, b, facts = fading_bumps()
    premises = (Relation(VI.psi_dot * VI.b, "->", sp.S.Zero), Relation(VI.psi_dot, "-/>", sp.S.Zero))
    rule = Implication(premises, Relation(VI.b, "->", sp.S.Zero))
    wrong = counterexample(rule, {VI.psi_dot: f, VI.b: b}, facts)
    start = symbol("s")
    exciting = identity(sp.Integral(f**2, (TIME, start, start + 2 * sp.pi)), sp.pi)
    return Claim("psi-rate-not-to-0", Kind.PAPER, (wrong, exciting), truth=_slow_error())


def _slow_error() -> tuple[Fact, ...]:
    """mu b(t)^2 <= 2T (delta^2 + psi1^2 r^2 T^2) where |psi' b| <= delta and |b'| <= r over a window of (12).

    psi'^2 b(t)^2 <= 2 (psi' b)^2 + 2 psi'^2 (b - b(t))^2 at every time of the window, |b - b(t)| <= r T; integrate.
    With delta, r -> 0, b -> 0. b' = -omega q + phi_perp^T e_z' (L4) tends to 0 where omega and e_z' do.
    """
    now, delta, rate, period = symbol("b", "0"), parameter("delta"), parameter("r"), parameter("T")
    product, drift = symbol("y"), symbol("x")  # psi' b, and b - b(t)
    split = squares(
        VI.psi_dot**2 * now**2,
        2 * (VI.psi_dot * VI.b) ** 2 + 2 * VI.psi_dot**2 * (VI.b - now) ** 2,
        [(VI.psi_dot**2, 2 * VI.b - now)],
    )
    limits = [
        assumed(Relation(sp.Abs(value), "<=", bound))
        for value, bound in ((product, delta), (VI.psi_dot, VI.psi1), (drift, rate * period))
    ]
    size = majorized(
        2 * product**2 + 2 * VI.psi_dot**2 * drift**2, limits, 2 * delta**2 + 2 * VI.psi1**2 * rate**2 * period**2
    )
    return split, size, restated(l4().about(VI.b_dot))


def alpha_rate() -> Claim:
    """'alpha' -> 0': e_theta' contains the neighbours' omega_j, of which the case omega_i -> 0 says nothing.

    Vehicle i at rest, its neighbour swinging: theta_j = theta_i + sin t, omega_j = cos t.
    """
    zero = sp.S.Zero
    slope = VI.e_theta_dot
    swing = {VI.w: zero, VJ.theta: VI.theta + sp.sin(TIME), VJ.w: sp.cos(TIME)}
    moved = normal_form(U.unfold(slope).subs(swing))
    balance = Relation(VI.alpha_dot, "=", VI.I * VI.w_ddot + VI.d_w * VI.w_dot * sech2(VI.w) + VI.p_w * slope)
    rest = tuple(Relation(s, "->", zero) for s in (VI.w, VI.w_dot, VI.w_ddot))
    rule = Implication((*rest, balance), Relation(VI.alpha_dot, "->", zero))
    functions = {VI.w: zero, VI.w_dot: zero, VI.w_ddot: zero, slope: moved, VI.alpha_dot: VI.p_w * moved}
    facts = (
        tends_to_zero(identity(zero, zero), TIME),
        identity(functions[VI.alpha_dot], VI.p_w * functions[slope]),
        keeps_returning(functions[VI.alpha_dot], TIME, 2 * sp.pi * NUMBER),
    )
    wrong = counterexample(rule, functions, facts)
    return Claim("alpha-rate", Kind.PAPER, (wrong, identity(slope, moved, replace(U, units=tuple(swing.items())))))


def orientation() -> Claim:
    """'W' and omega' bounded, so W' -> 0 by Barbalat's lemma': the lemma needs the next derivative bounded."""
    f, f_dot = symbol("f"), symbol("f_dot")
    one = sp.S.One
    premises = (Relation(sp.Abs(f), "<=", one), Relation(sp.Abs(f_dot), "<=", one))
    rule = Implication(premises, Relation(f_dot, "->", sp.S.Zero))
    sine, cosine = sp.sin(TIME), sp.cos(TIME)
    within = (root(squares(sine**2, one, [(one, cosine)])), root(squares(cosine**2, one, [(one, sine)])))
    facts = (*within, keeps_returning(cosine, TIME, 2 * sp.pi * NUMBER))
    wrong = counterexample(rule, {f: sine, f_dot: cosine}, facts)
    return Claim("orientation", Kind.PAPER, (wrong,), truth=(_barbalat(),))


def _barbalat() -> Fact:
    """W' -> 0 for alpha = 0: W' = -sum (d/p) omega tanh omega has a bounded derivative where omega is bounded."""
    most, slope = parameter("omega_max"), symbol("S")
    rate = -VI.d_w / VI.p_w * VI.w * sp.tanh(VI.w)
    second = sp.expand(sp.diff(rate, VI.w) * VI.w_dot)
    turning, steep = l1().about(sp.Abs(VI.w_dot)), sized(*sech2_within(VI.w))
    limits = (turning, tanh_below_1(VI.w), assumed(Relation(sp.Abs(VI.w), "<=", most)))
    damping = VI.d_w / VI.p_w
    shown = -damping * (sp.tanh(VI.w) + VI.w * slope) * VI.w_dot
    chain = identity(second, shown.subs(slope, steep.left.args[0]))
    bound = majorized(shown, limits, damping * (1 + most) * turning.right, {slope: steep})
    return cited(BARBALAT, (chain, bound))


BARBALAT = Quotation(
    "Barbalat's lemma",
    "Khalil, Nonlinear Systems, Lemma 8.2",
    "f -> 0 where the integral of f converges and f' is bounded",
)
