"""The integrators by name, each with its tolerance, and the choice by the number of vehicles.

| job                  | option               | below LARGE vehicles            | from LARGE vehicles          |
|----------------------|----------------------|---------------------------------|------------------------------|
| `simulate` and `run` | `--engine auto`      | `cvodes`: Adams, 1e-15          | `scale`: Dopri5, 1e-9        |
| `validate`           | `--integrator auto`  | `chaos-aware`: CVODES, 1e-8     | `scale`: Dopri5, 1e-9        |

Any other name chooses its method for every fleet. `validate --integrator dop853` (SciPy's method, at 2.5e-14) is the
independent check. Runs with a disturbance use `sampled_loop.py`.
"""

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
LARGE = 1000  # vehicles; from this size the explicit engine is faster, docs/performance.md


def make_integrator(engine: str, loop: ClosedLoop, *, step: float, piece: float) -> Integrator:
    """The integrator of that name at its tolerance. Raises InputError for an unknown name."""
    if engine not in ENGINES:
        raise InputError(f"engine {engine!r} is not known; choose one of {', '.join(ENGINES)}")
    kind, tolerance = ENGINES[engine]
    return kind(loop, step=step, piece=piece, tolerance=tolerance)


def engine_name(engine: str, vehicles: int, small: str = "cvodes") -> str:
    """The engine to use: "auto" means `small`, or "scale" for a large fleet; any other name is returned."""
    if engine != "auto":
        return engine
    return "scale" if vehicles >= LARGE else small
