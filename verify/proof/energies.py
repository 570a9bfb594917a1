"""Lemmas L2-L5: the edge identity and the derivatives of V, W and the modified energy.

`identities()` holds what the paper prints of these, (17)-(20), together with L5; the claims and the mutants both take
their identities from here.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import sympy as sp

from ...models import energy
from ...models.algebra.log_cosh import log_cosh
from ...models.algebra.ops import sympy_ops
from ...models.arrays import column
from .claim import Claim
from .generic_fleet import Scene, concrete, generic, parameter, symbol
from .names import Names, first
from .normal_form import Expr, normal_form
from .steps import Check, Identity, NonNegative
from .verdicts import lemma

Form = Callable[[Scene], Expr]


def vehicles(scene: Scene) -> list[Names]:
    """The names of every vehicle of a scene."""
    return [Names(scene, i) for i in range(1, scene.vehicles + 1)]


def translational(scene: Scene) -> Expr:
    """V of (17), from the model."""
    return energy.translational(sympy_ops(), scene.plant, scene.gains, scene.state)


def rotational(scene: Scene) -> Expr:
    """W of (19), from the model."""
    return energy.rotational(sympy_ops(), scene.plant, scene.gains, scene.state)


def modified(scene: Scene) -> Expr:
    """W-hat of L5, from the model."""
    return energy.modified(sympy_ops(), scene.plant, scene.gains, scene.psi, scene.psi_dot, scene.state)


def translational_rate(scene: Scene) -> Expr:
    """The right side of (18)."""
    return -sum(n.d_v / n.p_v * n.v * sp.tanh(n.v) for n in vehicles(scene))


def rotational_rate(scene: Scene) -> Expr:
    """The right side of (20)."""
    return -sum((n.d_w * n.w * sp.tanh(n.w) - n.w * n.alpha) / n.p_w for n in vehicles(scene))


def modified_rate(scene: Scene) -> Expr:
    """The right side of L5: only psi', psi'' and the rates of e_z are left beside the damping."""
    damping = sum(n.d_w / n.p_w * n.w * sp.tanh(n.w) for n in vehicles(scene))
    return -damping + sum(n.k / n.p_w * _excited(n) for n in vehicles(scene))


def _excited(n: Names) -> Expr:
    inertial = -n.m / n.p_v * n.psi_ddot * n.v + n.d_v / n.p_v * n.psi_dot * sp.tanh(n.v)
    return inertial - n.psi * n.q_of_rate


def derivative(text: str, form: Form, rate: Form, scene: Scene) -> Identity:
    """form' = rate along the closed loop of a scene."""
    return Identity(text, rate(scene), scene.dt(form(scene)), scene)


_RATES: dict[str, tuple[str, Form, Form]] = {
    "V'": ("V' = -P_v", translational, translational_rate),
    "W'": ("W' = -P_w + sum omega alpha / p_omega", rotational, rotational_rate),
    "What'": (
        "What' = -P_w + sum (k/p_w){-(m/p_v) psi'' v + (d_v/p_v) psi' tanh v - psi phi^T e_z'}",
        modified,
        modified_rate,
    ),
}


@cache
def energy_rate(name: str) -> Identity:
    """The identity of L3 (V'), L4 (W') or L5 (What') on the generic vehicle and edge."""
    text, form, rate = _RATES[name]
    return derivative(text, form, rate, generic())


def claims() -> list[Claim]:
    """L2-L5 and the atoms that they use."""
    return [atoms(), l2(), l3(), l4(), l5()]


def atoms() -> Claim:
    """L0: what is used of tanh, sech and log cosh, each from its derivative."""
    s, x = symbol("s", nonnegative=True), parameter("x")
    tanh = sp.tanh(s)
    e, half = sp.exp(x), sp.Rational(1, 2)
    sinh_, cosh_ = (e - 1 / e) / 2, (e + 1 / e) / 2
    slope = sp.diff(s * tanh - log_cosh(s), s)
    t = symbol("t", nonnegative=True)
    return lemma(
        "L0",
        "|tanh s| < 1; 0 < sech^2 <= 1; |tanh s| <= |s|; |s| - ln 2 <= log cosh s <= s^2/2; s tanh s >= log cosh s; "
        "tanh s / s decreases on s > 0",
        Identity("cosh^2 - sinh^2 = 1, so 1 - tanh^2 = 1/cosh^2 > 0", sp.S.Zero, sp.expand(cosh_**2 - sinh_**2) - 1),
        Identity("(log cosh)' = tanh", tanh, sp.diff(log_cosh(s), s)),
        NonNegative("tanh' = 1 - tanh^2 >= 0 and <= 1", 1 - t**2, ({t: 1 / (1 + x)},), "0 <= tanh < 1"),
        Identity("(s - tanh s)' = tanh^2 >= 0, so tanh s <= s and log cosh s <= s^2/2", tanh**2, sp.diff(s - tanh, s)),
        Identity("(s tanh s - log cosh s)' = s sech^2 s >= 0", s * (1 - tanh**2), slope),
        Identity("cosh s - e^s/2 = e^-s/2 > 0, so log cosh s >= s - ln 2", half / e, sp.expand(cosh_ - e / 2)),
        Identity(
            "s^2 (tanh s / s)' = s sech^2 s - tanh s", s * (1 - tanh**2) - tanh, sp.expand(s**2 * sp.diff(tanh / s, s))
        ),
        Identity(
            "(s sech^2 s - tanh s)' = -2 s tanh sech^2 <= 0",
            -2 * s * tanh * (1 - tanh**2),
            sp.diff(s * (1 - tanh**2) - tanh, s),
        ),
        note="functions that vanish at 0 and whose derivatives have one sign; odd and even parity give s < 0",
    )


def edge_identity(forward: Expr | None = None, backward: Expr | None = None) -> Identity:
    """L2 on one edge, g odd: y_i a_ij g(x_i - x_j) + y_j a_ji g(x_j - x_i) = a (y_i - y_j) g(x_i - x_j)."""
    weight = parameter("a", 12)
    forward, backward = forward or weight, backward or weight
    y_1, y_2, g = symbol("y", 1), symbol("y", 2), symbol("g")
    there_and_back = y_1 * forward * g + y_2 * backward * (-g)
    halves = (forward * (y_1 - y_2) * g + backward * (y_2 - y_1) * (-g)) / 2
    return Identity("y_i a g + y_j a (-g) = (a/2)[(y_i - y_j) g + (y_j - y_i)(-g)]", halves, there_and_back)


def l2() -> Claim:
    """The edge identity, and that the two graph verbs of the model are each other's transpose, edge by edge."""
    return lemma(
        "L2",
        "for g odd and a_ij = a_ji: sum_i y_i sum_j a_ij g(x_i - x_j) = (1/2) sum_ij a_ij (y_i - y_j) g(x_i - x_j)",
        edge_identity(),
        *(_verbs(scene) for scene in (generic(), *concrete())),
        *(_affine(name) for name in _RATES),
        note="both sides are sums over edges, so one edge proves it for every graph and N; identities whose residual "
        "is "
        "affine in the weights are lifted by it from N = 2, E = 1 to any graph",
    )


def _verbs(scene: Scene) -> Identity:
    ops, graph = sympy_ops(), scene.graph
    y, f = scene.column("y"), sp.symbols(f"f_1:{graph.edges + 1}", real=True)
    forces = column(f)
    at_vehicles = sum(y * ops.edge_sum(graph, forces))
    at_edges = sum(forces * ops.edge_difference(graph, y))
    return Identity(
        f"the verbs edge_sum and edge_difference are transposes (N = {graph.vehicles})", at_edges, at_vehicles
    )


def _affine(name: str) -> Check:
    """The unreduced rate of an energy is affine in the weights: no product of two of them."""

    def compute() -> tuple[bool, str]:
        scene = generic()
        weights = [*scene.graph.weight, *scene.graph.leader_weight]
        _, form, rate = _RATES[name]
        sides = (scene.unfold(rate(scene)), scene.unfold(scene.dt(form(scene))))
        degree = max(sp.Poly(normal_form(side), *weights).total_degree() for side in sides)
        return degree <= 1, f"degree {degree} in (a_12, a_1l, a_2l)"

    return Check(f"{name} is affine in the weights", compute, "degree of the polynomial in the weights")


def _instances(name: str) -> list[Identity]:
    text, form, rate = _RATES[name]
    return [derivative(f"{text} on a graph with N = {s.vehicles}", form, rate, s) for s in concrete()]


def l3() -> Claim:
    """V' = -P_v."""
    return lemma("L3", "V' = -P_v <= 0", energy_rate("V'"), *_instances("V'"), needs=("L0", "L2", "eq-13"))


def projections() -> tuple[Identity, Identity]:
    """q' and b' of L4."""
    one, g = first(), generic()
    return (
        Identity("q' = omega b + phi^T e_z'", one.w * one.b + one.q_of_rate, g.dt(one.q), g),
        Identity("b' = -omega q + phi_perp^T e_z'", -one.w * one.q + one.b_of_rate, g.dt(one.b), g),
    )


def l4() -> Claim:
    """W' and the rates of the along-track and cross-track errors."""
    return lemma(
        "L4",
        "W' = -P_w + sum omega alpha/p_omega; q' = omega b + phi^T e_z'; b' = -omega q + phi_perp^T e_z'",
        energy_rate("W'"),
        *projections(),
        *_instances("W'"),
        needs=("L2", "eq-14"),
    )


def l5() -> Claim:
    """The key identity: the term omega alpha, which no damping dominates, is a total derivative up to terms in v."""
    return lemma(
        "L5",
        "What := W - sum (k/p_w)[psi q + (m/p_v) psi' v] has "
        "What' = -P_w + sum (k/p_w){-(m/p_v) psi'' v + (d_v/p_v) psi' tanh v - psi phi^T e_z'}",
        energy_rate("What'"),
        *_instances("What'"),
        needs=("L3", "L4"),
        note="omega alpha = k[(psi q)' - psi' q - psi phi^T e_z'] and q = -(m v' + d_v tanh v)/p_v",
    )
