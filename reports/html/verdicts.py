"""The tiles at the top of the report: verdicts about the files in a folder."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any, NamedTuple

from ...models.errors import InputError
from ...models.fleet import Fleet
from ...verify.simulation.disturbance import Disturbance
from ..deployment import Deployment, load_deployment
from ..results import ClaimResult, ManyStartsResult, MarginResult, RunResult, SpreadResult, say_stale

CERTIFIED = "Certified"


class Verdict(NamedTuple):
    """One tile."""

    good: bool
    title: str
    text: str
    facts: tuple[str, ...] = ()  # details that the reader can open
    heading: str = "what is proved"  # heading of the details


def certificate_verdict(folder: Path, fleet: Fleet | None) -> tuple[list[Verdict], Deployment | None]:
    """The kernel's verdict on the folder's certificate, and the deployment if all files match."""
    path = folder / "certificate.json"
    if fleet is None:
        return ([_kernel(path)] if path.is_file() else []), None
    if not path.is_file() and not (folder / "design.json").is_file():
        return [], None
    try:
        deployed = load_deployment(folder, fleet)
    except InputError as error:
        return [Verdict(False, "Not deployable", str(error))], None
    if deployed.certificate_digest is None:
        return [Verdict(False, "Not certified", "no certificate.json lies in the folder")], deployed
    text = f"conditions {deployed.conditions}; the kernel checked the certificate again for this report"
    return [Verdict(True, CERTIFIED, text, deployed.facts)], deployed


def _kernel(path: Path) -> Verdict:
    from ...verify.certificates.certify import verify

    try:
        verdict = verify(path)
    except InputError as error:
        return Verdict(False, "Not a certificate", str(error))
    title = CERTIFIED if verdict.valid else "Certificate not valid"
    return Verdict(verdict.valid, title, str(verdict.reason), verdict.theorem)


def stale_verdict(names: list[str]) -> list[Verdict]:
    """A warning that names the files left out of the report."""
    return [Verdict(False, "Left out of this report", say_stale(names))] if names else []


def run_verdicts(run: RunResult | None) -> list[Verdict]:
    """Settling and torques of the run from the fleet's own start: nominal, then with the disturbance."""
    if run is None:
        return []
    if run.nominal is None:
        return _of_run(run, f"nominal run, {run.scheme} scheme")
    words = f"with the disturbance: {in_words(run.disturbance)}"
    return [*_of_run(run.nominal, f"nominal run, {run.scheme} scheme"), *_of_run(run, words)]


def _of_run(run: RunResult, which: str) -> list[Verdict]:
    settled, peak = run.settling_time_s is not None, run.peak_torque_ratio
    title = "Torques within their limits" if peak <= 1 else "Torque limit exceeded"
    return [
        Verdict(settled, "Settles" if settled else "Does not settle", f"{which}: {_settling_text(run)}"),
        Verdict(peak <= 1, title, f"{which}: largest torque {100 * peak:.2f} % of its limit"),
    ]


def _settling_text(run: RunResult) -> str:
    tolerance = run.tolerance
    within = f"{tolerance.position_m:g} m and {tolerance.heading_rad:g} rad"
    if run.settling_time_s is None:
        errors = f"{run.final_position_error_m:.3g} m and {run.final_heading_error_rad:.3g} rad"
        approach = f" and {run.approach}" if run.approach else ""
        return f"not settled within {run.horizon_s:g} s{approach}; errors {errors} at the end, wanted {within}"
    return f"within {within} after {run.settling_time_s:.1f} s, to the end of the run at {run.horizon_s:g} s"


def many_starts_verdict(result: ManyStartsResult | None) -> list[Verdict]:
    """How many starts settle: nominal, and under each disturbance."""
    if result is None:
        return []
    count = result.starts
    horizon = f" within {result.horizon_s:g} s" if result.horizon_s else ""
    plant = "nominal" if result.plant == "model" else f"in {result.plant}, driven by the exported C controller"
    text = f"{plant}: {result.settled} of {count} settle{horizon} ({_spread_text(result.settling_time_s)})"
    if result.model is not None:
        text += f"; in the model {result.model.settled}"
    facts = [
        f"{in_words(runs.disturbance)}: {runs.settled} of {count} settle ({_spread_text(runs.settling_time_s)}), "
        f"largest torque {100 * runs.peak_torque_ratio:.1f} % of its limit"
        for runs in result.disturbed
    ]
    worst = min((runs.settled for runs in result.disturbed), default=count)
    within = all(runs.peak_torque_ratio <= 1 for runs in result.disturbed)
    if result.disturbed:
        text += f"; with disturbances: {worst} of {count} at the worst"
    facts += [_margin_fact(kind, margin) for kind, margin in result.margins.items()]
    good = result.settled == count == worst and within
    return [Verdict(good, "Many starts", text, tuple(facts), "each disturbance")]


def _margin_fact(kind: str, margin: MarginResult) -> str:
    from ...verify.validation.margins import NAMES

    largest = "none that was tried" if margin.largest is None else f"{margin.largest:.3g} {margin.unit}"
    return (
        f"largest {NAMES[kind]} with which all settle: {largest} (in the fleet file {margin.present:.3g} {margin.unit})"
    )


def _spread_text(spread: SpreadResult) -> str:
    times = {"median": spread.median, "90 % by": spread.p90, "last": spread.max}
    return ", ".join(f"{name} {'not settled' if time is None else f'{time:.4g} s'}" for name, time in times.items())


def in_words(said: dict[str, Any] | None) -> str:
    """A disturbance from a JSON file, in words. Raises TypeError for anything else."""
    return Disturbance(**(said or {})).in_words()


def proof_verdict(claims: list[ClaimResult]) -> list[Verdict]:
    """Whether the corrected theorem is proved, and the verdicts on the paper's statements."""
    if not claims:
        return []
    counts = Counter(claim.status for claim in claims)
    proved = any(claim.id == "theorem" and claim.status in ("PROVED", "FORMAL") for claim in claims)
    false = f"{counts['REFUTED']} are refuted and {counts['CORRECTED']} corrected"
    text = (
        f"{len(claims)} claims checked: {counts['PROVED']} proved, {counts['FORMAL']} formal, {counts['OPEN']} open; "
        f"of the paper's printed statements {false}"
    )
    return [Verdict(proved, "The corrected theorem is " + ("proved" if proved else "not proved"), text)]
