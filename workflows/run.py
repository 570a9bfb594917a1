"""`gaincert run`: design, certify, prove, simulate, report. Each step is the workflow of the verb of that name."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ..console import Outcome
from . import certify, compare, design, prove, simulate

if TYPE_CHECKING:
    from ..console import Printer
    from ..models.fleet import Fleet
    from .design import DesignOptions
    from .simulate import Simulation


def run(printer: Printer, fleet: Fleet, options: DesignOptions, simulation: Simulation, folder: Path) -> Outcome:
    """The whole pipeline; false where the certificate, the theorem or a promise of the theorem is."""
    from ..reports.html.page import write_report

    designed = design.design_gains(printer, fleet, options)
    document = {"design": design.write_design(printer, designed, folder)}
    gains = compare.gains_of(designed)
    certificate = certify.certify_gains(printer, fleet, gains, options.conditions, folder)
    document["certificate"] = certify.as_json(certificate, options.conditions, folder)
    claims = prove.prove_claims(printer, fleet, folder, brief=True)
    true = certificate.valid and prove.theorem_holds(claims)
    if fleet.start() is None:
        printer.say("simulation: left out, because the fleet file has no start for every vehicle")
    else:
        summary = simulate.simulate_schemes(printer, fleet, gains, simulation, folder)
        document["summary"] = summary
        true = true and not summary["violations"]
    path = write_report(folder)
    printer.say(f"report: {path}")
    return Outcome.of({**document, "report": str(path)}, true=true)
