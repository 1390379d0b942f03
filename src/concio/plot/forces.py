"""Figures of contact pressure, contact forces, force chains and thrust lines."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from concio.arguments import strict
from concio.errors import InputError
from concio.plot import style
from concio.post.force_lines import force_chains
from concio.post.joint_lines import joint_lines
from concio.post.outlines import outlines
from concio.post.pressure import pressure_diagrams
from concio.post.thrust_line import thrust_lines

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.result import Result

Array = np.ndarray


@strict
def plot_pressure(result: Result, ax: Axes | None = None, *, scale: float | None = None) -> Axes:
    """Draw contact pressure as a diagram standing on each joint.

    Parameters
    ----------
    result : Result
    ax : Axes, optional
        Where to draw; default a new figure.
    scale : float, optional
        Length that shows 1 kN/m2 [m].

    Returns
    -------
    Axes
    """
    from matplotlib.collections import PolyCollection

    pieces = joint_lines(result, outlines(result))
    contacts = result.contacts
    pressure = np.nan_to_num(contacts.pressure[pieces.pair])  # a corner has no area
    largest = float(pressure.max(initial=0.0))
    areas = [b.area for b in result.model.outlines if b.kind != "fixed" and b.role != "mortar"]
    typical = float(np.sqrt(np.median(areas or [1.0])))
    scale = (0.8 * typical / largest if largest > 0 else 1.0) if scale is None else scale
    diagrams = pressure_diagrams(result, pieces, scale)
    ax, _, box = style.draw_at_rest(result, ax, around=np.vstack([pieces.ends.reshape(-1, 2), *diagrams]))
    ax.add_collection(
        PolyCollection(diagrams, facecolors=style.COMPRESSION.colour, alpha=0.42, edgecolors="none", zorder=3)
    )
    ax.add_collection(
        PolyCollection(diagrams, facecolors="none", edgecolors=style.COMPRESSION.colour, linewidths=0.8, zorder=3.1)
    )
    opened = contacts.states.open[pieces.pair]
    style.draw_lines(ax, pieces.ends[opened], style.OPEN, zorder=4)
    units = result.model.report
    note = f"largest {units.text('stress', largest)}"
    style.dress(ax, box, "Contact pressure along the joints", note, units=units)
    if largest > 0:
        bar = style.round_value(0.16 * float((box[1] - box[0])[0]) / scale)
        style.scale_bar(ax, box, bar * scale, units.text("stress", bar, size=largest), style.COMPRESSION)
    handles = [style.patch("#94BFDC", "pressure", style.COMPRESSION.colour), style.handle(style.OPEN, "open joint")]
    style.legend(ax, handles)
    return ax


@strict
def plot_forces(result: Result, ax: Axes | None = None, *, chains: bool = True, reactions: bool = True) -> Axes:
    """Draw contact forces as lines along which they act, and as chains from joint to joint through the blocks.

    Parameters
    ----------
    result : Result
    ax : Axes, optional
        Where to draw; default a new figure.
    chains : bool
        True joins the resultants of the joints by struts (and the ties that bending asks for) which hold each block
        in balance, the thicker the larger the force; False draws the force of every contact pair in its own direction.
    reactions : bool
        Write the forces of fixed bodies and supports on the structure.

    Returns
    -------
    Axes
    """
    units = result.model.report
    ax, _, box = style.draw_at_rest(result, ax)
    handles: list[Any] = []
    if chains:
        found = force_chains(result)
        largest = float(np.abs(found.force).max(initial=0.0))
        pulls = found.force < 0
        _chain_lines(ax, found.lines[~pulls], found.force[~pulls], largest, style.COMPRESSION)
        _chain_lines(ax, found.lines[pulls], -found.force[pulls], largest, style.TENSION)
        title = "Force chains"
        note = f"line width in proportion to the force; largest {units.text('force', largest)}"
        handles.append(style.handle(style.Line(style.COMPRESSION.colour, "-", 5, ""), "compression"))
        if pulls.any():
            handles.append(style.handle(style.Line(style.TENSION.colour, "-", 3, ""), "tension: blocks that bend"))
    else:
        force = result.contacts.force_on_b
        keep = result.assembly.pairs.interface >= 0
        size = np.hypot(*force.T)
        largest = float(size[keep].max(initial=0.0))
        keep &= size > 1e-3 * largest
        typical = float(np.sqrt(np.median([b.area for b in result.model.outlines if b.kind != "fixed"])))
        scale = typical / (largest or 1.0)
        half = 0.5 * scale * force[keep]
        point = result.contacts.point[keep]
        lines = np.stack([point - half, point + half], axis=1)
        style.draw_lines(ax, lines, style.COMPRESSION, width=0.6 + 1.8 * size[keep] / (largest or 1.0), zorder=3)
        bar = style.round_value(0.16 * float((box[1] - box[0])[0]) / scale)
        style.scale_bar(ax, box, bar * scale, units.text("force", bar), style.COMPRESSION)
        title, note = "Contact forces", f"each contact pair; largest {units.text('force', largest)}"
        handles.append(style.handle(style.COMPRESSION, "contact force, along its line of action"))
    if reactions:
        _reactions(ax, result, box)
    style.dress(ax, box, title, note, units=units)
    style.legend(ax, handles)
    return ax


@strict
def plot_thrust(result: Result, ax: Axes | None = None) -> Axes:
    """Draw the line of thrust through the resultants of the joints, with hinges where it reaches an edge.

    Parameters
    ----------
    result : Result
    ax : Axes, optional
        Where to draw; default a new figure.

    Raises
    ------
    InputError
        The bodies do not stand in a row, so that there is no line of thrust.

    Returns
    -------
    Axes
    """
    lines = thrust_lines(result)
    if not lines:
        msg = "there is no line of thrust: no bodies stand in a row, each pressed by two others"
        raise InputError(msg, hint="draw result.plot.forces() instead")
    from matplotlib.lines import Line2D

    units = result.model.report
    ax, _, box = style.draw_at_rest(result, ax, around=np.vstack([line.points for line in lines]))
    hinges = 0
    for line in lines:
        ax.plot(*line.points.T, color=style.THRUST.colour, lw=style.THRUST.width, zorder=4)
        at_edge = line.points[line.ratio > 0.98]
        hinges += len(at_edge)
        ax.plot(*at_edge.T, "o", mfc="white", mec=style.OPEN.colour, mew=1.8, ms=7, zorder=5)
    largest = max(float(line.force.max()) for line in lines)
    nearest = max(float(line.ratio.max()) for line in lines)
    style.dress(
        ax, box, "Line of thrust",
        f"largest force {units.text('force', largest)}; it comes within {max(0.0, 50 * (1 - nearest)):.2g} % "
        "of a joint's length of its edge", units=units,
    )  # fmt: skip
    handles = [style.handle(style.THRUST)]
    if hinges:
        look: dict[str, Any] = {"marker": "o", "mfc": "white", "mec": style.OPEN.colour, "mew": 1.8, "ms": 7}
        handles.append(Line2D([], [], ls="none", label="hinge", **look))
    style.legend(ax, handles)
    return ax


def _chain_lines(ax: Axes, lines: Array, force: Array, largest: float, look: style.Line) -> None:
    if not force.size:
        return
    share = force / largest
    order = np.argsort(share)
    thin = 0.5 if len(force) > 4 * style.LARGE else 1.0
    style.draw_lines(
        ax, lines[order], look, width=thin * 7.0 * share[order], zorder=3, alpha=0.8, capstyle="round"
    )


def _reactions(ax: Axes, result: Result, box: Array) -> None:
    body_of = {b.name: b for b in result.model.outlines}
    units = result.model.report
    largest = max((float(np.linalg.norm(f)) for f in result.reactions.values()), default=0.0)
    for name, (fx, fy) in result.reactions.items():
        body = body_of.get(name)
        if body is None:
            support = next(s for s in result.model.supports if s.name == name)
            body = body_of[support.body]
        if not np.hypot(fx, fy) > 0 or len(result.reactions) > 12:
            continue
        x, y = (units.text("force", v, size=largest) for v in (fx, fy))
        text = f"{name}\n{x}, {y}"
        ax.annotate(
            text, tuple(body.centroid), ha="center", va="center", fontsize=7.5,
            color=style.LOAD.colour, zorder=6, rotation=90 if _upright(body.outline) else 0,
            bbox={"boxstyle": "round,pad=0.25", "fc": "white", "ec": style.LOAD.colour, "lw": 0.8},
            annotation_clip=False,
        )  # fmt: skip


def _upright(outline: Array) -> bool:
    span = np.ptp(outline, axis=0)
    return bool(span[1] > 1.6 * span[0])
