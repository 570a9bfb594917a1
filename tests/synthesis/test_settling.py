"""Rollouts side by side: as accurate as one by one, and independent of each other."""

import math
import statistics
from dataclasses import replace

import numpy as np
import pytest
from gaincert.models.arrays import floats
from gaincert.models.equations import State
from gaincert.models.paper import paper_fleet
from gaincert.models.starts import Draw
from gaincert.models.tolerance import Tolerance
from gaincert.synthesis.rates import CrossTrack
from gaincert.synthesis.rollouts.settling import Limits, Trial, settle_all
from gaincert.synthesis.rollouts.tail_times import tail_times
from gaincert.synthesis.scaled_gains import Scalars
from gaincert.synthesis.settings import FAST, Accuracy, Settings
from gaincert.synthesis.task import Options, Task, prepare
from gaincert.verify.simulation.closed_loop import ClosedLoop
from gaincert.verify.simulation.integrators import Adams, Dop853

GOOD = Scalars(0.15, 0.26, 3.9, 0.033, 0.14, 3.2)
SLOW = Scalars(0.3, 0.8, 1.0, 0.1, 0.9, 1.1)
LIMITS = Limits(1000.0)  # s


@pytest.fixture(scope="module")
def task() -> Task:
    return prepare(paper_fleet(), Options("corrected", "designed"))


def trial(task: Task, scalars: Scalars) -> Trial:
    candidate = task.candidate("here", scalars)
    return Trial(candidate.gains.map(floats), candidate.excitation)


def one_by_one(task: Task, scalars: Scalars, start: State) -> float:
    """The settling time (s) by CVODES at 1e-8, on a grid of 0.1 s."""
    candidate = task.candidate("here", scalars)
    loop, last = ClosedLoop.of(task.fleet, candidate.gains, candidate.excitation), 0.0
    for t, states in Adams(loop, step=0.1, piece=50.0, tolerance=1e-8).pieces(start):
        outside = t[loop.excess(states, Tolerance(0.1, 0.1)) > 1]
        last = float(outside[-1]) if len(outside) else last
        if last < t[0] - 0.1 or t[-1] > LIMITS.horizon:
            return last
    raise AssertionError("pieces end only here")


def test_a_rollout_does_not_depend_on_those_beside_it(task: Task) -> None:
    """Alone, among others with other gains, and in a place that another one has left: the same to the last bit."""
    trials, starts = [trial(task, GOOD), trial(task, SLOW)], task.starts(Draw.TRAINING, 4)

    def settled(trials: list[Trial], starts: list[State], settings: Settings = FAST) -> list[list[tuple[object, ...]]]:
        found = settle_all(task.plant, trials, starts, Limits(150.0), task.tolerance, settings)
        return [[(*one[:3], np.concatenate(one.final).tolist(), one.steps) for one in row if one] for row in found]

    together = settled(trials, starts)
    alone = [[settled([one], [start])[0][0] for start in starts] for one in trials]
    narrow = settled(trials, starts, replace(FAST, simulated_vehicles=3 * len(task.fleet)))
    assert len(together[0]) == len(starts)
    assert together == alone == narrow


def test_each_rollout_follows_its_own_trial_and_start(task: Task) -> None:
    """With short steps, before chaos: every column ends where the true solution is then."""
    fine = replace(FAST, accuracy=Accuracy(1e-5, 1e-6, 2.0))
    candidates, starts = [task.candidate("here", scalars) for scalars in (GOOD, SLOW)], task.starts(Draw.TRAINING, 2)
    trials = [Trial(one.gains.map(floats), one.excitation) for one in candidates]
    settled = settle_all(task.plant, trials, starts, Limits(4.0), task.tolerance, fine)
    for one, row in zip(candidates, settled, strict=True):
        loop = ClosedLoop.of(task.fleet, one.gains, one.excitation)
        for settling, start in zip(row, starts, strict=True):
            assert settling is not None
            true = Dop853(loop, step=0.1, piece=10.0, tolerance=1e-8).solve(
                0, np.concatenate(start), np.array([settling.end])
            )
            assert settling.end >= 4
            assert np.abs(np.concatenate(settling.final) - true[0]).max() < 0.01 * np.abs(true[0]).max()


@pytest.mark.slow
def test_the_ranking_integrator_is_accurate_enough(task: Task) -> None:
    """Two digits in single precision tell the mean settling time as eight do: single starts are chaotic."""
    starts = task.starts(Draw.TRAINING, 80)
    found = [one.time for one in settle_all(task.plant, [trial(task, GOOD)], starts, LIMITS, task.tolerance)[0] if one]
    true = [one_by_one(task, GOOD, start) for start in starts]
    chance = math.hypot(*(statistics.stdev(times) / math.sqrt(len(starts)) for times in (found, true)))
    assert abs(statistics.fmean(found) - statistics.fmean(true)) < 3 * chance < 0.2 * statistics.fmean(true)


def test_the_clock_ends_a_batch(task: Task) -> None:
    out_of_time, starts = replace(FAST, rollout_seconds=0.0), task.starts(Draw.TRAINING, 2)
    settled = settle_all(task.plant, [trial(task, GOOD)], starts, LIMITS, task.tolerance, out_of_time)
    assert settled == [[None] * 3]


@pytest.mark.parametrize("scalars", [GOOD, SLOW])
def test_tails_together_are_tails_one_by_one(task: Task, scalars: Scalars) -> None:
    """Every column has the flow of its own trial, and columns within the tolerance take no time."""
    trials = [trial(task, FAST) for FAST in (GOOD, SLOW, scalars)]
    y = 0.08 * np.random.default_rng(0).uniform(-1, 1, (6, 12))
    y[:, 0] = 1e-6
    half = Tolerance(0.05, 0.05)
    chosen = [k % 3 for k in range(12)]
    found = tail_times(task.plant, trials, chosen, y, half)
    true = [
        CrossTrack(task.plant, *trials[k]).time_to(column, 0.05, 0.05, 1e-5)[0]
        for k, column in zip(chosen, y.T, strict=True)
    ]
    assert found[0] == true[0] == 0
    assert np.median(np.abs(found - true)[1:] / true[1:]) < 0.02
    assert found == pytest.approx(true, rel=0.3)
