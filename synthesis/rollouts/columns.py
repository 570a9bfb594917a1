"""Rollouts side by side: what all integrators of the closed loop have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import casadi as ca

from ...models.equations import Plant
from ...models.excitation import Excitation
from ...models.tolerance import Tolerance
from ..settings import Settings
from .closed_loop import Controls, rows
from .disturbance import Disturbance
from .runge_kutta import Array

POSE = 3  # the rows of a state that say where a vehicle is


@dataclass(frozen=True, eq=False)
class Setup:
    """What all rollouts of a fleet share."""

    plant: Plant  # floats, in coordinates in which every vehicle's goal is the origin
    excitation: Excitation  # the shape of psi; its frequency is that of the controls
    tolerance: Tolerance
    disturbance: Disturbance
    settings: Settings

    @property
    def vehicles(self) -> int:
        """N."""
        return self.plant.graph.vehicles

    @property
    def near(self) -> Setup:
        """The same with the part of the tolerance that near starts have to settle within."""
        part = self.settings.near_tolerance
        return replace(self, tolerance=Tolerance(part * self.tolerance.position, part * self.tolerance.heading))

    @cached_property
    def goal(self) -> Array:
        """Every vehicle's goal, (3, N) singles."""
        return rows([0.0, 0.0, self.plant.leader_theta], self.vehicles)

    @cached_property
    def within(self) -> Array:
        """How far from it is tolerated, (3, N) singles: m, m, rad."""
        position, heading = self.tolerance.position, self.tolerance.heading
        return rows([position, position, heading], self.vehicles)

    @cached_property
    def units(self) -> Array:
        """Of the state, (5, N) singles: the tolerance, and the tolerance in a time of some samples."""
        position, heading = self.tolerance.position, self.tolerance.heading
        time = self.settings.speed_unit * self.disturbance.sample_time
        return rows([position, position, heading, position / time, heading / time], self.vehicles)

    @property
    def sizes(self) -> dict[str, int]:
        """How many items of every kind the loops of a program run over."""
        return {"one": 1, "vehicles": self.vehicles, "edges": self.plant.graph.edges, "values": 5 * self.vehicles}


class Columns(ABC):
    """Rollouts at work, each a column with its own controller; they begin together."""

    cost: int  # evaluations of the controller that a step counts as

    @abstractmethod
    def __init__(self, setup: Setup, controls: Controls, state: Array) -> None:
        """Begin at the states (5, N, B); `controls` has a fleet for every column."""

    @abstractmethod
    def advance(self, steps: int) -> None:
        """Let every column go on by so many steps."""

    @abstractmethod
    def keep(self, stay: Array) -> None:
        """Go on with these columns, (B,) of bool, alone."""

    @property
    @abstractmethod
    def t(self) -> Array:
        """The time of every column, (B,), s."""

    @property
    @abstractmethod
    def last(self) -> Array:
        """When each was last seen outside the tolerance, (B,), s."""

    @property
    @abstractmethod
    def far(self) -> Array:
        """The largest squared error over its tolerance now, (B,)."""

    @property
    @abstractmethod
    def failed(self) -> Array:
        """Whether an integration has broken down, (B,)."""


def excess(pose: Any, goal: Any, within: Any) -> Any:
    """The larger squared error of a pose (3,) over its tolerance, that of the position or of the heading, in CasADi."""
    x, y, theta = ca.vertsplit(((pose - goal) / within) ** 2)
    return ca.fmax(x + y, theta)


def fraction(turns: Any) -> Any:
    """What is left of some turns without the full ones, in CasADi."""
    return turns - ca.floor(turns)
