"""The deployable content of a folder: the fleet, its gains and psi, and the digests that tie them together."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from .. import __version__
from ..models.arrays import Array
from ..models.conditions import exact_numbers, torque_bound
from ..models.digests import Digests, controller_digest
from ..models.errors import InputError
from ..models.excitation import Excitation
from ..models.files.fleet_file import load_fleet
from ..models.files.fleet_text import dumps
from ..models.files.gains_file import load_gains
from ..models.files.text import write_text
from ..models.fleet import Fleet
from ..models.gains import Gains
from .versions import versions

FLEET_COPY = "fleet_copy.toml"  # not fleet.toml: a fleet file of the user's own may lie in the same folder
COPIED = 20_000  # vehicles up to which a folder gets a copy of its fleet


@dataclass(frozen=True, eq=False)
class Deployment:
    """Gains that are ready for robots, and their origin."""

    fleet: Fleet  # with the links that are used
    excitation: Excitation
    gains: Gains  # exact, (N,)
    fleet_digest: str  # of the fleet file's content
    certificate_digest: str | None  # SHA-256 of certificate.json, None if there is none
    conditions: str | None
    facts: tuple[str, ...] = ()  # the certificate's theorem, in the kernel's sentences

    @cached_property
    def torque_bounds(self) -> Array:
        """T of (16*), N m, exact or rounded up, (N,): the supremum of both wheel torques."""
        return torque_bound(exact_numbers(), self.fleet.condition_data(self.excitation), self.gains)

    @cached_property
    def digests(self) -> Digests:
        """The digests for every file made from it."""
        return Digests(self.fleet_digest, controller_digest(self.fleet, self.excitation, self.gains))

    @cached_property
    def evidence(self) -> dict[str, str]:
        """The origin that every export states."""
        return {
            "gaincert": __version__,
            "casadi": versions()["casadi"],
            **self.digests.to_json(),
            "certificate_digest": self.certificate_digest or "none",
            "conditions": self.conditions or "none",
        }


def write_fleet_copy(fleet: Fleet, folder: Path) -> None:
    """Keep a copy of the fleet in the folder, so that `report` and `export` need nothing else."""
    if len(fleet) <= COPIED:
        write_text(folder / FLEET_COPY, dumps(fleet))


def fleet_of_folder(folder: Path, given: Path | None = None) -> Fleet:
    """The fleet in the given file, else the folder's copy. Raises InputError without either."""
    if given is not None:
        return load_fleet(given)
    if not (folder / FLEET_COPY).is_file():
        raise InputError(f"{folder}: holds no {FLEET_COPY}; give the fleet file with --fleet FLEET.toml")
    return load_fleet(folder / FLEET_COPY)


def load_deployment(folder: Path, fleet: Fleet) -> Deployment:
    """The deployable content of a folder for a fleet. Raises InputError if files are missing or do not match."""
    design, certificate = folder / "design.json", folder / "certificate.json"
    if not design.is_file() and not certificate.is_file():
        raise InputError(f"{folder}: holds neither design.json nor certificate.json; run gaincert design or certify")
    designed = _designed(design, fleet) if design.is_file() else None
    certified = _certified(certificate, fleet) if certificate.is_file() else None
    if designed and certified and designed.digests != certified.digests:
        raise InputError(
            f"{certificate}: does not belong to the gains in design.json; "
            f"run gaincert certify FLEET.toml --gains {design} -o {folder}"
        )
    found = certified or designed
    if found is None:  # removed since we looked
        raise InputError(f"{folder}: its files changed while they were read; try again")
    return found


def _designed(path: Path, fleet: Fleet) -> Deployment:
    chosen = load_gains(path, fleet)
    used = fleet.with_links(chosen.links)
    return Deployment(used, chosen.excitation, chosen.gains, fleet.digest, None, chosen.conditions)


def _certified(path: Path, fleet: Fleet) -> Deployment:
    """The content of a certificate, after the kernel has accepted it for this fleet."""
    from ..verify.certificates.certificate import Certificate

    certificate = Certificate.read(path, fleet)
    if not certificate.valid:
        raise InputError(f"{path}: {certificate.verdict}; certify the gains of this fleet again")
    return Deployment(
        fleet.with_links(certificate.links(fleet)),
        certificate.excitation,
        certificate.gains,
        fleet.digest,
        certificate.file_digest,
        certificate.conditions,
        certificate.facts,
    )
