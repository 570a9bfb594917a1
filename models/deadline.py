"""Wall-clock limits."""

from __future__ import annotations

import math
import time


class Deadline:
    """A wall-clock limit."""

    def __init__(self, seconds: float) -> None:
        self._begin, self._seconds = time.monotonic(), seconds

    @property
    def passed(self) -> bool:
        """Whether the time is up."""
        return self.share > 1

    @property
    def share(self) -> float:
        """Time used / limit; above 1 after the limit."""
        gone = time.monotonic() - self._begin
        return gone / self._seconds if self._seconds > 0 else math.inf
