"""Work in a second thread: its result, what it raises, and that it stops when asked to."""

from __future__ import annotations

import threading

import pytest

from concio.analysis.beside import Beside
from concio.problem.solution import Progress, ProgressCallback


def endless(begun: threading.Event, ended: threading.Event) -> object:
    def work(tell: ProgressCallback) -> int:
        count = 0
        while not tell(Progress("work", count, 0.0, "still")):
            count += 1
            begun.set()
        ended.set()
        return count

    return work


def test_leaving_the_block_stops_the_work_whatever_was_raised_in_it() -> None:
    begun, ended = threading.Event(), threading.Event()
    beside = Beside(endless(begun, ended))
    assert begun.wait(10)
    beside.__exit__(KeyboardInterrupt, KeyboardInterrupt(), None)
    assert ended.is_set()


def test_a_callback_that_asks_to_stop_is_obeyed_and_called_in_the_thread_that_waits() -> None:
    begun, ended = threading.Event(), threading.Event()
    threads = set()

    def stop(state: Progress) -> bool:
        assert state.message == "still"
        threads.add(threading.current_thread())
        return True

    with Beside(endless(begun, ended)) as beside:
        assert beside.result(stop) > 0
    assert threads == {threading.current_thread()}


def test_what_the_work_raises_is_raised_where_it_is_waited_for() -> None:
    def work(tell: ProgressCallback) -> None:
        raise ZeroDivisionError

    with Beside(work) as beside, pytest.raises(ZeroDivisionError):
        beside.result(None)
