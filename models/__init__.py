"""What the paper defines: vehicles, graph, excitation, controller, energies and conditions; no solver, no plot."""

from __future__ import annotations

import importlib
from typing import Any

_HOMES = {"Fleet": "fleet", "Vehicle": "fleet_tables", "Excitation": "excitation", "Gains": "gains", "Graph": "graph"}

__all__ = list(_HOMES)


def __getattr__(name: str) -> Any:
    """Public names are imported when they are first used, so that one module does not load all."""
    if name in _HOMES:
        return getattr(importlib.import_module(f".{_HOMES[name]}", __name__), name)
    raise AttributeError(f"module 'gaincert.models' has no attribute {name!r}")
