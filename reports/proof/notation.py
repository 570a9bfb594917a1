# ruff: noqa: RUF001 -- Greek letters are printed here
"""How the statements of the proof are typeset: LaTeX, presentation MathML and plain text."""

from __future__ import annotations

from functools import cache, lru_cache
from typing import Any

import sympy as sp
from sympy.printing.latex import LatexPrinter
from sympy.printing.mathml import MathMLPresentationPrinter
from sympy.printing.str import StrPrinter

from ...models.algebra.log_cosh import log_cosh
from ..escapes import tex_text
from .letters import LETTERS, letter_of

_GREEK_NAMES = "alpha beta gamma delta epsilon eta theta kappa lambda mu nu xi pi rho sigma tau phi chi psi omega"
GREEK = dict(zip(_GREEK_NAMES.split(), "αβγδεηθκλμνξπρστφχψω", strict=True))
_MARKS = {"dot": "˙", "ddot": "¨", "bar": "¯", "hat": "^"}
_ARROWS = {"∥": "\\parallel", "⊥": "\\perp"}
CACHED = 4096  # expressions of one report
_TANH, _LN_COSH = sp.Function("tanh"), sp.Function("lncosh")  # as SymPy's, but their sign is left alone


@lru_cache(maxsize=CACHED)
def tidy(expression: Any) -> Any:
    """The expression as it is read: ln cosh, differences that begin with what is compared, D for the sum of weights."""
    shown = sp.sympify(expression).replace(log_cosh, lambda s: _LN_COSH(_forward(s)[1]))
    shown = shown.replace(sp.tanh, lambda s: _forward(s)[0] * _TANH(_forward(s)[1]))
    return shown.replace(lambda e: e.is_Add and e in _degrees(), lambda e: _degrees()[e])


def _forward(argument: Any) -> tuple[int, Any]:
    """(sign, sign * argument) with the sign that makes the first place or angle in it positive."""
    states = [s for s in argument.free_symbols if s.name.partition("_")[0] in ("x", "y", "theta")]
    first = min(states, key=lambda s: s.name, default=None)
    backward = first is not None and bool(sp.expand(argument).coeff(first).could_extract_minus_sign())
    return (-1, sp.expand(-argument)) if backward else (1, argument)


@cache
def _degrees() -> dict[Any, Any]:
    """a_ij + a_il as D_i, of both vehicles of the generic edge."""
    edge = sp.Symbol("a_ij", real=True, positive=True)
    leader = {i: sp.Symbol(f"a_{i}l", real=True, positive=True) for i in "ij"}
    return {edge + a: sp.Symbol(f"D_{i}", real=True, positive=True) for i, a in leader.items()}


class _Ordered:
    """What is added comes before what is taken away."""

    def _as_ordered_terms(self, expr: Any, order: Any = None) -> list[Any]:
        terms = super()._as_ordered_terms(expr, order=order)  # type: ignore[misc]
        return sorted(terms, key=lambda term: bool(term.could_extract_minus_sign()))


def _ten_to(number: Any) -> int | None:
    """The exponent of a long power of ten, which nobody wants to count the zeros of."""
    zeros = len(str(number)) - 1
    return zeros if zeros > 4 and number == 10**zeros else None


class _Latex(_Ordered, LatexPrinter):  # type: ignore[misc]
    def _print_Integer(self, expr: Any) -> str:  # noqa: N802
        power = _ten_to(expr)
        return f"10^{{{power}}}" if power else str(expr)

    def _print_Symbol(self, expr: Any, style: str = "plain") -> str:  # noqa: ARG002, N802
        letter, index = letter_of(expr.name)
        shown = _latex_letter(letter.letter)
        for accent in letter.accent.split():
            shown = f"\\{accent}{{{shown}}}"
        apart = "\\," if len(letter.sub) > 1 and letter.sub not in GREEK else " "  # words and an index
        lower = apart.join(_latex_sub(part) for part in (letter.sub, index) if part)
        return f"{{{shown}}}_{{{lower}}}" if lower else shown


def _latex_letter(letter: str) -> str:
    if letter in GREEK:
        return f"\\{letter}"
    return letter if len(letter) == 1 else f"\\mathrm{{{letter}}}"


def _latex_sub(sub: str) -> str:
    if sub in _ARROWS:
        return _ARROWS[sub]
    shown = [_latex_letter(part) if part in GREEK else _latex_index(part) for part in sub.split(",")]
    return ",".join(shown)


def _latex_index(index: str) -> str:
    if len(index) <= 2 and index.isalnum():
        return index.replace("l", "\\ell ")
    return f"\\mathrm{{{tex_text(index)}}}"


class _MathML(_Ordered, MathMLPresentationPrinter):  # type: ignore[misc]
    def _print_Integer(self, expr: Any) -> Any:  # noqa: N802
        power = _ten_to(expr)
        if not power:
            return self._leaf(str(expr), "mn")
        node = self.dom.createElement("msup")
        for number in (10, power):
            node.appendChild(self._leaf(str(number), "mn"))
        return node

    def _print_Symbol(self, expr: Any, style: str = "plain") -> Any:  # noqa: ARG002, N802
        letter, index = letter_of(expr.name)
        shown = self._leaf(GREEK.get(letter.letter, letter.letter))
        for accent in letter.accent.split():
            shown = self._marked(shown, _MARKS[accent])
        lower = [GREEK.get(part, part) for part in letter.sub.split(",") if part]
        lower += [index.replace("l", "ℓ") if len(index) <= 2 else index] if index else []
        if not lower:
            return shown
        node, row = self.dom.createElement("msub"), self.dom.createElement("mrow")
        for part in lower:
            if row.childNodes and max(map(len, (part, lower[0]))) > 1:  # words and an index
                row.appendChild(self._leaf(" ", "mtext"))
            row.appendChild(self._leaf(part))
        node.appendChild(shown)
        node.appendChild(row)
        return node

    def _leaf(self, content: str, tag: str = "mi") -> Any:
        node = self.dom.createElement(tag)
        node.appendChild(self.dom.createTextNode(content))
        return node

    def _marked(self, letter: Any, mark: str) -> Any:
        node = self.dom.createElement("mover")
        node.setAttribute("accent", "true")
        node.appendChild(letter)
        node.appendChild(self._leaf(mark, "mo"))
        return node


class _Text(_Ordered, StrPrinter):  # type: ignore[misc]
    pass


@lru_cache(maxsize=CACHED)
def latex(expression: Any) -> str:
    """LaTeX of an expression."""
    printed = _Latex({"mul_symbol": "\\,", "fold_short_frac": False}).doprint(tidy(expression))
    return str(printed).replace(r"\operatorname{lncosh}", r"\ln\cosh").replace(r"\operatorname{tanh}", r"\tanh")


# A gap between factors, so that x tanh does not read xtanh; the minus of a formula; the name of a function.
_BETTER = {"<mo>&InvisibleTimes;</mo>": "<mtext>\u2009</mtext>", "<mo>-</mo>": "<mo>−</mo>", "lncosh": "ln cosh"}


@lru_cache(maxsize=CACHED)
def mathml(expression: Any) -> str:
    """Presentation MathML of an expression, without the <math> element around it."""
    body = _MathML()._print(tidy(expression)).toxml()
    for plain, shown in _BETTER.items():
        body = body.replace(plain, shown)
    return f"<mrow>{body}</mrow>"


@lru_cache(maxsize=CACHED)
def text(expression: Any) -> str:
    """One line of plain text."""
    return str(_Text().doprint(tidy(expression))).replace("lncosh", "ln cosh").replace("**", "^")


def meanings(expressions: Any) -> list[tuple[Any, str]]:
    """Every letter that occurs in the expressions, with what it means, in the order of the table."""
    used = {_base(s.name) for e in expressions for s in tidy(e).atoms(sp.Symbol)}
    return [(sp.Symbol(base, real=True), letter.meaning) for base, letter in LETTERS.items() if base in used]


def _base(name: str) -> str:
    return name if name in LETTERS else name.rpartition("_")[0]
