"""(15) and (16) on the paper's gains, (16) against its purpose, and the saturation paragraph."""

from __future__ import annotations

import sympy as sp
from flint import arb

from ...models import conditions
from .ball import evaluate, text
from .claim import Claim
from .generic_fleet import parameter, symbol
from .names import first
from .normal_form import Expr, majorant
from .printed_model import printed_torques
from .saturation import psi_bar, pull_bound, pulling_supremum, pulls, turning_supremum
from .steps import Check, Identity
from .verdicts import printed
from .witness import FAR, paper, paper_peak


def claims() -> list[Claim]:
    """Every claim of this file."""
    return [*torque_conditions(), *saturation_paragraph()]


def condition_holds(condition: str) -> tuple[bool, str]:
    """Whether a condition of `models.conditions` holds for every vehicle of the paper, with its numbers."""
    data = paper()
    found = getattr(conditions, condition)(conditions.exact_numbers(), data.fleet.condition_data(data.psi), data.gains)
    least = min(found.margin / found.large)
    values = ", ".join(
        f"{float(small):.6g} <= {float(large):.6g}" for small, large in zip(found.small, found.large, strict=True)
    )
    return bool(all(found.holds)), f"{values}; smallest margin {100 * float(least):.2g} %"


def torque_conditions() -> list[Claim]:
    """(15), (16) on the paper's gains; (16) against its purpose."""
    p, c, D = pulls()
    return [
        printed(
            "eq-15-paper",
            "(15) on the paper's gains",
            "the gains of Section 4 satisfy (15)",
            Check(
                "(15) for every vehicle",
                lambda: condition_holds("condition_15"),
                "exact rational arithmetic, roots rounded up",
            ),
            note="tight for every vehicle",
            needs=("psi-bar",),
        ),
        printed(
            "eq-16",
            "(16)",
            "2R ubar_v + ubar_omega < (4R/r) min{taubar_r, taubar_l} implies Constraint 1",
            pull_bound(sp.sqrt(2) * D * (p + c), text="(16) implies (16*): p + kappa >= sqrt(p^2 + kappa^2)"),
            note="sufficient, and conservative; the exact form is (16*)",
            needs=("L16", "L16b"),
        ),
        printed(
            "eq-16-paper",
            "(16) on the paper's gains",
            "the gains of Section 4 satisfy (16)",
            Check(
                "(16) for every vehicle",
                lambda: condition_holds("condition_16"),
                "exact rational arithmetic, roots rounded up",
            ),
            Check("its excess over (16*) is 2.6 to 3.7 %", _conservatism, "exact rational arithmetic"),
            note="tight for vehicles 2, 4, 5 and 6; against (16*) it is 2.6 to 3.7 % conservative",
            needs=("psi-bar",),
        ),
    ]


def _conservatism() -> tuple[bool, str]:
    data, numbers = paper(), conditions.exact_numbers()
    room = data.fleet.condition_data(data.psi)
    printed_bound = conditions.condition_16(numbers, room, data.gains).small * room.r / (2 * room.arm)
    excess = printed_bound / conditions.torque_bound(numbers, room, data.gains) - 1
    low, high = 100 * float(min(excess)), 100 * float(max(excess))
    return low >= 2.55 and high <= 3.75, f"excess {low:.2f} to {high:.2f} %"


def saturation_paragraph() -> list[Claim]:
    """The bounds of u_v, u_omega and the torques at the end of the proof, and Proposition 1's own ubar."""
    one = first()
    c = sp.sqrt(2) * one.k * psi_bar()
    stated_v = one.d_v + sp.sqrt(2) * one.p_v * one.D
    bars = parameter("u_bar_v", 1), parameter("u_bar_omega", 1)
    largest = one.r / 2 * (bars[0] + bars[1] / (2 * one.R))
    proposition = one.d_w + one.p_w * one.D + c * one.D
    return [
        printed(
            "ubar-v",
            "saturation paragraph, ubar_v",
            "|u_v| <= d_v + sqrt2 p_v (a_il + l_ii)",
            Identity("the supremum of |u_v|", stated_v, pulling_supremum()),
            note="the supremum, not attained",
            needs=("L0", "eq-7"),
            quantity=symbol("u_bar_v", 1),
        ),
        ubar_omega(printed_ubar_omega()),
        printed(
            "ubar-omega-prop",
            "Proposition 1, ubar_omega",
            "|u_omega| <= d_omega + p_omega D + sqrt2 k psibar D",
            Identity("the supremum of |u_omega|", proposition, turning_supremum()),
            note="the supremum, not attained",
            needs=("L0", "eq-9"),
            quantity=symbol("u_bar_omega", 1),
        ),
        printed(
            "max-torque",
            "saturation paragraph, torques",
            "max{|tau_r|, |tau_l|} <= (r/2)[ubar_v + ubar_omega/(2R)]",
            Identity("the triangle inequality in (6)", largest, _largest_torque(bars)),
            note="the triangle inequality in (6), with ubar_omega of Proposition 1",
            needs=("eq-6", "ubar-v", "ubar-omega-prop"),
        ),
    ]


def _largest_torque(bars: tuple[Expr, Expr]) -> Expr:
    u_v, u_w = symbol("u_v", 1), symbol("u_omega", 1)
    return majorant(printed_torques()[0], {u_v: bars[0], u_w: bars[1]})


def printed_ubar_omega() -> Expr:
    """ubar_omega as the saturation paragraph prints it."""
    one, weight = first(), parameter("a", 12)  # l_11 = a_12 in the generic scene
    led = one.D - weight
    return one.d_w + one.p_w * led + (one.p_w + sp.sqrt(2) * one.k * psi_bar()) * weight


def ubar_omega(stated: Expr) -> Claim:
    """Judge a bound of |u_omega| against its supremum and against a state of the paper's fleet."""
    return printed(
        "ubar-omega",
        "saturation paragraph, ubar_omega",
        "|u_omega| <= d_omega + p_omega a_il + (p_omega + sqrt2 k psibar) l_ii",
        Identity("the supremum of |u_omega|", stated, turning_supremum()),
        Check(
            "it holds at a state of the paper's fleet",
            lambda: _turning_on_paper(stated),
            "the model's equations in ball arithmetic",
        ),
        note="omits sqrt2 k psibar a_il where the vehicle hears the leader; Proposition 1's form is the true one",
        needs=("L0", "eq-9"),
        quantity=symbol("u_bar_omega", 1),
    )


def _turning_on_paper(stated: Expr) -> tuple[bool, str]:
    """Vehicle 2 far out, heading 3 pi / 4 less many turns, psi at its peak: |u_omega| against the stated bound."""
    data, one = paper(), first()
    state = data.state({1: (-FAR, -FAR)}, {1: 3 * arb.pi() / 4 - 2 * FAR * arb.pi()}, omega={1: -FAR})
    reached = abs(data.turning_input(paper_peak(), state)[1])
    gains = data.exact_gains
    values = {one.d_w: gains.d_omega[1], one.p_w: gains.p_omega[1], one.k: gains.k_alpha[1], psi_bar(): paper_peak()}
    weights = {parameter("a", "1l"): data.plant.graph.leader_weight[1], parameter("a", 12): arb(3)}
    allowed = evaluate(stated, values | weights)
    return bool(
        reached <= allowed
    ), f"vehicle 2 reaches |u_omega| = {text(reached, 5)} N m, the bound is {text(allowed, 5)} N m"
