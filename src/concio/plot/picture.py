"""A picture with a depth at every point: triangles and lines, each point showing what is nearest to the eye."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from concio.kinematics.frames import cross

Array = np.ndarray

MOST_POINTS = 200_000
"""Points of triangles that are examined together."""

LONGER_SIDE = 2000
"""Points along the longer side of a picture; it is drawn at this size and shown at about half of it."""


@dataclass(frozen=True, eq=False)
class Picture:
    """A picture, h x w points.

    Parameters
    ----------
    low : (2,) array
        Lower left corner [m].
    step : float
        Size of a point [m].
    axes : (3, 3) array
        Unit vectors to the right, up, and towards the eye.
    colour : (h, w, 3) array of bytes
        Rows from below.
    depth : (h, w) array
        Distance towards the eye of what is shown, minus infinity where there is nothing [m].
    """

    low: Array
    step: float
    axes: Array
    colour: Array
    depth: Array

    @classmethod
    def of(cls, box: Array, axes: Array, longer: int | None = None) -> Picture:
        """Return an empty picture of the box ((x0, y0), (x1, y1)) [m], ``longer`` points along its longer side."""
        span = box[1] - box[0]
        step = float(span.max()) / (longer or LONGER_SIDE)
        width, height = (max(1, int(np.ceil(s / step))) for s in span)
        white = np.full((height, width, 3), 255, dtype=np.uint8)
        return cls(box[0], step, axes, white, np.full((height, width), -np.inf))

    def placed(self, points: Array) -> Array:
        """Return points (..., 3) in units of the picture: to the right, up, and their depth [m]."""
        seen = points @ self.axes.T
        return np.concatenate([(seen[..., :2] - self.low) / self.step, seen[..., 2:]], axis=-1)

    def fill(self, triangles: Array, colours: Array) -> None:
        """Draw triangles (t, 3, 3) in colours (t, 3), those of one size together."""
        placed, colours = self.placed(triangles), _bytes(colours)
        height, width = self.depth.shape
        limit = np.array([width, height]) - 1
        low = np.clip(np.floor(placed[..., :2].min(1)).astype(int), 0, limit)
        span = np.clip(placed[..., :2].max(1).astype(int) + 1, 0, limit) - low + 1
        outside = (placed[..., :2].max(1) < 0).any(1) | (placed[..., :2].min(1) > limit + 1).any(1)
        a, ab, ac = placed[:, 0], placed[:, 1] - placed[:, 0], placed[:, 2] - placed[:, 0]
        whole = cross(ab[:, :2], ac[:, :2])
        size = 1 << np.ceil(np.log2(span)).astype(int)  # (t, 2): boxes a power of two wide and high
        drawn = np.flatnonzero(~outside & (whole != 0.0))
        kinds, kind = np.unique(size[drawn], axis=0, return_inverse=True)
        for number, (wide, high) in enumerate(kinds.tolist()):
            own = drawn[kind.ravel() == number]
            for part in np.array_split(own, -(-len(own) * wide * high // MOST_POINTS)):
                self._fill(part, (a, ab, ac, whole), low, span, (wide, high), colours)

    def _fill(
        self, part: Array, shape: tuple[Array, ...], low: Array, span: Array, box: tuple[int, int], colours: Array
    ) -> None:
        """Draw the triangles ``part``, each within a box of so many points from its lower left corner."""
        a, ab, ac, whole = (v[part] for v in shape)
        column, row = np.meshgrid(np.arange(box[0]), np.arange(box[1]))
        within = (column < span[part, 0, None, None]) & (row < span[part, 1, None, None])
        x = column + (low[part, 0] + 0.5 - a[:, 0])[:, None, None]
        y = row + (low[part, 1] + 0.5 - a[:, 1])[:, None, None]
        p, q, r, t, z = (v[:, None, None] for v in (ab[:, 0], ab[:, 1], ac[:, 0], ac[:, 1], whole))
        first, second = (x * t - y * r) / z, (y * p - x * q) / z
        inside = within & (first >= 0) & (second >= 0) & (first + second <= 1)
        k, j, i = np.nonzero(inside)
        depth = a[k, 2] + first[inside] * ab[k, 2] + second[inside] * ac[k, 2]
        at = (low[part[k], 1] + j) * self.depth.shape[1] + low[part[k], 0] + i
        held = self.depth.reshape(-1)
        nearer = depth > held[at]
        k, at, depth = k[nearer], at[nearer], depth[nearer]
        np.maximum.at(held, at, depth)
        shown = np.flatnonzero(depth == held[at])[::-1]  # of equals the first
        self.colour.reshape(-1, 3)[at[shown]] = colours[part[k[shown]]]

    def stroke(self, lines: Array, colour: Any, wide: int, slack: float) -> None:
        """Draw lines (l, 2, 3) ``wide`` points thick, wherever nothing is nearer by more than ``slack`` [m]."""
        ends = self.placed(lines)
        parts = np.maximum(np.ceil(np.abs(ends[:, 1, :2] - ends[:, 0, :2]).max(axis=1) * 1.5), 1).astype(int)
        which = np.repeat(np.arange(len(ends)), parts + 1)
        first = np.repeat(np.cumsum(parts + 1) - (parts + 1), parts + 1)
        share = ((np.arange(len(which)) - first) / parts[which])[:, None]
        at = ends[which, 0] + share * (ends[which, 1] - ends[which, 0])
        height, width = self.depth.shape
        for dx in range(wide):
            for dy in range(wide):
                x, y = (at[:, 0] + dx - 0.5 * (wide - 1)).astype(int), (at[:, 1] + dy - 0.5 * (wide - 1)).astype(int)
                inside = (x >= 0) & (x < width) & (y >= 0) & (y < height)
                x, y, depth = x[inside], y[inside], at[inside, 2]
                seen = depth >= self.depth[y, x] - slack
                self.colour[y[seen], x[seen]] = _bytes(colour)

    def points_of(self, colour: Any) -> int:
        """Return on how many points a colour of areas is seen."""
        from matplotlib.colors import to_rgb

        return int((self.colour == _bytes(to_rgb(colour))).all(axis=2).sum())

    def image(self) -> Array:
        """Return the picture (h, w, 4) in bytes, rows from above, clear where there is nothing."""
        alpha = np.isfinite(self.depth) | (self.colour < 255).any(axis=2)
        return np.dstack([self.colour, np.where(alpha, np.uint8(255), np.uint8(0))])[::-1]


def _bytes(colour: Any) -> Array:
    return np.asarray(np.rint(255 * np.asarray(colour)).astype(np.uint8))
