"""The paper's definitions: vehicles, graph, excitation, controller, energies and conditions; no solver, no plot."""

from __future__ import annotations

import importlib
from typing import Any

_HOMES = {"Fleet": "fleet", "Vehicle": "fleet_tables", "Excitation": "excitation", "Gains": "gains", "Graph": "graph"}

__all__ = list(_HOMES)


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used, so that one module does not load all others."""
    if name in _HOMES:
        return getattr(importlib.import_module(f".{_HOMES[name]}", __name__), name)
    raise AttributeError(f"module 'gaincert.models' has no attribute {name!r}")
