"""Where the runs take place: in processes of this machine or on a Dask cluster, behind one `Executor`."""

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

AHEAD = 3  # jobs per worker that are handed out at a time
CONNECT = "10s"  # to a scheduler
PATIENCE = 3.0  # s that workers have to end; after an error or an interrupt they may be busy
JOB_SECONDS = 7200  # of wall clock, after which the worker of a job is ended


@contextmanager
def local(workers: int | None = None) -> Iterator[tuple[Executor, int]]:
    """A pool of processes, one for every core that this process may use unless said otherwise."""
    count = workers or len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    spawn = multiprocessing.get_context("spawn")
    others = set(multiprocessing.active_children())
    with _Pool(count, mp_context=spawn, initializer=_obey_the_parent) as pool:
        try:
            yield pool, count
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
            _end(set(multiprocessing.active_children()) - others)


def _end(workers: set[multiprocessing.process.BaseProcess]) -> None:
    """Wait a little for workers that have nothing more to do, then end them: one may hang."""
    end = time.monotonic() + PATIENCE
    for worker in workers:
        worker.join(max(0.0, end - time.monotonic()))
    # Not before: the pool writes a traceback where a worker dies while it still holds jobs that are cancelled.
    for worker in workers:
        worker.kill()


class _Pool(ProcessPoolExecutor):
    """A pool whose workers know no interrupts and end with a job that takes too long."""

    def submit(self, function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """See `Executor`; a worker that this starts inherits that interrupts are held back."""
        if not hasattr(signal, "pthread_sigmask"):  # Windows
            return super().submit(function, *args, **kwargs)
        before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
        try:
            return super().submit(_in_time, JOB_SECONDS, function, *args, **kwargs)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _in_time(seconds: int, function: Callable[..., Any], *args: Any, **kwargs: Any) -> Any:
    """A call in a worker; the alarm ends the process, wherever it hangs."""
    signal.alarm(seconds)
    try:
        return function(*args, **kwargs)
    finally:
        signal.alarm(0)


def _obey_the_parent() -> None:
    """Leave interrupts to the process that gives out the work, although a terminal sends them to all; end with it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_the_parent, daemon=True).start()


def _end_with_the_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


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
    """function(*job) of all jobs as they are done, a few per worker handed out at a time.

    Raises UndecidedError where a worker dies, or none is done with a job in time.
    """
    left = iter(jobs)
    running: set[Future[Any]] = {executor.submit(function, *job) for job in islice(left, AHEAD * workers)}
    try:
        while running:
            done, running = wait(running, 2 * JOB_SECONDS, FIRST_COMPLETED)
            if not done:  # on a cluster; here the workers have an alarm
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
