"""The statistics of many starts: the content of validation.json."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from .robustness import UNTRIED, Robustness
from .spread import Spread
from .start_result import Measurement, StartResult, peak_to_json
from .validate import ValidationSpec

SENSITIVE = 0.5  # m between two very accurate runs of a start: above it the settling time depends on rounding
PRINTED = 5  # failures and violations that are printed


class Violation(NamedTuple):
    """A broken promise of the theorem."""

    start: int
    what: str


@dataclass(frozen=True)
class ValidationResults:
    """The results of all starts and their statistics."""

    spec: ValidationSpec
    results: Sequence[StartResult]
    seed: int | None  # of random starts; None for starts from a file
    robustness: Robustness = UNTRIED

    @property
    def times(self) -> list[float | None]:
        """The settling time of each start, s."""
        return [result.settling_time for result in self.results]

    @property
    def settled(self) -> int:
        """How many starts settle."""
        return sum(time is not None for time in self.times)

    @property
    def failures(self) -> list[StartResult]:
        """The starts that do not settle."""
        return [result for result in self.results if result.failure]

    @property
    def violations(self) -> list[Violation]:
        """All broken promises."""
        return [Violation(result.start, what) for result in self.results for what in result.violations]

    @property
    def sensitive(self) -> list[int]:
        """The starts whose settling times depend on rounding."""
        return [number for number, measured in self._measured if (measured.sensitivity or 0) > SENSITIVE]

    @property
    def worst(self) -> tuple[int, Measurement] | None:
        """The start with the largest torque ratio; None if no start was measured."""
        return max(self._measured, key=lambda entry: entry[1].torque_ratio.value, default=None)

    @property
    def ratios(self) -> list[float]:
        """Settling time divided by the physical limit, of each start that settles."""
        return [m.settling_time / m.physical_limit for _, m in self._measured if m.settling_time]

    @property
    def _measured(self) -> list[tuple[int, Measurement]]:
        return [(result.start, result.measurement) for result in self.results if result.measurement]

    def to_json(self) -> dict[str, Any]:
        """The content of validation.json, except versions."""
        worst, measured, ratios = self.worst, [measured for _, measured in self._measured], self.ratios
        content = self.spec.content
        return {
            "starts": len(self.results),
            "settled": self.settled,
            "settling_time_s": {**Spread.of(self.times)._asdict(), "each": self.times},
            "ratio_to_physical_limit": {
                "median": statistics.median(ratios) if ratios else None,
                "max": max(ratios, default=None),
            },
            "peak_torque_ratio": worst and worst[1].torque_ratio.value,
            "peak_torque": worst and {"start": worst[0], **peak_to_json(worst[1].torque_ratio)},
            "peak_speed": max((one.speed.value for one in measured), default=None),
            "peak_turn_rate": max((one.turn_rate.value for one in measured), default=None),
            "max_V_increase": max((one.max_V_increase for one in measured), default=None),
            "sensitive": self.sensitive,
            "failures": [_failure(result) for result in self.failures],
            "violations": [violation._asdict() for violation in self.violations],
            "seed": self.seed,
            "question": self.spec.key,
            **{key: content[key] for key in ("fleet_digest", "tolerance", "horizon_s", "starts_from")},
            "integrator": content["integrator"],
            **self.robustness.to_json(),
        }

    def sentences(self) -> list[str]:
        """The statistics as sentences."""
        lines = [self._settling()]
        if ratios := self.ratios:
            lines.append(
                f"that is {statistics.median(ratios):.3g} times the physical limit (median over the starts that settle)"
            )
        if (worst := self.worst) is not None:
            peak, speed = worst[1].torque_ratio, max(measured.speed.value for _, measured in self._measured)
            lines.append(
                f"peak torque {100 * peak.value:.2f} % of the limit (vehicle {peak.vehicle!r}, "
                f"start {worst[0]}, {peak.time:.3g} s), peak speed {speed:.3g} m/s"
            )
        if self.sensitive:
            lines.append(
                f"{len(self.sensitive)} of {len(self.results)} starts are chaotic at first: rounding errors decide "
                "their settling times, and only the statistics over all starts mean something"
            )
        lines += [f"FALSE: start {number}: {what}" for number, what in self.violations[:PRINTED]]
        lines += [f"start {result.start}: {result.failure}" for result in self.failures[:PRINTED]]
        hidden = len(self.failures) - PRINTED
        if hidden > 0:
            lines.append(f"and {hidden} more, in validation.json")
        return [*lines, *self.robustness.sentences()]

    def _settling(self) -> str:
        spread, tolerance = Spread.of(self.times)._asdict(), self.spec.tolerance
        median, p90, latest = ("not settled" if time is None else f"{time:.4g} s" for time in spread.values())
        return (
            f"{self.settled} of {len(self.results)} starts settle within {tolerance.position:g} m and "
            f"{tolerance.heading:g} rad by {self.spec.horizon:g} s: median {median}, 90 % by {p90}, slowest {latest}"
        )


def _failure(result: StartResult) -> dict[str, Any]:
    entry: dict[str, Any] = {"start": result.start, "failure": result.failure}
    measured = result.measurement
    if measured is None:
        return {**entry, "gave_up": True}
    return {
        **entry,
        "final_position_error_m": measured.final_position_error,
        "final_heading_error_rad": measured.final_heading_error,
    }
