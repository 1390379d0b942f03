"""Figures of a wall whose blocks become smaller at fixed outline: the way to its homogenised continuum."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from concio.arguments import strict
from concio.errors import InputError
from concio.plot import style
from concio.plot.diagram import diagram_axes, dress_diagram

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.continuum.halving import BlockHalving

SIZE = (6.6, 4.4)
"""Width and height of a new figure [in]."""

ACROSS = "size of the blocks, over that of the largest"


@strict
def plot_limit_by_size(halving: BlockHalving, ax: Axes | None = None) -> Axes:
    """Draw the limit load of the blocks against their size, and the band in which that of the continuum lies.

    Parameters
    ----------
    halving : BlockHalving
        With limit loads.
    ax : Axes, optional
        Where to draw; default a new figure.

    Raises
    ------
    InputError
        There are no limit loads.
    """
    table = halving.table()
    load, (low, high) = table["limit_blocks"], halving.bracket
    if not np.isfinite(load).any():
        msg = "there are no limit loads to draw"
        raise InputError(msg, hint="give the wall a load group 'live', or name one: live=...")
    ax = diagram_axes(ax, SIZE)
    size = 1.0 / table["times_smaller"]
    ax.axhspan(low if np.isfinite(low) else 0.0, high, color=style.NEIGHBOUR, lw=0, zorder=0)
    ax.axhline(high, color=style.TENSION.colour, ls=style.TENSION.dash, lw=1.3, zorder=1)
    if np.isfinite(low):
        ax.axhline(low, color=style.LOAD.colour, ls=(0, (1.2, 1.2)), lw=1.5, zorder=1)
    ax.plot(size, load, "o-", color=style.COMPRESSION.colour, mfc="white", lw=1.6, zorder=3)
    for s, v, n in zip(size, load, table["blocks"], strict=True):
        ax.annotate(f"{n} blocks", (s, v), (4, -13), textcoords="offset points", fontsize=8, color="#555555")
    ax.set_xlim(0.0, 1.12 * float(size.max()))
    blocks = style.Line(style.COMPRESSION.colour, "-", 1.6, "wall of blocks")
    above = style.Line(style.TENSION.colour, style.TENSION.dash, 1.3, f"continuum: at most {high:.4g} (a mechanism)")
    handles = [style.handle(blocks), style.handle(above)]
    if np.isfinite(low):
        below = style.Line(style.LOAD.colour, (0, (1.2, 1.2)), 1.5, f"continuum: at least {low:.4g} (stresses)")
        handles.append(style.handle(below))
    dress_diagram(ax, "Limit load as the blocks become smaller", ACROSS, "limit load multiplier (associated)")
    ax.legend(handles=handles, frameon=False, fontsize=8.5, loc="best")
    return ax


@strict
def plot_difference_by_size(halving: BlockHalving, ax: Axes | None = None) -> Axes:
    """Draw how far displacements of blocks are from those of the continuum, against the size of the blocks.

    Parameters
    ----------
    halving : BlockHalving
        With elastic answers.
    ax : Axes, optional
        Where to draw; default a new figure.

    Raises
    ------
    InputError
        There are no elastic answers.
    """
    from matplotlib.ticker import NullLocator

    table = halving.table()
    bonded, own = table["difference_bonded"], table["difference_blocks"]
    if not np.isfinite(bonded).any():
        msg = f"there are no elastic answers to draw: {halving.comparisons[0].elastic_note}"
        raise InputError(msg, hint="make the blocks elastic, or give joints a stiffness")
    ax = diagram_axes(ax, SIZE)
    size = 1.0 / table["times_smaller"]
    looks = [(bonded, style.Line(style.COMPRESSION.colour, "-", 1.6, "blocks bonded: no joint opens or slips"))]
    if np.isfinite(own).any():
        looks.append((own, style.Line(style.TENSION.colour, style.TENSION.dash, 1.6, "blocks: joints open and slip")))
    for value, look in looks:
        ax.plot(size, value, "o", ls=look.dash, color=look.colour, mfc="white", lw=look.width)
    first = bonded[np.isfinite(bonded)][0]
    ax.plot(size, first * size / size[0], color="#999999", lw=0.9, ls=":")
    ax.set(xscale="log", yscale="log")
    ax.set_xticks(size, [f"1/{n}" if n > 1 else "1" for n in halving.sizes])
    ax.xaxis.set_minor_locator(NullLocator())
    up = "difference from the continuum's displacements [-]"
    dress_diagram(ax, "Displacements as the blocks become smaller", ACROSS, up)
    slope = style.Line("#999999", ":", 0.9, "in proportion to the size")
    ax.legend(handles=[style.handle(look) for _, look in looks] + [style.handle(slope)], frameon=False, fontsize=8.5)
    return ax
