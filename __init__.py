"""gaincert: certified gains for bounded leader-follower formation control of differential-drive robots."""

from __future__ import annotations

import importlib
from typing import Any

__version__ = "0.2.0"

_HOMES = {
    "load_fleet": "models.files.fleet_file",
    "build_fleet": "models.files.fleet_file",
    "load_gains": "models.files.gains_file",
    "Fleet": "models.fleet",
    "Vehicle": "models.fleet_tables",
    "Excitation": "models.excitation",
    "Gains": "models.gains",
    "Saturation": "models.saturation",
    "design": "synthesis.design",
    "certify": "verify.certificates.certify",
    "Certificate": "verify.certificates.certify",
    "prove": "verify.proof",
    "simulate": "verify.simulation.simulate",
    "summarize": "verify.simulation.simulate",
    "read_trajectory": "verify.simulation.trajectory",
    "plot_paths": "reports.figures.plots",
    "plot_poses": "reports.figures.plots",
    "plot_cross_track": "reports.figures.plots",
    "plot_torques": "reports.figures.plots",
    "plot_wheel_torques": "reports.figures.plots",
    "plot_energies": "reports.figures.plots",
    "write_report": "reports.html.page",
    "export": "reports.export.formats",
}

__all__ = [*_HOMES, "__version__"]


def __getattr__(name: str) -> Any:
    """Public names are imported when they are first used: `import gaincert` loads no solver and no plotting."""
    if name in _HOMES:
        return getattr(importlib.import_module(f".{_HOMES[name]}", __name__), name)
    raise AttributeError(f"module 'gaincert' has no attribute {name!r}")
