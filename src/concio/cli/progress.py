"""A progress bar on standard error while a solver works; where that is not a terminal, a line every ten seconds."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TYPE_CHECKING, Any

from concio.cli.outcome import QUIET

if TYPE_CHECKING:
    from pathlib import Path

    from concio.problem.solution import Progress, ProgressCallback
    from concio.verdict.verdict import Verdict

TARGET = 1e-6
"""Residual at which the bar is full: where the exact finish begins, at the latest."""

OFTEN = 0.1
"""A listener receives progress at most once in this time [s]."""
SELDOM = 10.0
"""Seconds between lines about the progress where standard error is not a terminal."""
SOON = 5.0
"""Seconds after which the time left is reported."""
ENOUGH = 0.01
"""Share of the work after which it is: what a path does first, many events at small loads, says nothing of the rest."""


SHARES = ("dynamics", "push", "assessment", "diagnose", "path")
"""Methods that report what is left to do in place of a residual."""
LISTENER: ContextVar[Callable[[str, Any], None] | None] = ContextVar("listener", default=None)
"""Receives what is known on the way: ("progress", {...}), ("found", lines), ("verdict", verdict)."""


@contextmanager
def progress_bar(*, shown: bool) -> Iterator[ProgressCallback | None]:
    """Give a callback that moves a bar, or None where nothing is to be shown.

    The bar shows how far the residual has fallen on a logarithmic scale; it never goes back. Long runs tell how much
    time is left if the residual goes on falling as it did. Where standard error is not a terminal, the words beside the
    bar are printed there every :data:`SELDOM` seconds: a log shows what a long run does.
    """
    listener, share, left = LISTENER.get(), Share(), TimeLeft()
    if listener is not None:
        sent = 0.0

        def report(state: Progress) -> None:
            nonlocal sent
            share.after(state)
            remaining = left.seconds(share.best, time.monotonic())
            if time.monotonic() - sent >= OFTEN:
                sent = time.monotonic()
                listener("progress", progress_of(state, share.best, remaining))

        yield report
        return
    if not shown or QUIET.get():
        yield None
        return
    if not sys.stderr.isatty():
        printed = time.monotonic()

        def beat(state: Progress) -> None:
            nonlocal printed
            now = time.monotonic()
            text = share.after(state) + left.after(share.best, now)
            if now - printed >= SELDOM:
                printed = now
                on_the_way([f"  {'at work':<20} {text}"])

        yield beat
        return
    from rich.console import Console
    from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bar

    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Bar(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("assembling", total=1.0)

        def move(state: Progress) -> None:
            text = share.after(state) + left.after(share.best, time.monotonic())
            bar.update(task, completed=share.best, description=text)

        yield move


def progress_of(state: Progress, share: float, remaining: float | None) -> dict[str, Any]:
    """Return what a listener receives: ``share`` of the work done, ``iteration``, and in words ``residual``, ``left``.

    The residual is empty where a solver reports what is left to do instead, the time left while it is not known.
    """
    counts = state.method in SHARES or not (math.isfinite(state.residual) and state.residual > 0)
    return {
        "share": share, "iteration": state.iteration, "residual": "" if counts else f"{state.residual:.1e}",
        "left": "" if remaining is None else duration(remaining),
    }  # fmt: skip


def found_so_far(lines: list[str], latest: list[str], *, shown: bool) -> None:
    """Send all lines that are known already to the listener, where there is one.

    Without a listener and without a terminal, which has a bar, print the latest ones on standard error.
    """
    listener = LISTENER.get()
    if listener is not None:
        listener("found", lines)
    elif shown:
        on_the_way(latest)


def on_the_way(lines: list[str]) -> None:
    """Print on standard error what is known on the way, unless it is a terminal, which has a bar."""
    if not QUIET.get() and not sys.stderr.isatty():
        sys.stderr.write("".join(f"so far:{line}\n" for line in lines))
        sys.stderr.flush()


def being_written(place: Path) -> None:
    """Say on standard error that a report is written now, which may take longer than the answer did."""
    if not QUIET.get() and LISTENER.get() is None:
        sys.stderr.write(f"so far:  {'at work':<20} the report and its figures are written to {place}\n")
        sys.stderr.flush()


def verdict_so_far(verdict: Verdict) -> None:
    """Send a verdict to the listener, where there is one, before the report and the tables are written."""
    listener = LISTENER.get()
    if listener is not None:
        listener("verdict", verdict)


class Share:
    """Estimates the share of the work that is done; it never goes back."""

    def __init__(self) -> None:
        self.first = self.best = 0.0

    def after(self, state: Progress) -> str:
        """Take in what a solver reports; return it in words."""
        text = f"{state.method}: iteration {state.iteration}"
        if state.method in SHARES:
            self.best = max(self.best, 1.0 - state.residual)
            text = state.method
        elif math.isfinite(state.residual) and state.residual > 0:
            self.first = self.first or max(state.residual, 10 * TARGET)
            share = math.log(self.first / state.residual) / math.log(self.first / TARGET)
            self.best = max(self.best, min(share, 1.0))
            text += f", residual {state.residual:.1e}"
        return text + (f", {state.message}" if state.message else "")


class TimeLeft:
    """Estimates the time left from the share of the work done so far."""

    def __init__(self) -> None:
        self.begun: tuple[float, float] | None = None

    def seconds(self, share: float, now: float) -> float | None:
        """Return the time left [s] when ``share`` of the work (0 to 1) is done at the time ``now`` [s].

        None while less than :data:`ENOUGH` is known, before :data:`SOON`, and when the bar is full.
        """
        if self.begun is None:
            self.begun = share, now
        gained, passed = share - self.begun[0], now - self.begun[1]
        if gained < ENOUGH or share >= 1 or passed < SOON:
            return None
        return passed / gained * (1 - share)

    def after(self, share: float, now: float) -> str:
        """Return the time left as ", about ... left", or nothing; see :meth:`seconds`."""
        left = self.seconds(share, now)
        return "" if left is None else f", about {duration(left)} left"


def duration(seconds: float) -> str:
    """Return a time in the unit people would use."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
