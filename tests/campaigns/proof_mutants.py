"""False variants that the checker must refuse, and true forms that it must accept, through the very same checks.

`named()` are the mutants of docs/theory.md 8; `generated()` makes more from every identity: one sign flipped, one
factor dropped, one index swapped, perp for non-perp, one derivative of psi too few or too many. A mutant whose
difference from the original is 0 in normal form is equivalent and is listed as such.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
import sympy as sp
from flint import arb
from gaincert.models.arrays import column
from gaincert.models.excitation import Excitation
from gaincert.models.graph import Graph
from gaincert.verify.proof.ball import ball, text
from gaincert.verify.proof.claim import Status
from gaincert.verify.proof.energies import (
    Form,
    derivative,
    edge_identity,
    energy_rate,
    modified,
    modified_rate,
    projections,
    rotational,
    rotational_rate,
    translational,
    translational_rate,
    vehicles,
)
from gaincert.verify.proof.fleet_facts import assumption_1, assumption_3
from gaincert.verify.proof.generic_fleet import Scene, generic, parameter, symbol
from gaincert.verify.proof.names import Names, first
from gaincert.verify.proof.normal_form import Expr, normal_form
from gaincert.verify.proof.printed_bounds import TANH_1, bound_cases, bound_gap
from gaincert.verify.proof.printed_model import inner_loop
from gaincert.verify.proof.printed_numbers import psi_at_phase
from gaincert.verify.proof.printed_proof import identities, jerk_corrected
from gaincert.verify.proof.printed_saturation import printed_ubar_omega
from gaincert.verify.proof.saturation import damping_letters, dominates, pull_bound, pulls, turning_supremum
from gaincert.verify.proof.steps import Check, Identity, NonNegative, Step

PER_IDENTITY = 12  # generated mutants kept of each identity, spread evenly over those that are made


@dataclass(frozen=True)
class Mutant:
    """A variant, and the check that judges it."""

    name: str
    step: Step
    equivalent: bool = False

    def refused(self) -> bool:
        """Whether the check finds it false; undecided is not refused."""
        return self.step.decide().holds is False


def named() -> list[Mutant]:
    """The mutants that docs/theory.md 8 lists."""
    return [
        Mutant(step.text, step)
        for step in (*_rate_mutants(), *_energy_mutants(), *_bound_mutants(), *_condition_mutants())
    ]


def truths() -> list[Step]:
    """True forms of the same statements: refusing one of these would make the kill rate worthless."""
    n, d, u, c = first(), *damping_letters()
    p, kappa, D = pulls()
    found = identities()
    return [
        replace(found["eq-21"], stated=jerk_corrected(n), text="(21) corrected"),
        replace(found["eq-23"], stated=n.w * n.b, text="(23) corrected"),
        energy_rate("V'"),
        energy_rate("W'"),
        energy_rate("What'"),
        edge_identity(),
        Identity("ubar_omega of Proposition 1", turning_supremum(), turning_supremum()),
        pull_bound(sp.sqrt(2) * D * sp.sqrt(p**2 + kappa**2), text="(16*)"),
        dominates(({d: u + c + parameter("s")},), "(15')"),
        NonNegative("inequality after (20) with |omega|", bound_gap(symbol("size")), bound_cases()),
    ]


def _rate_mutants() -> list[Step]:
    n, found = first(), identities()
    true = jerk_corrected(n)
    non_perp = true + n.p_v * n.w * (n.b - n.q) / n.m
    return [
        replace(found["eq-21"], text="(21) with phi for phi_perp", stated=non_perp),
        replace(found["eq-21"], text="(21) with its last sign plus", stated=true + 2 * n.p_v * n.q_of_rate / n.m),
        replace(found["eq-23"], text="(23) with phi for phi_perp", stated=n.w * n.q),
        edge_identity(parameter("a", 12), parameter("a", 21)),
    ]


def _correction(n: Names, along: int = 1, inertial: int = 1) -> Expr:
    return n.k / n.p_w * (along * n.psi * n.q + inertial * n.m / n.p_v * n.psi_dot * n.v)


def _modified(along: int, inertial: int) -> Form:
    return lambda scene: rotational(scene) - scene.unfold(sum(_correction(n, along, inertial) for n in vehicles(scene)))


def _edge_part(potential: Expr, weight: Expr) -> Expr:
    return potential - potential.subs(weight, 0)


def _energy_mutants() -> list[Step]:
    g = generic()
    weight = g.graph.weight[0]

    def unmixed(scene: Scene) -> Expr:
        return sum(n.m * n.v**2 / 2 for n in vehicles(scene)) + _potential(scene)

    def unmixed_rate(scene: Scene) -> Expr:
        return -sum(n.d_v * n.v * sp.tanh(n.v) for n in vehicles(scene))

    late = {n.psi_ddot: n.psi_dot for n in vehicles(g)}
    return [
        derivative("What with the sign of psi q flipped", _modified(-1, 1), modified_rate, g),
        derivative("What without psi' v", _modified(1, 0), modified_rate, g),
        derivative("L5 with psi' for psi''", modified, lambda s: modified_rate(s).xreplace(late), g),
        derivative(
            "V without the 1/2 on edges counted twice",
            lambda s: translational(s) + _edge_part(translational(s), weight),
            translational_rate,
            g,
        ),
        derivative(
            "W without the 1/2 on edges counted twice",
            lambda s: rotational(s) + _edge_part(rotational(s), weight),
            rotational_rate,
            g,
        ),
        derivative("V without 1/p_v in a mixed fleet", unmixed, unmixed_rate, g),
    ]


def _potential(scene: Scene) -> Expr:
    return translational(scene) - sum(n.m / n.p_v * n.v**2 / 2 for n in vehicles(scene))


def _bound_mutants() -> list[Step]:
    p, kappa, D = pulls()
    largest, s = symbol("M"), symbol("s", nonnegative=True)
    ordered = ({largest: p + s, kappa: p + s}, {largest: kappa + s, p: kappa + s})
    return [
        Identity("the saturation paragraph's ubar_omega", printed_ubar_omega(), turning_supremum()),
        pull_bound(sp.sqrt(2) * D * largest, ordered, "(16*) with max for the root"),
        pull_bound(D * sp.sqrt(p**2 + kappa**2), text="(16*) without sqrt2"),
        NonNegative("inequality after (20) without |omega|", bound_gap(symbol("omega")), bound_cases()),
        peak_bound("psibar = 2.43", Fraction(243, 100), 4 / arb.pi()),
        peak_bound("psi as printed with psibar = 2.4324", Fraction(24324, 10000), 4 * arb.pi()),
    ]


def peak_bound(name: str, bound: Fraction, coefficient: arb) -> Check:
    """Whether a number bounds psi at t = pi/5."""

    def compute() -> tuple[bool, str]:
        value = psi_at_phase(coefficient)(arb.pi() / 10)  # type: ignore[operator]
        return bool(value <= ball(bound)), f"psi(pi/5) = {text(value, 9)}, the bound is {float(bound):g}"

    return Check(name, compute, "ball arithmetic")


def _condition_mutants() -> list[Step]:
    d, u, c = damping_letters()
    r, s = symbol("r", nonnegative=True), parameter("s")
    either = ({c: u + r, d: u + r + s}, {u: c + r, d: c + r + s})
    constant = Excitation(Fraction(1), Fraction(1), (Fraction(0),))
    return [
        dominates(({d: (c + s) / TANH_1},), "omega bounded from (15) alone"),
        dominates(either, "(15') weakened to d > max(p D, c)"),
        _claim("PE of psi for PE of psi': psi = 1", lambda: assumption_3(constant).status),
        _claim("a component without leader", lambda: assumption_1(_split_graph()).status),
        _claim("(6) on a physical drive", lambda: next(c for c in inner_loop() if c.id == "eq-6-physical").status),
    ]


def _claim(name: str, status: Callable[[], Status]) -> Check:
    return Check(name, lambda: ((found := status()) is Status.PROVED, found.name), "the claim's own check")


def _split_graph() -> Graph:
    """Vehicles 1-2 led, 3-4 on their own."""
    ones = column([Fraction(1), Fraction(1)])
    return Graph(np.array([0, 2]), np.array([1, 3]), ones, column([Fraction(1), *[Fraction(0)] * 3]))


def generated() -> list[Mutant]:
    """Mutants of the right side of every true identity, and of the energies themselves."""
    g, found = generic(), identities()
    n = first()
    q_rate, b_rate = projections()
    true = {
        "eq-17": found["eq-17"], "eq-19": found["eq-19"], "remark-1": found["remark-1"], "eq-24": found["eq-24"],
        "eq-25": found["eq-25"], "eq-18": energy_rate("V'"), "eq-20": energy_rate("W'"), "L5": energy_rate("What'"),
        "eq-21": replace(found["eq-21"], stated=jerk_corrected(n)), "q'": q_rate, "b'": b_rate,
    }  # fmt: skip
    made = [m for name, identity in true.items() for m in _of_identity(name, identity)]
    forms: tuple[tuple[str, Form, Form], ...] = (
        ("V", translational, translational_rate),
        ("W", rotational, rotational_rate),
        ("What", modified, modified_rate),
    )
    return made + [m for name, form, rate in forms for m in _of_energy(name, form(g), rate)]


def _of_identity(name: str, identity: Identity) -> list[Mutant]:
    return [
        _mutant(f"{name}: {label}", replace(identity, stated=e), e - identity.stated)
        for label, e in _spread(identity.stated)
    ]


def _of_energy(name: str, energy: Expr, rate: Form) -> list[Mutant]:
    found = []
    for label, expression in _spread(energy):
        step = Identity(f"{name}: {label}", rate(generic()), generic().dt(expression), generic())
        found.append(_mutant(step.text, step, expression - energy))
    return found


def _mutant(name: str, step: Identity, difference: Expr) -> Mutant:
    equivalent = normal_form(generic().unfold(difference)) == 0
    return Mutant(name, replace(step, text=name), equivalent)


def _spread(expression: Expr) -> list[tuple[str, Expr]]:
    every = list({str(e): (label, e) for label, e in mutations(expression) if e != expression}.values())
    step = max(1, -(-len(every) // PER_IDENTITY))
    return every[::step]


def mutations(expression: Expr) -> Iterator[tuple[str, Expr]]:
    """Every single mutation of an expression."""
    for node in sp.preorder_traversal(expression):
        if node.is_Add:
            yield from ((f"sign of {term}", _put(expression, node, node - 2 * term)) for term in node.args)
        if node.is_Mul:
            yield from ((f"without {part}", _put(expression, node, node / part)) for part in node.args if part != -1)
    yield from _renamings(expression)


def _put(expression: Expr, old: Expr, new: Expr) -> Expr:
    return expression.xreplace({old: new})


def _renamings(expression: Expr) -> Iterator[tuple[str, Expr]]:
    names = {s.name: s for s in generic_symbols()}
    for s in sorted(expression.free_symbols, key=lambda s: s.name):
        base, _, index = s.name.rpartition("_")
        other = names.get(f"{base}_{'2' if index == '1' else '1'}")
        if index in ("1", "2") and other is not None:
            yield f"{s.name} for {other.name}", expression.xreplace({s: other})
        later = names.get({"psi": f"psi_dot_{index}", "psi_dot": f"psi_ddot_{index}"}.get(base, ""))
        if later is not None:
            yield f"{later.name} for {s.name}", expression.xreplace({s: later})
    for theta in generic().state.theta:
        if expression.has(sp.cos(theta)):
            yield (
                f"perp at {theta.name}",
                expression.xreplace({sp.cos(theta): -sp.sin(theta), sp.sin(theta): sp.cos(theta)}),
            )


def generic_symbols() -> set[Expr]:
    """Every symbol of the generic scene."""
    g = generic()
    gains = [getattr(g.gains, name) for name in ("p_v", "d_v", "p_omega", "d_omega", "k_alpha")]
    columns = [*g.state, g.plant.m, g.plant.inertia, g.psi, g.psi_dot, *gains, g.plant.offset_x, g.plant.offset_y]
    return {s for part in columns for s in part} | set(g.rates) | set(g.definitions) | set(g.column("psi_ddot"))
