"""The horizon is not an answer: a run settles if it stays so, and a run that has not says what it does at its end."""

import math

import numpy as np
import pytest
from gaincert.models.tolerance import Tolerance
from gaincert.verify.simulation.closed_loop import ClosedLoop
from gaincert.verify.simulation.disturbance import Disturbance
from gaincert.verify.simulation.sampled_loop import SampledLoop
from gaincert.verify.simulation.settling import Approach, confirmed_by
from gaincert.verify.simulation.simulate import simulate, summarize
from gaincert.workflows.simulate import sentence

WIDE = Tolerance(35.0, 7.0)  # in which the fleet comes after half a minute


def test_a_fleet_that_comes_in_at_the_end_has_not_settled(paper, gains_of_paper) -> None:
    """The same start, a run that ends just after it comes in and one that goes on for a tenth more."""
    loop = ClosedLoop.of(paper, gains_of_paper, paper.psi)
    longer = simulate(paper, gains_of_paper, paper.psi, horizon=100)
    time = summarize(paper, longer, WIDE).settling_time
    assert 40 < time < 70
    end = math.ceil(10 * time) / 10 + 0.1
    early = simulate(paper, gains_of_paper, paper.psi, horizon=end)
    assert loop.excess(early.state, WIDE)[-1] < 1
    summary = summarize(paper, early, WIDE)
    assert summary.settling_time == math.inf
    assert sentence(summary).startswith(f"not settled within {end:g} s (still closing in)")
    assert summary.to_json()["approach"] == "still closing in"
    for horizon, settled in ((end, False), (100.0, True)):
        outcomes = SampledLoop(paper, loop, Disturbance(0.002), horizon, WIDE).outcomes([paper.start()])
        assert math.isfinite(outcomes.settling_time[0]) == settled


def test_a_run_stays_for_a_period_of_psi_or_a_tenth(paper, gains_of_paper) -> None:
    loop = ClosedLoop.of(paper, gains_of_paper, paper.psi)
    period = 2 * math.pi / float(paper.psi.frequency)
    assert confirmed_by(loop, 1000.0) == pytest.approx(1000 - period)
    assert confirmed_by(loop, 10.0) == pytest.approx(9.0)


def test_a_fleet_that_begins_at_its_goal_is_settled_from_the_beginning(paper, gains_of_paper) -> None:
    run = simulate(paper, gains_of_paper, paper.psi, horizon=1)
    assert summarize(paper, run, Tolerance(1e3, 1e3)).settling_time == 0


def test_friction_that_holds_the_robots_is_standing_still(paper, gains_of_paper) -> None:
    loop = ClosedLoop.of(paper, gains_of_paper, paper.psi)
    outcomes = SampledLoop(paper, loop, Disturbance(0.02, coulomb=10.0), 30.0, Tolerance()).outcomes([paper.start()])
    assert outcomes.settling_time[0] == math.inf
    assert outcomes.approach == (Approach.STANDING_STILL,)


@pytest.mark.parametrize(
    ("excess", "expected"),
    [
        (lambda t: 1 + 1 / np.sqrt(1 + t), Approach.CLOSING_IN),
        (lambda t: 3 + 0 * t, Approach.STANDING_STILL),
        (lambda t: 3 + np.sin(t), Approach.STANDING_STILL),
        (lambda t: 1 + t, Approach.MOVING_AWAY),
    ],
)
def test_the_last_two_tenths_say_where_a_run_goes(excess, expected) -> None:
    t = np.linspace(0.1, 500, 5000)
    assert Approach.of_history(t, excess(t)) is expected
