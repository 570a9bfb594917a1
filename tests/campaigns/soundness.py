"""Whether the trusted kernel ever accepts what is false: random fleets a hair's breadth from the edge of a condition.

    python tests/campaigns/soundness.py [COUNT] [--first N] [--show N]

Each fleet has one number (a gain, a torque limit or psi_bar) moved to a relative margin of +-1e-3 .. +-1e-15 from the
edge of one condition of one vehicle, to the nearest decimals on either side of it, or, where the edge is rational,
onto it. A margin that the certificate states counts as part of the condition. All other conditions hold with room.
Three judges decide the same certificate:

  kernel     verify/kernel.py on the certificate
  models     models/conditions.py in exact fractions, with psi_bar of models/excitation.py
  theory     soundness_theory.py, written from the formulas of the theorem, in mpmath's interval arithmetic of 60
             digits, at every corner of the intervals of the parameters; where the margin's interval holds 0 it is
             "too close"

Then the units of some fleets are changed by 1e-8 and 1e8, which must change no verdict. Exit code 1 where the kernel
accepts a false statement, or judges disagree on one farther from the edge than the stated band.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from decimal import Decimal, localcontext
from fractions import Fraction
from typing import Any, NamedTuple

from gaincert.models.arrays import column
from gaincert.models.conditions import condition_set, exact_numbers
from gaincert.models.fleet import Fleet
from gaincert.models.gains import GAIN_NAMES, Gains
from gaincert.models.saturation import Saturation
from gaincert.verify import kernel

from tests.campaigns.certificate_rows import to_columns
from tests.campaigns.soundness_fleets import PLACES, Trial, draw, text
from tests.campaigns.soundness_theory import (
    CONDITIONS,
    LIMITS,
    PSI_BAR,
    SPEED,
    TURN_ACCELERATION,
    TURN_RATE,
    WHEEL_SPEED,
    Judgement,
    theory,
)  # fmt: skip

# Relative margins up to which a judge may refuse what is true. The kernel decides roots exactly and tanh to 1e-75, but
# not |psi| <= psi_bar at the supremum itself; conditions.py encloses roots and tanh (down to 1e-3) within 1e-40, and
# excitation.py exceeds the supremum by at most 1e-8.
KERNEL_BAND = dict.fromkeys(CONDITIONS, 1e-60) | {PSI_BAR: 1e-36}
MODELS_BAND = dict.fromkeys(CONDITIONS, 1e-36) | {PSI_BAR: 1.1e-8}


# -- the judges -------------------------------------------------------------------------------------------------------


SOURCES = {name: f"{name.replace('_', ' ')} limit" for name in LIMITS}  # of the models' conditions


def models_hold(document: dict[str, Any]) -> bool:
    """The word of models/conditions.py and models/excitation.py on a certificate's conditions and psi_bar."""
    leader = {"position": ["0", "0"], "heading": "0"}
    fleet = Fleet.model_validate({"name": "drawn", "leader": leader, **document["fleet"], **document["designed"]})
    assert fleet.psi is not None
    bar, own = Fraction(document["psi_bar"]), fleet.condition_data(fleet.psi)
    exact = {name: column(map(Fraction, values)) for name, values in document["gains"].items()}
    network = exact["position_scale"][0], exact["heading_scale"][0]
    scales = Saturation(*network, exact["speed_scale"], exact["turn_rate_scale"])
    gains = Gains(**{name: exact[name] for name in GAIN_NAMES}, saturation=scales)
    found = condition_set(document["conditions"]).inequalities(exact_numbers(), replace(own, psi_bar=bar), gains)
    margins = {SOURCES.get(name, name): stated for name, stated in document["margins"].items()}
    return own.psi_bar <= bar and all(
        stated is None or (one.holds[i] and one.margin[i] >= Fraction(stated))
        for one in found
        for i, stated in enumerate(margins[one.source])
    )


def checked(document: dict[str, Any]) -> kernel.Verdict:
    """The kernel's verdict on a row document."""
    return kernel.check_data(json.dumps(to_columns(document)).encode())


class Outcome(NamedTuple):
    """What the judges say of one fleet."""

    trial: Trial
    truth: bool | None  # None: nobody knows
    theory: Judgement  # of the statement at the edge; all others are clearly true
    verdict: kernel.Verdict
    models: bool

    @property
    def margin(self) -> float:
        """How far from the edge."""
        return 0.0 if self.trial.on_the_edge else abs(self.theory.margin)

    @property
    def falsely_accepted(self) -> bool:
        """The kernel accepts what is false."""
        return self.truth is False and self.verdict.valid

    @property
    def refused(self) -> bool:
        """The kernel refuses what is true."""
        return self.truth is True and not self.verdict.valid

    @property
    def undecided_by_models(self) -> bool:
        """The models do not confirm what is true, within their band."""
        return self.truth is True and not self.models and self.margin <= MODELS_BAND[self.trial.condition]

    @property
    def models_disagree(self) -> bool:
        """The models confirm what is false, or refuse what is true beyond their band."""
        return self.truth is not None and self.models != self.truth and not self.undecided_by_models

    @property
    def refused_elsewhere(self) -> bool:
        """The kernel refuses what is false for another vehicle or condition than the false one."""
        if self.truth is not False or self.verdict.valid:
            return False
        if self.trial.condition == PSI_BAR:
            return self.verdict.rule != "psi_bounded"
        return not self.verdict.reason.startswith(f"{self.trial.condition}: vehicle {int(self.trial.vehicle[1:]) + 1}")

    def failures(self) -> list[str]:
        """What must not be, in words."""
        trial = self.trial
        found = {
            "the kernel accepts what is false": self.falsely_accepted,
            "the kernel refuses what is true": self.refused and self.margin > KERNEL_BAND[trial.condition],
            f"the kernel refuses for another reason: {self.verdict.reason}": self.refused_elsewhere,
            f"the models say {self.models}": self.models_disagree,
            "60 digits decide what is exactly on the edge": trial.on_the_edge and self.theory.true is not None,
        }
        where = f"fleet {trial.seed}, {trial.condition} {trial.vehicle}, margin {self.theory.margin:.2e}"
        return [f"{where}: {what}" for what, holds in found.items() if holds]


def judged(trial: Trial) -> Outcome:
    """The three judges on one fleet."""
    found = theory(trial.document)
    moved = found.pop((trial.condition, trial.vehicle))
    if not all(other.true for other in found.values()):
        raise ArithmeticError(f"fleet {trial.seed}: more than {trial.condition} of {trial.vehicle} is in question")
    truth = True if trial.on_the_edge and moved.true is None else moved.true
    return Outcome(trial, truth, moved, checked(trial.document), models_hold(trial.document))


# -- other units ------------------------------------------------------------------------------------------------------

_GAINS = dict.fromkeys(GAIN_NAMES, 1)
_TURNING = dict.fromkeys(("p_omega", "d_omega", "k_alpha"), 1)
# Powers of the factor by which the entries under a key are multiplied; the truth does not change, because ...
SCALINGS: dict[str, dict[str, int]] = {
    # ... both sides of every condition but that of the wheels are forces, moments or torques
    "force": {"mass": 1, "inertia": 1, "wheel_inertia": 1, "torque_limit": 1, **_GAINS},
    # ... p_v, p_omega and k_alpha come with D alone
    "weights": {"edges": 1, "leader_links": 1, "p_v": -1, "p_omega": -1, "k_alpha": -1},
    # ... torque comes with 1 / r, the inertia of a wheel with 1 / r^2, its speed with r
    "wheels": {"wheel_radius": 1, "torque_limit": 1, "wheel_inertia": 2, "wheel_speed": -1},
    # ... p_omega, d_omega and k_alpha come with 1 / arm alone, or with each other and the inertia
    "arm": {"half_track": 1, "inertia": 1, **_TURNING},
    # ... k_alpha comes with psi_bar alone
    "psi": {"mean": 1, "sin": 1, "cos": 1, "psi_bar": 1, "k_alpha": -1},
    # ... speeds come with their scales alone
    "speeds": dict.fromkeys((SPEED, TURN_RATE, WHEEL_SPEED, "speed_scale", "turn_rate_scale", "rim_speed"), 1),
}
MARGIN_SCALINGS: dict[str, dict[str, int]] = {
    "force": dict.fromkeys(set(CONDITIONS) - {WHEEL_SPEED, PSI_BAR}, 1),
    "wheels": {"(16*)": 1},
    "arm": dict.fromkeys(("(15)", "(15')", "(16)", TURN_RATE, TURN_ACCELERATION), 1),
    "speeds": {WHEEL_SPEED: 1},
}
SHIFTS = (-8, 8)


def possible(document: dict[str, Any], scaling: str) -> bool:
    """Whether a scaling leaves the truth as it is."""
    vehicles = document["fleet"]["vehicle"]
    if scaling == "psi":  # the amplitude of a square wave is fixed
        return bool((document["fleet"] | document["designed"])["excitation"]["family"] != "square-wave")
    if scaling == "arm":  # wheels turn by the sum of v and arm omega
        return all(v["limits"][WHEEL_SPEED] is None and v["wheel_inertia"] == "0" for v in vehicles)
    return True


def rescaled(document: dict[str, Any], scaling: str, shift: int) -> dict[str, Any]:
    """The certificate with its numbers times 10^shift, as the scaling says."""

    def times(value: Any, power: int) -> Any:
        if isinstance(value, list):
            return [times(entry, power) for entry in value]
        if isinstance(value, dict):
            return {key: times(entry, power) for key, entry in value.items()}
        named = value is None or value.startswith("v")  # a vehicle's name in an edge
        return value if named else text(Decimal(value).scaleb(power * shift))

    def walk(value: Any, powers: dict[str, int]) -> Any:
        if isinstance(value, list):
            return [walk(entry, powers) for entry in value]
        if not isinstance(value, dict):
            return value
        return {k: times(entry, powers[k]) if k in powers else walk(entry, powers) for k, entry in value.items()}

    with localcontext(PLACES):
        other = walk({key: value for key, value in document.items() if key != "margins"}, SCALINGS[scaling])
        return {**other, "margins": walk(document["margins"], MARGIN_SCALINGS.get(scaling, {}))}


class Rescaled(NamedTuple):
    """How the judges see a certificate in other units."""

    outcome: Outcome
    scaling: str
    shift: int
    same: bool  # to the kernel
    models_same: bool  # to the models

    def failures(self) -> list[str]:
        """A verdict that changed; the models may, so near to the edge that it need not decide."""
        trial, decided = self.outcome.trial, self.outcome.margin > MODELS_BAND[self.outcome.trial.condition]
        where = f"fleet {trial.seed}, {trial.condition}: {self.scaling} times 1e{self.shift} changes the verdict of"
        found = {"the kernel": not self.same, "the models": decided and not self.models_same}
        return [f"{where} {judge}" for judge, holds in found.items() if holds]


def in_other_units(outcome: Outcome) -> Iterator[Rescaled]:
    """The same fleet in every other unit."""
    document = outcome.trial.document
    for scaling in SCALINGS:
        for shift in SHIFTS if possible(document, scaling) else ():
            other = rescaled(document, scaling, shift)
            verdict = checked(other)
            same = (verdict.valid, verdict.rule) == (outcome.verdict.valid, outcome.verdict.rule)
            yield Rescaled(outcome, scaling, shift, same, models_hold(other) == outcome.models)


# -- the table --------------------------------------------------------------------------------------------------------


@dataclass
class Tally:
    """What was found."""

    outcomes: list[Outcome] = field(default_factory=list)
    scaled: list[Rescaled] = field(default_factory=list)

    @property
    def failures(self) -> list[str]:
        """One line for everything that must not be."""
        lines = [line for outcome in self.outcomes for line in outcome.failures()]
        return lines + [line for one in self.scaled for line in one.failures()]

    @property
    def falsely_accepted(self) -> int:
        """How many false statements the kernel accepts."""
        return sum(outcome.falsely_accepted for outcome in self.outcomes)


def run(count: int, first: int = 0, scale_every: int = 10, condition: str | None = None) -> Tally:
    """Judge so many fleets, and each tenth in other units too."""
    tally = Tally()
    for seed in range(first, first + count):
        outcome = judged(draw(seed, condition))
        tally.outcomes.append(outcome)
        if scale_every and seed % scale_every == 0:
            tally.scaled += in_other_units(outcome)
    return tally


HEADER = (
    "condition",
    "true",
    "false",
    "of these exactly on the edge",
    "too close for 60 digits",
    "least margin decided, true / false",
    "kernel accepts false",
    "kernel refuses true (largest margin)",
    "models disagree",
    "models undecided (largest margin)",
)


def table(tally: Tally) -> str:
    """The findings as a markdown table, one row per condition."""
    rows = [HEADER, ("---",) * len(HEADER)]
    rows += [_line(name, [o for o in tally.outcomes if o.trial.condition == name]) for name in CONDITIONS]
    rows.append(_line("all", tally.outcomes))
    return "\n".join("| " + " | ".join(map(str, row)) + " |" for row in rows)


def _line(name: str, outcomes: list[Outcome]) -> tuple[Any, ...]:
    right = [o for o in outcomes if o.truth is o.verdict.valid and not o.trial.on_the_edge]
    least = (min((o.margin for o in right if o.truth is truth), default=math.nan) for truth in (True, False))
    return (
        name,
        sum(o.truth is True for o in outcomes),
        sum(o.truth is False for o in outcomes),
        sum(o.trial.on_the_edge for o in outcomes),
        sum(o.theory.true is None and not o.trial.on_the_edge for o in outcomes),
        " / ".join(f"{margin:.0e}" for margin in least),
        sum(o.falsely_accepted for o in outcomes),
        _with_largest([o for o in outcomes if o.refused]),
        sum(o.models_disagree for o in outcomes),
        _with_largest([o for o in outcomes if o.undecided_by_models]),
    )


def _with_largest(outcomes: list[Outcome]) -> str:
    return f"{len(outcomes)} ({max(o.margin for o in outcomes):.0e})" if outcomes else "0"


def report(tally: Tally) -> str:
    """All that is printed of the findings but the time."""
    fleets = len({one.outcome.trial.seed for one in tally.scaled})
    within = sum(not one.models_same and not one.failures() for one in tally.scaled)
    scaling = (
        f"Other units: {fleets} fleets, {len(tally.scaled)} certificates ({', '.join(SCALINGS)}; times 1e-8 and 1e8): "
        f"{sum(not one.same for one in tally.scaled)} verdicts of the kernel change, {within} of the models within "
        f"their band, {sum(bool(one.failures()) for one in tally.scaled)} failures."
    )
    bands = (
        f"What is true may be refused up to a margin of {KERNEL_BAND[PSI_BAR]:.0e} by the kernel and "
        f"{MODELS_BAND[PSI_BAR]:.0e} by excitation.py for psi_bar, {KERNEL_BAND['(16*)']:.0e} by the kernel and "
        f"{MODELS_BAND['(16*)']:.0e} by the models else."
    )
    failures = tally.failures
    lines = [table(tally), "", bands, scaling]
    return "\n".join([*lines, f"{len(failures)} failures.", *(f"- {line}" for line in failures[:20])])


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("count", nargs="?", type=int, default=10_000, help="how many fleets")
    parser.add_argument("--first", type=int, default=0, help="number of the first fleet")
    parser.add_argument("--show", type=int, help="print the certificate of this fleet and what the judges say of it")
    options = parser.parse_args(arguments)
    if options.show is not None:
        outcome = judged(draw(options.show))
        print(json.dumps(outcome.trial.document, indent=1))
        print(f"theory {outcome.theory}\nkernel {outcome.verdict}\nthe models {outcome.models}")
        return bool(outcome.failures())
    begin = time.perf_counter(), time.process_time()
    tally = run(options.count, options.first)
    print(report(tally))
    spent, worked = time.perf_counter() - begin[0], time.process_time() - begin[1]
    print(f"{options.count} fleets in {spent:.0f} s, {worked:.0f} s of them on the processor.")
    return bool(tally.failures)


if __name__ == "__main__":
    sys.exit(main())
