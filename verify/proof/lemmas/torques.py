"""Lemmas L16 and L18: the suprema of the torques, (16*), and the certified limits; the conditions against both."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import sympy as sp

from ....models import conditions
from ....models.arrays import column
from ....models.conditions import ConditionData, Inequality
from .. import constants
from ..claim import Claim, Expr, Fact, Kind, Relation
from ..method.fleet_symbols import SymbolicFleet, generic, generic_physical
from ..method.normal_form import normal_form
from ..method.rules import (
    assumed,
    by_gap,
    by_squares,
    cauchy_schwarz,
    chained,
    identity,
    majorized,
    ordered,
    renamed,
    saturated,
    scaled,
)
from ..method.symbols import parameter
from .bounds import ROOT2, l1, psi_limit
from .functions import tanh_below_1

NUMBERS = replace(conditions.sympy_numbers(), atanh=np.frompyfunc(sp.atanh, 1, 1))  # of symbols
# The letters of the limits that a fleet file may ask for.
LIMITS = {
    "torque": "tau_max",
    "speed": "v_max",
    "turn_rate": "omega_max",
    "wheel_speed": "wheel_max",
    "acceleration": "a_v",
    "turn_acceleration": "a_omega",
}


def data_of(fleet: SymbolicFleet) -> ConditionData:
    """What the conditions take besides gains, as symbols."""
    plant, arm = fleet.plant, column(sp.Abs(arm) for arm in fleet.plant.arm)
    letters = {name: fleet.column(letter, positive=True) for name, letter in LIMITS.items()}
    return ConditionData(
        degree=fleet.graph.degree,
        psi_bar=fleet.column("psi_bar", positive=True),
        r=plant.r,
        arm=arm,
        m=plant.m,
        inertia=plant.inertia,
        longest_arm=arm,
        smallest_r=plant.r,
        **letters,
    )


def condition(function: conditions.Condition, fleet: SymbolicFleet) -> Inequality:
    """A condition of `models/conditions.py` in symbols."""
    return function(NUMBERS, data_of(fleet), fleet.gains)


def torque_limit(fleet: SymbolicFleet) -> Expr:
    """T of (16*) for vehicle i, as `models/conditions.py` computes it."""
    return conditions.torque_bound(NUMBERS, data_of(fleet), fleet.gains)[0]


# -- L16 --------------------------------------------------------------------------------------------------------------


@cache
def l16() -> Claim:
    """|tau| < T of (16*) for both wheels and both drives, and states come as near to T as one likes."""
    facts = [
        fact
        for fleet in (generic(), generic_physical())
        for wheel in (0, 1)
        for fact in (torque_below(fleet, wheel), torque_reached(fleet, wheel))
    ]
    return Claim("L16", Kind.LEMMA, tuple(facts))


def _pull(fleet: SymbolicFleet, wheel: int, psi: Expr) -> tuple[Expr, Expr]:
    """(p_v, kappa): the pull in a torque is -p_v q + kappa b, kappa = +-k psi/arm."""
    i = fleet[0]
    return i.p_v, (1, -1)[wheel] * i.k * psi / fleet.plant.arm[0]


def torque_below(fleet: SymbolicFleet, wheel: int) -> Fact:
    """|tau| < T: Cauchy-Schwarz for the two pulls together, |tanh| < 1 for the rest."""
    i, name = fleet[0], fleet.column(("tau_l", "tau_r")[wheel])[0]
    p, kappa = _pull(fleet, wheel, i.psi)
    u = (-p * i.cos - kappa * i.sin, -p * i.sin + kappa * i.cos)
    size, most = (ROOT2 * i.D * sp.sqrt(p**2 + _pull(fleet, wheel, psi)[1] ** 2) for psi in (i.psi, i.psi_bar))
    pull = cauchy_schwarz(u, (i.e_x, i.e_y), (l1().about(sp.Abs(i.e_x)), l1().about(sp.Abs(i.e_y))), size)
    pull = chained(pull, by_squares(size, most, (psi_limit(i.psi, i.psi_bar),)))
    letter = parameter("pull")
    rest = fleet.fold(fleet.definitions[name]) - i.r / 2 * (kappa * i.b - p * i.q)
    limits = (l1().about(sp.Abs(i.e_theta)), tanh_below_1(i.v / i.s), tanh_below_1(i.w / i.o))
    return renamed(
        majorized(normal_form(rest) + i.r / 2 * letter, limits, torque_limit(fleet), {letter: pull}), name, fleet
    )


def torque_reached(fleet: SymbolicFleet, wheel: int) -> Fact:
    """The torque tends to T as vehicle i moves off, heading along p_v phi -/+ kappa phi_perp parallel to (1, 1).

    All differences of vehicle i can tend to -infinity together; its angle does so (or to +infinity, with omega) in
    whole turns, so that its cosine and sine are free.
    """
    i, name = fleet[0], fleet.column(("tau_l", "tau_r")[wheel])[0]
    p, kappa = _pull(fleet, wheel, i.psi_bar)
    size, turn = ROOT2 * sp.sqrt(p**2 + kappa**2), sp.sign(kappa)
    corner = {i.e_x: -i.D, i.e_y: -i.D, i.e_theta: -turn * i.D, sp.tanh(i.v / i.s): -1, sp.tanh(i.w / i.o): -turn}
    corner |= {i.cos: (p - kappa) / size, i.sin: (p + kappa) / size, i.psi: i.psi_bar}
    torque = fleet.fold(fleet.definitions[name]).xreplace({i.q: i.along(i.e_x, i.e_y), i.b: i.across(i.e_x, i.e_y)})
    return saturated(torque, corner, torque_limit(fleet))


@cache
def l16_sufficient() -> Claim:
    """(16) implies (16*), because sqrt(p^2 + kappa^2) <= p + kappa."""
    fleet = generic()
    i, sixteen = fleet[0], condition(conditions.condition_16, fleet)
    p, kappa = _pull(fleet, 0, i.psi_bar)
    scale = i.r / (2 * fleet.plant.arm[0])
    sides = by_squares(ROOT2 * i.D * sp.sqrt(p**2 + kappa**2), ROOT2 * i.D * (p + kappa))
    below = by_gap(torque_limit(fleet), scale * sixteen.small[0], i.r / 2, sides)
    given = assumed(Relation(sixteen.small[0], "<", sixteen.large[0]))
    return Claim("L16b", Kind.LEMMA, (chained(below, scaled(given, scale)),))


# -- L18 --------------------------------------------------------------------------------------------------------------


@cache
def l18() -> Claim:
    """Where damping outweighs all else, |omega| and |v| fall."""
    fleet = generic()
    i = fleet[0]
    turning = (l1().about(sp.Abs(i.e_theta)), l1().about(sp.Abs(i.b)), psi_limit(i.psi, i.psi_bar))
    rows = (
        (i.I * i.w_dot, i.d_w, sp.tanh(i.w / i.o), turning, conditions.turning_bound),
        (i.m * i.v_dot, i.d_v, sp.tanh(i.v / i.s), (l1().about(sp.Abs(i.q)),), conditions.pulling_bound),
    )
    facts: list[Fact] = []
    for force, damping, level, limits, bound in rows:
        most = bound(NUMBERS, data_of(fleet), fleet.gains)[0]
        rest = fleet.fold(fleet.unfold(force)) + damping * level
        facts.append(renamed(majorized(normal_form(rest), limits, most), force + damping * level, fleet))
        facts.append(ordered(most - damping * level, "<=", 0, (Relation(level, ">=", most / damping),)))
    return Claim("L18", Kind.LEMMA, tuple(facts))


# -- models/conditions.py ---------------------------------------------------------------------------------------------


@cache
def conditions_as_proved() -> Claim:
    """Every condition of `models/conditions.py` says what the lemmas prove of it: large - small, written out."""
    fleet = generic()
    i, setting, data = fleet[0], fleet.setting, data_of(fleet)
    c, arm = constants.excitation_bound(setting)[0], fleet.plant.arm[0]
    turning, pulling = i.p_w * i.D + c, ROOT2 * i.p_v * i.D
    force, moment, kappa = i.d_v + pulling, i.d_w + turning, i.k * i.psi_bar / arm
    star = i.r / 2 * (i.d_v + ROOT2 * i.D * sp.sqrt(i.p_v**2 + kappa**2) + (i.d_w + i.p_w * i.D) / arm)
    rim = i.s * sp.atanh(pulling / i.d_v) + arm * i.o * sp.atanh(turning / i.d_w)
    limit = {name: getattr(data, name)[0] for name in LIMITS}
    rows: tuple[tuple[conditions.Condition, Expr], ...] = (
        (conditions.condition_15, i.d_w * sp.tanh(1) - c),
        (conditions.condition_15_prime, i.d_w - turning),
        (conditions.condition_16, 2 * arm * limit["torque"] / i.r - (arm * force + moment)),
        (conditions.condition_16_star, limit["torque"] - star),
        (conditions.speed_condition, i.d_v * sp.tanh(limit["speed"] / i.s) - pulling),
        (conditions.turn_rate_condition, i.d_w * sp.tanh(limit["turn_rate"] / i.o) - turning),
        (conditions.wheel_speed_condition, i.r * limit["wheel_speed"] - rim),
        (conditions.acceleration_condition, i.m * (limit["acceleration"] - constants.acceleration_bound(setting)[0])),
        (
            conditions.turn_acceleration_condition,
            i.I * (limit["turn_acceleration"] - constants.turn_acceleration_bound(setting)[0]),
        ),
    )
    return Claim("conditions", Kind.LEMMA, tuple(identity(condition(f, fleet).margin[0], stated) for f, stated in rows))
