"""The integrators by name, with the tolerance each is used at, and the choice for a number of vehicles."""

from __future__ import annotations

from ...models.errors import InputError
from .chaos_aware import ChaosAware
from .closed_loop import ClosedLoop
from .integrators import Adams, Dop853, Integrator
from .large_fleet import Dopri5

ENGINES: dict[str, tuple[type[Integrator], float]] = {  # name: class, tolerance
    "cvodes": (Adams, 1e-15),
    "chaos-aware": (ChaosAware, 1e-8),
    "dop853": (Dop853, 2.5e-14),
    "scale": (Dopri5, 1e-9),
}
LARGE = 1000  # vehicles; from here on the explicit engine is faster, docs/performance.md


def make_integrator(engine: str, loop: ClosedLoop, *, step: float, piece: float) -> Integrator:
    """The integrator of that name at its tolerance. Raises InputError for an unknown name."""
    if engine not in ENGINES:
        raise InputError(f"engine {engine!r} is not known; choose one of {', '.join(ENGINES)}")
    kind, tolerance = ENGINES[engine]
    return kind(loop, step=step, piece=piece, tolerance=tolerance)


def engine_name(engine: str, vehicles: int, small: str = "cvodes") -> str:
    """The engine to use: "auto" means `small`, or "scale" for a large fleet; other names stand for themselves."""
    if engine != "auto":
        return engine
    return "scale" if vehicles >= LARGE else small
