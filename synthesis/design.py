"""design(fleet): gains that settle the fleet fast, exact and within a condition set."""

from __future__ import annotations

import logging
import math
from concurrent.futures import Executor
from dataclasses import dataclass, replace

from ..models.arrays import floats
from ..models.conditions import ConditionSet, Inequality, exact_numbers, torque_bound
from ..models.errors import InputError
from ..models.excitation import Excitation
from ..models.fleet import Fleet
from ..models.fleet_tables import Links
from ..models.gains import GAIN_NAMES, Gains
from ..models.html_table import html_table
from ..models.tolerance import Tolerance
from .measurement import worker_errors
from .programs.averaged import local_optima
from .programs.rates import convex_designs
from .programs.weights import design_weights
from .rates import Rates, rates
from .search.ranking import best_of
from .search.search import search
from .settings import MODES, WORK_PER_SECOND, Settings
from .task import Options, Progress, Proposal, Task, prepare

LOG = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class Design:
    """Gains for a fleet, exact and within their conditions, with what was predicted and measured of them."""

    fleet: Fleet
    links: Links | None  # designed weights, None where the fleet's own are used
    conditions: ConditionSet
    excitation: Excitation
    excitation_designed: bool
    gains: Gains  # of fractions that are decimals, (N,), with their scales
    origin: str  # the program or search that proposed them
    rates: Rates
    settling: tuple[float, ...]  # s, from the ranking starts; inf where not settled
    settling_held: tuple[float, ...]  # the same with torques that are held and what the fleet's robots add
    sample_time: float  # s, for which they are held
    largest_sample_time: float | None  # s, up to which all ranking starts settle
    tolerance: Tolerance
    torque_factor: float  # the share of the torque limits that was allowed
    mode: str
    seed: int
    digits: int

    def inequalities(self) -> list[Inequality]:
        """The conditions, exact, one entry per vehicle; all hold."""
        return self.conditions.inequalities(
            exact_numbers(), self.used_fleet.condition_data(self.excitation), self.gains
        )

    def __repr__(self) -> str:
        times = sorted(self.settling)
        settled = sum(map(math.isfinite, times))
        median = f", median {times[len(times) // 2]:.0f} s" if settled > len(times) // 2 else ""
        return (
            f"Design({self.fleet.name!r}: {len(self.fleet)} vehicles, conditions {self.conditions.name}, "
            f"{settled} of {len(times)} starts settle{median})"
        )

    def _repr_html_(self) -> str:
        data, scales = self.used_fleet.condition_data(self.excitation), self.gains.saturation.columns(len(self.fleet))
        bounds = torque_bound(exact_numbers(), data, self.gains)
        columns = [*(getattr(self.gains, name) for name in GAIN_NAMES), *scales.values(), bounds, data.torque]
        headings = ("vehicle", *GAIN_NAMES, *(f"{name} scale" for name in scales), "T of (16*) / N m", "limit / N m")
        return html_table(repr(self), headings, list(zip(self.fleet.names, *columns, strict=True)))

    @property
    def used_fleet(self) -> Fleet:
        """The fleet with the weights that the gains are for."""
        return self.fleet.with_links(self.links)


def design(
    fleet: Fleet,
    *,
    conditions: str = "paper",
    mode: str = "fast",
    excitation: str | None = None,
    saturation: str | None = None,
    weights: str = "given",
    seed: int = 0,
    digits: int = 4,
    time_limit: float = 600.0,
    tolerance: Tolerance = Tolerance(),  # noqa: B008 -- frozen
    torque_factor: float = 1.0,
    box: float | None = None,
    settings: Settings | None = None,
    executor: Executor | None = None,
    progress: Progress = lambda _what, _fraction: None,
) -> Design:
    """Gains for a fleet under a condition set.

    Args:
        fleet: the fleet.
        conditions: "paper" for (15) and (16), "corrected" for (16*), "rate-bounded" for (15') and (16*).
        mode: "draft" for a search of some seconds, "fast" for one of a minute, "best" for one until the time limit.
        excitation: "given" or "designed"; None takes the fleet's own where it has one.
        saturation: "given", "designed" or "unit" (the paper's controller); None takes the fleet's own where it has any.
        weights: "given" for the fleet's own a_ij and a_il, "designed" for better ones on the same links.
        seed: of the random starts and the search; the same seed gives the same gains.
        digits: significant digits of every gain.
        time_limit: s that mode "best" searches for on two cores; it counts work, so that every machine finds the same.
        tolerance: what counts as settled.
        torque_factor: at most this share of every torque limit is used, > 0 and at most 1.
        box: m, the side of the square around the goal that starts are drawn from; None takes the fleet's own scale.
        settings: the numbers of the search; None takes those of the mode.
        executor: where rollouts run; None runs them here.
        progress: called with what is going on and the fraction done.

    Raises:
        InputError: for an unknown choice, or a given excitation that is not there.
        InfeasibleError: where a start already breaks a limit that is to be certified.
        UndecidedError: where no candidate could be rounded to the digits asked for.

    """
    if mode not in MODES:
        raise InputError(f"mode = {mode!r} is not known; choose one of {', '.join(MODES)}")
    if weights not in ("given", "designed"):
        raise InputError(f"weights = {weights!r} is not known; choose given or designed")
    settings = settings or (
        replace(MODES["best"], work=WORK_PER_SECOND * time_limit) if mode == "best" else MODES[mode]
    )
    links = design_weights(fleet, settings.clarabel_seconds) if weights == "designed" else None
    options = Options(conditions, excitation, saturation, seed, digits, tolerance, torque_factor, box)
    task = prepare(fleet.with_links(links), options, settings)
    progress("solving the averaged program", 0.0)
    proposals = search(task, incumbents(task, executor), executor, progress)
    ranked = best_of(task, proposals, executor, progress)
    best = ranked.candidate
    return Design(
        fleet=fleet,
        links=links,
        conditions=task.conditions,
        excitation=best.excitation,
        excitation_designed=task.excitation_designed,
        gains=best.gains,
        origin=best.origin,
        rates=rates(task.plant, best.gains.map(floats), best.excitation, tolerance.position, tolerance.heading),
        settling=ranked.settling,
        settling_held=ranked.settling_held,
        sample_time=task.setup.disturbance.sample_time,
        largest_sample_time=ranked.largest_sample_time,
        tolerance=tolerance,
        torque_factor=torque_factor,
        mode=mode,
        seed=seed,
        digits=digits,
    )


def incumbents(task: Task, executor: Executor | None = None) -> list[Proposal]:
    """What the programs propose, or else the typical scalars.

    The programs are solved in other processes where there is an executor.
    """
    with worker_errors():
        convex = executor.submit(convex_designs, task) if executor else None
        averaged = executor.submit(local_optima, task, task.half_width) if executor else None
        optima = averaged.result() if averaged else local_optima(task, task.half_width)
        designs = convex.result() if convex else convex_designs(task)
    proposals = [*(task.proposal("averaged program", scalars) for scalars, _ in optima), *designs]
    return proposals or [task.proposal("closed form", task.typical)]
