"""Every number that decides how `design` searches, in one place: what it means, its unit, and what it was tuned on.

Unless a field says otherwise it was tuned on three fleets: the paper's six vehicles, the mixed ring and the TurtleBot3
line, by the settling times of designs from starts that the search had not seen.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Accuracy:
    """The error that a Runge-Kutta step may have, in the root mean square over a column, and how long it may be."""

    relative: float
    absolute: float  # in units of the column
    longest: float  # s


@dataclass(frozen=True)
class Bounds:
    """How far candidates are simulated, in multiples of what the best so far took."""

    horizon: float  # of its mean settling time
    abandon_above: float  # of its mean settling time: a candidate whose mean is known to lie above is not finished
    steps: float  # of the most integration steps that it took from one start


@dataclass(frozen=True)
class Settings:
    """The numbers of the design and its search. FAST and BEST are those of the two modes."""

    # Which parts of the search run.
    seconds: float = 300.0  # s of wall clock for the search; in FAST a guard for busy machines, half a minute is usual
    searched_vehicles: float = 20  # the largest fleet that is searched at all; beyond, programs and ranking suffice
    own_gains: bool = False  # whether the search goes on to separate gains per vehicle or role
    final_ranking: bool = False  # whether the best candidates are ranked once more, from `final_starts`
    keep_on_interrupt: bool = False  # whether an interrupt ends the search with its best, and not the program

    # Starts: the fleet's own, if it has one, and so many random ones.
    training_starts: int = 24  # that the strategies learn from, generation after generation others of them
    heldout_starts: int = 24  # on which new candidates are compared: the training starts flatter them
    searched_starts_vehicles: int = 4000  # in all starts of a search together: a large fleet is searched on fewer
    exploration_starts: int = 8  # per random candidate of the exploration
    scalars_starts: int = 12  # of one generation over the scalars
    own_gains_starts: int = 16  # of one generation over separate gains
    ranking_starts: int = 40  # for the ranking after a search
    unsearched_ranking_starts: int = 6  # for the ranking of a fleet that was not searched
    ranked_vehicles: int = 200  # in all starts of a ranking together: a large fleet is simulated from one
    final_starts: int = 320  # for the final ranking: over fewer the best differ by chance
    final_vehicles: int = 2000  # in all starts of the final ranking together
    final_candidates: int = 8  # that the final ranking chooses among

    # Exploration: random scalars around the candidates of the programs.
    explored: int = 240  # random candidates
    exploration_spread: float = 1.0  # standard deviation, in logarithms
    exploration_batch: int = 240  # candidates at a time: the best of a batch limits how long the next are simulated
    basins: int = 4  # of the best explored points, from which runs of CMA-ES begin
    basin_distance: float = 0.5  # largest difference, in logarithms, below which two beginnings count as one

    # CMA-ES over the scalars, with the worse half of the runs dropped after each round.
    generations: int = 10  # of one round, between two comparisons
    rounds: int = 1
    population: int = 12
    spread: float = 0.35  # standard deviation of the first generation, in logarithms
    elite: int = 4  # best candidates that each run keeps
    finalists: int = 2  # runs whose best candidates are ranked in the end
    scalars_share: float = 1.0  # of the time, after which the scalars are left

    # CMA-ES over separate gains per vehicle or role.
    own_gains_basins: int = 4  # beginnings; the worse half of the runs ends with every third of the time
    own_gains_population: int = 48  # more variables, and noise: neighbouring gains differ where motion is chaotic
    own_gains_spread: float = 0.15  # standard deviation of the first generation, in logarithms
    own_gains_vehicles: int = 12  # the largest fleet in which every vehicle has gains of its own
    roles_vehicles: int = 40  # the largest fleet in which every role in the graph has gains of its own
    patience: int = 8  # comparisons without improvement, after which such a run ends

    # How far candidates are simulated.
    compared: Bounds = Bounds(6.0, 3.0, 10.0)  # on the held-out starts
    learned: Bounds = Bounds(2.0, 1.6, 3.0)  # for a generation
    tried: Bounds = Bounds(3.0, 1.3, 3.0)  # in the exploration
    least_mean: float = 10.0  # s, floor on the best mean, so that the horizon never reaches 0
    ranking_shares: tuple[float, ...] = (1 / 64, 1 / 16, 1 / 4, 1.0)  # of the horizon, tried in turn
    horizon_factor: float = 6.0  # of the programs' predicted settling time
    large_horizon_factor: float = 2.0  # the same for a fleet of more than `ranked_vehicles`
    unpredicted_time: float = 500.0  # s, where no program predicts a settling time
    shortest_horizon: float = 300.0  # s
    longest_horizon: float = 20_000.0  # s

    # The cost (`cost.py`).
    tail_power: float = 0.25  # weight of the tail in the geometric mean with the typical time
    shortest_time: float = 0.1  # s, lower clamp on both, so that neither is 0
    tail_from: float = 1.0  # m across the track, where the tail begins
    tail_to: float = 0.5  # of the tolerance, where it ends
    tail_vehicles: int = 640  # times shapes that the tail is followed from: a large fleet has one shape
    longest_tail: float = 1e5  # s, upper clamp on the tail
    failure_cost: float = 1e9  # s, of scalars that leave no gains within the conditions

    # The ranking integrator: enough to rank; tests compare its mean settling times with those at 1e-8.
    accuracy: Accuracy = Accuracy(1e-2, 1e-3, 2.0)
    first_step: float = 0.05  # s
    shortest_step: float = 1e-5  # s, below which the integrator gives up
    most_steps: int = 100_000  # of one rollout
    simulated_vehicles: int = 16_384  # side by side: more leave the processor's cache
    steps_between_checks: int = 8  # for what has settled
    settled_for: float = 15.0  # s, or a period of psi: a fleet inside the tolerance for so long counts as settled
    rollout_seconds: float = 600.0  # s of wall clock for one batch of rollouts

    # The programs.
    frequency_range: tuple[float, float] = (0.02, 20.0)  # rad/s, of a designed psi
    ipopt_seconds: float = 120.0  # s of wall clock from one start: a busy machine takes some seconds
    ipopt_iterations: int = 120  # from one start: longer runs find no optimum or one that other starts find
    clarabel_seconds: float = 20.0  # s of wall clock for one program


FAST = Settings()
BEST = replace(
    FAST,
    seconds=600.0,
    searched_vehicles=math.inf,
    own_gains=True,
    final_ranking=True,
    keep_on_interrupt=True,
    training_starts=320,
    heldout_starts=320,
    scalars_starts=24,
    explored=960,
    basins=8,
    rounds=12,
    scalars_share=0.2,
)
MODES = {"fast": FAST, "best": BEST}
