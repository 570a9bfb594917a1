"""Disturbances of real robots, beyond (1)-(14): sampling, delay, noise, wrong parameters, friction, a lost link."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

from ...models.errors import InputError, did_you_mean
from ...models.fleet import Fleet
from ...models.fleet_tables import DisturbanceTable

RANGES = {"sample_time": (1e-4, 10.0), "delay": (0.0, 100.0), "mismatch": (0.0, 0.9)}
_NO_NUMBERS = ("lost_link", "com_offset")
LARGEST = 1e6  # upper limit of the entries that are not in RANGES


@dataclass(frozen=True)
class Disturbance:
    """How reality differs from (1)-(14). If all but the sample time is zero, the controller is only sampled."""

    sample_time: float = 0.01  # s, between two computations of the torques
    delay: float = 0.0  # s, from measuring to the wheels; rounded to whole samples
    noise_position: float = 0.0  # m, standard deviation of each measured coordinate
    noise_heading: float = 0.0  # rad
    noise_speed: float = 0.0  # m/s and rad/s
    mismatch: float = 0.0  # relative: m, I, r and the arm differ from the controller's by up to this much
    coulomb: float = 0.0  # N m at every wheel
    viscous: float = 0.0  # N m s/rad at every wheel
    lost_link: tuple[str, str] | None = None  # vehicles; the edge between them fails
    lost_at: float = 0.0  # s
    com_offset: bool = False  # whether the centre of mass is where com_offset of each vehicle says
    seed: int = 0

    def to_json(self) -> dict[str, Any]:
        """The entries that are not zero."""
        return {name: value for name, value in vars(self).items() if value}

    def in_words(self) -> str:
        """The entries in words."""
        widths = ((self.noise_position, "m"), (self.noise_heading, "rad"), (self.noise_speed, "m/s and rad/s"))
        friction = ((self.coulomb, "N m"), (self.viscous, "N m s"))
        said = [f"torques held for {1000 * self.sample_time:g} ms"]
        if self.delay:
            said.append(f"{1000 * self.delay:g} ms of delay")
        if noise := _quantities(widths):
            said.append(f"noise of {noise}")
        if self.mismatch:
            said.append(f"parameters off by up to {100 * self.mismatch:g} %")
        if wheel := _quantities(friction):
            said.append(f"friction of {wheel} at every wheel")
        if self.com_offset:
            said.append("centres of mass off the axle")
        if self.lost_link:
            said.append(f"the link {' - '.join(self.lost_link)} lost at {self.lost_at:g} s")
        return ", ".join(said)


def _quantities(pairs: Iterable[tuple[float, str]]) -> str:
    return ", ".join(f"{value:g} {unit}" for value, unit in pairs if value)


def of_table(table: DisturbanceTable | None, seed: int = 0) -> Disturbance:
    """The [disturbance] table of a fleet file; without one, sampling alone at the default sample time."""
    if table is None:
        return Disturbance(seed=seed)
    given = {name: value for name, value in table if value is not None}
    numbers = {name: float(value) for name, value in given.items() if name not in _NO_NUMBERS}
    return Disturbance(**numbers, lost_link=table.lost_link, com_offset=table.com_offset, seed=seed)


def checked(disturbance: Disturbance, fleet: Fleet) -> Disturbance:
    """The disturbance, if its entries are in range and the fleet has the lost link. Raises InputError."""
    numbers = {key: value for key, value in vars(disturbance).items() if isinstance(value, float)}
    mistakes = [
        f"{key} = {value} must be from {low:g} to {high:g}"
        for key, value in numbers.items()
        for low, high in [RANGES.get(key, (0.0, LARGEST))]
        if not low <= value <= high
    ]
    if disturbance.lost_link is not None:
        mistakes += _lost_link_mistakes(disturbance.lost_link, fleet)
    if mistakes:
        raise InputError(*mistakes)
    return disturbance


def _lost_link_mistakes(lost: tuple[str, str], fleet: Fleet) -> list[str]:
    """Names that are no vehicles, or vehicles without an edge between them."""
    unknown = [name for name in lost if name not in fleet.names]
    if unknown:
        return [f"lost link: the fleet has no vehicle {name!r}{did_you_mean(name, fleet.names)}" for name in unknown]
    if any({a, b} == set(lost) for a, b, _ in fleet.links.edges):
        return []
    others = sorted({a if b == lost[0] else b for a, b, _ in fleet.links.edges if lost[0] in (a, b)})
    linked = f"; {lost[0]!r} is linked to {', '.join(map(repr, others[:5]))}" if others else ""
    return [f"lost link: the fleet has no edge {lost[0]!r} - {lost[1]!r}{linked}"]


def parts(disturbance: Disturbance) -> list[Disturbance]:
    """Sampling alone, each kind of disturbance that is present with it, and all together if there are several."""
    alone = Disturbance(disturbance.sample_time, seed=disturbance.seed)
    groups = (
        ("delay",),
        ("noise_position", "noise_heading", "noise_speed"),
        ("mismatch",),
        ("coulomb", "viscous"),
        ("lost_link", "lost_at"),
        ("com_offset",),
    )
    kept = [replace(alone, **{name: getattr(disturbance, name) for name in names}) for names in groups]
    single = [part for part in kept if part != alone]
    return [alone, *single, disturbance] if len(single) > 1 else [alone, *single]
