"""(15) and (16) on the paper's gains, (16) against its purpose, and the saturation paragraph."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp
from flint import arb

from ....models import conditions
from ..claim import Claim, Expr, Fact, Kind, Relation
from ..lemmas.bounds import l1, psi_limit
from ..lemmas.functions import tanh_below_1
from ..lemmas.torques import l16, l16_sufficient
from ..method.ball import precise, text
from ..method.fleet_balls import FAR, paper, paper_peak
from ..method.fleet_symbols import generic_unit
from ..method.inferences import compared
from ..method.rules import assumed, majorized, renamed, restated, saturated
from ..method.symbols import parameter, symbol

U = generic_unit()
VI, _ = U.vehicles
C = sp.sqrt(2) * VI.k * VI.psi_bar


def claims() -> list[Claim]:
    """In the paper's order."""
    return [eq_16(), ubar_v(), ubar_omega(), ubar_omega_of_proposition(), max_torque()]


def on_the_paper() -> list[Claim]:
    """(15) and (16) for the gains of Section 4, vehicle by vehicle, and how much (16) asks beyond (16*)."""
    rows = (("eq-15-paper", conditions.condition_15), ("eq-16-paper", conditions.condition_16))
    return [Claim(id_, Kind.PAPER, met_on_the_paper(condition)) for id_, condition in rows] + [conservatism()]


def met_on_the_paper(condition: conditions.Condition) -> tuple[Fact, ...]:
    """A condition in exact rational arithmetic, roots rounded up."""
    data = paper()
    found = condition(conditions.exact_numbers(), data.fleet.condition_data(data.psi), data.gains)
    sign, facts = "<" if found.strict else "<=", []
    for n, (small, large) in enumerate(zip(found.small, found.large, strict=True), 1):
        names = symbol("small", str(n)), symbol("large", str(n))
        facts.append(compared(Relation(names[0], sign, names[1]), dict(zip(names, (small, large), strict=True))))
    return tuple(facts)


def conservatism() -> Claim:
    """The torque that (16) allows for, over T of (16*): 2.551 to 3.646 % more on the paper's data."""
    data, numbers = paper(), conditions.exact_numbers()
    room = data.fleet.condition_data(data.psi)
    allowed = conditions.condition_16(numbers, room, data.gains).small * room.r / (2 * room.arm)
    excess = 100 * (allowed / conditions.torque_bound(numbers, room, data.gains) - 1)
    share = symbol("excess")
    bounds = ((">=", min(excess), sp.Rational("2.551")), ("<=", max(excess), sp.Rational("3.646")))
    facts = tuple(compared(Relation(share, sign, most), {share: value}) for sign, value, most in bounds)
    return Claim("conservatism", Kind.REMARK, facts)


def eq_16() -> Claim:
    """(16) implies Constraint 1, through (16*)."""
    return Claim("eq-16", Kind.PAPER, (*map(restated, l16_sufficient().facts), *map(restated, l16().facts[:4:2])))


# -- the saturation paragraph -----------------------------------------------------------------------------------------


def _corner(cos: Expr, sin: Expr) -> dict[Expr, Expr]:
    """Vehicle i far out, every tanh at -1, its heading free."""
    tanhs = {sp.tanh(VI.v): -1, sp.tanh(VI.w): -1}
    return {VI.e_x: -VI.D, VI.e_y: -VI.D, VI.e_theta: -VI.D, VI.cos: cos, VI.sin: sin, VI.psi: VI.psi_bar, **tanhs}


def _supremum(name: Expr, limits: Sequence[Fact], stated: Expr, heading: tuple[Expr, Expr]) -> tuple[Fact, Fact]:
    """|input| < stated, and the input comes as near to stated as one likes."""
    folded = U.fold(U.definitions[name])
    below = renamed(majorized(folded, limits, stated), name, U)
    in_errors = folded.xreplace({VI.q: VI.along(VI.e_x, VI.e_y), VI.b: VI.across(VI.e_x, VI.e_y)})
    return below, saturated(in_errors, _corner(*heading), stated)


def ubar_v() -> Claim:
    """|u_v| < d_v + sqrt2 p_v D."""
    limits, half = (l1().about(sp.Abs(VI.q)), tanh_below_1(VI.v)), 1 / sp.sqrt(2)
    return Claim("ubar-v", Kind.PAPER, _supremum(VI.u_v, limits, VI.d_v + sp.sqrt(2) * VI.p_v * VI.D, (half, half)))


def printed_ubar_omega() -> Expr:
    """ubar_omega of the saturation paragraph: sqrt2 k psi_bar beside l_ii, but not beside a_il."""
    led, inner = U.graph.leader_weight[0], U.graph.weight[0]
    return VI.d_w + VI.p_w * led + (VI.p_w + C) * inner


def proposition_ubar_omega() -> Expr:
    """ubar_omega of Proposition 1."""
    return VI.d_w + VI.p_w * VI.D + C * VI.D


def ubar_omega(stated: Expr | None = None) -> Claim:
    """The bound of |u_omega|, against its supremum and against a state of the paper's fleet."""
    printed = printed_ubar_omega() if stated is None else stated
    return Claim(
        "ubar-omega",
        Kind.PAPER,
        (*_turning(printed), _turning_on_paper(printed)),
        truth=_turning(proposition_ubar_omega()),
    )


def ubar_omega_of_proposition() -> Claim:
    """Proposition 1 has it right."""
    return Claim("ubar-omega-prop", Kind.PAPER, _turning(proposition_ubar_omega()))


def _turning(stated: Expr) -> tuple[Fact, Fact]:
    half = 1 / sp.sqrt(2)
    limits = (
        l1().about(sp.Abs(VI.e_theta)),
        l1().about(sp.Abs(VI.b)),
        psi_limit(VI.psi, VI.psi_bar),
        tanh_below_1(VI.w),
    )
    return _supremum(VI.u_omega, limits, stated, (-half, half))


def _turning_on_paper(stated: Expr) -> Fact:
    """Vehicle 2 far out, heading 3 pi/4 less many turns, psi at its peak: |u_omega| against the stated bound."""
    data = paper()
    with precise():
        state = data.state({1: (-FAR, -FAR)}, {1: 3 * arb.pi() / 4 - 2 * FAR * arb.pi()}, omega={1: -FAR})
        reached, gains = abs(data.turning_input(paper_peak(), state)[1]), data.exact_gains
        values = {VI.d_w: gains.d_omega[1], VI.p_w: gains.p_omega[1], VI.k: gains.k_alpha[1], VI.psi_bar: paper_peak()}
        led = data.plant.graph.leader_weight[1]
        weights = {U.graph.leader_weight[0]: led, U.graph.weight[0]: data.plant.graph.degree[1] - led}
        place = {symbol(axis, "2"): symbol(axis, "l") + symbol(f"delta_{axis}", "2") - FAR for axis in "xy"}
        turned = {symbol("theta", "2"): 3 * sp.pi / 4 - 2 * FAR * sp.pi, symbol("omega", "2"): sp.Integer(-FAR)}
        point = place | turned | {symbol("psi"): text(paper_peak())}
        most = sp.Abs(symbol("u_omega", "2"))
        return compared(Relation(most, "<=", stated), {most: reached, **values, **weights}, point)


def max_torque() -> Claim:
    """|tau| <= (r/2)[ubar_v + ubar_omega/(2R)]: the triangle inequality in (6)."""
    bars = parameter("u_bar_v", VI.index), parameter("u_bar_omega", VI.index)
    limits = [
        assumed(Relation(sp.Abs(value), "<=", bar)) for value, bar in zip((VI.u_v, VI.u_omega), bars, strict=True)
    ]
    stated = VI.r / 2 * (bars[0] + bars[1] / (2 * VI.R))
    wheels = ((VI.tau_l, 1), (VI.tau_r, -1))
    return Claim(
        "max-torque",
        Kind.PAPER,
        tuple(
            renamed(majorized(VI.r / 2 * (VI.u_v + sign * VI.u_omega / (2 * VI.R)), limits, stated), name, U)
            for name, sign in wheels
        ),
    )
