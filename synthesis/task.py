"""What every part of a design works on: the task, its options, and candidates."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from fractions import Fraction

from ..models.arrays import floats
from ..models.conditions import ConditionData, ConditionSet, condition_set
from ..models.equations import Plant, State
from ..models.errors import InfeasibleError, InputError
from ..models.excitation import Excitation
from ..models.fleet import Fleet
from ..models.gains import GAIN_NAMES, Gains
from ..models.numbers import decimal_text
from ..models.starts import Draw, random_starts, scale
from ..models.tolerance import Tolerance
from .programs.excitation import at_frequency, flat_tones
from .rounding import decimal_places, rounded
from .scaled_gains import Scalars, structured, within
from .settings import FAST, Settings

LARGEST_BOX = 1e6  # m

Progress = Callable[[str, float], None]  # what is going on, and the fraction done


@dataclass(frozen=True)
class Options:
    """What a design is asked for; see `design`."""

    conditions: str = "paper"
    excitation: str | None = None  # "given" or "designed"; None takes the fleet's own where it has one
    seed: int = 0
    digits: int = 4  # significant digits of every gain
    tolerance: Tolerance = field(default_factory=Tolerance)
    torque_factor: float = 1.0  # at most this share of every torque limit is used
    box: float | None = None  # m, side of the square around the goal that starts are drawn from; None: the fleet's

    def check(self, fleet: Fleet) -> None:
        """Raise InputError for a choice that is unknown or that the fleet does not admit."""
        if self.excitation not in (None, "given", "designed"):
            raise InputError(f"excitation = {self.excitation!r} is not known; choose given or designed")
        if not 1 <= self.digits <= 17:
            raise InputError(f"digits = {self.digits} must be from 1 to 17")
        if not 0 < self.torque_factor <= 1:
            raise InputError(f"torque_factor = {self.torque_factor} must be > 0 and at most 1")
        if self.box is not None and not 0 < self.box <= LARGEST_BOX:
            raise InputError(f"box = {self.box} must be > 0 and at most {LARGEST_BOX:g} m")
        if self.excitation == "given" and fleet.psi is None:
            raise InputError(
                "excitation = 'given', but the fleet file has no [excitation] table; add one or ask for designed"
            )


@dataclass(frozen=True, eq=False)
class Candidate:
    """Exact gains with their excitation, and the program or search that proposed them."""

    origin: str
    gains: Gains
    excitation: Excitation
    scalars: Scalars | None = None  # where the gains came from scalars


@dataclass(frozen=True, eq=False)
class Task:
    """The fleet in floats, the conditions, and what is asked for."""

    fleet: Fleet
    plant: Plant
    conditions: ConditionSet
    excitation: Excitation  # at its own frequency; a designed one at 1 rad/s
    excitation_designed: bool
    exact_data: ConditionData  # of the conditions, in fractions
    data: ConditionData  # the same in floats
    options: Options
    half_width: float  # m, of the square around the goal that random starts are drawn from
    settings: Settings

    def candidate(self, origin: str, scalars: Scalars, factors: Gains | None = None) -> Candidate:
        """Rounded gains and excitation of scalars, each gain multiplied by that of `factors`, (N,), if given.

        Raises UndecidedError where rounding cannot keep the conditions.
        """
        raw = structured(scalars, self.plant.m, self.plant.inertia, self.data.degree)
        if factors is not None:
            raw = Gains(*(getattr(raw, name) * getattr(factors, name) for name in GAIN_NAMES))
        gains = within(self.conditions, self.data, raw)
        return replace(self.rounded_candidate(origin, gains, float(scalars.tempo)), scalars=scalars)

    def rounded_candidate(self, origin: str, gains: Gains, tempo: float) -> Candidate:
        """Float gains rounded inward, with psi at a rounded frequency. Raises UndecidedError."""
        exact = rounded(self.conditions, self.exact_data, gains, self.options.digits)
        if not self.excitation_designed:
            return Candidate(origin, exact, self.excitation)
        frequency = decimal_places(tempo, self.options.digits)
        return Candidate(origin, exact, at_frequency(self.excitation, frequency))

    @property
    def tolerance(self) -> Tolerance:
        """What counts as settled."""
        return self.options.tolerance

    @property
    def tempo_range(self) -> tuple[float, float]:
        """What psi's frequency may be multiplied by."""
        return self.settings.frequency_range if self.excitation_designed else (1.0, 1.0)

    def starts(self, draw: Draw, count: int, vehicles: int | None = None) -> list[State]:
        """The fleet's own start, if it has one, and `count` random ones.

        With `vehicles` at most so many in all starts together, and at least one start.
        """
        own = self.fleet.start()
        most = count + 1 if vehicles is None else max(1, vehicles // len(self.fleet))
        drawn = random_starts(self.fleet, min(count, most), self.options.seed, self.half_width, draw)
        return [*([] if own is None else [own]), *drawn][:most]


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
