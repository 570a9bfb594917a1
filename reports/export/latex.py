"""gains.tex: gains, scales, psi and the margins of (15), (16) and (16*), as tables for a paper."""

from __future__ import annotations

from collections.abc import Iterator
from decimal import ROUND_CEILING, ROUND_FLOOR
from fractions import Fraction
from typing import NamedTuple

from ...models.conditions import CONDITION_SETS, condition_15, condition_16, condition_16_star, exact_numbers
from ...models.excitation import Excitation
from ...models.gains import GAIN_NAMES
from ...models.numbers import decimal_text
from ..deployment import Deployment
from ..rendering import render
from ..tables.gain_table import decimal, rows

LONG_TABLE = 40  # with more rows the tables may break over pages
DIGITS = 5  # significant digits of a margin, rounded down
CHECKED = (condition_15, condition_16, condition_16_star)


class MarginRow(NamedTuple):
    """The margins of one vehicle, N m, rounded down; a negative one means that the condition does not hold."""

    vehicle: str
    margins: tuple[str, ...]  # of (15), (16), (16*)


def latex_files(deployed: Deployment) -> dict[str, str]:
    """gains.tex, which compiles by itself and which another document can input."""
    table = rows(deployed.fleet, deployed.excitation, deployed.gains)
    unit = deployed.gains.saturation.unit
    keys = (*GAIN_NAMES, *(() if unit else ("speed_scale", "turn_rate_scale")), "torque_bound", "torque_limit")
    return {
        "gains.tex": render(
            "gains.tex",
            fleet=deployed.fleet,
            evidence=deployed.evidence,
            psi=psi_formula(deployed.excitation),
            psi_bar=decimal(deployed.excitation.bound, ROUND_CEILING),
            table=table,
            unit=unit,
            keys=keys,
            margins=margin_rows(deployed),
            long=len(table) > LONG_TABLE,
            sources=CONDITION_SETS[deployed.conditions].sources if deployed.conditions else (),
        )
    }


def margin_rows(deployed: Deployment) -> list[MarginRow]:
    """Right side minus left side of (15), (16) and (16*), exact and then rounded down."""
    data, numbers = deployed.fleet.condition_data(deployed.excitation), exact_numbers()
    margins = [condition(numbers, data, deployed.gains).margin for condition in CHECKED]
    return [
        MarginRow(name, tuple(decimal(Fraction(margin[i]), ROUND_FLOOR, DIGITS) for margin in margins))
        for i, name in enumerate(deployed.fleet.names)
    ]


def psi_formula(psi: Excitation) -> str:
    """psi(t) for LaTeX's mathematics mode."""
    mean = decimal_text(psi.mean)
    if psi.terms is not None:
        start = "" if psi.mean == 0 else f"{mean} + "
        phase = rf"(2k-1)\cdot {decimal_text(psi.frequency)}\,t"
        return rf"{start}\sum_{{k=1}}^{{{psi.terms}}} \frac{{4}}{{(2k-1)\pi}} \sin({phase})"
    terms = list(_terms(psi))
    first = [] if psi.mean == 0 else [mean]
    return " ".join([*first, *(terms if first else [terms[0].removeprefix("+ "), *terms[1:]])])


def _terms(psi: Excitation) -> Iterator[str]:
    """The signed terms of a sum of harmonics."""
    for n, sine, cosine in psi.coefficients:
        for amplitude, wave in ((sine, r"\sin"), (cosine, r"\cos")):
            if amplitude:
                sign = "-" if amplitude < 0 else "+"
                yield rf"{sign} {decimal_text(abs(amplitude))} {wave}({decimal_text(n * psi.frequency)}\,t)"
