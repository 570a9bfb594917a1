"""The verdicts that head the report: what is true of the files in a folder, and what is not."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

from ...models.errors import InputError
from ...models.fleet import Fleet
from ..deployment import Deployment, load_deployment

CERTIFIED = "Certified"


class Verdict(NamedTuple):
    """One line of the summary."""

    good: bool
    title: str
    text: str
    facts: tuple[str, ...] = ()


def certificate_verdict(folder: Path, fleet: Fleet | None) -> tuple[list[Verdict], Deployment | None]:
    """What the kernel says of the folder's certificate now, and what can be deployed where all belongs together."""
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
    return Verdict(
        verdict.valid, CERTIFIED if verdict.valid else "Certificate not valid", str(verdict.reason), verdict.theorem
    )


def simulation_verdicts(summary: dict[str, Any] | None) -> list[Verdict]:
    """Settling and torques of the simulation."""
    if not summary:
        return []
    settled, peak = summary["settling_time_s"] is not None, float(summary["peak_torque_ratio"])
    title = "Torques within their limits" if peak <= 1 else "Torque limit exceeded"
    scheme = f" ({summary['scheme']} scheme)" if "scheme" in summary else ""
    return [
        Verdict(settled, "Settles" if settled else "Does not settle", _settling_text(summary) + scheme),
        Verdict(peak <= 1, title, f"largest torque {100 * peak:.2f} % of its limit in the simulation{scheme}"),
    ]


def _settling_text(summary: dict[str, Any]) -> str:
    tolerance = summary["tolerance"]
    within = f"{tolerance['position_m']:g} m and {tolerance['heading_rad']:g} rad"
    horizon = f"{summary['horizon_s']:g} s"
    if summary["settling_time_s"] is None:
        errors = f"{summary['final_position_error_m']:.3g} m and {summary['final_heading_error_rad']:.3g} rad"
        return f"after {horizon} the largest errors are {errors}; wanted: {within}"
    return f"within {within} after {summary['settling_time_s']:.1f} s, to the end of the run at {horizon}"


def validation_verdicts(validation: dict[str, Any] | None) -> list[Verdict]:
    """How many starts settle."""
    if not validation:
        return []
    settled, starts, times = validation["settled"], validation["starts"], validation["settling_time_s"]
    said = {key: "not settled" if times[key] is None else f"{times[key]:.4g} s" for key in ("median", "p90", "max")}
    text = f"{settled} of {starts} starts settle: median {said['median']}, 90 % by {said['p90']}, last {said['max']}"
    return [Verdict(settled == starts, "Many starts", text)]


def proof_verdict(claims: list[dict[str, Any]]) -> list[Verdict]:
    """Whether the corrected theorem is proved."""
    if not claims:
        return []
    counts: dict[str, int] = {}
    for claim in claims:
        counts[claim["status"]] = counts.get(claim["status"], 0) + 1
    theorem = next((claim for claim in claims if claim["id"] == "theorem"), None)
    proved = theorem is not None and theorem["status"] == "PROVED"
    text = f"{len(claims)} claims: " + ", ".join(
        f"{count} {status.lower()}" for status, count in sorted(counts.items())
    )
    return [Verdict(proved, "The corrected theorem is " + ("proved" if proved else "not proved"), text)]


def origin_verdict(found: dict[str, Any], fleet: Fleet | None) -> list[Verdict]:
    """A warning where the files are of different fleets."""
    digests = {name: content["fleet_digest"] for name, content in found.items() if _has_digest(content)}
    if fleet is not None:
        digests["the fleet file"] = fleet.digest
    if len(set(digests.values())) < 2:
        return []
    text = "; ".join(f"{name} {digest[:18]}" for name, digest in digests.items())
    return [Verdict(False, "The files are of different fleets", f"{text}; write them again")]


def _has_digest(content: Any) -> bool:
    return isinstance(content, dict) and isinstance(content.get("fleet_digest"), str)
