"""What the theorem needs and yields for one fleet: (A1)-(A3), kappa_cut, psi's numbers, torques and speed limits."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
from flint import arb

from ...models import conditions
from ...models.excitation import Excitation
from ...models.fleet import Fleet
from ...models.gains import GAIN_NAMES, Gains
from ...models.graph import Graph
from .ball import ball, evaluate, text
from .claim import Claim
from .excitation_facts import rate_power, times_power_of_pi, variance
from .steps import Check, Step
from .verdicts import lemma
from .windows import nu_bound
from .witness import Instance

EXACT_CUT_VEHICLES = 64  # beyond this kappa_cut is enclosed, not computed: Stoer-Wagner is cubic


def claims(fleet: Fleet, gains: Gains | None) -> list[Claim]:
    """(A1), (A2), (A3) as far as they can be judged, and what follows for this fleet."""
    found = [assumption_1(fleet.graph), kappa(fleet.graph)]
    psi = fleet.psi
    found += [assumption_2(fleet, gains)] if gains else []
    found += [assumption_3(psi), window_number(psi)] if psi else []
    found += [torques(fleet, gains, psi), speed_limits(fleet, gains, psi)] if gains and psi else []
    given = {claim.id for claim in found}
    needs = ("theorem", *(id_ for id_ in ("A1", "A2", "A3") if id_ in given))
    missing = [what for what, value in (("gains", gains), ("excitation", psi)) if value is None]
    reserve = f"; not given, so assumed to meet (A2), (A3): {' and '.join(missing)}" if missing else ""
    return [
        *found,
        _fact(
            "fleet", f"the corrected theorem applies to fleet {fleet.name!r} (N = {len(fleet)}){reserve}", needs=needs
        ),
    ]


def _fact(id_: str, statement: str, *steps: Step, needs: tuple[str, ...] = ()) -> Claim:
    claim = lemma(id_, statement, *steps, needs=needs, source="this fleet", group="fleet")
    details = [finding.detail for finding in (step.decide() for step in steps) if finding.detail]
    return replace(claim, reason="; ".join(details or [claim.reason or "by the claims beneath"]))


def assumption_1(graph: Graph) -> Claim:
    """(A1): every component has a leader link."""

    def compute() -> tuple[bool, str]:
        cut_off = np.flatnonzero(graph.leader_tree() < 0)
        positive = all(w > 0 for w in graph.weight) and all(w >= 0 for w in graph.leader_weight)
        detail = f"{len(cut_off)} of {graph.vehicles} vehicles without a path to the leader"
        return not len(cut_off) and positive, detail

    return _fact(
        "A1",
        "(A1) weights are positive and every component hears the leader",
        Check("a spanning tree from the leader", compute, "breadth-first tree, O(N + E)"),
    )


def kappa(graph: Graph) -> Claim:
    """kappa_cut, exact for small fleets, enclosed for large ones."""
    small = graph.vehicles <= EXACT_CUT_VEHICLES
    method = (
        "Stoer-Wagner in exact rationals, confirmed by a checked flow to every vehicle"
        if small
        else "maximum spanning tree and least degree, exact"
    )
    step = Check("kappa_cut > 0", lambda: (_exact_kappa if small else _enclosed_kappa)(graph), method)
    return _fact("kappa-cut", "kappa_cut = min over vehicle sets S of a_l(S) + cut(S) is positive", step)


def _exact_kappa(graph: Graph) -> tuple[bool, str]:
    from .mincut import global_minimum_cut, supports_flow, with_leader

    weights = with_leader(graph)
    value = global_minimum_cut(weights)
    confirmed = all(supports_flow(weights, i, value) for i in range(graph.vehicles))
    return value > 0 and confirmed, f"kappa_cut = {value}"


def _enclosed_kappa(graph: Graph) -> tuple[bool, str]:
    from .mincut import tree_bound

    low, high = tree_bound(graph), min(graph.degree)
    return low > 0, f"{low} <= kappa_cut <= {high}"


def assumption_2(fleet: Fleet, gains: Gains) -> Claim:
    """(A2): positive parameters and gains."""

    def compute() -> tuple[bool, str]:
        bad = [
            f"{name} of {fleet.names[i]}"
            for name in GAIN_NAMES
            for i, g in enumerate(getattr(gains, name))
            if not g > 0
        ]
        return not bad, f"not positive: {', '.join(bad[:5])}" if bad else "all five gains of every vehicle are positive"

    return _fact("A2", "(A2) parameters and gains are positive", Check("positive", compute, "comparison"))


def assumption_3(psi: Excitation) -> Claim:
    """(A3): bounds of psi and its derivatives, and (12)."""

    def bounds() -> tuple[bool, str]:
        psi1, psi2 = psi.derivative_bounds
        return True, f"psi0 = {float(psi.bound):.9g}, psi1 = {float(psi1):.9g}, psi2 = {float(psi2):.9g}"

    def power() -> tuple[bool, str]:
        found = rate_power(psi, 1 / psi.frequency)
        mu = times_power_of_pi(found) if found else arb(0)
        return bool(mu > 0), f"(12) with T = 2 pi/{psi.frequency}, mu = {text(mu)}"

    return _fact(
        "A3",
        "(A3) psi is bounded with two derivatives and psi' is persistently exciting",
        Check("bounds of |psi|, |psi'|, |psi''|", bounds, "branch and bound in ball arithmetic"),
        Check("the integral of psi'^2 over every period is mu > 0", power, "orthogonality in exact rationals"),
    )


def window_number(psi: Excitation) -> Claim:
    """nu of L10, exact over one period."""

    def compute() -> tuple[bool, str]:
        exact = times_power_of_pi(variance(psi))
        least = nu_bound(
            times_power_of_pi(psi.power()), 2 * arb.pi() / ball(psi.frequency), ball(psi.derivative_bounds[1])
        )
        return bool(exact >= least), f"nu = {text(exact)} (lemma L10 alone gives {text(least)})"

    return _fact(
        "nu",
        "nu, the least variance of psi over a period, is positive",
        Check("nu", compute, "orthogonality in exact rationals"),
        needs=("L10",),
    )


def torques(fleet: Fleet, gains: Gains, psi: Excitation) -> Claim:
    """(d) for these gains: T_i against the limits; a state that breaks one where (16*) fails."""

    def compute() -> tuple[bool, str]:
        found = conditions.condition_16_star(conditions.exact_numbers(), fleet.condition_data(psi), gains)
        broken = np.flatnonzero(~np.asarray(found.holds, dtype=bool))
        if not len(broken):
            most = max(float(a / b) for a, b in zip(found.small, found.large, strict=True))
            return True, f"T_i <= limit for every vehicle; largest use {100 * most:.2f} %"
        return _torque_witness(Instance(fleet, gains, psi), int(broken[0]), found)

    return _fact(
        "torques",
        "(16*): no torque limit is ever met, from any state",
        Check("T_i <= min(taubar_l, taubar_r)", compute, "exact rationals, roots rounded up"),
        needs=("thm-d",),
    )


def _torque_witness(data: Instance, i: int, found: conditions.Inequality) -> tuple[bool, str]:
    peak = data.psi_at(_peak_time(data.psi))
    for wheel, side in ((0, "left"), (1, "right")):
        reached = data.torques(peak, data.worst_state(i, wheel, peak))[wheel][i]
        if abs(reached) > ball(found.large[i]):
            return (
                False,
                f"vehicle {data.fleet.names[i]!r} can reach {text(abs(reached))} N m on the {side} wheel; limit "
                f"{float(found.large[i]):g}",
            )
    return (
        False,
        f"vehicle {data.fleet.names[i]!r}: T = {float(found.small[i]):.9g} exceeds the limit "
        f"{float(found.large[i]):g} by less than a state could show",
    )


def _peak_time(psi: Excitation) -> arb:
    t = np.linspace(0, 2 * np.pi / float(psi.frequency), 20001)
    from ...models.algebra.ops import numpy_ops

    return ball(Fraction(float(t[np.argmax(np.abs(psi.value(numpy_ops(), t)))])))


def speed_limits(fleet: Fleet, gains: Gains, psi: Excitation) -> Claim:
    """(f) for these gains: which vehicles have a certified turn rate and speed, and the requested limits."""

    def compute() -> tuple[bool, str]:
        numbers, room = conditions.exact_numbers(), fleet.condition_data(psi)
        turning = conditions.turning_bound(numbers, room, gains) / gains.d_omega
        pulling = conditions.pulling_bound(numbers, room, gains) / gains.d_v
        asked = all(conditions.turn_rate_condition(numbers, room, gains).holds[room.turn_rate != np.inf]) and all(
            conditions.speed_condition(numbers, room, gains).holds[room.speed != np.inf]
        )
        return bool(asked), f"turn rate: {_levels(turning, 'rad/s')}; speed: {_levels(pulling, 'm/s')}"

    return _fact(
        "speed-limits",
        "(f): the speed and turn-rate limits that the fleet file asks for are certified",
        Check("(15') and its twin", compute, "exact rationals"),
        needs=("thm-f",),
    )


def _levels(ratio: np.ndarray, unit: str) -> str:
    import sympy as sp

    certified = [r for r in ratio if r < 1]
    if not certified:
        return "no vehicle has a certified limit"
    worst = max(certified)
    level = evaluate(sp.atanh(sp.Rational(worst.numerator, worst.denominator)))
    return f"{len(certified)} of {len(ratio)} certified, largest limit {text(level)} {unit}"
