# ruff: noqa: RUF001 -- mathematical letters are what this is for
"""Mathematics inside sentences: words such as omega_i, e_z', psi_bar or <= are typeset."""

from __future__ import annotations

import re
from collections.abc import Callable
from html import escape

from ..escapes import markdown_text, tex_text
from .notation import GREEK

_NAMES = "|".join(sorted(GREEK, key=len, reverse=True))
# A Latin letter that stands alone is mathematics too, but for words (a, A, I), units (m, N, /s) and marks such as (b).
_ALONE = r"(?<![\w*'<])(?!(?<=\()\w\))(?!(?<=/)s)(?!(?<=, )s\b(?! \w))[B-HJ-MO-Zb-lo-z](?![\w'>])"
# A Greek letter, or a Latin one alone or with subscripts or primes; perhaps transposed. Relations, roots.
_MATH = re.compile(
    rf"\b(?P<letter>(?:{_NAMES})(?![A-Za-z])|sum(?=_)|[A-Za-z](?=_|')|{_ALONE})(?P<subs>(?:_[A-Za-z0-9]+)*)"
    r"(?P<primes>'*)(?P<top>\^T)?"
    r"|(?P<sign>sqrt2|\^2|<=|>=|->|\+-|(?<![\w)-])-(?=[\w ]))"
)
_HTML = {"sqrt2": "√2", "<=": "≤", ">=": "≥", "->": "→", "+-": "±", "-": "−", "^2": "²", "perp": "⊥", "il": "iℓ"}
_TEX = {
    "sqrt2": r"\sqrt{2}", "<=": r"\le", ">=": r"\ge", "->": r"\to", "+-": r"\pm", "-": "-", "^2": "^{2}",
    "perp": r"\perp", "il": r"i\ell",
}  # fmt: skip


def inline_html(sentence: str) -> str:
    """HTML of a sentence, escaped."""
    return _pieces(sentence, escape, _html)


def inline_tex(sentence: str) -> str:
    """LaTeX of a sentence, escaped; mathematics in dollars."""
    shown = _pieces(sentence, tex_text, lambda found: f"${_tex(found)}$")
    return f"``{shown[2:]}" if sentence.startswith('"') else shown


def inline_markdown(sentence: str) -> str:
    """Markdown of a sentence, escaped; mathematics in dollars."""
    return _pieces(sentence, markdown_text, lambda found: f"${_tex(found)}$")


def _pieces(sentence: str, escaped: Callable[[str], str], typeset: Callable[[re.Match[str]], str]) -> str:
    """The sentence with each stretch between mathematics escaped; spaces at their ends stay."""
    pieces, end = [], 0
    for found in _MATH.finditer(sentence):
        pieces += [_padded(sentence[end : found.start()], escaped), typeset(found)]
        end = found.end()
    return "".join([*pieces, _padded(sentence[end:], escaped)])


def _padded(words: str, escaped: Callable[[str], str]) -> str:
    before, after = words[: len(words) - len(words.lstrip())], words[len(words.rstrip()) :]
    return before + escaped(words.strip()) + after if words.strip() else words


def _subs(found: re.Match[str]) -> tuple[list[str], bool]:
    """The subscripts of a letter, and whether it has a bar."""
    subs = [sub for sub in found["subs"].split("_") if sub]
    return [sub for sub in subs if sub != "bar"], "bar" in subs


def _html(found: re.Match[str]) -> str:
    if found["sign"]:
        return _HTML[found["sign"]]
    subs, bar = _subs(found)
    letter = (GREEK | {"sum": "∑"}).get(found["letter"], found["letter"]) + ("\u0304" if bar else "")
    lower = "".join(_HTML.get(sub, GREEK.get(sub, sub)) for sub in subs)
    shown = f"<i>{letter}</i>" + (f"<sub>{lower}</sub>" if lower else "") + "′" * len(found["primes"])
    return shown + ("<sup>⊤</sup>" if found["top"] else "")


def _tex(found: re.Match[str]) -> str:
    if found["sign"]:
        return _TEX[found["sign"]]
    subs, bar = _subs(found)
    letter = f"\\{found['letter']}" if found["letter"] in (*GREEK, "sum") else found["letter"]
    letter = f"\\bar{{{letter}}}" if bar else letter
    lower = " ".join(_TEX.get(sub, f"\\{sub}" if sub in GREEK else _word(sub)) for sub in subs)
    shown = letter + (f"_{{{lower}}}" if lower else "")
    upper = "\\prime" * len(found["primes"]) + ("\\top" if found["top"] else "")
    return shown + (f"^{{{upper}}}" if upper else "")


def _word(sub: str) -> str:
    return sub if len(sub) <= 2 else f"\\mathrm{{{sub}}}"
