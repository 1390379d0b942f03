"""Points in polygons: as means of the corners, and the nearest ones to points outside."""

from __future__ import annotations

import numpy as np

from concio.kinematics.frames import turning

Array = np.ndarray

EDGE = 1e-12
"""Distance from a side, over the size of the polygon, within which a point lies on it."""


def polygon_weights(ring: Array, points: Array) -> Array:
    """Return weights (n, k) of the corners of a polygon (k, 2) whose means are points (n, 2) in it or on its boundary.

    Mean value coordinates (Floater, 2003): any polygon, linear on its sides, smooth inside.

    Examples
    --------
    >>> import numpy as np
    >>> from concio.contact.polygon_points import polygon_weights
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> polygon_weights(square, np.array([[0.5, 0.5], [0.25, 0.0]])).round(12).tolist()
    [[0.25, 0.25, 0.25, 0.25], [0.75, 0.25, 0.0, 0.0]]
    """
    k = len(ring)
    size = float(np.ptp(ring, axis=0).max())
    found = np.zeros((len(points), k))
    for i, point in enumerate(points):
        to, on = ring - point, _on_side(ring, point, EDGE * size)
        if on is not None:
            found[i, on[0]] += 1.0 - on[1]
            found[i, (on[0] + 1) % k] += on[1]
            continue
        far, ahead = np.linalg.norm(to, axis=1), np.roll(to, -1, axis=0)
        half = np.tan(0.5 * turning(to, ahead))
        weight = (np.roll(half, 1) + half) / far
        found[i] = weight / weight.sum()
    return found


def _on_side(ring: Array, point: Array, near: float) -> tuple[int, float] | None:
    """Return the side on which a point lies and where on it, 0 to 1; None where it lies on none."""
    along = np.roll(ring, -1, axis=0) - ring
    share = np.clip(((point - ring) * along).sum(axis=1) / (along**2).sum(axis=1), 0.0, 1.0)
    away = np.linalg.norm(ring + share[:, None] * along - point, axis=1)
    side = int(np.argmin(away))
    return (side, float(share[side])) if away[side] <= near else None


def nearest_inside(sides: Array, at: Array) -> Array:
    """Return points (n, 2) moved to the nearest ones of polygons with sides (n, s, 2, 2) where they lie outside."""
    beyond = outside(sides, at[:, 0], at[:, 1]) > 0
    if not beyond.any():
        return at
    start, along = sides[beyond, :, 0], sides[beyond, :, 1] - sides[beyond, :, 0]
    away, size = at[beyond, None] - start, (along**2).sum(axis=2)
    share = np.clip((away * along).sum(axis=2) / np.where(size > 0, size, 1.0), 0.0, 1.0)
    place = start + share[:, :, None] * along
    distance = np.where(size > 0, np.linalg.norm(at[beyond, None] - place, axis=2), np.inf)
    found = at.copy()
    found[beyond] = place[np.arange(len(place)), np.argmin(distance, axis=1)]
    return found


def outside(sides: Array, x: Array, y: Array) -> Array:
    """Return how far points (k,) lie outside polygons with sides (k, s, 2, 2), negative inside [m]."""
    p, d = sides[:, :, 0], sides[:, :, 1] - sides[:, :, 0]
    from_x, from_y = x[:, None] - p[..., 0], y[:, None] - p[..., 1]
    size = d[..., 0] ** 2 + d[..., 1] ** 2
    share = np.clip((from_x * d[..., 0] + from_y * d[..., 1]) / np.where(size > 0, size, 1.0), 0.0, 1.0)
    distance = np.hypot(from_x - share * d[..., 0], from_y - share * d[..., 1])
    distance = np.where(size > 0, distance, np.inf).min(axis=1)
    below, above = from_y < 0, y[:, None] - sides[:, :, 1, 1] < 0  # the same of the end that two sides share
    upward = np.where(d[..., 1] != 0, d[..., 1], 1.0)
    left = from_x < d[..., 0] * from_y / upward
    inside = ((below != above) & left).sum(axis=1) % 2 == 1
    return np.asarray(np.where(inside, -distance, distance))
