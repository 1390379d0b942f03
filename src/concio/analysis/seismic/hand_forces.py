"""Weights and loads of a model integrated once more, with formulas of their own: for the check of alpha_0 by hand.

Nothing here is shared with :mod:`concio.contact.applied`, from which the limit programme and the chain take their
forces: areas are sums of triangles, volumes of tetrahedra, the length on which a line load acts is cut out of the sides
of the blocks. Only loads on polygons in space are taken from the program, and marked as such.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from itertools import pairwise
from typing import Any

import numpy as np

from concio.contact.applied import applied_forces
from concio.contact.separate import surroundings
from concio.model.model import Load, Model

Array = np.ndarray

ON_LINE = 1e-6
"""Sides of blocks nearer than this to the line of a load, over the size of the structure, lie on it; so do those nearer
than twice the gap tolerance of the model."""

FACING = {"lower": (-1, 1.0), "upper": (-1, -1.0), "left": (0, 1.0), "right": (0, -1.0)}
"""Of two faces that meet under a line load: component and sign of the outward normal of the one that is loaded."""


@dataclass(frozen=True, eq=False)
class HandForce:
    """A force on a body.

    Parameters
    ----------
    load : int
        Number of the load in the model.
    body : int
    force, point : (d,) arrays
        [kN], [m].
    own : bool
        Whether it was integrated here; False where it was taken from the program.
    """

    load: int
    body: int
    force: Array
    point: Array
    own: bool = True


def measured(body: Any) -> tuple[float, Array]:
    """Return the volume [m3] and the centroid (d,) [m] of a body, as a sum of triangles or tetrahedra from a corner."""
    points = np.asarray(body.vertices, dtype=float)
    origin = points[0]
    total, first = 0.0, np.zeros(points.shape[1])
    if points.shape[1] == 2:
        for ring in body.rings:
            for p, q in zip(ring, np.roll(ring, -1, axis=0), strict=True):
                part = ((p[0] - origin[0]) * (q[1] - origin[1]) - (q[0] - origin[0]) * (p[1] - origin[1])) / 2.0
                total, first = total + part, first + part * (p + q - 2 * origin) / 3.0
        return total * body.thickness, origin + first / total
    for loop in (*body.faces, *(loop for _, loop in body.holes)):
        a = points[loop[0]]
        for i, j in pairwise(loop[1:]):
            part = float(np.linalg.det(np.array([a, points[i], points[j]]) - origin)) / 6.0
            total, first = total + part, first + part * (a + points[i] + points[j] - 3 * origin) / 4.0
    return total, origin + first / total


def hand_forces(model: Model) -> list[HandForce]:
    """Return the forces of all loads of a model on its free bodies.

    Parameters
    ----------
    model : Model
    """
    sizes = {b: measured(body) for b, body in enumerate(model.bodies) if body.kind != "fixed"}
    found: list[HandForce] = []
    for k, load in enumerate(model.loads):
        value = np.array(load.value, dtype=float)
        chosen = [b for b in sizes if not load.bodies or any(_called(word, model.bodies[b]) for word in load.bodies)]
        if load.kind in ("weight", "body"):
            for b in chosen:
                density = model.materials[model.bodies[b].material].unit_weight if load.kind == "weight" else 1.0
                found.append(HandForce(k, b, density * sizes[b][0] * value, sizes[b][1]))
        elif load.kind == "point":
            found += [HandForce(k, b, value, np.array(load.at, dtype=float)) for b in chosen]
        elif model.dim == 2:
            found += _on_sides(model, k, load, chosen)
        elif load.edge is not None:
            p, q = np.array(load.edge, dtype=float)
            found += [HandForce(k, b, value * float(np.sqrt(((q - p) ** 2).sum())), (p + q) / 2) for b in chosen]
        else:
            found += [HandForce(k, f.body, f.force, f.point, own=False) for f in applied_forces(model, [k])]
    return [f for f in found if f.force.any()]


def _called(word: str, body: Any) -> bool:
    return fnmatchcase(body.name, word) or word in (body.role, body.layer)


def _on_sides(model: Model, k: int, load: Load, chosen: Sequence[int]) -> list[HandForce]:
    """Return the forces of a load along a line: on every side of a body that lies on it, as far as it does."""
    assert load.edge is not None
    p, q = np.array(load.edge, dtype=float)
    length = float(np.hypot(*(q - p)))
    along = (q - p) / length
    normal = np.array([-along[1], along[0]])
    around = surroundings(model)
    sides: list[tuple[int, float, float, Array]] = []
    runs: list[tuple[float, Array, Array]] = []  # where a side begins on the line and as it is drawn, and its slope
    for b in chosen:
        ring, near = model.outlines[b].outline, max(ON_LINE * float(around.size[b]), 2 * (model.gap_tolerance or 0.0))
        for a, c in zip(ring, np.roll(ring, -1, axis=0), strict=True):
            s, t = float((a - p) @ along), float((c - p) @ along)
            low, high = max(min(s, t), 0.0), min(max(s, t), length)
            off = max(abs(float((a - p) @ normal)), abs(float((c - p) @ normal)))
            if off <= near and high - low > near:
                sides.append((b, low, high, normal if s > t else -normal))
                runs.append((s, a, (c - a) / (t - s)))
    axis, sign = FACING[load.face if load.face in FACING else "lower"]
    found = []
    for (b, low, high, outward), (first, corner, slope) in zip(sides, runs, strict=True):
        pieces = [(low, high)]
        if load.face != "both" and sign * outward[axis] < 0:
            for _, x, y, other in sides:
                if float(other @ outward) < 0:
                    pieces = [piece for u, v in pieces for piece in ((u, min(v, x)), (max(u, y), v))
                              if piece[1] - piece[0] > near]  # fmt: skip
        vector = -load.value[0] * outward if load.kind == "pressure" else np.array(load.value, dtype=float)
        deep = model.outlines[b].thickness
        found += [HandForce(k, b, vector * deep * (v - u), corner + slope * ((u + v) / 2 - first)) for u, v in pieces]
    return found
