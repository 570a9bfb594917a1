"""Rollouts of the closed loop by CasADi's CVODES, built once per fleet and excitation, with the gains as parameters."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import casadi as ca
import numpy as np

from ...models.algebra.ops import casadi_column, casadi_ops, unbounded
from ...models.equations import Plant, State, closed_loop
from ...models.errors import UndecidedError, last_line
from ...models.excitation import Excitation
from ...models.gains import GAIN_NAMES, Gains
from .loop import Floats

MAX_STEPS = 200_000  # of CVODES between two outputs
SX_VEHICLES = 200  # up to here a scalar expression graph is the faster right-hand side


class Rollout:
    """The closed loop of one plant under one excitation, integrated piece by piece for any gains and start."""

    def __init__(
        self,
        plant: Plant,
        excitation: Excitation,
        *,
        step: float,
        piece: float,
        reltol: float,
        abstol: float,
        bounded: bool,
        multistep: str,
    ) -> None:
        """Build the integrator: output every `step` s, in pieces of `piece` s; `multistep` is bdf or adams."""
        self.vehicles = plant.graph.vehicles
        self.per_piece = max(1, round(piece / step))
        self.step = step
        ops = casadi_ops() if bounded else unbounded(casadi_ops())
        symbol = ca.SX if self.vehicles <= SX_VEHICLES else ca.MX
        x = symbol.sym("x", 5 * self.vehicles)
        p = symbol.sym("p", 5 * self.vehicles + 1)
        t = symbol.sym("t")
        # psi is read at (start of the piece) + t, so that all pieces share one integrator.
        *columns, begin = ca.vertsplit(p, [*range(0, 5 * self.vehicles + 1, self.vehicles), 5 * self.vehicles + 1])
        state = State(*ca.vertsplit(x, self.vehicles))
        rates = closed_loop(ops, plant.map(casadi_column), Gains(*columns), excitation.value(ops, begin + t), state)
        problem = {"x": x, "t": t, "p": p, "ode": shared(ca.vertcat(*rates))}
        outputs = (step * np.arange(1, self.per_piece + 1)).tolist()
        options = {
            "reltol": reltol,
            "abstol": abstol,
            "max_num_steps": MAX_STEPS,
            "linear_multistep_method": multistep,
        }
        try:
            self._integrator = ca.integrator("closed_loop", "cvodes", problem, 0.0, outputs, options)
        except RuntimeError as error:
            raise UndecidedError(f"the integrator cannot be built: {last_line(error)}") from None

    def pieces(self, gains: Gains, start: State, begin: float = 0.0) -> Iterator[tuple[Floats, State]]:
        """Piece after piece of the solution from time `begin` (s): times (K,) and states (K, N).

        Raises UndecidedError where CVODES stalls.
        """
        x = np.concatenate(start)
        columns = np.concatenate([np.asarray(getattr(gains, name), dtype=float) for name in GAIN_NAMES])
        while True:
            try:
                solved = self._integrator(x0=x, p=np.concatenate([columns, [begin]]))
            except RuntimeError as error:
                raise UndecidedError(f"the integrator gave up after t = {begin:g} s: {last_line(error)}") from None
            states = np.asarray(solved["xf"])
            if not np.isfinite(states).all():
                raise UndecidedError(f"the integrator returned numbers that are not finite after t = {begin:g} s")
            x = states[:, -1]
            yield np.asarray(begin + self.step * np.arange(1, self.per_piece + 1), dtype=float), self._state(states)
            begin += self.per_piece * self.step

    def _state(self, columns: Any) -> State:
        blocks = columns.reshape(5, self.vehicles, -1)
        return State(*(block.T for block in blocks))


def shared(expression: Any) -> Any:
    """The expression with its common parts computed once; large ones are left as they are."""
    return ca.cse(expression) if isinstance(expression, ca.SX) else expression
