"""Plots return their axes: a new figure's, or those that they were given; figure 7 shows torques in N m."""

import numpy as np
import pytest
from gaincert.models.equations import State
from gaincert.models.paper import paper_fleet
from gaincert.reports.figures.plots import (
    plot_cross_track,
    plot_energies,
    plot_paths,
    plot_poses,
    plot_torques,
    plot_wheel_torques,
)
from gaincert.reports.figures.run_figures import DRAWINGS, write_figures
from gaincert.reports.figures.style import STYLE, save
from gaincert.verify.simulation.trajectory import Trajectory
from matplotlib import rc_context
from matplotlib.figure import Figure

REST = ("tau_left", "tau_right", "V", "W")
PANELS = {
    plot_paths: 1,
    plot_poses: 3,
    plot_cross_track: 1,
    plot_torques: 1,
    plot_wheel_torques: 2,
    plot_energies: 1,
}


@pytest.fixture(scope="module")
def run():
    """Torques that swing between -50 and 50 N m, with one peak of -54 N m at one stored point."""
    t = np.linspace(0, 400, 4001)
    wave = np.outer(np.exp(-t / 100), np.ones(6))
    torque = 50 * np.sin(3 * t)[:, None] * np.ones(6)
    torque[1234, 4] = -54.0
    return Trajectory(t, State(wave, wave, wave, wave, wave), torque, torque / 2, wave[:, 0], wave[:, 0])


@pytest.mark.parametrize("plot", PANELS, ids=lambda plot: plot.__name__)
def test_a_plot_returns_its_axes(plot, run):
    own = plot(paper_fleet(), run)
    panels = np.atleast_1d(own)
    assert panels.shape == (PANELS[plot],)
    assert all(axis.lines for axis in panels)
    given = Figure().subplots(PANELS[plot])
    assert plot(paper_fleet(), run, given) is given
    assert all(axis.lines for axis in np.atleast_1d(given))


def test_wheel_torques_are_in_newton_metres_and_lose_no_peak(run):
    left, right = plot_wheel_torques(paper_fleet(), run)
    assert left.get_yscale() == right.get_yscale() == "linear"
    assert left.get_ylabel() == "left wheel / N m"
    assert min(line.get_ydata().min() for line in left.lines[:6]) == -54.0
    assert max(line.get_ydata().max() for line in right.lines[:6]) == pytest.approx(25, rel=1e-3)
    levels = {line.get_ydata()[0] for line in left.lines[6:]}
    assert levels == {55.0, -55.0, 56.0, -56.0, 160.0, -160.0}


def test_every_figure_is_written_as_svg_png_and_pdf(run, tmp_path):
    short = Trajectory(
        run.t[:50], State(*(column[:50] for column in run.state)), *(getattr(run, name)[:50] for name in REST)
    )
    write_figures(paper_fleet(), {"bounded": short}, tmp_path, "fleet x, gains y")
    for name in DRAWINGS:
        for kind, end in (("svg", b"</svg>"), ("png", b"IEND\xaeB`\x82"), ("pdf", b"%%EOF")):
            assert (tmp_path / f"{name}.{kind}").read_bytes().rstrip().endswith(end)


def test_the_same_figure_is_the_same_bytes(tmp_path):
    for folder in ("a", "b"):
        with rc_context(STYLE):
            figure = Figure()
            figure.subplots().plot([1, 2], [3, 1])
            save(figure, tmp_path / folder / "figure", "fleet x, gains y")
    for kind in ("svg", "png", "pdf"):
        assert (tmp_path / "a" / f"figure.{kind}").read_bytes() == (tmp_path / "b" / f"figure.{kind}").read_bytes()
