"""Lemma L0: what is used of tanh, sech and log cosh, each from its derivative or from exponentials."""

from __future__ import annotations

from functools import cache

import sympy as sp

from ....models.algebra.log_cosh import log_cosh
from ..claim import Claim, Expr, Fact, Kind
from ..method.rules import grows, identity, instance, less, mirrored, ordered
from ..method.symbols import nonnegative_symbol, symbol

X, S = symbol("x"), nonnegative_symbol("s")


def sech2(x: Expr) -> Expr:
    """sech^2 by tanh."""
    return 1 - sp.tanh(x) ** 2


@cache
def l0() -> Claim:
    """|tanh x| < 1, |tanh x| <= |x|, 0 < sech^2 <= 1, bounds of log cosh, and that tanh s / s decreases."""
    tanh = sp.tanh(S)
    below, line = less(tanh, sp.S.One, 2 / (sp.exp(2 * S) + 1)), grows(tanh, S, S)
    return Claim(
        "L0",
        Kind.LEMMA,
        (
            mirrored(below, S, X),
            mirrored(line, S, X),
            less(sp.S.Zero, sech2(X), 4 / (sp.exp(X) + sp.exp(-X)) ** 2),
            mirrored(ordered(sech2(S), "<=", sp.S.One), S, X),
            mirrored(grows(sp.S.Zero, log_cosh(S), S), S, X),
            mirrored(grows(log_cosh(S), S**2 / 2, S, (line,)), S, X),
            mirrored(grows(log_cosh(S), S * tanh, S, (below,)), S, X),
            less(sp.exp(S) / 2, sp.cosh(S), sp.exp(-S) / 2),
            identity(S**2 * sp.diff(tanh / S, S), S * sech2(S) - tanh),
            grows(S * sech2(S), tanh, S, (below,)),
        ),
    )


def tanh_below_1(argument: Expr) -> Fact:
    """|tanh| < 1 at an argument."""
    return instance(l0().about(sp.Abs(sp.tanh(X)), "<"), {X: argument})


def tanh_below_line(argument: Expr) -> Fact:
    """|tanh x| <= |x| at an argument."""
    return instance(l0().about(sp.Abs(sp.tanh(X)), "<="), {X: argument})


def sech2_within(argument: Expr) -> tuple[Fact, Fact]:
    """0 < sech^2 and sech^2 <= 1 at an argument."""
    return instance(l0().about(sp.S.Zero, "<"), {X: argument}), instance(l0().about(sech2(X)), {X: argument})
