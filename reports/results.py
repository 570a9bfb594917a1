"""The results in an output folder as typed values, and which of them belong together."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError

from ..models.digests import KEYS, Digests
from ..models.errors import InputError
from ..models.fleet import digest_of
from .tables.designs_table import read_json

AGAIN = {  # file -> verb that writes it; the file that says most about the gains comes first
    "certificate.json": "certify",
    "design.json": "design",
    "summary.json": "simulate",
    "trajectory.npz": "simulate",
    "validation.json": "validate",
}


RESULTS = (*AGAIN, "proof.json")


class Part(BaseModel):
    """A part of a JSON file; keys that the report does not use are ignored."""

    model_config = ConfigDict(extra="ignore", frozen=True)


class ResultFile(Part):
    """The digests and versions in every file."""

    fleet_digest: str = ""
    controller_digest: str = ""
    versions: dict[str, str] = {}

    @property
    def digests(self) -> Digests:
        """The digests of the fleet and gains that the file belongs to."""
        return Digests(self.fleet_digest, self.controller_digest)


class Predicted(Part):
    """Rates near the goal."""

    gamma_omega: float | None  # 1/s
    gamma_v: float | None  # 1/s
    kappa: float | None  # 1/(m^2 s)


class DesignResult(ResultFile):
    """design.json."""

    fleet: str
    conditions: str
    excitation: dict[str, Any]
    psi_bar: str
    predicted: Predicted
    measured_settling_s: list[float | None]
    seed: int
    digits: int


class ToleranceResult(Part):
    """The tolerance of settled."""

    position_m: float
    heading_rad: float


class RunResult(ResultFile):
    """summary.json, or the nominal run in it."""

    settling_time_s: float | None
    approach: str | None = None  # how the error moves at the end, if the run has not settled
    tolerance: ToleranceResult
    horizon_s: float
    peak_torque_ratio: float
    final_position_error_m: float
    final_heading_error_rad: float
    scheme: str = "bounded"
    disturbance: dict[str, Any] | None = None
    nominal: RunResult | None = None  # beside a disturbed run


class SpreadResult(Part):
    """Settling times of many starts, s; None if not settled."""

    median: float | None
    p90: float | None
    max: float | None
    each: list[float | None]


class DisturbedResult(Part):
    """All starts under one disturbance."""

    disturbance: dict[str, Any]
    settled: int
    settling_time_s: SpreadResult
    peak_torque_ratio: float


class SettledResult(Part):
    """How many starts settle."""

    settled: int


class MarginResult(Part):
    """The largest value of a disturbance with which all starts settle."""

    largest: float | None
    present: float
    unit: str
    tried: tuple[float, float]


class ManyStartsResult(ResultFile):
    """validation.json."""

    starts: int
    settled: int
    settling_time_s: SpreadResult
    plant: str = "model"
    model: SettledResult | None = None  # beside MuJoCo
    horizon_s: float | None = None
    disturbed: list[DisturbedResult] = []
    margins: dict[str, MarginResult] = {}  # kind -> margin


class ClaimResult(Part):
    """A claim of proof.json."""

    id: str
    source: str
    statement: str
    status: str
    method: str
    reason: str
    needs: list[str] = []
    corrected: str | None = None
    witness: str | None = None
    mathml: dict[str, str] = {}


@dataclass(frozen=True)
class Results:
    """The files of a folder that the report reads."""

    folder: Path
    design: DesignResult | None
    certificate: dict[str, Any] | None  # not parsed here: the kernel reads it
    run: RunResult | None
    many_starts: ManyStartsResult | None
    claims: list[ClaimResult] = field(default_factory=list)

    @property
    def empty(self) -> bool:
        """Whether there is nothing to report on."""
        return not (self.design or self.certificate or self.run or self.many_starts or self.claims)

    def without(self, names: list[str]) -> Results:
        """The same results without these files."""
        return Results(
            self.folder,
            None if "design.json" in names else self.design,
            None if "certificate.json" in names else self.certificate,
            None if "summary.json" in names else self.run,
            None if "validation.json" in names else self.many_starts,
            self.claims,
        )


Model = TypeVar("Model")


def read_results(folder: Path) -> Results:
    """The results in a folder. Raises InputError if a file is not JSON or was written by another version."""
    certificate = read_json(folder / "certificate.json")
    return Results(
        folder,
        _read(folder / "design.json", DesignResult),
        certificate if isinstance(certificate, dict) else {"not": "a certificate"} if certificate else None,
        _read(folder / "summary.json", RunResult),
        _read(folder / "validation.json", ManyStartsResult),
        _read(folder / "proof.json", list[ClaimResult]) or [],
    )


def _read(path: Path, kind: type[Model]) -> Model | None:
    content = read_json(path)
    if content is None:
        return None
    adapter: TypeAdapter[Model] = TypeAdapter(kind)
    try:
        return adapter.validate_python(content)
    except (ValidationError, RecursionError) as error:
        reason = ""
        if isinstance(error, ValidationError):
            first = error.errors()[0]
            reason = f" ({'.'.join(map(str, first['loc'])) or 'the whole'}: {first['msg']})"
        raise InputError(f"{path}: was not written by this version{reason}; write it again") from None


def current_digests(folder: Path) -> Digests | None:
    """The digests of the fleet and gains in this folder, from the first file that has them; else None."""
    found = (_digests_of(folder / name) for name in AGAIN if (folder / name).is_file())
    return next((digests for digests in found if all(digests)), None)


def stale_files(folder: Path, current: Digests) -> list[str]:
    """The files in a folder whose digests of fleet and gains are missing or differ from the current ones."""
    return [name for name in AGAIN if (folder / name).is_file() and _digests_of(folder / name) != current]


def _digests_of(path: Path) -> Digests:
    """The digests in a file; empty texts if it has none or cannot be read."""
    from ..verify.simulation.trajectory import read_labels

    try:
        content = read_labels(path, KEYS) if path.suffix == ".npz" else read_json(path)
    except InputError:
        return Digests("", "")
    if path.name == "certificate.json" and isinstance(content, dict):
        # The kernel computes the fleet's digest. It does not read the digest of the gains.
        provenance = content.get("provenance")
        gains = provenance.get("controller_digest") if isinstance(provenance, dict) else None
        content = dict(zip(KEYS, (digest_of(content.get("fleet")), gains), strict=True))
    return Digests.of_json(content if isinstance(content, dict) else {})


def say_stale(names: list[str]) -> str:
    """The remedy for stale files, as a sentence; empty without any."""
    if not names:
        return ""
    verbs = ", ".join(dict.fromkeys(f"gaincert {AGAIN[name]}" for name in names))
    verb = "are" if len(names) > 1 else "is"
    return f"{', '.join(names)} {verb} from other gains or another fleet: run {verbs} again"
