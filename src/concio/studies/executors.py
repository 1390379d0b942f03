"""Who makes the runs: this process, processes beside it, a Dask cluster, or any executor of ``concurrent.futures``.

There is no scheduler here. Runs are handed out in their order, a few more than there are workers, and rows come back
as they end. Where a worker is lost (killed, out of memory, or ended with a run that would not stop), the runs that were
out are made again one by one, each with a process to itself: the one that takes its process with it twice is a row that
says so, all others are rows like any other.
"""

from __future__ import annotations

import math
import multiprocessing
import os
import pickle
import time
from collections import Counter, deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    ProcessPoolExecutor,
    wait,
)
from contextlib import contextmanager, suppress
from dataclasses import replace
from typing import Any

from concio.arguments import closest
from concio.errors import ConcioError, InputError
from concio.studies.sampling import Sample
from concio.studies.study_rows import GRACE, Row, Task

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
"""Variables of the environment that hold libraries of linear algebra to one thread in every worker."""

AHEAD = 2
"""Runs handed out for each worker: one at work, one waiting."""

TRIES = 2
"""Times that a run may crash its worker."""

NAMES = ("serial", "processes", "dask")

Emit = Callable[[Row], bool]
"""Takes a row as it comes; true asks to stop."""


def run_rows(
    task: Task, sample: Sample, wanted: Sequence[int], emit: Emit, *, executor: Any = None, workers: int | None = None
) -> None:
    """Make the runs ``wanted`` of a sample and hand each row to ``emit``.

    Parameters
    ----------
    task : Task
    sample : Sample
    wanted : sequence of int
        Numbers of the runs, in the order in which they are handed out.
    emit : callable
    executor : optional
        None or "serial": this process. "processes": a pool. "dask": a local cluster. An address such as
        "tcp://host:8786": a Dask cluster that runs there. Or an executor with ``submit``, or a Dask client.
    workers : int, optional
        Processes; by default one for each core.

    Raises
    ------
    InputError
        There is no such executor.
    """
    check_executor(executor, workers)
    if executor is None:
        executor = "processes" if workers is not None and workers > 1 else "serial"
    if executor == "serial":
        for index in wanted:
            if emit(task(index, *_arguments(sample, index))):
                return
        return
    size = workers or os.cpu_count() or 1
    if executor == "processes":
        _run_processes(replace(task, own_process=True), sample, wanted, emit, size)
    elif isinstance(executor, str) and (executor == "dask" or "://" in executor):
        with _dask(None if executor == "dask" else executor, workers) as (pool, size):
            _run_foreign(pool, replace(task, own_process=executor == "dask"), sample, wanted, emit, size)
    elif hasattr(executor, "get_executor"):  # a Dask client
        size = workers or max(len(executor.nthreads()), 1)
        _run_foreign(executor.get_executor(pure=False), task, sample, wanted, emit, size)
    else:
        _run_foreign(executor, task, sample, wanted, emit, size)


def check_executor(executor: Any, workers: int | None) -> None:
    """Raise InputError where there is no such executor, or no such number of processes."""
    if workers is not None and (isinstance(workers, bool) or not isinstance(workers, int) or not 1 <= workers <= 1024):
        msg = f"workers = {workers!r} must be a whole number from 1 to 1024"
        raise InputError(msg)
    if isinstance(executor, str) and executor not in NAMES and "://" not in executor:
        msg = f"there is no executor '{executor}'"
        raise InputError(msg, hint=closest(executor, [*NAMES, "tcp://HOST:PORT of a Dask scheduler"]))
    if not (executor is None or isinstance(executor, str) or hasattr(executor, "submit")):
        msg = f"{type(executor).__name__} is not an executor: it has no 'submit'"
        raise InputError(msg, hint="give one of " + ", ".join(NAMES) + ", or an executor of concurrent.futures")


def _arguments(sample: Sample, index: int) -> tuple[tuple[float, ...], int]:
    return tuple(sample.numbers[index].tolist()), int(sample.seeds[index])


@contextmanager
def one_thread() -> Iterator[None]:
    """Hold processes that start meanwhile to one thread each, unless the environment already says how many."""
    added = [name for name in THREADS if name not in os.environ]
    os.environ.update(dict.fromkeys(added, "1"))
    try:
        yield
    finally:
        for name in added:
            del os.environ[name]


def _processes(size: int) -> Executor:
    # started again rather than forked: threads and locks of this process stay out of them
    return ProcessPoolExecutor(size, mp_context=multiprocessing.get_context("spawn"))


@contextmanager
def _dask(address: str | None, workers: int | None) -> Iterator[tuple[Executor, int]]:
    """Give the executor of a Dask cluster and its number of workers: one on this machine, or that of an address."""
    try:
        import dask
        from distributed import Client, LocalCluster
    except ImportError:
        msg = "this executor needs the package dask.distributed"
        raise InputError(msg, hint="pip install 'concio[study]'") from None
    settings = {"distributed.scheduler.allowed-failures": 0, "logging.distributed": "critical"}
    with one_thread(), dask.config.set(settings):
        if address is None:
            size = workers or os.cpu_count() or 1
            with (
                LocalCluster(n_workers=size, threads_per_worker=1, dashboard_address=None, silence_logs=50) as cluster,
                Client(cluster) as client,
            ):
                yield client.get_executor(pure=False), size
            return
        try:
            client = Client(address, timeout="10s")
        except (OSError, ValueError) as error:
            msg = f"no Dask scheduler answers there: {error}"
            raise InputError(msg, where=address, hint="start one with 'dask scheduler'") from None
        with client:
            yield client.get_executor(pure=False), max(len(client.nthreads()), workers or 1)


def _run_processes(task: Task, sample: Sample, wanted: Sequence[int], emit: Emit, size: int) -> None:
    """Make runs in processes; where one is lost, those that were out are made alone, and a new pool takes the rest."""
    queue = deque(wanted)
    _check_portable(task)
    with one_thread():
        while queue:
            lost = []
            pool = _processes(size)
            try:
                _start(pool, min(size, len(queue)))
                for index, row in _ended(pool, task, sample, queue, size):
                    if row is None:
                        lost.append(index)
                    elif emit(row):
                        return
            finally:
                _end(pool)
            for index in sorted(lost):
                if emit(_alone(task, sample, index)):
                    return


def _run_foreign(pool: Executor, task: Task, sample: Sample, wanted: Sequence[int], emit: Emit, size: int) -> None:
    """Make runs by an executor that is not ours to end: a run whose worker was lost is handed out once more."""
    queue, lost = deque(wanted), Counter[int]()
    patience = AHEAD * (task.time_limit + GRACE) + GRACE
    for index, row in _ended(pool, task, sample, queue, size, patience):
        answer = row
        if row is None:
            lost[index] += 1
            if lost[index] < TRIES:
                queue.append(index)
                continue
            answer = Row(index, "worker_lost", f"its worker was lost {TRIES} times")
        if answer is not None and emit(answer):
            return
    if queue:
        msg = f"the executor takes no more runs; {len(queue)} were not made"
        raise ConcioError(msg, hint="resume the study with a new executor")


def _ended(
    pool: Executor, task: Task, sample: Sample, queue: deque[int], size: int, patience: float = math.inf
) -> Iterator[tuple[int, Row | None]]:
    """Yield runs as they end: number and row, None where the worker was lost; stops early where the pool is broken."""
    out: dict[Future[Row], tuple[int, float]] = {}
    try:
        while queue or out:
            while queue and len(out) < AHEAD * size:
                try:
                    future = pool.submit(task, queue[0], *_arguments(sample, queue[0]))
                except BrokenExecutor:
                    break
                out[future] = queue.popleft(), time.monotonic()
            if not out:
                return
            done, _ = wait(out, timeout=1.0, return_when=FIRST_COMPLETED)
            for future in done:
                index, _ = out.pop(future)
                yield index, _row_of(future, index)
            for future in [f for f, (_, since) in out.items() if time.monotonic() - since > patience]:
                index, _ = out.pop(future)
                future.cancel()  # nothing else ends a run that a foreign worker keeps
                yield index, Row(index, "time_limit", f"the run did not end within {task.time_limit:g} s")
    finally:
        for future in out:
            future.cancel()


def _check_portable(task: Task) -> None:
    """Raise where a run cannot be handed to another process."""
    try:
        pickle.dumps(task)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        msg = f"runs cannot be handed to workers: {error}"
        hint = "functions must be importable by workers: put them into a module, or use executor='serial'"
        raise ConcioError(msg, hint=hint) from None


def _ready() -> bool:
    return True


def _start(pool: Executor, size: int) -> None:
    """Start the processes of a pool together, and wait for the first; raise where they do not start at all.

    A pool begins one process for each call that it is given while none is free.
    """
    try:
        wait([pool.submit(_ready) for _ in range(size)], return_when=FIRST_COMPLETED).done.pop().result()
    except BrokenExecutor:
        msg = "worker processes do not start"
        hint = "a script that makes studies in processes does so below: if __name__ == '__main__':"
        raise ConcioError(msg, hint=hint) from None


def _row_of(future: Future[Row], index: int) -> Row | None:
    """Return the row of a run that has ended, or None where its worker was lost."""
    try:
        return future.result()
    except (BrokenExecutor, CancelledError):
        return None
    except Exception as error:  # what executors raise where they cannot carry a run to a worker and back
        if type(error).__name__ in ("KilledWorker", "CommClosedError", "FutureCancelledError"):
            return None
        msg = f"run {index} could not be handed to a worker: {type(error).__name__}: {error}"
        hint = "functions must be importable by workers: put them into a module, or use executor='serial'"
        raise ConcioError(msg, hint=hint) from error


def _alone(task: Task, sample: Sample, index: int) -> Row:
    """Make one run in a process of its own; where that is lost :data:`TRIES` times, return a row that says so."""
    seconds = 0.0
    for _ in range(TRIES):
        start = time.monotonic()
        pool = _processes(1)
        try:
            row = _row_of(pool.submit(task, index, *_arguments(sample, index)), index)
        finally:
            _end(pool)
        if row is not None:
            return row
        seconds = time.monotonic() - start
        if seconds > task.time_limit:
            return Row(index, "time_limit", f"the run did not end within {task.time_limit:g} s", seconds=seconds)
    return Row(index, "worker_lost", f"it took its process with it {TRIES} times", seconds=seconds)


def _end(pool: Executor) -> None:
    """Let a pool go at once: runs that are still at work in it are not waited for."""
    processes = list((getattr(pool, "_processes", None) or {}).values())
    pool.shutdown(wait=False, cancel_futures=True)
    for process in processes:
        with suppress(OSError, ValueError):
            process.terminate()
