"""Mending of outlines drawn with small gaps: vertices that mean the same point are put on it.

1. Vertices closer to each other than the tolerance move to their mean. A cluster wider than twice the tolerance is left
   as it is: it is a row of vertices, not one point.
2. A vertex closer than the tolerance to a side of another outline moves onto it (T-joints).

No vertex moves further than the tolerance by either step.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.sparse as sp
import shapely
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from concio.model.model import Array


def snapped(outlines: Sequence[Array], tolerance: float) -> list[Array]:
    """Return the outlines (n, 2) with vertices closer than ``tolerance`` [m] to each other or a side put together."""
    counts = [len(o) for o in outlines]
    points = np.concatenate(outlines) if len(outlines) else np.zeros((0, 2))
    owner = np.repeat(np.arange(len(outlines)), counts)
    points = _clustered(points, tolerance)
    points = _on_sides(points, owner, np.array(counts), tolerance)
    points = _clustered(points, 1e-3 * tolerance)
    return [_without_repeats(o) for o in np.split(points, np.cumsum(counts)[:-1])]


def _without_repeats(outline: Array) -> Array:
    """Return an outline without vertices equal to the one before."""
    kept: Array = outline[(outline != np.roll(outline, 1, axis=0)).any(1)]
    return kept


def _clustered(points: Array, tolerance: float) -> Array:
    """Return the points with those closer than the tolerance moved to their mean."""
    near = cKDTree(points).query_pairs(tolerance, output_type="ndarray")
    if not len(near):
        return points
    n = len(points)
    graph = sp.coo_array((np.ones(len(near)), (near[:, 0], near[:, 1])), shape=(n, n))
    _, label = connected_components(graph, directed=False)
    many = np.bincount(label)
    mean = np.stack([np.bincount(label, points[:, k]) for k in range(2)], 1) / many[:, None]
    widest = np.zeros(len(many))
    np.maximum.at(widest, label, np.hypot(*(points - mean[label]).T))
    move = (widest <= tolerance) & (many > 1)
    result: Array = np.where(move[label][:, None], mean[label], points)
    return result


def _on_sides(points: Array, owner: Array, counts: Array, tolerance: float) -> Array:
    """Return the points with those near a side of another outline moved onto it, one after the other."""
    points = points.copy()
    first = np.concatenate([[0], np.cumsum(counts)[:-1]])
    following = np.arange(len(points)) + 1
    following[first + counts - 1] = first
    sides = shapely.linestrings(np.stack([points, points[following]], 1))
    vertex, side = shapely.STRtree(sides).query(shapely.points(points), predicate="dwithin", distance=tolerance)
    keep = owner[vertex] != owner[side]
    for v, s in zip(vertex[keep].tolist(), side[keep].tolist(), strict=True):
        a, b = points[s], points[following[s]]
        along = b - a
        square = float(along @ along)
        if square <= tolerance**2:
            continue
        share = float((points[v] - a) @ along) / square
        foot = a + share * along
        reach = tolerance / np.sqrt(square)
        if reach < share < 1 - reach and np.hypot(*(points[v] - foot)) <= tolerance:
            same = (points == points[v]).all(1)  # vertices already put together stay together
            points[same] = foot
    return points
