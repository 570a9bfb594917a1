"""The search space: logarithms of factors on the scalars, and on the gains and scales of single vehicles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...models.gains import GAIN_NAMES
from ..scaled_gains import SCALAR_NAMES, Scalars
from ..task import Proposal, Task, fixed_scalars

ORIGIN = "time-domain search"
GRID = 1e-4  # of points: what processors round differently is far below it

Point = NDArray[np.float64]  # the variables of the search


@dataclass(frozen=True, eq=False)
class Space:
    """Points (n,): logarithms of factors on the free scalars, then of those on separate gains and scales."""

    task: Task
    centre: Scalars  # the point 0
    free: NDArray[np.int64]  # the numbers of the scalars that are free
    groups: NDArray[np.int64]  # (N,): vehicles of one group share their separate factors; those of group 0 have none

    @classmethod
    def of(cls, task: Task) -> Space:
        """The space of the scalars that the task leaves free."""
        fixed = fixed_scalars(task)
        free = [k for k, name in enumerate(SCALAR_NAMES) if name not in fixed]
        return cls(task, task.typical, np.array(free), np.zeros(len(task.fleet), dtype=np.int64))

    @property
    def scalars(self) -> int:
        """How many variables are scalars."""
        return len(self.free)

    @property
    def size(self) -> int:
        """How many variables there are."""
        return self.scalars + int(self.groups.max(initial=0)) * self._separate

    @property
    def _separate(self) -> int:
        return len(GAIN_NAMES) + (2 if self.task.saturation is None else 0)

    def with_separate_gains(self) -> Space:
        """The space that goes on with separate gains: per vehicle in a small fleet, else per role in the graph."""
        small = len(self.task.fleet) <= self.task.settings.separate_vehicles
        groups = np.arange(len(self.task.fleet)) if small else self.task.plant.graph.roles()
        return replace(self, groups=groups)

    def extended(self, point: Point) -> Point:
        """The same point in the space with separate gains."""
        return np.concatenate([point, np.zeros(self.size - len(point))])

    def point(self, scalars: Scalars) -> Point:
        """The point of some scalars, on the grid."""
        ratios = [getattr(scalars, SCALAR_NAMES[k]) / getattr(self.centre, SCALAR_NAMES[k]) for k in self.free]
        return self.snapped(np.log(np.array(ratios)))

    def snapped(self, points: Point) -> Point:
        """The points of the grid that are nearest."""
        return np.asarray(np.rint(points / GRID) * GRID)

    def proposal(self, point: Point) -> Proposal:
        """What a point of the grid stands for, moved into the conditions."""
        factors = np.ones(len(SCALAR_NAMES))
        factors[self.free] = np.exp(point[: self.scalars])
        scalars = self.centre.scaled(factors.tolist())
        separate = np.exp(point[self.scalars :]).reshape(-1, self._separate)
        per_vehicle = np.vstack([np.ones(self._separate), separate])[self.groups].T
        return self.task.proposal(ORIGIN, scalars, per_vehicle)

    def proposals(self, points: Sequence[Point]) -> list[Proposal]:
        """Those of several points."""
        return [self.proposal(point) for point in points]
