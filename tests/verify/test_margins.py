"""Margins: the largest disturbances with which all starts settle, by bisection with the other disturbances on."""

from dataclasses import replace
from types import SimpleNamespace

import pytest
from gaincert.models.errors import UndecidedError
from gaincert.models.files.gains_file import GainsFile
from gaincert.models.starts import random_starts
from gaincert.models.tolerance import Tolerance
from gaincert.verify.simulation.closed_loop import ClosedLoop
from gaincert.verify.simulation.disturbance import Disturbance
from gaincert.verify.simulation.sampled_loop import SampledLoop
from gaincert.verify.validation.margins import HALVINGS, Margin, margins, searches_for, with_value
from gaincert.verify.validation.robustness import robustness

REAL = Disturbance(0.02, delay=0.04, coulomb=0.1, noise_position=0.01, noise_heading=0.05)
KINDS = ["sample_time", "delay", "coulomb", "noise_position"]


@pytest.fixture
def sampled(paper, gains_of_paper, psi_of_paper):
    gains = GainsFile(gains_of_paper, psi_of_paper, None, None)
    return SampledLoop(paper, ClosedLoop.of(paper, gains.gains, gains.excitation), REAL, 20.0, Tolerance(25.0, 8.0))


class Acceptable:
    """Outcomes of a run that is acceptable up to a limit; what it ran under is written down."""

    def __init__(self, monkeypatch, kind, limit):
        self.tried = []

        def outcomes(loop, _starts):
            self.tried.append(loop.disturbance)
            if getattr(loop.disturbance, kind) > 100 * limit:
                raise UndecidedError("no longer finite")
            return self

        self.kind, self.limit = kind, limit
        monkeypatch.setattr(SampledLoop, "outcomes", outcomes)

    @property
    def acceptable(self):
        return getattr(self.tried[-1], self.kind) <= self.limit


@pytest.mark.parametrize("kind", KINDS)
def test_the_limit_is_found_with_the_other_disturbances_on(sampled, kind, monkeypatch):
    (search,) = (one for one in searches_for(sampled) if one.kind == kind)
    limit = search.low * (search.high / search.low) ** 0.6
    run = Acceptable(monkeypatch, kind, limit)
    found = {margin.search.kind: margin for margin in margins(sampled, [], lambda *_: None)}
    step = (search.high / search.low) ** (0.5**HALVINGS)
    assert limit / step <= found[kind].largest <= limit
    assert found[kind].present == getattr(REAL, kind)
    alone = [one for one in run.tried if getattr(one, kind) != getattr(REAL, kind)]
    assert len(alone) == HALVINGS
    changed = {"noise_heading": REAL.noise_heading} if kind == "noise_position" else {}
    assert all(replace(one, **{kind: getattr(REAL, kind)}, **changed) == REAL for one in alone)


def test_robustness_searches_from_the_fleets_disturbance_and_only_on_request(sampled, paper, monkeypatch):
    run = Acceptable(monkeypatch, "delay", 1.0)
    monkeypatch.setattr("gaincert.verify.validation.robustness.parts", lambda _: [])
    spec = SimpleNamespace(loop=sampled.loop, horizon=20.0, tolerance=sampled.tolerance)
    assert robustness(paper, spec, [], [], disturbance=REAL, search=False).margins == ()
    assert run.tried == []
    found = robustness(paper, spec, [], [], disturbance=REAL, search=True)
    assert [margin.present for margin in found.margins] == [0.02, 0.04, 0.1, 0.01]
    assert list(found.to_json()["margins"]) == KINDS
    assert [line.startswith("margins: all starts settle with") for line in found.sentences()] == [True] * 4
    assert robustness(paper, spec, [], [], disturbance=None, search=True).margins[1].present == 0


def test_where_nothing_settles_there_is_no_margin(sampled, monkeypatch):
    Acceptable(monkeypatch, "sample_time", 0.0)
    found = margins(sampled, [], lambda *_: None)
    assert [margin.largest for margin in found] == [None] * 4
    assert found[0].sentence() == "margins: not all starts settle with any sample time from 0.002 s"


def test_noise_of_headings_grows_with_that_of_positions(sampled):
    assert with_value(sampled, "noise_position", 0.02).disturbance.noise_heading == pytest.approx(0.1)
    silent = replace(sampled, disturbance=Disturbance(0.02))
    assert with_value(silent, "noise_position", 0.5).disturbance.noise_heading == pytest.approx(0.16)


def test_the_runs_at_the_margin_settle(sampled, paper):
    """With real runs: the paper's gains and a wide tolerance, sampled for a second."""
    short = replace(sampled, disturbance=Disturbance(0.1), horizon=1.0)
    starts = random_starts(paper, 1, seed=1, half_width=3.0)
    found = margins(short, starts, lambda *_: None)
    assert [margin.search.kind for margin in found] == KINDS
    for margin in found:
        assert with_value(short, margin.search.kind, margin.largest).outcomes(starts).acceptable


def test_a_margin_in_words_and_in_json(sampled):
    margin = Margin(searches_for(sampled)[1], 0.04, 0.25)
    assert margin.sentence() == "margins: all starts settle with delay up to 0.25 s"
    assert margin.to_json() == {"largest": 0.25, "present": 0.04, "unit": "s", "tried": [0.02, 20.0]}
