"""Bars of what a limit multiplier depends on: its change for one per cent more of each number."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from concio.plot import style
from concio.plot.diagram import diagram_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.sensitivity import Sensitivity, SensitivityRow

MOST = 8
"""Bars at most."""


def sensitivity_figure(
    found: Sensitivity, label: str, name: Callable[[SensitivityRow], str], ax: Axes | None = None
) -> Axes:
    """Draw a bar for each number that matters, the largest on top.

    Parameters
    ----------
    found : Sensitivity
    label : str
        Of the axis.
    name : callable
        Words for a row.
    ax : Axes, optional
    """
    rows = found.rows[:MOST][::-1]
    ax = diagram_axes(ax, (6.4, 0.5 + 0.26 * len(rows)))
    for k, row in enumerate(rows):
        less, more = row.per_percent
        if row.one_sided:
            ax.barh(k + 0.2, more, height=0.36, color=style.TENSION.colour)
            ax.barh(k - 0.2, -less, height=0.36, color=style.TENSION.colour, alpha=0.4)
        else:
            ax.barh(k, more, height=0.6, color=style.TENSION.colour)
    ax.axvline(0.0, color=style.INK, lw=0.8)
    ax.set_yticks(range(len(rows)), [name(row) for row in rows], fontsize=8)
    ax.set_xlabel(label, fontsize=8)
    ax.tick_params(axis="x", labelsize=8)
    return ax
