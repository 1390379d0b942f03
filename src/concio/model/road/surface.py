"""The faces of a plane model that look up to the fill, and the road line above them."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from concio.errors import InputError
from concio.model.fill import Fill
from concio.model.model import Model
from concio.representation import short_repr

Array = np.ndarray

NARROW = 1e-9
"""Faces narrower than this share of the structure are left out."""


@short_repr
@dataclass(frozen=True, eq=False)
class Surface:
    """Upper faces of the bodies from left to right, n pieces of straight line.

    Parameters
    ----------
    body : (n,) integer array
    start, end : (n, 2) arrays
        Left and right end of each piece [m].
    edge : (n,) integer array
        Number of the edge of the outline that the piece lies on.
    """

    body: Array
    start: Array
    end: Array
    edge: Array

    def __len__(self) -> int:
        return len(self.body)

    @classmethod
    def of(cls, model: Model) -> Surface:
        """Return the upper faces of a plane model."""
        bodies, edges, start, end = _looking_up(model)
        x = np.unique(np.concatenate([start[:, 0], end[:, 0]]))
        x = x[np.concatenate([[True], np.diff(x) > NARROW * model.size])]
        slope = (end[:, 1] - start[:, 1]) / (end[:, 0] - start[:, 0])
        low = np.searchsorted(x, start[:, 0] + NARROW * model.size, side="right") - 1
        high = np.searchsorted(x, end[:, 0] - NARROW * model.size, side="left")
        middle = 0.5 * (x[1:] + x[:-1])
        top, found = np.full(len(middle), -np.inf), np.full(len(middle), -1)
        for k in range(len(start)):
            part = slice(max(int(low[k]), 0), int(high[k]))
            y = start[k, 1] + slope[k] * (middle[part] - start[k, 0])
            higher = y > top[part]
            top[part] = np.where(higher, y, top[part])
            found[part] = np.where(higher, k, found[part])
        pieces = [i for i in range(len(middle)) if found[i] >= 0]
        own = found[pieces]
        left, right = x[:-1][pieces], x[1:][pieces]
        at = [np.column_stack([v, start[own, 1] + slope[own] * (v - start[own, 0])]) for v in (left, right)]
        return cls(bodies[own], at[0], at[1], edges[own])._joined()

    def _joined(self) -> Surface:
        """Return the same with neighbouring pieces of one edge made one."""
        first = np.ones(len(self), dtype=bool)
        first[1:] = (np.diff(self.body) != 0) | (np.diff(self.edge) != 0)
        first[1:] |= np.abs(self.start[1:, 0] - self.end[:-1, 0]) > 0
        begin = np.flatnonzero(first)
        last = np.append(begin[1:], len(self)) - 1
        return Surface(self.body[begin], self.start[begin], self.end[last], self.edge[begin])

    @cached_property
    def crown(self) -> Array:
        """The highest point (2,) [m]; of several that are alike their middle."""
        points = np.vstack([self.start, self.end])
        high = points[points[:, 1] >= points[:, 1].max() - 1e-9 * np.ptp(points[:, 0])]
        return np.array([0.5 * (high[:, 0].min() + high[:, 0].max()), high[:, 1].max()])

    @property
    def reach(self) -> tuple[float, float]:
        """Where the surface begins and ends [m]."""
        return float(self.start[:, 0].min()), float(self.end[:, 0].max())

    def height(self, x: Array) -> Array:
        """Return the height of the surface [m] at places x; nan beside it."""
        x = np.asarray(x, dtype=float)
        k = np.clip(np.searchsorted(self.start[:, 0], x, side="right") - 1, 0, len(self) - 1)
        share = (x - self.start[k, 0]) / (self.end[k, 0] - self.start[k, 0])
        y = self.start[k, 1] + share * (self.end[k, 1] - self.start[k, 1])
        return np.where((share < -1e-9) | (share > 1 + 1e-9), np.nan, y)


@dataclass(frozen=True, eq=False)
class Road:
    """A road line (n, 2) from left to right [m], and the line ``under`` its surfacing (k, 2), which may be none."""

    line: Array
    under: Array = field(default_factory=lambda: np.zeros((0, 2)))

    @classmethod
    def of(cls, fill: Fill, surface: Surface) -> Road:
        """Return the road line of a fill, which must lie above the masonry everywhere.

        Raises
        ------
        InputError
            It ends before the masonry does, or lies below it; the masonry has a gap under it that is wider than the
            fill there is deep; or layers are thicker than the cover.
        """
        left, right = surface.reach
        if fill.road:
            line = np.array(fill.road, dtype=float)
            if line[0, 0] > left + 1e-6 * (right - left) or line[-1, 0] < right - 1e-6 * (right - left):
                msg = f"the road line runs from {line[0, 0]:g} to {line[-1, 0]:g} m, the masonry below it from "
                msg += f"{left:g} to {right:g} m"
                raise InputError(msg, where="fill", hint="let the road line run over the whole bridge")
        else:
            crown = surface.crown
            height = crown[1] + float(fill.cover or 0.0)
            line = np.array([[x, height + fill.gradient * (x - crown[0])] for x in (left, right)])
        road = cls(line)
        places = np.vstack([surface.start, surface.end])
        inside = line[(line[:, 0] > left) & (line[:, 0] < right)]
        depth = road.height(places[:, 0]) - places[:, 1]
        depth = np.concatenate([depth, inside[:, 1] - surface.height(inside[:, 0])])
        where = np.concatenate([places[:, 0], inside[:, 0]])
        k = int(np.nanargmin(depth))
        if not depth[k] > 0:
            msg = f"the road lies {-depth[k]:.3g} m below the masonry at x = {where[k]:.3g} m"
            raise InputError(msg, where="fill", hint="raise the road line, or the cover where there is a gradient")
        _refuse_gaps(surface, road)
        layers = sum(layer.depth for layer in fill.layers)
        if layers > depth[k] + 1e-9:
            msg = f"the layers are {layers:.3g} m deep, the cover at x = {where[k]:.3g} m is {depth[k]:.3g} m"
            raise InputError(msg, where="fill", hint="cover is measured from the road, with surfacing and ballast")
        return cls(line, _checked_line(fill, surface, road)) if fill.fill_line else road

    def over(self, surface: Surface) -> tuple[float, float]:
        """Where the road runs over a surface [m]; what stands on it further out does not reach that."""
        low, high = surface.reach
        return max(low, float(self.line[0, 0])), min(high, float(self.line[-1, 0]))

    def surfacing(self, x: Array) -> Array:
        """Return the depth of the surfacing [m] at places x: zero where no line is under it."""
        if not len(self.under):
            return np.zeros(np.shape(x))
        found: Array = self.height(x) - np.interp(x, self.under[:, 0], self.under[:, 1])
        return found

    def height(self, x: Array) -> Array:
        """Return the height of the road [m] at places x."""
        found: Array = np.interp(x, self.line[:, 0], self.line[:, 1])
        return found


def _refuse_gaps(surface: Surface, road: Road) -> None:
    """Refuse masonry of which nothing carries the road between two places: a structure beside the bridge, say."""
    ends, starts = surface.end[:-1], surface.start[1:]
    gap = starts[:, 0] - ends[:, 0]
    deep = [road.height(p[:, 0]) - p[:, 1] for p in (ends, starts)]
    wide = np.flatnonzero(gap > np.maximum(np.minimum(*deep), 0.0))
    if len(wide):
        k = int(wide[np.argmax(gap[wide])])
        msg = f"nothing lies below the road from x = {ends[k, 0]:.4g} to {starts[k, 0]:.4g} m"
        hint = "draw the ground between, or leave out what does not belong to the bridge"
        raise InputError(msg, where="fill", hint=hint)


def _checked_line(fill: Fill, surface: Surface, road: Road) -> Array:
    """Return the line under the surfacing, which lies between masonry and road over the whole bridge."""
    under = np.array(fill.fill_line, dtype=float)
    left, right = surface.reach
    near = 1e-6 * (right - left)
    if under[0, 0] > left + near or under[-1, 0] < right - near:
        msg = f"the fill line runs from {under[0, 0]:g} to {under[-1, 0]:g} m, the masonry below it from {left:g} to "
        msg += f"{right:g} m"
        raise InputError(msg, where="fill", hint="let the fill line run over the whole bridge")
    x = np.unique(np.concatenate([surface.start[:, 0], surface.end[:, 0], under[:, 0], road.line[:, 0]]))
    x = x[(x >= left) & (x <= right)]
    y = np.interp(x, under[:, 0], under[:, 1])
    for name, beyond in (("above the road", y - road.height(x)), ("below the masonry", surface.height(x) - y)):
        k = int(np.nanargmax(beyond))
        if beyond[k] > near:
            msg = f"the fill line lies {beyond[k]:.3g} m {name} at x = {x[k]:.3g} m"
            raise InputError(msg, where="fill", hint="it is the line between fill and surfacing")
    return under


def _looking_up(model: Model) -> tuple[Array, Array, Array, Array]:
    """Return body, edge, left end and right end of all edges that look up (outlines run counter-clockwise)."""
    bodies, edges, start, end = [], [], [], []
    for b, body in enumerate(model.outlines):
        p, q = body.outline, np.roll(body.outline, -1, axis=0)
        up = np.flatnonzero(p[:, 0] - q[:, 0] > NARROW * model.size)  # the body lies to the left of every side
        bodies.append(np.full(len(up), b))
        edges.append(up)
        start.append(q[up])
        end.append(p[up])
    return np.concatenate(bodies), np.concatenate(edges), np.concatenate(start), np.concatenate(end)
