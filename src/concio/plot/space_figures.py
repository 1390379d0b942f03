"""Figures of structures in space, in fixed views for print: front, side, plan and axonometry.

What is nearer hides what is farther, point by point (:mod:`concio.plot.picture`), so that blocks of any shape, moved
as far as one likes, are drawn as they are seen.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np

from concio.arguments import strict
from concio.display import number
from concio.errors import InputError
from concio.kinematics.frames import cross
from concio.plot import style
from concio.plot.picture import Picture
from concio.plot.space_loads import draw_loads
from concio.post.joint_faces import joint_faces
from concio.post.mechanism_states import mechanism_states
from concio.post.outlines import display_scale
from concio.post.solids import Solids, model_solids, moved_ties, solids

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.result import Result
    from concio.model.model import Model

Array = np.ndarray
View = Literal["front", "side", "plan", "axonometry"]
WORDS = {0: "open", 2: "slips", 3: "crushed"}
WORDS_OF_MECHANISMS = {0: "opens", 2: "slides", 3: "crushes"}
SEEN = 50
"""A colour on fewer points of a picture is not explained: nobody finds it."""
NAMED = 60
"""Up to this many bodies get their names written."""
NAME_SIZE = 5.5
"""Size of a name of a block [pt]."""

VIEWS: dict[str, tuple[float, float]] = {
    "front": (0.0, 0.0),
    "side": (np.pi / 2, 0.0),
    "plan": (0.0, np.pi / 2),
    "axonometry": (-0.7, 0.5),
}
"""Turn about the vertical and height of the eye, of each view [rad]."""


def directions(view: View | tuple[float, float]) -> tuple[Array, Array, Array]:
    """Return (right, up, towards the eye) of a view or of its angles, unit vectors (3,)."""
    if isinstance(view, tuple):
        turn, lift = view
    elif view in VIEWS:
        turn, lift = VIEWS[view]
    else:
        msg = f"there is no view '{view}'"
        raise InputError(msg, hint="one of " + ", ".join(VIEWS))
    c, s, cl, sl = np.cos(turn), np.sin(turn), np.cos(lift), np.sin(lift)
    return np.array([c, s, 0.0]), np.array([-s * sl, c * sl, cl]), np.array([s * cl, -c * cl, sl])


@strict
def plot_space_model(
    model: Model, ax: Axes | None = None, *, view: View = "axonometry", names: bool | None = None
) -> Axes:
    """Draw the blocks, ties and loads of a model in space, as it is described; self-weight is not drawn.

    Parameters
    ----------
    model : Model
    ax : Axes, optional
    view : {"front", "side", "plan", "axonometry"}
    names : bool, optional
        Write the names of the blocks that are seen; default for up to 60 bodies.
    """
    shown = model_solids(model)
    ax, picture = draw_solids(shown, block_colours(model), view, ax, 0.0, model.title or "Model")
    if len(model.bodies) <= NAMED if names is None else names:
        _names(ax, model, picture)
    draw_loads(ax, model, picture.axes)
    for tie in model.ties:
        ends = np.array([tie.at_a, tie.at_b]) @ picture.axes[:2].T
        ax.plot(ends[:, 0], ends[:, 1], color=style.TENSION.colour, lw=1.6, zorder=5)
    return ax


def _names(ax: Axes, model: Model, picture: Picture) -> None:
    """Write the name of each block on the nearest of its faces whose middle is seen."""
    for body in model.polyhedra:
        if body.kind == "fixed":
            continue
        middles = np.array([body.vertices[list(face)].mean(0) for face in body.faces])
        x, y, depth = picture.placed(middles).T
        height, width = picture.depth.shape
        column, row = np.clip(x.astype(int), 0, width - 1), np.clip(y.astype(int), 0, height - 1)
        seen = np.flatnonzero(
            (body.normals @ picture.axes[2] > 0.2) & (depth >= picture.depth[row, column] - 1e-3 * body.size)
        )
        if len(seen):
            at = picture.axes[:2] @ middles[seen[np.argmax(body.normals[seen] @ picture.axes[2])]]
            ax.text(at[0], at[1], body.name, fontsize=NAME_SIZE, ha="center", va="center", color=style.INK, zorder=6)


@strict
def plot_space(
    result: Result, ax: Axes | None = None, *, view: View = "axonometry", scale: float | None = None
) -> Axes:
    """Draw the deformed shape or the mechanism of a structure in space; joint faces that open or slip are coloured.

    Parameters
    ----------
    result : Result
    ax : Axes, optional
    view : {"front", "side", "plan", "axonometry"}
    scale : float, optional
        By which displacements are multiplied; by default so that they can be seen.
    """
    mechanism = not result.solved and result.mechanism is not None
    u = result.mechanism_velocity if mechanism else None
    if u is None and not result.solved:
        return plot_space_model(result.model, ax, view=view)
    shown = solids(result, u)
    largest = float(np.linalg.norm(shown.displacement, axis=1).max(initial=0.0))
    chosen = (2.0 if mechanism else 1.0) * display_scale(largest, shown.size) if scale is None else scale
    faces = joint_faces(result, u)
    state = mechanism_states(result, faces) if mechanism else result.contacts.state[faces.pair]
    looks = {0: style.OPEN.colour, 2: style.SLIP.colour, 3: style.CRUSHED.colour}
    pointed = result.assembly.pairs.interface[faces.pair] >= len(result.assembly.detection.patches)
    extra = []
    for moved in (faces.moved_a, faces.moved_b):
        corners = faces.corners + chosen * moved
        extra += [(corners[k], looks[int(state[k])]) for k in np.flatnonzero(np.isin(state, tuple(looks)))]
        extra += [(corners[k], style.STICK.colour) for k in np.flatnonzero(pointed & (state == 1))]
    title = "Collapse mechanism" if mechanism else f"Displaced shape, {number(chosen)} times"
    factors = ", ".join(f"{group} = {number(factor)}" for group, factor in result.factors.items())
    note = f"loads {factors}" if factors else ""
    bars = moved_ties(result, u, chosen)
    ax, picture = draw_solids(shown, block_colours(result.model), view, ax, chosen, title, extra, note, bars)
    words = WORDS_OF_MECHANISMS if mechanism else WORDS
    told = {looks[k]: words[k] for k in looks} | ({style.TENSION.colour: "tie"} if len(bars) else {})
    style.legend(ax, [style.patch(look, word) for look, word in told.items() if picture.points_of(look) >= SEEN])
    return ax


def block_colours(model: Model) -> list[str]:
    """Return the colour of each body."""
    looks = {"rigid": style.RIGID, "fixed": "#CFCBC2"}
    return [looks.get(b.kind, style.FILM if b.role == "mortar" else style.BLOCK) for b in model.bodies]


def draw_solids(
    shown: Solids,
    colours: Sequence[str],
    view: View | tuple[float, float],
    ax: Axes | None,
    scale: float,
    title: str,
    extra: Sequence[tuple[Array, str]] = (),
    note: str = "",
    bars: Array | None = None,
    box: Array | None = None,
    longer: int | None = None,
) -> tuple[Axes, Picture]:
    """Draw bodies, each in its colour, coloured areas (n, 3) upon them and ties (t, 2, 3); return axes and picture.

    A ``box`` (2, 2) of the view shows what lies within it, otherwise everything is shown; ``longer`` is the number of
    points along the longer side of the picture.
    """
    from matplotlib.colors import to_rgb

    right, up, eye = directions(view)
    points = shown.moved(scale)
    box = style.box_of(points @ np.column_stack([right, up])) if box is None else box
    ax = style.axes_for(box, ax)
    corners = points[shown.triangles]
    normal = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1)
    facing = normal @ eye > 1e-9 * length
    light = 0.7 * eye + 0.5 * up + 0.2 * right
    shade = 0.72 + 0.28 * np.clip(normal[facing] @ light / (length[facing] * np.linalg.norm(light)), 0.0, 1.0)
    fills = np.array([to_rgb(c) for c in colours])[shown.body[facing]] * shade[:, None]
    areas = corners[facing]
    if extra:
        lifted = np.array([c for c, _ in extra]) + 1e-4 * shown.size * eye  # a colour lies on the face that carries it
        areas, fills = np.concatenate([areas, lifted]), np.vstack([fills, [to_rgb(tone) for _, tone in extra]])
    picture = Picture.of(box, np.array([right, up, eye]), longer)
    picture.fill(areas, fills)
    wide = 1 if len(colours) > style.LARGE else 2
    picture.stroke(points[shown.edges], to_rgb(style.EDGE), wide, 1.5e-3 * shown.size)
    if bars is not None and len(bars):
        picture.stroke(bars, to_rgb(style.TENSION.colour), 2 * wide + 1, 1.5e-3 * shown.size)
    extent = (box[0, 0], box[1, 0], box[0, 1], box[1, 1])
    ax.imshow(picture.image(), extent=extent, interpolation="antialiased", zorder=1)
    style.dress(ax, box, title, note)
    names = {"front": ("x", "z"), "side": ("y", "z"), "plan": ("x", "y")}
    if isinstance(view, str) and view in names:
        ax.set_xlabel(f"{names[view][0]} [m]", fontsize=8)
        ax.set_ylabel(f"{names[view][1]} [m]", fontsize=8)
    else:
        ax.set_axis_off()
        _triad(ax, box, right, up)
    return ax, picture


def _triad(ax: Axes, box: Array, right: Array, up: Array) -> None:
    """Draw the directions x, y, z in the lower left corner."""
    length = 0.06 * float((box[1] - box[0]).max())
    at = box[0] + 1.4 * length
    for k, name in enumerate("xyz"):
        along = np.array([right[k], up[k]])
        ax.annotate(
            "", at + length * along, at, zorder=5,
            arrowprops={"arrowstyle": "-|>", "lw": 0.9, "color": style.INK, "shrinkA": 0, "shrinkB": 0},
        )  # fmt: skip
        x, y = (at + 1.35 * length * along).tolist()
        ax.text(x, y, name, fontsize=7.5, color=style.INK, ha="center", va="center", zorder=5)
