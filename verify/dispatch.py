"""Where the runs take place: in processes of this machine or on a Dask cluster, behind one `Executor`."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, ProcessPoolExecutor, wait
from contextlib import contextmanager
from itertools import islice
from typing import Any

from ..models.errors import InputError, UndecidedError

AHEAD = 3  # jobs per worker that are handed out at a time
CONNECT = "10s"  # to a scheduler


@contextmanager
def local(workers: int | None = None) -> Iterator[tuple[Executor, int]]:
    """A pool of processes, one for every core that this process may use unless said otherwise."""
    count = workers or len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(count, mp_context=spawn, initializer=_leave_interrupts_to_the_parent) as pool:
        try:
            yield pool, count
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _leave_interrupts_to_the_parent() -> None:
    """A terminal's interrupt reaches every process; the one that gave out the work decides what becomes of it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


@contextmanager
def cluster(address: str) -> Iterator[tuple[Executor, int]]:
    """An existing Dask cluster. Raises InputError where dask is not installed or nobody answers."""
    try:
        from distributed import Client
    except ImportError:
        raise InputError("--scheduler needs dask.distributed; pip install 'gaincert[cluster]'") from None
    try:
        client: Any = Client(address, timeout=CONNECT)  # type: ignore[no-untyped-call,unused-ignore]
    except (OSError, ValueError) as error:
        raise InputError(f"--scheduler {address}: {error}; is a Dask scheduler running there?") from None
    with client:
        count = sum(client.nthreads().values())
        if not count:
            raise InputError(f"--scheduler {address}: has no workers; start some with `dask worker {address}`")
        with client.get_executor(retries=3) as executor:
            yield executor, count


def in_turn(
    executor: Executor, function: Callable[..., Any], jobs: Iterable[tuple[Any, ...]], workers: int
) -> Iterator[Any]:
    """function(*job) of all jobs as they are done, a few per worker handed out at a time. Raises UndecidedError."""
    left = iter(jobs)
    running: set[Future[Any]] = {executor.submit(function, *job) for job in islice(left, AHEAD * workers)}
    try:
        while running:
            done, running = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                yield future.result()
            running |= {executor.submit(function, *job) for job in islice(left, len(done))}
    except BrokenExecutor:
        raise UndecidedError(
            "validate: a worker process died; run the same command again: it goes on from here"
        ) from None
    finally:
        for future in running:
            future.cancel()
