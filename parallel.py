"""The executor that design and validate share: processes of this machine, or a Dask cluster."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, ProcessPoolExecutor, wait
from contextlib import contextmanager
from itertools import islice
from typing import Any

from .models.errors import InputError, UndecidedError
from .models.warning_lines import show_warnings, shown_level

AHEAD = 3  # queued jobs per worker
CONNECT = "10s"  # timeout of connecting to a scheduler
PATIENCE = 3.0  # s that workers get to end by themselves; after an error or an interrupt they may be busy
JOB_SECONDS = 7200  # s of wall clock for one job; after that its worker is killed


@contextmanager
def local(workers: int | None = None) -> Iterator[tuple[Executor, int]]:
    """A pool of processes and their number: `workers`, or one for every core that this process may use."""
    count = worker_count(workers)
    spawn = multiprocessing.get_context("spawn")
    others = set(multiprocessing.active_children())
    with _Pool(count, mp_context=spawn, initializer=_begin_worker, initargs=(shown_level(),)) as pool:
        try:
            yield pool, count
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
            _end(set(multiprocessing.active_children()) - others)


def worker_count(workers: int | None) -> int:
    """`workers` if given, else the number of cores that this process may use."""
    if workers:
        return workers
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1  # macOS and Windows


def _end(workers: set[multiprocessing.process.BaseProcess]) -> None:
    """Wait a little for idle workers, then kill those that are left: one may hang."""
    end = time.monotonic() + PATIENCE
    for worker in workers:
        worker.join(max(0.0, end - time.monotonic()))
    # Not earlier: the pool prints a traceback if a worker dies while cancelled jobs are still queued.
    for worker in workers:
        worker.kill()


class _Pool(ProcessPoolExecutor):
    """A pool whose workers ignore interrupts, and die when a job takes too long."""

    def submit(self, function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """See `Executor`. A worker started here inherits the blocked interrupts."""
        if not hasattr(signal, "pthread_sigmask"):  # Windows
            return super().submit(function, *args, **kwargs)
        before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
        try:
            return super().submit(_in_time, JOB_SECONDS, function, *args, **kwargs)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _in_time(seconds: int, function: Callable[..., Any], *args: Any, **kwargs: Any) -> Any:
    """Call the function in a worker. After so many seconds an alarm kills the process, wherever it hangs."""
    signal.alarm(seconds)
    try:
        return function(*args, **kwargs)
    finally:
        signal.alarm(0)


def _begin_worker(level: int | None) -> None:
    """Ignore interrupts, which the parent handles; end with the parent; show the same warnings as it does."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_the_parent, daemon=True).start()
    if level is not None:
        show_warnings(level)


def _end_with_the_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


@contextmanager
def cluster(address: str) -> Iterator[tuple[Executor, int]]:
    """An existing Dask cluster. Raises InputError if dask is not installed or the scheduler does not answer."""
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
    """The results of function(*job) as they come, with a few jobs per worker queued at a time.

    Raises UndecidedError if a worker dies, or if no job ends in time.
    """
    left = iter(jobs)
    running: set[Future[Any]] = {executor.submit(function, *job) for job in islice(left, AHEAD * workers)}
    try:
        while running:
            done, running = wait(running, 2 * JOB_SECONDS, FIRST_COMPLETED)
            if not done:  # only on a cluster: local workers have an alarm
                raise UndecidedError(f"validate: no worker was done with a start within {2 * JOB_SECONDS} s")
            for future in done:
                yield future.result()
            running |= {executor.submit(function, *job) for job in islice(left, len(done))}
    except BrokenExecutor:
        raise UndecidedError(
            f"validate: a worker process died, or took more than {JOB_SECONDS} s for one start; "
            "run the same command again: it goes on from here"
        ) from None
    finally:
        for future in running:
            future.cancel()
