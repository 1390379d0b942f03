"""Structured quadrilaterals of outlines with four corners, by a Coons patch between the four sides.

A side may be straight or a chain of short straight pieces, as the intrados of a voussoir. Lines of the mesh join a mark
at fraction ``f`` of one side with a mark at fraction ``g`` of the opposite side; marks that have no partner near them
get one at the same fraction. A node is where line i (from f_i to g_i) and line j (from h_j to k_j) cross in the unit
square,

    u = f + (g - f) v,   v = h + (k - h) u,

and the Coons patch takes (u, v) to the plane, exact on all four sides (Coons 1967).
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from concio.kinematics.frames import cross, turning

Array = np.ndarray
CORNER = np.deg2rad(30.0)
"""Vertices where the outline turns by less are part of a smooth side [rad]."""
SHARPEST = np.deg2rad(25.0)
"""Outlines with a corner sharper or blunter (180 degrees less this) are left to triangles [rad]."""


def corners_of(outline: Array) -> Array | None:
    """Return the indices of the four corners of an outline (n, 2), or None where it is not a quadrilateral."""
    before, after = outline - np.roll(outline, 1, axis=0), np.roll(outline, -1, axis=0) - outline
    turn = turning(before, after)
    corners = np.flatnonzero(np.abs(turn) >= CORNER)
    if len(corners) != 4:
        return None
    p = outline[corners]
    p_before, p_after = p - np.roll(p, 1, axis=0), np.roll(p, -1, axis=0) - p
    inner = np.pi - np.concatenate([turn[corners], turning(p_before, p_after)])
    if (inner < SHARPEST).any() or (inner > np.pi - SHARPEST).any():
        return None
    return corners


def mapped_quads(outline: Array, corners: Array, marks: list[Array], size: float) -> tuple[Array, Array] | None:
    """Return points (n, 2) and quadrilaterals (k, 4), or None where the patch folds.

    Parameters
    ----------
    outline : (n, 2) array
        Counter-clockwise [m].
    corners : (4,) array
        Indices of its corners.
    marks : list of (k,) arrays
        For each edge of the outline, distances from its first vertex that must be nodes, with 0 and its length [m].
    size : float
        Largest span between nodes along the sides [m].
    """
    n = len(outline)
    sides: list[tuple[Array, Array]] = []
    for c, d in zip(corners, np.roll(corners, -1), strict=True):
        chain = [int(k % n) for k in range(c, d if d > c else d + n)]
        points, at, run = [], [], 0.0
        for e in chain:
            a, b = outline[e], outline[(e + 1) % n]
            length = float(np.hypot(*(b - a)))
            points += [a + (b - a) * (m / length) for m in marks[e][:-1]]
            at += [run + m for m in marks[e][:-1]]
            run += length
        points.append(outline[int(d)])
        sides.append((np.array(points), np.array([*at, run]) / run))
    bottom, right = sides[0], sides[1]
    top, left = ((points[::-1], 1 - f[::-1]) for points, f in (sides[2], sides[3]))
    lengths = [float(np.hypot(*np.diff(points, axis=0).T).sum()) for points, _ in sides]
    f, g = _paired(bottom[1], top[1], lengths[0], lengths[2], size)
    h, k = _paired(left[1], right[1], lengths[3], lengths[1], size)
    (fi, hj), (gi, kj) = np.meshgrid(f, h), np.meshgrid(g, k)
    u = (fi + (gi - fi) * hj) / (1 - (gi - fi) * (kj - hj))
    v = (hj + (kj - hj) * u)[..., None]
    u = u[..., None]
    sw, se, ne, nw = outline[corners]
    patch = (
        (1 - v) * _on(bottom, f)[None] + v * _on(top, g)[None] + (1 - u) * _on(left, h)[:, None]
        + u * _on(right, k)[:, None] - (1 - u) * (1 - v) * sw - u * (1 - v) * se - u * v * ne - (1 - u) * v * nw
    )  # fmt: skip
    patch[0], patch[-1], patch[:, 0], patch[:, -1] = _on(bottom, f), _on(top, g), _on(left, h), _on(right, k)
    nx, ny = len(f), len(h)
    points = patch.reshape(-1, 2)
    i, j = np.meshgrid(np.arange(nx - 1), np.arange(ny - 1))
    first = (j * nx + i).ravel()
    cells = np.column_stack([first, first + 1, first + nx + 1, first + nx])
    x = points[cells]
    ahead, back = np.roll(x, -1, axis=1) - x, np.roll(x, 1, axis=1) - x
    turn = cross(ahead, back)
    if (turn <= 0.02 * np.hypot(*ahead.transpose(2, 0, 1)) * np.hypot(*back.transpose(2, 0, 1))).any():
        return None
    return points, cells


def _on(side: tuple[Array, Array], fraction: Array) -> Array:
    """Return the points (k, 2) of a side at fractions of its length; exact at its marks."""
    points, at = side
    return np.stack([np.interp(fraction, at, points[:, 0]), np.interp(fraction, at, points[:, 1])], 1)


def _paired(p: Array, q: Array, length_p: float, length_q: float, size: float) -> tuple[Array, Array]:
    """Return equally many increasing fractions of two opposite sides, holding the marks of each.

    Marks of the two sides are partners where they are nearest to each other and closer than a third of ``size``.
    """
    close = 0.34 * size / max(length_p, length_q)
    inner_p, inner_q = p[1:-1], q[1:-1]
    pairs: list[tuple[float, float]] = [(0.0, 0.0), (1.0, 1.0)]
    alone_q = np.ones(len(inner_q), dtype=bool)
    for value in inner_p:
        partner = value
        if len(inner_q):
            nearest = int(np.argmin(np.abs(inner_q - value)))
            mutual = np.abs(inner_p - inner_q[nearest]).min() >= abs(value - inner_q[nearest])
            if mutual and alone_q[nearest] and abs(inner_q[nearest] - value) <= close:
                partner, alone_q[nearest] = inner_q[nearest], False
        pairs.append((float(value), float(partner)))
    pairs += [(float(value), float(value)) for value in inner_q[alone_q]]
    pairs = _monotone(sorted(pairs), inner_p, inner_q)
    f, g = np.array(pairs).T
    fs, gs = [np.zeros(1)], [np.zeros(1)]
    for a, b, c, d in zip(f[:-1], f[1:], g[:-1], g[1:], strict=True):
        parts = max(1, int(np.ceil(max((b - a) * length_p, (d - c) * length_q) / size - 1e-6)))
        steps = np.arange(1, parts + 1) / parts
        fs.append(np.where(steps == 1, b, a + (b - a) * steps))
        gs.append(np.where(steps == 1, d, c + (d - c) * steps))
    return np.concatenate(fs), np.concatenate(gs)


def _monotone(pairs: list[tuple[float, float]], p: Array, q: Array) -> list[tuple[float, float]]:
    """Return the pairs with the invented partners moved where they would cross a given mark."""
    given_p, given_q = {0.0, 1.0, *p.tolist()}, {0.0, 1.0, *q.tolist()}
    f, g = (np.array(v) for v in zip(*pairs, strict=True))
    for values, given in ((f, given_p), (g, given_q)):
        fixed = [k for k, v in enumerate(values) if v in given]
        for a, b in pairwise(fixed):
            inner = values[a + 1 : b]
            if len(inner) and (np.diff(values[a : b + 1]) <= 1e-9).any():
                values[a + 1 : b] = values[a] + (values[b] - values[a]) * np.arange(1, b - a) / (b - a)
    return list(zip(f.tolist(), g.tolist(), strict=True))
