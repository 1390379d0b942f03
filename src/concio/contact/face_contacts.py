"""Contacts with a face: face on face, an edge on a face, a corner on a face.

The reference face belongs to one piece (r), what meets it to the other (i). Faces turned against each other by small
angles meet over their common part in the mean plane; each of its corners has the normal and the gap of what touches
there: a corner of one body against the face of the other, or an edge against an edge.
"""

from __future__ import annotations

import numpy as np

from concio.contact.clipping import clipped, inside_of, segment_inside, shares, without_repeats
from concio.contact.convex_bodies import ConvexBodies
from concio.contact.meeting_features import CORNER, EDGE, Found
from concio.kinematics.frames import cross, dot, norm, tangents

Array = np.ndarray

CROSSING = 0.05
"""Edges that cross at less have the mean normal of their faces [rad]."""


def on_face(
    pieces: ConvexBodies, row: Array, face: Array, other: Array, slack: Array, facing: float
) -> tuple[list[Found], Array]:
    """Return what meets reference faces, and which pairs (rows) touch beside them only.

    Parameters
    ----------
    pieces : ConvexBodies
    row : (m,) integer array
        Numbers of the pairs.
    face : (m,) integer array
        Reference faces.
    other : (m,) integer array
        The pieces that meet them.
    slack : (m,) array
        Lengths that count as none [m].
    facing : float
        Largest angle between a reference face and a face or edge that lies along it [rad].
    """
    number, _ = pieces.faces_of.padded(other)
    turned = dot(pieces.normals[number], pieces.normals[face][:, None])
    best = turned.argmin(1)
    rows = np.arange(len(row))
    opposite = number[rows, best]
    flat = turned[rows, best] <= -np.cos(facing)
    found, beside = [], [np.zeros(0, dtype=int)]
    if flat.any():
        one, left = _faces(pieces, row[flat], face[flat], opposite[flat], slack[flat])
        found.append(one)
        beside.append(left)
    rest = ~flat
    edge = np.full(len(row), -1)
    if pieces.dim == 3 and rest.any():
        edge[rest] = _lying_edge(pieces, face[rest], other[rest], slack[rest], facing)
    lying = edge >= 0
    if lying.any():
        one, left = _edges(pieces, row[lying], face[lying], edge[lying], slack[lying])
        found.append(one)
        beside.append(left)
    rest &= ~lying
    if rest.any():
        one, left = _corners(pieces, row[rest], face[rest], other[rest], slack[rest])
        found.append(one)
        beside.append(left)
    return found, np.concatenate(beside)


def _corners(pieces: ConvexBodies, row: Array, face: Array, other: Array, slack: Array) -> tuple[Found, Array]:
    """Return corners on the inside of faces, and the pairs of which the nearest corner stands beside."""
    corner, _ = pieces.corners_of.padded(other)
    n = pieces.normals[face]
    height = dot(pieces.points[corner], n[:, None])
    tip = corner[np.arange(len(row)), height.argmin(1)]
    at = pieces.points[tip]
    ring = pieces.points[pieces.loops.values[pieces.loops.padded(face)[0]]]
    proper = inside_of(ring, n, at[:, None])[:, 0] > slack
    gap = dot(n, at) - pieces.offsets[face]
    on = at - gap[:, None] * n
    k = np.flatnonzero(proper)
    points = (on[k, None], at[k, None], n[k, None], np.zeros((len(k), 1)))
    dims = (pieces.dim - 1, CORNER)
    return Found.of(row[k], dims, (face[k], tip[k]), n[k], points, np.ones((len(k), 1), dtype=bool)), row[~proper]


def _lying_edge(pieces: ConvexBodies, face: Array, other: Array, slack: Array, facing: float) -> Array:
    """Return the edge (m,) of each piece that has its lowest corner and lies along the face, -1 where none does."""
    edge, _ = pieces.edges_of.padded(other)
    n = pieces.normals[face]
    height = dot(pieces.points[pieces.edges[edge]], n[:, None, None])
    low, rise = height.min(2), np.ptp(height, axis=2)
    lowest = low <= low.min(1)[:, None] + slack[:, None]
    slope = np.where(lowest, np.abs(dot(pieces.along[edge], n[:, None])), np.inf)
    slope = np.where(lowest & (rise <= slack[:, None]), 0.0, slope)
    best = slope.argmin(1)
    rows = np.arange(len(face))
    return np.asarray(np.where(slope[rows, best] <= np.sin(facing), edge[rows, best], -1))


def _edges(pieces: ConvexBodies, row: Array, face: Array, edge: Array, slack: Array) -> tuple[Found, Array]:
    """Return edges over faces, and the pairs of which the edge runs beside the face or along its boundary."""
    n = pieces.normals[face]
    p, q = (pieces.points[pieces.edges[edge, k]] for k in (0, 1))
    ring = pieces.points[pieces.loops.values[pieces.loops.padded(face)[0]]]
    low, high, first, last = segment_inside(ring, n, p, q)
    length = (high - low) * norm(q - p)
    middle = p + 0.5 * (low + high)[:, None] * (q - p)
    proper = (length > slack) & (inside_of(ring, n, middle[:, None])[:, 0] > slack)
    k = np.flatnonzero(proper)
    share = np.stack([low[k], high[k]], 1)
    at = p[k, None] + share[:, :, None] * (q - p)[k, None]
    on = at - (dot(at, n[k, None]) - pieces.offsets[face[k], None])[:, :, None] * n[k, None]
    side = np.stack([first[k], last[k]], 1)
    rim = np.roll(ring[k], -1, axis=1) - ring[k]
    along = rim[np.arange(len(k))[:, None], np.maximum(side, 0)]
    normals = crossing_normals(along, (q - p)[k, None], n[k, None], side >= 0)
    points = (on, at, normals, np.broadcast_to(0.5 * length[k, None], share.shape))
    found = Found.of(row[k], (2, EDGE), (face[k], edge[k]), n[k], points, np.ones(share.shape, dtype=bool))
    return found, row[~proper]


def crossing_normals(along: Array, other: Array, mean: Array, crosses: Array) -> Array:
    """Return unit vectors square to two edges (..., 3), turned like ``mean``; that itself where they hardly cross."""
    n = cross(along, other)
    length = norm(n)
    sharp = crosses & (length > CROSSING * norm(along) * norm(other))
    n = n / np.where(sharp, length, 1.0)[..., None]
    n = n * np.where(dot(n, np.broadcast_to(mean, n.shape)) < 0, -1.0, 1.0)[..., None]
    return np.asarray(np.where(sharp[..., None], n, mean))


def _faces(pieces: ConvexBodies, row: Array, face: Array, opposite: Array, slack: Array) -> tuple[Found, Array]:
    """Return the common parts of faces that face each other, and the pairs whose faces have none."""
    n_r, n_i = pieces.normals[face], pieces.normals[opposite]
    mean = n_r - n_i
    mean = mean / norm(mean)[:, None]
    place_r, _ = pieces.loops.padded(face)
    place_i, real_i = pieces.loops.padded(opposite)
    ring_r, ring_i = (pieces.points[pieces.loops.values[place]] for place in (place_r, place_i))
    origin, frame = ring_r[:, 0], tangents(mean)
    flat_r, flat_i = (np.matmul(ring - origin[:, None], frame.swapaxes(1, 2)) for ring in (ring_r, ring_i))
    if pieces.dim == 2:
        flat, count, size, share = _common_segment(flat_r[..., 0], flat_i[..., 0])
        proper = size > slack
    else:
        flat, count = clipped(flat_i, real_i.sum(1), flat_r)
        flat, count = without_repeats(flat, count, slack)
        size, around, share = shares(flat, count)
        proper = (count > 2) & (2 * size > slack * around)
    k = np.flatnonzero(proper)
    flat, share, mean = flat[k], share[k], mean[k]
    real = np.arange(flat.shape[1]) < count[k, None]
    at = origin[k, None] + np.matmul(flat, frame[k])
    on_r = _lifted(at, n_r[k], pieces.offsets[face[k]], mean)
    on_i = _lifted(at, n_i[k], pieces.offsets[opposite[k]], mean)
    normals = _normals(flat, (flat_r[k], flat_i[k]), (ring_r[k], ring_i[k]), (n_r[k], n_i[k], mean), slack[k])
    dims = (pieces.dim - 1, pieces.dim - 1)
    found = Found.of(row[k], dims, (face[k], opposite[k]), mean, (on_r, on_i, normals, share), real)
    return found, row[~proper]


def _common_segment(r: Array, i: Array) -> tuple[Array, Array, Array, Array]:
    """Return the common parts (m, 2, 1) of intervals (m, 2), how many ends they have, their lengths and shares."""
    low, high = np.maximum(r.min(1), i.min(1)), np.minimum(r.max(1), i.max(1))
    ends = np.stack([low, high], 1)[:, :, None]
    half = 0.5 * (high - low)
    return ends, np.full(len(low), 2), high - low, np.stack([half, half], 1)


def _lifted(at: Array, normal: Array, offset: Array, along: Array) -> Array:
    """Return points (m, k, d) moved along directions (m, d) onto planes."""
    rise = (offset[:, None] - dot(at, normal[:, None])) / dot(normal, along)[:, None]
    return np.asarray(at + rise[:, :, None] * along[:, None])


def _normals(
    flat: Array, rings: tuple[Array, Array], solid: tuple[Array, Array], unit: tuple[Array, Array, Array], slack: Array
) -> Array:
    """Return the normals (m, k, d), from r to i, of the corners ``flat`` of common parts.

    A corner of i over the inside of the face of r has the normal of that face, a corner of r that of the face of i,
    two edges that cross the normal square to both. Where corners of both meet, and where edges hardly cross, it is the
    mean of the two faces.
    """
    n_r, n_i, mean = unit
    own = [np.linalg.norm(flat[:, :, None] - ring[:, None], axis=3).min(2) <= 2 * slack[:, None] for ring in rings]
    normals = np.broadcast_to(mean[:, None], (*flat.shape[:2], mean.shape[1])).copy()
    if flat.shape[2] == 2:
        sides = []
        for ring, points in zip(rings, solid, strict=True):
            side, rim = np.roll(ring, -1, axis=1) - ring, np.roll(points, -1, axis=1) - points
            length = norm(side)[:, None]
            off = np.abs(cross(side[:, None], flat[:, :, None] - ring[:, None]))
            off = np.where(length > 0, off / np.where(length > 0, length, 1.0), np.inf)
            sides.append(rim[np.arange(len(flat))[:, None], off.argmin(2)])
        normals = crossing_normals(sides[0], sides[1], normals, ~own[0] & ~own[1])
    normals = np.where((own[1] & ~own[0])[:, :, None], n_r[:, None], normals)
    return np.asarray(np.where((own[0] & ~own[1])[:, :, None], -n_i[:, None], normals))
