"""A polyhedron as convex pieces, for questions that are easy to answer of convex bodies only.

A block whose grid is known is its hexahedra. Any other is cut by the plane of a face out of which it stands, and what
is left on either side again, until every piece is convex. A piece is described by its corners and its planes; corners
in which only planes of cutting meet, inside the block, are left out, so that a piece may come out slightly too small.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import shapely

from concio.kinematics.frames import cross, tangents, turned_left
from concio.representation import short_repr

if TYPE_CHECKING:
    from concio.model.polyhedron import Polyhedron

Array = np.ndarray

MOST_PIECES = 200
"""A block that falls into more pieces is left whole."""
FLAT = 1e-6
"""Share of a block's size by which a corner may stand out of a plane of a convex piece."""
_SIDES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (3, 7, 6, 2), (0, 4, 7, 3), (1, 2, 6, 5))
_CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))


@short_repr
@dataclass(frozen=True, eq=False)
class ConvexPiece:
    """A convex piece: corners (n, 3) and planes with outward normals (f, 3) and offsets (f,) [m]."""

    vertices: Array
    normals: Array
    offsets: Array

    @cached_property
    def directions(self) -> Array:
        """Directions of its edges (e, 3): those of two planes that are not one and meet in two corners or more."""
        size = float(np.ptp(self.vertices, axis=0).max())
        on = (np.abs(self.vertices @ self.normals.T - self.offsets) <= FLAT * size).astype(float)
        p, q = np.nonzero(np.triu(on.T @ on >= 2, 1))
        along = cross(self.normals[p], self.normals[q])
        steep = np.linalg.norm(along, axis=1)
        along = along[steep > FLAT] / steep[steep > FLAT, None]
        along *= np.where(along @ np.array([1.0, 1e-3, 1e-6]) < 0, -1.0, 1.0)[:, None]
        return np.unique(np.round(along, 9), axis=0)


def convex_pieces(body: Polyhedron) -> tuple[ConvexPiece, ...] | None:
    """Return the convex pieces of a block, None where it falls into too many."""
    if body.convex:
        return (ConvexPiece(body.vertices, body.normals, body.offsets),)
    if body.grid is not None:
        cells = _cells(body.grid)
        if cells is not None:
            return cells
    return _cut_up(body)


def _cells(grid: Array) -> tuple[ConvexPiece, ...] | None:
    """Return the hexahedra of a grid, None where one is not convex."""
    n = np.array(grid.shape[:3]) - 1
    size = float(np.ptp(grid.reshape(-1, 3), axis=0).max())
    found = []
    for first in np.ndindex(*n):
        points = np.array([grid[tuple(np.add(first, c))] for c in _CORNERS])
        sides = points[np.array(_SIDES)]
        normals = cross(sides[:, 2] - sides[:, 0], sides[:, 3] - sides[:, 1])
        length = np.linalg.norm(normals, axis=1)
        some = length > 1e-12 * size * size
        normals = normals[some] / length[some, None]
        offsets = (sides.mean(1)[some] * normals).sum(1)
        if (points @ normals.T - offsets).max() > FLAT * size:
            return None
        found.append(ConvexPiece(points, normals, offsets))
    return tuple(found)


@dataclass(frozen=True, eq=False)
class _Part:
    """Faces as polygons in their planes, and the planes that cut the part off."""

    faces: list[int]
    shapes: list[shapely.Geometry]
    cuts: list[tuple[Array, float]]


def _cut_up(body: Polyhedron) -> tuple[ConvexPiece, ...] | None:
    axes = tangents(body.normals)
    origins = np.array([body.vertices[face[0]] for face in body.faces])
    size = float(np.ptp(body.vertices, axis=0).max())
    shapes = []
    for face in range(len(body.faces)):
        rings = [(body.vertices[list(loop)] - origins[face]) @ axes[face].T for loop in body.loops_of(face)]
        shapes.append(shapely.Polygon(rings[0], rings[1:]))
    waiting = [_Part(list(range(len(shapes))), shapes, [])]
    done: list[ConvexPiece] = []
    while waiting:
        part = waiting.pop()
        points = np.concatenate(
            [origins[f] + shapely.get_coordinates(s) @ axes[f] for f, s in zip(part.faces, part.shapes, strict=True)]
        )
        out = (points @ body.normals[part.faces].T - body.offsets[part.faces]).max(0)
        if out.max() <= FLAT * size:
            normals = np.concatenate([body.normals[part.faces], *[[n] for n, _ in part.cuts]])
            offsets = np.concatenate([body.offsets[part.faces], [o for _, o in part.cuts]])
            corners = np.unique(np.round(points / (1e-9 * size)), axis=0) * (1e-9 * size)
            if (offsets - (points @ normals.T).min(0)).min() > FLAT * size:  # faces that miss one plane leave flat ones
                done.append(ConvexPiece(corners, normals, offsets))
        else:
            face = part.faces[int(np.argmax(out))]
            normal, offset = body.normals[face], float(body.offsets[face])
            for sign in (1.0, -1.0):
                piece = _clipped(body, part, axes, origins, sign * normal, sign * offset, size)
                if piece.faces:
                    waiting.append(piece)
        if len(done) + len(waiting) > MOST_PIECES:
            return None
    return tuple(done)


def _clipped(
    body: Polyhedron, part: _Part, axes: Array, origins: Array, normal: Array, offset: float, size: float
) -> _Part:
    """Return what of a part lies below a plane."""
    faces, shapes = [], []
    tiny = FLAT * size
    for f, shape in zip(part.faces, part.shapes, strict=True):
        height = origins[f] @ normal - offset
        slope = axes[f] @ normal
        flat = shapely.get_coordinates(shape)
        at = height + flat @ slope
        if at.max() <= tiny:
            if at.min() >= -tiny and body.normals[f] @ normal < 0:  # in the plane, and of the part above it
                continue
            kept = shape
        elif at.min() >= -tiny:
            continue
        else:
            kept = shape.intersection(_half_plane(slope, height, float(np.ptp(flat, axis=0).max()), flat.mean(0)))
            # slivers along an edge in the plane are as wide as rounding
            polygons = [p for p in shapely.get_parts(kept) if p.area > 0.5 * tiny * p.length]
            if not polygons:
                continue
            kept = shapely.MultiPolygon(polygons)
        faces.append(f)
        shapes.append(kept)
    return _Part(faces, shapes, [*part.cuts, (normal, offset)])


def _half_plane(slope: Array, height: float, reach: float, middle: Array) -> shapely.Polygon:
    """Return where ``height + slope . x <= 0``, as far as twice ``reach`` from a point."""
    steep = float(np.hypot(*slope))
    across = slope / steep
    along = turned_left(across)
    edge = middle - (height + middle @ slope) / steep * across
    far = 4 * reach
    return shapely.Polygon([edge - far * along, edge + far * along, edge + far * along - far * across,
                            edge - far * along - far * across])  # fmt: skip
