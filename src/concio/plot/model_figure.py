"""Figure of a model: bodies with their names, obstacles, supports, loads and ties."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from concio.arguments import strict
from concio.kinematics.frames import turned_right
from concio.model.interfaces.periodic import images
from concio.plot import style
from concio.plot.road_figure import draw_fill, draw_vehicle, road_box

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.display import Units
    from concio.model.model import Body, Load, Model, Periods

Array = np.ndarray

NAMED = 150
"""Up to this many bodies get their names written."""


@strict
def plot_model(model: Model, ax: Axes | None = None, *, names: bool | None = None) -> Axes:
    """Draw a model as it is described, before meshing.

    Parameters
    ----------
    model : Model
    ax : Axes, optional
        Where to draw; default a new figure.
    names : bool, optional
        Write the names of the bodies; default for up to 150 bodies.

    Returns
    -------
    Axes
    """
    box = style.box_of(*[b.outline for b in model.outlines])
    if model.periods is not None:
        box = box + np.array([[-1.0], [1.0]]) * 0.35 * (box[1] - box[0])
    if any(load.edge is not None or load.at is not None for load in model.loads):
        box = box + np.array([[-1.0], [1.0]]) * 0.05 * float((box[1] - box[0]).max())
    if model.fill is not None:
        road = road_box(model)
        room = 0.1 * float(np.ptp(road[:, 0])) if model.vehicle is not None else 0.0
        box = np.array([np.minimum(box[0], road[0]), np.maximum(box[1], road[1] + [0.0, room])])
    size = float((box[1] - box[0]).max())
    ax = style.axes_for(box, ax)
    fixed = [b for b in model.outlines if b.kind == "fixed"]
    free = [b for b in model.outlines if b.kind != "fixed"]
    many = len(free) > style.LARGE
    ax.add_collection(
        style.polygons_of([b.rings for b in free], facecolors=[style.body_colour(b) for b in free],
                       edgecolors=style.EDGE, linewidths=0.2 if many else 0.7, rasterized=many, zorder=1)
    )  # fmt: skip
    ax.add_collection(
        style.polygons_of([b.rings for b in fixed], facecolors=style.OBSTACLE, edgecolors=style.HATCH, hatch="/////",
                       linewidths=0.8, zorder=0.9)
    )  # fmt: skip
    if model.periods is not None:
        _neighbours(ax, model, model.periods)
    if names if names is not None else len(model.bodies) <= NAMED:
        _names(ax, model, box)
    kinds = {("rigid" if b.kind == "rigid" else b.role) for b in free}
    handles: list[Any] = []
    if kinds - {"mortar", "rigid"}:
        handles.append(style.patch(style.BLOCK, "block"))
    if "rigid" in kinds:
        handles.append(style.patch(style.RIGID, "rigid block"))
    if "mortar" in kinds:
        handles.append(style.patch(style.FILM, "mortar"))
    if model.periods is not None:
        handles += [style.patch(style.NEIGHBOUR, "neighbouring cells"), style.handle(style.CELL)]
    if fixed:
        handles.append(style.patch(style.OBSTACLE, "fixed", style.HATCH, "/////"))
    for support in model.supports:
        _support(ax, model, support, size)
    if model.supports:
        from matplotlib.lines import Line2D

        handles.append(Line2D([], [], color=style.INK, marker="^", ls="none", ms=6, label="support"))
    bars = [tie for tie in model.ties if tie.kind == "bar"]
    if model.fill is not None:
        handles += draw_fill(ax, model)
        if model.vehicle is not None and model.vehicle.position is not None:
            draw_vehicle(ax, model, model.vehicle.position)
    for tie in bars:
        ax.plot(*zip(tie.at_a, tie.at_b, strict=True), color=style.TENSION.colour, ls="-.", lw=1.4, marker="o", ms=3)
    if bars:
        handles.append(style.handle(style.Line(style.TENSION.colour, "-.", 1.4, "tie rod")))
    if _loads(ax, model, size):
        handles.append(style.handle(style.LOAD, "load"))
    count = f"{len(free)} bodies" + (f", {len(fixed)} fixed" if fixed else "")
    count += " repeated periodically" if model.periods is not None else ""
    count += f"; plane {model.plane}, element {model.element}"
    style.dress(ax, box, model.title or "model", count, units=model.report)
    style.legend(ax, handles, 6)
    return ax


def _neighbours(ax: Axes, model: Model, periods: Periods) -> None:
    """Draw the images of the bodies around a periodic cell in grey, and the cell that the two periods span."""
    p, corners = np.asarray(periods, dtype=float), np.vstack([b.outline for b in model.outlines])
    size = float(np.ptp(corners, axis=0).max())
    around = [image.body.rings for image in images(model.outlines, periods, 0.6 * size)]
    ax.add_collection(
        style.polygons_of(around, facecolors=style.NEIGHBOUR, edgecolors=style.GHOST, linewidths=0.5, zorder=0.7)
    )
    low, own = corners.min(0), model.outlines[0].outline.min(0)
    start = low if np.abs(own - low).max() <= 1e-6 * size else (low + corners.max(0) - p.sum(0)) / 2
    ring = start + np.array([[0, 0], p[0], p[0] + p[1], p[1], [0, 0]])
    ax.plot(*ring.T, color=style.CELL.colour, ls=style.CELL.dash, lw=style.CELL.width, zorder=3.5)


def _names(ax: Axes, model: Model, box: Array) -> None:
    points_per_metre = 72 * 9.0 / float((box[1] - box[0])[0])
    for body in model.outlines:
        span = np.ptp(body.outline, axis=0)
        upright = span[1] > 1.6 * span[0]
        room, width = (span[1], span[0]) if upright else (span[0], span[1])
        font = min(7.5, 0.85 * width * points_per_metre, 1.6 * room * points_per_metre / max(len(body.name), 1))
        if font >= 2.0:
            ax.annotate(
                body.name, _middle(body), ha="center", va="center", fontsize=font, color="#5A5348", zorder=4,
                rotation=90 if upright else 0,
                bbox={"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none"} if body.kind == "fixed" else None,
            )  # fmt: skip


def _middle(body: Body) -> tuple[float, float]:
    """Return where a body's name stands: at its centroid, or inside where that lies in a hole."""
    if not body.holes:
        return float(body.centroid[0]), float(body.centroid[1])
    import shapely

    inside = shapely.Polygon(body.outline, body.holes).point_on_surface()
    return float(inside.x), float(inside.y)


def _support(ax: Axes, model: Model, support: Any, size: float) -> None:
    body = model.body(support.body)
    ends = np.array(support.edge if support.edge is not None else [body.centroid, body.centroid], dtype=float)
    points = np.linspace(ends[0], ends[1], 3 if np.ptp(ends, axis=0).max() > 0.05 * size else 1)
    marker = {"xy": "^", "y": "o", "x": ">"}[support.directions if support.directions in ("x", "y") else "xy"]
    ax.plot(*points.T, marker=marker, ls="none", color=style.INK, ms=6, zorder=6)
    move = np.array(support.displacement)
    if move.any():
        x, y = points.mean(0)
        dx, dy = 0.08 * size * move / np.hypot(*move)
        ax.annotate(
            model.report.text("motion", float(np.hypot(*move))), (x + dx, y + dy), (x, y),
            arrowprops={"arrowstyle": "<-", "color": style.INK, "lw": 1.2}, fontsize=8, ha="center", zorder=6,
        )  # fmt: skip


def _loads(ax: Axes, model: Model, size: float) -> bool:
    """Draw edge and point loads as arrows; self-weight is reported in words. True where there was anything to draw."""
    drawn = False
    own = {part.group for part in (model.fill, model.vehicle) if part is not None}
    for load in model.loads:
        if load.group in own and load.kind == "point":  # drawn as fill and as axles on the road
            continue
        arrows = load_arrows(load, model.report)
        if arrows is None:
            continue
        tips, direction, word = arrows
        length = 0.05 * size
        tails = tips - length * direction
        ax.quiver(
            *tails.T, *(length * direction).T, color=style.LOAD.colour, angles="xy", scale_units="xy", scale=1,
            width=0.0022, headwidth=4, headlength=5, zorder=5, clip_on=False,
        )  # fmt: skip
        x, y = tails.mean(0) - 0.25 * length * direction.mean(0)
        ax.annotate(word, (x, y), ha="center", va="center", fontsize=8, color=style.LOAD.colour, annotation_clip=False)
        drawn = True
    return drawn


def load_arrows(load: Load, units: Units) -> tuple[Array, Array, str] | None:
    """Return the tips (n, 2) [m] of the arrows of a load, their unit directions (n, 2), and its size in words."""
    value = np.array(load.value, dtype=float)
    size = float(np.hypot(*value)) if len(value) > 1 else abs(float(value[0]))
    if not size > 0:
        return None
    if load.kind == "point" and load.at is not None:
        return np.array([load.at]), (value / size)[None, :], units.text("force", size)
    if load.kind in ("pressure", "traction") and load.edge is not None:
        a, b = np.array(load.edge, dtype=float)
        along = (b - a) / max(float(np.hypot(*(b - a))), 1e-300)
        if load.kind == "traction":
            direction = value / size
        else:
            inward = turned_right(along)
            direction = np.sign(value[0]) * (inward if inward[1] < 0 or (inward[1] == 0 and inward[0] < 0) else -inward)
        tips = np.linspace(a, b, 13)
        return tips, np.tile(direction, (13, 1)), units.text("stress", size)
    return None
