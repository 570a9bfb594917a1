"""How a validated design behaves under disturbances: the part of validation.json about real robots."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from ...models.equations import State
from ...models.fleet import Fleet
from ..simulation.disturbance import Disturbance, parts
from ..simulation.sampled_loop import Outcomes, SampledLoop
from .margins import Margin, margins
from .spread import Spread
from .start_result import StartResult
from .validate import ValidationSpec

Progress = Callable[[str, float], None]


@dataclass(frozen=True, eq=False)
class DisturbedRuns:
    """All starts under one disturbance, beside their nominal settling times (s, None if not settled)."""

    disturbance: Disturbance
    outcomes: Outcomes
    nominal: Sequence[float | None]

    @property
    def times(self) -> list[float | None]:
        """The settling time of each start, s; None if it did not settle."""
        return [float(time) if time < float("inf") else None for time in self.outcomes.settling_time]

    @property
    def delays(self) -> list[float]:
        """How much later each start settles, s, for starts that settle in both runs."""
        return [a - b for a, b in zip(self.times, self.nominal, strict=True) if a is not None and b is not None]

    def to_json(self) -> dict[str, Any]:
        """An entry of "disturbed" in validation.json."""
        later = self.delays
        return {
            "disturbance": self.disturbance.to_json(),
            "settled": sum(time is not None for time in self.times),
            "settling_time_s": {**Spread.of(self.times)._asdict(), "each": self.times},
            "later_than_nominal_s": {"median": statistics.median(later), "max": max(later)} if later else None,
            "peak_torque_ratio": float(self.outcomes.torque_ratio.max()),
            "final_position_error_m": float(self.outcomes.final_position.max()),
            "final_heading_error_rad": float(self.outcomes.final_heading.max()),
        }

    def sentence(self) -> str:
        """The same for a reader."""
        later = self.delays
        return (
            f"with {self.disturbance.in_words()}: {sum(time is not None for time in self.times)} settle"
            + (f", {statistics.median(later):+.3g} s later than without (median)" if later else "")
            + f", peak torque {100 * self.outcomes.torque_ratio.max():.2f} %"
        )


@dataclass(frozen=True, eq=False)
class Robustness:
    """The results of a design under disturbances."""

    disturbed: tuple[DisturbedRuns, ...] = ()
    margins: tuple[Margin, ...] = ()  # empty unless asked for

    def to_json(self) -> dict[str, Any]:
        """The entries of validation.json."""
        document: dict[str, Any] = {}
        if self.disturbed:
            document["disturbed"] = [runs.to_json() for runs in self.disturbed]
        if self.margins:
            document["margins"] = {margin.search.kind: margin.to_json() for margin in self.margins}
        return document

    def sentences(self) -> list[str]:
        """The same for a reader."""
        found: list[DisturbedRuns | Margin] = [*self.disturbed, *self.margins]
        return [one.sentence() for one in found]


UNTRIED = Robustness()


def robustness(
    fleet: Fleet,
    spec: ValidationSpec,
    starts: Sequence[State],
    results: Sequence[StartResult],
    *,
    disturbance: Disturbance | None,
    search: bool,
    progress: Progress = lambda _what, _fraction: None,
) -> Robustness:
    """Each kind of disturbance against the nominal results of the same starts, and the margins if `search` says so."""

    def sampled(real: Disturbance) -> SampledLoop:
        return SampledLoop(fleet, spec.loop, real, spec.horizon, spec.tolerance)

    nominal = [result.settling_time for result in results]
    disturbed = []
    tried = parts(disturbance) if disturbance is not None else []
    for number, part in enumerate(tried):
        progress("disturbed runs", number / len(tried))
        disturbed.append(DisturbedRuns(part, sampled(part).outcomes(starts), nominal))
    if not search:
        return Robustness(tuple(disturbed))
    return Robustness(tuple(disturbed), tuple(margins(sampled(disturbance or Disturbance()), starts, progress)))
