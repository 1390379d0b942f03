r"""Directions along which two convex pieces may be apart: normals of faces, and of one edge of each (separating axes).

Along a unit direction n from a to b the *separation* is

.. math:: s(n) = \min_{x \in b} n \cdot x - \max_{x \in a} n \cdot x .

Convex pieces are apart where it is positive for some n, and then for a normal of a face of either or, in space, for the
cross product of an edge of each. Where they overlap, minus the largest of these is the least distance by which one of
them must be moved to touch the other.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.contact.convex_bodies import ConvexBodies
from concio.kinematics.frames import cross, norm

Array = np.ndarray

PARALLEL = 1e-5
"""Edges turned against each other by less have no cross product worth the name [rad]; faces speak for them."""
APART = -np.inf


@dataclass(frozen=True, eq=False)
class Sides:
    """One piece of each of m pairs, rows padded by repeating their last entry.

    Parameters
    ----------
    corner, face, axis : (m, V), (m, F), (m, E) integer arrays
        Numbers of corners, faces, and edges of different directions.
    real : (m, V) boolean array
        Which corners are no repeats.
    points, normals, offsets, along : (m, V, d), (m, F, d), (m, F), (m, E, d) arrays
    """

    corner: Array
    face: Array
    axis: Array
    real: Array
    points: Array
    normals: Array
    offsets: Array
    along: Array

    @classmethod
    def of(cls, pieces: ConvexBodies, which: Array) -> Sides:
        """Return the pieces (m,) with these numbers."""
        corner, real = pieces.corners_of.padded(which)
        face, _ = pieces.faces_of.padded(which)
        axis = np.zeros((len(which), 0), dtype=int)
        if pieces.dim == 3:
            place, _ = pieces.axes.padded(which)
            axis = pieces.axes.values[place]
        return cls(
            corner, face, axis, real, pieces.points[corner], pieces.normals[face], pieces.offsets[face],
            pieces.along[axis],
        )  # fmt: skip

    def chosen(self, which: Array) -> Sides:
        """Return some of the rows."""
        return Sides(*(getattr(self, name)[which] for name in self.__dataclass_fields__))


def face_separations(a: Sides, b: Sides) -> Array:
    """Return the separations (m, F) along the outward normals of the faces of a [m]."""
    return np.asarray(np.matmul(b.points, a.normals.swapaxes(1, 2)).min(1) - a.offsets)


def edge_separations(a: Sides, b: Sides) -> tuple[Array, Array]:
    """Return the directions (m, K, d) from a to b square to an edge of each, and the separations (m, K) [m].

    The separation of two edges that are parallel is minus infinity.
    """
    m, d = len(a.points), a.points.shape[2]
    if d == 2:
        return np.zeros((m, 0, 2)), np.zeros((m, 0))
    across = cross(a.along[:, :, None], b.along[:, None]).reshape(m, -1, 3)
    length = norm(across)
    level = length <= PARALLEL
    across = across / np.where(level, 1.0, length)[:, :, None]
    on_a, on_b = (np.matmul(s.points, across.swapaxes(1, 2)) for s in (a, b))
    ahead = on_b.min(1) - on_a.max(1)
    behind = on_a.min(1) - on_b.max(1)
    back = behind > ahead
    separation = np.where(level, APART, np.where(back, behind, ahead))
    return np.where(back[:, :, None], -across, across), separation


def every_axis(a: Sides, b: Sides) -> tuple[Array, Array]:
    """Return all directions (m, K, d) from a to b, those of the faces of a first, and their separations (m, K) [m]."""
    direction, separation = edge_separations(a, b)
    return (
        np.concatenate([a.normals, -b.normals, direction], axis=1),
        np.concatenate([face_separations(a, b), face_separations(b, a), separation], axis=1),
    )
