"""What the robots of a ranking add to (1)-(14): torques that are held, and what the fleet's [disturbance] says."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ...models.equations import Plant
from ...models.fleet import Fleet
from ...models.tolerance import Tolerance
from ..settings import Settings
from .runge_kutta import Array

NOISE_NUMBERS = 4_000_000  # of the table that noise is read from
NOISE_SAMPLES = 1024  # rows of it at most; then it begins anew
NOISE_BLOCK = 8  # samples that may be read without a break: so many of the first rows are repeated at the end
SEED = 0  # of noise and mismatch: the same for all candidates


@dataclass(frozen=True)
class Disturbance:
    """How the robots of a ranking differ from the model."""

    sample_time: float  # s, for which torques are held
    delay: int = 0  # samples from measuring to the wheels
    noise_position: float = 0.0  # m, standard deviation of each measured coordinate
    noise_heading: float = 0.0  # rad
    noise_speed: float = 0.0  # m/s and rad/s
    mismatch: float = 0.0  # relative: m, I, r and the arm differ from the controller's by up to this much
    coulomb: float = 0.0  # N m at every wheel
    viscous: float = 0.0  # N m s/rad at every wheel
    lost_edge: int | None = None  # that fails
    lost_at: float = 0.0  # s

    @classmethod
    def of(cls, fleet: Fleet, tolerance: Tolerance, settings: Settings) -> Disturbance:
        """What the fleet's [disturbance] says; without one, torques held and noise of a part of the tolerance."""
        table = fleet.disturbance
        if table is None:
            noise_position = settings.noise_position * tolerance.position
            return cls(settings.sample_time, 0, noise_position, settings.noise_heading * tolerance.heading)
        sample_time = settings.sample_time if table.sample_time is None else float(table.sample_time)
        ends = set(table.lost_link or ())
        lost = [k for k, edge in enumerate(fleet.links.edges) if set(edge[:2]) == ends]
        return cls(
            sample_time=sample_time,
            delay=round(float(table.delay) / sample_time),
            noise_position=float(table.noise_position),
            noise_heading=float(table.noise_heading),
            noise_speed=float(table.noise_speed),
            mismatch=float(table.mismatch),
            coulomb=float(table.coulomb),
            viscous=float(table.viscous),
            lost_edge=lost[0] if lost else None,
            lost_at=float(table.lost_at),
        )

    @property
    def friction(self) -> bool:
        """Whether the wheels have any."""
        return self.coulomb > 0 or self.viscous > 0

    def true_plant(self, plant: Plant) -> Plant:
        """The vehicles as they are, where the controller knows them as `plant`."""
        random = np.random.default_rng(SEED)
        factors = 1 + random.uniform(-self.mismatch, self.mismatch, (4, plant.graph.vehicles))
        names = ("m", "inertia", "r", "arm")
        return replace(plant, **{name: getattr(plant, name) * row for name, row in zip(names, factors, strict=True)})

    def noise(self, vehicles: int) -> Array | None:
        """White noise of the measured states, (samples + NOISE_BLOCK, 5, N) singles; None where there is none."""
        position, heading, speed = self.noise_position, self.noise_heading, self.noise_speed
        if not (position or heading or speed):
            return None
        samples = min(NOISE_SAMPLES, max(NOISE_BLOCK, NOISE_NUMBERS // (5 * vehicles)))
        widths = np.array([position, position, heading, speed, speed])[:, None]
        noise = widths * np.random.default_rng(SEED).standard_normal((samples, 5, vehicles))
        return np.asarray(np.concatenate([noise, noise[:NOISE_BLOCK]]), dtype=np.float32)
