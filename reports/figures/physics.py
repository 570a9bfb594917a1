"""The figure of a validation in MuJoCo: one start beside the model, and the settling times of all."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ...models.fleet import Fleet
from ...verify.physics.validation import PhysicsValidation, Track
from .style import COLOURS, STYLE, plain, save, shown_vehicles

BAND = 0.15  # relative difference of settling times that is shaded


def write_physics(fleet: Fleet, validation: PhysicsValidation, folder: Path, origin: str = "") -> list[Path]:
    """physics.svg and .png: paths of the first start in MuJoCo and in the model; the settling times of every start."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    track = next((result.track for result in validation.results if result.track), None)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.6, 4.2))
        paths, times = figure.subplots(1, 2)
        if track is not None:
            _paths(paths, fleet, track)
        _times(times, validation)
        return save(figure, folder / "physics", origin)


def _paths(axis: Any, fleet: Fleet, track: Track) -> None:
    for i in shown_vehicles(len(fleet)):
        colour = COLOURS[i % len(COLOURS)]
        axis.plot(*track.real[:, :, i].T, color=colour, lw=1.4, label=plain(fleet.names[i]))
        axis.plot(*track.model[:, :, i].T, color=colour, lw=0.9, ls="--")
        axis.plot(*track.real[0, :, i], "o", color=colour, mfc="none", ms=5)
        axis.plot(*track.real[-1, :, i], "o", color=colour, ms=5)
    axis.set(xlabel="x / m", ylabel="y / m", aspect="equal", title="start 0: MuJoCo, dashed the model")
    if len(fleet) <= len(COLOURS):
        axis.legend(fontsize=7)


def _times(axis: Any, validation: PhysicsValidation) -> None:
    both = [
        (result.model_settling_time, result.settling_time)
        for result in validation.results
        if result.settling_time is not None and result.model_settling_time is not None
    ]
    end = 1.1 * max((time for pair in both for time in pair), default=1.0)
    axis.fill_between([0, end], [0, (1 - BAND) * end], [0, (1 + BAND) * end], color="0.9", lw=0)
    axis.plot([0, end], [0, end], color="0.5", lw=0.8)
    if both:
        axis.plot(*zip(*both, strict=True), "o", color=COLOURS[0], ms=5)
    title = f"{len(both)} of {len(validation.results)} starts settle in both; band {100 * BAND:g} %"
    axis.set(xlabel="settling time in the model / s", ylabel="in MuJoCo / s", xlim=(0, end), ylim=(0, end), title=title)
