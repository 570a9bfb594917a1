"""The proof checker's verdicts: docs/theory.md 6 row by row, the chain, and how verdicts follow the formulas."""

import pstats
import time
from cProfile import Profile
from dataclasses import replace
from itertools import product

import pytest
import sympy as sp
from gaincert.models.fleet import Fleet
from gaincert.verify import proof
from gaincert.verify.proof.chain import beneath, resolve
from gaincert.verify.proof.checker import symbolic
from gaincert.verify.proof.claim import Claim, Status
from gaincert.verify.proof.generic_fleet import generic
from gaincert.verify.proof.names import first
from gaincert.verify.proof.printed_numbers import section_4_psi
from gaincert.verify.proof.printed_proof import identities, jerk_corrected
from gaincert.verify.proof.printed_saturation import ubar_omega
from gaincert.verify.proof.saturation import turning_supremum
from gaincert.verify.proof.stability import cross_track_row
from gaincert.verify.proof.steps import Check, NonNegative
from gaincert.verify.proof.verdicts import printed

P, C, R = Status.PROVED, Status.CORRECTED, Status.REFUTED

SECTION_1 = {
    **{f"eq-{n}": P for n in (1, 2, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 16, 17, 18, 19, 20, 22, 24, 25)},
    "eq-3-4": P, "nonholonomic": P, "lemma-1": P, "lemma-1-paper": P, "prop-1": P, "annihilator": P,
    "eq-2-physical": C, "eq-6-physical": C, "pe-of-psi": R, "eq-15": R, "eq-15-unneeded": P, "eq-16-paper": P,
    "remark-1": P, "remark-1-limit": C, "alpha-bound": P, "after-20": C, "after-20-b": P, "after-20-c": P,
    "boundedness-of-omega": R, "any-bounded-alpha": R, "cuts": R, "eq-21": C, "eq-23": C, "eq-23-true": P,
    "omega-not-to-0": R, "alpha-rate": R, "psi-rate-not-to-0": R, "orientation": C, "cascade": P, "ubar-v": P,
    "ubar-omega": C, "ubar-omega-prop": P, "max-torque": P, "psi-section-4": C, "psi-bar": P, "fig-2": P,
    "eq-15-paper": P, "table-1": C, "table-2": P, "v-in-L2": P,
}  # fmt: skip


@pytest.fixture(scope="module")
def claims() -> dict[str, Claim]:
    return {claim.id: claim for claim in proof.prove()}


def test_section_1_verdict_by_verdict(claims):
    found = {id_: claims[id_].status for id_ in SECTION_1}
    assert found == SECTION_1
    assert {c.id for c in claims.values() if c.group == "printed"} == set(SECTION_1)


def test_the_theorem_is_proved_and_every_lemma_is_beneath_it(claims):
    assert proof.theorem_proved(claims.values())
    support = beneath(claims.values(), "theorem")
    assert {f"L{n}" for n in range(19)} | {f"thm-{part}" for part in "abcdef"} <= support
    assert all(claims[id_].status in (P, Status.CITED) for id_ in support)
    assert "eq-15" not in support


def test_at_least_45_claims_each_with_reason_and_false_ones_with_witness(claims):
    assert len(claims) >= 45
    for claim in claims.values():
        assert claim.method, claim.id
        assert claim.reason, claim.id
        if claim.status in (C, R):
            assert claim.witness, claim.id
        if claim.status is C:
            assert claim.corrected, claim.id


@pytest.mark.parametrize(
    ("id_", "words"),
    [
        ("after-20", ["-0.037", "-15.195"]),
        ("boundedness-of-omega", ["W' = 1.234"]),
        ("cuts", ["53 of 63"]),
        ("psi-section-4", ["12.919", "6 of 6"]),
        ("ubar-omega", ["180.42", "146.02"]),
        ("eq-15", ["c=.76"]),
    ],
)
def test_witness_values(claims, id_, words):
    witness = claims[id_].witness.replace("-0.0367", "-0.037")
    assert all(word in witness for word in words), witness


def test_true_form_of_21_turns_it_proved(claims):
    assert claims["eq-21"].status is C
    true = replace(identities()["eq-21"], stated=jerk_corrected(first()))
    assert printed("eq-21", "(21)", "", true).status is P


def test_other_statements_flip_with_their_formulas():
    n = first()
    assert printed("eq-23", "(23)", "", replace(identities()["eq-23"], stated=n.w * n.b)).status is P
    assert ubar_omega(turning_supremum()).status is P
    from flint import arb

    assert section_4_psi(4 / arb.pi()).status is P
    wrong = replace(identities()["eq-24"], stated=-identities()["eq-24"].stated)
    assert printed("eq-24", "(24)", "", wrong).status is C


def test_three_errors_in_21():
    """Left side v'' for v', phi_perp for phi, the sign of the last term: only all three corrections together hold."""
    n, identity = first(), identities()["eq-21"]
    holding = []
    for left, pull, sign in product((n.v_dot, identity.derived), (n.q, n.b), (1, -1)):
        right = -(n.d_v * n.v_dot * sp.sech(n.v) ** 2 + n.p_v * n.w * pull) / n.m + sign * n.p_v * n.q_of_rate / n.m
        if replace(identity, stated=right, derived=left).decide().holds:
            holding.append((left == identity.derived, pull == n.b, sign == -1))
    assert holding == [(True, True, True)]


def test_rows_not_columns_of_the_linearisation_vanish():
    """L17: omega' does depend on the cross-track error, so the rows of the Jacobian are zero, not its columns."""
    g, n = generic(), first()
    goal = {s: 0 for part in (g.state.v, g.state.omega) for s in part}
    goal |= {s: sp.Symbol("theta_l", real=True) for s in g.state.theta}
    column = g.closed_loop.omega[0].diff(n.y).subs(goal)
    for axis in ("x", "y"):
        for i in (1, 2):
            place = sp.Symbol(f"{axis}_l", real=True) + sp.Symbol(f"delta_{axis}_{i}", real=True)
            column = column.subs(sp.Symbol(f"{axis}_{i}", real=True), place)
    expected = n.k * n.psi * sp.cos(sp.Symbol("theta_l", real=True)) * n.D / n.I
    assert sp.expand(column - expected) == 0
    assert all(entry == 0 for entry in cross_track_row())


def test_unproved_beneath_means_open():
    base = {c.id: c for c in symbolic()}
    base["L5"] = replace(base["L5"], status=Status.OPEN)
    judged = {c.id: c for c in resolve(base.values())}
    for id_ in ("L6", "L7", "L13", "L15", "thm-c", "theorem", "prop-1"):
        assert judged[id_].status is Status.OPEN
        assert "rests on" in judged[id_].reason
    assert judged["thm-f"].status is P


def test_chain_refuses_circles_and_gaps():
    a = printed("a", "", "", needs=("b",))
    with pytest.raises(ValueError, match="rest on each other"):
        resolve([a, printed("b", "", "", needs=("a",))])
    with pytest.raises(ValueError, match="is no claim"):
        resolve([a])


def test_undecided_is_open_and_never_proved():
    x, y = sp.symbols("x y", nonnegative=True)
    hidden = NonNegative("(x - y)^2 >= 0, beyond sign patterns", (x - y) ** 2)
    claim = printed("c", "", "", hidden)
    assert claim.status is Status.OPEN
    assert claim.reason


@pytest.mark.slow
def test_symbolic_part_is_fast_and_independent_of_the_fleet():
    def work(count: int) -> tuple[float, int]:
        fleet = ring(count)
        start = time.process_time()
        proof.prove(fleet)
        seconds = time.process_time() - start
        with Profile() as profile:
            proof.prove(fleet)
        return seconds, pstats.Stats(profile).total_calls

    proof.prove()  # imports and caches
    (six, calls_six), (thousand, calls_thousand) = work(6), work(1000)
    print(f"N = 6: {six:.2f} s, {calls_six} calls, N = 1000: {thousand:.2f} s, {calls_thousand} calls")
    assert max(six, thousand) < 10
    assert abs(calls_thousand - calls_six) <= 0.1 * calls_six


def ring(count: int) -> Fleet:
    names = [f"r{i}" for i in range(count)]
    vehicle = {"mass": 1, "inertia": 1, "half_track": "0.2", "wheel_radius": "0.1", "torque_limit": 5, "offset": [0, 0]}
    return Fleet.model_validate(
        {
            "name": f"ring of {count}",
            "leader": {"position": [0, 0], "heading": 0},
            "graph": {"edges": [[names[i], names[(i + 1) % count]] for i in range(count)], "leader_links": {"r0": 1}},
            "vehicle": [{"name": name, **vehicle} for name in names],
        }
    )


def test_importing_gaincert_loads_no_sympy():
    import subprocess
    import sys

    heavy = "{'sympy', 'z3', 'matplotlib', 'jinja2'}"
    code = f"import gaincert, gaincert.verify.proof, sys; assert not {heavy} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_z3_is_optional(monkeypatch):
    from gaincert.verify.proof import second_opinion

    monkeypatch.setattr(second_opinion, "_z3", lambda: None)
    finding = NonNegative("x >= 0", sp.Symbol("x", nonnegative=True)).decide()
    assert finding.holds
    assert "not installed" in finding.second


@pytest.mark.needs("z3")
def test_z3_agrees_everywhere(claims):
    seconds = [claim.second for claim in claims.values() if claim.second]
    assert len(seconds) >= 20
    assert not any("DISAGREES" in second for second in seconds)


def test_a_check_that_fails_refutes_with_its_detail():
    claim = printed("c", "", "", Check("1 < 0", lambda: (False, "1 >= 0"), "comparison"))
    assert claim.status is R
    assert claim.witness == "1 >= 0"
