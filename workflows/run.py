"""`gaincert run`: design, certify, prove, simulate, report. Each step is the workflow of the verb of that name."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..console import Outcome
from . import certify, design, prove, simulate
from .obstacles import confirmed, obstacles_of, say_obstacles, say_slips

if TYPE_CHECKING:
    from ..console import Printer
    from ..models.files.gains_file import GainsFile
    from ..models.fleet import Fleet
    from ..reports.obstacles import Obstacle
    from .design import DesignOptions
    from .simulate import Simulation


@dataclass(frozen=True)
class Pipeline:
    """All steps for one fleet into one folder.

    The outcome is false if the certificate is not valid, the theorem is not proved, a run breaks a promise, or the
    robots cannot use the gains.
    """

    printer: Printer
    fleet: Fleet
    simulation: Simulation
    folder: Path

    def run(self, options: DesignOptions) -> Outcome:
        """Design and certify, then the rest."""
        designed = design.design_fleet(self.printer, self.fleet, options, self.folder)
        certificate = certify.as_json(designed.certificate, options.conditions, self.folder)
        gains, document = design.gains_of(designed.design), {"design": designed.document, "certificate": certificate}
        return self._rest(gains, document, designed.obstacles)

    def run_given(self, gains: GainsFile, conditions: str) -> Outcome:
        """Certify gains that somebody else chose, then the rest."""
        say_slips(self.printer, self.fleet)
        certificate = certify.certify_gains(self.printer, self.fleet, gains, conditions, self.folder)
        obstacles = obstacles_of(self.printer, self.fleet, gains, self.simulation.tolerance)
        document = {"certificate": certify.as_json(certificate, conditions, self.folder)}
        return self._rest(gains, document, obstacles)

    def _rest(self, gains: GainsFile, document: dict[str, Any], obstacles: list[Obstacle]) -> Outcome:
        """Prove, simulate, report."""
        from ..reports.html.page import write_report

        printer, fleet, folder = self.printer, self.fleet, self.folder
        claims = prove.prove_claims(printer, fleet, folder, brief=True)
        true = document["certificate"]["valid"] and prove.theorem_holds(claims)
        if fleet.start() is None:
            printer.say("simulation: left out, because the fleet file has no start for every vehicle")
        else:
            simulated = simulate.simulate_schemes(printer, fleet, gains, self.simulation, folder)
            document["summary"] = simulated.document
            true = true and not simulated.false_claims
            if simulated.summary.disturbance is not None and simulated.summary.settled:
                obstacles = confirmed(printer, obstacles, "the vehicles of this run")
            obstacles = [*obstacles, *simulated.obstacles]
        path = write_report(folder)
        printer.say(f"report: {path}")
        say_obstacles(printer, obstacles)
        content = {**document, "report": str(path), "obstacles": list(map(str, obstacles))}
        return Outcome.of(content, true=true and not obstacles)
