"""The fleet: vehicles, leader, links and excitation, validated, with exact numbers."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterable
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator
from pydantic_core import PydanticCustomError

from .excitation import Excitation
from .graph import Graph
from .numbers import NotNegative, Number, Positive, Uncertain, high, low, nominal

if TYPE_CHECKING:
    from .equations import Plant, State
    from .limits import Limits
    from .ops import Array

Name = Annotated[str, Field(min_length=1, max_length=64)]
Point = tuple[Number, Number]


class Table(BaseModel):
    """A table of a fleet file: unknown keys are errors, values are frozen."""

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True, ignored_types=(cached_property,))


class Pose(Table):
    """A position (m) and a heading, in rad or in degrees."""

    position: Point
    heading: Number | None = None  # rad
    heading_deg: Number | None = None

    @model_validator(mode="after")
    def _one_heading(self) -> Pose:
        if (self.heading is None) == (self.heading_deg is None):
            raise PydanticCustomError("heading", "must have exactly one of heading (rad) and heading_deg")
        return self

    @property
    def theta(self) -> float:
        """The heading in rad."""
        return math.radians(self.heading_deg) if self.heading is None else float(self.heading)  # type: ignore[arg-type]


class Leader(Pose):
    """The static leader: z_l (m) and theta_l."""


class Start(Pose):
    """The initial state of a vehicle, for simulation."""

    v: Number = Fraction(0)  # m/s
    omega: Number = Fraction(0)  # rad/s


def _both_wheels(value: Any) -> Any:
    return value if isinstance(value, (dict, TorqueLimit)) else {"left": value, "right": value}


class TorqueLimit(Table):
    """The torque limits of the two wheels, N m."""

    left: Uncertain
    right: Uncertain


class SpeedLimits(Table):
    """Limits that a certificate is to prove."""

    speed: Positive | None = None  # m/s
    turn_rate: Positive | None = None  # rad/s


class Vehicle(Table):
    """One differential-drive vehicle; a physical parameter is a number or an interval [low, high]."""

    name: Name
    mass: Uncertain  # kg
    inertia: Uncertain  # kg m^2, about the centre
    half_track: Uncertain  # R, m
    wheel_radius: Uncertain  # r, m
    torque_limit: Annotated[TorqueLimit, BeforeValidator(_both_wheels)]
    offset: Point  # delta, m
    start: Start | None = None
    limits: SpeedLimits = SpeedLimits()


class SquareWave(Table):
    """mean + sum_k 4/((2k-1) pi) sin((2k-1) w t), k = 1..terms."""

    family: Literal["square-wave"]
    mean: Number = Fraction(0)
    terms: Annotated[int, Field(ge=1, le=100, strict=True)]
    frequency: Positive

    @property
    def psi(self) -> Excitation:
        """The Fourier sum."""
        return Excitation.square_wave(self.mean, self.terms, self.frequency)


class Harmonics(Table):
    """mean + sum_k s_k sin(k w t) + c_k cos(k w t)."""

    family: Literal["harmonics"]
    mean: Number = Fraction(0)
    frequency: Positive
    sin: Annotated[tuple[Number, ...], Field(max_length=200)] = ()
    cos: Annotated[tuple[Number, ...], Field(max_length=200)] = ()

    @model_validator(mode="after")
    def _moves(self) -> Harmonics:
        if not self.psi.persistent:
            raise PydanticCustomError(
                "constant", "is constant, so (12) fails; give at least one sin or cos that is not 0"
            )
        return self

    @property
    def psi(self) -> Excitation:
        """The Fourier sum."""
        return Excitation(self.mean, self.frequency, self.sin, self.cos)


ExcitationTable = Annotated[SquareWave | Harmonics, Field(discriminator="family")]


def _weighted(value: Any) -> Any:
    if not isinstance(value, (list, tuple)) or len(value) not in (2, 3):
        raise PydanticCustomError("edge", "must be [from, to] or [from, to, weight]")
    return (*value, 1)[:3]


class Links(Table):
    """The undirected edges (from, to, weight) between vehicles and the weights of the links to the leader."""

    edges: tuple[Annotated[tuple[str, str, Positive], BeforeValidator(_weighted)], ...] = ()
    leader_links: dict[str, NotNegative]


class DisturbanceTable(Table):
    """How reality differs from (1)-(14), for simulation: sampling, delay, noise, mismatch, friction, a lost link."""

    sample_time: Positive | None = None  # s, between two computations of the torques
    delay: NotNegative = Fraction(0)  # s, from measuring to the wheels
    noise_position: NotNegative = Fraction(0)  # m, standard deviation of each coordinate measured
    noise_heading: NotNegative = Fraction(0)  # rad
    noise_speed: NotNegative = Fraction(0)  # m/s and rad/s
    mismatch: NotNegative = Fraction(0)  # relative error of mass, inertia, wheel radius and track
    coulomb: NotNegative = Fraction(0)  # N m at every wheel
    viscous: NotNegative = Fraction(0)  # N m s/rad at every wheel
    lost_link: tuple[str, str] | None = None  # the edge between these vehicles fails
    lost_at: NotNegative = Fraction(0)  # s


class Fleet(Table):
    """A fleet, as its file describes it. `Fleet.load(path)` reads one; see `fleet_file` for the format."""

    name: Name
    drive: Literal["physical", "paper"] = "physical"
    leader: Leader
    excitation: ExcitationTable | None = None
    disturbance: DisturbanceTable | None = None  # for simulation only
    links: Links = Field(alias="graph")
    vehicles: tuple[Vehicle, ...] = Field(alias="vehicle")

    @classmethod
    def load(cls, path: Any) -> Fleet:
        """The fleet that a TOML file describes. Raises InputError with every mistake of the file."""
        from .fleet_file import load

        return load(path)

    @model_validator(mode="after")
    def _consistent(self) -> Fleet:
        from .fleet_file import graph_mistakes

        names = [vehicle.name for vehicle in self.vehicles]
        if mistakes := graph_mistakes(names, self.links.edges, self.links.leader_links):
            raise PydanticCustomError("graph", "{mistakes}", {"mistakes": "\n".join(mistakes)})
        return self

    def with_links(self, links: Links | None) -> Fleet:
        """The same fleet with other links; itself for None."""
        if links is None:
            return self
        kept = {
            name: getattr(self, name) for name in ("name", "drive", "leader", "excitation", "disturbance", "vehicles")
        }
        return Fleet(links=links, **kept)

    def __len__(self) -> int:
        return len(self.vehicles)

    @cached_property
    def names(self) -> list[str]:
        """The vehicles' names in file order."""
        return [vehicle.name for vehicle in self.vehicles]

    @cached_property
    def graph(self) -> Graph:
        """The interconnection with exact weights."""
        index = {name: i for i, name in enumerate(self.names)}
        tail = np.array([index[a] for a, _, _ in self.links.edges], dtype=np.int64)
        head = np.array([index[b] for _, b, _ in self.links.edges], dtype=np.int64)
        led = self.links.leader_links
        return Graph(
            tail,
            head,
            column(weight for _, _, weight in self.links.edges),
            column(led.get(name, Fraction(0)) for name in self.names),
        )

    @property
    def psi(self) -> Excitation | None:
        """The given excitation, None where the tool is to design it."""
        return self.excitation.psi if self.excitation else None

    @cached_property
    def arm(self) -> Array:
        """The signed lever arm of the left wheel, m, exact (N,): 2R in (2) as printed, -R on a physical drive.

        Nominal, where only an interval of R is known.
        """
        return column(self._arm_sign * nominal(vehicle.half_track) for vehicle in self.vehicles)

    @property
    def _arm_sign(self) -> int:
        return 2 if self.drive == "paper" else -1

    def plant(self) -> Plant:
        """The numbers of (1)-(14) as floats; nominal where only an interval is known."""
        from .equations import Plant

        return Plant(
            graph=self.graph.map(floats),
            m=floats(column(nominal(v.mass) for v in self.vehicles)),
            inertia=floats(column(nominal(v.inertia) for v in self.vehicles)),
            r=floats(column(nominal(v.wheel_radius) for v in self.vehicles)),
            arm=floats(self.arm),
            offset_x=floats(column(v.offset[0] for v in self.vehicles)),
            offset_y=floats(column(v.offset[1] for v in self.vehicles)),
            leader_x=float(self.leader.position[0]),
            leader_y=float(self.leader.position[1]),
            leader_theta=self.leader.theta,
        )

    def limits(self, psi: Excitation) -> Limits:
        """The numbers of the conditions, exact, for the excitation psi; the worst case where parameters are intervals.

        (16) and (16*) say that u_v + u_omega / arm stays below 2 torque / r: the worst case is the smallest arm, the
        largest r and the smallest torque limit.
        """
        from .limits import Limits

        return Limits(
            degree=self.graph.degree,
            psi_bar=psi.bound,
            r=column(high(v.wheel_radius) for v in self.vehicles),
            arm=column(abs(self._arm_sign) * low(v.half_track) for v in self.vehicles),
            torque=column(min(low(v.torque_limit.left), low(v.torque_limit.right)) for v in self.vehicles),
            speed=column(v.limits.speed or math.inf for v in self.vehicles),
            turn_rate=column(v.limits.turn_rate or math.inf for v in self.vehicles),
        )

    def start(self) -> State | None:
        """The initial state as floats, each (N,), or None where a vehicle of the file has none."""
        from .equations import State

        starts = [vehicle.start for vehicle in self.vehicles]
        if any(start is None for start in starts):
            return None
        rows = [(*s.position, s.theta, s.v, s.omega) for s in starts if s is not None]
        return State(*np.array(rows, dtype=float).T)

    def content(self) -> dict[str, Any]:
        """All that a certificate speaks of, in the fleet file's keys: no name, leader's pose, starts or disturbance."""
        left_out: Any = {"name": True, "leader": True, "disturbance": True, "vehicles": {"__all__": {"start"}}}
        return self.model_dump(mode="json", by_alias=True, exclude=left_out)

    @cached_property
    def digest(self) -> str:
        """The digest of the content: what ties a certificate to a fleet file."""
        return digest_of(self.content())


def digest_of(content: dict[str, Any]) -> str:
    """SHA-256 of a fleet's content, as canonical JSON."""
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), ensure_ascii=True)
    return "sha256:" + hashlib.sha256(text.encode()).hexdigest()


def column(values: Iterable[Any]) -> Array:
    """The values as an object array (N,)."""
    entries = list(values)
    column = np.empty(len(entries), dtype=object)
    column[:] = entries
    return column


def floats(values: Array) -> Array:
    """An array of exact numbers as floats."""
    return np.asarray(values, dtype=float)
