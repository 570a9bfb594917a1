"""The content of design.json."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from fractions import Fraction
from typing import Any

from ..models.digests import controller_digest
from ..models.gains import GAIN_NAMES
from ..models.numbers import decimal_text
from ..models.saturation import Saturation
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
    controller_digest: str
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
    saturation: dict[str, Any]  # position, heading: decimals; speed, turn_rate: lists of decimals
    measured_settling_s: Measured  # from the ranking starts
    measured_settling_held_s: Measured  # the same with torques held for sample_time_s and other disturbances
    sample_time_s: float
    largest_sample_time_s: float | None  # up to which all ranking starts settle
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
            controller_digest=controller_digest(design.used_fleet, design.excitation, design.gains),
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
            saturation=_scales(design.gains.saturation, len(design.fleet)),
            measured_settling_s=[_finite(time) for time in design.settling],
            measured_settling_held_s=[_finite(time) for time in design.settling_held],
            sample_time_s=design.sample_time,
            largest_sample_time_s=design.largest_sample_time,
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


def _scales(saturation: Saturation, vehicles: int) -> dict[str, Any]:
    """The [saturation] of the file: one number per network scale, one per vehicle for the others."""
    columns = saturation.columns(vehicles)
    texts = {name: [decimal_text(Fraction(value)) for value in column] for name, column in columns.items()}
    return {name: column[0] if name in ("position", "heading") else column for name, column in texts.items()}


def _finite(value: float) -> float | None:
    """A number to six digits, in which all processors agree; None for infinity."""
    return float(f"{value:.6g}") if math.isfinite(value) else None
