"""The content of design.json."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from ..models.digests import gains_digest
from ..models.gains import GAIN_NAMES
from ..models.numbers import decimal_text
from .design import Design

Decimals = list[str]  # exact decimal numbers, in the order of the fleet file
Measured = list[float | None]  # None stands for infinity


@dataclass(frozen=True)
class PredictedFile:
    """What the rates near the goal say about speed."""

    gamma_omega: float | None  # 1/s
    gamma_v: float | None  # 1/s
    kappa: float | None  # 1/(m^2 s)
    tail_time_s: float | None


@dataclass(frozen=True)
class ToleranceFile:
    """What counts as settled."""

    position_m: float
    heading_rad: float


@dataclass(frozen=True)
class DesignFile:
    """The keys of design.json; every number that is exact is a decimal string."""

    fleet: str
    fleet_digest: str
    gains_digest: str
    conditions: str
    theorem: str
    excitation: dict[str, Any]  # the [excitation] table of a fleet file
    excitation_designed: bool
    psi_bar: str
    weights: dict[str, Any] | None  # the [graph] table of a fleet file, where the weights were designed
    vehicles: list[str]
    gains: dict[str, Decimals]
    origin: str
    predicted: PredictedFile
    measured_settling_s: Measured  # on the starts of the final ranking
    tolerance: ToleranceFile
    torque_factor: float
    margins: dict[str, Measured]  # by equation
    mode: str
    seed: int
    digits: int
    versions: Mapping[str, str]

    @classmethod
    def of(cls, design: Design, versions: Mapping[str, str]) -> DesignFile:
        """The file of a design."""
        margins = {
            inequality.source: [_finite(float(margin)) for margin in inequality.margin]
            for inequality in design.inequalities()
        }
        rates, tolerance = design.rates, design.tolerance
        numbers = map(_finite, (rates.gamma_omega, rates.gamma_v, rates.kappa, rates.tail_time))
        return cls(
            fleet=design.fleet.name,
            fleet_digest=design.fleet.digest,
            gains_digest=gains_digest(design.used_fleet, design.excitation, design.gains),
            conditions=design.conditions.name,
            theorem=design.conditions.theorem,
            excitation=design.excitation.table(),
            excitation_designed=design.excitation_designed,
            psi_bar=decimal_text(design.excitation.bound),
            weights=None if design.links is None else design.links.model_dump(mode="json"),
            vehicles=design.fleet.names,
            gains={name: [decimal_text(value) for value in getattr(design.gains, name)] for name in GAIN_NAMES},
            origin=design.origin,
            predicted=PredictedFile(*numbers),
            measured_settling_s=[_finite(time) for time in design.settling],
            tolerance=ToleranceFile(tolerance.position, tolerance.heading),
            torque_factor=design.torque_factor,
            margins=margins,
            mode=design.mode,
            seed=design.seed,
            digits=design.digits,
            versions=versions,
        )

    def content(self) -> dict[str, Any]:
        """What is written as JSON."""
        return asdict(self)


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
