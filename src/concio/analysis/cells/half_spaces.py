r"""Convex polyhedra of macroscopic stresses, as half-spaces :math:`n_i \cdot \Sigma \le h_i`.

Redundant half-spaces are found by duality: with a point p inside, the half-spaces that matter are the vertices of the
convex hull of the points n_i / (h_i - n_i . p), and its facets are the vertices of the polyhedron. What is unbounded is
closed by a distant box, whose faces are distinguished from those of the polyhedron.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import linprog
from scipy.spatial import ConvexHull

from concio.read_only import read_only
from concio.representation import short_repr

Array = np.ndarray

FAR = 1e3
"""Distance of the box that closes what is unbounded, in sizes of the polyhedron."""

SAME = 1e-9
"""Half-spaces whose normals and relative distances differ by less are one; an interior smaller than this is none."""


@short_repr
@dataclass(frozen=True, eq=False)
@read_only
class HalfSpaces:
    """An intersection of half-spaces of components xx, yy, xy.

    Parameters
    ----------
    normals : (k, 3) array
        Of length one.
    offsets : (k,) array
        [kN/m2].
    """

    normals: Array
    offsets: Array

    @classmethod
    def of(cls, normals: Array, offsets: Array) -> HalfSpaces:
        """Return half-spaces with normals of length one, each once; those without a normal are left out."""
        length = np.linalg.norm(normals, axis=1)
        some = length > SAME * float(length.max(initial=0.0))
        normals, offsets = normals[some] / length[some, None], np.asarray(offsets)[some] / length[some]
        size = float(np.abs(offsets).max(initial=0.0)) or 1.0
        keys = np.round(np.column_stack([normals, offsets / size]) / SAME) + 0.0
        _, first = np.unique(keys, axis=0, return_index=True)
        first = np.sort(first)
        return cls(normals[first], offsets[first])

    def __len__(self) -> int:
        return len(self.offsets)

    @cached_property
    def size(self) -> float:
        """Largest distance of a face from the origin, or 1 where all go through it [kN/m2]."""
        return float(np.abs(self.offsets).max(initial=0.0)) or 1.0

    @cached_property
    def interior(self) -> Array | None:
        """A point (3,) that is far from all faces; None where there is none [kN/m2]."""
        count = len(self)
        if not count:
            return np.zeros(3)
        matrix = np.hstack([self.normals, np.ones((count, 1))])
        bounds = [(-10.0, 10.0)] * 3 + [(0.0, 1.0)]
        found = linprog([0, 0, 0, -1], A_ub=matrix, b_ub=self.offsets / self.size, bounds=bounds, method="highs")
        x: Array | None = found.x
        if x is None or x[3] <= SAME:
            return None
        return np.asarray(x[:3]) * self.size

    def distance(self, direction: Sequence[float] | Array, base: Sequence[float] | Array = (0, 0, 0)) -> float:
        """Return the largest multiplier of ``direction`` that, added to ``base``, stays inside; ``inf`` if any does."""
        rate = self.normals @ np.asarray(direction, dtype=float)
        room = self.offsets - self.normals @ np.asarray(base, dtype=float)
        moving = rate > SAME * float(np.abs(rate).max(initial=0.0))
        return float((room[moving] / rate[moving]).min()) if moving.any() else np.inf

    def margin(self, stress: Sequence[float] | Array) -> float:
        """Return how far a stress is inside all half-spaces (negative: outside) [kN/m2]."""
        room = self.offsets - self.normals @ np.asarray(stress, dtype=float)
        return float(room.min()) if len(self) else np.inf

    def kept(self) -> Array:
        """Return the numbers of the half-spaces that are not redundant; of all where they have no interior."""
        if self.interior is None or not len(self):
            return np.arange(len(self))
        hull, count = self._polar
        return np.sort(hull.vertices[hull.vertices < count])

    def reduced(self) -> HalfSpaces:
        """Return the half-spaces without the redundant ones; as they are where they have no interior."""
        kept = self.kept()
        return HalfSpaces(self.normals[kept], self.offsets[kept])

    @cached_property
    def _polar(self) -> tuple[ConvexHull, int]:
        """Convex hull of the polar points about the interior, in units of the size; the last six are of the box."""
        assert self.interior is not None
        p = self.interior / self.size
        box = np.vstack([np.eye(3), -np.eye(3)])
        normals = np.vstack([self.normals, box])
        room = np.concatenate([self.offsets / self.size, np.full(6, FAR)]) - normals @ p
        return ConvexHull(normals / room[:, None]), len(self)

    @cached_property
    def vertices(self) -> tuple[Array, Array]:
        """Vertices (v, 3) [kN/m2], and whether each is one of the polyhedron (v,) and not of the distant box."""
        assert self.interior is not None
        hull, count = self._polar
        points = self.interior / self.size - hull.equations[:, :3] / hull.equations[:, 3:]
        own: Array = np.asarray(hull.simplices).max(axis=1) < count
        plane = np.column_stack([hull.equations[:, :3], np.log(-hull.equations[:, 3])])  # one for each vertex
        _, first = np.unique(np.round(plane / SAME), axis=0, return_index=True)
        return points[first] * self.size, own[first]

    def section(
        self, along: Sequence[float] | Array, up: Sequence[float] | Array, at: Sequence[float] | Array, reach: float
    ) -> Array:
        """Return the polygon (v, 2) that a plane cuts out, in coordinates of ``along`` and ``up`` from ``at``.

        Parameters
        ----------
        along, up : (3,)
            Two directions of stress that span the plane.
        at : (3,)
            Its origin [kN/m2].
        reach : float
            What is unbounded is cut at this distance.
        """
        polygon = reach * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
        a, b, o = (np.asarray(v, dtype=float) for v in (along, up, at))
        for normal, offset in zip(self.normals, self.offsets, strict=True):
            g = np.array([normal @ a, normal @ b])
            room = offset - normal @ o - polygon @ g
            inside = room >= -1e-12 * reach
            points: list[Array] = []
            for k in range(len(polygon)):
                if inside[k - 1] != inside[k]:
                    share = room[k - 1] / (room[k - 1] - room[k])
                    points.append(polygon[k - 1] + share * (polygon[k] - polygon[k - 1]))
                if inside[k]:
                    points.append(polygon[k])
            if len(points) < 3:
                return np.zeros((0, 2))
            polygon = np.array(points)
        return polygon
