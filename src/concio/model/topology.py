"""How the faces of polyhedra are connected, without coordinates: computed once for all blocks of one sort."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
import shapely

from concio.kinematics.frames import cross, tangents
from concio.model.linked import nearest
from concio.representation import short_repr

Array = np.ndarray
Loop = tuple[int, ...]
"""Vertices of a face, or of a hole in one, in order."""


@short_repr
@dataclass(frozen=True, eq=False)
class Topology:
    """Faces without coordinates, s sides in all.

    Parameters
    ----------
    start, end : (s,) integer arrays
        Vertices of each side, loop by loop, first those of the faces, then those of the holes.
    loop, face : (s,) integer arrays
        Loop and face of each side.
    first : (l,) integer array
        First side of each loop.
    edges : (e, 2) integer array
        Edges, lower vertex first.
    edge_faces : (e, 2) integer array
        Faces on its two sides: the one along which it runs from the lower to the higher vertex first.
    fault : tuple or None
        What keeps the faces from being a closed surface: ("open" | "turned" | "shared", first vertex, second vertex,
        number of such edges).
    """

    start: Array
    end: Array
    loop: Array
    face: Array
    first: Array
    edges: Array
    edge_faces: Array
    fault: tuple[str, int, int, int] | None

    @property
    def closed_loops(self) -> Array:
        """Vertices of all loops, each repeating its first at its end."""
        ends = np.append(self.first[1:], len(self.start))
        return np.insert(self.start, ends, self.start[self.first])

    @cached_property
    def corners(self) -> Array:
        """First vertex of the loop of each side (s,), start and end: what spans a triangle with the side, (3, s)."""
        return np.stack([self.start[self.first][self.loop], self.start, self.end])

    def spanned(self, points: Array) -> Array:
        """Return twice the area vectors (s, 3) of the triangles that sides span with the first vertex of their loop."""
        near, p, q = points[self.corners]
        return cross(p - near, q - near)

    def by_face(self, values: Array) -> Array:
        """Return the sums (f, ...) over the sides of each face of values (s, ...) of the sides."""
        sums: Array = np.add.reduceat(values, self.first, axis=0)
        owner = self.face[self.first]
        count = int(owner.max()) + 1
        if len(owner) == count:
            return sums
        total = sums[:count].copy()
        np.add.at(total, owner[count:], sums[count:])
        return total

    @cached_property
    def following(self) -> Array:
        """Side after each in its loop (s,)."""
        number = np.arange(len(self.start)) + 1
        number[np.append(self.first[1:], len(self.start)) - 1] = self.first
        return number

    @cached_property
    def sides_of_face(self) -> Array:
        """Number of sides of each face (f,)."""
        return np.bincount(self.face)

    def area_vectors(self, points: Array) -> Array:
        """Return the areas of the faces times their normals (f, 3) [m2]."""
        return 0.5 * self.by_face(self.spanned(points))


@lru_cache(maxsize=4096)
def topology(faces: tuple[Loop, ...], holes: tuple[tuple[int, Loop], ...] = ()) -> Topology:
    """Return how faces are connected."""
    loops = [*faces, *(loop for _, loop in holes)]
    count = np.array([len(loop) for loop in loops])
    first = np.concatenate([[0], np.cumsum(count)[:-1]])
    start = np.array([v for loop in loops for v in loop])
    end = np.roll(start, -1)
    end[first + count - 1] = start[first]
    loop = np.repeat(np.arange(len(loops)), count)
    face = np.array([*range(len(faces)), *(number for number, _ in holes)])[loop]
    low, high = np.minimum(start, end), np.maximum(start, end)
    edges, edge, number = np.unique(np.column_stack([low, high]), axis=0, return_inverse=True, return_counts=True)
    edge = edge.ravel()
    upward = np.bincount(edge, start < end, len(edges))
    kinds = {"open": number == 1, "shared": number > 2, "turned": (number == 2) & (upward != 1)}
    fault = None
    for kind, bad in kinds.items():
        if bad.any() and fault is None:
            k = int(np.argmax(bad))
            fault = (kind, int(edges[k, 0]), int(edges[k, 1]), int(bad.sum()))
    sides = np.zeros_like(edges)
    sides[edge[start < end], 0] = face[start < end]
    sides[edge[start > end], 1] = face[start > end]
    return Topology(start, end, loop, face, first, edges, sides, fault)


def face_triangles(points: Array, loops: Sequence[Loop], normal: Array) -> Array:
    """Return triangles (k, 3) of vertex numbers that fill a planar face, counter-clockwise about its normal."""
    outer = np.array(loops[0])
    frame = tangents(normal)
    flat = points[outer] @ frame.T
    if len(loops) == 1:
        before, after = flat - np.roll(flat, 1, axis=0), np.roll(flat, -1, axis=0) - flat
        turn = cross(before, after)
        if len(outer) <= 4 and (turn > 0).all():
            return np.column_stack([np.full(len(outer) - 2, outer[0]), outer[1:-1], outer[2:]])
    every = np.concatenate([np.array(loop) for loop in loops])
    rings = [points[list(loop)] @ frame.T for loop in loops]
    parts = shapely.get_parts(shapely.constrained_delaunay_triangles(shapely.Polygon(rings[0], rings[1:])))
    corners = shapely.get_coordinates(parts).reshape(-1, 4, 2)[:, :3]
    cells: Array = every[nearest(points[every] @ frame.T, corners.reshape(-1, 2))].reshape(-1, 3)
    p, q, r = (np.moveaxis(corners, 1, 0)[k] for k in range(3))
    left = (q[:, 0] - p[:, 0]) * (r[:, 1] - p[:, 1]) - (q[:, 1] - p[:, 1]) * (r[:, 0] - p[:, 0]) > 0
    cells[~left] = cells[~left][:, ::-1]
    return cells
