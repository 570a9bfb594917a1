"""How the solvers' reports are read: an answer is used only if its solver calls it an optimum."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from ...models.errors import UndecidedError


def clarabel_finds_optimum(problem: Any, seconds: float) -> bool:
    """Solve with Clarabel. True only if the status is optimal and all variables have values.

    Raises UndecidedError if Clarabel breaks down or takes longer than `seconds` of wall clock.
    """
    import cvxpy as cp

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # "may be inaccurate": the status says so too
        try:
            problem.solve(solver=cp.CLARABEL, time_limit=seconds)
        except cp.SolverError:  # numerical trouble, which a bisection meets far from its optimum
            return False
        except Exception as error:
            raise UndecidedError(f"Clarabel broke down: {type(error).__name__}: {str(error)[:200]}") from None
    if problem.status == cp.USER_LIMIT:
        raise UndecidedError(f"Clarabel found no answer within {seconds:g} s")
    values = [variable.value for variable in problem.variables()]
    return problem.status == cp.OPTIMAL and all(value is not None and np.isfinite(value).all() for value in values)


def ipopt_finds_optimum(stats: dict[str, Any], seconds: float) -> bool:
    """Whether IPOPT calls its last answer an optimum, by the statistics of CasADi's solver.

    Raises RuntimeError if IPOPT used up its `seconds` of wall clock.
    """
    if stats["return_status"] == "Maximum_WallTime_Exceeded":
        raise RuntimeError(f"IPOPT found no answer within {seconds:g} s")
    return bool(stats["success"])
