"""Bodies as convex pieces in tables of arrays, in the plane and in space: what the contact search looks at.

In the plane a *face* of a piece is a side of its outline. A body that is not convex is several pieces; the faces
between two pieces of one body are *inner*: nothing can touch them.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import shapely

from concio.kinematics.boxes import meeting_boxes
from concio.kinematics.frames import cross, dot, norm, tangents, turned_right
from concio.kinematics.placement import Placement
from concio.model.body import Body
from concio.model.polyhedron import Polyhedron

Array = np.ndarray

FLAT = 1e-6
"""Share of the size of a piece by which a corner may stand out of a plane that it lies in."""
ALIKE = 1e-9
"""Unit vectors that differ by less are one direction."""


@dataclass(frozen=True, eq=False)
class Ragged:
    """Rows of different lengths in one array: row k is ``values[first[k]:first[k + 1]]``."""

    values: Array
    first: Array

    @classmethod
    def of(cls, rows: Sequence[Array]) -> Ragged:
        """Put rows one after the other."""
        return cls(np.concatenate(rows), np.concatenate([[0], np.cumsum([len(row) for row in rows])]))

    @property
    def count(self) -> Array:
        """Length of each row."""
        return np.diff(self.first)

    def padded(self, rows: Array) -> tuple[Array, Array]:
        """Return places in ``values`` of rows (m,), the last of each repeated to one length, and which are real."""
        count = self.count[rows]
        column = np.arange(int(count.max(initial=1)))
        return self.first[rows][:, None] + np.minimum(column, count[:, None] - 1), column < count[:, None]


@dataclass(frozen=True, eq=False)
class ConvexBodies:
    """Convex pieces of bodies, n in all, with v corners, f faces and e edges.

    Parameters
    ----------
    body : (n,) integer array
        Body of each piece.
    points : (v, d) array
        Corners [m].
    corner_of, face_of, edge_of : (n + 1,) integer arrays
        Corners of piece k are ``corner_of[k]:corner_of[k + 1]``; faces and edges likewise.
    normals : (f, d) array
        Unit, outward.
    loops : Ragged
        Corners of each face in order, counter-clockwise seen from outside; of a side in the plane its two ends.
    inner : (f,) boolean array
        Faces between pieces of one body.
    number : (f,) integer array
        Number of the face or side of the body; -1 for inner ones.
    edges : (e, 2) integer array
        Ends of the edges. In the plane they are the sides.
    axes : Ragged
        Edges of each piece, one for each direction; none in the plane.
    left_out : tuple of int
        Bodies that fall into too many convex pieces and are not in the table.
    """

    body: Array
    points: Array
    corner_of: Array
    face_of: Array
    edge_of: Array
    normals: Array
    loops: Ragged
    inner: Array
    number: Array
    edges: Array
    axes: Ragged
    left_out: tuple[int, ...] = ()

    @classmethod
    def of(cls, bodies: Sequence[Body] | Sequence[Polyhedron]) -> ConvexBodies:
        """Return the table of bodies where they were described."""
        parts: list[_Piece] = []
        left_out = []
        every: list[Body | Polyhedron] = list(bodies)
        for b, body in enumerate(every):
            found = list(_plane_pieces(b, body) if isinstance(body, Body) else _space_pieces(b, body))
            parts += found
            left_out += [] if found else [b]
        count = [len(p.points) for p in parts]
        corner_of, face_of, edge_of = (
            np.concatenate([[0], np.cumsum(c)])
            for c in (count, [len(p.normals) for p in parts], [len(p.edges) for p in parts])
        )
        loops = [loop + at for p, at in zip(parts, corner_of, strict=False) for loop in p.loops]
        return cls(
            np.array([p.body for p in parts], dtype=int), np.concatenate([p.points for p in parts]),
            corner_of, face_of, edge_of, np.concatenate([p.normals for p in parts]), Ragged.of(loops),
            np.concatenate([p.inner for p in parts]), np.concatenate([p.number for p in parts]),
            np.concatenate([p.edges + at for p, at in zip(parts, corner_of, strict=False)]),
            Ragged.of([p.axes + at for p, at in zip(parts, edge_of, strict=False)]), tuple(left_out),
        )  # fmt: skip

    def __len__(self) -> int:
        return len(self.body)

    @property
    def dim(self) -> int:
        """Space dimension, 2 or 3."""
        return int(self.points.shape[1])

    @cached_property
    def offsets(self) -> Array:
        """Distances (f,) of the faces from the origin along their normals [m]."""
        return dot(self.normals, self.points[self.loops.values[self.loops.first[:-1]]])

    @cached_property
    def along(self) -> Array:
        """Unit vectors (e, d) of the edges."""
        way = self.points[self.edges[:, 1]] - self.points[self.edges[:, 0]]
        return np.asarray(way / norm(way)[:, None])

    @cached_property
    def boxes(self) -> tuple[Array, Array]:
        """Lower and upper corners (n, d) of the boxes round the pieces [m]."""
        first = self.corner_of[:-1]
        return np.minimum.reduceat(self.points, first), np.maximum.reduceat(self.points, first)

    @cached_property
    def size(self) -> Array:
        """Longest side (n,) of the box round each piece where it was described [m]."""
        low, high = self.boxes
        return np.asarray((high - low).max(1))

    @cached_property
    def faces_of(self) -> Ragged:
        """Faces of each piece."""
        return Ragged(np.arange(len(self.normals)), self.face_of)

    @cached_property
    def corners_of(self) -> Ragged:
        """Corners of each piece."""
        return Ragged(np.arange(len(self.points)), self.corner_of)

    @cached_property
    def edges_of(self) -> Ragged:
        """Edges of each piece."""
        return Ragged(np.arange(len(self.edges)), self.edge_of)

    def placed(self, placement: Placement, centre: Array) -> ConvexBodies:
        """Return the pieces of bodies that stand elsewhere.

        Parameters
        ----------
        placement : Placement
        centre : (B, d) array
            Centroids of the bodies where they were described [m].
        """
        of_point = self.body[np.repeat(np.arange(len(self)), np.diff(self.corner_of))]
        of_face = self.body[np.repeat(np.arange(len(self)), np.diff(self.face_of))]
        points = placement.points(of_point, self.points - centre[of_point])
        found = replace(self, points=points, normals=np.asarray(placement.turns[of_face].apply(self.normals)))
        found.__dict__["size"] = self.size  # tolerances do not change as bodies turn
        return found


@dataclass(frozen=True, eq=False)
class _Piece:
    """One convex piece, its corners and edges counted from 0."""

    body: int
    points: Array
    normals: Array
    loops: list[Array]
    inner: Array
    number: Array
    edges: Array
    axes: Array


def _plane_pieces(b: int, body: Body) -> Iterable[_Piece]:
    """Return the convex pieces of a body in the plane: itself, or triangles."""
    ring = np.asarray(body.outline)
    numbers = np.arange(len(ring))
    if not body.holes:
        turn = cross(ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring)
        least = FLAT * float(np.ptp(ring, axis=0).max()) ** 2
        if turn.min() >= -1e-6 * least:
            some = turn > 1e-6 * least
            yield _polygon(b, ring[some], numbers[some])
            return
    shape = shapely.Polygon(body.outline, body.holes)
    starts, ends = body.vertices, body.vertices[body.following]
    for part in shapely.get_parts(shapely.constrained_delaunay_triangles(shape)):
        corners = shapely.get_coordinates(shapely.orient_polygons(part))[:3]
        yield _polygon(b, corners, _sides_on(corners, starts, ends))


def _sides_on(corners: Array, starts: Array, ends: Array) -> Array:
    """Return the number of the side of an outline on which each side of a triangle lies, -1 for none."""
    found = np.full(len(corners), -1)
    for k, (p, q) in enumerate(zip(corners, np.roll(corners, -1, axis=0), strict=True)):
        way = ends - starts
        length = norm(way)
        off = [np.abs(cross(way, x - starts)) / length for x in (p, q)]
        at = [dot(way, x - starts) / length for x in (p, q)]
        near = 1e-9 * length.max()
        on = (np.maximum(*off) <= near) & (np.minimum(*at) >= -near) & (np.maximum(*at) <= length + near)
        if on.any():
            found[k] = int(np.argmax(on))
    return found


def _polygon(b: int, points: Array, number: Array) -> _Piece:
    along = np.roll(points, -1, axis=0) - points
    sides = np.column_stack([np.arange(len(points)), np.roll(np.arange(len(points)), -1)])
    normals = turned_right(along) / norm(along)[:, None]
    return _Piece(b, points, normals, list(sides), number < 0, number, sides, np.zeros(0, dtype=int))


def _space_pieces(b: int, body: Polyhedron) -> Iterable[_Piece]:
    """Return the convex pieces of a body in space; none where it falls into too many."""
    if body.convex and not body.holes:
        top = body.topology
        sides = dot(*body.normals[top.edge_faces.T])
        if sides.max() < 1 - 1e-10:
            loops = [np.array(face) for face in body.faces]
            number = np.arange(len(loops))
            yield _piece(b, body.vertices, body.normals, loops, np.zeros(len(loops), dtype=bool), number, top.edges)
            return
    for part in body.pieces or ():
        yield _hull(b, body, part.vertices, part.normals, part.offsets)


def _piece(
    b: int, points: Array, normals: Array, loops: list[Array], inner: Array, number: Array, edges: Array
) -> _Piece:
    along = points[edges[:, 1]] - points[edges[:, 0]]
    along = along / norm(along)[:, None]
    along = along * np.where(along @ np.array([1.0, 1e-3, 1e-6]) < 0, -1.0, 1.0)[:, None]
    first: dict[tuple[float, ...], int] = {}
    for e, key in enumerate(np.round(along / ALIKE).tolist()):
        first.setdefault(tuple(key), e)
    return _Piece(b, points, normals, loops, inner, number, edges, np.array(list(first.values())))


def _hull(b: int, body: Polyhedron, points: Array, normals: Array, offsets: Array) -> _Piece:
    """Return a piece from its corners and planes: planes that are one are taken once, their corners put in order."""
    size = float(np.ptp(points, axis=0).max())
    loops: list[Array] = []
    kept: list[tuple[Array, float]] = []
    for n, o in zip(normals, offsets, strict=True):
        if any(n @ m > 1 - 1e-10 and abs(o - p) <= FLAT * size for m, p in kept):
            continue
        on = np.flatnonzero(np.abs(points @ n - o) <= FLAT * size)
        if len(on) < 3:
            continue
        flat = (points[on] - points[on].mean(0)) @ tangents(n).T
        order = np.argsort(np.arctan2(flat[:, 1], flat[:, 0]))
        flat, on = flat[order], on[order]
        turn = cross(flat - np.roll(flat, 1, axis=0), np.roll(flat, -1, axis=0) - flat)
        some = turn > 1e-9 * size * size
        if some.sum() < 3:
            continue
        loops.append(on[some])
        kept.append((n, o))
    planes = np.array([n for n, _ in kept])
    sides = np.concatenate([np.column_stack([loop, np.roll(loop, -1)]) for loop in loops])
    edges = np.unique(np.sort(sides, axis=1), axis=0)
    used = np.unique(np.concatenate(loops))
    new = np.zeros(len(points), dtype=int)
    new[used] = np.arange(len(used))
    number = np.array([_face_on(body, points[loop], n) for loop, n in zip(loops, planes, strict=True)])
    return _piece(b, points[used], planes, [new[loop] for loop in loops], number < 0, number, new[edges])


def _face_on(body: Polyhedron, ring: Array, normal: Array) -> int:
    """Return the number of the face of a body of which a face of a piece is a part, -1 for none."""
    near = FLAT * body.size
    alike = np.flatnonzero((body.normals @ normal > 1 - 1e-9) & (np.abs(body.offsets - ring[0] @ normal) <= 10 * near))
    frame = tangents(normal)
    own = shapely.Polygon((ring - ring[0]) @ frame.T)
    for f in alike.tolist():
        rings = [(body.vertices[list(loop)] - ring[0]) @ frame.T for loop in body.loops_of(f)]
        if shapely.intersection(own, shapely.Polygon(rings[0], rings[1:])).area > 1e-6 * own.area:
            return f
    return -1


def pairs_of(pieces: ConvexBodies, skin: float, still: Array) -> tuple[Array, Array]:
    """Return the pairs i, j of pieces of two bodies, the lower body first, whose boxes come within a skin [m].

    Parameters
    ----------
    pieces : ConvexBodies
    skin : float
        [m].
    still : (B,) boolean array
        Bodies that do not move: pairs of two such are left out.
    """
    low, high = pieces.boxes
    i, j = meeting_boxes(low - 0.5 * skin, high + 0.5 * skin)
    a, b = pieces.body[i], pieces.body[j]
    some = (a != b) & ~(still[a] & still[b])
    i, j = np.where(a < b, i, j)[some], np.where(a < b, j, i)[some]
    order = np.lexsort([j, i, pieces.body[j], pieces.body[i]])
    return i[order], j[order]


