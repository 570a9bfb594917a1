"""Arrays over vehicles or edges: of floats, of exact numbers, of symbols."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

Array = Any  # a NumPy array of floats or objects, or a CasADi column


def column(values: Iterable[Any]) -> Array:
    """The values as an object array (N,)."""
    entries = list(values)
    column = np.empty(len(entries), dtype=object)
    column[:] = entries
    return column


def floats(values: Array) -> Array:
    """An array of exact numbers as floats; a single number as a float."""
    return np.asarray(values, dtype=float)[()]
