"""The proof check's verdicts: docs/theory.md 6 row by row, what rests on what, and how verdicts follow the formulas."""

import pstats
import time
from cProfile import Profile
from dataclasses import replace
from itertools import product

import pytest
import sympy as sp
from flint import arb
from gaincert.models.fleet import Fleet
from gaincert.verify import proof
from gaincert.verify.proof.claim import Claim, Fact, Kind, Method, Relation, Status
from gaincert.verify.proof.formal import Record, development, proved_by
from gaincert.verify.proof.lemmas.theorem import lemmas
from gaincert.verify.proof.method.fleet_symbols import generic_unit
from gaincert.verify.proof.method.rules import identity, ordered, restated
from gaincert.verify.proof.printed import boundedness, convergence, energies, saturation, section_4

P, F, C, R = Status.PROVED, Status.FORMAL, Status.CORRECTED, Status.REFUTED
U = generic_unit()
N = U[0]

PAPER = {
    **{f"eq-{n}": P for n in (1, 2, 5, 6, 7, 8, 9, 10, 12, 13, 14, 16, 17, 18, 19, 20, 24)},
    "eq-22": F, "eq-3-4": F, "nonholonomic": P, "lemma-1": P, "lemma-1-paper": P, "prop-1": F, "annihilator": P,
    "eq-2-physical": C, "eq-6-physical": C, "eq-15": R, "eq-16-paper": P, "remark-1": P, "remark-1-limit": C,
    "alpha-bound": P, "after-20": C, "after-20-b": P, "after-20-c": P, "boundedness-of-omega": R,
    "any-bounded-alpha": R, "eq-21": C, "eq-23": C, "omega-not-to-0": R, "alpha-rate": R, "psi-rate-not-to-0": C,
    "orientation": C, "cascade": F, "ubar-v": P, "ubar-omega": C, "ubar-omega-prop": P, "max-torque": P,
    "psi-bar": P, "eq-15-paper": P, "table-1": C, "table-2": P, "v-in-L2": P,
}  # fmt: skip
READINGS = {"eq-11": P, "eq-25": P, "fig-2": P, "psi-section-4": P}  # illegible in the text at hand
REMARKS = {"pe-of-psi": F, "cuts": P, "conservatism": P, "unit-scales": P, "other-units": P}  # not the paper's
HERE = (0, 1, 2, 3, 4, 5, 6, 8, 16, 18)  # lemmas that are derived here; the others are formal


@pytest.fixture(scope="module")
def claims() -> dict[str, Claim]:
    return {claim.id: claim for claim in proof.prove()}


@pytest.mark.parametrize(
    ("kind", "expected"),
    [(Kind.PAPER, PAPER), (Kind.READING, READINGS), (Kind.REMARK, REMARKS)],
    ids=lambda k: str(k)[:12],
)
def test_verdict_by_verdict(claims, kind, expected):
    assert {id_: claim.status for id_, claim in claims.items() if claim.kind is kind} == expected


def test_lemmas_are_proved_here_or_formal(claims):
    found = {id_: claim.status for id_, claim in claims.items() if claim.kind is Kind.LEMMA}
    here = {*(f"L{n}" for n in HERE), "L16b", "conditions"}
    assert found == {id_: P if id_ in here else F for id_ in found}
    assert {f"L{n}" for n in range(19)} | {f"thm-{part}" for part in "abcdef"} | {"theorem"} <= found.keys()
    assert proof.theorem_proved(claims.values())


def beneath(claims, id_):
    found, waiting = set(), [id_]
    while waiting:
        new = set(claims[waiting.pop()].rests_on) - found
        found |= new
        waiting += new
    return found


def test_what_the_theorem_rests_on_is_read_off_its_sources(claims):
    support = beneath(claims, "theorem")
    assert {"L7", "L9", "L10", "L12", "L13", "L14", "L16", "L18", "L0", "L1", "L2", "L5", "L6"} <= support
    assert not {"eq-15", "eq-15-paper"} & support
    assert beneath(claims, "L6") >= {"L5", "L1", "L0"}


def test_every_claim_has_facts_and_every_false_one_a_witness(claims):
    assert len(claims) >= 45
    for claim in claims.values():
        assert claim.facts
        if claim.status in (C, R):
            assert any(fact.holds is False and fact.witness for fact in claim.facts), claim.id
        if claim.status is C:
            assert all(fact.holds for fact in claim.truth)
            assert claim.truth


@pytest.mark.parametrize(
    ("id_", "values"),
    [
        ("eq-2-physical", ("0.463149", "-0.231575")),
        ("eq-6-physical", ("1.47096", "-0.735480")),
        ("after-20", ("-0.0366517232", "-15.1952314")),
        ("boundedness-of-omega", ("1.23418516", "0")),
        ("ubar-omega", ("180.417810", "146.019495")),
    ],
)
def test_witness_values(claims, id_, values):
    assert values in [(f.witness.left, f.witness.right) for f in claims[id_].facts if f.witness]


def test_numbers_of_the_paper(claims):
    assert ("53", "=", "53") in [fact.values for fact in claims["cuts"].facts]
    assert [fact.values[1] for fact in claims["psi-section-4"].facts] == 6 * ["<="] + 6 * [">"]
    found = [float(fact.values[0]) for fact in claims["eq-16-paper"].facts]
    assert found == pytest.approx([653.27, 1302.15, 753.11, 1489.10, 503.52, 503.52], abs=0.005)


# -- verdicts follow the formulas -------------------------------------------------------------------------------------

TRUE_FORMS = {
    "(21)": lambda: convergence.eq_21(convergence.jerk(N.b, -1)),
    "(23)": lambda: convergence.eq_23(_attractive(), N.w * N.b),
    "saturation paragraph": lambda: saturation.ubar_omega(saturation.proposition_ubar_omega()),
    "inequality after (20)": lambda: boundedness.after_20(sp.Abs(boundedness.OMEGA)),
    "Table 1": lambda: section_4.table_1(_newton_metre()),
}


def _attractive() -> Fact:
    return proved_by("uniformly_attractive_holds", development())


def _newton_metre() -> sp.Expr:
    kg, metre, second = sp.symbols("kg metre second", real=True, positive=True)
    return kg * metre**2 / second**2


@pytest.mark.parametrize("build", TRUE_FORMS.values(), ids=TRUE_FORMS.keys())
def test_printed_errors_turn_true_with_their_formulas(build):
    assert build().status is P


BROKEN = {
    "(17) without 1/2": lambda: energies.eq_17(2 * energies.printed_energy("x y", "m", "p_v", "v")),
    "(17) with d_v for p_v": lambda: energies.eq_17(energies.printed_energy("x y", "m", "d_v", "v")),
    "(18) with its sign": lambda: energies.eq_18(-energies.printed_rate_of_v(U)),
    "(18) with p_v for d_v": lambda: energies.eq_18(energies.printed_rate_of_v(U).subs(N.d_v, N.p_v)),
    "(19) without the headings": lambda: energies.eq_19(energies.printed_energy("", "I", "p_w", "w")),
    "(20) without alpha": lambda: energies.eq_20(energies.printed_rate_of_w(U).subs(N.alpha, 0)),
}


@pytest.mark.parametrize("build", BROKEN.values(), ids=BROKEN.keys())
def test_broken_energies_are_refuted_with_a_witness(build):
    claim = build()
    assert claim.status is R
    assert any(fact.witness for fact in claim.facts)


def test_psi_of_section_4_read_otherwise_is_refuted():
    assert section_4.psi_section_4(4 / arb.pi()).status is P
    assert section_4.psi_section_4(4 * arb.pi()).status is R


def test_three_errors_in_21():
    """Left side v'' for v', phi_perp for phi, the sign of the last term: only all three corrections together hold."""
    second = convergence.second_rate(N.v_dot)
    holding = [
        (left is second, pull == N.b, sign == -1)
        for left, pull, sign in product((N.v_dot, second), (N.q, N.b), (1, -1))
        if identity(convergence.jerk(pull, sign), left, U).holds
    ]
    assert holding == [(True, True, True)]


def test_derivatives_of_the_energies_cancel_line_by_line(claims):
    for id_ in ("eq-18", "eq-20"):
        walks = claims[id_].walks
        assert [walk.vehicles for walk in walks] == [2, 2, 3]
        for walk in walks:
            assert walk.residual == 0
            assert all(one + other == 0 for one, other in walk.pairs)
            assert sp.expand(sum(walk.after) - walk.left_over) == 0
            assert 2 * len(walk.pairs) + len(sp.Add.make_args(walk.left_over)) == len(walk.after)


# -- a status cannot be typed -----------------------------------------------------------------------------------------


def test_a_claim_without_a_step_is_refused():
    with pytest.raises(ValueError, match="no fact"):
        Claim("0 = 1", Kind.LEMMA, ())


def test_zero_is_not_one():
    assert Claim("0 = 1", Kind.LEMMA, (identity(0, 1),)).status is R


def test_undecided_is_open_and_never_proved():
    x, y = sp.symbols("x y", nonnegative=True)
    hidden = ordered(0, "<=", (x - y) ** 2)
    assert hidden.holds is None
    assert Claim("c", Kind.LEMMA, (hidden,)).status is Status.OPEN


def test_what_rests_on_something_false_is_open():
    x = sp.Symbol("x", real=True)
    wrong = Claim("wrong", Kind.LEMMA, (identity(x, 2 * x),))
    above = Claim("above", Kind.LEMMA, (identity(x, x, by=(wrong.about(x),)),))
    assert (wrong.status, above.status, above.rests_on) == (R, Status.OPEN, ("wrong",))
    assert Claim("further", Kind.LEMMA, (restated(above.about(x)),)).status is Status.OPEN


def test_a_rule_of_statements_needs_every_premise():
    """A counterexample that does not meet a premise refutes nothing."""
    f, b, facts = convergence.fading_bumps()
    assert convergence.omega_not_to_0().status is R
    rule = convergence.omega_not_to_0().facts[0].statement
    from gaincert.verify.proof.method.inferences import counterexample

    for left_out in range(len(facts)):
        kept = facts[:left_out] + facts[left_out + 1 :]
        assert counterexample(rule, {N.w: f, N.b: b}, kept).holds is None


# -- the machine-checked theorem --------------------------------------------------------------------------------------


def test_formal_claims_need_the_record_of_these_sources():
    formal = development()
    assert formal.checked
    stale = replace(formal, record=replace(formal.record, digest="sha256:0"))
    none = replace(formal, record=None)
    axiom = replace(formal, record=replace(formal.record, theorems={"corrected_theorem_holds": ["an_axiom"]}))
    gap = replace(formal, gaps=["File.v: Admitted"])
    for other in (stale, none, axiom, gap):
        found = {claim.id: claim.status for claim in lemmas(other)}
        assert found["theorem"] is Status.OPEN
        assert found["L9"] is Status.OPEN
        assert found["L6"] is P


def test_a_theorem_that_is_not_there_is_refused():
    with pytest.raises(KeyError, match="no theorem 'no_such_theorem'"):
        proved_by("no_such_theorem", development())


def test_formal_statements_are_the_words_of_the_sources(claims):
    theorem = claims["theorem"].facts[-1]
    assert theorem.method is Method.COQ
    assert theorem.statement.source == "Theorem.v"
    assert theorem.statement.text == (
        "forall F : fleet, A1 F -> A2 F -> A3 F -> uniformly_bounded F /\\ uniformly_stable F /\\ "
        "uniformly_attractive F /\\ torque_bound F /\\ speed_bound F /\\ turn_rate_bound F"
    )
    assert isinstance(development().record, Record)


# -- the work ---------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_check_is_fast_and_independent_of_the_fleet():
    def work(count: int) -> tuple[float, int]:
        fleet = ring(count)
        start = time.process_time()
        proof.prove(fleet)
        seconds = time.process_time() - start
        with Profile() as profile:
            proof.prove(fleet)
        return seconds, pstats.Stats(profile).total_calls

    (six, calls_six), (thousand, calls_thousand) = work(6), work(1000)
    print(f"N = 6: {six:.2f} s, {calls_six} calls, N = 1000: {thousand:.2f} s, {calls_thousand} calls")
    assert max(six, thousand) < 10
    assert calls_thousand < 10**6  # what depends on the fleet: its graph, read once


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


@pytest.mark.needs("z3")
def test_z3_agrees_everywhere(claims):
    """A second opinion on every inequality that signs decide: its negation is unsatisfiable, or z3 gives up."""
    from tests.verify.second_opinion import opinion

    facts = {id(f): f for claim in claims.values() for f in claim.steps() if f.method is Method.SIGNS}
    found = [opinion(fact) for fact in facts.values() if fact.holds]
    assert len(found) >= 20
    assert not any("finds a counterexample" in word for word in found)
    assert sum("agrees" in word for word in found) >= 20


def test_a_comparison_that_fails_refutes_with_its_numbers():
    from gaincert.verify.proof.method.inferences import compared

    x = sp.Symbol("x")
    claim = Claim("c", Kind.FLEET, (compared(Relation(x, "<", sp.S.Zero), {x: 1}),))
    assert claim.status is R
    assert claim.facts[0].witness.left == "1"
