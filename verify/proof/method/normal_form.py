"""The polynomial normal form in which identities are decided.

Every tanh, sin, cos and log_cosh of an expanded argument is a generator; sech^2 = 1 - tanh^2 and sin^2 = 1 - cos^2 are
their only relations. After expansion and reduction an expression is a polynomial (with monomials of parameters for
denominators) in a basis, so that it is identically zero if and only if nothing is left of it. `simplify` is not used.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import sympy as sp

from ....models.algebra.log_cosh import log_cosh
from ..claim import Expr

_GENERATORS = (sp.tanh, sp.sin, sp.cos, log_cosh, sp.atanh)


def normal_form(expression: Expr) -> Expr:
    """The normal form of an expression that is polynomial in the generators, what has a sum below the line kept whole.

    Raises ValueError for odd powers of sech.
    """
    canonical = sp.sympify(expression).replace(_is_generator, lambda g: _canonical(g.func, sp.expand(g.args[0])))
    polynomial = sp.expand(_without_sech(canonical.replace(_is_root_of_sum, _root_of_primitive)))
    return _reduce_sines(polynomial)


def difference(left: Expr, right: Expr) -> Expr:
    """left - right: 0 if and only if the two are identical, a fraction being 0 where its numerator is."""
    found = normal_form(left - right)
    if any(power.base.is_Add and power.exp.is_negative for power in found.atoms(sp.Pow)):
        numerator = normal_form(sp.fraction(sp.together(found))[0])
        return sp.S.Zero if numerator == 0 else found
    return found


def equal(left: Expr, right: Expr) -> bool:
    """Whether two expressions are identical."""
    return bool(difference(left, right) == 0)


def majorant(expression: Expr, bounds: Mapping[Expr, Expr]) -> Expr:
    """The triangle inequality: every generator g by bounds[g] >= |g|, all else by its size."""
    terms = sp.Add.make_args(normal_form(expression))
    return normal_form(sum((_size(term, bounds) for term in terms), sp.S.Zero))


def _size(term: Expr, bounds: Mapping[Expr, Expr]) -> Expr:
    powers = [factor.as_base_exp() for factor in sp.Mul.make_args(term)]
    return sp.Mul(*(bounds.get(base, sp.Abs(base)) ** exponent for base, exponent in powers))


def _is_generator(expression: Expr) -> bool:
    return expression.func in _GENERATORS


def _canonical(function: Any, argument: Expr) -> Expr:
    """The generator of an expanded argument; sin and cos of a sum by their addition theorems."""
    found = function(argument)
    return sp.expand_trig(found) if argument.is_Add and function in (sp.sin, sp.cos) else found


def _is_root_of_sum(expression: Expr) -> bool:
    return bool(expression.is_Pow and expression.base.is_Add and (2 * expression.exp).is_odd)


def _root_of_primitive(root: Expr) -> Expr:
    """sqrt(2 p + 2 q) and sqrt(2) sqrt(p + q) as one: the rational content of what is under a root goes out of it."""
    content, primitive = sp.expand(root.base).primitive()
    return content**root.exp * primitive**root.exp


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
