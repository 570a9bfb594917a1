"""Mutants: every one refused by the rules that accept the true forms, with the kill rate printed."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from gaincert.models.arrays import column
from gaincert.models.paper import paper_fleet, paper_gains
from gaincert.verify import proof
from gaincert.verify.proof.claim import Status
from gaincert.verify.proof.method.fleet_symbols import generic_unit
from gaincert.verify.proof.method.normal_form import equal
from gaincert.verify.proof.printed import convergence

from tests.campaigns.proof_mutants import generated, named, truths
from tests.campaigns.proof_rules import unsupported


def test_mutants_of_theory_are_refused_with_a_witness():
    mutants = named()
    assert len(mutants) >= 21
    findings = {m.name: m.judge() for m in mutants}
    assert [name for name, fact in findings.items() if fact.holds is not False] == []
    assert all(fact.witness for fact in findings.values())


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


@pytest.mark.parametrize("truth", truths(), ids=lambda truth: truth.name)
def test_true_forms_are_accepted(truth):
    assert truth.judge().holds is True


@pytest.mark.parametrize("judge", unsupported().values(), ids=unsupported())
def test_what_does_not_follow_is_not_accepted(judge):
    try:
        fact = judge()
    except (KeyError, ValueError):
        return
    assert fact.holds is not True


def of_fleet(fleet, gains):
    return {claim.id: claim for claim in proof.prove(fleet, gains)}


def test_gains_that_break_15_tenfold_are_accepted():
    gains = paper_gains()
    claims = of_fleet(paper_fleet(), replace(gains, d_omega=gains.d_omega / 10))
    for id_ in ("theorem", "fleet", "torques"):
        assert claims[id_].status is Status.FORMAL


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
    claims = of_fleet(*exact_limit_fleet(Fraction(1)))
    assert claims["torques"].status is Status.FORMAL
    used, _, limit, *_ = claims["torques"].facts[0].values
    assert used == limit


def test_torque_bound_above_the_limit_is_refuted_by_a_state():
    claims = of_fleet(*exact_limit_fleet(Fraction(999, 1000)))
    assert claims["torques"].status is Status.REFUTED
    bound, reached, *_ = claims["torques"].facts
    assert bound.holds is False
    assert reached.holds is False
    assert float(reached.witness.left) > float(reached.witness.right)
    assert claims["theorem"].status is Status.FORMAL


def test_gains_that_are_not_positive_are_refused():
    gains = paper_gains()
    bad = replace(gains, k_alpha=np.where(np.arange(6) == 2, Fraction(0), gains.k_alpha))
    claims = of_fleet(paper_fleet(), bad)
    assert claims["A2"].status is Status.REFUTED
    assert claims["fleet"].status in (Status.OPEN, Status.REFUTED)
    assert not claims["fleet"].sound


def test_an_equivalent_mutant_is_recognised():
    """sech^2 written as 1 - tanh^2 is no mutant: its difference is 0 in normal form."""
    unit = generic_unit()
    stated = convergence.eq_24().facts[0].left
    rewritten = stated.replace(sp.sech, lambda s: sp.sqrt(1 - sp.tanh(s) ** 2))
    assert equal(unit.unfold(rewritten), unit.unfold(stated))
