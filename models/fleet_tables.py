"""The tables of a fleet file, validated: vehicle, leader, start, links, excitation, disturbance."""

from __future__ import annotations

import math
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, model_validator
from pydantic_core import PydanticCustomError

from .excitation import Excitation
from .numbers import Interval, NotNegative, Number, Positive, Uncertain, UncertainOrZero, high, low, nominal
from .saturation import Saturation

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


@lru_cache(maxsize=2**10)
def _shared(limit: TorqueLimit) -> TorqueLimit:
    """The same object for equal limits: a large fleet has a few kinds of robots."""
    return limit


class MotionLimits(Table):
    """The limits that a certificate has to prove."""

    speed: Positive | None = None  # m/s
    turn_rate: Positive | None = None  # rad/s
    wheel_speed: Positive | None = None  # rad/s, of either wheel
    acceleration: Positive | None = None  # m/s^2
    turn_acceleration: Positive | None = None  # rad/s^2


class Vehicle(Table):
    """One differential-drive vehicle; a physical parameter is a number or an interval [low, high]."""

    name: Name
    mass: Uncertain  # kg
    inertia: Uncertain  # kg m^2, about the centre
    half_track: Uncertain  # R, m
    wheel_radius: Uncertain  # r, m
    torque_limit: Annotated[TorqueLimit, BeforeValidator(_both_wheels), AfterValidator(_shared)]
    offset: Point  # delta, m
    start: Start | None = None
    limits: MotionLimits = MotionLimits()
    wheel_inertia: UncertainOrZero = Fraction(0)  # kg m^2, J of one wheel and its rotor about the axle
    footprint: Positive | None = None  # m, radius, for the distance between robots in reports
    com_offset: Point = (Fraction(0), Fraction(0))  # m, centre of mass ahead of the axle and left of its centre

    def mass_bounds(self) -> tuple[Fraction, Fraction]:
        """(least, greatest) effective mass, kg: m + 2 J / r^2, since the wheels spin as the vehicle rolls.

        Where r is an interval, controller and vehicle may have different values r and r' of it: the vehicle then moves
        as one of mass (m + 2 J / r'^2) r' / r.
        """
        if self._exact and not self.wheel_inertia:
            return low(self.mass), high(self.mass)
        least, most = low(self.wheel_radius), high(self.wheel_radius)
        return (
            (low(self.mass) * least + 2 * low(self.wheel_inertia) / most) / most,
            (high(self.mass) * most + 2 * high(self.wheel_inertia) / least) / least,
        )

    def inertia_bounds(self, arm_factor: int) -> tuple[Fraction, Fraction]:
        """(least, greatest) effective inertia, kg m^2: I + 2 J (arm / r)^2 with the lever arm arm_factor R.

        Where r or R are intervals it is (I + 2 J arm'^2 / r'^2) (r' / r) (arm / arm').
        """
        if self._exact and not self.wheel_inertia:
            return low(self.inertia), high(self.inertia)
        r, R = (low(self.wheel_radius), high(self.wheel_radius)), (low(self.half_track), high(self.half_track))
        radii, arms = r[0] * r[1], arm_factor**2 * R[0] * R[1]
        return (
            (low(self.inertia) * radii + 2 * low(self.wheel_inertia) * arms) * R[0] / (R[1] * r[1] ** 2),
            (high(self.inertia) * radii + 2 * high(self.wheel_inertia) * arms) * R[1] / (R[0] * r[0] ** 2),
        )

    @property
    def _exact(self) -> bool:
        """Whether r and R are known exactly."""
        return not isinstance(self.wheel_radius, Interval) and not isinstance(self.half_track, Interval)

    def effective_mass(self) -> Fraction:
        """m + 2 J / r^2, kg, nominal where only intervals are known."""
        return nominal(self.mass) + 2 * nominal(self.wheel_inertia) / nominal(self.wheel_radius) ** 2

    def effective_inertia(self, arm_factor: int) -> Fraction:
        """I + 2 J (arm / r)^2, kg m^2, nominal where only intervals are known."""
        ratio = arm_factor * nominal(self.half_track) / nominal(self.wheel_radius)
        return nominal(self.inertia) + 2 * nominal(self.wheel_inertia) * ratio**2


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


class SaturationTable(Table):
    """The scales that divide the arguments of tanh; all 1 is the controller as the paper prints it."""

    position: Positive = Fraction(1)  # m, in (8)
    heading: Positive = Fraction(1)  # rad, in (10)
    speed: Positive = Fraction(1)  # m/s, in (7), of every vehicle
    turn_rate: Positive = Fraction(1)  # rad/s, in (9), of every vehicle

    @property
    def scales(self) -> Saturation:
        """The scales for the controller, exact."""
        return Saturation(self.position, self.heading, self.speed, self.turn_rate)


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
    com_offset: bool = False  # whether the centre of mass is where com_offset of each vehicle says
