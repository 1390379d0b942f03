"""The outline that blocks have together, and its mesh: rectangles between lines, cut into triangles."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import shapely

from concio.errors import InputError

Array = np.ndarray

RAYS = 6
"""Parts into which the two far sides of a rectangle are cut where rays start from its corner."""


def wall_shape(blocks: Sequence[tuple[Array, Sequence[Array]]], near: float) -> shapely.Geometry:
    """Return the shape that blocks have together, with corners where theirs are.

    Parameters
    ----------
    blocks : sequence of ((v, 2) array, sequence of (v, 2) arrays)
        Outlines and holes [m].
    near : float
        Gaps up to twice this are closed [m].

    Raises
    ------
    InputError
        It has edges that run neither along x nor along y.
    """
    wide = [shapely.Polygon(p, list(holes)).buffer(near, join_style="mitre") for p, holes in blocks]
    shape = shapely.union_all(wide).buffer(-near, join_style="mitre").simplify(4 * near)
    corners = np.vstack([ring for p, holes in blocks for ring in (p, *holes)])
    known = [np.unique(corners[:, k]) for k in (0, 1)]

    def put(points: Array) -> Array:
        return np.column_stack([_nearest(known[k], points[:, k]) for k in (0, 1)])

    shape = shapely.transform(shape, put)
    sides = np.vstack([np.diff(r, axis=0) for r in _rings(shape)])
    if np.minimum(*np.abs(sides).T).max() > 10 * near:
        msg = "the outline of the wall has edges that run neither along x nor along y"
        raise InputError(msg, hint="a continuum is meshed for walls and panels of rectangles")
    return shape


def mesh_lines(shape: shapely.Geometry, points: Array, near: float) -> tuple[Array, Array]:
    """Return the increasing x and y through all corners of a shape and those points (k, 2) that lie between them."""
    found = []
    for k in (0, 1):
        corners = np.unique(np.concatenate([r[:, k] for r in _rings(shape)]))
        kept = [float(corners[0])]
        kept += [float(b) for a, b in pairwise(corners) if b - a > 10 * near]
        for v in points[:, k]:
            if kept[0] < v < max(kept) and np.abs(np.array(kept) - v).min() > 10 * near:
                kept.append(float(v))
        found.append(np.sort(kept))
    return found[0], found[1]


def corners_of_shape(shape: shapely.Geometry) -> Array:
    """Return the corners (k, 2) of a shape [m]."""
    return np.vstack([r[:-1] for r in _rings(shape)])


def _rings(shape: shapely.Geometry) -> list[Array]:
    return [np.array(r.coords) for p in shapely.get_parts(shape) for r in (p.exterior, *p.interiors)]


def _nearest(known: Array, values: Array) -> Array:
    right = np.clip(np.searchsorted(known, values), 1, len(known) - 1)
    below, above = known[right - 1], known[right]
    found: Array = np.where(values - below < above - values, below, above)
    return found


def fanned_rectangles(xs: Array, ys: Array, shape: shapely.Geometry, centres: Array) -> tuple[Array, Array]:
    """Return points and triangles of the rectangles between mesh lines that lie in a shape.

    A rectangle is cut by its diagonals. One that has a corner at one of ``centres`` (k, 2) (where edges of the shape
    meet, supports or loads end) is cut by rays from there: stresses turn about such points, and however fine they are,
    two triangles cannot follow them.
    """
    nx, ny = len(xs) - 1, len(ys) - 1
    shapely.prepare(shape)
    places = [(float(x), float(y)) for y in ys for x in xs]
    near = 1e-9 * float(max(np.ptp(xs), np.ptp(ys)))
    gaps = np.abs(np.array(places)[:, None, :] - centres[None]).max(axis=2)
    special = set(np.flatnonzero(gaps.min(axis=1, initial=np.inf) <= near).tolist())
    rings: list[tuple[list[int], int]] = []
    for j in range(ny):
        for i in range(nx):
            if shapely.contains_xy(shape, (xs[i] + xs[i + 1]) / 2, (ys[j] + ys[j + 1]) / 2):
                a = j * (nx + 1) + i
                ring = [a, a + 1, a + nx + 2, a + nx + 1]
                turned = [k for k in range(4) if ring[k] in special]
                rings.append((ring, turned[0] if len(turned) == 1 else -1))
    cuts: dict[tuple[int, int], list[int]] = {}
    for ring, centre in rings:
        for k in (1, 2) if centre >= 0 else ():
            p, q = sorted((ring[(centre + k) % 4], ring[(centre + k + 1) % 4]))
            if (p, q) not in cuts:
                cuts[p, q] = list(range(len(places), len(places) + RAYS - 1))
                ends = np.array([places[p], places[q]])
                places += [tuple(ends[0] + s * (ends[1] - ends[0])) for s in np.arange(1, RAYS) / RAYS]
    triangles: list[tuple[int, int, int]] = []
    for ring, centre in rings:
        around: list[int] = []
        for k in range(4):
            p, q = ring[k], ring[(k + 1) % 4]
            around += [p, *(cuts.get((p, q), []) if p < q else cuts.get((q, p), [])[::-1])]
        if centre >= 0:
            middle, at = ring[centre], around.index(ring[centre])
            around = around[at + 1 :] + around[:at]
            pairs = list(pairwise(around))
        else:
            middle = len(places)
            places.append(tuple(np.array([places[p] for p in ring]).mean(axis=0)))
            pairs = list(pairwise([*around, around[0]]))
        triangles += [(p, q, middle) for p, q in pairs]
    used, back = np.unique(np.array(triangles), return_inverse=True)
    return np.array(places)[used], back.reshape(-1, 3)


def boundary_edges(triangles: Array) -> tuple[Array, Array]:
    """Return the edges (b, 2) that belong to one triangle only, as they run in it, and that triangle (b,)."""
    edges = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    owner = np.tile(np.arange(len(triangles)), 3)
    _, first, count = np.unique(np.sort(edges, axis=1), axis=0, return_index=True, return_counts=True)
    once = np.sort(first[count == 1])
    return edges[once], owner[once]
