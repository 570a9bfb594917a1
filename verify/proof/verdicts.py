"""From findings to claims: one place where a `Status` is chosen, by what the checks found and nothing else."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import sympy as sp

from .claim import Claim, Status
from .normal_form import Expr, normal_form
from .steps import Cited, Finding, Identity, Step, seconds


def printed(
    id: str,  # noqa: A002 -- the field of a Claim
    source: str,
    statement: str,
    *steps: Step,
    truth: str | None = None,
    truth_steps: tuple[Step, ...] = (),
    note: str = "",
    needs: tuple[str, ...] = (),
    quantity: Expr | None = None,
) -> Claim:
    """A statement of the paper. Where it fails it is CORRECTED if `truth` is given and its own steps hold."""
    findings = [step.decide() for step in steps]
    failed = [(s, f) for s, f in zip(steps, findings, strict=True) if not f.holds]
    base = Claim(id, source, statement, Status.PROVED, _methods(findings), note or "every check holds", needs=needs)
    base = replace(base, second=seconds(findings), **_formulas(steps, findings, quantity))
    if not failed:
        return base
    undecided = next(((step, finding) for step, finding in failed if finding.holds is None), None)
    if undecided:
        return replace(base, status=Status.OPEN, reason=f"{undecided[0].text}: {undecided[1].detail}")
    return _false(base, failed, truth, truth_steps, note)


def _false(
    base: Claim, failed: list[tuple[Step, Finding]], truth: str | None, truth_steps: tuple[Step, ...], note: str
) -> Claim:
    witness = "; ".join(finding.witness for _, finding in failed if finding.witness)
    base = replace(base, witness=witness, reason=note or f"fails: {failed[0][0].text}", status=Status.REFUTED)
    if truth is None and any(isinstance(step, Identity) for step, _ in failed):
        return replace(base, status=Status.CORRECTED, corrected=f"{base.quantity} = {base.derived}")
    found = [s.decide() for s in truth_steps]
    if truth is None or not all(f.holds for f in found):
        return base
    method = "; ".join(dict.fromkeys([base.method, *(f"true form: {f.method}" for f in found)]))
    second = seconds([*(f for _, f in failed), *found])
    return replace(base, status=Status.CORRECTED, corrected=truth, method=method, second=second)


def inference(
    id: str,  # noqa: A002
    source: str,
    statement: str,
    counterexample: tuple[Step, ...],
    witness: str,
    note: str,
    *,
    truth: str | None = None,
    truth_steps: tuple[Step, ...] = (),
    needs: tuple[str, ...] = (),
) -> Claim:
    """An inference of the paper, refuted if every fact about the counterexample holds, else OPEN."""
    findings = [step.decide() for step in (*counterexample, *truth_steps)]
    facts = "; ".join(step.text for step in counterexample)
    base = Claim(id, source, statement, Status.REFUTED, _methods(findings), note, needs=needs)
    base = replace(base, witness=f"{witness}. Checked: {facts}", second=seconds(findings))
    if not all(finding.holds for finding in findings):
        return replace(base, status=Status.OPEN, witness=None, reason="the counterexample was not confirmed")
    return replace(base, status=Status.CORRECTED, corrected=truth) if truth else base


def lemma(
    id: str,  # noqa: A002
    statement: str,
    *steps: Step,
    needs: tuple[str, ...] = (),
    note: str = "",
    source: str = "corrected theorem",
    group: str = "theorem",
) -> Claim:
    """A link of the corrected proof: PROVED if every step holds, REFUTED if one is false, OPEN if one is undecided."""
    findings = [step.decide() for step in steps]
    detail = note or "; ".join(dict.fromkeys(step.text for step in steps))
    claim = Claim(id, source, statement, Status.PROVED, _methods(findings), detail, needs=needs, group=group)
    claim = replace(claim, second=seconds(findings), **_formulas(steps, findings, None))
    for step, finding in zip(steps, findings, strict=True):
        if not finding.holds:
            status = Status.OPEN if finding.holds is None else Status.REFUTED
            reason = f"fails: {step.text}; {finding.detail}"
            return replace(claim, status=status, reason=reason, witness=finding.witness)
    if steps and all(isinstance(step, Cited) for step in steps):
        return replace(claim, status=Status.CITED)
    return claim


def shorter(expression: Expr) -> Expr:
    """The expression or its normal form, whichever reads faster."""
    return min(expression, normal_form(expression), key=sp.count_ops)


def _methods(findings: list[Finding]) -> str:
    return "; ".join(dict.fromkeys(finding.method for finding in findings)) or "by the claims beneath"


def _formulas(steps: tuple[Step, ...], findings: list[Finding], quantity: Expr | None) -> dict[str, Any]:
    """The formulas to typeset: those of the first identity that fails, else of the first."""
    pairs = [(s, f) for s, f in zip(steps, findings, strict=True) if isinstance(s, Identity)]
    if not pairs:
        return {}
    step, finding = next(((s, f) for s, f in pairs if not f.holds), pairs[0])
    return {"quantity": quantity, "stated": step.stated, "derived": shorter(step.derived), "residual": finding.residual}
