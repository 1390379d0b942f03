"""Weights of the corner nodes of a mesh for a point inside it: the shape functions of linear elements.

Those of a quadrilateral or a hexahedron depend neither on the corner with which its numbering begins nor on its sense:
the mirror image of a mesh has the same weights. A split into simplices would not.
"""

from __future__ import annotations

import numpy as np

from concio.fem.elements import TETRAHEDRA

Array = np.ndarray

SIMPLICES: dict[tuple[int, int], tuple[tuple[int, ...], ...]] = {
    (2, 3): ((0, 1, 2),),
    (2, 4): ((0, 1, 2), (0, 2, 3)),
    (3, 4): ((0, 1, 2, 3),),
    (3, 8): TETRAHEDRA,
}
"""Corners of the simplices that fill an element, by dimension and number of its corners."""

CUBE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], dtype=float)
"""Corners of a hexahedron in local coordinates; the first four are those of a quadrilateral."""

OUTSIDE = 1e-6
"""How far below zero the weight of a node may be of a point that still counts as inside."""

ROUNDING = 1e-13
"""Weights below this are zero, and an iteration whose step is smaller has ended."""


def interpolated(nodes: Array, cells: Array, point: Array) -> tuple[Array, Array]:
    """Return corner nodes (k,) and their weights (k,) at a point of a mesh; none where it is outside.

    Parameters
    ----------
    nodes : (n, d) array
        [m].
    cells : (e, c) integer array
        Corners of each element: 3 or 4 in the plane, 4 or 8 in space.
    point : (d,) array
        [m].
    """
    parts = SIMPLICES[nodes.shape[1], cells.shape[1]]
    simplices = np.vstack([cells[:, list(corners)] for corners in parts])
    weights = _in_simplices(nodes[simplices], point)
    best = int(np.argmax(weights.min(axis=1)))
    if weights[best].min() < -OUTSIDE:
        return np.zeros(0, dtype=int), np.zeros(0)
    cell = cells[best % len(cells)]
    found = None if len(parts) == 1 else _in_element(nodes[cell], point)
    if found is None:
        return simplices[best], weights[best]
    some = np.abs(found) > ROUNDING
    return cell[some], found[some]


def _in_simplices(corners: Array, point: Array) -> Array:
    """Return the barycentric coordinates (s, d+1) of a point in simplices (s, d+1, d)."""
    first = corners[:, 0]
    edges = np.moveaxis(corners[:, 1:] - first[:, None], 1, 2)
    inner = np.linalg.solve(edges, (point - first)[..., None])[..., 0]
    return np.column_stack([1 - inner.sum(1), inner])


def _in_element(corners: Array, point: Array) -> Array | None:
    """Return the shape functions (c,) of a quadrilateral or hexahedron at a point; None where Newton's method fails."""
    d = corners.shape[1]
    ends, corners = CUBE[: len(corners), :d], corners - point  # digits are lost far from the origin
    local = np.full(d, 0.5)
    for _ in range(50):
        factors = np.where(ends > 0, local, 1 - local)  # (c, d)
        values = factors.prod(axis=1)
        others = np.stack([np.delete(factors, k, axis=1).prod(axis=1) for k in range(d)], axis=1)
        slope = corners.T @ np.where(ends > 0, others, -others)
        if abs(np.linalg.det(slope)) < np.finfo(float).tiny:
            return None
        step = np.linalg.solve(slope, values @ corners)
        local = local - step
        if np.abs(step).max() < ROUNDING:
            return values if values.min() > -OUTSIDE else None
    return None
