"""Meshes of bodies: structured where a body is a rectangle or a quadrilateral, triangles elsewhere.

A structured mesh honours break points: where an interface begins or ends on an edge, a mesh line starts, so that
contact never begins inside an element edge. Between break points a span ``L`` gets ``ceil(L / size)`` elements.
"""

from __future__ import annotations

import numpy as np

from concio.model.generate.spacing import subdivided
from concio.model.model import Body

Array = np.ndarray


def is_rectangle(outline: Array) -> bool:
    """Return whether an outline has four vertices and sides along x and y."""
    if len(outline) != 4:
        return False
    sides = np.roll(outline, -1, axis=0) - outline
    size = np.abs(sides).max()
    return bool((np.abs(sides).min(axis=1) <= 1e-9 * size).all())


def merged(values: Array, tolerance: float) -> Array:
    """Return sorted values without those closer than ``tolerance`` to the one before; the first and last stay."""
    values = np.sort(np.asarray(values, dtype=float))
    keep = [values[0]]
    for v in values[1:]:
        if v - keep[-1] > tolerance:
            keep.append(v)
    keep[-1] = values[-1]
    return np.array(keep)


def tensor(xs: Array, ys: Array) -> tuple[Array, Array]:
    """Return points (n, 2) and quadrilaterals (e, 4) of a grid with lines ``xs`` and ``ys``."""
    nx, ny = len(xs), len(ys)
    x, y = np.meshgrid(xs, ys)
    i, j = np.meshgrid(np.arange(nx - 1), np.arange(ny - 1))
    first = (j * nx + i).ravel()
    cells = np.column_stack([first, first + 1, first + nx + 1, first + nx])
    return np.column_stack([x.ravel(), y.ravel()]), cells


def mesh_body(body: Body, size: float, refinement: int, breaks: list[Array]) -> tuple[Array, Array]:
    """Return points (n, 2) and cells (e, 3 or 4) of one body.

    Parameters
    ----------
    body : Body
    size : float
        Target element size [m].
    refinement : int
        Each element is split this many times more in each direction.
    breaks : list of (k,) arrays
        For each edge of the outline, then of the holes, distances from its first vertex at which an interface begins
        or ends [m].
    """
    outline = body.outline
    if body.grid is not None:
        xs, ys = (np.asarray(g, dtype=float) for g in body.grid)
        return tensor(subdivided(xs, np.inf, refinement), subdivided(ys, np.inf, refinement))
    if is_rectangle(outline) and not body.holes:
        lower, upper = outline.min(0), outline.max(0)
        marks: list[list[float]] = [[lower[0], upper[0]], [lower[1], upper[1]]]
        for e, at in enumerate(breaks):
            if len(at):
                a, b = outline[e], outline[(e + 1) % 4]
                points = a + np.outer(at, (b - a) / np.linalg.norm(b - a))
                axis = int(np.argmax(np.abs(b - a)))
                marks[axis].extend(points[:, axis])
        tolerance = 1e-6 * float((upper - lower).max())
        xs, ys = (subdivided(merged(np.array(v), tolerance), size, refinement) for v in marks)
        return tensor(xs, ys)
    from concio.fem.polygon_mesh import mesh_polygon

    return mesh_polygon(outline, size / refinement, breaks=breaks, holes=body.holes)
