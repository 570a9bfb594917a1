"""Lemmas L7 and L9-L12: their constants, derived here; that such constants exist, and what follows, is machine-checked.

"Window" is a time [t, t + T]; eta bounds |v_i| and |omega_i| over it.
"""

from __future__ import annotations

import sympy as sp

from ....models.arrays import column
from .. import constants
from ..claim import Claim, Expr, Fact, Kind, Relation
from ..formal import Development, proved_by
from ..method.fleet_symbols import SymbolicFleet, generic
from ..method.inferences import compared
from ..method.rules import assumed, by_equation, chained, identity, majorized, ordered
from ..method.symbols import Vehicle, nonnegative_symbol, parameter, symbol
from ..method.windows import ETA, PERIOD, Weight, over_window
from .bounds import ROOT2, l1, l6, psi_limit
from .energies import l2, l3, l4
from .functions import tanh_below_line

N, PEAK, SIZE, CHI = parameter("N"), parameter("M"), nonnegative_symbol("x"), parameter("chi")


# -- L7 ---------------------------------------------------------------------------------------------------------------


def l7(formal: Development) -> Claim:
    """sum g_i |v_i| <= e + K_e P_v, in two cases of |v| against e/(N g); so Y_e = W-hat + (K_e + 1) V falls."""
    fleet = generic()
    i, slack, level = fleet[0], parameter("e"), nonnegative_symbol("h")
    weights = fleet.column("g", positive=True)
    weight, speed = weights[0], slack / (N * weights[0])
    share = constants.damping_share(fleet.setting, weights, slack, N)[0]
    slow = ordered(weight * SIZE, "<=", slack / N, (Relation(SIZE, "<=", speed),))
    faster = (Relation(level, ">=", sp.tanh(speed / i.s)),)
    fast = ordered(weight * SIZE, "<=", share * i.d_v / i.p_v * SIZE * level, faster)
    K, P_w, P_v = (symbol(name) for name in ("K", "P_w", "P_v"))
    falls = identity(-P_w + slack + K * P_v - (K + 1) * P_v, -(P_w + P_v) + slack, by=(*l3().facts, *l6().facts))
    formally = proved_by("energy_family", formal)
    return Claim("L7", Kind.LEMMA, (slow, fast, falls, formally))


# -- L9 ---------------------------------------------------------------------------------------------------------------


def l9(formal: Development) -> Claim:
    """|e_i| <= chi for all i implies |error_i| <= M.

    Of N gaps between sorted values one is M/N or longer; the set beyond it is held by at least
    kappa_cut tanh(M/(N rho)), since the edges inside it cancel (L2), and by at most N chi.
    """
    fleet, cut = generic(), parameter("kappa_cut")
    level = constants.level_for(fleet.setting, PEAK, fleet.angle, cut, N)
    at_level = SymbolicFleet("i", [], units=((CHI, level),))
    pulls = identity(N * CHI, cut * sp.tanh(PEAK / (N * fleet.angle)), at_level, l2().facts[:1])
    return Claim("L9", Kind.LEMMA, (pulls, _chain_of_two(), proved_by("inverse_bound", formal)))


def _chain_of_two() -> Fact:
    """The worst case of two vehicles in a chain with unit weights, kappa_cut = 1: both errors at the level for M = 1/2.

    Then tanh(theta_1) = 2 chi and tanh(theta_2 - theta_1) = chi, with which theta_2 must not exceed M.
    """
    most = sp.Rational(1, 2)
    level = constants.level_for(generic().setting, most, sp.S.One, sp.S.One, sp.Integer(2))
    reached = sp.atanh(2 * level) + sp.atanh(level)
    return compared(Relation(reached, "<=", most), {})


# -- L10, L11 ---------------------------------------------------------------------------------------------------------


def l10(formal: Development) -> Claim:
    """nu >= mu h^3/(48 T): psi' keeps half of sqrt(mu/T) over a stretch h, so psi differs from every constant."""
    mu, psi2, h, c = parameter("mu"), parameter("psi2"), parameter("h"), symbol("c")
    slope, a, b = sp.sqrt(mu / PERIOD) / 2, symbol("x"), symbol("y")
    stretch = constants.steep_stretch(PERIOD, mu, psi2)
    steep = ordered(slope, "<=", 2 * slope - psi2 * SIZE, (Relation(SIZE, "<=", stretch),))
    twice = sp.Integral((slope * (a - b)) ** 2, (a, 0, h), (b, 0, h))
    s_1, s_2 = symbol("S", "1"), symbol("S", "2")  # the integrals of psi and psi^2 over the stretch
    split = identity(s_2 - 2 * c * s_1 + c**2 * h, (2 * h * s_2 - 2 * s_1**2) / (2 * h) + h * (c - s_1 / h) ** 2)
    bound = identity(constants.variance_bound(PERIOD, mu, h), twice / (2 * h))
    return Claim("L10", Kind.LEMMA, (steep, split, bound, proved_by("excitation", formal)))


def l11(formal: Development) -> Claim:
    """|f| >= eta/2 within eta/(2A) of its peak eta; there f tanh(f/o) is at least (eta/2) tanh(eta/2o)."""
    fleet, rate, length, level = generic(), parameter("A"), parameter("L"), nonnegative_symbol("h")
    scale = fleet[0].o
    near = ordered(ETA / 2, "<=", ETA - rate * SIZE, (Relation(SIZE, "<=", constants.spike_length(ETA, rate)),))
    half = (Relation(SIZE, ">=", ETA / 2), Relation(level, ">=", sp.tanh(ETA / (2 * scale))))
    lost = ordered(constants.spike_energy(fleet.setting, ETA, length, scale), "<=", length * SIZE * level, half)
    return Claim("L11", Kind.LEMMA, (near, lost, proved_by("spike_falls", formal)))


# -- L12 --------------------------------------------------------------------------------------------------------------


def l12(formal: Development, l10_: Claim) -> Claim:
    """Over a window with |v|, |omega| <= eta: |b| <= beta eta, |e_theta| <= eps eta, |q| <= xi eta."""
    fleet, variance, across = generic(), parameter("nu"), parameter("beta")
    i, setting = fleet[0], fleet.setting
    turning = identity(i.I * i.w_dot, fleet.fold(i.I * fleet.closed_loop.omega[0]), fleet)
    driving = identity(i.m * i.v_dot, fleet.fold(i.m * fleet.closed_loop.v[0]), fleet)
    mean_free, variance_kept = _mean_free(i)
    moves = _rates_within(fleet)
    b, q, heading = (moves[name] for name in (i.b, i.q, i.e_theta))
    slow_turn, slow_drive = (_damping_within(n, scale) for n, scale in ((i.w, i.o), (i.v, i.s)))
    psi = psi_limit(i.psi, i.psi_bar)
    small_b = assumed(Relation(sp.Abs(i.b), "<=", across * ETA))
    beta = constants.across_bound(setting, PERIOD, variance)[0]
    eps = constants.heading_bound(setting, PERIOD, column([across, across]))[0]
    xi = constants.along_bound(setting, PERIOD)[0]
    weight = Weight(mean_free.right, i.psi1, i.k * variance)
    steps = (
        over_window(turning, i.b, weight, (b, heading), (slow_turn, psi), beta, fleet.dots),
        over_window(turning, i.e_theta, _even(i.p_w), (heading,), (slow_turn, psi, small_b), eps, fleet.dots),
        over_window(driving, i.q, _even(i.p_v), (q,), (slow_drive,), xi, fleet.dots),
    )
    facts = (mean_free, variance_kept, *moves.values(), *steps)
    return Claim("L12", Kind.LEMMA, (*facts, proved_by("window_small", formal, l10_.facts)))


def _even(gain: Expr) -> Weight:
    """f = 1."""
    return Weight(sp.S.One, sp.S.Zero, gain * PERIOD)


def _mean_free(i: Vehicle) -> tuple[Fact, Fact]:
    """f = psi less its mean: |f| <= 2 psi_bar, and int f psi = int f^2, which is at least nu (L10)."""
    mean, total, power = symbol("mean"), symbol("S", "1"), symbol("S", "2")
    limits = psi_limit(i.psi, i.psi_bar), assumed(Relation(sp.Abs(mean), "<=", i.psi_bar))
    square = power - 2 * total / PERIOD * total + (total / PERIOD) ** 2 * PERIOD
    return majorized(i.psi - mean, limits, 2 * i.psi_bar), identity(power - total / PERIOD * total, square)


def _within(speed: Expr) -> Fact:
    return assumed(Relation(sp.Abs(speed), "<=", ETA))


def _damping_within(speed: Expr, scale: Expr) -> Fact:
    """|tanh(speed/scale)| <= eta/scale."""
    line = tanh_below_line(speed / scale)
    return chained(line, ordered(line.right, "<=", ETA / scale, (_within(speed),)))


def _rates_within(fleet: SymbolicFleet) -> dict[Expr, Fact]:
    """|b'|, |q'| <= r eta and |e_theta'| <= sigma eta, from L1 and L4."""
    i, j = fleet.vehicles
    pull, turn = (rate(fleet.setting)[0] * ETA for rate in (constants.pull_rate, constants.heading_rate))
    within = {n: (_within(n.v), _within(n.w)) for n in (i, j)}
    found = {}
    for name, other, projected in ((i.b, i.q, i.e_across), (i.q, i.b, i.e_along)):
        moved = l1().about(sp.Abs(projected))
        moved = chained(moved, ordered(moved.right, "<=", pull - ROOT2 * i.D * ETA, (within[i][0], within[j][0])))
        rate = l4().about(fleet.dots[name])
        limits = (within[i][1], l1().about(sp.Abs(other)), moved)
        found[name] = by_equation(majorized(rate.right, limits, pull), rate.left, rate)
    heading = l1().about(sp.Abs(i.e_theta_dot))
    found[i.e_theta] = chained(heading, ordered(heading.right, "<=", turn, (within[i][1], within[j][1])))
    return found
