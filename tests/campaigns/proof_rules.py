"""Every rule of the proof check, with an input from which its conclusion does not follow: none may accept it."""

from __future__ import annotations

from collections.abc import Callable

import sympy as sp
from flint import arb
from gaincert.verify.proof.claim import Claim, Fact, Implication, Kind, Relation
from gaincert.verify.proof.lemmas.energies import within_first_degree
from gaincert.verify.proof.lemmas.functions import S, X, l0, sech2
from gaincert.verify.proof.method import inferences, rules
from gaincert.verify.proof.method.fleet_symbols import generic
from gaincert.verify.proof.method.symbols import nonnegative_symbol, parameter, symbol
from gaincert.verify.proof.method.windows import ETA, PERIOD, Weight, over_window
from gaincert.verify.proof.this_fleet.excitation import computed_twice
from gaincert.verify.proof.this_fleet.graph import carries

A, B, C, T = (parameter(name) for name in ("a", "b", "c", "t"))
Y, N = nonnegative_symbol("y"), sp.Symbol("n", integer=True, positive=True)


def known(left: object, sign: str, right: object) -> Fact:
    """A hypothesis."""
    return rules.assumed(Relation(sp.sympify(left), sign, sp.sympify(right)))


UNKNOWN = rules.ordered(A, "<=", B)  # false: refuted by a point
UP, OVER = known(A, "<=", B), known(B, "<=", C)
SIZE = known(sp.Abs(X), "<=", A)


def unsupported() -> dict[str, Callable[[], Fact]]:
    """By what is wrong with the input."""
    return {**_algebra(), **_inequalities(), **_from_facts(), **_limits(), **_inferences(), **_flows()}


Rows = dict[str, Callable[[], Fact]]


def _algebra() -> Rows:
    return {
        "an identity by a false fact": lambda: rules.identity(A, A, by=(UNKNOWN,)),
        "tanh x <= x/2": lambda: rules.ordered(sp.tanh(Y), "<=", Y / 2, (Relation(sp.tanh(Y), "<=", Y),)),
        "(a + b)^2 <= a^2 + b^2": lambda: rules.ordered((A + B) ** 2, "<=", A**2 + B**2),
        "a letter of unknown sign taken for positive": lambda: rules.ordered(0, "<=", X),
        "a letter of unknown sign taken for negative": lambda: rules.ordered(X, "<=", 0),
        "a bounded letter taken for positive": lambda: rules.ordered(0, "<=", X, (SIZE,)),
        "a bounded letter taken for negative": lambda: rules.ordered(X, "<=", 0, (SIZE,)),
        "a rate quadratic in a leader's weight": lambda: within_first_degree(generic().graph.leader_weight[0] ** 2),
        "a rate quadratic in an edge's weight": lambda: within_first_degree(generic().graph.weight[0] ** 2),
        "a claim without a fact": lambda: Claim("0 = 1", Kind.LEMMA, ()).facts[0],
        "a positive letter times a sine": lambda: rules.ordered(0, "<=", A * sp.sin(Y)),
        "a true inequality, refuted at a negative number": lambda: _negated(rules.ordered(0, "<=", Y**3 - Y**2 + Y)),
        "a product of two letters of unknown sign": lambda: rules.ordered(0, "<=", X * symbol("z")),
        "a hypothesis the wrong way round": lambda: rules.ordered(A, "<=", B, (Relation(A, ">=", B),)),
        "|x| <= a/2 from |x| <= a": lambda: rules.majorized(X, (SIZE,), A / 2),
        "|x| <= 2 a from |x| <= a, which is not exact": lambda: rules.majorized(X, (SIZE,), 2 * A),
        "|x y| from a bound of x alone": lambda: rules.majorized(X * symbol("y"), (SIZE,), A),
        "sech^2 < tanh^2": lambda: rules.less(sech2(X), sp.tanh(X) ** 2, sp.tanh(X) ** 2 - sech2(X)),
        "a gap that may be negative": lambda: rules.less(X, sp.S.Zero, -X),
    }


def _inequalities() -> Rows:
    components = known(sp.Abs(symbol("e")), "<", A), known(sp.Abs(symbol("f")), "<", B)
    u = (symbol("u"), symbol("w"))
    return {
        "roots by squares of what may be negative": lambda: rules.by_squares(X, A, (SIZE,)),
        "roots by squares that are not ordered": lambda: rules.by_squares(A, B),
        "a root of a cube": lambda: rules.root(known(X**3, "<=", A**3)),
        "a root whose bound may be negative": lambda: rules.root(known(X**2, "<=", symbol("z"))),
        "Cauchy-Schwarz with the sum of sizes": lambda: rules.cauchy_schwarz(
            u, (symbol("e"), symbol("f")), components, sp.sqrt(u[0] ** 2 + u[1] ** 2) * (A + B)
        ),
        "a gap times a negative factor": lambda: rules.by_gap(-A, -B, -sp.S.One, known(A, "<=", B)),
        "< by a gap times 0 or more": lambda: rules.by_gap(A * Y, B * Y, Y, known(A, "<", B)),
        "a negative multiple": lambda: rules.scaled(UP, -C),
        "squares with a negative coefficient": lambda: rules.squares(X**2, sp.S.Zero, [(-sp.S.One, X)]),
        "squares that are not the gap": lambda: rules.squares(sp.S.Zero, X**2 + symbol("z"), [(sp.S.One, X)]),
        "growth from a gap that is not 0 at 0": lambda: rules.grows(S + 1, 2 * S, S),
        "growth with a falling gap": lambda: rules.grows(2 * S, S, S),
        "a function that grows, said to fall": lambda: rules.falling(
            sp.tanh(S), S, A, (rules.identity(S**2 * sech2(S), S**2 * sech2(S) - 0), rules.ordered(0, "<=", S))
        ),
        "a fall whose slope has the other sign": lambda: rules.falling(
            sp.tanh(S) / S, S, A, (l0().about(S**2 * sp.diff(sp.tanh(S) / S, S)), l0().about(sp.Abs(sp.tanh(X)), "<="))
        ),
    }


def _from_facts() -> Rows:
    fleet = generic()
    wide = rules.ordered(X, "<=", A, (SIZE,))
    return {
        "a chain with a link missing": lambda: rules.chained(UP, known(A, "<=", C)),
        "a chain over a false link": lambda: rules.chained(UNKNOWN, OVER),
        "a size from a bound of another letter": lambda: rules.sized(known(0, "<", B), known(A, "<=", C)),
        "an instance outside a hypothesis": lambda: rules.instance(wide, {X: C}),
        "an instance at a negative number": lambda: rules.instance(rules.ordered(0, "<=", Y), {Y: symbol("z")}),
        "a name for another expression": lambda: rules.renamed(known(sp.Abs(fleet[0].q), "<=", A), fleet[0].b, fleet),
        "an equation for another expression": lambda: rules.by_equation(
            known(sp.Abs(X), "<=", A), symbol("z"), known(symbol("z"), "=", 2 * X)
        ),
        "a supremum that is not reached": lambda: rules.saturated(sp.tanh(X), {sp.tanh(X): sp.S.Half}, sp.S.One),
    }


def _limits() -> Rows:
    wave = sp.sin(T)
    return {
        "an envelope that stays": lambda: inferences.tends_to_zero(known(sp.Abs(X), "<=", 1 + 1 / T), T),
        "an envelope of another function": lambda: inferences.tends_to_zero(known(sp.Abs(X), "<=", 1 / T), T, A),
        "a wave at its zeros": lambda: inferences.keeps_returning(wave, T, sp.pi * N),
        "a wave at times that end": lambda: inferences.keeps_returning(wave, T, sp.pi / 2 + 0 * N + 1 / N),
        "a bound from below by 0": lambda: inferences.stays_above(known(0, "<=", X)),
        "a lower bound that stays": lambda: inferences.outgrows(known(A, "<=", X), T),
        "a rate whose level may fall": lambda: inferences.carried(A, T, X, (known(0, "<=", B),)),
        "a speed that grows too fast": lambda: inferences.gained(
            known(A, "<=", B), (symbol("x"), sp.S.One, C), symbol("z"), 2 * A * (C - 1)
        ),
        "a speed from an acceleration bounded above": lambda: inferences.gained(
            known(A, ">=", B), (symbol("x"), sp.S.One, C), symbol("z"), sp.sqrt(2 * A * (C - 1))
        ),
    }


def _inferences() -> Rows:
    f, x = symbol("f"), symbol("x")
    rule = Implication((Relation(sp.S.Zero, "<", f), Relation(f, "->", sp.S.Zero)), Relation(x, "->", sp.S.Zero))
    shown = (known(0, "<", 1 / T), known(1 / T, "->", 0), known(T, "-/>", 0))
    fleet = generic()
    i = fleet[0]
    turning = rules.identity(i.I * i.w_dot, fleet.fold(i.I * fleet.closed_loop.omega[0]), fleet)
    return {
        **{
            f"a counterexample without fact {left_out}": lambda left_out=left_out: _negated(
                inferences.counterexample(rule, {f: 1 / T, x: T}, shown[:left_out] + shown[left_out + 1 :])
            )
            for left_out in range(3)
        },
        "a consequence at a point that is not the formation": lambda: inferences.vanishes(i.v + 1, fleet, UP),
        "a window with a term that nothing bounds": lambda: over_window(
            turning,
            i.e_theta,
            Weight(sp.S.One, sp.S.Zero, i.p_w * PERIOD),
            (known(sp.Abs(i.e_theta_dot), "<=", A * ETA),),
            (),
            B,
            fleet.dots,
        ),
        "a second computation that is larger": lambda: computed_twice("mu", arb(1), arb(2)),
        "a second computation that is smaller": lambda: computed_twice("mu", arb(2), arb(1)),
        **{
            f"{left} {sign} {right}": lambda left=left, sign=sign, right=right: inferences.compared(
                Relation(A, sign, B), {A: left, B: right}
            )
            for left, sign, right in ((2, "<=", 1), (1, "<", 1), (1, ">=", 2), (1, ">", 1), (1, "=", 2), (1, "!=", 1))
        },
        "3 <= sqrt 4": lambda: inferences.compared(Relation(sp.sqrt(A), ">=", 3), {A: arb(4)}),
        "a comparison of overlapping balls": lambda: inferences.compared(
            Relation(sp.sin(1) ** 2 + sp.cos(1) ** 2, "<=", sp.S.One), {}
        ),
    }


def _flows() -> Rows:
    """Flows of 1 from the leader, node 3, to vehicle 1; the leader hears vehicle 0, which hears the others."""
    weights = [{1: 1, 2: 1, 3: 1}, {0: 1}, {0: 1}, {0: 1}]
    false = {
        "beyond the weights": ([{1: 2, 2: 0, 3: -2}, {0: -2}, {0: 0}, {0: 2}], 2),
        "of another value": ([{1: 1, 2: 0, 3: -1}, {0: -1}, {0: 0}, {0: 1}], 2),
        "that only one of two nodes knows": ([{1: 0, 2: 0, 3: 0}, {0: -1}, {0: 0}, {0: 1}], 1),
        "that springs from a vehicle": ([{1: 1, 2: -1, 3: -1}, {0: -1}, {0: 1}, {0: 1}], 1),
        "that ends elsewhere": ([{1: 0, 2: 1, 3: -1}, {0: 0}, {0: -1}, {0: 1}], 1),
        "that the leader does not give": ([{1: 1, 2: -1, 3: 0}, {0: -1}, {0: 1}, {0: 0}], 1),
    }
    star = [{1: 1, 2: 1, 3: 1, 4: 1}, {0: 1}, {0: 1}, {0: 1}, {0: 1}]
    leaks = [{1: 1, 2: -1, 3: 1, 4: -1}, {0: -1}, {0: 1}, {0: -1}, {0: 1}]
    fed = symbol("vehicles_fed")
    return {
        "a flow that springs from one vehicle and ends in another": lambda: inferences.compared(
            Relation(fed, "=", 1), {fed: int(carries(star, leaks, 1, 1))}
        ),
        **{
            f"a flow {name}": lambda flow=flow, value=value: inferences.compared(
                Relation(fed, "=", 1), {fed: int(carries(weights, flow, 1, value))}
            )
            for name, (flow, value) in false.items()
        },
    }


def _negated(refutation: Fact) -> Fact:
    """Accepted where the implication is said to be false."""
    return Fact(refutation.statement, refutation.holds is False, refutation.method)
