"""Figure of a model in space, seen from the front, the side, above or askew (axonometry), shaded by faces.

Only what no joint covers is drawn, from the farthest to the nearest; the fixed bodies below come first.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from concio.arguments import closest, strict
from concio.contact.assembly import detect
from concio.errors import InputError
from concio.plot import style
from concio.post.free_surface import free_surface

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.model.interfaces.detect import Detection
    from concio.model.model import Model

Array = np.ndarray
View = Literal["front", "side", "plan", "axonometry"]
SUN = np.array([0.36, -0.48, 0.8])
"""Where light comes from."""
SOLID, FIXED = np.array([0.93, 0.88, 0.79]), np.array([0.80, 0.80, 0.80])
NAMED = 60
"""Up to this many bodies get their names written."""


def projected(points: Array, view: View) -> tuple[Array, Array]:
    """Return points (n, 3) in the plane of a view (n, 2) and how near they are to the eye (n,) [m].

    Raises
    ------
    InputError
        There is no such view.
    """
    a, b = np.deg2rad(-55.0), np.deg2rad(24.0)
    eye = {
        "front": ((1, 0, 0), (0, 0, 1)),
        "side": ((0, 1, 0), (0, 0, 1)),
        "plan": ((1, 0, 0), (0, 1, 0)),
        "axonometry": ((-np.sin(a), np.cos(a), 0), (-np.sin(b) * np.cos(a), -np.sin(b) * np.sin(a), np.cos(b))),
    }
    if view not in eye:
        msg = f"there is no view '{view}'"
        raise InputError(msg, hint=closest(view, eye))
    right, up = (np.array(v, dtype=float) for v in eye[view])
    return points @ np.stack([right, up], 1), points @ np.cross(right, up)


@strict
def plot_solid_model(
    model: Model,
    ax: Axes | None = None,
    *,
    view: View = "axonometry",
    names: bool | None = None,
    detection: Detection | None = None,
) -> Axes:
    """Draw a model in space as it is described, before meshing.

    Parameters
    ----------
    model : Model
    ax : Axes, optional
        Where to draw; default a new figure.
    view : {"axonometry", "front", "side", "plan"}
        From where it is seen; front looks along y, side along -x.
    names : bool, optional
        Write the names of the blocks that are seen; default for up to 60 bodies.
    detection : Detection, optional
        The joints, where they are known already.

    Returns
    -------
    Axes
    """
    from matplotlib.collections import PolyCollection

    bodies = model.polyhedra
    flat, _ = projected(np.concatenate([b.vertices for b in bodies]), view)
    box = np.array([flat.min(0), flat.max(0)])
    ax = style.axes_for(box, ax)
    shapes: list[tuple[float, float, Array, Array]] = []
    seen: dict[str, tuple[float, Array]] = {}
    patches = (detect(model) if detection is None else detection).patches
    towards = [projected(b.normals, view)[1] for b in bodies]
    for b, face, pieces in free_surface(model, patches):
        body = bodies[b]
        if towards[b][face] <= 1e-9:
            continue
        fixed = body.kind == "fixed"
        light = 0.72 + 0.28 * float(body.normals[face] @ SUN)
        colour = np.clip((FIXED if fixed else SOLID) * light, 0, 1)
        for piece in pieces:
            at, depth = projected(piece, view)
            near = float(depth.mean())
            shapes.append((0.0 if fixed else 1.0, near, at, colour))
            if not fixed and near > seen.get(body.name, (-np.inf,))[0]:
                seen[body.name] = (near, at.mean(0))
    shapes.sort(key=lambda s: (s[0], s[1]))
    many = len(bodies) > style.LARGE
    ax.add_collection(
        PolyCollection([s[2] for s in shapes], facecolors=[s[3] for s in shapes], edgecolors=style.EDGE,
                       linewidths=0.15 if many else 0.5, rasterized=many, zorder=1)
    )  # fmt: skip
    if names if names is not None else len(bodies) <= NAMED:
        for name, (_, place) in seen.items():
            x, y = place.tolist()
            ax.text(x, y, name, fontsize=5.5, ha="center", va="center", color=style.INK, zorder=4)
    for load in model.loads:
        if load.at is not None:
            x, y = projected(np.array([load.at]), view)[0][0]
            ax.plot(x, y, "v", color=style.LOAD.colour, ms=7, zorder=5)
    for tie in model.ties:
        ends = projected(np.array([tie.at_a, tie.at_b]), view)[0]
        ax.plot(*ends.T, color=style.TENSION.colour, lw=1.6, zorder=5)
    _finish(ax, box, model.title or "model without a title")
    return ax


def _finish(ax: Any, box: Array, title: str) -> None:
    size = float((box[1] - box[0]).max())
    margin = 0.04 * size
    ax.set_xlim(box[0, 0] - margin, box[1, 0] + margin)
    ax.set_ylim(box[0, 1] - margin, box[1, 1] + margin)
    ax.set_aspect("equal")
    ax.set_axis_off()
    ax.set_title(title, fontsize=10)
