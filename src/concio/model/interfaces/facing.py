"""Pairs of edges that face each other: found with an R-tree, described on their mean direction, cut and clipped."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from concio.kinematics.frames import turned_right, turning
from concio.model.model import Array, Body


@dataclass(frozen=True, eq=False)
class Edges:
    """All edges of all bodies: ends (e, 2), unit tangent (e, 2), body (e,), number in the outline (e,)."""

    start: Array
    end: Array
    tangent: Array
    body: Array
    number: Array
    fixed: Array

    @classmethod
    def of(cls, bodies: Sequence[Body]) -> Edges:
        """Return the edges of all bodies, without those of length zero."""
        counts = np.array([len(b.vertices) for b in bodies])
        start = np.concatenate([b.vertices for b in bodies])
        first = np.concatenate([[0], np.cumsum(counts)[:-1]])
        following = np.concatenate([b.following + at for b, at in zip(bodies, first, strict=True)])
        body = np.repeat(np.arange(len(bodies)), counts)
        number = np.arange(len(start)) - first[body]
        end = start[following]
        length = np.hypot(*(end - start).T)
        some = length > 0
        fixed = np.array([b.kind == "fixed" for b in bodies])[body]
        start, end, body, number, fixed, length = (v[some] for v in (start, end, body, number, fixed, length))
        return cls(start, end, (end - start) / length[:, None], body, number, fixed)


@dataclass(frozen=True, eq=False)
class FacingPairs:
    """Pairs of edges that face each other, described on their mean direction.

    The common part runs from coordinate ``lo`` to ``hi`` along ``tangent``; there the edges of a and b are
    ``x(s) = foot + (s - s_foot) slope``; the gap is ``g_lo`` at lo and ``g_hi`` at hi.
    """

    edges: Array  # (p, 2) indices of edges
    bodies: Array  # (p, 2) indices of bodies
    tangent: Array  # (p, 2)
    angle: Array  # (p,)
    lo: Array
    hi: Array
    g_lo: Array
    g_hi: Array
    a_lo: Array  # (p, 2) point of edge a at lo
    a_hi: Array

    @property
    def normal(self) -> Array:
        """Unit normals from a to b (p, 2)."""
        return turned_right(self.tangent)

    @property
    def g_min(self) -> Array:
        """Smaller of the gaps at the two ends (p,)."""
        return np.asarray(np.minimum(self.g_lo, self.g_hi))

    @property
    def g_max(self) -> Array:
        """Larger of the gaps at the two ends (p,)."""
        return np.asarray(np.maximum(self.g_lo, self.g_hi))

    def chosen(self, which: Array) -> FacingPairs:
        """Return the pairs picked by a mask or by indices."""
        return FacingPairs(*(getattr(self, name)[which] for name in self.__dataclass_fields__))

    def cut(self, lo: Array, hi: Array) -> FacingPairs:
        """Return the pairs restricted to the intervals ``lo``, ``hi`` (p,) of their own coordinate."""
        span = self.hi - self.lo
        with np.errstate(invalid="ignore", divide="ignore"):
            p = np.where(span > 0, (lo - self.lo) / span, 0.0)
            q = np.where(span > 0, (hi - self.lo) / span, 0.0)
        slope_g, slope_a = self.g_hi - self.g_lo, self.a_hi - self.a_lo
        return FacingPairs(
            self.edges, self.bodies, self.tangent, self.angle, lo, hi,
            self.g_lo + p * slope_g, self.g_lo + q * slope_g,
            self.a_lo + p[:, None] * slope_a, self.a_lo + q[:, None] * slope_a,
        )  # fmt: skip

    def clipped(self, least: float, largest: Array) -> FacingPairs:
        """Return the pairs restricted to where the gap lies between ``least`` and ``largest`` (p,); may be empty."""
        slope = self.g_hi - self.g_lo
        flat = np.abs(slope) <= 1e-14 * (np.abs(self.g_hi) + np.abs(self.g_lo))
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            p, q = (least - self.g_lo) / slope, (largest - self.g_lo) / slope
        inside = (self.g_lo >= least) & (self.g_lo <= largest)
        p, q = np.where(flat, np.where(inside, 0.0, 1.0), p), np.where(flat, np.where(inside, 1.0, 0.0), q)
        p, q = np.where(flat, p, np.minimum(p, q)), np.where(flat, q, np.maximum(p, q))
        p, q = np.clip(p, 0, 1), np.clip(q, 0, 1)
        span = self.hi - self.lo
        return self.cut(self.lo + p * span, np.where(q >= 1, self.hi, self.lo + q * span))


def facing_pairs(edges: Edges, near: Array, shortest: Array, angle: float) -> FacingPairs:
    """Return the pairs of edges whose boxes come near, turned by less than ``angle``, with a common length.

    Parameters
    ----------
    edges : Edges
    near, shortest : (n,) arrays
        How far the boxes of each body reach, and the common length that counts with it, of two the smaller [m].
    angle : float
        [rad].
    """
    low, high = np.minimum(edges.start, edges.end), np.maximum(edges.start, edges.end)
    tree = shapely.STRtree(shapely.box(*low.T, *high.T))
    grown = near[edges.body][:, None]
    i, j = tree.query(shapely.box(*(low - grown).T, *(high + grown).T))
    keep = edges.body[i] < edges.body[j]
    i, j = i[keep], j[keep]
    ti, tj = edges.tangent[i], edges.tangent[j]
    keep = (-(ti * tj).sum(1) >= np.cos(angle)) & ~(edges.fixed[i] & edges.fixed[j])
    i, j, ti, tj = i[keep], j[keep], ti[keep], tj[keep]
    turned = np.abs(turning(ti, -tj))
    t = ti - tj
    t /= np.hypot(*t.T)[:, None]
    origin = edges.start[i]
    a1 = ((edges.end[i] - origin) * t).sum(1)
    b1, b0 = ((edges.start[j] - origin) * t).sum(1), ((edges.end[j] - origin) * t).sum(1)
    lo, hi = np.maximum(0.0, b0), np.minimum(a1, b1)
    keep = hi - lo > np.minimum(shortest[edges.body[i]], shortest[edges.body[j]])
    i, j, t, turned, origin, a1, b0, b1, lo, hi = (v[keep] for v in (i, j, t, turned, origin, a1, b0, b1, lo, hi))
    n = turned_right(t)
    end_i, b_first, b_last = edges.end[i] - origin, edges.end[j] - origin, edges.start[j] - origin

    def point_a(s: Array) -> Array:
        result: Array = (s / a1)[:, None] * end_i
        return result

    def gap(s: Array) -> Array:
        r = ((s - b0) / (b1 - b0))[:, None]
        result: Array = ((b_first + r * (b_last - b_first) - point_a(s)) * n).sum(1)
        return result

    bodies = np.stack([edges.body[i], edges.body[j]], 1)
    return FacingPairs(
        np.stack([i, j], 1), bodies, t, turned, lo, hi, gap(lo), gap(hi), origin + point_a(lo), origin + point_a(hi)
    )
