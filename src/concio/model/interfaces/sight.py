"""Which parts of two facing edges see each other, where other bodies may stand between them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from concio.model.interfaces.facing import FacingPairs
from concio.model.interfaces.near import polygons
from concio.model.model import Array, Body
from concio.model.overlay import areas

GRID = 1e-3
"""Spacing of the grid on which areas are cut, as a share of the tolerance.

The space between two edges has those edges for sides, and cut in floating point with the bodies they belong to it may
come out whole: rounding decides on which side of itself an edge lies. On a grid the cut is always consistent.
"""


def visible_parts(bodies: Sequence[Body], pairs: FacingPairs, tolerance: float, shortest: Array) -> FacingPairs:
    """Return the parts of the pairs between whose edges no body stands.

    Parameters
    ----------
    bodies : sequence of Body
    pairs : FacingPairs
        Only pairs with a gap above the tolerance can be hidden; the others are returned as they are.
    tolerance : float
        Bodies that enter the space between by less than this do not count [m].
    shortest : (p,) array
        Parts shorter than this are dropped [m].
    """
    open_pairs = np.flatnonzero(pairs.g_max > tolerance)
    if not len(open_pairs):
        return pairs
    some = pairs.chosen(open_pairs)
    n = some.normal
    b_lo, b_hi = some.a_lo + some.g_lo[:, None] * n, some.a_hi + some.g_hi[:, None] * n
    corners = np.stack([some.a_lo, some.a_hi, b_hi, b_lo], 1)
    between = areas(shapely.make_valid(shapely.polygons(corners)))
    shapes = polygons(bodies)
    k, q = shapely.STRtree(shapes).query(between)
    inside = shapely.intersection(between[k], shapes[q], grid_size=GRID * tolerance)
    around = shapely.length(inside)
    keep = 2 * shapely.area(inside) > tolerance * np.maximum(around, tolerance)
    k, inside = k[keep], inside[keep]
    if not len(k):
        return pairs
    points, owner = shapely.get_coordinates(inside, return_index=True)
    s = ((points - some.a_lo[k][owner]) * some.tangent[k][owner]).sum(1) + some.lo[k][owner]
    low, high = np.full(len(k), np.inf), np.full(len(k), -np.inf)
    np.minimum.at(low, owner, s)
    np.maximum.at(high, owner, s)

    whole = np.setdiff1d(np.arange(len(pairs.lo)), open_pairs[np.unique(k)])
    index, lo, hi = [*whole], [*pairs.lo[whole]], [*pairs.hi[whole]]
    order = np.lexsort([low, k])
    k, low, high = k[order], low[order], high[order]
    for pair in np.unique(k):
        at, full = float(some.lo[pair]), float(some.hi[pair])
        own = slice(np.searchsorted(k, pair), np.searchsorted(k, pair, side="right"))
        least = max(float(shortest[open_pairs[pair]]), tolerance)
        for start, stop in zip([*low[own], full], [*high[own], full], strict=True):
            if start - at >= least:
                index.append(open_pairs[pair])
                lo.append(at)
                hi.append(start)
            at = max(at, stop)
    chosen = np.array(index, dtype=int)
    return pairs.chosen(chosen).cut(np.array(lo), np.array(hi))
