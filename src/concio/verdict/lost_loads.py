"""Loads of which a part, or all, acts nowhere."""

from __future__ import annotations

import numpy as np
import shapely

from concio.contact.edge_loads import covered, line_tolerance, loaded_faces
from concio.contact.face_loads import loaded_parts, plane_of
from concio.errors import InputError
from concio.model.model import Load, Model

LOST = 0.005
"""Share of a load's length or area that may lie off the blocks before it is reported."""


def lost_loads(model: Model) -> tuple[str, ...]:
    """Return a sentence for each load along a line or over a polygon that does not lie on blocks all along.

    Parameters
    ----------
    model : Model
    """
    found = []
    for load in model.loads:
        if load.kind not in ("pressure", "traction"):
            continue
        try:
            part = _on_line(model, load) if model.dim == 2 else _on_faces(model, load)
        except InputError:  # told by the assembly, which refuses it
            continue
        if part:
            found.append(part)
    return tuple(found)


def load_words(load: Load) -> str:
    """Return a load along a line in words, without what happens to it."""
    assert load.edge is not None
    (x0, y0), (x1, y1) = load.edge
    value = ", ".join(f"{v:g}" for v in load.value)
    return f"{load.kind} ({value}) kN/m2 in group '{load.group}' from ({x0:.4g}, {y0:.4g}) to ({x1:.4g}, {y1:.4g}) m"


def _on_line(model: Model, load: Load) -> str:
    if load.edge is None:
        return ""
    ends = np.array(load.edge, dtype=float)
    length, loaded = float(np.hypot(*(ends[1] - ends[0]))), covered(loaded_faces(model, load))
    if length - loaded <= max(2 * line_tolerance(model, load), LOST * length):
        return ""
    return (
        f"{load_words(load)}: only {loaded:.4g} m of its {length:.4g} m lie on edges of its blocks, and only these are "
        "loaded"
    )


def _on_faces(model: Model, load: Load) -> str:
    if load.polygon is None:
        return ""
    corners = np.array(load.polygon, dtype=float)
    middle, _, axes = plane_of(corners)
    area = float(shapely.Polygon((corners - middle) @ axes.T).area)
    loaded = float(shapely.union_all([p.part for p in loaded_parts(model, load)]).area)
    if area - loaded <= LOST * area:
        return ""
    at = ", ".join(f"{v:.4g}" for v in middle)
    return (
        f"{load.kind} load of group '{load.group}' round ({at}) m: only {loaded:.4g} m2 of its {area:.4g} m2 lie on "
        "faces of its blocks, and only these are loaded"
    )
