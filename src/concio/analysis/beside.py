"""Work that goes on in a second thread while the first does something else: factorisations use both cores then."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from types import TracebackType
from typing import Generic, TypeVar

from concio.problem.solution import Progress, ProgressCallback

T = TypeVar("T")

LOOK = 0.1
"""Seconds between two looks at what the other thread tells, once it is waited for."""


class Beside(Generic[T]):
    """Runs a function in a second thread; leaving the block asks it to stop.

    Callbacks are called in the thread that waits, and only while it waits: a bar shows one thing at a time.

    Parameters
    ----------
    work : callable
        Takes a progress callback and returns its result; it stops soon after the callback has returned True.
    """

    def __init__(self, work: Callable[[ProgressCallback], T]) -> None:
        self.asked = threading.Event()
        self.told: Progress | None = None
        self.pool = ThreadPoolExecutor(1)
        self.future = self.pool.submit(work, self.note)

    def note(self, state: Progress) -> bool:
        """Keep what is reported; return whether to stop."""
        self.told = state
        return self.asked.is_set()

    def result(self, progress: ProgressCallback | None) -> T:
        """Wait for the result; raise what the function raised."""
        shown: Progress | None = None
        while progress is not None and not wait((self.future,), LOOK).done:
            if self.told is not None and self.told is not shown:
                shown = self.told
                if progress(shown):
                    self.asked.set()
        return self.future.result()

    def __enter__(self) -> Beside[T]:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.asked.set()
        self.pool.shutdown()
