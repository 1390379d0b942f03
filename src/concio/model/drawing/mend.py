"""Mending of outlines drawn with small gaps: corners that nearly meet are moved together.

1. Corners closer to each other than the diagonal of the tolerance (they may be off by it along a joint and across it)
   become one point, the mean of where they were drawn: nearest ones first, and only as long as none of them moves by
   more than the tolerance. So a row of close corners is put together in groups, and never runs together as a whole.
2. A point closer than the tolerance to a side of another outline moves onto it (T-joints).

Both are repeated until nothing moves, since a side turns when its ends do. What is left apart is further apart than the
tolerance, so no joint between two corners is much shorter than it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from concio.model.linked import pairs_within
from concio.model.model import Array

SWEEPS = 6
"""Most rounds of the two steps."""
STILL = 1e-3
"""Points that move by less than this share of the tolerance are at rest."""
DRIFT = 2.0
"""No corner ends further from where it was drawn than this many tolerances."""


@dataclass(frozen=True, eq=False)
class Move:
    """A corner that was moved: number of its outline, where it was drawn and where it went (2,) [m]."""

    outline: int
    start: Array
    end: Array

    @property
    def length(self) -> float:
        """How far it went [m]."""
        return float(np.hypot(*(self.end - self.start)))


def mended(outlines: Sequence[Array], tolerance: float) -> tuple[list[Array], tuple[Move, ...]]:
    """Return the outlines (n, 2) with corners that nearly meet put together, and every move.

    Parameters
    ----------
    outlines : sequence of (n, 2) arrays
        [m].
    tolerance : float
        [m].

    Returns
    -------
    outlines : list of (n, 2) arrays
        Corners that fell on the one before are left out.
    moves : tuple of Move
        Of corners that moved at all, in the order of the outlines.
    """
    if not len(outlines):
        return [], ()
    counts = np.array([len(o) for o in outlines])
    drawn = np.concatenate(outlines)
    owner = np.repeat(np.arange(len(outlines)), counts)
    groups = _Groups(drawn, owner, counts, tolerance)
    for _ in range(SWEEPS):
        before = groups.points.copy()
        groups.join()
        groups.move_onto_sides()
        if np.hypot(*(groups.points - before).T).max() <= STILL * tolerance:
            break
    points = groups.points
    far = np.flatnonzero(np.hypot(*(points - drawn).T) > 1e-9 * tolerance)
    moves = tuple(Move(int(owner[k]), drawn[k], points[k]) for k in far)
    return [_without_repeats(o) for o in np.split(points, np.cumsum(counts)[:-1])], moves


def _without_repeats(outline: Array) -> Array:
    """Return an outline without vertices equal to the one before."""
    kept: Array = outline[(outline != np.roll(outline, 1, axis=0)).any(1)]
    return kept


class _Groups:
    """Corners put together in groups, each at one point.

    Parameters
    ----------
    drawn : (n, 2) array
        Where the corners were drawn [m].
    owner : (n,) integer array
        Outline of each.
    counts : (o,) integer array
        Corners of each outline.
    tolerance : float
        [m].
    """

    def __init__(self, drawn: Array, owner: Array, counts: Array, tolerance: float) -> None:
        self.drawn, self.owner, self.tolerance = drawn, owner, tolerance
        self.points = drawn.copy()
        self.group = np.arange(len(drawn))
        self.members = {k: [k] for k in range(len(drawn))}
        first = np.concatenate([[0], np.cumsum(counts)[:-1]])
        self.following = np.arange(len(drawn)) + 1
        self.following[first + counts - 1] = first

    def join(self) -> None:
        """Put together corners within the diagonal of the tolerance, nearest first, while none moves too far."""
        near = pairs_within(self.points, np.sqrt(2.0) * self.tolerance)
        apart = np.hypot(*(self.points[near[:, 0]] - self.points[near[:, 1]]).T)
        order = np.lexsort([near[:, 1], near[:, 0], apart])
        for i, j in near[order].tolist():
            p, q = int(self.group[i]), int(self.group[j])
            if p == q:
                continue
            together = self.members[p] + self.members[q]
            if not self._may_meet(self.members[p], self.members[q]):
                continue
            mean = self.drawn[together].mean(0)
            if np.hypot(*(self.drawn[together] - mean).T).max() > self.tolerance:
                continue
            self.members[p] = together
            del self.members[q]
            self.group[together] = p
            self.points[together] = mean

    def _may_meet(self, one: list[int], other: list[int]) -> bool:
        """Tell whether no outline would touch itself: of one outline only neighbours meet."""
        for i in one:
            for j in other:
                if self.owner[i] == self.owner[j] and self.following[i] != j and self.following[j] != i:
                    return False
        return True

    def move_onto_sides(self) -> None:
        """Move groups near a side of another outline onto it."""
        points = self.points
        some = np.flatnonzero((points != points[self.following]).any(1))
        sides = shapely.linestrings(np.stack([points[some], points[self.following[some]]], 1))
        vertex, side = shapely.STRtree(sides).query(
            shapely.points(points), predicate="dwithin", distance=self.tolerance
        )
        side = some[side]
        keep = self.owner[vertex] != self.owner[side]
        for v, s in zip(vertex[keep].tolist(), side[keep].tolist(), strict=True):
            group = int(self.group[v])
            if group in (self.group[s], self.group[self.following[s]]):
                continue
            a, b = points[s], points[self.following[s]]
            along = b - a
            length = float(np.hypot(*along))
            share = float((points[v] - a) @ along) / length**2 if length else 0.0
            if not 0 < share < 1:
                continue
            foot = a + share * along
            own = self.members[group]
            if np.hypot(*(self.drawn[own] - foot).T).max() <= DRIFT * self.tolerance:
                points[own] = foot
