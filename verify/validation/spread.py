"""Median, ninth decile and maximum of settling times."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple


class Spread(NamedTuple):
    """Quantiles over all starts, s; None if the quantile falls among starts that did not settle."""

    median: float | None
    p90: float | None
    max: float | None

    @classmethod
    def of(cls, times: Sequence[float | None]) -> Spread:
        """The quantiles of settling times; a start that did not settle (None) counts as later than all others."""
        ordered = sorted(time for time in times if time is not None)
        missing = len(times) - len(ordered)
        latest = None if missing or not ordered else ordered[-1]
        return cls(_quantile(ordered, missing, 0.5), _quantile(ordered, missing, 0.9), latest)


def _quantile(ordered: Sequence[float], missing: int, share: float) -> float | None:
    """The quantile with linear interpolation; None if it falls among the `missing` later ones."""
    place = share * (len(ordered) + missing - 1)
    below, fraction = int(place), place - int(place)
    above = below + (fraction > 0)
    if above >= len(ordered):
        return None
    return ordered[below] + fraction * (ordered[above] - ordered[below])
