"""Facets: the sides of elements that lie on the surface of a body, with their interpolation in the plane of a face.

A facet has 3 or 4 straight sides and order 1 or 2. Its nodes are numbered corners first, counter-clockwise seen from
outside, then the middles of its sides in the same order, then its centre. The geometry is that of its corners.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Array = np.ndarray

_QUAD = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
_QUAD_9 = np.vstack([_QUAD, [[0.5, 0.0], [1.0, 0.5], [0.5, 1.0], [0.0, 0.5], [0.5, 0.5]]])
PARTS: dict[int, tuple[tuple[int, ...], ...]] = {
    3: ((0, 1, 2),),
    6: ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
    4: ((0, 1, 2, 3),),
    9: ((0, 4, 8, 7), (4, 1, 5, 8), (8, 5, 2, 6), (7, 8, 6, 3)),
}
"""Linear pieces of a facet by the number of its nodes."""


@dataclass(frozen=True, eq=False)
class FacetMesh:
    """Facets on one face of a body, f in all, of one sort.

    Parameters
    ----------
    nodes : (f, k) integer array
        Nodes of the body; k = 3, 6 (triangles), 4, 9 (quadrilaterals).
    """

    nodes: Array

    @property
    def corners(self) -> int:
        """Number of corners of a facet, 3 or 4."""
        return 3 if self.nodes.shape[1] in (3, 6) else 4

    @property
    def order(self) -> int:
        """Order of the interpolation, 1 or 2."""
        return 1 if self.nodes.shape[1] in (3, 4) else 2

    @property
    def parts(self) -> Array:
        """Linear pieces of all facets (p, corners): node numbers; piece p belongs to facet ``p // pieces of each``."""
        cells = np.array(PARTS[self.nodes.shape[1]])
        return self.nodes[:, cells].reshape(-1, self.corners)


def local_coordinates(corners: Array, points: Array) -> Array:
    """Return the local coordinates (n, 2) of points (n, 2) in facets with corners (n, 3 or 4, 2).

    A triangle is x = x0 + r (x1 - x0) + s (x2 - x0); a quadrilateral is bilinear on the unit square (Newton's method,
    one step where it is a parallelogram).
    """
    first = corners[:, 0]
    if corners.shape[1] == 3:
        edges = np.stack([corners[:, 1] - first, corners[:, 2] - first], axis=2)
        return np.asarray(np.linalg.solve(edges, (points - first)[..., None])[..., 0])
    a, b = corners[:, 1] - first, corners[:, 3] - first
    twist = corners[:, 2] - first - a - b
    local = np.full(points.shape, 0.5)
    for _ in range(50):
        r, s = local[:, :1], local[:, 1:]
        error = first + r * a + s * b + r * s * twist - points
        slope = np.stack([a + s * twist, b + r * twist], axis=2)
        step = np.linalg.solve(slope, error[..., None])[..., 0]
        local = local - step
        if np.abs(step).max(initial=0.0) < 1e-14:
            break
    return local


def functions(nodes: int, local: Array) -> Array:
    """Return the shape functions (n, k) of a facet with k nodes at local coordinates (n, 2)."""
    r, s = local[:, 0], local[:, 1]
    if nodes in (3, 6):
        corner = np.column_stack([1 - r - s, r, s])
        if nodes == 3:
            return corner
        a, b, c = corner.T
        return np.column_stack([a * (2 * a - 1), b * (2 * b - 1), c * (2 * c - 1), 4 * a * b, 4 * b * c, 4 * c * a])
    if nodes == 4:
        return np.column_stack([(1 - r) * (1 - s), r * (1 - s), r * s, (1 - r) * s])
    along = [_quadratic(r), _quadratic(s)]
    at = np.round(2 * _QUAD_9).astype(int)  # 0, 1, 2: first, middle, last
    return np.column_stack([along[0][:, i] * along[1][:, j] for i, j in at])


def _quadratic(t: Array) -> Array:
    return np.column_stack([(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)])


TRIANGLE_POINTS = np.array(
    [
        [0.445948490915965, 0.445948490915965], [0.108103018168070, 0.445948490915965],
        [0.445948490915965, 0.108103018168070], [0.091576213509771, 0.091576213509771],
        [0.816847572980459, 0.091576213509771], [0.091576213509771, 0.816847572980459],
    ]
)  # fmt: skip
TRIANGLE_WEIGHTS = np.array([0.223381589678011] * 3 + [0.109951743655322] * 3)
"""Six points in a triangle, exact to degree four (Dunavant, Int. J. Numer. Methods Engrg. 21, 1985); sum one."""


def quadrature(triangles: Array) -> tuple[Array, Array]:
    """Return points (t, 6, 2) and weights (t, 6) in triangles (t, 3, 2) of the plane, any way round."""
    a, b, c = (triangles[:, k] for k in range(3))
    area = 0.5 * np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    r, s = TRIANGLE_POINTS.T
    points = a[:, None] + r[:, None] * (b - a)[:, None] + s[:, None] * (c - a)[:, None]
    return points, area[:, None] * TRIANGLE_WEIGHTS / TRIANGLE_WEIGHTS.sum()
