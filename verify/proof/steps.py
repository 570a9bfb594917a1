"""The kinds of check, each a frozen value with `decide() -> Finding`; claims are built from what they find.

Nothing here knows a verdict: an `Identity` subtracts and normalises, a `NonNegative` looks at signs, a `Witness`
evaluates in balls. The same code judges the true forms and the mutants.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import sympy as sp

from . import second_opinion, signs
from .ball import evaluate, precise, sample, text
from .generic_fleet import Scene
from .normal_form import Expr, normal_form


@dataclass(frozen=True)
class Finding:
    """What a check found. `holds` is None where it could not decide."""

    holds: bool | None
    method: str
    detail: str = ""  # the range, the value or the reason
    witness: str | None = None  # where it does not hold
    second: str | None = None
    residual: Expr | None = None


class Step(Protocol):
    """A statement with its mechanical check."""

    @property
    def text(self) -> str:
        """The statement in words."""
        ...

    def decide(self) -> Finding:
        """Check it."""
        ...


@dataclass(frozen=True)
class Identity:
    """stated = derived, for all states and parameters."""

    text: str
    stated: Expr
    derived: Expr
    scene: Scene | None = None  # where folded symbols have their meaning

    def difference(self) -> Expr:
        """stated - derived, with the errors kept as symbols: what a reader sees."""
        return normal_form(self.stated - self.derived)

    def residual(self) -> Expr:
        """stated - derived in states alone: what decides."""
        if self.scene is None:
            return self.difference()
        return normal_form(self.scene.unfold(self.stated) - self.scene.unfold(self.derived))

    def decide(self) -> Finding:
        """Zero in normal form, or nonzero at a point in ball arithmetic."""
        residual = self.residual()
        if residual == 0:
            return Finding(True, "polynomial normal form: the residual is 0", residual=residual)
        point = separating_point(residual)
        if point is None:
            return Finding(None, "polynomial normal form", "the residual is not 0, but no point shows it")
        return Finding(
            False,
            "polynomial normal form: the residual is not 0; shown at a point in ball arithmetic",
            witness=point,
            residual=self.difference(),
        )


def separating_point(residual: Expr) -> str | None:
    """A rational point at which an expression is not 0, with its value there; None where three points show none."""
    symbols = sorted(residual.free_symbols, key=lambda s: s.name)
    with precise():
        for seed in range(3):
            point = sample(symbols, seed)
            value = evaluate(residual, point)
            if abs(value) > 0:
                where = ", ".join(f"{s.name} = {float(q):g}" for s, q in point.items())
                return f"residual = {text(value)} at {where or 'no variable'}"
    return None


@dataclass(frozen=True)
class NonNegative:
    """gap >= 0 in every case; `reach` says the range in words."""

    text: str
    gap: Expr
    cases: tuple[Mapping[Expr, Expr], ...] = field(default=({},))
    reach: str = "all positive parameters"

    def decide(self) -> Finding:
        """All signs nonnegative, or a counterexample in ball arithmetic."""
        with precise():
            for case in self.cases:
                if not signs.nonnegative(self.gap, case):
                    return self._refute(case)
        second = "; ".join(sorted({second_opinion.opinion(self.gap, case) for case in self.cases}))
        if second_opinion.DISAGREES in second:
            return Finding(
                None, "expansion in nonnegative slacks", f"the second opinion differs: {second}", second=second
            )
        return Finding(True, "expansion in nonnegative slacks: every sign is +", self.reach, second=second)

    def _refute(self, case: Mapping[Expr, Expr]) -> Finding:
        point = signs.counterexample(self.gap, case)
        if point is None:
            return Finding(None, "expansion in nonnegative slacks", "a sign is -, but no counterexample was found")
        value = evaluate(sp.expand(sp.sympify(self.gap).subs(case, simultaneous=True)), point)
        where = ", ".join(f"{s.name} = {text(q, 4)}" for s, q in self._in_letters(case, point).items())
        return Finding(False, "ball arithmetic at a point", witness=f"gap = {text(value)} < 0 at {where}")

    def _in_letters(self, case: Mapping[Expr, Expr], point: Mapping[Expr, Any]) -> dict[Expr, Any]:
        """The values of the statement's own letters at a point given in slacks."""
        letters = sorted(sp.sympify(self.gap).free_symbols, key=lambda s: s.name)
        slack = dict(point) | {s: 0 for e in case.values() for s in sp.sympify(e).free_symbols if s not in point}
        return {s: evaluate(sp.sympify(case.get(s, s)), slack) for s in letters}


@dataclass(frozen=True)
class Check:
    """A computation that says yes or no, with the words for its method and for what it saw."""

    text: str
    compute: Callable[[], tuple[bool, str]]  # (it holds, the values in words)
    method: str

    def decide(self) -> Finding:
        """Run it in ball arithmetic."""
        with precise():
            holds, detail = self.compute()
        return Finding(holds, self.method, detail, witness=None if holds else detail)


@dataclass(frozen=True)
class Cited:
    """A theorem of analysis that algebra cannot check; each hypothesis is a step that is checked."""

    text: str
    reference: str
    hypotheses: tuple[Step, ...]

    def decide(self) -> Finding:
        """Every hypothesis must hold."""
        findings = [(step, step.decide()) for step in self.hypotheses]
        failed = [step.text for step, finding in findings if not finding.holds]
        listed = "; ".join(f"({n}) {step.text}" for n, (step, _) in enumerate(findings, 1))
        if failed:
            return Finding(None, f"cited: {self.reference}", f"hypothesis fails: {failed[0]}")
        return Finding(
            True, f"cited: {self.reference}; hypotheses checked: {listed}", second=seconds(f for _, f in findings)
        )


def seconds(findings: Any) -> str | None:
    """The second opinions, each once."""
    found = sorted({finding.second for finding in findings if finding.second})
    return "; ".join(found) or None
