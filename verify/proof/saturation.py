"""Lemmas L16 and L18: the suprema of the inputs and torques, (16) and (16*), and the certified speed limits.

A bound is judged against the supremum that algebra derives: it holds if stated >= supremum for all parameters, and it
is refuted by parameters (and, for the paper's data, by a state) where it is smaller.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import sympy as sp

from ...models.arrays import column
from ...models.equations import wheel_torques
from .claim import Claim
from .generic_fleet import generic, generic_physical, parameter, symbol
from .names import first
from .normal_form import Expr, majorant, normal_form
from .steps import Identity, NonNegative, Step
from .verdicts import lemma

Cases = tuple[Mapping[Expr, Expr], ...]


@cache
def kappa() -> Expr:
    """kappa = k psibar / (2R): the weight of phi_perp beside p_v in a torque."""
    one = first()
    return one.k * psi_bar() / (2 * one.R)


@cache
def psi_bar() -> Expr:
    """psibar_1."""
    return parameter("psi_bar", 1)


def corner(expression: Expr, cos: Expr, sin: Expr, turn: int = -1) -> Expr:
    """The limit of a folded input of vehicle 1 as it moves off to where every tanh of x, y, v is -1, psi = psibar.

    All differences of vehicle 1 can tend to -infinity together; its angle does so (or to +infinity, turn = 1, with
    omega) in whole turns, so that its cosine and sine are free.
    """
    one = first()
    limits = {one.e_x: -one.D, one.e_y: -one.D, one.e_theta: turn * one.D, sp.tanh(one.v): -1, sp.tanh(one.w): turn}
    turned = expression.xreplace({one.cos: cos, one.sin: sin, one.psi: psi_bar()})
    return turned.xreplace(limits)


def folded_inputs() -> tuple[Expr, Expr]:
    """u_v and u_omega with the errors as symbols."""
    g, one = generic(), first()
    return g.fold(g.closed_loop.v[0]) * one.m, g.fold(g.closed_loop.omega[0]) * one.I


def error_ranges() -> tuple[Step, ...]:
    """|e_x|, |e_y|, |e_theta| < D: every tanh by 1 in the model's own error."""
    g, one = generic(), first()
    steps = []
    for name in ("e_x", "e_y", "e_theta"):
        error = g.errors[name][0]
        largest = majorant(error, dict.fromkeys(sp.expand(error).atoms(sp.tanh), sp.S.One))
        steps.append(Identity(f"|{name}| < D by |tanh| < 1", one.D, largest))
    return tuple(steps)


def rotation_identity() -> Identity:
    """(p q - kappa b)^2 + (p b + kappa q)^2 = (p^2 + kappa^2)(e_x^2 + e_y^2): Cauchy-Schwarz with its remainder."""
    one, p, c = first(), parameter("p"), parameter("kappa")
    squares = (p * one.q - c * one.b) ** 2 + (p * one.b + c * one.q) ** 2
    return Identity(
        "|(p phi - kappa phi_perp)^T e|^2 <= (p^2 + kappa^2) |e|^2", (p**2 + c**2) * (one.e_x**2 + one.e_y**2), squares
    )


def supremum_pull() -> Expr:
    """sqrt2 D sqrt(p_v^2 + kappa^2)."""
    one = first()
    return sp.sqrt(2) * one.D * sp.sqrt(one.p_v**2 + kappa() ** 2)


def torque_supremum(pull: Expr | None = None) -> Expr:
    """T of (16*), with (2) as printed; `pull` replaces sqrt2 D sqrt(p_v^2 + kappa^2) in mutants."""
    one = first()
    pull = supremum_pull() if pull is None else pull
    return one.r / 2 * (one.d_v + pull + (one.d_w + one.p_w * one.D) / (2 * one.R))


def torque_limit_identity(wheel: int) -> Identity:
    """The torque of one wheel (0 left, 1 right) in its corner, heading along (p -+ kappa, p +- kappa), equals T."""
    one, sign = first(), (1, -1)[wheel]
    u_v, u_w = folded_inputs()
    size = sp.sqrt(2) * sp.sqrt(one.p_v**2 + kappa() ** 2)
    torque = one.r / 2 * (u_v + sign * u_w / (2 * one.R))
    heading = (one.p_v - sign * kappa()) / size, (one.p_v + sign * kappa()) / size
    rational = sp.together(
        corner(torque, *heading, turn=-sign) - torque_supremum()
    )  # a multiple of size - size^2 / size
    side = ("left", "right")[wheel]
    return Identity(f"the {side} torque tends to T of (16*)", sp.S.Zero, sp.expand(sp.fraction(rational)[0]))


def physical_drive() -> Identity:
    """On a physical drive the left wheel takes the right one's formula, with R for 2R."""
    u_v, u_w = (column([symbol(name, 1), sp.S.Zero]) for name in ("u_v", "u_omega"))
    left, _ = wheel_torques(generic_physical().plant, u_v, u_w)
    _, right = wheel_torques(generic().plant, u_v, u_w)
    R = first().R
    return Identity("physical drive: the wheels change places and R stands for 2R", right[0].subs(R, R / 2), left[0])


def pull_bound(pull: Expr, cases: Cases = ({},), text: str = "the pull is at least its supremum") -> NonNegative:
    """pull >= sqrt2 D sqrt(p^2 + kappa^2), compared by squares; pull may hold Max(p, kappa) resolved by the cases."""
    p, c, D = parameter("p"), parameter("kappa"), parameter("D")
    return NonNegative(text, pull**2 - 2 * D**2 * (p**2 + c**2), cases)


def pulls() -> tuple[Expr, Expr, Expr]:
    """p, kappa, D: the letters of `pull_bound`."""
    return parameter("p"), parameter("kappa"), parameter("D")


def turning_supremum() -> Expr:
    """The supremum of |u_omega|: every term at its largest, which the corner with heading -pi/4 reaches."""
    half = 1 / sp.sqrt(2)
    return normal_form(corner(folded_inputs()[1], -half, half))


def pulling_supremum() -> Expr:
    """The supremum of |u_v|: the corner with heading pi/4."""
    half = 1 / sp.sqrt(2)
    return normal_form(corner(folded_inputs()[0], half, half))


def claims() -> list[Claim]:
    """L16 and L18."""
    return [l16(), l16_sufficient(), l18()]


def l16() -> Claim:
    """(d): T_i is the supremum of both torques, over all states and times, and is not attained."""
    p, c, D = pulls()
    return lemma(
        "L16",
        "sup |tau| = T = (r/2)[d_v + sqrt2 D sqrt(p_v^2 + (k psibar/(2R))^2) + (d_w + p_w D)/(2R)] over all states and "
        "times, never attained: Constraint 1 holds from every state iff T <= min(taubar_l, taubar_r)",
        rotation_identity(),
        *error_ranges(),
        pull_bound(
            sp.sqrt(2) * D * sp.sqrt(p**2 + c**2), text="|pull| < sqrt2 D sqrt(p^2 + kappa^2) from |e_z|^2 < 2 D^2"
        ),
        torque_limit_identity(0),
        torque_limit_identity(1),
        physical_drive(),
        needs=("L0", "eq-6", "eq-7", "eq-9", "eq-11", "thm-a"),
        note="upper bound by Cauchy-Schwarz and |tanh| < 1; reached in the limit of vehicle 1 far away (angles live on "
        "the real line, so the heading is free); every state is met at every time, since solutions extend backwards",
    )


def l16_sufficient() -> Claim:
    """(16) implies (16*), because sqrt(p^2 + kappa^2) <= p + kappa."""
    p, c, D = pulls()
    one = first()
    printed = one.r / 2 * (pulling_supremum() + turning_supremum() / (2 * one.R))
    scaled = one.r / (4 * one.R) * (2 * one.R * pulling_supremum() + turning_supremum())
    return lemma(
        "L16b",
        "(16) implies (16*)",
        Identity("(16) times r/(4R) bounds (r/2)[ubar_v + ubar_w/(2R)]", printed, scaled),
        pull_bound(sp.sqrt(2) * D * (p + c), text="sqrt2 D (p + kappa) >= sqrt2 D sqrt(p^2 + kappa^2)"),
        needs=("L16",),
    )


def dominates(cases: Cases, text: str) -> NonNegative:
    """d - (u + c) >= 0: damping at full speed outweighs p D = u and the excitation c, whatever their signs."""
    d, u, c = damping_letters()
    return NonNegative(text, d - u - c, cases, "u = p_w D, c = sqrt2 k psibar D, all positive")


def damping_letters() -> tuple[Expr, Expr, Expr]:
    """d, u = p D, c."""
    return parameter("d"), parameter("u"), parameter("c")


def l18() -> Claim:
    """(f): above the level where damping outweighs all else, |omega| (and likewise |v|) falls."""
    d, u, c = damping_letters()
    rise, e, a = parameter("s"), parameter("e"), parameter("z")
    level = (u + c) / d
    outward = d * (level + rise) - (u - e) - (c - a)
    pull, e_v = parameter("u"), parameter("e")
    return lemma(
        "L18",
        "d_w > p_w D + c implies |omega(t)| <= max(|omega(t0)|, atanh((p_w D + c)/d_w)); "
        "d_v > sqrt2 p_v D implies |v(t)| <= max(|v(t0)|, atanh(sqrt2 p_v D/d_v))",
        dominates(({d: u + c + rise},), "the level (p D + c)/d is below 1, so atanh of it exists"),
        NonNegative("I omega' < 0 where tanh omega >= (p D + c)/d, since |e_theta| < D and |alpha| < c", outward),
        NonNegative("m v' < 0 where tanh v >= sqrt2 p_v D/d_v", d * (pull / d + rise) - (pull - e_v)),
        needs=("L0", "L1"),
        note="comparison at the level; the system is odd in (omega, e_theta, alpha), which gives the lower side",
    )
