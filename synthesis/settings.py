"""Every number that decides how `design` searches, in one place: what it means, its unit, and what it was tuned on.

Unless a field says otherwise it was tuned on the paper's six vehicles with and without speed limits, the mixed ring and
the TurtleBot3 line, by the settling times of designs from starts that the search had not seen. Lengths and times are
given in the fleet's own units: its tolerance, its sample time, tau. So a fleet in other units gets the same design.
"""

from __future__ import annotations

from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Settings:
    """The numbers of the design and its search. DRAFT, FAST and BEST are those of the three modes."""

    # How long the search goes on. It counts work, not time, so that its result is the same on every machine.
    work: float = 2.5e9  # evaluations of one vehicle's controller, 20 ns each: 25 s on two cores; 0: no search
    separate_gains: bool = False  # whether the search goes on to separate gains and scales per vehicle or role
    keep_on_interrupt: bool = False  # whether an interrupt ends the search with its best, and not the program

    # Starts. Far ones are random, near ones are small errors across the track, which fall most slowly.
    training_starts: int = 160  # far ones that the strategies learn from, generation after generation others of them
    heldout_starts: int = 48  # far ones on which new candidates are compared: the training starts flatter them
    ranking_starts: int = 100  # far ones of the ranking in the end
    ranking_work: float = 1e9  # evaluations after which the ranking does not wait for more starts to settle
    explored_starts: int = 6  # far ones per random candidate of the exploration
    learned_starts: int = 8  # far ones of a generation; tuned on the paper's fleet under (15) and (16), seeds 0 to 4
    near_share: float = 1 / 3  # near starts per far start
    near_errors: float = 1.0  # the largest error of a near start, in tolerances
    near_tolerance: float = 0.5  # of the tolerance, into which near starts have to settle: no error may freeze there
    near_patterns: float = 0.3  # how far its pattern is from the graph's slowest mode, relative
    starts_vehicles: int = 2000  # in all far starts of a comparison together: a large fleet is simulated from fewer

    # Exploration: random candidates around the fleet's typical scalars and around those of the averaged program.
    explored: int = 960  # candidates
    exploration_batch: int = 240  # candidates at a time: the best so far limits how long the next are simulated
    exploration_spread: float = 0.8  # standard deviation, in logarithms
    explored_friction: float = 0.5  # of the friction of the fleet's wheels
    exploration_share: float = 0.25  # of the work, after which it ends
    first_horizon: float = 64.0  # tau, and the way at top speed; doubled until enough candidates settle
    longest_horizon: float = 2.0**14  # the same
    basins: int = 2  # of the best explored points, from which runs of CMA-ES begin; tuned as learned_starts
    basin_distance: float = 0.5  # largest difference, in logarithms, below which two beginnings count as one

    # CMA-ES over the scalars; the worse half of the runs ends after each round.
    generations: int = 10  # of one round, between two comparisons
    population: int = 12
    spread: float = 0.35  # standard deviation of the first generation, in logarithms
    converged: float = 0.01  # standard deviation, in logarithms, at which a run ends
    elite: int = 6  # best candidates of all runs that are ranked in the end
    scalars_share: float = 1.0  # of the work, after which the scalars are left

    # CMA-ES over separate gains and scales.
    separate_population: int = 24
    separate_spread: float = 0.1  # standard deviation of the first generation, in logarithms
    separate_vehicles: int = 12  # the largest fleet in which every vehicle has its own
    roles_vehicles: int = 40  # the largest fleet in which every role in the graph has its own

    # In larger fleets the scalars are searched on a part.
    part_vehicles: int = 12  # linked vehicles around the slowest
    part_elite: int = 2  # best candidates of the part that are ranked in the whole

    # How far candidates are simulated, in multiples of the least cost so far.
    explored_horizon: float = 3.0
    learned_horizon: float = 4.0
    compared_horizon: float = 6.0
    ranked_horizon: float = 20.0

    # The cost (`cost.py`).
    power: float = 2.0  # of the mean over starts: late starts weigh more
    largest_excess: float = 1e6  # upper clamp on an error over its tolerance
    failure: float = 1e6  # cost of gains that leave nothing within the conditions, in the longest horizon

    # How robots differ from the model where the fleet has no [disturbance].
    sample_time: float = 0.02  # s, for which torques are held: the one length of time that no fleet says
    noise_position: float = 0.05  # of the tolerance, standard deviation of measured coordinates
    noise_heading: float = 0.1  # of the tolerance, of measured headings

    # The ranking integrators: enough to rank; tests compare their mean settling times with those at 1e-8.
    relative_error: float = 1e-2  # of a Runge-Kutta step
    absolute_error: float = 1e-2  # of the same, in tolerances
    speed_unit: float = 50.0  # sample times in which an error of speed makes an error of position
    longest_step: float = 100.0  # sample times
    shortest_step: float = 1e-4  # sample times, below which the integrator gives up
    simulated_vehicles: int = 16_384  # side by side: more leave the processor's cache
    steps_between_checks: int = 8  # for what has settled
    settled_periods: float = 2.0  # of psi: a fleet inside the tolerance for so long and for
    settled_share: float = 0.2  # of the time that it has run counts as settled
    seconds: float = 3600.0  # s of wall clock for one batch of rollouts: a guard

    # The programs.
    ipopt_seconds: float = 120.0  # s of wall clock from one start: a busy machine takes some seconds
    ipopt_iterations: int = 120  # from one start: longer runs find no optimum or one that other starts find
    clarabel_seconds: float = 20.0  # s of wall clock for one program

    def near_count(self, far: int) -> int:
        """How many near starts go with so many far ones: an even number, so that halves are fair."""
        return 2 * max(1, round(self.near_share * far / 2))


FAST = Settings()
DRAFT = replace(
    FAST,
    work=2e8,
    explored=240,
    generations=3,
    converged=0.05,
    training_starts=24,
    heldout_starts=8,
    ranking_starts=12,
)
BEST = replace(FAST, separate_gains=True, keep_on_interrupt=True, basins=8, scalars_share=0.4)
MODES = {"draft": DRAFT, "fast": FAST, "best": BEST}
WORK_PER_SECOND = 1e8  # of two cores, which a time limit is translated with
