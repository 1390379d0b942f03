r"""Exact areas, volumes, centroids and second moments of polygons (with holes) and polyhedra.

A polygon is the signed sum of the triangles that its sides span with any one point, a polyhedron that of the tetrahedra
that the triangles of its faces span; of a simplex with one corner at the origin and the others at :math:`v_1 \dots v_d`

.. math:: \int dV = \frac{D}{d!}, \qquad \int x\,dV = \frac{D}{(d+1)!}\, s, \qquad
          \int x x^T dV = \frac{D}{(d+2)!} \Bigl( s s^T + \sum_i v_i v_i^T \Bigr), \qquad s = \sum_i v_i,

with D the determinant of the corners. Second moments are taken about the centroid found first, so that nothing cancels
for a small body far from the origin.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import factorial

import numpy as np

from concio.kinematics.frames import cross
from concio.representation import short_repr

Array = np.ndarray


@short_repr
@dataclass(frozen=True, eq=False)
class Moments:
    """Moments of a polygon or a polyhedron of density one.

    Parameters
    ----------
    measure : float
        Area [m2] or volume [m3].
    centroid : (d,) array
        [m].
    second : (d, d) array
        Integral of (x - c)(x - c)' about the centroid c [m4 or m5].
    """

    measure: float
    centroid: Array
    second: Array

    @property
    def inertia(self) -> Array:
        """Moment of inertia about the centroid of density one: (1, 1) in the plane, (3, 3) in space [m4 or m5]."""
        trace = float(np.trace(self.second))
        return np.array([[trace]]) if len(self.centroid) == 2 else trace * np.eye(3) - self.second

    @property
    def radius_of_gyration(self) -> float:
        """Root of the mean principal moment of inertia over the measure [m]; in the plane the polar one."""
        inertia = self.inertia
        return float(np.sqrt(np.trace(inertia) / len(inertia) / self.measure))


def signed_area(ring: Array) -> float:
    """Return the area of a polygon (n, 2), positive when counter-clockwise [m2]."""
    p = np.asarray(ring, dtype=float) - ring[0]
    return float(0.5 * cross(p, np.roll(p, -1, axis=0)).sum())


def polygon_moments(outline: Array, holes: Sequence[Array] = ()) -> Moments:
    """Return the moments of a polygon.

    Parameters
    ----------
    outline : (n, 2) array
        Vertices in order, either way round, without the closing repetition [m].
    holes : sequence of (k, 2) arrays
        Interior rings, either way round.
    """
    corners = []
    for ring, sign in ((outline, 1.0), *((hole, -1.0) for hole in holes)):
        ring = np.asarray(ring, dtype=float)
        ring = ring if sign * signed_area(ring) > 0 else ring[::-1]
        corners.append(np.stack([ring, np.roll(ring, -1, axis=0)], axis=1))
    return _moments(np.concatenate(corners))


def polyhedron_moments(vertices: Array, faces: Sequence[Sequence[int] | Array]) -> Moments:
    """Return the moments of a closed polyhedron.

    Parameters
    ----------
    vertices : (n, 3) array
        [m].
    faces : sequence of integer sequences
        Vertices of each planar face, counter-clockwise seen from outside; a face need not be convex.
    """
    points = np.asarray(vertices, dtype=float)
    corners = [points[[face[0], face[k], face[k + 1]]] for face in faces for k in range(1, len(face) - 1)]
    return _moments(np.array(corners))


def _moments(corners: Array) -> Moments:
    """Return the moments of the sum of the simplices of corners (k, d, d) with a point among them."""
    d = corners.shape[-1]
    near = corners.reshape(-1, d).mean(0)
    v = corners - near
    size = cross(v[:, 0], v[:, 1]) if d == 2 else (cross(v[:, 0], v[:, 1]) * v[:, 2]).sum(-1)
    measure = float(size.sum()) / factorial(d)
    centroid = near + size @ v.sum(1) / factorial(d + 1) / measure
    v = corners - centroid
    size = cross(v[:, 0], v[:, 1]) if d == 2 else (cross(v[:, 0], v[:, 1]) * v[:, 2]).sum(-1)
    s = v.sum(1)
    second = np.einsum("k,ki,kj->ij", size, s, s) + np.einsum("k,kci,kcj->ij", size, v, v)
    return Moments(measure, centroid, second / factorial(d + 2))
