"""Faces of polyhedra in one table, and the pairs of them that face each other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely

from concio.kinematics.frames import cross, dot, norm
from concio.model.polyhedron import Polyhedron

Array = np.ndarray

CHUNK = 4_000_000
"""Pairs of faces judged together; bounds the memory."""


def spread(first: Array, count: Array) -> tuple[Array, Array]:
    """Return for ranges ``first[k]:first[k] + count[k]`` all their numbers in order, and the range of each."""
    owner = np.repeat(np.arange(len(count)), count)
    before = np.concatenate([[0], np.cumsum(count)[:-1]]) if len(count) else np.zeros(0, dtype=int)
    return first[owner] + np.arange(len(owner)) - before[owner], owner


@dataclass(frozen=True, eq=False)
class Faces:
    """All faces of all bodies, F in all.

    Parameters
    ----------
    body, number : (F,) integer arrays
        Body of each face and its number there.
    normal : (F, 3) array
        Unit, outward.
    offset : (F,) array
        Distance of the plane from the origin along the normal [m].
    low, high : (F, 3) arrays
        Box around each face [m].
    points : (P, 3) array
        Loops of all faces, each closed by its first vertex [m].
    rings : (R + 1,) integer array
        Loop r is ``points[rings[r]:rings[r + 1]]``.
    first : (F + 1,) integer array
        Loops of face f are ``first[f]:first[f + 1]``, its boundary first.
    of_body : (B + 1,) integer array
        Faces of body b are ``of_body[b]:of_body[b + 1]``.
    """

    body: Array
    number: Array
    normal: Array
    offset: Array
    low: Array
    high: Array
    points: Array
    rings: Array
    first: Array
    of_body: Array

    @classmethod
    def of(cls, bodies: Sequence[Polyhedron]) -> Faces:
        """Return the faces of all bodies."""
        count = np.array([len(b.faces) for b in bodies])
        points, sizes, loops = [], [], []
        for b in bodies:
            if b.holes:
                every = [b.loops_of(f) for f in range(len(b.faces))]
                chains = [[*loop, loop[0]] for face in every for loop in face]
                points.append(b.vertices[[v for chain in chains for v in chain]])
                sizes.append(np.array([len(chain) for chain in chains]))
                loops.append(np.array([len(face) for face in every]))
            else:
                points.append(b.vertices[b.topology.closed_loops])
                sizes.append(b.topology.sides_of_face + 1)
                loops.append(np.ones(len(b.faces), dtype=int))
        at = np.concatenate(points)
        rings = np.concatenate([[0], np.cumsum(np.concatenate(sizes))])
        first = np.concatenate([[0], np.cumsum(np.concatenate(loops))])
        begin = rings[first[:-1]]
        body = np.repeat(np.arange(len(bodies)), count)
        of_body = np.concatenate([[0], np.cumsum(count)])
        return cls(
            body=body,
            number=np.arange(len(body)) - of_body[body],
            normal=np.concatenate([b.normals for b in bodies]),
            offset=np.concatenate([b.offsets for b in bodies]),
            low=np.minimum.reduceat(at, begin),
            high=np.maximum.reduceat(at, begin),
            points=at,
            rings=rings,
            first=first,
            of_body=of_body,
        )

    @cached_property
    def boundaries(self) -> tuple[Array, Array]:
        """Directions (P, 3) into faces, and which faces (F,) have corners that point inwards, or holes.

        A direction is that across the side from each point of a boundary; zero where no side begins.
        """
        ring = self.first[:-1]
        point, owner = spread(self.rings[ring], np.diff(self.rings)[ring] - 1)
        side = self.points[point + 1] - self.points[point]
        across = cross(self.normal[owner], side)
        inward = np.zeros_like(self.points)
        inward[point] = across / norm(across)[:, None]
        last = np.append(owner[1:] != owner[:-1], True)
        behind = np.where(last, self.rings[ring][owner] + 1, point + 2)
        turn = dot(cross(side, self.points[behind] - self.points[point + 1]), self.normal[owner])
        doubtful = np.diff(self.first) > 1
        doubtful[owner[turn < -1e-9 * dot(side, side)]] = True
        return inward, doubtful

    def polygons(self, faces: Array, origin: Array, frame: Array) -> Array:
        """Return faces (k,) as shapely polygons in planes of their own.

        Parameters
        ----------
        faces : (k,) integer array
        origin : (k, 3) array
            Where the coordinates of each plane are zero [m].
        frame : (k, 2, 3) array
            The two axes of each plane.
        """
        ring, owner = spread(self.first[faces], np.diff(self.first)[faces])
        point, chain = spread(self.rings[ring], np.diff(self.rings)[ring])
        which = owner[chain]
        arm = self.points[point] - origin[which]
        flat = np.einsum("kd,kid->ki", arm, frame[which])
        ends = np.concatenate([[0], np.cumsum(np.diff(self.rings)[ring])])
        parts = np.concatenate([[0], np.cumsum(np.diff(self.first)[faces])])
        found: Array = shapely.from_ragged_array(shapely.GeometryType.POLYGON, flat, (ends, parts))
        return found


@dataclass(frozen=True, eq=False)
class FacePairs:
    """Pairs of faces that face each other, on their mean planes; p in all.

    Parameters
    ----------
    faces : (p, 2) integer array
        The face of the lower body first.
    normal : (p, 3) array
        Mean unit normal from the first to the second.
    frame : (p, 2, 3) array
        Axes of the mean plane.
    origin : (p, 3) array
        A point of the first face: where the coordinates of the plane are zero [m].
    angle : (p,) array
        Between the two faces [rad].
    """

    faces: Array
    normal: Array
    frame: Array
    origin: Array
    angle: Array

    def chosen(self, which: Array) -> FacePairs:
        """Return the pairs picked by a mask or by indices."""
        return FacePairs(*(getattr(self, name)[which] for name in self.__dataclass_fields__))

    def on_first(self, table: Faces, pair: Array, flat: Array) -> Array:
        """Return the points (k, 3) of the first face whose coordinates in the plane of ``pair`` (k,) are ``flat``."""
        at = self.origin[pair] + np.einsum("ki,kid->kd", flat, self.frame[pair])
        return np.asarray(at + self.height(table, 0, pair, at)[:, None] * self.normal[pair])

    def height(self, table: Faces, side: int, pair: Array, at: Array) -> Array:
        """Return how far (k,) points ``at`` (k, 3) are below the plane of a side of ``pair``, along the mean normal."""
        face = self.faces[pair, side]
        n = table.normal[face]
        found: Array = (table.offset[face] - (n * at).sum(1)) / (n * self.normal[pair]).sum(1)
        return found


def facing_faces(table: Faces, bodies: tuple[Array, Array], near: Array, angle: float) -> FacePairs:
    """Return the pairs of faces of neighbouring bodies that face each other within a distance and an angle.

    Parameters
    ----------
    table : Faces
    bodies : (i, j)
        Neighbouring bodies.
    near : (pairs of bodies,) array
        Largest distance [m].
    angle : float
        Largest angle between the faces [rad].
    """
    found = [np.zeros((0, 2), dtype=int)]
    for part in _chunks(table, bodies):
        i, j = bodies[0][part], bodies[1][part]
        count = np.diff(table.of_body)
        number, owner = spread(np.zeros(len(i), dtype=int), count[i] * count[j])
        across = count[j][owner]
        a, b = table.of_body[i][owner] + number // across, table.of_body[j][owner] + number % across
        reach = near[part][owner]
        facing = (table.normal[a] * table.normal[b]).sum(1) <= -np.cos(angle)
        a, b, reach = a[facing], b[facing], reach[facing]
        meet = (table.low[a] <= table.high[b] + reach[:, None]).all(1)
        meet &= (table.low[b] <= table.high[a] + reach[:, None]).all(1)
        a, b, reach = a[meet], b[meet], reach[meet]
        far = np.zeros(len(a), dtype=bool)
        for p, q in ((a, b), (b, a)):
            middle, radius = 0.5 * (table.low[q] + table.high[q]), 0.5 * (table.high[q] - table.low[q])
            height = (table.normal[p] * middle).sum(1) - table.offset[p]
            slack = (np.abs(table.normal[p]) * radius).sum(1)
            far |= np.abs(height) > reach + slack
        found.append(np.column_stack([a[~far], b[~far]]))
    faces = np.concatenate(found)
    n_a, n_b = table.normal[faces[:, 0]], table.normal[faces[:, 1]]
    normal = n_a - n_b
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    turned = np.arctan2(np.linalg.norm(cross(n_a, n_b), axis=1), -(n_a * n_b).sum(1))
    corner = table.rings[table.first[faces[:, 0]]]
    origin = table.points[corner]
    along = table.points[corner + 1] - origin  # the first axis runs along a side: rectangles become boxes
    along -= (along * normal).sum(1)[:, None] * normal
    along /= np.linalg.norm(along, axis=1)[:, None]
    return FacePairs(faces, normal, np.stack([along, cross(normal, along)], 1), origin, turned)


def _chunks(table: Faces, bodies: tuple[Array, Array]) -> Iterator[slice]:
    count = np.diff(table.of_body)
    total = np.cumsum(count[bodies[0]] * count[bodies[1]])
    start = 0
    while start < len(total):
        before = total[start - 1] if start else 0
        stop = max(start + 1, int(np.searchsorted(total, before + CHUNK, side="right")))
        yield slice(start, stop)
        start = stop
