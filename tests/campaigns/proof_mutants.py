"""False variants that the proof check must refuse, and true forms that it must accept, through the very same rules.

`named()` are the mutants of docs/theory.md; `generated()` makes more from every identity: one sign flipped, one factor
dropped, one index swapped, perp for non-perp, one derivative of psi too few or too many. A mutant whose difference from
the original is 0 in normal form is equivalent and is listed as such.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import sympy as sp
from flint import arb
from gaincert.models.arrays import column
from gaincert.models.excitation import Excitation
from gaincert.models.graph import Graph
from gaincert.verify.proof.claim import Expr, Fact, Relation
from gaincert.verify.proof.lemmas.energies import edge_identity, excitation_left, l2, l3, l4, l5
from gaincert.verify.proof.lemmas.torques import l16_sufficient
from gaincert.verify.proof.method.ball import precise
from gaincert.verify.proof.method.fleet_symbols import SymbolicFleet, generic, generic_unit
from gaincert.verify.proof.method.inferences import compared
from gaincert.verify.proof.method.normal_form import equal
from gaincert.verify.proof.method.rules import by_squares, identity, ordered
from gaincert.verify.proof.method.symbols import W_HAT, V, W, parameter
from gaincert.verify.proof.printed import boundedness, convergence, energies, model, saturation, section_4
from gaincert.verify.proof.this_fleet.excitation import assumption_3
from gaincert.verify.proof.this_fleet.graph import assumption_1

PER_IDENTITY = 12  # generated mutants kept of each identity, spread evenly over those that are made
U, SCALED = generic_unit(), generic()
N = U[0]


@dataclass(frozen=True)
class Mutant:
    """A variant, and what judges it."""

    name: str
    judge: Callable[[], Fact]
    equivalent: bool = False

    def refused(self) -> bool:
        """Whether it is found false; undecided is not refused."""
        return self.judge().holds is False


def named() -> list[Mutant]:
    """The mutants that docs/theory.md lists."""
    rows = {**_rates(), **_energies(), **_bounds(), **_conditions()}
    return [Mutant(name, judge) for name, judge in rows.items()]


def truths() -> list[Mutant]:
    """True forms of the same statements: refusing one of these would make the kill rate worthless."""
    rows = {
        "(21) corrected": lambda: identity(convergence.jerk(N.b, -1), convergence.second_rate(N.v_dot), U),
        "(23) corrected": lambda: convergence.eq_23(l3().facts[0]).truth[0],
        "V'": lambda: l3().facts[0],
        "W'": lambda: l4().facts[0],
        "What'": lambda: l5().facts[1],
        "edges": lambda: l2().facts[0],
        "ubar_omega of Proposition 1": lambda: saturation.ubar_omega_of_proposition().facts[0],
        "(16) implies (16*)": lambda: l16_sufficient().facts[0],
        "(15')": lambda: ordered(_u() + _c(), "<=", _d(), (Relation(_d(), ">=", _u() + _c()),)),
        "inequality after (20) with |omega|": lambda: boundedness.after_20(sp.Abs(boundedness.OMEGA)).facts[0],
    }
    return [Mutant(name, judge) for name, judge in rows.items()]


Rows = dict[str, Callable[[], Fact]]


def _rates() -> Rows:
    second = convergence.second_rate(N.v_dot)
    return {
        "(21) with phi for phi_perp": lambda: identity(convergence.jerk(N.q, -1), second, U),
        "(21) with its last sign plus": lambda: identity(convergence.jerk(N.b, 1), second, U),
        "(23) with phi for phi_perp": lambda: convergence.eq_23(l3().facts[0]).facts[0],
        "a_ij for a_ji": lambda: edge_identity(parameter("a", "ij"), parameter("a", "ji")),
    }


def _modified(along: int, inertial: int) -> Expr:
    """W-hat with other signs of its two corrections."""
    pairs = ((n.k / n.p_w, n.psi * n.q, n.m / n.p_v * n.psi_dot * n.v) for n in SCALED.vehicles)
    return SCALED.rotational - sum(gain * (along * pull + inertial * drive) for gain, pull, drive in pairs)


def _falls_as(energy: Expr, rate: Expr, fleet: SymbolicFleet = SCALED) -> Fact:
    return identity(rate, fleet.dt(energy), fleet)


def _energies() -> Rows:
    stated = excitation_left(SCALED) - SCALED.rotational_dissipation
    late = {n.psi_ddot: n.psi_dot for n in SCALED.vehicles}
    weight = SCALED.graph.weight[0]
    v, w = SCALED.translational, SCALED.rotational
    fall, turn = -SCALED.translational_dissipation, l4().facts[0].right
    kinetic = sum(n.m / n.p_v * n.v**2 / 2 for n in SCALED.vehicles)
    unmixed = v - kinetic + sum(n.m * n.v**2 / 2 for n in SCALED.vehicles)
    falls_unmixed = -sum(n.d_v * n.v * sp.tanh(n.v / n.s) for n in SCALED.vehicles)
    return {
        "What with the sign of psi q flipped": lambda: _falls_as(_modified(-1, 1), stated),
        "What without psi' v": lambda: _falls_as(_modified(1, 0), stated),
        "L5 with psi' for psi''": lambda: _falls_as(_modified(1, 1), stated.xreplace(late)),
        "V without the 1/2 on edges counted twice": lambda: _falls_as(2 * v - v.subs(weight, 0), fall),
        "W without the 1/2 on edges counted twice": lambda: _falls_as(2 * w - w.subs(weight, 0), turn),
        "V without 1/p_v in a mixed fleet": lambda: _falls_as(unmixed, falls_unmixed),
        "V with the scale left out of log cosh": lambda: _falls_as(v.subs(SCALED.length, 1), fall),
    }


def _d() -> Expr:
    return parameter("d")


def _u() -> Expr:
    return parameter("u")


def _c() -> Expr:
    return parameter("c")


def _bounds() -> Rows:
    p, kappa, degree = parameter("p"), parameter("k"), parameter("D")
    root = sp.sqrt(p**2 + kappa**2)
    most = sp.sqrt(2) * degree * root
    return {
        "the saturation paragraph's ubar_omega": lambda: saturation.ubar_omega().facts[-1],
        "(16*) with max for the root": lambda: ordered(
            sp.expand(most**2), "<=", 2 * degree**2 * p**2, (Relation(p, ">=", kappa),)
        ),
        "(16*) without sqrt2": lambda: by_squares(most, degree * root),
        "inequality after (20) without |omega|": lambda: boundedness.after_20().facts[0],
        "psibar = 2.43": lambda: _peak_within(Fraction(243, 100), 1 / arb.pi()),
        "psi as printed with psibar = 2.4324": lambda: _peak_within(Fraction(24324, 10000), arb.pi()),
    }


def _peak_within(bound: Fraction, power_of_pi: arb) -> Fact:
    """Whether a number bounds psi at t = pi/5."""
    with precise():
        value = section_4.psi_at(4 * power_of_pi, arb.pi() / 10)
        psi, limit = parameter("psi"), parameter("psi_bar")
        return compared(Relation(psi, "<=", limit), {psi: value, limit: bound})


def _conditions() -> Rows:
    d, u, c = _d(), _u(), _c()
    constant = Excitation(Fraction(1), Fraction(1), (Fraction(0),))
    weaker = (Relation(d, ">=", c), Relation(c, ">=", u))
    return {
        "omega bounded from (15) alone": lambda: ordered(u + c, "<=", d, (Relation(d, ">=", c / sp.tanh(1)),)),
        "(15') weakened to d > max(p D, c)": lambda: ordered(u + c, "<=", d, weaker),
        "PE of psi for PE of psi': psi = 1": lambda: assumption_3(constant).facts[0],
        "a component without leader": lambda: assumption_1(_split_graph()).facts[0],
        "(6) on a physical drive": lambda: model.inner_loop()[1].facts[0],
    }


def _split_graph() -> Graph:
    """Vehicles 1-2 led, 3-4 on their own."""
    ones = column([Fraction(1), Fraction(1)])
    return Graph(np.array([0, 2]), np.array([1, 3]), ones, column([Fraction(1), *[Fraction(0)] * 3]))


# -- generated mutants ------------------------------------------------------------------------------------------------


def generated() -> list[Mutant]:
    """Mutants of the right side of every true identity, and of the energies themselves."""
    unit = {
        "eq-17": energies.eq_17, "eq-18": energies.eq_18, "eq-19": energies.eq_19, "eq-20": energies.eq_20,
        "remark-1": energies.remark_1,
    }  # fmt: skip
    true = {name: build().facts[0] for name, build in unit.items()}
    true |= {"eq-24": _turned(convergence.eq_24().facts[0]), "eq-25": _turned(convergence.eq_25().facts[0])}
    true["eq-21"] = _turned(convergence.eq_21().truth[0])
    made = [mutant for name, fact in true.items() for mutant in _of_identity(name, fact, U)]
    scaled = {"V'": l3().facts[0], "W'": l4().facts[0], "q'": l4().facts[1], "b'": l4().facts[2], "L5": l5().facts[1]}
    made += [mutant for name, fact in scaled.items() for mutant in _of_identity(name, fact, SCALED)]
    return made + [mutant for name in (V, W, W_HAT) for mutant in _of_energy(name)]


def _turned(fact: Fact) -> Fact:
    """The identity with the stated side on the right."""
    return identity(fact.right, fact.left, U)


def _of_identity(name: str, fact: Fact, fleet: SymbolicFleet) -> list[Mutant]:
    return [
        Mutant(f"{name}: {label}", _judge(fact.left, e, fleet), _same(e, fact.right, fleet))
        for label, e in _spread(fact.right, fleet)
    ]


def _of_energy(name: Expr) -> list[Mutant]:
    rates = {V: l3().facts[0], W: l4().facts[0], W_HAT: l5().facts[1]}
    energy = SCALED.energies[name]
    return [
        Mutant(f"{name}: {label}", _judge(rates[name].right, SCALED.dt(e), SCALED), _same(e, energy, SCALED))
        for label, e in _spread(energy, SCALED)
    ]


def _judge(left: Expr, right: Expr, fleet: SymbolicFleet) -> Callable[[], Fact]:
    return lambda: identity(left, right, fleet)


def _same(one: Expr, other: Expr, fleet: SymbolicFleet) -> bool:
    return equal(fleet.unfold(one), fleet.unfold(other))


def _spread(expression: Expr, fleet: SymbolicFleet) -> list[tuple[str, Expr]]:
    every = list({str(e): (label, e) for label, e in mutations(expression, fleet) if e != expression}.values())
    step = max(1, -(-len(every) // PER_IDENTITY))
    return every[::step]


def mutations(expression: Expr, fleet: SymbolicFleet = U) -> Iterator[tuple[str, Expr]]:
    """Every single mutation of an expression."""
    for node in sp.preorder_traversal(expression):
        if node.is_Add:
            yield from ((f"sign of {term}", _put(expression, node, node - 2 * term)) for term in node.args)
        if node.is_Mul:
            yield from ((f"without {part}", _put(expression, node, node / part)) for part in node.args if part != -1)
    yield from _renamings(expression, fleet)


def _put(expression: Expr, old: Expr, new: Expr) -> Expr:
    return expression.xreplace({old: new})


def _renamings(expression: Expr, fleet: SymbolicFleet) -> Iterator[tuple[str, Expr]]:
    for i, j in ((fleet[0], fleet[1]), (fleet[1], fleet[0])):
        for base in ("v", "omega", "p_v", "d_v", "p_w", "d_w", "k", "m", "I", "psi", "q", "b", "alpha", "x", "theta"):
            own, other = getattr(i, base), getattr(j, base)
            if expression.has(own):
                yield f"{own} for {other}", expression.xreplace({own: other})
        for early, late in (("psi", "psi_dot"), ("psi_dot", "psi_ddot"), ("q", "b")):
            if expression.has(getattr(i, early)):
                yield f"{late} for {early}", expression.xreplace({getattr(i, early): getattr(i, late)})
        if expression.has(i.cos):
            yield f"perp at {i.theta}", expression.xreplace({i.cos: -i.sin, i.sin: i.cos})
