"""A progress bar on standard error while a solver works; none where standard error is not a terminal."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from concio.problem.solution import Progress, ProgressCallback

TARGET = 1e-10
"""Residual at which the bar is full."""


@contextmanager
def progress_bar(*, shown: bool) -> Iterator[ProgressCallback | None]:
    """Give a callback that moves a bar, or None where there is nobody to see it.

    The bar shows how far the residual has fallen on a logarithmic scale; it never goes back.
    """
    if not shown or not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bar

    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Bar(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("assembling", total=1.0)
        first = 0.0
        best = 0.0

        def move(state: Progress) -> None:
            nonlocal first, best
            text = f"{state.method}: iteration {state.iteration}"
            if state.method in ("dynamics", "push"):  # what is left to do, not a residual
                best = max(best, 1.0 - state.residual)
                text = state.method
            elif math.isfinite(state.residual) and state.residual > 0:
                first = first or max(state.residual, 10 * TARGET)
                share = math.log(first / state.residual) / math.log(first / TARGET)
                best = max(best, min(share, 1.0))
                text += f", residual {state.residual:.1e}"
            bar.update(task, completed=best, description=text + (f", {state.message}" if state.message else ""))

        yield move
