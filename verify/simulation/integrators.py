"""Independent integrators of a `ClosedLoop`: CVODES on the CasADi expression, DOP853 on the NumPy one.

Each returns the solution piece by piece on a grid, and on a finer grid between two grid points.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import Any

import numpy as np

from ...models.equations import State
from ...models.errors import UndecidedError
from .closed_loop import ClosedLoop, Floats
from .cvodes import CasadiIntegrator

SUBSTEPS = 50  # points of the finer grid in one step


class Integrator(ABC):
    """Produces a run, and the solution within one of its steps."""

    def __init__(self, loop: ClosedLoop, *, step: float, piece: float, tolerance: float) -> None:
        """Output every `step` s in pieces of `piece` s; `tolerance` is relative and absolute, in SI units."""
        self.loop, self.step, self.piece, self.tolerance = loop, step, piece, tolerance
        self.per_piece = max(1, round(piece / step))

    def with_tolerance(self, tolerance: float) -> Integrator:
        """The same method at another tolerance."""
        return type(self)(self.loop, step=self.step, piece=self.piece, tolerance=tolerance)

    @abstractmethod
    def pieces(self, start: State, begin: float = 0.0) -> Iterator[tuple[Floats, State]]:
        """Times (K,) after `begin` and states (K, N), piece by piece, without end and without the start itself."""

    @abstractmethod
    def between(self, t: float, state: State) -> tuple[Floats, State]:
        """The solution at SUBSTEPS points of (t, t + step], from `state` at time t."""


class Cvodes(Integrator):
    """SUNDIALS' CVODES, Newton's method with CasADi's sparse analytic Jacobian, backward differentiation."""

    multistep = "bdf"

    def __init__(self, loop: ClosedLoop, *, step: float, piece: float, tolerance: float) -> None:
        """Settings only: the CasADi integrators are built when they are first needed."""
        super().__init__(loop, step=step, piece=piece, tolerance=tolerance)
        self._grid: CasadiIntegrator | None = None
        self._finer: CasadiIntegrator | None = None

    def _built(self, step: float, piece: float) -> CasadiIntegrator:
        return CasadiIntegrator(self.loop, step=step, piece=piece, tolerance=self.tolerance, multistep=self.multistep)

    def pieces(self, start: State, begin: float = 0.0) -> Iterator[tuple[Floats, State]]:
        """See `Integrator`."""
        self._grid = self._grid or self._built(self.step, self.piece)
        return self._grid.pieces(start, begin=begin)

    def between(self, t: float, state: State) -> tuple[Floats, State]:
        """See `Integrator`."""
        self._finer = self._finer or self._built(self.step / SUBSTEPS, self.step)
        return next(self._finer.pieces(state, begin=t))


class Adams(Cvodes):
    """CVODES by Adams-Moulton formulas: at tolerances below 1e-10 fewer steps than by backward differentiation."""

    multistep = "adams"


class Explicit(Integrator):
    """An explicit method that integrates `rates(t, x)` over x, the five columns of the state end to end."""

    @abstractmethod
    def solve(self, begin: float, x: Floats, times: Floats) -> Floats:
        """The solution from x at `begin` at the times (K,), as (K, 5 N). Raises UndecidedError."""

    def pieces(self, start: State, begin: float = 0.0) -> Iterator[tuple[Floats, State]]:
        """See `Integrator`."""
        x = np.concatenate(start)
        while True:
            times = np.asarray(begin + self.step * np.arange(1, self.per_piece + 1), dtype=float)
            rows = self.solve(begin, x, times)
            yield times, self._states(rows)
            begin, x = float(times[-1]), rows[-1]

    def between(self, t: float, state: State) -> tuple[Floats, State]:
        """See `Integrator`."""
        times = np.asarray(t + self.step / SUBSTEPS * np.arange(1, SUBSTEPS + 1), dtype=float)
        return times, self._states(self.solve(t, np.concatenate(state), times))

    def _states(self, rows: Floats) -> State:
        return State(*(rows[:, i * self.loop.vehicles : (i + 1) * self.loop.vehicles] for i in range(5)))


class Dop853(Explicit):
    """SciPy's Runge-Kutta method of order 8 on the NumPy equations: it shares no integration code with CVODES."""

    def _rate(self, t: float, x: Any) -> Any:
        return np.concatenate(self.loop.rates(t, State(*x.reshape(5, -1))))

    def solve(self, begin: float, x: Floats, times: Floats) -> Floats:
        """See `Explicit`."""
        from scipy.integrate import solve_ivp

        accuracy = {"rtol": self.tolerance, "atol": self.tolerance}
        run = solve_ivp(self._rate, (begin, times[-1]), x, "DOP853", times, **accuracy)
        if run.status != 0 or not np.isfinite(run.y).all():
            raise UndecidedError(f"DOP853 gave up after t = {begin:g} s: {run.message}")
        return np.ascontiguousarray(run.y.T)
