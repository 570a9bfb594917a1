"""What z3 says of an inequality that signs decided: not (hypotheses => gap >= 0) is unsatisfiable."""

from __future__ import annotations

from typing import Any

import sympy as sp
import z3
from gaincert.verify.proof.claim import Fact

TIMEOUT_MS = 1000


class _BeyondTheory(Exception):
    """The formula has a function that real arithmetic does not know."""


def opinion(fact: Fact) -> str:
    """One line: agrees, finds a counterexample, gives up, or cannot say."""
    solver = z3.Solver()
    solver.set("timeout", TIMEOUT_MS)
    variables: dict[Any, Any] = {}
    try:
        for known in fact.by:
            left, right = (_translate(solver, variables, sp.sympify(side)) for side in (known.left, known.right))
            solver.add(left <= right if "<" in known.statement.sign else left >= right)
        left, right = (_translate(solver, variables, sp.sympify(side)) for side in (fact.left, fact.right))
    except _BeyondTheory as reason:
        return f"beyond z3's theory: {reason}"
    solver.add(left > right if fact.statement.sign == "<=" else left < right)
    verdicts = {"unsat": "agrees", "sat": "finds a counterexample"}
    return verdicts.get(str(solver.check()), "gives up")


def _translate(solver: Any, variables: dict[Any, Any], e: Any) -> Any:
    if e.is_Rational:
        return z3.Q(int(e.p), int(e.q))
    if e.is_Symbol or e.func is sp.tanh or (e.is_Pow and e.exp == sp.Rational(1, 2)):
        return _variable(solver, variables, e)
    if e.func is sp.Abs:
        inner = _translate(solver, variables, e.args[0])
        return z3.If(inner >= 0, inner, -inner)
    if e.is_Pow and e.exp.is_Integer:
        base = _translate(solver, variables, e.base)
        return base ** int(e.exp) if e.exp > 0 else 1 / base ** int(-e.exp)
    if e.is_Add or e.is_Mul:
        parts = [_translate(solver, variables, part) for part in e.args]
        return z3.Sum(parts) if e.is_Add else z3.Product(parts)
    raise _BeyondTheory(str(e.func))


def _variable(solver: Any, variables: dict[Any, Any], e: Any) -> Any:
    """A fresh real with what is known of it: signs, roots are roots, tanh of a number lies in its bracket."""
    if e in variables:
        return variables[e]
    variable = variables[e] = z3.Real(f"u{len(variables)}")
    if e.is_Symbol:
        if e.is_nonnegative:
            solver.add(variable > 0 if e.is_positive else variable >= 0)
    elif e.is_Pow:
        solver.add(variable >= 0, variable * variable == _translate(solver, variables, e.base))
    elif e.args[0].is_number:
        low = sp.Rational(int(sp.floor(e.evalf(20) * 10**9)), 10**9)
        solver.add(variable >= z3.Q(int(low.p), int(low.q)), variable <= z3.Q(int(low.p) + 1, int(low.q)))
    else:
        solver.add(variable < 1, variable > -1)
        if e.args[0].is_nonnegative:
            solver.add(variable > 0 if e.args[0].is_positive else variable >= 0)
    return variable
