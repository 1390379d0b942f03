"""Constrained Delaunay triangles of a polygon, with holes or without, whose boundary subdivision is kept exactly.

1. All points are triangulated (Qhull, by scipy). Sides of the polygon that are missing are recovered by flipping the
   edges that cross them (Sloan, Adv. Engng Software 9, 1987), and what lies outside is left away.
2. Interior points begin as a triangular grid. Then circumcentres of triangles that are too large or too sharp are
   added, as in Ruppert's refinement (J. Algorithms 18, 1995), but only where they lie in no side's diametral circle:
   the sides stay whole, so that contact is found where the model put it. Each round adds the worst ones that stand
   clear of each other, and triangulates again.
3. Interior points move to the mean of their neighbours where that makes the worst triangle around them no worse.

Work is done in coordinates of order one. The result covers the polygon exactly: it is a triangulation of the given
boundary vertices, whatever the interior does.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy  # its parts are loaded when they are used: scipy.spatial takes long
import scipy.sparse as sp
import shapely

from concio.errors import GeometryError
from concio.kinematics.frames import cross

Array = np.ndarray
ROUNDS = 60
"""Most rounds of refinement."""
SWEEPS = 3
"""Rounds of smoothing."""
FRAME = np.array([(-3.0, -3.1), (4.2, -2.9), (3.9, 4.1), (-3.2, 3.8)])
"""Four points far around: with them no point of a straight side lies on the convex hull, where Qhull may drop it."""
_SHARP = np.deg2rad(25.0)
_FLAT = 1e-13


def triangles(rings: Sequence[Array], size: float) -> tuple[Array, Array]:
    """Return points (n, 2), those of the rings first, and triangles (k, 3) of about ``size``, counter-clockwise.

    Parameters
    ----------
    rings : sequence of (n, 2) arrays
        The outline counter-clockwise, then each hole clockwise [m]; every vertex becomes a node and every side an
        element edge.
    size : float
        Target length of edges inside [m].

    Raises
    ------
    GeometryError
        The polygon cannot be cut into triangles: its sides cross or touch.
    """
    boundary = np.concatenate(rings)
    origin, scale = boundary.min(0), float(np.ptp(boundary, axis=0).max())
    area = _Area([(ring - origin) / scale for ring in rings])
    h = size / scale
    points = area.boundary
    inner = _grid(h, points.max(0))
    if len(inner):
        inner = inner[area.may_stand(inner)]
        inner = inner[shapely.distance(shapely.points(inner), area.shape.boundary) > 0.55 * h]
        points = np.concatenate([points, inner])
    points = _refined(area, points, h)
    for _ in range(SWEEPS):
        points = _smoothed(area, points)
    cells = area.triangulated(points)
    return np.concatenate([boundary, origin + scale * points[len(boundary) :]]), cells


def bare_triangles(rings: Sequence[Array]) -> Array:
    """Return triangles (k, 3) of the points of the rings alone; see :func:`triangles`."""
    boundary = np.concatenate(rings)
    origin, scale = boundary.min(0), float(np.ptp(boundary, axis=0).max())
    area = _Area([(ring - origin) / scale for ring in rings])
    return area.triangulated(area.boundary)


class _Area:
    """A polygon in unit coordinates: its boundary points (b, 2), its sides (b, 2) as numbers of points, its shape."""

    def __init__(self, rings: Sequence[Array]) -> None:
        self.boundary = np.concatenate(rings)
        counts = [len(ring) for ring in rings]
        first = np.concatenate([[0], np.cumsum(counts)[:-1]])
        following = np.arange(len(self.boundary)) + 1
        following[first + np.array(counts) - 1] = first
        self.sides = np.stack([np.arange(len(self.boundary)), following], 1)
        self.shape = shapely.Polygon(rings[0], list(rings[1:]))
        shapely.prepare(self.shape)
        ends = self.boundary[self.sides]
        self.middle, self.radius = ends.mean(1), 0.5 * np.hypot(*(ends[:, 1] - ends[:, 0]).T)
        self.near = scipy.spatial.cKDTree(self.middle)

    def may_stand(self, points: Array) -> Array:
        """Tell which points lie inside, in no side's diametral circle (a little enlarged)."""
        inside: Array = shapely.contains_xy(self.shape, *points.T)
        reach = 1.02 * self.radius
        for k, found in enumerate(self.near.query_ball_point(points, float(reach.max()))):
            if inside[k] and found:
                inside[k] = (np.hypot(*(points[k] - self.middle[found]).T) > reach[found]).all()
        return inside

    def triangulated(self, points: Array) -> Array:
        """Return the triangles (k, 3) of the polygon on points (n, 2), those of the boundary first."""
        with_frame = np.concatenate([points, FRAME])
        cells = scipy.spatial.Delaunay(with_frame).simplices.astype(np.int64)
        a, b, c = (with_frame[cells[:, k]] for k in range(3))
        cells = np.where((cross(b - a, c - a) < 0)[:, None], cells[:, [0, 2, 1]], cells)
        cells = _with_sides(with_frame, cells, self.sides)
        cells = cells[(cells < len(points)).all(1)]
        inside: Array = shapely.contains_xy(self.shape, *points[cells].mean(1).T)
        kept: Array = cells[inside]
        a, b, c = (points[kept[:, k]] for k in range(3))
        if abs(0.5 * float(cross(b - a, c - a).sum()) - self.shape.area) > 1e-9 * self.shape.area:
            raise _cannot(points[0])
        return kept


def _with_sides(points: Array, cells: Array, sides: Array) -> Array:
    """Return triangles that have all sides of the polygon for edges."""
    n = len(points)
    edges = np.concatenate([cells[:, [k, (k + 1) % 3]] for k in range(3)])
    have = np.unique(edges.min(1) * n + edges.max(1))
    missing = sides[~np.isin(sides.min(1) * n + sides.max(1), have)]
    if not len(missing):
        return cells
    flips = _Flips(points, cells)
    for i, j in missing.tolist():
        flips.recover(i, j)
    return np.array(flips.cells)


class _Flips:
    """Triangles whose edges can be flipped; every triangle runs counter-clockwise."""

    def __init__(self, points: Array, cells: Array) -> None:
        self.xy: list[tuple[float, float]] = [(x, y) for x, y in points.tolist()]
        self.cells: list[tuple[int, int, int]] = [(i, j, k) for i, j, k in cells.tolist()]
        self.edges = {e: t for t, (i, j, k) in enumerate(self.cells) for e in ((i, j), (j, k), (k, i))}
        self.around: dict[int, set[int]] = {}
        for t, cell in enumerate(self.cells):
            for i in cell:
                self.around.setdefault(i, set()).add(t)

    def _turn(self, i: int, j: int, k: int) -> float:
        """Return twice the area of a triangle, positive counter-clockwise."""
        (ax, ay), (bx, by), (cx, cy) = self.xy[i], self.xy[j], self.xy[k]
        return (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)

    def recover(self, i: int, j: int) -> None:
        """Flip the edges that cross the side from i to j until it is an edge."""
        if (i, j) in self.edges or (j, i) in self.edges:  # another side's flips made it
            return
        queue = self._crossing(i, j)
        left = 10 * (len(queue) + 10) ** 2
        while queue:
            left -= 1
            if left < 0:
                raise _cannot(np.array(self.xy[i]))
            p, q = queue.pop(0)
            t, s = self.edges.get((p, q)), self.edges.get((q, p))
            if t is None or s is None:
                raise _cannot(np.array(self.xy[i]))
            k, m = sum(self.cells[t]) - p - q, sum(self.cells[s]) - p - q
            if self._turn(k, p, m) <= _FLAT or self._turn(m, q, k) <= _FLAT:  # the two are not convex quadrilateral yet
                queue.append((p, q))
                continue
            self._flip(t, s, p, q, k, m)
            if {k, m} != {i, j} and self._cross(i, j, k, m):
                queue.append((k, m))

    def _flip(self, t: int, s: int, p: int, q: int, k: int, m: int) -> None:
        """Replace (p, q, k) and (q, p, m) by (k, p, m) and (m, q, k)."""
        for e in ((p, q), (q, p)):
            del self.edges[e]
        for cell, (a, b, c) in ((t, (k, p, m)), (s, (m, q, k))):
            self.cells[cell] = (a, b, c)
            self.edges[a, b] = self.edges[b, c] = self.edges[c, a] = cell
        self.around[p].discard(s)
        self.around[q].discard(t)
        self.around[m].add(t)
        self.around[k].add(s)

    def _cross(self, i: int, j: int, k: int, m: int) -> bool:
        """Tell whether the side from i to j and the edge between k and m cross inside both."""
        if len({i, j, k, m}) < 4:
            return False
        return self._turn(i, j, k) * self._turn(i, j, m) < 0 and self._turn(k, m, i) * self._turn(k, m, j) < 0

    def _crossing(self, i: int, j: int) -> list[tuple[int, int]]:
        """Return the edges that cross the side from i to j, in order."""
        for t in self.around.get(i, ()):
            a, b, c = self.cells[t]
            p, q = {a: (b, c), b: (c, a), c: (a, b)}[i]
            if self._cross(i, j, p, q):
                break
        else:
            raise _cannot(np.array(self.xy[i]))
        found = [(p, q)]
        while True:
            p, q = found[-1]
            s = self.edges.get((q, p))
            if s is None or len(found) > len(self.cells):
                raise _cannot(np.array(self.xy[i]))
            m = sum(self.cells[s]) - p - q
            if m == j:
                return found
            # the next edge is the one of (q, p, m) on whose two ends the side passes between
            turn = self._turn(i, j, m)
            if abs(turn) <= _FLAT:
                raise _cannot(np.array(self.xy[m]))
            found.append((m, q) if (turn > 0) == (self._turn(i, j, p) > 0) else (p, m))


def _cannot(at: Array) -> GeometryError:
    msg = f"the outline cannot be cut into triangles near ({at[0]:.4g}, {at[1]:.4g}) of its size"
    return GeometryError(msg, hint="look for sides that cross, touch or lie on each other; see 'concio check'")


def _grid(h: float, upper: Array) -> Array:
    """Return a grid of equilateral triangles of side h over the box from 0 to ``upper``, centred in it."""
    rows = int(upper[1] / (h * 0.75**0.5))
    columns = int(upper[0] / h)
    y0, x0 = 0.5 * (upper[1] - rows * h * 0.75**0.5), 0.5 * (upper[0] - columns * h)
    i, j = np.meshgrid(np.arange(columns + 1), np.arange(rows + 1))
    x, y = x0 + (i - 0.25 + 0.5 * (j % 2)) * h, y0 + j * h * 0.75**0.5
    return np.column_stack([x.ravel(), y.ravel()])


def _refined(area: _Area, points: Array, h: float) -> Array:
    """Return the points with circumcentres of triangles that are too large or too sharp, where they may stand."""
    for _ in range(ROUNDS):
        cells = area.triangulated(points)
        a, b, c = (points[cells[:, k]] for k in range(3))
        la, lb, lc = (np.hypot(*v.T) for v in (c - b, a - c, b - a))
        double = cross(b - a, c - a)
        shortest = np.minimum(np.minimum(la, lb), lc)
        radius = la * lb * lc / np.maximum(2 * double, 1e-300)
        sharp = shortest < 2 * np.sin(_SHARP) * radius
        bad = np.flatnonzero((radius > 0.85 * h) | (sharp & (radius > 0.2 * h)))
        if not len(bad):
            break
        bad = bad[np.argsort(-radius[bad], kind="stable")]
        p, q = b[bad] - a[bad], c[bad] - a[bad]
        pp, qq = (p * p).sum(1), (q * q).sum(1)
        turned = np.stack([q[:, 1] * pp - p[:, 1] * qq, p[:, 0] * qq - q[:, 0] * pp], 1)
        centre = a[bad] + turned / (2 * double[bad, None])
        clear = scipy.spatial.cKDTree(points).query(centre)[0] > 0.35 * shortest[bad]
        centre, size = centre[clear], radius[bad][clear]
        keep = area.may_stand(centre)
        centre, size = centre[keep], size[keep]
        if not len(centre):
            break
        points = np.concatenate([points, centre[_apart(centre, size)]])
    return points


def _apart(centre: Array, radius: Array) -> Array:
    """Return the first of the points and every later one that lies in no circle of one returned before."""
    taken = np.ones(len(centre), dtype=bool)
    tree = scipy.spatial.cKDTree(centre)
    for k in range(len(centre)):
        if taken[k]:
            others = np.array(tree.query_ball_point(centre[k], float(radius[k])))
            taken[others[others > k]] = False
    return np.flatnonzero(taken)


def _smoothed(area: _Area, points: Array) -> Array:
    """Return the points with interior ones moved to the mean of their neighbours, where the worst angle allows it."""
    cells = area.triangulated(points)
    n, fixed = len(points), len(area.boundary)
    if n == fixed:
        return points
    edges = np.concatenate([cells[:, [k, (k + 1) % 3]] for k in range(3)])
    graph = sp.coo_array((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(n, n)).tocsr()
    graph = ((graph + graph.T) > 0).astype(float)
    order = np.random.default_rng(0).permutation(n)
    points = points.copy()
    waiting = np.arange(n) >= fixed
    while waiting.any():
        # an independent set: points that come before all their waiting neighbours
        rank = np.where(waiting, order, n)
        least = np.full(n, n)
        np.minimum.at(least, edges[:, 0], rank[edges[:, 1]])  # an edge inside stands there in both directions
        chosen = waiting & (rank < least)
        waiting &= ~chosen
        moved = np.where(chosen[:, None], (graph @ points) / np.maximum(graph.sum(1), 1)[:, None], points)
        before, after = _worst_around(points, cells), _worst_around(moved, cells)
        better = chosen & (after > before)
        points[better] = moved[better]
    return points


def _worst_around(points: Array, cells: Array) -> Array:
    """Return the shape of the worst triangle at each point (n,): 1 equilateral, 0 flat, negative when turned over."""
    a, b, c = (points[cells[:, k]] for k in range(3))
    square = ((b - a) ** 2 + (c - b) ** 2 + (a - c) ** 2).sum(1)
    shape = 2 * 3**0.5 * cross(b - a, c - a) / np.maximum(square, 1e-300)
    worst = np.full(len(points), np.inf)
    for k in range(3):
        np.minimum.at(worst, cells[:, k], shape)
    return worst
