"""Constrained Delaunay triangles of a simple polygon whose boundary subdivision is kept exactly.

1. Ears of the boundary polygon are cut, best shaped first; vertices in the middle of a straight side are allowed.
2. Edges are flipped until each is locally Delaunay (Lawson 1977); sides of the polygon are never flipped.
3. Interior points of a triangular grid are inserted, then circumcentres of triangles that are too large or too sharp,
   as in Ruppert's refinement (J. Algorithms 18, 1995), but only where they lie in no side's diametral circle: the
   sides stay whole, so that contact is found where the model put it.
4. Interior points move to the mean of their neighbours where that does not make the worst triangle worse.

Work is done in coordinates of order one. The result covers the polygon exactly: it is a triangulation of the given
boundary vertices, whatever the interior does.
"""

from __future__ import annotations

import numpy as np
import shapely

from concio.errors import GeometryError
from concio.kinematics.frames import cross

Array = np.ndarray
_SHARP = np.deg2rad(25.0)
_FLAT = 1e-13
_ON_EDGE = 1e-9


class Triangulation:
    """Triangles of a polygon that can be split and flipped; every triangle runs counter-clockwise.

    Parameters
    ----------
    boundary : (n, 2) array
        Vertices of a simple polygon, counter-clockwise, all of them kept.

    Raises
    ------
    GeometryError
        The polygon cannot be cut into triangles: it crosses itself or has no interior somewhere.
    """

    def __init__(self, boundary: Array) -> None:
        self.origin, self.scale = boundary.min(0), float(np.ptp(boundary, axis=0).max())
        self.sides = len(boundary)
        self.xy: list[tuple[float, float]] = [tuple(p) for p in ((boundary - self.origin) / self.scale).tolist()]
        self.triangles: list[tuple[int, int, int]] = []
        self.edges: dict[tuple[int, int], int] = {}
        for triangle in cut_ears(np.array(self.xy)):
            self._put(len(self.triangles), triangle)
        self._legalise(list(self.edges))

    @property
    def points(self) -> Array:
        """Points (n, 2) in the units of the boundary."""
        result: Array = self.origin + self.scale * np.array(self.xy)
        return result

    def cells(self) -> Array:
        """Triangles (k, 3)."""
        return np.array(self.triangles)

    def insert(self, point: tuple[float, float]) -> bool:
        """Insert a point that is no vertex, given in unit coordinates; False where it lies outside."""
        xy, tri = np.array(self.xy), np.array(self.triangles)
        p = np.array(point)
        a, b, c = (xy[tri[:, k]] for k in range(3))
        signs = np.stack([cross(b - a, p - a), cross(c - b, p - b), cross(a - c, p - c)], 1)
        length = np.stack([np.hypot(*(v).T) for v in (b - a, c - b, a - c)], 1)
        home = int(np.argmax((signs / length).min(1)))
        if (signs / length)[home].min() <= _ON_EDGE:
            if (signs / length)[home].min() < -_ON_EDGE:
                return False
            # on an edge: a step into the triangle, which the flips that follow make good
            middle = (a[home] + b[home] + c[home]) / 3
            point = tuple((p + 1e3 * _ON_EDGE * (middle - p)).tolist())
        new = len(self.xy)
        self.xy.append(point)
        i, j, k = self.triangles[home]
        self._put(home, (i, j, new))
        self._put(len(self.triangles), (j, k, new))
        self._put(len(self.triangles), (k, i, new))
        self._legalise([(i, j), (j, k), (k, i)])
        return True

    def smooth(self, sweeps: int = 3) -> None:
        """Move interior points to the mean of their neighbours where the worst angle around them gets no smaller."""
        for _ in range(sweeps):
            around: dict[int, list[tuple[int, int]]] = {}
            for i, j, k in self.triangles:
                for p, q, r in ((i, j, k), (j, k, i), (k, i, j)):
                    if p >= self.sides:
                        around.setdefault(p, []).append((q, r))
            for p, ring in around.items():
                old = self.xy[p]
                mean = np.mean([self.xy[q] for q, _ in ring], axis=0)
                before = min(self._worst(p, q, r) for q, r in ring)
                self.xy[p] = (float(mean[0]), float(mean[1]))
                if min(self._worst(p, q, r) for q, r in ring) <= before:
                    self.xy[p] = old
            self._legalise(list(self.edges))

    def _worst(self, i: int, j: int, k: int) -> float:
        """Return the shape of a triangle: 1 equilateral, 0 flat, negative when turned over."""
        (ax, ay), (bx, by), (cx, cy) = self.xy[i], self.xy[j], self.xy[k]
        double = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
        square = (bx - ax) ** 2 + (by - ay) ** 2 + (cx - bx) ** 2 + (cy - by) ** 2 + (ax - cx) ** 2 + (ay - cy) ** 2
        return 2 * 3**0.5 * double / square if square else 0.0

    def _put(self, at: int, triangle: tuple[int, int, int]) -> None:
        if at == len(self.triangles):
            self.triangles.append(triangle)
        else:
            self.triangles[at] = triangle
        i, j, k = triangle
        self.edges[i, j] = self.edges[j, k] = self.edges[k, i] = at

    def _apex(self, t: int, i: int, j: int) -> int:
        return sum(self.triangles[t]) - i - j

    def _legalise(self, queue: list[tuple[int, int]]) -> None:
        """Flip edges until each is locally Delaunay, with a limit against rounding that would flip for ever."""
        left = 50 * (len(self.triangles) + 20)
        while queue and left:
            left -= 1
            i, j = queue.pop()
            t, s = self.edges.get((i, j)), self.edges.get((j, i))
            if t is None or s is None:
                continue
            k, m = self._apex(t, i, j), self._apex(s, i, j)
            if not self._should_flip(i, j, k, m):
                continue
            del self.edges[i, j], self.edges[j, i]
            self._put(t, (k, i, m))
            self._put(s, (m, j, k))
            queue.extend([(i, m), (m, j), (j, k), (k, i)])

    def _should_flip(self, i: int, j: int, k: int, m: int) -> bool:
        """Tell whether m lies in the circle of (i, j, k) and both new triangles (k, i, m), (m, j, k) are proper."""
        (ax, ay), (bx, by), (cx, cy), (dx, dy) = (self.xy[q] for q in (i, j, k, m))
        ax, ay, bx, by, cx, cy = ax - dx, ay - dy, bx - dx, by - dy, cx - dx, cy - dy
        circle = (
            (ax * ax + ay * ay) * (bx * cy - cx * by)
            - (bx * bx + by * by) * (ax * cy - cx * ay)
            + (cx * cx + cy * cy) * (ax * by - bx * ay)
        )
        size = max(ax * ax + ay * ay, bx * bx + by * by, cx * cx + cy * cy)
        if circle <= 1e-10 * size * size:
            return False
        first, second = cx * ay - ax * cy, bx * cy - cx * by
        return bool(first > _FLAT and second > _FLAT)


def cut_ears(boundary: Array) -> list[tuple[int, int, int]]:
    """Return the triangles of a simple polygon (n, 2) of size one, the best shaped ears first."""
    remaining = list(range(len(boundary)))
    result = []
    while len(remaining) > 3:
        p = boundary[remaining]
        before, after = np.roll(p, 1, axis=0), np.roll(p, -1, axis=0)
        double = cross(p - before, after - before)
        square = ((p - before) ** 2 + (after - p) ** 2 + (before - after) ** 2).sum(1)
        shape = double / square
        for ear in np.argsort(-shape):
            if shape[ear] <= 0:
                raise _cannot(boundary[remaining[ear]])
            if not _holds_another(p, before[ear], p[ear], after[ear], int(ear)):
                break
        else:
            raise _cannot(p[0])
        n = len(remaining)
        result.append((remaining[ear - 1], remaining[ear], remaining[(ear + 1) % n]))
        del remaining[ear]
    i, j, k = remaining
    if cross(boundary[j] - boundary[i], boundary[k] - boundary[i]) <= 0:
        raise _cannot(boundary[i])
    result.append((i, j, k))
    return result


def _cannot(at: Array) -> GeometryError:
    msg = f"the outline cannot be cut into triangles near ({at[0]:.4g}, {at[1]:.4g}) of its size"
    return GeometryError(msg, hint="look for sides that cross, touch or lie on each other; see 'concio check'")


def _holds_another(points: Array, a: Array, b: Array, c: Array, ear: int) -> bool:
    """Tell whether the closed triangle holds a vertex other than its own."""
    n = len(points)
    others = np.delete(points, [ear - 1 if ear else n - 1, ear, (ear + 1) % n], axis=0)
    inside = np.ones(len(others), dtype=bool)
    for p, q in ((a, b), (b, c), (c, a)):
        inside &= cross(q - p, others - p) >= -_FLAT
    return bool(inside.any())


def triangles(boundary: Array, size: float) -> tuple[Array, Array]:
    """Return points (n, 2), the boundary's first, and triangles (k, 3) of about ``size``.

    Parameters
    ----------
    boundary : (n, 2) array
        Vertices of a simple polygon, counter-clockwise [m]; every one becomes a node and every side an element edge.
    size : float
        Target length of edges inside [m].
    """
    mesh = Triangulation(boundary)
    unit, h = np.array(mesh.xy), size / mesh.scale
    span = np.hypot(*(np.roll(unit, -1, axis=0) - unit).T)
    middle, radius = 0.5 * (unit + np.roll(unit, -1, axis=0)), 0.5 * span
    polygon = shapely.Polygon(unit)
    ring = polygon.exterior

    def may_stand(points: Array) -> Array:
        """Tell which points lie inside, in no side's diametral circle (a little enlarged)."""
        inside = shapely.contains_xy(polygon, *points.T)
        free = (np.hypot(*(points[:, None] - middle).transpose(2, 0, 1)) > 1.02 * radius).all(1)
        result: Array = inside & free
        return result

    grid = _grid(h, unit.max(0))
    if len(grid):
        grid = grid[may_stand(grid)]
        grid = grid[shapely.distance(shapely.points(grid), ring) > 0.55 * h]
    for point in grid.tolist():
        mesh.insert((point[0], point[1]))
    _refine(mesh, h, may_stand)
    mesh.smooth()
    points = mesh.points
    points[: len(boundary)] = boundary
    return points, mesh.cells()


def _grid(h: float, upper: Array) -> Array:
    """Return a grid of equilateral triangles of side h over the box from 0 to ``upper``, centred in it."""
    rows = int(upper[1] / (h * 0.75**0.5))
    columns = int(upper[0] / h)
    y0, x0 = 0.5 * (upper[1] - rows * h * 0.75**0.5), 0.5 * (upper[0] - columns * h)
    i, j = np.meshgrid(np.arange(columns + 1), np.arange(rows + 1))
    x, y = x0 + (i - 0.25 + 0.5 * (j % 2)) * h, y0 + j * h * 0.75**0.5
    return np.column_stack([x.ravel(), y.ravel()])


def _refine(mesh: Triangulation, h: float, may_stand: object) -> None:
    """Insert circumcentres of triangles that are too large or too sharp, where they may stand."""
    assert callable(may_stand)
    refused: set[tuple[int, int, int]] = set()
    for _ in range(20 * mesh.sides + 200):
        xy, tri = np.array(mesh.xy), mesh.cells()
        a, b, c = (xy[tri[:, k]] for k in range(3))
        la, lb, lc = (np.hypot(*v.T) for v in (c - b, a - c, b - a))
        double = cross(b - a, c - a)
        shortest = np.minimum(np.minimum(la, lb), lc)
        radius = la * lb * lc / np.maximum(2 * double, 1e-300)
        sharp = shortest < 2 * np.sin(_SHARP) * radius
        badness = np.where((radius > 0.85 * h) | (sharp & (radius > 0.2 * h)), radius, 0.0)
        for t in np.argsort(-badness):
            if badness[t] <= 0:
                return
            key = tuple(sorted(tri[t].tolist()))
            if key in refused:
                continue
            refused.add(key)
            p, q = b[t] - a[t], c[t] - a[t]
            centre = a[t] + np.array([q[1] * (p @ p) - p[1] * (q @ q), p[0] * (q @ q) - q[0] * (p @ p)]) / (
                2 * double[t]
            )
            near = np.hypot(*(xy - centre).T).min()
            if near > 0.35 * shortest[t] and may_stand(centre[None])[0] and mesh.insert((centre[0], centre[1])):
                break
        else:
            return
