"""The two boundedness witnesses, plotted."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ...models.files.text import write_whole
from ...verify.proof.trajectories import bang_bang, rising_energy


def write_witness_figures(folder: Path) -> list[Path]:
    """witness_energy.svg and witness_bang_bang.svg in a folder; returns their paths."""
    return [_energy(folder / "witness_energy.svg"), _bang_bang(folder / "witness_bang_bang.svg")]


def _energy(path: Path) -> Path:
    run, energy = rising_energy(0.05)  # the rise lasts 0.015 s; then vehicle 2 is fast as well
    figure, (top, bottom) = _axes()
    top.plot(run.t, energy, color="#b3322e")
    top.set_ylabel("W")
    top.set_title("The paper's gains satisfy (15), and W rises while |ω₁| ≥ 1")
    for i in range(2):
        bottom.plot(run.t, run.state.omega[:, i], label=f"ω of vehicle {i + 1}")
    return _finish(figure, bottom, path, "rad/s")


def _bang_bang(path: Path) -> Path:
    swings = bang_bang()
    figure, (top, bottom) = _axes()
    top.plot(swings.t, swings.theta, color="#2f5f9d")
    top.set_ylabel("θ, rad")
    top.set_title("(15) holds, the push ±0.76 switches sign: sup |ω| grows without bound")
    bottom.plot(swings.t, swings.omega, label="ω", color="#b3322e")
    guaranteed = np.sqrt(2 * 0.1408 * (swings.reaches - 1))
    bottom.axhline(-guaranteed[-1], linestyle="--", color="grey", label="bound from below of the last peak")
    return _finish(figure, bottom, path, "rad/s")


def _axes() -> tuple[Any, Any]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8, 5), layout="constrained")
    return figure, figure.subplots(2, 1, sharex=True)


def _finish(figure: Any, axes: Any, path: Path, unit: str) -> Path:
    axes.set_xlabel("t, s")
    axes.set_ylabel(unit)
    axes.legend()
    return write_whole(path, lambda file: figure.savefig(file, format="svg"))
