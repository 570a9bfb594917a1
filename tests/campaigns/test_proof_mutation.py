"""The campaign proof_mutation.py: a sample, kinds of error that must not pass, and that no argument is out of date."""

import sys

import pytest

from tests.campaigns import proof_mutation as mutation
from tests.campaigns.proof_mutation import Planted
from tests.campaigns.proof_verdicts import strained_fleet

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="no fork")

LEMMAS = "verify/proof/lemmas"
PLANTED = [
    Planted(
        "N - 1 for N in L9, in the constant and in the statement",
        (
            (
                f"{LEMMAS}/windows.py",
                "N * CHI, cut * sp.tanh(PEAK / (N * f",
                "(N - 1) * CHI, cut * sp.tanh(PEAK / ((N - 1) * f",
            ),
            (
                "verify/proof/constants.py",
                "cut / vehicles * c.ops.tanh(error / (vehicles *",
                "cut / (vehicles - 1) * c.ops.tanh(error / ((vehicles - 1) *",
            ),
        ),
    ),
    Planted(
        "L9 without any step",
        ((f"{LEMMAS}/windows.py", '(pulls, _chain_of_two(), proved_by("inverse_bound", formal))', "()"),),
    ),
    Planted(
        "L9 without what is machine-checked", ((f"{LEMMAS}/windows.py", ', proved_by("inverse_bound", formal))', ")"),)
    ),
    Planted(
        "L12 without its window steps", ((f"{LEMMAS}/windows.py", "*moves.values(), *steps)", "*moves.values())"),)
    ),
    Planted(
        "T^2/4 for T^2/2 in L12",
        (
            (
                "verify/proof/constants.py",
                "turning = 2 * c.plant.inertia + gains.p_omega * rate * period**2 / 2",
                "turning = 2 * c.plant.inertia + gains.p_omega * rate * period**2 / 4",
            ),
        ),
    ),
    Planted("L1 without sqrt2", ((f"{LEMMAS}/bounds.py", "(e_x, e_y), ROOT2 * i.D)", "(e_x, e_y), i.D)"),)),
    Planted(
        "L1 without sqrt2 in the constant",
        (("verify/proof/constants.py", "(c.root2 * c.gains.p_v * c.degree +", "(c.gains.p_v * c.degree +"),),
    ),
    Planted(
        "L13 to L15 resting on nothing",
        ((f"{LEMMAS}/theorem.py", "proved_by(name, self.formal, known)", "proved_by(name, self.formal)"),),
    ),
    Planted(
        "a stronger theorem", ((f"{LEMMAS}/theorem.py", '"corrected_theorem_holds"', '"exponentially_stable_holds"'),)
    ),
    Planted(
        "0 = 1 without a step",
        (
            (
                f"{LEMMAS}/theorem.py",
                "    return found.claims\n",
                '    return [*found.claims, Claim("L19", Kind.LEMMA, ())]\n',
            ),
        ),
    ),
    Planted(
        "0 = 1 with a step",
        (
            (
                f"{LEMMAS}/theorem.py",
                "    return found.claims\n",
                '    return [*found.claims, Claim("L19", Kind.LEMMA, (identity(sp.S.Zero, sp.S.One),))]\n',
            ),
        ),
    ),
    Planted(
        "the torque bound without p_omega D",
        (
            (
                "models/conditions.py",
                "turn = (gains.d_omega + gains.p_omega * data.degree) / data.arm",
                "turn = gains.d_omega / data.arm",
            ),
        ),
    ),
    Planted(
        "a condition with p_omega for p_v",
        (
            (
                "models/conditions.py",
                "return data.degree * numbers.sqrt2_norm(gains.p_v)",
                "return data.degree * numbers.sqrt2_norm(gains.p_omega)",
            ),
        ),
    ),
]


@pytest.mark.slow
def test_planted_errors_are_noticed() -> None:
    passed = [change.name for change, word in mutation.outcomes(PLANTED) if word != mutation.KILLED]
    assert passed == []


@pytest.mark.slow
def test_a_sample_of_forty_is_killed() -> None:
    chosen = [changed for changed in mutation.sample(50, seed=1) if mutation.argument(changed) is None][:40]
    assert len(chosen) == 40
    assert [changed.place for changed, word in mutation.outcomes(chosen) if word == mutation.SURVIVED] == []


def test_every_argument_is_about_a_mutant_that_there_is() -> None:
    assert not mutation.ARGUED.keys() - {changed.key for changed in mutation.every_mutant()}


def test_there_are_thousands_of_mutants_in_every_file() -> None:
    mutants = mutation.every_mutant()
    assert len(mutants) > 5000
    assert {changed.path for changed in mutants} >= {path for path in mutation.PROOF if path.name != "__init__.py"}


def test_the_strained_fleet_breaks_a_torque_limit_and_meets_some_others() -> None:
    from gaincert.verify.proof import prove
    from gaincert.verify.proof.claim import Kind, Status

    claims = {claim.id: claim for claim in prove(*strained_fleet()) if claim.kind is Kind.FLEET}
    assert claims["torques"].status is Status.REFUTED
    limits = [fact for fact in claims["speed-limits"].facts if fact.statement and fact.values[1:2] == ("=",)]
    assert len(limits) == 5
    assert {fact.holds for fact in limits} == {True, False}
