"""The result of one start: a line of the results file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..simulation.monitor import NamedPeak


@dataclass(frozen=True)
class Measurement:
    """The measurements of the run from one start."""

    settling_time: float | None  # s; None if not settled at the horizon
    torque_ratio: NamedPeak  # |torque| divided by its limit
    speed: NamedPeak  # |v|, m/s
    turn_rate: NamedPeak  # |omega|, rad/s
    final_position_error: float  # m, the largest of the fleet
    final_heading_error: float  # rad
    max_V_increase: float  # noqa: N815 -- V of (17)
    physical_limit: float  # s, see validate.physical_limit
    sensitivity: float | None  # m, see ChaosAware; None under other integrators


@dataclass(frozen=True)
class StartResult:
    """One start: its measurements, or why the integrator gave up."""

    start: int  # its number
    measurement: Measurement | None  # None if the integrator gave up
    failure: str | None  # why the start counts as not settled
    violations: tuple[str, ...] = ()  # broken promises of the theorem, one sentence each

    @property
    def settling_time(self) -> float | None:
        """The settling time, s; None if the start did not settle."""
        return self.measurement.settling_time if self.measurement else None

    def to_json(self) -> dict[str, Any]:
        """The line of the results file."""
        document = {"start": self.start, "settling_time_s": self.settling_time, "failure": self.failure}
        measured = self.measurement
        if measured is None:
            return {**document, "gave_up": True, "violations": list(self.violations)}
        return {
            **document,
            "peak_torque_ratio": peak_to_json(measured.torque_ratio),
            "peak_speed": peak_to_json(measured.speed),
            "peak_turn_rate": peak_to_json(measured.turn_rate),
            "final_position_error_m": measured.final_position_error,
            "final_heading_error_rad": measured.final_heading_error,
            "max_V_increase": measured.max_V_increase,
            "physical_limit_s": measured.physical_limit,
            "violations": list(self.violations),
            "sensitivity_m": measured.sensitivity,
        }

    @classmethod
    def from_json(cls, line: dict[str, Any]) -> StartResult:
        """The result in a line of the results file. Raises KeyError, TypeError or ValueError for any other line."""
        number, violations = int(line["start"]), tuple(line["violations"])
        if line.get("gave_up"):
            return cls(number, None, line["failure"], violations)
        measurement = Measurement(
            settling_time=line["settling_time_s"],
            torque_ratio=peak_from_json(line["peak_torque_ratio"]),
            speed=peak_from_json(line["peak_speed"]),
            turn_rate=peak_from_json(line["peak_turn_rate"]),
            final_position_error=line["final_position_error_m"],
            final_heading_error=line["final_heading_error_rad"],
            max_V_increase=line["max_V_increase"],
            physical_limit=line["physical_limit_s"],
            sensitivity=line["sensitivity_m"],
        )
        return cls(number, measurement, line["failure"], violations)


def peak_to_json(peak: NamedPeak) -> dict[str, Any]:
    """A peak in JSON."""
    return {"value": peak.value, "time_s": peak.time, "vehicle": peak.vehicle}


def peak_from_json(entry: dict[str, Any]) -> NamedPeak:
    """The peak of `peak_to_json`."""
    return NamedPeak(entry["value"], entry["time_s"], entry["vehicle"])
