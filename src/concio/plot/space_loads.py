"""Loads in figures of structures in space: arrows at points, outlines and arrows on faces, each with its size."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from concio.model.body import called
from concio.plot import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.model.actions import Load
    from concio.model.model import Model

Array = np.ndarray
LENGTH = 0.08
"""Length of an arrow as a share of the greatest extent of the model."""
END_ON = 0.2
"""An arrow is a dot where less than this share of its length is seen."""
WRITTEN = 12
"""Sizes are written beside up to this many loads."""


def draw_loads(ax: Axes, model: Model, axes: Array) -> None:
    """Draw point loads and loads on faces; self-weight is reported in words.

    Parameters
    ----------
    ax : Axes
    model : Model
        In space.
    axes : (3, 3) array
        Right, up and towards the eye, as rows.
    """
    flat = axes[:2]
    few = sum(bool(load.polygon or load.at) for load in model.loads) <= WRITTEN
    for load in model.loads:
        size = float(np.linalg.norm(load.value))
        place = load.polygon or load.edge or (() if load.at is None else (load.at,))
        if not len(place) or not size > 0:
            continue
        outline = np.array([*place, place[0]], dtype=float) @ flat.T
        ax.plot(*outline.T, color=style.LOAD.colour, lw=style.LOAD.width, zorder=5)
        tip = outline[:-1].mean(0)
        arrow = LENGTH * model.size * (flat @ load_direction(load, model))
        kind = "force" if load.kind == "point" else "stress"
        word = model.report.text(kind, size) if few and load.edge is None else ""
        if np.linalg.norm(arrow) < END_ON * LENGTH * model.size:
            ax.plot(*tip, "o", color=style.LOAD.colour, ms=5, zorder=5)
            ax.annotate(word, tip, xytext=(5, 5), textcoords="offset points", fontsize=7, color=style.LOAD.colour)
            continue
        ax.quiver(
            *(tip - arrow), *arrow, color=style.LOAD.colour, angles="xy", scale_units="xy", scale=1, width=0.004,
            headwidth=4, headlength=5, zorder=5, clip_on=False,
        )  # fmt: skip
        ax.annotate(
            word, tip - 1.15 * arrow, ha="center", va="center", fontsize=7, color=style.LOAD.colour,
            annotation_clip=False, zorder=6,
        )  # fmt: skip


def load_direction(load: Load, model: Model) -> Array:
    """Return the unit direction (3,) of a load; a pressure acts against the face on which its polygon lies."""
    value = np.array(load.value, dtype=float)
    if load.kind != "pressure":
        return np.asarray(value / np.linalg.norm(value))
    corners = np.array(load.polygon, dtype=float)
    middle = corners.mean(0)
    _, _, (_, _, across) = np.linalg.svd(corners - middle)
    loaded = [b for b in model.polyhedra if b.kind != "fixed" and
              (not load.bodies or any(called(word, b) for word in load.bodies))]  # fmt: skip
    off = [(abs(float(b.normals[f] @ middle - b.offsets[f])), -b.normals[f])
           for b in loaded for f in np.flatnonzero(np.abs(b.normals @ across) > 0.999)]  # fmt: skip
    inward = min(off, key=lambda entry: entry[0])[1] if off else across
    return np.asarray(np.sign(value[0]) * inward)
