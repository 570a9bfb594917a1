"""Sections 2 and 3 up to Proposition 1: (1)-(11), the constraint, Lemma 1, (13), (14); and units of measurement."""

from __future__ import annotations

from dataclasses import replace

import sympy as sp

from ..claim import Claim, Expr, Fact, Kind
from ..method.fleet_symbols import OPS, generic, generic_physical, generic_unit
from ..method.normal_form import normal_form
from ..method.rules import identity, squares
from ..method.symbols import parameter, symbol

U, PHYSICAL = generic_unit(), generic_physical()
VI, VJ = U.vehicles  # the generic vehicle and its neighbour
A_L, A_J = U.graph.leader_weight
A = U.graph.weight[0]


def claims() -> list[Claim]:
    """In the paper's order."""
    return [*kinematics(), *dynamics(), *graph(), *inner_loop(), *controller(), *closed_loop()]


def kinematics() -> list[Claim]:
    """(1) and the constraint that it implies."""
    rows = ((VI.x_dot, VI.v * VI.cos), (VI.y_dot, VI.v * VI.sin), (VI.theta_dot, VI.w))
    return [
        Claim("eq-1", Kind.PAPER, tuple(identity(rate, stated, U) for rate, stated in rows)),
        Claim("nonholonomic", Kind.PAPER, (identity(VI.x_dot * VI.sin - VI.y_dot * VI.cos, 0, U),)),
    ]


def moment_of_wheel_forces() -> Expr:
    """The moment about the centre of the forces tau / r along phi at +R phi_perp (left) and -R phi_perp (right)."""
    lever = (-VI.R * VI.sin, VI.R * VI.cos)
    turn = lever[0] * VI.sin - lever[1] * VI.cos
    return normal_form(turn * VI.tau_l / VI.r - turn * VI.tau_r / VI.r)


def dynamics() -> list[Claim]:
    """(2), a convention, and what it is where R is half the distance between the wheels."""
    moment, sum_ = 2 * VI.R * (VI.tau_l - VI.tau_r) / VI.r, (VI.tau_l + VI.tau_r) / VI.r
    physical, rate = VI.R / VI.r * (VI.tau_r - VI.tau_l), VI.I * VI.w_dot
    return [
        Claim("eq-2", Kind.PAPER, (identity(VI.m * VI.v_dot, sum_, U), identity(rate, moment, U))),
        Claim(
            "eq-2-physical",
            Kind.PAPER,
            (identity(moment, moment_of_wheel_forces()),),
            truth=(identity(physical, moment_of_wheel_forces()), identity(physical, rate, PHYSICAL)),
            quantity=rate,
        ),
    ]


def graph() -> list[Claim]:
    """(5) and Lemma 1, as sums of squares that are added up edge by edge."""
    y, z = U.column("y"), U.column("z")
    square = A * (y[0] - y[1]) ** 2
    form, mixed, turned = (sum(a * laplacian(b)) for a, b in ((y, y), (z, y), (y, z)))
    led = sum(U.graph.leader_weight * y * y)
    descent = squares(y[0] ** 2, 2 * (y[0] - y[1]) ** 2 + 2 * y[1] ** 2, [(sp.S.One, y[0] - 2 * y[1])])
    return [
        Claim("eq-5", Kind.PAPER, (identity(form, square), identity(mixed, turned))),
        Claim("lemma-1", Kind.PAPER, (identity(form + led, square + A_L * y[0] ** 2 + A_J * y[1] ** 2), descent)),
    ]


def laplacian(y: Expr) -> Expr:
    """L y with the model's graph verbs."""
    return OPS.edge_sum(U.graph, U.graph.weight * OPS.edge_difference(U.graph, y))


def inner_loop() -> list[Claim]:
    """(6), and what it does on a drive whose moment is (R/r)(tau_r - tau_l)."""
    left, right = (VI.r / 2 * (VI.u_v + sign * VI.u_omega / (2 * VI.R)) for sign in (1, -1))
    on_physical = VI.R / VI.r * (right - left) / VI.I
    true_left, true_right = (VI.r / 2 * (VI.u_v + sign * VI.u_omega / VI.R) for sign in (-1, 1))
    return [
        Claim(
            "eq-6",
            Kind.PAPER,
            (
                identity(VI.tau_l, left, U),
                identity(VI.tau_r, right, U),
                identity(VI.v_dot, VI.u_v / VI.m, U),
                identity(VI.w_dot, VI.u_omega / VI.I, U),
            ),
        ),
        Claim(
            "eq-6-physical",
            Kind.PAPER,
            (identity(VI.u_omega / VI.I, on_physical),),
            truth=(
                identity(VI.tau_l, true_left, PHYSICAL),
                identity(VI.tau_r, true_right, PHYSICAL),
                identity(VI.w_dot, VI.u_omega / VI.I, PHYSICAL),
            ),
            quantity=VI.w_dot,
        ),
    ]


def controller() -> list[Claim]:
    """(7)-(11) as printed, against the functions that are simulated and shipped."""
    e_x, e_y, e_theta = (
        A_L * sp.tanh(VI.error(axis)) + A * sp.tanh(VI.error(axis, VJ)) for axis in ("x", "y", "theta")
    )
    u_w = -VI.p_w * VI.e_theta - VI.d_w * sp.tanh(VI.w) + VI.alpha
    q, b = symbol("q"), symbol("b")
    turned = VI.across(VI.cos * q - VI.sin * b, VI.sin * q + VI.cos * b)
    return [
        Claim("eq-7", Kind.PAPER, (identity(VI.u_v, -VI.p_v * VI.along(VI.e_x, VI.e_y) - VI.d_v * sp.tanh(VI.v), U),)),
        Claim("eq-8", Kind.PAPER, (identity(VI.e_x, e_x, U), identity(VI.e_y, e_y, U))),
        Claim("eq-9", Kind.PAPER, (identity(VI.u_omega, u_w, U),)),
        Claim("eq-10", Kind.PAPER, (identity(VI.e_theta, e_theta, U),)),
        Claim("eq-11", Kind.READING, (identity(VI.alpha, VI.k * VI.psi * VI.across(VI.e_x, VI.e_y), U),)),
        Claim("annihilator", Kind.PAPER, (identity(turned, b),)),
    ]


def closed_loop() -> list[Claim]:
    """(13) and (14), through the torques (6) and the vehicle (2)."""
    v_dot = -(VI.p_v * VI.along(VI.e_x, VI.e_y) + VI.d_v * sp.tanh(VI.v)) / VI.m
    w_dot = -(VI.p_w * VI.e_theta + VI.d_w * sp.tanh(VI.w) - VI.alpha) / VI.I
    return [
        Claim("eq-13", Kind.PAPER, (identity(VI.v_dot, v_dot, U),)),
        Claim("eq-14", Kind.PAPER, (identity(VI.w_dot, w_dot, U),)),
    ]


def scales() -> list[Claim]:
    """What the scales do to the paper's equations: nothing where all are 1, other units where rho = 1 and s = l o."""
    scaled = generic()
    per_vehicle = [s for n in scaled.vehicles for s in (n.s, n.o)]
    unit = replace(scaled, units=tuple((s, sp.S.One) for s in (scaled.length, scaled.angle, *per_vehicle)))
    stated = {getattr(VI, name): errors[0] for name, errors in U.errors.items()}
    stated |= {name: U.fold(U.definitions[name]) for name in (VI.v_dot, VI.w_dot)}
    at_unit = tuple(identity(name, rate, unit) for name, rate in stated.items())
    return [Claim("unit-scales", Kind.REMARK, at_unit), Claim("other-units", Kind.REMARK, _other_units())]


def _other_units() -> tuple[Fact, ...]:
    """rho = 1, s = l o: with lengths in l, times in 1/o, masses m l o^2, inertias I o^2 these are (13)-(14)."""
    scaled = generic()
    length, rate = scaled.length, parameter("o")
    units = [
        (scaled.angle, sp.S.One),
        *((n.o, rate) for n in scaled.vehicles),
        *((n.s, length * rate) for n in scaled.vehicles),
    ]
    hats: dict[Expr, Expr] = {}
    places = [s for n in scaled.vehicles for s in (n.x, n.y, n.delta_x, n.delta_y)] + [
        symbol("x", "l"),
        symbol("y", "l"),
    ]
    sizes = [(places, length), ([n.v for n in scaled.vehicles], length * rate), ([n.w for n in scaled.vehicles], rate)]
    for letters, unit in sizes:
        for s in letters:
            base, _, index = s.name.rpartition("_")
            hats[s] = symbol(f"{base}_hat", index)
            units.append((s, unit * hats[s]))
    heavier = {VI.m: VI.m * length * rate**2, VI.I: VI.I * rate**2}
    mapped = replace(scaled, units=tuple(units))
    rows = ((VI.x_dot, length * rate), (VI.v_dot, length * rate**2), (VI.w_dot, rate**2), (VI.tau_l, 1), (VI.tau_r, 1))
    return tuple(
        identity(name, sp.expand(unit * normal_form(U.unfold(name)).xreplace(hats | heavier)), mapped)
        for name, unit in rows
    )
