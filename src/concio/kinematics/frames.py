"""Frames of contact and the products that go with them: one sign convention for the plane and for space.

The tangent of the plane is the normal *turned left*, so that (n, t) turns like (x, y). Arrays hold vectors along their
last axis, of length d = 2 or 3; functions work on any number of vectors at once.
"""

from __future__ import annotations

import numpy as np

Array = np.ndarray

FLAT = 1e-6
"""Share of a normal that may lie in the horizontal plane for its face to count as horizontal."""


def turned_left(v: Array) -> Array:
    """Return plane vectors (..., 2) turned left by a right angle: (-y, x)."""
    v = np.asarray(v)
    found = np.empty_like(v)
    found[..., 0], found[..., 1] = -v[..., 1], v[..., 0]
    return found


def turned_right(v: Array) -> Array:
    """Return plane vectors (..., 2) turned right by a right angle: (y, -x)."""
    v = np.asarray(v)
    found = np.empty_like(v)
    found[..., 0], found[..., 1] = v[..., 1], -v[..., 0]
    return found


def turned(v: Array, angle: Array | float) -> Array:
    """Return plane vectors (..., 2) turned left by angles (...) [rad]."""
    v, c, s = np.asarray(v), np.cos(angle), np.sin(angle)
    x = c * v[..., 0] - s * v[..., 1]
    found = np.empty((*x.shape, 2))
    found[..., 0], found[..., 1] = x, s * v[..., 0] + c * v[..., 1]
    return found


def dot(p: Array, q: Array) -> Array:
    """Return the scalar product (...) of vectors (..., d), component by component: faster than a sum along an axis.

    Vectors along the tangents of the plane have one component.
    """
    if p.shape[-1] == 1:
        return np.asarray(p[..., 0] * q[..., 0])
    found = p[..., 0] * q[..., 0] + p[..., 1] * q[..., 1]
    return np.asarray(found + p[..., 2] * q[..., 2] if p.shape[-1] == 3 else found)


def norm(v: Array) -> Array:
    """Return the lengths (...) of vectors (..., d)."""
    if v.shape[-1] == 1:
        return np.asarray(np.abs(v[..., 0]))
    if v.shape[-1] == 2:
        return np.asarray(np.hypot(v[..., 0], v[..., 1]))
    return np.asarray(np.sqrt(dot(v, v)))


def cross(p: Array, q: Array) -> Array:
    """Return the cross product: (...) in the plane, positive from p to q turning left; (..., 3) in space."""
    p, q = np.asarray(p), np.asarray(q)
    if p.shape[-1] == 2:
        area: Array = np.asarray(p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0])
        return area
    a, b, c = p[..., 0], p[..., 1], p[..., 2]
    x, y, z = q[..., 0], q[..., 1], q[..., 2]
    first = b * z - c * y
    found = np.empty((*np.shape(first), 3))
    found[..., 0], found[..., 1], found[..., 2] = first, c * x - a * z, a * y - b * x
    return found


def turning(p: Array, q: Array) -> Array:
    """Return the angle (...) by which plane vectors p turn into q, in (-pi, pi], positive to the left [rad]."""
    p, q = np.asarray(p), np.asarray(q)
    return np.asarray(np.arctan2(cross(p, q), (p * q).sum(-1)))


def tangents(normal: Array) -> Array:
    """Return the tangents (..., d-1, d) of unit normals (..., d).

    In the plane the normal turned left. In space two of them, right-handed with the normal: on a face that is not
    horizontal the first is horizontal, the normal turned left in plan, and the second points up the face; on a
    horizontal face the first points along x.
    """
    n = np.asarray(normal, dtype=float)
    if n.shape[-1] == 2:
        return turned_left(n)[..., None, :]
    level = np.hypot(n[..., 0], n[..., 1])
    flat = (level <= FLAT)[..., None]
    in_plan = np.stack([-n[..., 1], n[..., 0], np.zeros_like(level)], axis=-1) / np.where(flat, 1.0, level[..., None])
    along_x = np.array([1.0, 0.0, 0.0]) - n[..., :1] * n
    length = np.where(flat, np.linalg.norm(along_x, axis=-1, keepdims=True), 1.0)
    first = np.where(flat, along_x / length, in_plan)
    return np.stack([first, cross(n, first)], axis=-2)


def frames(normal: Array) -> Array:
    """Return unit normals (..., d) with their tangents, as rows (..., d, d)."""
    n = np.asarray(normal, dtype=float)
    found = np.empty((*n.shape, n.shape[-1]))
    found[..., 0, :] = n
    if n.shape[-1] == 2:
        found[..., 1, 0], found[..., 1, 1] = -n[..., 1], n[..., 0]
    else:
        found[..., 1:, :] = tangents(n)
    return found


def components(v: Array, frame: Array) -> Array:
    """Return the components (m, d) of vectors (m, d) in frames (m, d, d) whose rows are directions."""
    found = np.empty(v.shape)
    for k in range(v.shape[-1]):
        found[:, k] = dot(frame[:, k], v)
    return found
