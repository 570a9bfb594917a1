"""A second opinion on polynomial inequalities from z3, where it is installed: not (hypotheses => gap >= 0) is unsat."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

import sympy as sp

from .normal_form import Expr

TIMEOUT_MS = 1000
DISAGREES = "DISAGREES"


@cache
def _z3() -> Any:
    try:
        import z3  # type: ignore[import-untyped,unused-ignore]
    except ImportError:
        return None
    return z3


def available() -> bool:
    """Whether z3 can be imported (pip package z3-solver)."""
    return _z3() is not None


def opinion(gap: Expr, case: Mapping[Expr, Expr]) -> str:
    """What z3 says of gap >= 0 for nonnegative slacks: one line to stand beside the first method."""
    z3 = _z3()
    if z3 is None:
        return "z3 is not installed: no second opinion"
    try:
        return _ask(z3, sp.sympify(gap).subs(case, simultaneous=True))
    except _BeyondTheory as reason:
        return f"beyond z3's theory: {reason}"


class _BeyondTheory(Exception):
    """The formula has a function that real arithmetic does not know."""


def _ask(z3: Any, gap: Expr) -> str:
    solver = z3.Solver()
    solver.set("timeout", TIMEOUT_MS)
    variables: dict[Expr, Any] = {}
    formula = _translate(z3, solver, variables, gap)
    solver.add(formula < 0)
    answer = str(solver.check())
    name = f"z3 {z3.get_version_string()}"
    verdicts = {"unsat": "agrees (the negation is unsatisfiable)", "sat": f"{DISAGREES} (finds a counterexample)"}
    return f"{name} {verdicts.get(answer, 'gives up within 1 s')}"


def _translate(z3: Any, solver: Any, variables: dict[Expr, Any], e: Expr) -> Any:
    if e.is_Rational:
        return z3.Q(int(e.p), int(e.q))
    if e.is_Symbol or e.func is sp.tanh or (e.is_Pow and e.exp == sp.Rational(1, 2)):
        return _variable(z3, solver, variables, e)
    parts = [_translate(z3, solver, variables, part) for part in e.args[:1]]
    if e.is_Pow and e.exp.is_Integer:
        return parts[0] ** int(e.exp) if e.exp > 0 else 1 / parts[0] ** int(-e.exp)
    parts += [_translate(z3, solver, variables, part) for part in e.args[1:]]
    if e.is_Add:
        return z3.Sum(parts)
    if e.is_Mul:
        return z3.Product(parts)
    raise _BeyondTheory(str(e.func))


def _variable(z3: Any, solver: Any, variables: dict[Expr, Any], e: Expr) -> Any:
    """A fresh real with what is known of it: slacks are >= 0, roots are roots, tanh of a number lies in its bracket."""
    if e in variables:
        return variables[e]
    variable = variables[e] = z3.Real(f"u{len(variables)}")
    if e.is_Symbol:
        if e.is_positive or e.is_nonnegative:
            solver.add(variable > 0 if e.is_positive else variable >= 0)
    elif e.is_Pow:
        solver.add(variable >= 0, variable * variable == _translate(z3, solver, variables, e.base))
    elif e.args[0].is_number:
        low = sp.Rational(int(sp.floor(e.evalf(20) * 10**9)), 10**9)
        solver.add(variable >= z3.Q(int(low.p), int(low.q)), variable <= z3.Q(int(low.p), int(low.q)) + z3.Q(1, 10**9))
    else:
        _tanh_of(z3, solver, variable, _translate(z3, solver, variables, e.args[0]))
    return variable


def _tanh_of(z3: Any, solver: Any, t: Any, v: Any) -> None:
    """The polynomial abstraction of t = tanh v: |t| < 1 and 0 <= t v <= v^2."""
    solver.add(t < 1, t > -1, t * v >= 0, t * v <= v * v, z3.Implies(v == 0, t == 0))
