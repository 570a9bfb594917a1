"""When a run counts as settled, and how the error of an unsettled run moves at its end."""

from __future__ import annotations

import math
from enum import StrEnum

from .closed_loop import ClosedLoop, Floats

PART = 0.1  # of a run: its last part is compared with the part before
CHANGE = 1e-3  # below this relative change of the error between both, it no longer changes


class Approach(StrEnum):
    """How the error moves at the end of a run that has not settled."""

    CLOSING_IN = "still closing in"
    STANDING_STILL = "standing still"
    MOVING_AWAY = "moving away"

    @classmethod
    def of(cls, earlier: float, last: float) -> Approach:
        """From the largest errors in the part before the last and in the last part, each divided by its tolerance."""
        if last < (1 - CHANGE) * earlier:
            return cls.CLOSING_IN
        return cls.MOVING_AWAY if last > (1 + CHANGE) * earlier > 0 else cls.STANDING_STILL

    @classmethod
    def of_history(cls, t: Floats, excess: Floats) -> Approach:
        """From the errors divided by their tolerances, (K,), at all times (K,) of a run."""
        last, before = t >= (1 - PART) * t[-1], t >= (1 - 2 * PART) * t[-1]
        return cls.of(float(excess[before & ~last].max(initial=0)), float(excess[last].max(initial=0)))


def confirmed_by(loop: ClosedLoop, horizon: float) -> float:
    """The time, s, by which a run must have settled, so that it stays settled for a period of psi at least.

    A run of less than ten periods has to stay settled for its last tenth.
    """
    return horizon - min(2 * math.pi / float(loop.excitation.frequency), PART * horizon)
