"""The closed loop as a CasADi integrator object (SUNDIALS' CVODES), built once, for any start."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import casadi as ca
import numpy as np

from ...models.algebra.ops import casadi_column, casadi_ops, unbounded
from ...models.equations import State, closed_loop
from ...models.errors import UndecidedError, last_line
from .closed_loop import ClosedLoop, Floats

MAX_STEPS = 200_000  # CVODES steps between two outputs
SX_VEHICLES = 200  # up to this size a scalar expression graph is the faster right-hand side


class CasadiIntegrator:
    """Integrates a closed loop piece by piece: output every `step` s, `piece` s in one call of CVODES."""

    def __init__(self, loop: ClosedLoop, *, step: float, piece: float, tolerance: float, multistep: str) -> None:
        """Build the integrator; `tolerance` is relative and absolute, `multistep` is bdf or adams.

        Raises UndecidedError if CasADi cannot build it.
        """
        n = loop.vehicles
        self.loop, self.step, self.per_piece = loop, step, max(1, round(piece / step))
        ops = casadi_ops() if loop.bounded else unbounded(casadi_ops())
        symbol = ca.SX if n <= SX_VEHICLES else ca.MX
        # The time at which a piece begins is a parameter, so that all pieces share one integrator.
        x, begin, t = symbol.sym("x", 5 * n), symbol.sym("begin"), symbol.sym("t")
        plant, gains, state = loop.plant.map(casadi_column), loop.gains.map(casadi_column), State(*ca.vertsplit(x, n))
        rates = closed_loop(ops, plant, gains, loop.excitation.value(ops, begin + t), state)
        problem = {"x": x, "t": t, "p": begin, "ode": shared(ca.vertcat(*rates))}
        outputs = (step * np.arange(1, self.per_piece + 1)).tolist()
        options = {
            "reltol": tolerance,
            "abstol": tolerance,
            "max_num_steps": MAX_STEPS,
            "linear_multistep_method": multistep,
        }
        try:
            self._integrator = ca.integrator("closed_loop", "cvodes", problem, 0.0, outputs, options)
        except RuntimeError as error:
            raise UndecidedError(f"the integrator cannot be built: {last_line(error)}") from None

    def pieces(self, start: State, begin: float = 0.0) -> Iterator[tuple[Floats, State]]:
        """Piece after piece of the solution from time `begin` (s): times (K,) and states (K, N).

        Raises UndecidedError if CVODES stalls.
        """
        x = np.concatenate(start)
        while True:
            try:
                solved = self._integrator(x0=x, p=begin)
            except RuntimeError as error:
                raise UndecidedError(f"the integrator gave up after t = {begin:g} s: {last_line(error)}") from None
            states = np.asarray(solved["xf"])
            if not np.isfinite(states).all():
                raise UndecidedError(f"the integrator returned numbers that are not finite after t = {begin:g} s")
            x = states[:, -1]
            yield np.asarray(begin + self.step * np.arange(1, self.per_piece + 1), dtype=float), self._state(states)
            begin += self.per_piece * self.step

    def _state(self, columns: Any) -> State:
        blocks = columns.reshape(5, self.loop.vehicles, -1)
        return State(*(block.T for block in blocks))


def shared(expression: Any) -> Any:
    """The expression with common parts computed once; large expressions are returned unchanged."""
    return ca.cse(expression) if isinstance(expression, ca.SX) else expression
