"""The paper's Section 2 and 3 up to Proposition 1: the nonholonomic constraint, (1)-(11), (13), (14), Lemma 1.

Each stated form is typed as it is printed, for vehicle 1 with neighbour 2 and the leader; each derived form comes from
`models.equations`.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from ...models import equations
from ...models.algebra.ops import sympy_ops
from .claim import Claim
from .generic_fleet import Scene, generic, generic_physical, parameter, symbol
from .names import first, second
from .normal_form import Expr
from .steps import Identity, NonNegative
from .verdicts import printed


def claims() -> list[Claim]:
    """Every claim of this file."""
    return [*kinematics(), *dynamics(), *graph(), *controller(), *closed_loop()]


def kinematics() -> list[Claim]:
    """(1) and the constraint that it implies."""
    one, g = first(), generic()
    x_dot, y_dot, theta_dot = (getattr(g.closed_loop, name)[0] for name in ("x", "y", "theta"))
    return [
        printed(
            "eq-1",
            "(1)",
            "z' = phi(theta) v, theta' = omega",
            Identity("x' = v cos theta", one.cos * one.v, x_dot),
            Identity("y' = v sin theta", one.sin * one.v, y_dot),
            Identity("theta' = omega", one.w, theta_dot),
            note="the kinematics of a wheel pair that rolls without slip; the model evaluates this form",
            quantity=symbol("x_dot", 1),
        ),
        printed(
            "nonholonomic",
            "nonholonomic constraint after (1)",
            "x' sin theta - y' cos theta = 0",
            Identity("x' sin theta - y' cos theta = 0", sp.S.Zero, x_dot * one.sin - y_dot * one.cos),
            note="(1) moves along the heading only",
            needs=("eq-1",),
        ),
        printed(
            "annihilator",
            "text after (12)",
            "phi_perp(theta)^T phi(theta) = 0",
            Identity("phi_perp^T phi = 0", sp.S.Zero, one.across(one.cos, one.sin)),
            note="the two directions are orthogonal",
        ),
    ]


def _wheels() -> tuple[Expr, Expr]:
    return symbol("tau_l", 1), symbol("tau_r", 1)


def moment_of_wheel_forces() -> Expr:
    """The moment about the centre of the forces tau / r along phi at +R phi_perp (left) and -R phi_perp (right)."""
    one, (left, right) = first(), _wheels()

    def cross(a: tuple[Expr, Expr], b: tuple[Expr, Expr]) -> Expr:
        return a[0] * b[1] - a[1] * b[0]

    lever, heading = (-one.R * one.sin, one.R * one.cos), (one.cos, one.sin)
    return cross(lever, heading) * left / one.r - cross(lever, heading) * right / one.r


def dynamics() -> list[Claim]:
    """(2), (6) and the inner loop, with both readings of the lever arm."""
    one, (left, right) = first(), _wheels()
    v_dot, w_dot = (rates[0] for rates in _accelerations(generic(), left, right))
    convention = printed(
        "eq-2",
        "(2)",
        "m v' = (tau_l + tau_r)/r and I omega' = 2R (tau_l - tau_r)/r",
        Identity("I omega' = 2R (tau_l - tau_r)/r", 2 * one.R * (left - right) / one.r, one.I * w_dot),
        Identity("m v' = (tau_l + tau_r)/r", (left + right) / one.r, one.m * v_dot),
        note="a convention: lever arm 2R, left minus right; the model evaluates this form with drive = 'paper'",
        quantity=one.I * one.w_dot,
    )
    arm = printed(
        "eq-2-physical",
        "(2) with R the half distance between the wheels",
        "the moment of the wheel forces is (2R/r)(tau_l - tau_r)",
        Identity("moment = (2R/r)(tau_l - tau_r)", 2 * one.R * (left - right) / one.r, moment_of_wheel_forces()),
        note="forces tau/r along the heading at +-R across it have the moment (R/r)(tau_r - tau_l)",
        quantity=one.I * one.w_dot,
    )
    return [convention, arm, *inner_loop()]


def _accelerations(scene: Scene, left: Expr, right: Expr) -> tuple[Any, Any]:
    from ...models.arrays import column

    zero = sp.S.Zero
    return equations.accelerations(scene.plant, column([left, zero]), column([right, zero]))


def printed_torques() -> tuple[Expr, Expr]:
    """(6) as printed: left and right."""
    one, u_v, u_w = first(), symbol("u_v", 1), symbol("u_omega", 1)
    turn = u_w / (2 * one.R)
    return one.r / 2 * (u_v + turn), one.r / 2 * (u_v - turn)


def inner_loop() -> list[Claim]:
    """(6) inverts (2) as printed; on a physical drive it turns the sign of the turn channel."""
    from ...models.arrays import column

    one, u_v, u_w = first(), symbol("u_v", 1), symbol("u_omega", 1)
    left, right = printed_torques()
    v_dot, w_dot = (rates[0] for rates in _accelerations(generic(), left, right))
    inputs = (column([u_v, 0]), column([u_w, 0]))
    own_inverse = equations.wheel_torques(generic_physical().plant, *inputs)
    physical = _accelerations(generic_physical(), own_inverse[0][0], own_inverse[1][0])[1][0]
    on_physical = moment_of_wheel_forces().subs(dict(zip(_wheels(), (left, right), strict=True))) / one.I
    return [
        printed(
            "eq-6",
            "(6)",
            "replacing (6) in (2) yields v' = u_v / m, omega' = u_omega / I",
            Identity("omega' = u_omega / I", u_w / one.I, w_dot),
            Identity("v' = u_v / m", u_v / one.m, v_dot),
            note="(6) is the exact inverse of (2) as printed",
            needs=("eq-2",),
            quantity=one.w_dot,
        ),
        printed(
            "eq-6-physical",
            "(6) on a physical drive",
            "(6) as printed yields omega' = u_omega / I on a drive whose moment is (R/r)(tau_r - tau_l)",
            Identity("omega' = u_omega / I", u_w / one.I, on_physical),
            truth="tau_l = (r/2)(u_v - u_omega/R), tau_r = (r/2)(u_v + u_omega/R)",
            truth_steps=(Identity("omega' = u_omega / I", u_w / one.I, physical),),
            note="the turn channel gets the gain -1/2: positive feedback",
            needs=("eq-2-physical",),
            quantity=one.w_dot,
        ),
    ]


def graph() -> list[Claim]:
    """(5) and Lemma 1, by sums of squares that are added up edge by edge."""
    weight, (y_1, y_2) = parameter("a", 12), (symbol("y", 1), symbol("y", 2))
    led = (parameter("a", "1l"), parameter("a", "2l"))
    laplacian = sp.Matrix([[weight, -weight], [-weight, weight]])
    y = sp.Matrix([y_1, y_2])
    form = (y.T * laplacian * y)[0]
    composed = (y.T * (laplacian + sp.diag(*led)) * y)[0]
    squares = weight * (y_1 - y_2) ** 2
    return [
        printed(
            "eq-5",
            "(5)",
            "L 1 = 0, L is symmetric, with one zero eigenvalue and the rest positive on a connected graph",
            Identity("y^T L y = sum over edges of a_ij (y_i - y_j)^2", squares, form),
            Identity("L 1 = 0", sp.S.Zero, (laplacian * sp.ones(2, 1))[0]),
            Identity("L = L^T", laplacian[0, 1], laplacian[1, 0]),
            note="a sum of squares, one per edge, so L >= 0; it is 0 only where all y_i along edges agree",
            quantity=symbol("y^T L y"),
        ),
        printed(
            "lemma-1",
            "Lemma 1",
            "L_l = L + diag(a_il) is symmetric and positive definite on a connected graph with a leader link",
            Identity(
                "y^T L_l y = sum a_il y_i^2 + sum over edges of a_ij (y_i - y_j)^2",
                squares + led[0] * y_1**2 + led[1] * y_2**2,
                composed,
            ),
            _tree_descent(),
            note="the sum of squares is 0 only if y is 0 at the led vehicles and constant along edges",
            needs=("eq-5",),
        ),
    ]


def _tree_descent() -> NonNegative:
    """y_i^2 <= 2 (y_i - y_parent)^2 + 2 y_parent^2: down a tree from a led vehicle the form bounds every y_i."""
    child, parent = symbol("y", 1), symbol("y", 2)
    root = symbol("u", nonnegative=True)
    gap = 2 * (child - parent) ** 2 + 2 * parent**2 - child**2
    cases = tuple(
        {child: 2 * parent + sign * root} for sign in (1, -1)
    )  # the gap is (child - 2 parent)^2: the case split loses nothing
    return NonNegative(
        "y_i^2 <= 2 (y_i - y_j)^2 + 2 y_j^2, from the leader down a spanning tree", gap, cases, "all reals"
    )


def controller() -> list[Claim]:
    """(7)-(11), typed as printed, against the functions that are simulated and shipped."""
    one, two, g = first(), second(), generic()
    a_l, a = g.graph.leader_weight[0], g.graph.weight[0]
    ops, psi = sympy_ops(), g.psi
    x_bar = one.x - one.delta_x, two.x - two.delta_x
    theta_l = symbol("theta", "l")
    u_v = g.fold(equations.linear_input(ops, g.gains, g.state, g.consensus_errors)[0])
    u_w = g.fold(equations.angular_input(ops, g.gains, psi, g.state, g.consensus_errors)[0])
    alpha = g.fold(equations.excitation_input(ops, g.gains, psi, g.state, g.consensus_errors)[0])
    e_x = a_l * sp.tanh(x_bar[0] - symbol("x", "l")) + a * sp.tanh(x_bar[0] - x_bar[1])
    e_theta = a_l * sp.tanh(one.theta - theta_l) + a * sp.tanh(one.theta - two.theta)
    stated_w = -one.p_w * one.e_theta - one.d_w * sp.tanh(one.w) + one.alpha
    rows = (
        ("7", "u_v = -p_v phi^T e_z - d_v tanh v", symbol("u_v", 1), -one.p_v * one.q - one.d_v * sp.tanh(one.v), u_v),
        ("8", "e_z = a_il tanh(z_i - z_l) + sum_j a_ij tanh(z_i - z_j)", one.e_x, e_x, g.errors["e_x"][0]),
        ("9", "u_omega = -p_omega e_theta - d_omega tanh omega + alpha", symbol("u_omega", 1), stated_w, u_w),
        ("10", "e_theta = a_il tanh(theta_i - theta_l) + sum_j ...", one.e_theta, e_theta, g.errors["e_theta"][0]),
        ("11", "alpha = k psi phi_perp^T e_z", symbol("alpha", 1), one.k * one.psi * one.b, alpha),
    )
    return [_definition(number, statement, left, stated, derived) for number, statement, left, stated, derived in rows]


def _definition(number: str, statement: str, left: Expr, stated: Expr, derived: Expr) -> Claim:
    return printed(
        f"eq-{number}",
        f"({number})",
        statement,
        Identity(statement, stated, derived, generic()),
        note="a definition; the model's function is identical to the printed form",
        quantity=left,
    )


def closed_loop() -> list[Claim]:
    """(13) and (14): what comes out of (2) after (6), (7) and (9)."""
    one, g = first(), generic()
    v_dot, w_dot = g.fold(g.closed_loop.v[0]), g.fold(g.closed_loop.omega[0])
    stated_v = -(one.p_v * one.q + one.d_v * sp.tanh(one.v)) / one.m
    stated_w = -(one.p_w * one.e_theta + one.d_w * sp.tanh(one.w) - one.alpha) / one.I
    return [
        printed(
            "eq-13",
            "(13)",
            "v' = -[p_v phi^T e_z + d_v tanh v] / m",
            Identity("v' as printed", stated_v, v_dot, g),
            note="through the torques (6) and the vehicle (2)",
            needs=("eq-1", "eq-6", "eq-7", "eq-8"),
            quantity=one.v_dot,
        ),
        printed(
            "eq-14",
            "(14)",
            "omega' = -[p_omega e_theta + d_omega tanh omega - alpha] / I",
            Identity("omega' as printed", stated_w, w_dot, g),
            note="through the torques (6) and the vehicle (2)",
            needs=("eq-1", "eq-6", "eq-9", "eq-10", "eq-11"),
            quantity=one.w_dot,
        ),
    ]
