"""(A2), (d) and (f) for the gains of a fleet, and the constants of the lemmas in its numbers."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import sympy as sp
from flint import arb

from ....models import conditions
from ....models.algebra.ops import numpy_ops
from ....models.arrays import Array, floats
from ....models.excitation import Excitation
from ....models.fleet import Fleet
from ....models.gains import GAIN_NAMES, Gains
from ....models.saturation import SCALE_NAMES
from .. import constants
from ..claim import Claim, Fact, Kind, Relation
from ..method.ball import Ball, ball, precise, text
from ..method.fleet_balls import BallFleet
from ..method.inferences import compared
from ..method.rules import restated
from ..method.symbols import symbol
from .excitation import times_power_of_pi, variance
from .graph import EXACT_VEHICLES, least_cut


def assumption_2(fleet: Fleet, gains: Gains) -> Claim:
    """(A2): all gains and scales are positive; parameters are, or the fleet would not have been read."""
    scales = gains.saturation.columns(len(fleet))
    least = {name: min(getattr(gains, name)) for name in GAIN_NAMES} | {name: min(scales[name]) for name in SCALE_NAMES}
    letters = (*GAIN_NAMES, "l", "rho", "s", "o")
    values = {symbol(letter, "min"): Fraction(value) for letter, value in zip(letters, least.values(), strict=True)}
    return Claim("A2", Kind.FLEET, tuple(compared(Relation(letter, ">", 0), values) for letter in values))


# -- (d): torques -----------------------------------------------------------------------------------------------------


def torques(fleet: Fleet, gains: Gains, psi: Excitation, part_d: Claim) -> Claim:
    """(16*) for the vehicle that uses most of its limit; where it fails, a state that breaks the limit."""
    data = fleet.condition_data(psi)
    found = conditions.condition_16_star(conditions.exact_numbers(), data, gains)
    worst = max(range(len(fleet)), key=lambda n: found.small[n] / found.large[n])
    names = symbol("T", str(worst + 1)), symbol("tau_max", str(worst + 1))
    values = dict(zip(names, (found.small[worst], found.large[worst]), strict=True))
    met = compared(Relation(names[0], "<=", names[1]), values, of=fleet.names[worst])
    shown = () if met.holds else _reached(BallFleet(fleet, gains, psi), worst, found.large[worst])
    return Claim("torques", Kind.FLEET, (met, *shown, *map(restated, part_d.facts[-2:])))


def _reached(data: BallFleet, vehicle: int, limit: Fraction) -> tuple[Fact, ...]:
    """The torque of each wheel at a state near its supremum, against the limit."""
    name, index, facts = data.fleet.names[vehicle], str(vehicle + 1), []
    with precise():
        peak = data.psi_at(_peak_time(data.psi))
        for wheel, letter in enumerate(("tau_l", "tau_r")):
            torque, most = symbol(letter, index), symbol("tau_max", index)
            values = {torque: data.torques(peak, data.worst_state(vehicle, wheel, peak))[wheel][vehicle], most: limit}
            facts.append(compared(Relation(sp.Abs(torque), "<=", most), values, {symbol("psi"): text(peak)}, name))
    return tuple(facts)


def _peak_time(psi: Excitation) -> Ball:
    t = np.linspace(0, 2 * np.pi / float(psi.frequency), 20001)
    return ball(Fraction(float(t[np.argmax(np.abs(psi.value(numpy_ops(), t)))])))


# -- (f): limits ------------------------------------------------------------------------------------------------------

CONDITIONS = {
    "speed": conditions.speed_condition,
    "turn_rate": conditions.turn_rate_condition,
    "wheel_speed": conditions.wheel_speed_condition,
    "acceleration": conditions.acceleration_condition,
    "turn_acceleration": conditions.turn_acceleration_condition,
}


def limits(fleet: Fleet, gains: Gains, psi: Excitation, part_f: Claim) -> Claim:
    """How many vehicles certify a speed and a turn rate, and each limit that the fleet file asks for."""
    numbers, data = conditions.exact_numbers(), fleet.condition_data(psi)
    certified = {
        "v": conditions.pulling_bound(numbers, data, gains) < gains.d_v,
        "omega": conditions.turning_bound(numbers, data, gains) < gains.d_omega,
    }
    counts = {symbol("certified", letter): int(np.sum(met)) for letter, met in certified.items()}
    facts = [compared(Relation(count, ">=", 0), counts) for count in counts]
    for name, condition in CONDITIONS.items():
        asked = np.flatnonzero(np.asarray(getattr(data, name) != np.inf, dtype=bool))
        if len(asked):
            met = np.asarray(condition(numbers, data, gains).holds, dtype=bool)[asked]
            counts = {symbol("met"): int(np.sum(met)), symbol("asked"): len(asked)}
            facts.append(
                compared(Relation(symbol("met"), "=", symbol("asked")), counts, of=f"{name.replace('_', ' ')} limit")
            )
    return Claim("speed-limits", Kind.FLEET, (*facts, *map(restated, part_f.facts[-2:])))


# -- the constants of the lemmas --------------------------------------------------------------------------------------


def lemma_constants(fleet: Fleet, gains: Gains, psi: Excitation) -> Claim:
    """beta, eps, xi, g, nu and, where kappa_cut is exact, what a window of the second kind needs and the fall gamma."""
    setting, period = _setting(fleet, gains, psi), 2 * np.pi / float(psi.frequency)
    with precise():
        nu = float(times_power_of_pi(variance(psi)))
    beta = constants.across_bound(setting, period, nu)
    found = {
        "g": constants.speed_weight(setting),
        "beta": beta,
        "epsilon": constants.heading_bound(setting, period, beta),
        "xi": constants.along_bound(setting, period),
        "C0": np.sum(constants.energy_offset(setting)),
    }
    rows = {name: np.max(value) for name, value in found.items()}
    if len(fleet) <= EXACT_VEHICLES:
        rows |= _dichotomy(fleet, setting, period, rows)
    values = {symbol(name): arb(float(value)) for name, value in rows.items()}
    return Claim("constants", Kind.FLEET, tuple(compared(Relation(letter, ">", 0), values) for letter in values))


def _setting(fleet: Fleet, gains: Gains, psi: Excitation) -> constants.Setting:
    bounds = (np.full(len(fleet), float(bound)) for bound in (psi.bound, *psi.derivative_bounds))
    return constants.Setting(numpy_ops(), np.sqrt(2), fleet.plant(), gains.map(floats), *bounds)


def _dichotomy(fleet: Fleet, c: constants.Setting, period: float, rows: dict[str, float]) -> dict[str, float]:
    """eta with sqrt2 times the largest error at kappa_cut/(2N), and gamma(eta), by which Y_e falls otherwise: L13."""
    level = float(least_cut(fleet.graph)[0] / (2 * len(fleet)))
    eta = level / (np.sqrt(2) * max(1.0, rows["beta"], rows["epsilon"], rows["xi"]))
    scale = c.gains.saturation
    falls = [
        c.gains.d_v / c.gains.p_v * _spike(c, eta, constants.acceleration_bound(c), period, scale.speed),
        c.gains.d_omega
        / c.gains.p_omega
        * _spike(c, eta, constants.turn_acceleration_bound(c), period, scale.turn_rate),
    ]
    return {"eta": eta, "gamma": min(np.min(fall) for fall in falls)}


def _spike(c: constants.Setting, eta: float, rate: Array, period: float, scale: Array) -> Array:
    return constants.spike_energy(c, eta, np.minimum(period, constants.spike_length(eta, rate)), scale)
