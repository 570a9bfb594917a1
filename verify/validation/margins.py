"""`validate --margins`: how large each disturbance may become before a start no longer settles."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from ...models.equations import State
from ...models.errors import UndecidedError
from ..simulation.disturbance import Disturbance
from ..simulation.sampled_loop import SampledLoop

HALVINGS = 8  # of every search: the answer is within 3 % of a range of three decades

NAMES = {  # of the kinds that are searched, for a reader
    "sample_time": "sample time",
    "delay": "delay",
    "coulomb": "friction at every wheel",
    "noise_position": "noise of positions",
}

Progress = Callable[[str, float], None]


class Search(NamedTuple):
    """One kind of disturbance, and the values that are tried."""

    kind: str  # an entry of the [disturbance] table
    unit: str
    low: float
    high: float

    @property
    def name(self) -> str:
        """The kind for a reader."""
        return NAMES[self.kind]


@dataclass(frozen=True)
class Margin:
    """The largest value of one disturbance with which all starts settle within the torque limits."""

    search: Search
    present: float  # the value in the fleet file
    largest: float | None  # None: they do not settle even with the smallest value that is tried

    def to_json(self) -> dict[str, Any]:
        """The entry of "margins" in validation.json."""
        search = self.search
        tried = [search.low, search.high]
        return {"largest": self.largest, "present": self.present, "unit": search.unit, "tried": tried}

    def sentence(self) -> str:
        """The same for a reader."""
        search = self.search
        if self.largest is None:
            return f"margins: not all starts settle with any {search.name} from {search.low:.3g} {search.unit}"
        return f"margins: all starts settle with {search.name} up to {self.largest:.3g} {search.unit}"


def margins(sampled: SampledLoop, starts: Sequence[State], progress: Progress) -> list[Margin]:
    """The margin of each kind by bisection on a logarithmic scale, with all other disturbances on.

    This assumes that less of a disturbance is never worse.
    """
    found = []
    searches = searches_for(sampled)
    for number, search in enumerate(searches):
        progress(f"largest {search.name}", number / len(searches))
        largest = _largest(sampled, starts, search)
        found.append(Margin(search, getattr(sampled.disturbance, search.kind), largest))
    return found


def searches_for(sampled: SampledLoop) -> list[Search]:
    """The kinds and their ranges: noise in tolerances, friction in torque limits."""
    motor = float(min(sampled.loop.torque_left.min(), sampled.loop.torque_right.min()))
    position = sampled.tolerance.position
    return [
        Search("sample_time", "s", 2e-3, 2.0),
        Search("delay", "s", sampled.disturbance.sample_time, 1000 * sampled.disturbance.sample_time),
        Search("coulomb", "N m", 1e-3 * motor, motor),
        Search("noise_position", "m", 1e-2 * position, 10 * position),
    ]


def with_value(sampled: SampledLoop, kind: str, value: float) -> SampledLoop:
    """The same loop with another value of one disturbance; noise of headings grows with that of positions."""
    changes: dict[str, Any] = {kind: value}
    if kind == "noise_position":
        changes["noise_heading"] = value * _heading_noise(sampled)
    return replace(sampled, disturbance=replace(sampled.disturbance, **changes))


def _heading_noise(sampled: SampledLoop) -> float:
    """Noise of headings per noise of positions, rad/m: that of the fleet file, else that of the tolerances."""
    noise: Disturbance = sampled.disturbance
    if noise.noise_position:
        return noise.noise_heading / noise.noise_position
    return sampled.tolerance.heading / sampled.tolerance.position


def _largest(sampled: SampledLoop, starts: Sequence[State], search: Search) -> float | None:
    def acceptable(value: float) -> bool:
        try:
            return with_value(sampled, search.kind, value).outcomes(starts).acceptable
        except UndecidedError:
            return False

    low, high, largest = math.log(search.low), math.log(search.high), None
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        if acceptable(math.exp(middle)):
            low, largest = middle, math.exp(middle)
        else:
            high = middle
    return largest
