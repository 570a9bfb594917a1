"""log cosh as an atom of SymPy: its derivative is tanh, it is even, and it does not overflow."""

from __future__ import annotations

from typing import Any

import sympy as sp


class log_cosh(sp.Function):  # type: ignore[misc]  # noqa: N801 -- SymPy names functions as they are printed
    """ln(cosh(s)). SymPy does not expand it, so its derivative is tanh(s)."""

    @classmethod
    def eval(cls, s: Any) -> Any:
        """Fold log_cosh(0) = 0 and the sign: log_cosh(-s) = log_cosh(s)."""
        if s.is_zero:
            return sp.S.Zero
        if s.could_extract_minus_sign():
            return cls(-s)
        return None

    def fdiff(self, argindex: int = 1) -> Any:  # noqa: ARG002
        """d/ds log_cosh(s) = tanh(s)."""
        return sp.tanh(self.args[0])

    def _eval_evalf(self, prec: int) -> Any:
        size = abs(self.args[0])
        return (size + sp.log(1 + sp.exp(-2 * size)) - sp.log(2))._eval_evalf(prec)

    def _eval_rewrite(self, rule: Any, args: Any, **hints: Any) -> Any:  # noqa: ARG002
        return sp.log(sp.cosh(args[0])) if rule in (sp.log, sp.cosh) else None
