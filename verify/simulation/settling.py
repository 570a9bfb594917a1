"""When a run counts as settled, and what a run that has not settled does at its end."""

from __future__ import annotations

import math
from enum import StrEnum

from .closed_loop import ClosedLoop, Floats

PART = 0.1  # of a run: its last part is compared with the part before
CHANGE = 1e-3  # relative change of the error between both, below which it stands still


class Approach(StrEnum):
    """What the error does at the end of a run that has not settled."""

    CLOSING_IN = "still closing in"
    STANDING_STILL = "standing still"
    MOVING_AWAY = "moving away"

    @classmethod
    def of(cls, earlier: float, last: float) -> Approach:
        """From the largest errors in the last part of a run and in the part before, over their tolerances."""
        if last < (1 - CHANGE) * earlier:
            return cls.CLOSING_IN
        return cls.MOVING_AWAY if last > (1 + CHANGE) * earlier > 0 else cls.STANDING_STILL

    @classmethod
    def of_history(cls, t: Floats, excess: Floats) -> Approach:
        """From the errors over their tolerances, (K,), at all times (K,) of a run."""
        last, before = t >= (1 - PART) * t[-1], t >= (1 - 2 * PART) * t[-1]
        return cls.of(float(excess[before & ~last].max(initial=0)), float(excess[last].max(initial=0)))


def confirmed_by(loop: ClosedLoop, horizon: float) -> float:
    """The time, s, by which a run must have settled, so that it stays settled for a period of psi at least.

    A short run, of less than ten periods, has to stay for its last tenth.
    """
    return horizon - min(2 * math.pi / float(loop.excitation.frequency), PART * horizon)
