"""Axes of plain diagrams, one quantity over another: how they are made and dressed, alike in all of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from concio.plot import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

GRID = "#E8E4DC"
"""Colour of the grid."""


def figure_of(size: tuple[float, float]) -> Figure:
    """Return a new figure of a width and a height [in] that no window shows."""
    from concio.plot.shown import new_figure

    return new_figure(size, layout="constrained")


def diagram_axes(ax: Axes | None, size: tuple[float, float]) -> Axes:
    """Return ``ax``, or the axes of a new figure of a width and a height [in]."""
    return figure_of(size).add_subplot() if ax is None else ax


def plain_frame(ax: Axes) -> None:
    """Leave out the frame above and on the right, and draw a light grid behind everything."""
    ax.tick_params(labelsize=8)
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
    ax.grid(color=GRID, lw=0.6)
    ax.set_axisbelow(True)


def dress_diagram(ax: Axes, title: str, across: str, up: str) -> Axes:
    """Give axes their title, the words along them and a plain frame, and return them."""
    plain_frame(ax)
    ax.set_xlabel(across, fontsize=9)
    ax.set_ylabel(up, fontsize=9)
    ax.set_title(title, loc="left", fontsize=11, fontweight="bold", color=style.INK)
    return ax
