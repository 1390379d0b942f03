"""One look for all figures: what each colour, dash and hatch means, axes, legends and scale bars.

Colours are those of Okabe and Ito, distinguished by the colour-blind; every meaning is carried a second time by dash,
width or hatch, so that a grey copy reads as well.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from concio.display import DEFAULT, Units, number

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.result import Result
    from concio.model.model import Model
    from concio.post.outlines import Outlines

Array = np.ndarray


@dataclass(frozen=True)
class Line:
    """Look of one meaning: colour, dash, width in points, and the word in the legend."""

    colour: str
    dash: Any
    width: float
    word: str


COMPRESSION = Line("#0072B2", "-", 1.8, "compression")
TENSION = Line("#D55E00", (0, (3, 1.6)), 1.6, "tension")
STICK = Line("#3A3A3A", "-", 1.0, "closed, sticks")
SLIP = Line("#CC79A7", (0, (2.2, 0.9)), 2.4, "closed, slips")
OPEN = Line("#E69F00", (0, (0.8, 1.2)), 2.0, "open")
LOAD = Line("#009E73", "-", 1.4, "load")
THRUST = Line("#0072B2", "-", 2.0, "thrust line")
CRUSHED = Line("#882255", "-", 3.2, "crushed")
CELL = Line("#009E73", (0, (5, 2)), 1.6, "the cell")

BLOCK, FILM, RIGID, OBSTACLE = "#F3EEE4", "#DDD5C6", "#E4E4E4", "#FFFFFF"
NEIGHBOUR = "#ECECEC"
EDGE, GHOST, HATCH, INK = "#8C8375", "#B8B2A8", "#9A9A9A", "#222222"
FILL_OPEN = "#FBDFA6"
SEQUENTIAL = "cividis"
"""Colour map of quantities without a sign; it grows lighter steadily, also in grey."""

WIDEST, NARROWEST, TALLEST = 9.2, 4.6, 8.4
"""Sizes of the drawing in a figure of its own [inch]."""
MARGINS = (0.66, 0.3, 0.66, 0.86)
"""Room left, right, above and below the drawing for labels, title and legend [inch]."""

LARGE = 3000
"""Above this number of bodies lines are thin and vector files hold the drawing as an image."""


def axes_for(box: Array, ax: Axes | None) -> Axes:
    """Return ``ax``, or the axes of a new figure whose shape suits ``box`` = ((x0, y0), (x1, y1)) [m]."""
    if ax is not None:
        return ax
    from concio.plot.shown import new_figure

    width, height = np.maximum(box[1] - box[0], 1e-9)
    wide = float(np.clip(TALLEST * width / height, NARROWEST, WIDEST))
    tall = float(np.clip(wide * height / width, 0.9, TALLEST))
    left, right, top, bottom = MARGINS
    size = (wide + left + right, tall + top + bottom)
    figure = new_figure(size)
    axes: Axes = figure.add_axes((left / size[0], bottom / size[1], wide / size[0], tall / size[1]))
    return axes


def draw_at_rest(
    result: Result, ax: Axes | None, *, face: Sequence[Any] | None = None, around: Array | None = None
) -> tuple[Axes, Outlines, Array]:
    """Draw the bodies where they were before loading, in axes of their own shape where none are given.

    Parameters
    ----------
    result : Result
    ax : Axes or None
    face : colours, optional
        Of the bodies.
    around : (..., 2) array, optional
        Points that have to be inside the box as well [m].

    Returns
    -------
    ax : Axes
    shown : Outlines
    box : (2, 2) array
        Corners of the drawing [m].
    """
    from concio.post.outlines import outlines

    shown = outlines(result)
    box = box_of(shown.points)
    if around is not None and around.size:
        corners = np.vstack([box, box_of(around, margin=0.01)])
        box = np.array([corners.min(0), corners.max(0)])
    ax = axes_for(box, ax)
    draw_bodies(ax, result.model, shown, face=face)
    return ax, shown, box


def box_of(*points: Array, margin: float = 0.04) -> Array:
    """Return the box ((x0, y0), (x1, y1)) around points, with a margin as a share of its longer side."""
    everything = np.vstack([p.reshape(-1, 2) for p in points if p.size])
    low, high = everything.min(0), everything.max(0)
    span = high - low
    pad = np.minimum(margin * float(span.max()), np.maximum(2 * margin * span, 0.01 * float(span.max())))
    return np.array([low - pad, high + pad])


def dress(ax: Axes, box: Array, title: str, note: str = "", *, units: Units = DEFAULT) -> None:
    """Set limits, equal scales, labels with units, and the title with a note under it; drawn is in m."""
    ax.set_xlim(box[0, 0], box[1, 0])
    ax.set_ylim(box[0, 1], box[1, 1])
    ax.set_aspect("equal")
    ax.set_xlabel(f"x [{units.length}]", fontsize=8, color=INK)
    ax.set_ylabel(f"y [{units.length}]", fontsize=8, color=INK)
    if units.length != "m":
        factor, _ = units.factor("length")
        for axis in (ax.xaxis, ax.yaxis):
            axis.set_major_formatter(lambda value, _: number(factor * value, 6))
    ax.tick_params(labelsize=7.5, colors="#555555", length=3, width=0.6)
    for spine in ax.spines.values():
        spine.set_visible(False)
    ax.set_title(title, loc="left", fontsize=11, color=INK, pad=22 if note else 8, fontweight="bold")
    if note:
        ax.annotate(
            note, (0, 1), (0, 8), xycoords="axes fraction", textcoords="offset points", fontsize=8.5, color="#555555"
        )


def legend(ax: Axes, handles: Sequence[Any], columns: int = 4) -> None:
    """Put a legend without frame under the axes."""
    if handles:
        room = ax.get_window_extent().width / ax.figure.dpi
        ax.legend(
            handles=list(handles), loc="upper center", bbox_to_anchor=(0.5, 0.0), bbox_transform=_below(ax),
            ncols=max(1, min(columns, len(handles), int(room / 1.35))), frameon=False, fontsize=8.5, handlelength=2.6,
            borderaxespad=0.0,
        )  # fmt: skip


def _below(ax: Axes) -> Any:
    from matplotlib.transforms import ScaledTranslation

    return ax.transAxes + ScaledTranslation(0, -0.5, ax.figure.dpi_scale_trans)


def handle(line: Line, word: str | None = None) -> Any:
    """Return the legend entry of a meaning."""
    from matplotlib.lines import Line2D

    return Line2D([], [], color=line.colour, linestyle=line.dash, linewidth=line.width, label=word or line.word)


def patch(colour: str, word: str, edge: str = EDGE, hatch: str | None = None) -> Any:
    """Return the legend entry of an area."""
    from matplotlib.patches import Patch

    return Patch(facecolor=colour, edgecolor=edge, hatch=hatch, label=word, linewidth=0.8)


def draw_lines(ax: Axes, lines: Array, look: Line, *, width: float | Array | None = None, **options: Any) -> None:
    """Draw line pieces (k, 2, 2) with the look of one meaning."""
    from matplotlib.collections import LineCollection

    if not len(lines):
        return
    options.setdefault("capstyle", "butt")
    ax.add_collection(
        LineCollection(
            list(lines), colors=look.colour, linestyles=[look.dash], linewidths=look.width if width is None else width,
            rasterized=len(lines) > 4 * LARGE, **options,
        )
    )  # fmt: skip


def draw_bodies(
    ax: Axes, model: Model, shown: Outlines, scale: float = 0.0, *, face: Sequence[Any] | None = None, edge: str = EDGE
) -> None:
    """Fill the bodies, obstacles hatched; ``face`` gives colours body by body in place of those of the materials."""
    polygons = shown.moved(scale)
    fixed = np.array([b.kind == "fixed" for b in model.bodies])
    free = np.flatnonzero(~fixed).tolist()
    colours = [body_colour(model.bodies[b]) for b in free] if face is None else [face[b] for b in free]
    many = len(free) > LARGE
    width = 0.2 if many else 0.6
    ax.add_collection(
        polygons_of([polygons[b] for b in free], facecolors=colours, edgecolors=edge, linewidths=width, zorder=1,
                       rasterized=many)
    )  # fmt: skip
    ax.add_collection(
        polygons_of([polygons[b] for b in np.flatnonzero(fixed)], facecolors=OBSTACLE, edgecolors=HATCH,
                       hatch="/////", linewidths=0.8, zorder=0.9)
    )  # fmt: skip


def polygons_of(bodies: Sequence[Sequence[Array]], **options: Any) -> Any:
    """Return a collection of polygons, each given by its outline and its holes."""
    from matplotlib.collections import PathCollection, PolyCollection
    from matplotlib.path import Path

    if all(len(rings) == 1 for rings in bodies):
        return PolyCollection([rings[0] for rings in bodies], **options)
    paths = [Path.make_compound_path(*(Path(closed(ring), closed=True) for ring in rings)) for rings in bodies]
    return PathCollection(paths, **options)


def closed(ring: Array) -> Array:
    """Return a ring (n, 2) whose last point is its first."""
    return ring if np.array_equal(ring[0], ring[-1]) else np.vstack([ring, ring[:1]])


def body_colour(body: Any) -> str:
    """Return the fill of a body: block, mortar film, rigid block or obstacle."""
    if body.kind == "fixed":
        return OBSTACLE
    if body.kind == "rigid":
        return RIGID
    return FILM if body.role == "mortar" else BLOCK


def ghost(ax: Axes, shown: Outlines) -> None:
    """Draw where the bodies were, thin and grey."""
    from matplotlib.collections import LineCollection

    if len(shown.starts) <= LARGE:
        rings = [ring for body in shown.moved(0.0) for ring in body]
        ax.add_collection(LineCollection(rings, colors=GHOST, linewidths=0.5, linestyles=":", zorder=0.8))


def scale_bar(ax: Axes, box: Array, length: float, word: str, line: Line) -> None:
    """Draw a bar of ``length`` [m] with its meaning under the right end of the drawing."""
    from matplotlib.transforms import ScaledTranslation

    place = ax.get_xaxis_transform() + ScaledTranslation(0, -0.36, ax.figure.dpi_scale_trans)
    stop = box[1, 0] - 0.02 * (box[1, 0] - box[0, 0])
    start = stop - length
    ax.plot([start, stop], [0, 0], color=line.colour, lw=2.2, transform=place, clip_on=False, solid_capstyle="butt")
    ax.plot([start, start, np.nan, stop, stop], [-0.008, 0.008, np.nan, -0.008, 0.008], color=line.colour, lw=1.2,
            transform=place, clip_on=False)  # fmt: skip
    ax.annotate(
        word, (start, 0), (-6, 0), xycoords=place, textcoords="offset points", ha="right", va="center", fontsize=8.5,
        color=INK, annotation_clip=False,
    )  # fmt: skip


def round_value(value: float) -> float:
    """Return the largest of 1, 2, 5 times a power of ten that is not above ``value``."""
    if not (value > 0 and np.isfinite(value)):
        return 1.0
    power = 10.0 ** np.floor(np.log10(value))
    return float(power * max(step for step in (1.0, 2.0, 5.0) if step <= value / power * (1 + 1e-12)))

