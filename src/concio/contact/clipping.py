"""Common parts of convex faces, many at once: polygons cut by polygons in their plane, segments cut by polygons."""

from __future__ import annotations

import numpy as np

from concio.kinematics.frames import cross, dot, norm

Array = np.ndarray


def clipped(polygon: Array, count: Array, by: Array) -> tuple[Array, Array]:
    """Return what of convex polygons lies inside convex polygons, by Sutherland and Hodgman's rule.

    Parameters
    ----------
    polygon : (m, k, 2) array
        Corners in order, either way round; those from ``count`` on are not read.
    count : (m,) integer array
    by : (m, l, 2) array
        Corners counter-clockwise; a last corner repeated changes nothing.

    Returns
    -------
    polygon : (m, k', 2) array
    count : (m,) integer array
        0 where nothing is common.
    """
    for side in range(by.shape[1]):
        start, end = by[:, side], by[:, (side + 1) % by.shape[1]]
        polygon, count = _cut(polygon, count, start, end - start)
    return polygon, count


def _cut(polygon: Array, count: Array, start: Array, along: Array) -> tuple[Array, Array]:
    """Return what lies to the left of lines; a line without a direction cuts nothing."""
    m, k = polygon.shape[:2]
    column = np.arange(k)
    real = column < count[:, None]
    height = cross(along[:, None], polygon - start[:, None])
    after = np.where(column + 1 < count[:, None], column + 1, 0)
    row = np.arange(m)[:, None]
    next_point, next_height = polygon[row, after], height[row, after]
    stays = real & (height >= 0)
    crosses = real & ((height >= 0) != (next_height >= 0))
    drop = np.where(crosses, height - next_height, 1.0)
    met = polygon + (height / drop)[:, :, None] * (next_point - polygon)
    place = np.cumsum(stays.astype(int) + crosses, axis=1)
    total = place[:, -1] if k else np.zeros(m, dtype=int)
    found = np.zeros((m, max(int(total.max(initial=0)), 1), 2))
    r, c = np.nonzero(stays)
    found[r, place[r, c] - 1 - crosses[r, c]] = polygon[r, c]
    r, c = np.nonzero(crosses)
    found[r, place[r, c] - 1] = met[r, c]
    return found, total


def without_repeats(polygon: Array, count: Array, near: Array) -> tuple[Array, Array]:
    """Return polygons without corners that lie within ``near`` (m,) of the corner before them [m]."""
    m, k = polygon.shape[:2]
    column = np.arange(k)
    before = np.where(column > 0, column - 1, np.maximum(count[:, None] - 1, 0))
    apart = norm(polygon - polygon[np.arange(m)[:, None], before]) > near[:, None]
    keep = apart & (column < count[:, None])
    order = np.argsort(~keep, axis=1, kind="stable")
    return polygon[np.arange(m)[:, None], order], keep.sum(1)


def shares(polygon: Array, count: Array) -> tuple[Array, Array, Array]:
    """Return areas (m,), perimeters (m,) and the area that each corner stands for (m, k).

    Half of each triangle that a side makes with the centroid goes to each of its two ends, so that the shares sum to
    the area and have its centroid.
    """
    m, k = polygon.shape[:2]
    column, row = np.arange(k), np.arange(m)[:, None]
    real = column < count[:, None]
    after = np.where(column + 1 < count[:, None], column + 1, 0)
    near = polygon[:, :1]
    p, q = polygon - near, polygon[row, after] - near
    fan = np.where(real, 0.5 * cross(p, q), 0.0)
    area = fan.sum(1)
    safe = np.where(area != 0, area, 1.0)
    centre = (fan[:, :, None] * (p + q)).sum(1) / (3 * safe)[:, None]
    part = np.where(real, 0.5 * cross(p - centre[:, None], q - centre[:, None]), 0.0)
    share = 0.5 * part
    np.add.at(share, (np.broadcast_to(row, (m, k)), after), 0.5 * part)
    around = np.where(real, norm(q - p), 0.0).sum(1)
    return np.abs(area), around, np.where(real, share, 0.0) * np.sign(safe)[:, None]


def inside_of(ring: Array, normal: Array, at: Array) -> Array:
    """Return how far points lie inside convex faces, negative outside: the least distance from a side (m, j) [m].

    Parameters
    ----------
    ring : (m, l, d) array
        Corners, counter-clockwise about the normal, in the plane the two ends of a side of an outline; a last corner
        repeated changes nothing.
    normal : (m, d) array
    at : (m, j, d) array
        Points; heights above the face do not count.
    """
    inward, level = inward_of(ring, normal)
    depth = dot(inward[:, None], at[:, :, None] - ring[:, None])
    return np.asarray(np.where(level[:, None], np.inf, depth).min(2))


def inward_of(ring: Array, normal: Array) -> tuple[Array, Array]:
    """Return unit vectors (m, l, d) square to the sides into the faces, and which sides (m, l) have no length."""
    side = np.roll(ring, -1, axis=1) - ring
    inward = side if ring.shape[2] == 2 else cross(np.broadcast_to(normal[:, None], side.shape), side)
    length = norm(inward)
    level = length <= 1e-12 * length.max(1, initial=0.0)[:, None]
    return inward / np.where(level, 1.0, length)[:, :, None], level


def segment_inside(ring: Array, normal: Array, p: Array, q: Array) -> tuple[Array, Array, Array, Array]:
    """Return the shares from p to q (m, 3) between which segments lie inside convex faces, and which sides cut them.

    Returns
    -------
    low, high : (m,) arrays
        From 0 to 1; ``low > high`` where the segment lies outside.
    first, last : (m,) integer arrays
        Side that cuts the segment there, -1 where its own end is inside.
    """
    inward, level = inward_of(ring, normal)
    start = dot(inward, p[:, None] - ring)
    rate = dot(inward, (q - p)[:, None])
    flat = np.abs(rate) <= 1e-12 * norm(q - p)[:, None]
    share = -start / np.where(flat, 1.0, rate)
    outside = np.where(flat & ~level & (start < 0), 2.0, -1.0)
    enter = np.where(level, -1.0, np.where(flat, outside, np.where(rate > 0, share, -1.0)))
    leave = np.where(level | flat | (rate > 0), 2.0, share)
    row = np.arange(len(p))
    first, last = enter.argmax(1), leave.argmin(1)
    low, high = enter[row, first], leave[row, last]
    first, last = np.where(low > 0, first, -1), np.where(high < 1, last, -1)
    return np.maximum(low, 0.0), np.minimum(high, 1.0), first, last


def nearest(a: Array, u: Array, b: Array, v: Array) -> tuple[Array, Array]:
    """Return where on segments a + s u and b + t v (..., d), with s and t from 0 to 1, they are nearest (...).

    Segments may be points.
    """
    r = a - b
    uu, vv, uv, ur, vr = (dot(x, y) for x, y in ((u, u), (v, v), (u, v), (u, r), (v, r)))
    apart = uu * vv - uv * uv
    crossing = apart > 1e-12 * uu * vv
    s = np.where(crossing, np.clip((uv * vr - vv * ur) / np.where(crossing, apart, 1.0), 0.0, 1.0), 0.0)
    t = np.clip((uv * s + vr) / np.where(vv > 0, vv, 1.0), 0.0, 1.0)
    s = np.clip((uv * t - ur) / np.where(uu > 0, uu, 1.0), 0.0, 1.0)
    return s, t
