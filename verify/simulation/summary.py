"""The summary of one run: the content of summary.json."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

from ...models.tolerance import Tolerance
from .disturbance import Disturbance
from .monitor import NamedPeak
from .room import Room
from .settling import Approach


class IntegrationError(NamedTuple):
    """An upper estimate of the error of an integration, over all stored points."""

    position: float  # m
    heading: float  # rad


@dataclass(frozen=True)
class Summary:
    """The results of one run of a fleet."""

    settling_time: float  # s; inf if not settled at the end
    approach: Approach  # how the error moves at the end, if not settled
    tolerance: Tolerance
    horizon: float  # s
    peak_torque_ratio: float  # |wheel torque| / its limit
    final_position_error: float  # m, the largest of the fleet
    final_heading_error: float  # rad
    max_V_increase: float  # noqa: N815 -- V of (17)
    peak_speed: float  # m/s
    peak_turn_rate: float  # rad/s
    violations: tuple[str, ...]  # broken promises of the theorem, one sentence each
    room: Room | None = None
    peak_torque: NamedPeak | None = None
    integration_error: IntegrationError | None = None
    disturbance: Disturbance | None = None  # of a disturbed run
    nominal: Summary | None = None  # beside a disturbed run: the same run without disturbance

    @property
    def settled(self) -> bool:
        """Whether the fleet has settled by the horizon."""
        return math.isfinite(self.settling_time)

    def to_json(self) -> dict[str, Any]:
        """The content of summary.json."""
        document: dict[str, Any] = {
            "settling_time_s": self.settling_time if self.settled else None,
            "approach": None if self.settled else str(self.approach),
            "tolerance": {"position_m": self.tolerance.position, "heading_rad": self.tolerance.heading},
            "horizon_s": self.horizon,
            "peak_torque_ratio": self.peak_torque_ratio,
            "final_position_error_m": self.final_position_error,
            "final_heading_error_rad": self.final_heading_error,
            "max_V_increase": self.max_V_increase,
            "peak_speed": self.peak_speed,
            "peak_turn_rate": self.peak_turn_rate,
            "violations": list(self.violations),
        }
        if self.room is not None:
            document |= self.room.to_json()
        if self.peak_torque is not None:
            document["peak_torque"] = {"time_s": self.peak_torque.time, "vehicle": self.peak_torque.vehicle}
        if self.integration_error is not None:
            document["integration_error_m"] = self.integration_error.position
            document["integration_error_rad"] = self.integration_error.heading
        if self.disturbance is not None:
            document["disturbance"] = self.disturbance.to_json()
        if self.nominal is not None:
            document["nominal"] = self.nominal.to_json()
        return document
