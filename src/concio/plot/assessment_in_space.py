"""Figures of an assessment in space: the model, and a mechanism at its onset seen from the side to which it falls."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from concio.display import number
from concio.plot import style
from concio.plot.space_figures import NAME_SIZE, block_colours, directions, draw_solids, plot_space_model
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
BESIDE, DEEP = 0.05, 0.3
"""Distance of a dimension from the blocks, and at most below their foot, over the size of the model."""
NAMED, OF_SIZE = 150, 60
"""Up to so many blocks are named on paper, and up to so many in letters of full size."""
ASIDE, LIFT = 0.6, 0.45
"""Angles of the eye from the way of falling, in plan, and above the horizontal [rad]."""


def model_in_space(model: Model, ax: Axes | None = None) -> Axes:
    """Draw the blocks, point loads and ties."""
    own = ax is None
    many = len(model.free_bodies)
    ax = plot_space_model(model, ax, names=many <= NAMED)
    for text in ax.texts:
        if text.get_text() in {b.name for b in model.free_bodies}:
            text.set_fontsize(NAME_SIZE * min(1.0, (OF_SIZE / many) ** 0.5))
    for place in ("center", "left", "right"):
        ax.set_title("", loc=place)
    _dimensions(ax, model)
    if own:
        ax.set_position((0.01, 0.01, 0.98, 0.98))
    if own:  # names are read on paper, where the picture is half a page wide
        assert isinstance(ax.figure, Figure)
        ax.figure.set_size_inches(*ON_PAPER)
    return ax


def _dimensions(ax: Axes, model: Model) -> None:
    """Draw how far the free blocks reach along x, y and z [m], beside the edges of their box that are seen."""
    points = np.vstack([np.asarray(b.vertices) for b in model.free_bodies])
    low, high = points.min(0), points.max(0)
    size = float((high - low).max())
    fixed = [float(np.asarray(b.vertices)[:, 2].min()) for b in model.bodies if b.kind == "fixed"]
    foot = max(min([low[2], *fixed]), low[2] - DEEP * size)
    right, up, _ = directions("axonometry")  # from low x and low y
    flat = np.array([right, up])
    edges = (
        ((low[0], low[1], foot), (high[0], low[1], foot), (0.0, -1.0)),
        ((low[0], high[1], foot), (low[0], low[1], foot), (0.0, -1.0)),
        ((high[0], low[1], low[2]), (high[0], low[1], high[2]), (1.0, 0.0)),
    )
    look = {"arrowstyle": "<->", "color": style.INK, "lw": 0.7, "shrinkA": 0, "shrinkB": 0}
    for k, (start, end, aside) in enumerate(edges):
        a, b = (flat @ np.array(p) + BESIDE * size * np.array(aside) for p in (start, end))
        ax.annotate("", (float(b[0]), float(b[1])), (float(a[0]), float(a[1])), arrowprops=look, zorder=7,
                    annotation_clip=False)  # fmt: skip
        turn = float(np.degrees(np.arctan2(b[1] - a[1], b[0] - a[0])))
        x, y = ((a + b) / 2).tolist()
        ax.text(x, y, f"{number(float((high - low)[k]), 4)} m", fontsize=7.5, ha="center", va="center", rotation=turn,
                rotation_mode="anchor", zorder=8, bbox={"fc": "white", "ec": "none", "pad": 0.8})  # fmt: skip
    (x0, x1), (y0, y1) = ax.get_xlim(), ax.get_ylim()
    more = 2.5 * BESIDE * size
    ax.set_xlim(x0 - more, x1 + more)
    ax.set_ylim(y0 - more, y1)


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
