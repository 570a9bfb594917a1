"""What every part of a design works on: the task, its options, proposals and candidates."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property

import numpy as np

from ..models.arrays import floats
from ..models.conditions import ConditionData, ConditionSet, condition_set
from ..models.equations import Plant
from ..models.errors import InfeasibleError, InputError
from ..models.excitation import Excitation
from ..models.fleet import Fleet
from ..models.gains import Gains
from ..models.numbers import decimal_text
from ..models.saturation import Saturation
from ..models.starts import Draw, scale
from ..models.tolerance import Tolerance
from .programs.excitation import at_frequency, flat_tones
from .rollouts.columns import Setup
from .rollouts.disturbance import Disturbance
from .rollouts.runge_kutta import Array
from .rounding import decimal_places, rounded
from .scaled_gains import Scalars, structured, with_factors, within
from .settings import FAST, Settings
from .starts import far_starts, near_starts
from .typical import typical_scalars

LARGEST_BOX = 1e6  # m

Progress = Callable[[str, float], None]  # what is going on, and the fraction done


@dataclass(frozen=True)
class Options:
    """What a design is asked for; see `design`."""

    conditions: str = "paper"
    excitation: str | None = None  # "given" or "designed"; None takes the fleet's own where it has one
    saturation: str | None = None  # "given", "designed" or "unit"; None takes the fleet's own where it has some
    seed: int = 0
    digits: int = 4  # significant digits of every gain and scale
    tolerance: Tolerance = field(default_factory=Tolerance)
    torque_factor: float = 1.0  # at most this share of every torque limit is used
    box: float | None = None  # m, side of the square around the goal that starts are drawn from; None: the fleet's

    def check(self, fleet: Fleet) -> None:
        """Raise InputError for a choice that is unknown or that the fleet does not admit."""
        if self.excitation not in (None, "given", "designed"):
            raise InputError(f"excitation = {self.excitation!r} is not known; choose given or designed")
        if self.saturation not in (None, "given", "designed", "unit"):
            raise InputError(f"saturation = {self.saturation!r} is not known; choose given, designed or unit")
        if not 1 <= self.digits <= 17:
            raise InputError(f"digits = {self.digits} must be from 1 to 17")
        if not 0 < self.torque_factor <= 1:
            raise InputError(f"torque_factor = {self.torque_factor} must be > 0 and at most 1")
        if self.box is not None and not 0 < self.box <= LARGEST_BOX:
            raise InputError(f"box = {self.box} must be > 0 and at most {LARGEST_BOX:g} m")
        for choice, name, table in (
            (self.excitation, "excitation", fleet.psi),
            (self.saturation, "saturation", fleet.saturation),
        ):
            if choice == "given" and table is None:
                raise InputError(
                    f"{name} = 'given', but the fleet file has no [{name}] table; add one or ask for designed"
                )

    def scales(self, fleet: Fleet) -> Saturation | None:
        """The scales that the design has to take, exact; None where it chooses them."""
        if self.saturation == "unit":
            return Saturation()
        return None if self.saturation == "designed" or fleet.saturation is None else fleet.saturation.scales


@dataclass(frozen=True, eq=False)
class Proposal:
    """Gains and scales in floats, within the conditions, with the frequency of psi and what proposed them."""

    origin: str
    gains: Gains
    frequency: float  # rad/s
    scalars: Scalars | None = None  # where the gains came from scalars


@dataclass(frozen=True, eq=False)
class Candidate:
    """Exact gains and scales with their excitation, and what proposed them."""

    origin: str
    gains: Gains
    excitation: Excitation


@dataclass(frozen=True, eq=False)
class Task:
    """The fleet in floats, the conditions, and what is asked for."""

    fleet: Fleet
    plant: Plant
    conditions: ConditionSet
    excitation: Excitation  # at its own frequency; a designed one at 1 rad/s
    excitation_designed: bool
    saturation: Saturation | None  # the scales that are given, exact; None where they are designed
    exact_data: ConditionData  # of the conditions, in fractions
    data: ConditionData  # the same in floats
    options: Options
    half_width: float  # m, of the square around the goal that random starts are drawn from
    settings: Settings

    def proposal(self, origin: str, scalars: Scalars, factors: Array | None = None) -> Proposal:
        """The gains and scales of scalars within the conditions, each multiplied by its factors (7, N), if given."""
        raw = structured(scalars, self.plant.m, self.plant.inertia, self.data.degree)
        raw = raw if factors is None else with_factors(raw, factors)
        frequency = float(scalars.frequency if self.excitation_designed else self.excitation.frequency)
        return Proposal(origin, self.within(raw), frequency, scalars)

    def within(self, gains: Gains) -> Gains:
        """Float gains with the given scales, moved into the conditions."""
        if self.saturation is not None:
            gains = replace(gains, saturation=self.saturation.map(floats))
        return within(self.conditions, self.data, gains)

    def rounded(self, proposal: Proposal) -> Candidate:
        """A proposal rounded inward, with psi at a rounded frequency. Raises UndecidedError where nothing is left."""
        gains = rounded(self.conditions, self.exact_data, proposal.gains, self.options.digits, self.saturation)
        if not self.excitation_designed:
            return Candidate(proposal.origin, gains, self.excitation)
        frequency = decimal_places(proposal.frequency, self.options.digits)
        return Candidate(proposal.origin, gains, at_frequency(self.excitation, frequency))

    @property
    def tolerance(self) -> Tolerance:
        """What counts as settled."""
        return self.options.tolerance

    @cached_property
    def typical(self) -> Scalars:
        """Scalars that suit the fleet roughly."""
        return typical_scalars(
            self.plant, self.data, self.tolerance, self.setup.disturbance.sample_time, self.saturation
        )

    @cached_property
    def setup(self) -> Setup:
        """What rollouts need."""
        zero = np.zeros(len(self.fleet))
        centred = replace(self.plant, offset_x=zero, offset_y=zero, leader_x=0.0, leader_y=0.0)
        disturbance = Disturbance.of(self.fleet, self.tolerance, self.settings)
        return Setup(centred, self.excitation, self.tolerance, disturbance, self.settings)

    @cached_property
    def eased(self) -> Setup:
        """The same with a part of the friction: random gains seldom move a robot near its goal against all of it."""
        old, share = self.setup.disturbance, self.settings.explored_friction
        return replace(self.setup, disturbance=replace(old, coulomb=share * old.coulomb, viscous=share * old.viscous))

    def far_starts(self, draw: Draw, count: int) -> Array:
        """The fleet's own start, if it has one, and random ones, (5, N, S) singles; at most `count`, fewer if large."""
        count = max(1, min(count, self.settings.starts_vehicles // len(self.fleet)))
        return far_starts(self.fleet, count, self.options.seed, self.half_width, draw)

    def near_starts(self, draw: Draw, count: int) -> Array:
        """Starts with small errors across the track, (5, N, S) singles."""
        error = self.settings.near_errors * self.tolerance.position
        return near_starts(self.plant, count, (self.options.seed, draw), error, self.settings.near_patterns)


def fixed_scalars(task: Task) -> set[str]:
    """The names of the scalars that the task does not leave free."""
    scales = set() if task.saturation is None else {"length", "heading", "speed", "turn_rate"}
    return scales if task.excitation_designed else scales | {"tempo"}


def prepare(fleet: Fleet, options: Options, settings: Settings = FAST) -> Task:
    """The task of designing for a fleet. Raises InputError and InfeasibleError."""
    options.check(fleet)
    _check_starts(fleet)
    designed = options.excitation == "designed" or fleet.psi is None
    psi = flat_tones(settings.clarabel_seconds) if designed or fleet.psi is None else fleet.psi
    exact = fleet.condition_data(psi)
    exact = replace(exact, torque=exact.torque * Fraction(repr(options.torque_factor)))
    return Task(
        fleet=fleet,
        plant=fleet.plant(),
        conditions=condition_set(options.conditions),
        excitation=psi,
        excitation_designed=designed,
        saturation=options.scales(fleet),
        exact_data=exact,
        data=exact.map(floats),
        options=options,
        half_width=scale(fleet) if options.box is None else options.box / 2,
        settings=settings,
    )


def _check_starts(fleet: Fleet) -> None:
    """A certified limit holds for a vehicle that starts within it."""
    mistakes = []
    for vehicle in fleet.vehicles:
        if vehicle.start is None:
            continue
        pairs = (("v", vehicle.start.v, vehicle.limits.speed), ("omega", vehicle.start.omega, vehicle.limits.turn_rate))
        for key, value, limit in pairs:
            if limit is not None and abs(value) > limit:
                mistakes.append(
                    f"vehicle {vehicle.name!r}: start {key} = {decimal_text(value)} is beyond its certified limit "
                    f"{decimal_text(limit)}, which no gains can keep; slow the start or raise the limit"
                )
    if mistakes:
        raise InfeasibleError("\n".join(mistakes))
