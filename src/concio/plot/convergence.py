"""Figure: residual against work for several methods on one problem."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from concio.arguments import strict
from concio.problem.tolerances import CERTIFIED

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
"""Okabe and Ito's colours, distinguished by the colour-blind; yellow left out, too light for lines."""

DASHES: tuple[Any, ...] = ("-", "--", ":", "-.")


class Curve(Protocol):
    """What is drawn of a method: a row of :class:`concio.studies.compare.ComparisonTable` has it."""

    @property
    def method(self) -> str:
        """Name of the method."""

    @property
    def outcome(self) -> str:
        """What became of it."""

    @property
    def history(self) -> Sequence[float]:
        """Residuals, one for each unit of work counted."""

    @property
    def work(self) -> Sequence[float]:
        """Work done when each residual was met."""


class Table(Protocol):
    """What holds the curves."""

    @property
    def rows(self) -> Sequence[Curve]:
        """One curve for each method."""

    @property
    def title(self) -> str:
        """Title of the figure."""


@strict
def plot_convergence(table: Table, ax: Axes | None = None) -> Axes:
    """Draw the best residual so far against the work, one line a method, both axes logarithmic.

    Parameters
    ----------
    table : ComparisonTable
        Its rows with a residual history are drawn; a method that counts no work is drawn over its iterations.
    ax : Axes, optional
        Where to draw; default a new figure.

    Returns
    -------
    Axes
        A filled end of a line is a solved problem, a cross one that was not.
    """
    import matplotlib.pyplot as plt

    if ax is None:
        _, ax = plt.subplots(figsize=(7.5, 4.8), layout="constrained")
    drawn = [row for row in table.rows if len(row.history)]
    for k, row in enumerate(drawn):
        residual = np.asarray(row.history, dtype=float)
        residual = np.where(np.isfinite(residual) & (residual > 0), residual, np.nan)
        best = np.fmin.accumulate(residual)
        counted = len(row.work) == len(row.history)
        work = np.asarray(row.work, dtype=float) if counted else np.arange(1.0, best.size + 1.0)
        colour = COLOURS[k % len(COLOURS)]
        label = row.method if counted else f"{row.method} (by iterations)"
        dash = DASHES[(k + 2 * (k // len(COLOURS))) % len(DASHES)]
        ax.plot(work, best, color=colour, linestyle=dash, lw=1.4, label=label)
        solved = row.outcome == "solved"
        ax.plot(work[-1:], best[-1:], color=colour, marker="o" if solved else "x", ms=6, mew=1.6, ls="none")
    ax.axhline(CERTIFIED, color="0.5", lw=0.8)
    ax.annotate("certified", (0.005, CERTIFIED), xycoords=("axes fraction", "data"), ha="left", va="bottom", fontsize=8)
    ax.set(xscale="log", yscale="log", xlabel="work [factorisations of K + C'C]", ylabel="residual [-]")
    ax.set_title(table.title, loc="left", fontsize=10)
    if drawn:
        ax.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False, fontsize=8, title="o solved, x not")
    return ax
