"""Figures of an assessment in space: the model, and a mechanism at its onset seen from the side to which it falls."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from concio.plot import style
from concio.plot.space_figures import block_colours, directions, draw_solids, plot_space_model
from concio.post.solids import model_solids

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.seismic.assessment import LocalMechanism
    from concio.model.model import Model

Array = np.ndarray

ENLARGED = 0.10
"""Largest motion in the picture of a mechanism, over the size of the model."""
TINTS = ("#E9E2D3", "#CFE0EA", "#EBD3C8", "#D6E3C6", "#DFD3E8", "#F1E4AE")
"""Colours of macro-blocks, in turn."""
ON_PAPER = (4.4, 4.4)
"""Width and height of the picture of a model [in]."""
ASIDE, LIFT = 0.6, 0.45
"""Angles of the eye from the way of falling, in plan, and above the horizontal [rad]."""


def model_in_space(model: Model, ax: Axes | None = None) -> Axes:
    """Draw the blocks, point loads and ties."""
    own = ax is None
    ax = plot_space_model(model, ax)
    for place in ("center", "left", "right"):
        ax.set_title("", loc=place)
    if own:  # names are read on paper, where the picture is half a page wide
        assert isinstance(ax.figure, Figure)
        ax.figure.set_size_inches(*ON_PAPER)
    return ax


def mechanism_in_space(mechanism: LocalMechanism, ax: Axes | None = None) -> Axes:
    """Draw a mechanism at its onset, enlarged, with its control point and the way of the push."""
    model, mechanics = mechanism.assembly.model, mechanism.mechanics
    shown = model_solids(model)
    displacement = np.zeros_like(shown.points)
    for b, block in mechanics.of_body.items():
        own = slice(shown.starts[b], shown.starts[b + 1])
        displacement[own] = mechanism.velocity_at(block, shown.points[own])
    shown = replace(shown, displacement=displacement)
    scale = ENLARGED * shown.size / float(np.linalg.norm(displacement, axis=1).max())
    along = mechanism.linkage.control[2]
    view = _view(along)
    free = block_colours(model)
    tints = {b: TINTS[block % len(TINTS)] for b, block in mechanics.of_body.items()}
    colours = [
        colour if body.kind == "fixed" else tints.get(b, "#FFFFFF")
        for b, (body, colour) in enumerate(zip(model.bodies, free, strict=True))
    ]
    ax, picture = draw_solids(shown, colours, view, ax, scale, "")
    flat = picture.axes[:2]
    at = np.array(mechanism.control[1])
    moved = at + scale * mechanism.velocity_at(mechanism.linkage.control[0], at)
    ax.plot(*(flat @ moved), "x", ms=8, mew=2, color=style.TENSION.colour, zorder=6)
    start, end = flat @ moved, flat @ (moved + 0.15 * shown.size * along)
    look = {"arrowstyle": "-|>", "color": style.LOAD.colour, "lw": 1.6}
    ax.annotate("", (float(end[0]), float(end[1])), (float(start[0]), float(start[1])), arrowprops=look, zorder=6)
    for tie in model.ties:
        ends = np.array([tie.at_a, tie.at_b]) @ flat.T
        ax.plot(ends[:, 0], ends[:, 1], color=style.TENSION.colour, lw=1.4, zorder=5)
    return ax


def _view(along: Array) -> tuple[float, float]:
    """Return the angles of an eye towards which, somewhat aside, a mechanism falls."""
    for turn in (-ASIDE, ASIDE):
        angle = float(np.arctan2(along[0], -along[1])) + turn
        if directions((angle, LIFT))[2] @ along > 0:
            return angle, LIFT
    return -0.7, LIFT
