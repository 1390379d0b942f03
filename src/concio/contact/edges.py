"""The outlines of all bodies as flat arrays that move with them.

What is evaluated in every step of a motion is a handful of array operations. The exterior is to the right of edges.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from concio.kinematics.frames import cross
from concio.kinematics.placement import Placement
from concio.model.interfaces.facing import Edges
from concio.model.model import Body

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class PlacedEdges:
    """Edges where they are: ends and unit tangent of each (e, 2)."""

    start: Array
    end: Array
    tangent: Array


@dataclass(frozen=True, eq=False)
class MovingEdges:
    """Edges of all bodies in the frames of their bodies, relative to the centroids.

    Parameters
    ----------
    body : (e,) integer array
    number : (e,) integer array
        Number of each edge in its outline.
    start, end, tangent : (e, 2) arrays
        Relative to the centroid, as described.
    length : (e,) array
        [m].
    before : (e,) integer array
        Edge that ends where this one starts.
    convex : (e,) boolean array
        Whether the corner at the start stands out, so that it can touch other bodies.
    fixed : (e,) boolean array
        Edges of bodies that do not move freely.
    width : (B,) array
        Mean width of each body, twice its area over its perimeter [m].
    """

    body: Array
    number: Array
    start: Array
    end: Array
    tangent: Array
    length: Array
    before: Array
    convex: Array
    fixed: Array
    width: Array

    @classmethod
    def of(cls, bodies: Sequence[Body]) -> MovingEdges:
        """Return the edges of bodies."""
        edges = Edges.of(bodies)
        centroid = np.array([b.centroid for b in bodies])
        length = np.hypot(*(edges.end - edges.start).T)
        at = {(b, *p): e for e, (b, p) in enumerate(zip(edges.body.tolist(), edges.end.tolist(), strict=True))}
        before = np.array([at[b, *p] for b, p in zip(edges.body.tolist(), edges.start.tolist(), strict=True)])
        convex = cross(edges.tangent[before], edges.tangent) > 1e-9
        around = np.bincount(edges.body, length, len(bodies))
        width = 2 * np.array([b.area for b in bodies]) / around
        arm = centroid[edges.body]
        return cls(
            edges.body, edges.number, edges.start - arm, edges.end - arm, edges.tangent, length, before, convex,
            edges.fixed, width,
        )  # fmt: skip

    @property
    def counts(self) -> tuple[int]:
        """Number of edges."""
        return (len(self.body),)

    def numbers(self, bodies: Array) -> tuple[Array]:
        """Return the numbers of the edges of some bodies."""
        return (np.flatnonzero(np.isin(self.body, bodies)),)

    def placed(self, placement: Placement) -> PlacedEdges:
        """Return the edges of bodies that stand elsewhere."""
        c, turn = placement.centre[self.body], placement.turns[self.body]
        return PlacedEdges(c + turn.apply(self.start), c + turn.apply(self.end), turn.apply(self.tangent))

    def as_edges(self, placed: PlacedEdges) -> Edges:
        """Return placed edges in the form in which interfaces are looked for."""
        return Edges(placed.start, placed.end, placed.tangent, self.body, self.number, self.fixed)
