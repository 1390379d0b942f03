"""Candidates for contact: edges that face each other and corners near edges, looked for with a skin.

The search costs about as much as there are bodies (an R-tree of the edges' boxes, grown by a skin) and holds until a
corner has moved by half the skin; between two searches only the distances of the candidates are worked out again.

Where two edges face each other within :data:`FACING`, both ends of their common length are contact points, each of
them a corner of one body on the edge of the other. Corners whose own edges face nothing (a block standing on its
corner) are candidates by themselves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from concio.contact.edges import MovingEdges, PlacedEdges
from concio.contact.laws import RuleBook
from concio.kinematics.frames import dot, turned_right
from concio.model.interfaces.facing import facing_pairs

Array = np.ndarray

FACING = np.deg2rad(45.0)
"""Edges turned against each other by less than this share a length whose two ends touch [rad]."""

THROUGH = 0.1
"""Edges that have entered another body by more than this share of the narrower body's width stand behind it."""

CRUSHED = 0.5
"""The same where joints crush."""


@dataclass(frozen=True, eq=False)
class Candidates:
    """What may touch until a corner has moved by half the skin.

    Parameters
    ----------
    edge_a, edge_b : (f,) integer arrays
        Edges that face each other, the body of a before that of b.
    corner, edge : (q,) integer arrays
        Corners, by the edge that starts there, and the edges they may touch.
    """

    edge_a: Array
    edge_b: Array
    corner: Array
    edge: Array


def find_candidates(
    edges: MovingEdges, placed: PlacedEdges, skin: float, through: float = THROUGH, rules: RuleBook | None = None
) -> Candidates:
    """Return the candidates of placed edges.

    Parameters
    ----------
    edges : MovingEdges
    placed : PlacedEdges
    skin : float
        Distance within which edges are candidates [m].
    through : float
        Depth over the narrower body's width beyond which edges stand behind each other.
    rules : RuleBook, optional
        Say by which initial openings edges may stand deeper; none without.
    """
    near = np.full(len(edges.width), skin)
    facing = facing_pairs(edges.as_edges(placed), near, -near, FACING)
    narrow = edges.width[facing.bodies].min(1)
    deep = through * narrow + (0.0 if rules is None else rules.openings(*facing.bodies.T))
    keep = (facing.g_min <= 2 * skin) & (facing.g_max >= -deep)
    a, b = facing.edges[keep].T
    corner, edge = _corners(edges, placed, skin, rules, a, b)
    return Candidates(a, b, corner, edge)


def _corners(
    edges: MovingEdges, placed: PlacedEdges, skin: float, rules: RuleBook | None, a: Array, b: Array
) -> tuple[Array, Array]:
    """Return corners near edges that neither of their own edges faces."""
    corners = np.flatnonzero(edges.convex)
    reach = skin + (0.0 if rules is None else rules.widest)
    low, high = np.minimum(placed.start, placed.end) - reach, np.maximum(placed.start, placed.end) + reach
    points = shapely.points(placed.start[corners])
    found, near = shapely.STRtree(shapely.box(*low.T, *high.T)).query(points)
    corner, edge = corners[found], near
    keep = (edges.body[corner] != edges.body[edge]) & ~(edges.fixed[corner] & edges.fixed[edge])
    corner, edge = corner[keep], edge[keep]
    outward = turned_right(placed.tangent[edge])
    distance = dot(placed.start[corner] - placed.start[edge], outward)
    back, ahead = -placed.tangent[edges.before[corner]], placed.tangent[corner]
    faces = (dot(back, outward) > -0.1) & (dot(ahead, outward) > -0.1)
    deep = 2 * skin + (0.0 if rules is None else rules.openings(edges.body[corner], edges.body[edge]))
    faces &= (distance <= 2 * skin) & (distance >= -deep)
    corner, edge = corner[faces], edge[faces]
    count = len(edges.body)
    covered = np.concatenate([a * count + b, b * count + a])
    own = np.isin(corner * count + edge, covered) | np.isin(edges.before[corner] * count + edge, covered)
    return corner[~own], edge[~own]
