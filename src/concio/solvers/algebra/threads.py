"""Threads of the dense linear algebra: one, while concio solves.

Sparse factorisations call dense kernels on small panels, millions of times. A second thread of OpenBLAS gains nothing
on them on a quiet machine, and waits for its turn on a busy one: there a limit analysis in space took eight to fifteen
times as long. PARDISO brings threads of its own, which are left alone. Who sets one of the variables :data:`VARIABLES`
has chosen, and nothing is changed.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from threading import current_thread, main_thread

from threadpoolctl import ThreadpoolController

VARIABLES = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "GOTO_NUM_THREADS")
"""Environment variables by which users choose the number of threads of OpenBLAS."""


@cache
def _libraries() -> ThreadpoolController:
    """Return the libraries that are loaded; looking for them takes milliseconds, and they are loaded before."""
    return ThreadpoolController().select(internal_api="openblas")


@contextmanager
def one_thread() -> Iterator[None]:
    """Let OpenBLAS work with one thread inside, unless the environment names a number.

    The number belongs to the process, and only the main thread can set it; in another thread it stays what it is.
    """
    if current_thread() is not main_thread() or any(name in os.environ for name in VARIABLES):
        yield
        return
    with _libraries().limit(limits=1):
        yield
