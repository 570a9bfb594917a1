"""The number of worker processes."""

import os

import pytest
from gaincert.parallel import worker_count


def test_a_given_number_of_workers_is_taken_on_every_system(monkeypatch: pytest.MonkeyPatch) -> None:
    assert worker_count(3) == 3
    monkeypatch.delattr(os, "sched_getaffinity", raising=False)  # as on macOS and Windows
    assert worker_count(3) == 3


def test_without_a_number_there_is_one_worker_for_every_core(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda _pid: {0, 2, 5}, raising=False)
    assert worker_count(None) == 3
    monkeypatch.delattr(os, "sched_getaffinity")
    monkeypatch.setattr(os, "cpu_count", lambda: 8)
    assert worker_count(None) == 8
    monkeypatch.setattr(os, "cpu_count", lambda: None)
    assert worker_count(None) == 1
