"""Figures of an assessment: the model as drawn for a report, a mechanism with its joints, capacity and demand.

Words come in from outside, so that one figure serves several languages.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from concio.analysis.seismic.layout import openings_of
from concio.contact.applied import applied_forces
from concio.display import number
from concio.plot import style
from concio.plot.assessment_in_space import mechanism_in_space, model_in_space
from concio.plot.diagram import diagram_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.seismic.assessment import Assessment, LocalMechanism

Array = np.ndarray
Words = Mapping[str, str]

ENLARGED = 0.10
"""Largest motion in the picture of a mechanism, over the size of the model."""
NAME_SIZES = (3.0, 6.5)
"""Sizes of letters of names of blocks, least and largest [pt]."""
LETTER, AXES_SHARE = 0.6, 0.85
"""Width of a letter over its size, and what of a figure is left to its axes."""
SMALL = (4.3, 3.2)
"""Width and height of a diagram of capacity or demand [in]."""
DEMAND = ("#0072B2", "#D55E00", "#009E73", "#CC79A7")
DASHES: tuple[Any, ...] = ("-", (0, (5, 2)))


def model_figure(found: Assessment, ax: Axes | None = None) -> Axes:
    """Draw the blocks, what is fixed, supports, ties and loads with their resultants."""
    model = found.model
    if model.dim == 3:
        return model_in_space(model, ax)
    points = np.vstack([b.outline for b in model.outlines if b.kind != "fixed"])
    low, high = points.min(0), points.max(0)
    size = float((high - low).max())
    ends = [np.array(p) for t in model.ties for p in (t.at_a, t.at_b)]
    box = style.box_of(np.vstack([points, *([np.array(ends)] if ends else [])]), margin=0.14)
    ax = _drawing(box, 0.7) if ax is None else ax
    for body in model.outlines:
        fixed = body.kind == "fixed"
        ax.fill(*body.outline.T, fc="#D9D9D9" if fixed else style.BLOCK, ec=style.EDGE, lw=0.5, hatch="////" * fixed)
    for tie in model.ties:
        ax.plot(*np.array([tie.at_a, tie.at_b]).T, color=style.TENSION.colour, lw=2.0, marker="s", ms=4)
        ax.annotate(tie.name, _xy((np.array(tie.at_a) + np.array(tie.at_b)) / 2), xytext=(0, 4),
                    textcoords="offset points", ha="center", fontsize=7.5, color=style.TENSION.colour)  # fmt: skip
    for support in model.supports:
        corners = np.array(support.edge) if support.edge is not None else model.body(support.body).vertices
        ax.plot(*corners.mean(0), marker="^", ms=9, mfc="none", mec=style.INK)
    numbers = [k for k, load in enumerate(model.loads) if load.kind != "weight"]
    forces = applied_forces(model, numbers)
    largest = max((float(np.hypot(*f.force)) for f in forces), default=1.0)
    for f in forces:
        arrow = f.force / largest * 0.12 * size
        _arrow(ax, f.point - arrow, f.point)
        if len(forces) <= 20:
            text = f"{number(float(np.hypot(*f.force)), 3)} kN"
            ax.annotate(text, _xy(f.point - arrow), fontsize=7.5, color=style.LOAD.colour, ha="center",
                        va="bottom" if arrow[1] < 0 else "center")  # fmt: skip
    _names(ax, model, box)
    _dimensions(ax, model, low, high, _scale(ax, box))
    style.dress(ax, box, "")
    return ax


def _names(ax: Axes, model: Any, box: Array) -> None:
    """Write the name of each block where letters that can be read on paper fit into it."""
    scale = _scale(ax, box)
    for block in model.free_bodies:
        wide, high = np.ptp(block.vertices, axis=0) * scale
        size = min(NAME_SIZES[1], wide / (LETTER * len(block.name)), high)
        if size >= NAME_SIZES[0]:
            ax.annotate(block.name, _xy(block.centroid), ha="center", va="center", fontsize=size, color="#555555")


def _scale(ax: Axes, box: Array) -> float:
    """Return how many points of a figure a metre has."""
    figure = ax.get_figure(root=True)
    assert figure is not None
    return float((72.0 * AXES_SHARE * np.asarray(figure.get_size_inches()) / (box[1] - box[0])).min())


def _dimensions(ax: Axes, model: Any, low: Array, high: Array, points_for_a_metre: float) -> None:
    """Draw the overall width and height of what is free, and those of the openings [m]."""
    gap = 0.05 * float((high - low).max())
    look = {"arrowstyle": "<->", "color": style.INK, "lw": 0.7, "shrinkA": 0, "shrinkB": 0}
    ends = (((low[0], low[1] - gap), (high[0], low[1] - gap)), ((high[0] + gap, low[1]), (high[0] + gap, high[1])))
    for k, (start, end) in enumerate(ends):
        ax.annotate("", end, start, arrowprops=look)
        at = (np.array(start) + np.array(end)) / 2
        ax.annotate(f"{number(float((high - low)[k]), 4)} m", _xy(at), ha="center", va="center", fontsize=7.5,
                    rotation=90 * k, bbox={"fc": "white", "ec": "none", "pad": 0.8})  # fmt: skip
    free = [b for b, body in enumerate(model.bodies) if body.kind != "fixed"]
    for hole in openings_of(model, free, np.array([1.0, 0.0])):
        width, height = hole.sides[1] - hole.sides[0], hole.heights[1] - hole.heights[0]
        text = f"{number(width, 3)} x {number(height, 3)} m"
        fits = width * points_for_a_metre / (LETTER * len(text))
        text, size = (text, min(7.0, fits)) if fits >= 5.5 else (text.replace(" x ", "\nx "), min(7.0, 1.8 * fits))
        ax.annotate(text, (sum(hole.sides) / 2, sum(hole.heights) / 2), ha="center", va="center", fontsize=size)


def mechanism_figure(mechanism: LocalMechanism, ax: Axes | None = None) -> Axes:
    """Draw a mechanism at its onset, enlarged, with its joints and its control point."""
    model, mechanics = mechanism.assembly.model, mechanism.mechanics
    if model.dim == 3:
        return mechanism_in_space(mechanism, ax)
    free = [b for b in model.outlines if b.kind != "fixed"]
    points = np.vstack([b.outline for b in free])
    size = float(np.ptp(points, axis=0).max())

    def moved(b: int, outline: Array, scale: float) -> Array:
        block = mechanics.of_body.get(b)
        return outline if block is None else outline + scale * mechanism.velocity_at(block, outline)

    fastest = max(float(np.linalg.norm(mechanism.velocity_at(g, model.outlines[b].outline), axis=1).max())
                  for b, g in mechanics.of_body.items())  # fmt: skip
    scale = ENLARGED * size / fastest
    shapes = {b: moved(b, body.outline, scale) for b, body in enumerate(model.outlines)}
    box = style.box_of(points, *(shapes[b] for b in mechanics.of_body), margin=0.06)
    ax = _drawing(box) if ax is None else ax
    for b, body in enumerate(model.outlines):
        fixed, moves = body.kind == "fixed", b in mechanics.of_body
        if moves:
            ax.fill(*body.outline.T, fc="none", ec=style.GHOST, lw=0.5, ls=":")
        face = "#D9D9D9" if fixed else style.BLOCK if moves else "#FFFFFF"
        ax.fill(*shapes[b].T, fc=face, ec=style.EDGE, lw=0.6, zorder=2)
    for tie in model.ties:
        ax.plot(*np.array([tie.at_a, tie.at_b]).T, color=style.TENSION.colour, lw=1.4, zorder=3)
    for joint in mechanics.joints:
        look = {"hinge": "o", "roller": "s", "bar": "D"}[joint.kind]
        place = joint.point
        if joint.a >= 0:
            place = place + scale * mechanism.velocity_at(joint.a, joint.point)
        ax.plot(*place, look, ms=5.5, mfc="#FFFFFF", mec=style.INK, mew=1.2, zorder=5)
    for participant in mechanism.chain.participants:
        way = participant.force / participant.size
        _arrow(ax, participant.point, participant.point + 0.09 * size * way)
    at = np.array(mechanism.control[1])
    block = mechanism.linkage.control[0]
    ax.plot(*(at + scale * mechanism.velocity_at(block, at)), "x", ms=8, mew=2, color=style.TENSION.colour, zorder=6)
    style.dress(ax, box, "")
    return ax


def _xy(point: Array) -> tuple[float, float]:
    return float(point[0]), float(point[1])


def _arrow(ax: Axes, start: Array, end: Array) -> None:
    look = {"arrowstyle": "-|>", "color": style.LOAD.colour, "lw": 1.3}
    ax.annotate("", _xy(end), _xy(start), arrowprops=look, zorder=6)


def curve_figure(mechanism: LocalMechanism, words: Words, ax: Axes | None = None) -> Axes:
    """Draw alpha against the displacement of the control point: followed, and as a straight line."""
    ax = diagram_axes(ax, SMALL)
    followed = mechanism.followed
    ax.plot(followed.displacement, followed.multiplier, color=style.COMPRESSION.colour, lw=1.8,
            label=words[f"legend_{followed.kind}"])  # fmt: skip
    if mechanism.straight is not None:
        line = mechanism.straight
        ax.plot(
            line.displacement, line.multiplier, color=style.INK, lw=1.0, ls=(0, (5, 2)), label=words["legend_straight"]
        )
    if mechanism.branch is not None:
        b, spectral = mechanism.branch, mechanism.chain.spectral
        ax.plot([0.0, b.d / spectral], [0.0, b.a / mechanism.factor], color=style.LOAD.colour, lw=1.8,
                label=words["legend_elastic"])  # fmt: skip
    for level, limit in mechanism.limits.items():
        ax.plot([limit.control], [limit.a / mechanism.factor], "o", ms=5, color=style.TENSION.colour)
        ax.annotate(f"d_{level}", (limit.control, limit.a / mechanism.factor), xytext=(5, 5),
                    textcoords="offset points", fontsize=8)  # fmt: skip
    return _finish(ax, words["axis_dC"], words["axis_alpha"])


def demand_figure(mechanism: LocalMechanism, words: Words, ax: Axes | None = None) -> Axes:
    """Draw the capacity curves and the demand of each limit state in acceleration-displacement form."""
    ax = diagram_axes(ax, SMALL)
    for curve, colour, dash, word in (
        (mechanism.followed, style.INK, "-", f"legend_{mechanism.followed.kind}"),
        (mechanism.straight, style.INK, (0, (5, 2)), "legend_straight"),
    ):
        if curve is not None:
            ax.plot(*mechanism.spectral_curve(curve), color=colour, lw=1.8 if dash == "-" else 1.0, ls=dash,
                    label=words[word])  # fmt: skip
    if mechanism.branch is not None:
        b = mechanism.branch
        ax.plot([0.0, b.d], [0.0, b.a], color=style.LOAD.colour, lw=1.8, label=words["legend_elastic"])
    site = mechanism.site
    _, a = mechanism.spectral_curve(mechanism.followed)
    d_most = 1.15 * float(mechanism.d0) if math.isfinite(mechanism.d0) else 0.5
    shown: list[tuple[str, str]] = []
    for check in mechanism.checks:
        if check.kind == "displacement" and (check.level, check.place) not in shown:
            shown.append((check.level, check.place))
    for k, (level, place) in enumerate(shown):
        hazard = mechanism.periods[level]
        spectrum: Any = site.spectrum(hazard)
        T = np.linspace(0.02, spectrum.T_E, 900)
        if place == "height":
            spectrum = site.at_height(spectrum, mechanism.level)
        limit = mechanism.limits[level]
        d, s = spectrum.displacement(T, limit.xi), spectrum.acceleration(T, limit.xi)
        word = words["legend_demand"].format(level=level, place=words[place])
        ax.plot(d, s, color=DEMAND[k % len(DEMAND)], lw=1.2, ls=DASHES[place == "height"], label=word)
        if place == "ground":
            ax.plot([limit.d], [limit.a], "o", ms=5, color=DEMAND[k % len(DEMAND)])
            slope = limit.a / limit.d if limit.d > 0 else 0.0
            ax.plot([0, d_most], [0, slope * d_most], color=DEMAND[k % len(DEMAND)], lw=0.6, ls=":")
            ax.annotate(f"d_{level}", (limit.d, limit.a), xytext=(5, 5), textcoords="offset points", fontsize=8)
    ax.set_xlim(0, d_most)
    ax.set_ylim(0, 2.2 * max(float(a.max(initial=0.0)), mechanism.onset))
    return _finish(ax, words["axis_d"], words["axis_a"])


def _drawing(box: Array, share: float = 1.0) -> Axes:
    """Return axes of a figure as large as a drawing is in print, or a share of it, so that letters keep their size."""
    width, height = np.maximum(box[1] - box[0], 1e-9)
    tall = float(np.clip(6.0 * height / width, 1.5, 4.2))
    wide = float(np.clip(tall * width / height, 1.6, 6.2))
    return diagram_axes(None, (share * (wide + 0.7), share * (tall + 0.6)))


def _finish(ax: Axes, x: str, y: str) -> Axes:
    ax.set_xlabel(x, fontsize=8.5)
    ax.set_ylabel(y, fontsize=8.5)
    ax.tick_params(labelsize=8)
    ax.set_xlim(left=0)
    ax.set_ylim(bottom=0)
    ax.grid(visible=True, lw=0.3, color="#DDDDDD")
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
    if len(ax.get_legend_handles_labels()[1]) > 3:  # inside it would cover the curves
        ax.legend(frameon=False, fontsize=7.5, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2)
    else:
        ax.legend(frameon=False, fontsize=7.5)
    return ax
