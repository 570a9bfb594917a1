"""Gains from files and from Python as exact positive numbers, one per vehicle, with every mistake in one message."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from .arrays import Array, column
from .errors import InputError, shown
from .gains import GAIN_NAMES, Gains
from .numbers import decimal_text, exact
from .saturation import SCALE_NAMES, Saturation

NETWORK_SCALES = ("position", "heading")  # the same for all vehicles


def exact_gains(gains: Gains, names: Sequence[str]) -> Gains:
    """The same gains and scales as fractions, one per vehicle. Raises InputError.

    A gain may be a list, a tuple or an array of ints, floats, decimals, decimal texts or fractions, or one number for
    all vehicles. A float stands for the decimal number that it prints as.
    """
    if not isinstance(gains, Gains):
        raise InputError(
            f"gains: must be a Gains object, not {shown(gains)}; build one with gaincert.Gains(p_v=..., ...)"
        )
    count = len(names)
    scales = {name: _listed(getattr(gains.saturation, name), count) for name in SCALE_NAMES}
    return checked_gains("gains", names, {name: _listed(getattr(gains, name), count) for name in GAIN_NAMES}, scales)


def checked_gains(
    where: str, names: Sequence[str], gains: Mapping[str, Any], scales: Mapping[str, Any], more: Iterable[str] = ()
) -> Gains:
    """The gains and scales in lists by name, checked; `where` begins every line. Raises InputError.

    A scale that is left out is 1; `more` are mistakes that were found before.
    """
    mistakes = list(more)

    def numbers(name: str, entries: Any) -> Array:
        if not isinstance(entries, list) or len(entries) != len(names):
            mistakes.append(f"{where}: {name} must be a list of {len(names)} numbers, one per vehicle in file order")
            return column([])
        return column(_positive(where, name, names, entries, mistakes))

    found = {name: numbers(name, gains.get(name)) for name in GAIN_NAMES}
    scale = {name: numbers(f"{name} scale", entries) for name, entries in scales.items()}
    for name in NETWORK_SCALES:
        if name in scale and len(values := sorted(set(scale[name]))) > 1:
            mistakes.append(
                f"{where}: the {name} scale must be the same for all vehicles, but is {decimal_text(values[0])} "
                f"for one and {decimal_text(values[-1])} for another"
            )
    if mistakes:
        raise InputError(*mistakes)
    network: dict[str, Any] = {name: scale[name][0] for name in NETWORK_SCALES if name in scale}
    return Gains(**found, saturation=Saturation(**{**scale, **network}))


def _listed(values: Any, count: int) -> Any:
    """A list of a sequence's entries, or of one number for all; anything else as it is."""
    if isinstance(values, np.ndarray):
        values = values.tolist()
    if isinstance(values, (list, tuple)):
        return list(values)
    try:
        exact(values)
    except ValueError:
        return values
    return [values] * count


def _positive(where: str, name: str, names: Sequence[str], entries: list[Any], mistakes: list[str]) -> list[Fraction]:
    numbers = []
    for vehicle, entry in zip(names, entries, strict=True):
        try:
            number = exact(entry)
        except ValueError as error:
            mistakes.append(f"{where}: vehicle {vehicle!r}: {name} = {shown(entry)} {error}; it must be a number > 0")
            continue
        if number <= 0:
            mistakes.append(f"{where}: vehicle {vehicle!r}: {name} = {shown(entry)} must be > 0")
        numbers.append(number)
    return numbers
