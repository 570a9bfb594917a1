"""design(fleet): gains that settle the fleet fast, exact and within a condition set."""

from __future__ import annotations

import logging
import math
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..models.arrays import floats
from ..models.conditions import ConditionData, ConditionSet, Inequality, condition_set, exact_numbers
from ..models.equations import Plant, State
from ..models.errors import InfeasibleError, InputError, UndecidedError
from ..models.excitation import Excitation
from ..models.fleet import Fleet
from ..models.fleet_tables import Links
from ..models.gains import GAIN_NAMES, Gains
from ..models.numbers import decimal_text
from ..models.starts import Draw, random_starts, scale
from ..models.tolerance import Tolerance
from .cost import answering, cost, measure_all
from .programs.excitation import at_frequency, flat_tones
from .rates import Rates, rates
from .rounding import decimal_places, rounded
from .scaled_gains import Scalars, structured, within

RANKING_STARTS = 6  # random starts beside the fleet's own on which candidates are ranked
FINAL_STARTS = 40  # the same, once the search has been
RANKED_VEHICLES = 200  # in all starts together: a large fleet is simulated from one
LAST_CANDIDATES = 8  # among which mode "best" chooses once more: over few starts they differ by chance
LAST_STARTS = 320
LAST_VEHICLES = 2000  # in all of them together
SEARCHED_VEHICLES = 20  # up to here mode "fast" searches a little as well
FAST_SECONDS = 300.0  # of that search at most: a guard for busy machines, half a minute is usual
LARGEST_BOX = 1e6  # m
LONGEST = 20_000.0  # s, of a rollout
RANKING_SHARES = (1 / 64, 1 / 16, 1 / 4, 1.0)  # of it, tried in turn: the slowest candidate would hold up all others
FREQUENCY_RANGE = (0.02, 20.0)  # rad/s, of a designed psi
FALLBACK = Scalars(1.0, 3.0, 1.0, 1.0, 2.0, 1.0)  # feasible for every fleet once `within` has scaled it

LOG = logging.getLogger(__name__)
Progress = Callable[[str, float], None]  # what is going on, and the fraction done


@dataclass(frozen=True, eq=False)
class Candidate:
    """Exact gains with their excitation, and how they came about."""

    origin: str
    gains: Gains
    excitation: Excitation
    scalars: Scalars | None = None  # where they came from six of them


@dataclass(frozen=True, eq=False)
class Design:
    """Gains for a fleet, exact and within their conditions, with what was predicted and measured of them."""

    fleet: Fleet
    links: Links | None  # designed weights, None where the fleet's own are used
    conditions: ConditionSet
    excitation: Excitation
    excitation_designed: bool
    gains: Gains  # of fractions that are decimals, (N,)
    origin: str  # the program or search that found them
    rates: Rates
    settling: tuple[float, ...]  # s, on the starts that the candidates were ranked on; inf where not settled
    tolerance: Tolerance
    mode: str
    seed: int
    digits: int

    def inequalities(self) -> list[Inequality]:
        """The conditions, exact, one entry per vehicle; all hold."""
        return self.conditions.inequalities(
            exact_numbers(), self.used_fleet.condition_data(self.excitation), self.gains
        )

    @property
    def used_fleet(self) -> Fleet:
        """The fleet with the weights that the gains are for."""
        return self.fleet.with_links(self.links)


@dataclass(frozen=True, eq=False)
class Task:
    """What every part of a design works on: the fleet in floats, the conditions and the clock's tolerance."""

    fleet: Fleet
    plant: Plant
    conditions: ConditionSet
    excitation: Excitation  # at its own frequency; a designed one at 1 rad/s
    excitation_designed: bool
    exact: ConditionData
    limits: ConditionData  # of floats
    tolerance: Tolerance
    digits: int
    seed: int
    half_width: float  # m, of the square around the goal that random starts are drawn from

    def candidate(self, origin: str, scalars: Scalars, own: Gains | None = None) -> Candidate:
        """Rounded gains and excitation of scalars, each gain multiplied by that of `own`, (N,), where it is given.

        Raises UndecidedError where rounding cannot keep the conditions.
        """
        raw = structured(scalars, self.plant.m, self.plant.inertia, self.limits.degree)
        if own is not None:
            raw = Gains(*(getattr(raw, name) * getattr(own, name) for name in GAIN_NAMES))
        gains = within(self.conditions, self.limits, raw)
        return replace(self.exactly(origin, gains, float(scalars.tempo)), scalars=scalars)

    def exactly(self, origin: str, gains: Gains, tempo: float) -> Candidate:
        """Float gains rounded inward, with psi at a rounded frequency."""
        exact = rounded(self.conditions, self.exact, gains, self.digits)
        if not self.excitation_designed:
            return Candidate(origin, exact, self.excitation)
        return Candidate(origin, exact, at_frequency(self.excitation, decimal_places(tempo, self.digits)))

    @property
    def tempo_range(self) -> tuple[float, float]:
        """What psi's frequency may be multiplied by."""
        return FREQUENCY_RANGE if self.excitation_designed else (1.0, 1.0)

    def starts(self, draw: Draw, count: int, vehicles: int | None = None) -> list[State]:
        """The fleet's own start, if it has one, and `count` random ones; with at most `vehicles` in all, but one."""
        own = self.fleet.start()
        most = count + 1 if vehicles is None else max(1, vehicles // len(self.fleet))
        drawn = random_starts(self.fleet, min(count, most), self.seed, self.half_width, draw)
        return [*([] if own is None else [own]), *drawn][:most]


def design(
    fleet: Fleet,
    *,
    conditions: str = "paper",
    mode: str = "fast",
    excitation: str | None = None,
    weights: str = "given",
    seed: int = 0,
    digits: int = 4,
    time_limit: float = 600.0,
    tolerance: Tolerance = Tolerance(),  # noqa: B008 -- frozen
    box: float | None = None,
    executor: Executor | None = None,
    progress: Progress = lambda _what, _fraction: None,
) -> Design:
    """Gains for a fleet under a condition set.

    Args:
        fleet: the fleet.
        conditions: "paper" for (15) and (16), "corrected" for (16*), "rate-bounded" for (15') and (16*).
        mode: "fast" for the averaged program, ranked by simulation, and a short search; "best" to search on.
        excitation: "given" or "designed"; None takes the fleet's own where it has one.
        weights: "given" for the fleet's own a_ij and a_il, "designed" for better ones on the same links.
        seed: of the random starts and the search; the same seed gives the same gains.
        digits: significant digits of every gain.
        time_limit: s of wall clock that mode "best" searches for, between the averaged program and the last rankings.
        tolerance: what counts as settled.
        box: m, the side of the square around the goal that starts are drawn from; None takes the fleet's own scale.
        executor: where rollouts run; None runs them here.
        progress: called with what is going on and the fraction done.

    Raises:
        InputError: for an unknown choice, or a given excitation that is not there.
        InfeasibleError: where a start already breaks a limit that is to be certified.
        UndecidedError: where no candidate could be rounded to the digits asked for.

    """
    if mode not in ("fast", "best"):
        raise InputError(f"mode = {mode!r} is not known; choose one of fast, best")
    links = _weights(fleet, weights)
    task = prepare(fleet.with_links(links), conditions, excitation, seed, digits, tolerance, box)
    progress("solving the averaged program", 0.0)
    candidates, horizon = _candidates(task, executor)
    searched = mode == "best" or len(fleet) <= SEARCHED_VEHICLES
    if searched:
        from .search.search import search

        limit = time_limit if mode == "best" else FAST_SECONDS
        candidates = search(task, candidates, horizon, limit, mode == "fast", executor, progress)
    starts = task.starts(Draw.RANKING, FINAL_STARTS if searched else RANKING_STARTS, RANKED_VEHICLES)
    ranked, times = rank(task, candidates, starts, horizon, executor, progress, keep=mode == "best")
    if mode == "best":
        last = task.starts(Draw.LAST_CHOICE, LAST_STARTS, LAST_VEHICLES)
        if len(last) > len(starts):
            try:
                ranked, times = rank(task, ranked[:LAST_CANDIDATES], last, horizon, executor, progress)
            except KeyboardInterrupt:
                LOG.warning("last choice: interrupted; the one from %d starts is kept", len(times))
    best = ranked[0]
    return Design(
        fleet=fleet,
        links=links,
        conditions=task.conditions,
        excitation=best.excitation,
        excitation_designed=task.excitation_designed,
        gains=best.gains,
        origin=best.origin,
        rates=rates(task.plant, best.gains.map(floats), best.excitation, tolerance.position, tolerance.heading),
        settling=tuple(times),
        tolerance=tolerance,
        mode=mode,
        seed=seed,
        digits=digits,
    )


def prepare(
    fleet: Fleet,
    conditions: str,
    excitation: str | None,
    seed: int,
    digits: int,
    tolerance: Tolerance,
    box: float | None = None,
) -> Task:
    """The task of designing for a fleet. Raises InputError and InfeasibleError."""
    if excitation not in (None, "given", "designed"):
        raise InputError(f"excitation = {excitation!r} is not known; choose given or designed")
    if not 1 <= digits <= 17:
        raise InputError(f"digits = {digits} must be from 1 to 17")
    if box is not None and not 0 < box <= LARGEST_BOX:
        raise InputError(f"box = {box} must be > 0 and at most {LARGEST_BOX:g} m")
    if excitation == "given" and fleet.psi is None:
        raise InputError(
            "excitation = 'given', but the fleet file has no [excitation] table; add one or ask for designed"
        )
    _check_starts(fleet)
    designed = excitation == "designed" or fleet.psi is None
    psi = flat_tones() if designed or fleet.psi is None else fleet.psi
    exact = fleet.condition_data(psi)
    return Task(
        fleet,
        fleet.plant(),
        condition_set(conditions),
        psi,
        designed,
        exact,
        exact.map(floats),
        tolerance,
        digits,
        seed,
        scale(fleet) if box is None else box / 2,
    )


def _weights(fleet: Fleet, weights: str) -> Links | None:
    if weights not in ("given", "designed"):
        raise InputError(f"weights = {weights!r} is not known; choose given or designed")
    if weights == "given":
        return None
    from .programs.weights import design_weights

    return design_weights(fleet)


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


def _candidates(task: Task, executor: Executor | None = None) -> tuple[list[Candidate], float]:
    """Rounded candidates from the programs and the fallback, and the horizon that holds their tails.

    All are solved in other processes where there is an executor.
    """
    from .programs.averaged import local_optima
    from .programs.channels import convex_designs

    found: list[Candidate] = []
    predicted = []
    with answering():
        convex = executor.submit(convex_designs, task) if executor else None
        optima = local_optima(task, task.half_width, executor)
        designs = convex.result() if convex else convex_designs(task)
    for scalars, time in optima:
        found += _kept(task.candidate, "averaged program", scalars)
        predicted.append(time)
    for gains, tempo in designs:
        found += _kept(task.exactly, "convex programs", gains, tempo)
    if not found:
        found.append(task.candidate("closed form", FALLBACK))
    horizon = (6 if len(task.fleet) <= RANKED_VEHICLES else 2) * min(predicted, default=500.0)
    return found, float(np.clip(horizon, 300.0, LONGEST))


def _kept(make: Callable[..., Candidate], origin: str, *solution: Any) -> list[Candidate]:
    """The candidate of a solution, if it can be rounded within the conditions."""
    try:
        return [make(origin, *solution)]
    except UndecidedError as error:
        LOG.warning("%s: a candidate is left out: %s", origin, error)
        return []


def rank(
    task: Task,
    candidates: Sequence[Candidate],
    starts: Sequence[State],
    horizon: float,
    executor: Executor | None,
    progress: Progress,
    keep: bool = False,
) -> tuple[list[Candidate], list[float]]:
    """The candidates by cost over the starts, least first, and the settling times (s) of the first.

    They are simulated up to a share of the horizon, and further where the first does not settle from every start.
    With `keep` an interrupt leaves those that have been measured, if there are any.
    """
    found: list[tuple[float, int, list[float]]] = []
    try:
        for share in RANKING_SHARES:
            found, end = [], share * horizon
            for number, measured in enumerate(measure_all(task, candidates, starts, end, executor)):
                found.append((cost(measured, end), number, [run.time for run in measured]))
                progress("ranking candidates by simulation", (number + 1) / len(candidates))
            if max(min(found)[2]) < math.inf:
                break
    except KeyboardInterrupt:
        if not (keep and found):
            raise
        LOG.warning("ranking: interrupted; %d of %d candidates are kept", len(found), len(candidates))
    found.sort()
    return [candidates[number] for _, number, _ in found], found[0][2]


def as_json(made: Design, versions: dict[str, str]) -> dict[str, object]:
    """The content of design.json; every number that is exact is a decimal string."""
    margins = {
        inequality.source: [_finite(float(margin)) for margin in inequality.margin]
        for inequality in made.inequalities()
    }
    return {
        "fleet": made.fleet.name,
        "fleet_digest": made.fleet.digest,
        "conditions": made.conditions.name,
        "theorem": made.conditions.theorem,
        "excitation": made.excitation.table(),
        "excitation_designed": made.excitation_designed,
        "psi_bar": decimal_text(made.excitation.bound),
        "weights": None if made.links is None else made.links.model_dump(mode="json"),
        "vehicles": made.fleet.names,
        "gains": {name: [decimal_text(value) for value in getattr(made.gains, name)] for name in GAIN_NAMES},
        "origin": made.origin,
        "predicted": {
            "gamma_omega": _finite(made.rates.gamma_omega),
            "gamma_v": _finite(made.rates.gamma_v),
            "kappa": _finite(made.rates.kappa),
            "tail_time_s": _finite(made.rates.tail_time),
        },
        "measured_settling_s": [_finite(time) for time in made.settling],
        "tolerance": {"position_m": made.tolerance.position, "heading_rad": made.tolerance.heading},
        "margins": margins,
        "mode": made.mode,
        "seed": made.seed,
        "digits": made.digits,
        "versions": versions,
    }


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
