"""Contacts between convex pieces in any placement, in the plane and in space: a patch of points for each pair.

The direction of largest separation (:mod:`concio.contact.separating_axes`) names the features that meet. A face that
meets a face, an edge or a corner cuts it off (:mod:`concio.contact.face_contacts`): the patch has a polygon, a segment
or a point. Where no face does, edges and corners meet (:mod:`concio.contact.edge_contacts`).

A patch changes as little as its bodies move. Faces that come within a small angle are a patch with a gap that grows
along it, not an edge on a face; the reference face of the patch before is kept while it is nearly as good as the best.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from concio.contact.convex_bodies import ConvexBodies
from concio.contact.edge_contacts import crossing_edges, without_face
from concio.contact.face_contacts import on_face
from concio.contact.meeting_features import Found
from concio.contact.separating_axes import Sides, edge_separations, face_separations
from concio.kinematics.frames import dot
from concio.model.interfaces.detect import NEAR_ANGLE

Array = np.ndarray

SLACK = 1e-9
"""Share of the smaller piece's size that counts as no length."""
KEEP = 1e-4
"""A reference face stays while its separation is less than this share of the smaller piece's size below the largest."""
CHUNK = 2_000_000
"""Heights of corners above faces that are computed together; bounds the memory."""
FEATURES = {2: ("corner", "face"), 3: ("corner", "edge", "face")}
"""Names of what meets, by its dimension, in the plane and in space."""


@dataclass(frozen=True, eq=False)
class Contacts:
    """Patches between convex pieces, p in all, with k points.

    Parameters
    ----------
    a, b : (p,) integer arrays
        Pieces; ``body_a`` is below ``body_b``.
    body_a, body_b : (p,) integer arrays
    dims : (p, 2) integer array
        Dimension of what meets on a and on b: 0 a corner, 1 an edge (in the plane a side), 2 a face.
    feature : (p, 2) integer array
        Its number among the corners, edges or faces of the table.
    normal : (p, d) array
        Unit, from a to b.
    first : (p + 1,) integer array
        Points of patch j are ``first[j]:first[j + 1]``, round the patch.
    on_a, on_b : (k, d) arrays
        The two material points that face each other at each point [m].
    normals : (k, d) array
        Unit, from a to b, of what touches at each point: of a face where a corner meets it, square to both edges where
        edges cross. That of the patch but for small angles.
    gap : (k,) array
        ``normals . (on_b - on_a)``, negative where the pieces overlap [m].
    share : (k,) array
        What each point stands for: area [m2] of two faces in space, length [m] of two sides in the plane and of edges
        in space; 0 of single points.
    """

    a: Array
    b: Array
    body_a: Array
    body_b: Array
    dims: Array
    feature: Array
    normal: Array
    first: Array
    on_a: Array
    on_b: Array
    normals: Array
    gap: Array
    share: Array

    def __len__(self) -> int:
        return len(self.a)

    @property
    def of(self) -> Array:
        """Patch (k,) of each point."""
        return np.repeat(np.arange(len(self)), np.diff(self.first))

    @property
    def kinds(self) -> tuple[str, ...]:
        """What meets what, of each patch: "face-face", "edge-face" and so on, the feature of a first."""
        words = FEATURES[self.normal.shape[1]]
        return tuple(f"{words[p]}-{words[q]}" for p, q in self.dims.tolist())

    def chosen(self, which: Array) -> Contacts:
        """Return the patches picked by a mask or by numbers."""
        which = np.flatnonzero(which) if which.dtype == bool else which
        count = np.diff(self.first)[which]
        first = np.concatenate([[0], np.cumsum(count)])
        point = np.repeat(self.first[which] - first[:-1], count) + np.arange(first[-1])
        return Contacts(
            self.a[which], self.b[which], self.body_a[which], self.body_b[which], self.dims[which],
            self.feature[which], self.normal[which], first, self.on_a[point], self.on_b[point], self.normals[point],
            self.gap[point], self.share[point],
        )  # fmt: skip


def find_contacts(
    pieces: ConvexBodies, pairs: tuple[Array, Array], reach: Array | float, *, facing: float = NEAR_ANGLE,
    previous: Contacts | None = None, slack: Array | None = None,
) -> Contacts:  # fmt: skip
    """Return the patches of pairs of convex pieces that come within reach of each other or overlap.

    Parameters
    ----------
    pieces : ConvexBodies
        Where the bodies stand (:meth:`ConvexBodies.placed`).
    pairs : (i, j)
        Pieces (m,), the lower body first: :func:`concio.contact.convex_bodies.pairs_of`.
    reach : float or (m,) array
        Largest distance [m].
    facing : float
        Largest angle at which two faces, or an edge and a face, are a patch of more than one point [rad].
    previous : Contacts, optional
        Patches of the same pieces shortly before, whose reference faces are kept.
    slack : (m,) array, optional
        Lengths that count as none, in which many directions are as good [m]; default :data:`SLACK` of the smaller
        piece's size.
    """
    i, j = pairs
    near = np.broadcast_to(np.asarray(reach, dtype=float), len(i))
    small = np.minimum(pieces.size[i], pieces.size[j])
    slack = SLACK * small if slack is None else slack
    kept = _References.of(previous, len(pieces))
    found: list[Found] = []
    for own in _chunks(pieces, i, j):
        found += _some(pieces, own, (i[own], j[own]), near[own], slack[own], KEEP * small[own], facing, kept)
    return _together(pieces, pairs, found)


def _chunks(pieces: ConvexBodies, i: Array, j: Array) -> Iterator[Array]:
    """Yield the pairs in parts of like size."""
    corners, faces, axes = pieces.corners_of.count, pieces.faces_of.count, pieces.axes.count
    both = corners[i] + corners[j]
    work = both * (faces[i] + faces[j] + (axes[i] * axes[j] if pieces.dim == 3 else 0))
    order = np.argsort(work, kind="stable")
    start = 0
    while start < len(order):
        stop = int(np.searchsorted(work[order], 2 * work[order[start]], side="right"))
        stop = min(stop, start + max(1, CHUNK // int(2 * work[order[start]])))
        yield np.sort(order[start:stop])
        start = stop


@dataclass(frozen=True, eq=False)
class _References:
    """Which face was the reference of each pair of pieces before; -1 for none."""

    count: int
    key: Array
    face: Array
    side: Array

    @classmethod
    def of(cls, previous: Contacts | None, count: int) -> _References | None:
        if previous is None or not len(previous):
            return None
        top = previous.normal.shape[1] - 1
        faces = previous.dims == top
        side = np.where(faces[:, 0], 0, 1)
        some = np.flatnonzero(faces.any(1))
        key = previous.a[some].astype(np.int64) * count + previous.b[some]
        order = np.argsort(key)
        some = some[order]
        return cls(count, key[order], previous.feature[some, side[some]], side[some])

    def stay(
        self, i: Array, j: Array, faces: tuple[Array, Array], separation: tuple[Array, Array], least: Array
    ) -> Array:
        """Return the place of the face of before among the faces of a and then of b (m,), -1 where it does not stay."""
        key = i.astype(np.int64) * self.count + j
        at = np.minimum(np.searchsorted(self.key, key), len(self.key) - 1)
        known = self.key[at] == key
        found = np.full(len(i), -1)
        for side, (face, own) in enumerate(zip(faces, separation, strict=True)):
            place = self.face[at] - face[:, 0]
            inside = known & (self.side[at] == side) & (place >= 0) & (place < face.shape[1])
            good = inside & (own[np.arange(len(i)), np.where(inside, place, 0)] >= least)
            found = np.where(good, place + side * faces[0].shape[1], found)
        return found


def _some(
    pieces: ConvexBodies, row: Array, pair: tuple[Array, Array], reach: Array, slack: Array, keep: Array,
    facing: float, kept: _References | None,
) -> list[Found]:  # fmt: skip
    """Return the contacts of pairs of like size."""
    a, b = (Sides.of(pieces, piece) for piece in pair)
    own, other = face_separations(a, b), face_separations(b, a)
    near = np.maximum(own.max(1), other.max(1)) <= reach
    if not near.any():
        return []
    a, b, own, other = a.chosen(near), b.chosen(near), own[near], other[near]
    direction, across = edge_separations(a, b)
    every = np.concatenate([own, other], axis=1)
    best = every.max(1)
    edge = across.max(1, initial=-np.inf)
    k = np.flatnonzero(near)
    met = np.maximum(best, edge) <= reach[k]
    k, direction, across, every, own, other = (v[met] for v in (k, direction, across, every, own, other))
    a, b = a.chosen(met), b.chosen(met)
    if not len(k):
        return []
    best, edge = best[met], edge[met]
    first = np.argmax(every >= best[:, None] - slack[k, None], axis=1)
    by_face = best >= edge - slack[k]
    if kept is not None:
        stay = kept.stay(
            pair[0][k], pair[1][k], (a.face, b.face), (own, other), np.maximum(best, edge) - keep[k]
        )
        first, by_face = np.where(stay >= 0, stay, first), by_face | (stay >= 0)
    return _features(pieces, row[k], (pair[0][k], pair[1][k]), (a, b), first, by_face, (direction, across),
                     reach[k], slack[k], facing)  # fmt: skip


def _features(
    pieces: ConvexBodies, row: Array, pair: tuple[Array, Array], sides: tuple[Sides, Sides], first: Array,
    by_face: Array, edges: tuple[Array, Array], reach: Array, slack: Array, facing: float,
) -> list[Found]:  # fmt: skip
    """Return contacts with the reference faces or the edges that were found best (places of rows count from 0)."""
    a, b = sides
    rows = np.arange(len(row))
    of_b = first >= a.face.shape[1]
    place = np.where(of_b, first - a.face.shape[1], first)
    face = np.where(of_b, b.face[rows, np.where(of_b, place, 0)], a.face[rows, np.where(of_b, 0, place)])
    found: list[Found] = []
    left = [np.zeros(0, dtype=int)]
    k = np.flatnonzero(by_face)
    if len(k):
        other = np.where(of_b, *pair)[k]
        parts, beside = on_face(pieces, k, face[k], other, slack[k], facing)
        found += [part.turned(of_b) for part in parts]
        left.append(beside)
    k = np.flatnonzero(~by_face)
    if len(k):
        direction, across = edges
        best = across[k].argmax(1)
        p, q = np.divmod(best, b.axis.shape[1])
        axes = (a.axis[k, p], b.axis[k, q])
        part, beside = crossing_edges(pieces, k, (pair[0][k], pair[1][k]), axes, direction[k, best], slack[k])
        found.append(part)
        left.append(beside)
    k = np.sort(np.concatenate(left))
    if len(k):
        found += without_face(pieces, k, (pair[0][k], pair[1][k]), reach[k], slack[k])
    return [Found(row[part.row], *(getattr(part, n) for n in list(Found.__dataclass_fields__)[1:])) for part in found]


def _together(pieces: ConvexBodies, pairs: tuple[Array, Array], found: list[Found]) -> Contacts:
    """Return the contacts of all kinds in the order of the pairs, without those at faces inside of bodies."""
    d = pieces.dim
    if not found:
        none, empty = np.zeros(0, dtype=int), np.zeros((0, d))
        return Contacts(none, none, none, none, np.zeros((0, 2), dtype=int), np.zeros((0, 2), dtype=int), empty,
                        np.zeros(1, dtype=int), empty, empty, empty, np.zeros(0), np.zeros(0))  # fmt: skip
    row, dims, feature, normal, count, on_r, on_i, normals, share = (
        np.concatenate([getattr(part, name) for part in found]) for name in Found.__dataclass_fields__
    )
    a, b = (piece[row] for piece in pairs)
    gap = dot(normals, on_i - on_r)
    first = np.concatenate([[0], np.cumsum(count)])
    every = Contacts(
        a, b, pieces.body[a], pieces.body[b], dims, feature, normal, first, on_r, on_i, normals, gap, share
    )
    order = np.argsort(row, kind="stable")
    every = every.chosen(order)
    return every.chosen(~_inside(pieces, every)) if pieces.inner.any() else every


def _inside(pieces: ConvexBodies, found: Contacts) -> Array:
    """Return which patches press on a face between two pieces of one body: the other piece has the contact."""
    wrong = np.zeros(len(found), dtype=bool)
    top = pieces.dim - 1
    for side, piece, sign in ((0, found.a, 1.0), (1, found.b, -1.0)):
        face = found.dims[:, side] == top
        wrong[face] |= pieces.inner[found.feature[face, side]]
        number, real = pieces.faces_of.padded(piece)
        n, at = pieces.normals[number], (found.on_a if side == 0 else found.on_b)
        middle = np.add.reduceat(at, found.first[:-1], axis=0) / np.diff(found.first)[:, None]
        on = np.abs(dot(n, middle[:, None]) - pieces.offsets[number]) <= 1e-6 * pieces.size[piece][:, None]
        pressed = sign * dot(n, found.normal[:, None]) > 1e-6
        wrong |= ~face & (pieces.inner[number] & real & on & pressed).any(1)
    return wrong
