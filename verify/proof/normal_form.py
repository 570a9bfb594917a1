"""The polynomial normal form in which identities are decided.

Every tanh, sin, cos and log_cosh of an expanded argument is a generator; sech^2 = 1 - tanh^2 and sin^2 = 1 - cos^2 are
their only relations. After expansion and reduction an expression is a polynomial (with monomials of parameters for
denominators) in a basis, so that it is identically zero if and only if nothing is left of it. `simplify` is not used.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from ...models.algebra.log_cosh import log_cosh

Expr = Any  # a SymPy expression

_GENERATORS = (sp.tanh, sp.sin, sp.cos, log_cosh)


def normal_form(expression: Expr) -> Expr:
    """The normal form of an expression that is polynomial in the generators. Raises ValueError for any other."""
    canonical = sp.sympify(expression).replace(_is_generator, lambda g: g.func(sp.expand(g.args[0])))
    polynomial = sp.expand(_without_sech(canonical))
    if any(power.base.is_Add and not power.exp.is_nonnegative for power in polynomial.atoms(sp.Pow)):
        polynomial = sp.expand(sp.fraction(sp.together(polynomial))[0])  # a fraction is 0 where its numerator is
    return _reduce_sines(polynomial)


def equal(left: Expr, right: Expr) -> bool:
    """Whether two expressions are identical."""
    return bool(normal_form(left - right) == 0)


def majorant(expression: Expr, bounds: dict[Expr, Expr]) -> Expr:
    """The triangle inequality: every coefficient by its size, every generator g by bounds[g] >= |g|.

    Parameters without an entry are nonnegative and stand for themselves.
    """
    terms = sp.Add.make_args(normal_form(expression))
    return normal_form(sum(_size(term, bounds) for term in terms))


def _size(term: Expr, bounds: dict[Expr, Expr]) -> Expr:
    coefficient, rest = term.as_coeff_Mul()
    return abs(coefficient) * rest.xreplace(bounds)


def _is_generator(expression: Expr) -> bool:
    return expression.func in _GENERATORS


def _without_sech(expression: Expr) -> Expr:
    reduced = expression.replace(
        lambda e: e.is_Pow and e.base.func is sp.sech and e.exp.is_Integer and e.exp % 2 == 0,
        lambda e: (1 - sp.tanh(sp.expand(e.base.args[0])) ** 2) ** (e.exp // 2),
    )
    if reduced.has(sp.sech):
        raise ValueError("an odd power of sech is no polynomial in the generators")
    return reduced


def _reduce_sines(polynomial: Expr) -> Expr:
    def even_part(power: Expr) -> Expr:
        angle, n = power.base.args[0], power.exp
        return (1 - sp.cos(angle) ** 2) ** (n // 2) * sp.sin(angle) ** (n % 2)

    reduced = polynomial.replace(
        lambda e: e.is_Pow and e.base.func is sp.sin and e.exp.is_Integer and e.exp >= 2, even_part
    )
    return sp.expand(reduced)
