"""Which integrator a name and a number of vehicles stand for."""

from __future__ import annotations

from ...models.errors import InputError
from .chaos_aware import Staged
from .integrators import Adams, Dop853, Integrator
from .large_fleet import Dopri5
from .loop import Loop

ENGINES: dict[str, tuple[type[Integrator], float]] = {  # and the tolerance that it is used at
    "cvodes": (Adams, 1e-15),
    "staged": (Staged, 1e-8),
    "dop853": (Dop853, 2.5e-14),
    "scale": (Dopri5, 1e-9),
}
LARGE = 1000  # vehicles; from here the explicit engine is the faster one, docs/performance.md


def make(engine: str, loop: Loop, *, step: float, piece: float) -> Integrator:
    """The integrator of that name, built at its tolerance. Raises InputError."""
    if engine not in ENGINES:
        raise InputError(f"engine {engine!r} is not known; choose one of {', '.join(ENGINES)}")
    kind, tolerance = ENGINES[engine]
    return kind(loop, step=step, piece=piece, tolerance=tolerance)


def named(engine: str, vehicles: int, small: str = "cvodes") -> str:
    """The engine that "auto" stands for, for a number of vehicles; every other name stands for itself."""
    if engine != "auto":
        return engine
    return "scale" if vehicles >= LARGE else small
