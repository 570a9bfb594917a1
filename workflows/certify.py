"""`gaincert certify`: the certificate of gains, whoever chose them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from .inputs import check_folder

if TYPE_CHECKING:
    from ..console import Printer
    from ..models.files.gains_file import GainsFile
    from ..models.fleet import Fleet
    from ..verify.certificates.certify import Certificate


def certify_gains(printer: Printer, fleet: Fleet, gains: GainsFile, conditions: str, folder: Path) -> Certificate:
    """Write certificate.json if the gains meet the conditions; else print which condition is broken."""
    from ..reports.deployment import write_fleet_copy
    from ..verify.certificates.certify import certify

    check_folder(folder)
    certificate = certify(fleet, gains.excitation, gains.gains, conditions, links=gains.links)
    path = folder / "certificate.json"
    if certificate.valid:
        certificate.write(path)
        write_fleet_copy(fleet, folder)
        printer.say(f"certificate: {path}")
    else:
        broken = certificate.violations or (certificate.verdict,)
        printer.say("not certified:", *map(str, broken))
        if path.is_file():
            printer.say(f"{path} is older and belongs to other gains or conditions")
    printer.detail(*(f"note: {note}" for note in certificate.notes))
    return certificate


def as_json(certificate: Certificate, conditions: str, folder: Path) -> dict[str, Any]:
    """The JSON document of `certify`."""
    return {
        "valid": certificate.valid,
        "conditions": conditions,
        "certificate": str(folder / "certificate.json") if certificate.valid else None,
        "failures": [str(violation) for violation in certificate.violations],
        "notes": list(certificate.notes),
    }
