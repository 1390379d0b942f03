"""A picture with a depth at every point: triangles and lines, each point showing what is nearest to the eye."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

Array = np.ndarray

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
    colour : (h, w, 3) array
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
    def of(cls, box: Array, axes: Array) -> Picture:
        """Return an empty picture of the box ((x0, y0), (x1, y1)) [m]."""
        span = box[1] - box[0]
        step = float(span.max()) / LONGER_SIDE
        width, height = (max(1, int(np.ceil(s / step))) for s in span)
        return cls(box[0], step, axes, np.ones((height, width, 3)), np.full((height, width), -np.inf))

    def placed(self, points: Array) -> Array:
        """Return points (..., 3) in units of the picture: to the right, up, and their depth [m]."""
        seen = points @ self.axes.T
        return np.concatenate([(seen[..., :2] - self.low) / self.step, seen[..., 2:]], axis=-1)

    def fill(self, triangles: Array, colours: Array) -> None:
        """Draw triangles (t, 3, 3) in colours (t, 3)."""
        height, width = self.depth.shape
        for (a, b, c), colour in zip(self.placed(triangles), colours, strict=True):
            x0, x1 = max(0, int(min(a[0], b[0], c[0]))), min(width - 1, int(max(a[0], b[0], c[0])) + 1)
            y0, y1 = max(0, int(min(a[1], b[1], c[1]))), min(height - 1, int(max(a[1], b[1], c[1])) + 1)
            whole = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
            if x0 > x1 or y0 > y1 or whole == 0.0:
                continue
            x, y = np.arange(x0, x1 + 1) + 0.5, (np.arange(y0, y1 + 1) + 0.5)[:, None]
            s = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / whole
            t = ((y - a[1]) * (b[0] - a[0]) - (x - a[0]) * (b[1] - a[1])) / whole
            depth = a[2] + s * (b[2] - a[2]) + t * (c[2] - a[2])
            held = self.depth[y0 : y1 + 1, x0 : x1 + 1]
            nearer = (s >= 0) & (t >= 0) & (s + t <= 1) & (depth > held)
            held[nearer] = depth[nearer]
            self.colour[y0 : y1 + 1, x0 : x1 + 1][nearer] = colour

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
                self.colour[y[seen], x[seen]] = colour

    def image(self) -> Array:
        """Return the picture (h, w, 4) in bytes, rows from above, clear where there is nothing."""
        alpha = np.isfinite(self.depth) | (self.colour < 1).any(axis=2)
        image = np.concatenate([self.colour, alpha[:, :, None]], axis=2)[::-1]
        return np.asarray(np.rint(255 * image).astype(np.uint8))
