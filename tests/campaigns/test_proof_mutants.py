"""Mutants: every one refused by the checks that accept the true forms, with the kill rate printed."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from gaincert.models.arrays import column
from gaincert.models.paper import paper_fleet, paper_gains
from gaincert.verify import proof
from gaincert.verify.proof.claim import Status
from gaincert.verify.proof.printed_proof import identities

from tests.campaigns.proof_mutants import _mutant, generated, named, truths


def test_mutants_of_theory_are_refused_with_a_witness():
    mutants = named()
    assert len(mutants) >= 21
    findings = {m.name: m.step.decide() for m in mutants}
    assert [name for name, finding in findings.items() if finding.holds is not False] == []
    assert all(finding.witness for finding in findings.values())


@pytest.mark.slow
def test_generated_mutants_are_refused():
    mutants = generated()
    different = [m for m in mutants if not m.equivalent]
    killed = [m for m in different if m.refused()]
    equivalent = [m.name for m in mutants if m.equivalent]
    print(
        f"\nkill rate {100 * len(killed) / len(different):.1f} % ({len(killed)} of {len(different)}); equivalent: "
        f"{equivalent}"
    )
    assert len(different) >= 20
    assert len(killed) == len(different), [m.name for m in different if m not in killed]


@pytest.mark.parametrize("step", truths(), ids=lambda step: step.text)
def test_true_forms_are_accepted(step):
    assert step.decide().holds is True


@pytest.mark.slow
def test_gains_that_break_15_tenfold_are_accepted():
    gains = paper_gains()
    weak = replace(gains, d_omega=gains.d_omega / 10)
    claims = {c.id: c for c in proof.prove(paper_fleet(), weak)}
    assert claims["theorem"].status is Status.PROVED
    assert claims["fleet"].status is Status.PROVED
    assert claims["torques"].status is Status.PROVED


def exact_limit_fleet(torque: Fraction):
    """p_v = kappa makes 2 (p^2 + kappa^2) a square, so T is rational: T = (r/2)(d_v + 2 p D + (d_w + p_w D)/(2R))."""
    base = paper_fleet().model_dump(mode="json", by_alias=True)
    base["excitation"] = {"family": "harmonics", "frequency": 1, "sin": [1], "mean": 0}
    fleet = type(paper_fleet()).model_validate(base)
    psi, arm, D = fleet.psi, abs(fleet.arm), fleet.graph.degree
    ones = column([Fraction(1)] * 6)
    gains = type(paper_gains())(ones, ones, ones, ones, arm / psi.bound)
    exact = column(v.wheel_radius for v in fleet.vehicles) / 2 * (ones + 2 * D + (ones + D) / arm)
    for row, bound in zip(base["vehicle"], exact, strict=True):
        row["torque_limit"] = {"left": bound * torque, "right": bound * torque}
    return type(fleet).model_validate(base), gains


def test_torque_bound_equal_to_the_limit_is_accepted():
    claims = {c.id: c for c in proof.prove(*exact_limit_fleet(Fraction(1)))}
    assert claims["torques"].status is Status.PROVED
    assert "100.00 %" in claims["torques"].reason


def test_torque_bound_above_the_limit_is_refuted_by_a_state():
    claims = {c.id: c for c in proof.prove(*exact_limit_fleet(Fraction(999, 1000)))}
    assert claims["torques"].status is Status.REFUTED
    assert "can reach" in claims["torques"].witness
    assert claims["theorem"].status is Status.PROVED


def test_gains_that_are_not_positive_are_refused():
    gains = paper_gains()
    bad = replace(gains, k_alpha=np.where(np.arange(6) == 2, Fraction(0), gains.k_alpha))
    claims = {c.id: c for c in proof.prove(paper_fleet(), bad)}
    assert claims["A2"].status is Status.REFUTED
    assert claims["fleet"].status is Status.OPEN


def test_an_equivalent_mutant_is_recognised():
    """sech^2 written as 1 - tanh^2 is no mutant: its difference is 0 in normal form."""
    identity = identities()["eq-24"]
    rewritten = identity.stated.replace(sp.sech, lambda s: sp.sqrt(1 - sp.tanh(s) ** 2))
    mutant = _mutant("sech^2 as 1 - tanh^2", replace(identity, stated=rewritten), rewritten - identity.stated)
    assert mutant.equivalent
    assert not mutant.refused()
