"""Figures of the deformed shape with joint states, of slip and opening, and of mechanisms."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from concio.arguments import strict
from concio.errors import InputError
from concio.plot import style
from concio.post.body_motion import body_motions
from concio.post.joint_lines import JointLines, joint_lines
from concio.post.mechanism_states import mechanism_states
from concio.post.outlines import NO_MOTION, STILL, anything_moves, display_scale, outlines
from concio.problem.pair_state import PairState
from concio.problem.solution import Status

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.result import Result

Array = np.ndarray


@strict
def plot_deformed(result: Result, ax: Axes | None = None, *, scale: float | None = None) -> Axes:
    """Draw the deformed shape; joints are distinguished as open, sticking, slipping.

    Parameters
    ----------
    result : Result
    ax : Axes, optional
        Where to draw; default a new figure.
    scale : float, optional
        Factor of the displacements; default a round one that shows the largest as a twentieth of the model.

    Returns
    -------
    Axes
    """
    units = result.model.report
    shown = outlines(result)
    largest = float(np.hypot(*shown.displacement.T).max())
    scale = display_scale(largest, shown.size) if scale is None else scale
    box = style.box_of(shown.points, shown.points + scale * shown.displacement)
    ax = style.axes_for(box, ax)
    style.ghost(ax, shown)
    style.draw_bodies(ax, result.model, shown, scale)
    state = result.contacts.state
    pieces = joint_lines(result, shown)
    _draw_states(ax, pieces, state, scale)
    note = f"displacements x {scale:g}; largest {units.text('motion', largest)}"
    note = note if anything_moves(largest, shown.size) else STILL
    style.dress(ax, box, "Deformed shape and state of the joints", note, units=units)
    handles: list[Any] = [style.handle(style.STICK), style.handle(style.SLIP)]
    if (state == PairState.CRUSHED).any():
        handles.append(style.handle(style.CRUSHED))
    handles.append(style.patch(style.FILL_OPEN, "open", style.OPEN.colour))
    style.legend(ax, handles)
    return ax


@strict
def plot_slip(result: Result, ax: Axes | None = None) -> Axes:
    """Draw how far joints have opened (orange) and slipped (purple): the thicker, the further.

    Parameters
    ----------
    result : Result
    ax : Axes, optional
        Where to draw; default a new figure.

    Returns
    -------
    Axes
    """
    ax, shown, box = style.draw_at_rest(result, ax)
    pieces = joint_lines(result, shown)
    contacts = result.contacts
    gap, slip = contacts.gap[pieces.pair], np.linalg.norm(contacts.slip[pieces.pair], axis=1)
    gap, slip = (np.where(v > NO_MOTION * shown.size, v, 0.0) for v in (gap, slip))
    opened = contacts.states.open[pieces.pair]
    widest = max(float(gap[opened].max(initial=0.0)), float(slip[~opened].max(initial=0.0)))
    lines = pieces.ends
    for look, keep, value in ((style.OPEN, opened & (gap > 0), gap), (style.SLIP, ~opened & (slip > 0), slip)):
        width = 0.4 + 7.0 * value[keep] / (widest or 1.0)
        style.draw_lines(ax, lines[keep], style.Line(look.colour, "-", 1, look.word), width=width, zorder=3, alpha=0.95)
    units = result.model.report
    largest_gap = units.text("motion", float(gap[opened].max(initial=0.0)), size=widest)
    largest_slip = units.text("motion", float(slip[~opened].max(initial=0.0)), size=widest)
    style.dress(
        ax, box, "Opening and slip of the joints",
        f"largest opening {largest_gap}, largest slip {largest_slip}; widest line {units.text('motion', widest)}",
        units=units,
    )  # fmt: skip
    style.legend(
        ax,
        [
            style.handle(style.Line(style.OPEN.colour, "-", 4, ""), "opening"),
            style.handle(style.Line(style.SLIP.colour, "-", 4, ""), "slip of a closed joint"),
        ],
    )
    return ax


@strict
def plot_mechanism(
    result: Result,
    ax: Axes | None = None,
    *,
    share: float = 0.08,
    title: str | None = None,
    note: str | None = None,
) -> Axes:
    """Draw the motion that proves that there is no equilibrium, or one in which a structure begins to move.

    Parameters
    ----------
    result : Result
        With status NO_EQUILIBRIUM or COLLAPSES.
    ax : Axes, optional
        Where to draw; default a new figure.
    share : float
        Size of the largest motion as a share of the model.
    title, note : str, optional
        Title, and what the line under it says besides how many bodies move; default what the motion proves.

    Raises
    ------
    InputError
        The result has no mechanism.

    Returns
    -------
    Axes
    """
    from matplotlib.collections import PolyCollection

    velocity = result.mechanism_velocity
    if velocity is None or result.mechanism is None:
        msg = f"there is no mechanism to draw: the outcome is '{result.status.name.lower()}'"
        raise InputError(msg, hint="draw result.plot.deformed() instead")
    shown = outlines(result, velocity)
    speed = np.hypot(*shown.displacement.T)
    scale = share * shown.size / float(speed.max())
    box = style.box_of(shown.points, shown.points + scale * shown.displacement)
    ax = style.axes_for(box, ax)
    style.ghost(ax, shown)
    fastest = np.array([speed[a:b].max() for a, b in zip(shown.starts[:-1], shown.starts[1:], strict=True)])
    moving = fastest > 1e-6 * fastest.max()
    face = [style.body_colour(b) if m else "#FFFFFF" for b, m in zip(result.model.bodies, moving, strict=True)]
    pieces = joint_lines(result, shown)
    largest = float(speed.max())
    state = mechanism_states(result, pieces)
    style.draw_bodies(ax, result.model, shown, scale, face=face)
    opened = list(pieces.openings(scale)[state == PairState.OPEN])
    ax.add_collection(PolyCollection(opened, facecolors=style.FILL_OPEN, edgecolors="none", zorder=2))
    style.draw_lines(ax, pieces.side("middle", scale)[state == PairState.SLIP], style.SLIP, zorder=3)
    centre = result.assembly.disc.centroids
    motion = body_motions(result, velocity)[:, :2]
    arrows = moving & (np.hypot(*motion.T) > 0.02 * largest) if moving.sum() <= 400 else np.zeros(len(moving), bool)
    ax.quiver(
        *(centre + scale * motion)[arrows].T, *(scale * motion)[arrows].T, color=style.INK, angles="xy",
        scale_units="xy", scale=1.0, width=0.0022, headwidth=4, headlength=5, zorder=5, clip_on=False,
    )  # fmt: skip
    units = result.model.report
    power = units.text("force", result.mechanism.power)
    if title is None:
        departs = result.status is Status.COLLAPSES
        title = "How the structure moves away" if departs else "Collapse mechanism: no equilibrium is possible"
    if note is None:
        less = "" if result.status is Status.COLLAPSES else " less what the joints absorb"
        note = f"work of the loads{less}: {power} for each unit of the largest motion"
    count = f"{int(moving.sum())} of {len(result.model.free_bodies)} bodies move (bodies at rest are white)"
    style.dress(ax, box, title, f"{count}; {note}", units=units)
    handles = [style.patch(style.FILL_OPEN, "opens"), style.handle(style.SLIP, "slides")]
    style.legend(ax, [*handles, style.patch("#FFFFFF", "at rest")])
    return ax


def _draw_states(ax: Axes, pieces: JointLines, state: Array, scale: float) -> None:
    from matplotlib.collections import PolyCollection

    code = state[pieces.pair]
    opened = code == PairState.OPEN
    many = len(code) > 4 * style.LARGE
    ax.add_collection(
        PolyCollection(list(pieces.openings(scale)[opened]), facecolors=style.FILL_OPEN, edgecolors="none", zorder=2,
                       rasterized=many)
    )  # fmt: skip
    thin = 0.35 if many else 1.0
    for side in ("a", "b"):
        line = style.Line(style.OPEN.colour, style.OPEN.dash, 1.2, "")
        style.draw_lines(ax, pieces.side(side, scale)[opened], line, width=1.2 * thin, zorder=2.5)
    middle = pieces.side("middle", scale)
    looks = {PairState.STICK: style.STICK, PairState.SLIP: style.SLIP, PairState.CRUSHED: style.CRUSHED}
    for value, look in looks.items():
        style.draw_lines(ax, middle[code == value], look, width=look.width * thin, zorder=3 + 0.1 * (value - 1))
