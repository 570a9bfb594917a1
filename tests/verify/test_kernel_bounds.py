"""The kernel alone on hostile files: a verdict or a refusal in words, in bounded time and memory."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.campaigns.hostile_files import HOSTILE, MEGABYTES, SECONDS, SIZE, STARTING, cost

SHARE = 0.02  # of the size at which `python -m tests.campaigns.hostile_files` measures
ARCS = 2.0  # s that arcs may cost, however small the file is
BUSY = 3  # times as long where other programs take the caches


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="memory is read from /proc")
@pytest.mark.parametrize("kind", HOSTILE)
def test_hostile_files_cost_little(kind: str, tmp_path: Path) -> None:
    found = cost(kind, int(SIZE * SHARE), tmp_path)
    assert found.behaved, found
    assert found.seconds < BUSY * (SECONDS * SHARE + STARTING[0] + ARCS * ("arcs" in kind)), found
    assert found.megabytes < MEGABYTES * SHARE + STARTING[1], found
