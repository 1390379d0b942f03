"""A tie at other heights: where it does the most, its least force is the smallest."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely

from concio.arguments import closest
from concio.errors import InputError
from concio.model.model import Model
from concio.model.polyhedron import Polyhedron

NEAR = 1e-6
"""Distance from a body, over the size of the model, at which an end of a tie is still on it."""


def tie_at_height(model: Model, name: str, height: float) -> Model:
    """Return a model in which a tie is moved up or down, its ends on the bodies that they meet there.

    Parameters
    ----------
    model : Model
    name : str
        Of the tie; both ends move by as much as its first end that is on a body.
    height : float
        Of that end [m].

    Raises
    ------
    InputError
        There is no such tie, or no body where an end comes to lie.
    """
    names = [t.name for t in model.ties]
    if name not in names:
        msg = f"there is no tie '{name}'"
        raise InputError(msg, hint=closest(name, names) if names else "the model has none")
    tie = model.ties[names.index(name)]
    first = tie.at_a if tie.body_a else tie.at_b
    up = np.zeros(model.dim)
    up[-1] = height - float(first[-1])
    ends, bodies = [np.array(p) + up for p in (tie.at_a, tie.at_b)], []
    for body, point in zip((tie.body_a, tie.body_b), ends, strict=True):
        bodies.append(_body_at(model, name, body, point) if body else "")
    moved = replace(tie, at_a=tuple(ends[0].tolist()), at_b=tuple(ends[1].tolist()), body_a=bodies[0], body_b=bodies[1])
    return replace(model, ties=tuple(moved if t.name == name else t for t in model.ties))


def _body_at(model: Model, tie: str, before: str, point: np.ndarray) -> str:
    """Return the name of the body that a point is on; of several the one that it was on, or the nearest by centroid."""
    slack = NEAR * model.size
    found = []
    for body in model.bodies if model.dim == 3 else model.outlines:
        if isinstance(body, Polyhedron):
            corners = np.asarray(body.vertices)
            on = bool((point >= corners.min(0) - slack).all() and (point <= corners.max(0) + slack).all())
        else:
            on = bool(shapely.Polygon(np.asarray(body.outline)).distance(shapely.Point(point)) <= slack)
        if on:
            away = 0.0 if body.name == before else 1.0 + float(np.linalg.norm(np.asarray(body.centroid) - point))
            found.append((away, body.name))
    if not found:
        place = ", ".join(f"{v:g}" for v in point)
        msg = f"tie '{tie}' at that height meets no body: its end is at ({place}) m"
        raise InputError(msg, hint="give heights at which it ends on a block")
    return min(found)[1]
