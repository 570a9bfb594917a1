"""`gaincert run`: design, certify, prove, simulate, report. Each step is the workflow of the verb of that name."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..console import Outcome
from . import certify, design, prove, simulate

if TYPE_CHECKING:
    from ..console import Printer
    from ..models.files.gains_file import GainsFile
    from ..models.fleet import Fleet
    from .design import DesignOptions
    from .simulate import Simulation


def run(printer: Printer, fleet: Fleet, options: DesignOptions, simulation: Simulation, folder: Path) -> Outcome:
    """Design and certify, then the rest of the pipeline."""
    designed = design.design_fleet(printer, fleet, options, folder)
    document = {
        "design": designed.document,
        "certificate": certify.as_json(designed.certificate, options.conditions, folder),
    }
    return _rest(printer, fleet, design.gains_of(designed.design), simulation, folder, document)


def run_given(
    printer: Printer, fleet: Fleet, gains: GainsFile, conditions: str, simulation: Simulation, folder: Path
) -> Outcome:
    """The same with gains that somebody else chose: certify them, then the rest of the pipeline."""
    certificate = certify.certify_gains(printer, fleet, gains, conditions, folder)
    document = {"certificate": certify.as_json(certificate, conditions, folder)}
    return _rest(printer, fleet, gains, simulation, folder, document)


def _rest(
    printer: Printer, fleet: Fleet, gains: GainsFile, simulation: Simulation, folder: Path, document: dict[str, Any]
) -> Outcome:
    """Prove, simulate and report; false where the certificate, the theorem or a promise of the theorem is."""
    from ..reports.html.page import write_report

    claims = prove.prove_claims(printer, fleet, folder, brief=True)
    true = document["certificate"]["valid"] and prove.theorem_holds(claims)
    if fleet.start() is None:
        printer.say("simulation: left out, because the fleet file has no start for every vehicle")
    else:
        simulated = simulate.simulate_schemes(printer, fleet, gains, simulation, folder)
        document["summary"] = simulated.document
        true = true and not simulated.false_claims
    path = write_report(folder)
    printer.say(f"report: {path}")
    return Outcome.of({**document, "report": str(path)}, true=true)
