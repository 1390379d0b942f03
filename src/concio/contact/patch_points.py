r"""Contact points of a patch between two blocks that are not meshed, and the area each stands for.

*Corners*: the vertices of the patch. A rigid face presses on no more than the convex hull of its contact points, so
corners carry every resultant that the patch could; the pressure between them is not resolved, and with it torsion: a
square joint under a central force N turns at mu N a / sqrt 2 instead of 0.3826 mu N a of a uniform pressure.

*Points over the patch*: n x n Gauss-Lobatto points of a quadrilateral, of any other polygon those of the quadrilaterals
that its centre makes with its corners. They reach its boundary, so that hinges lie where they are, and integrate linear
pressures with their moments exactly; with n = 4 torsion is right to 2.3 per cent.

*Points graded towards the boundary*, for joints that crush: those of :mod:`concio.contact.joint_points` in both
directions, or no force near an edge would find the strip that carries it.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
import shapely

from concio.contact.joint_points import LEAST_GRADED, graded_half, graded_rule
from concio.kinematics.frames import cross
from concio.kinematics.mass import polygon_moments
from concio.model.interfaces.patch import Patch

Array = np.ndarray

STIFF, CRUSHING = 4, 14
"""Points along each side of a quadrilateral for joints with stiffness, and for those that crush."""

SPREADING = (6, 4)
"""Points along each side that spread the pressure of joints that twist, as many as the size allows: torsion is right to
0.5 and 2.3 % on a square."""


def corner_points(patches: Sequence[Patch]) -> tuple[Array, Array, Array]:
    """Return the corners (m, 3) of all patches, the area (m,) of each [m2], and their number in each patch (p,).

    The areas are those of the fan round the centroid of the patch: half of each triangle goes to each of its two
    corners. They sum to the area of the patch and have its centroid. Where one would be negative, as in patches that
    are not convex or have holes, a third of each triangle of a triangulation goes to each corner.
    """
    count = np.array([len(p.polygon) + sum(map(len, p.holes)) for p in patches], dtype=int)
    points = np.concatenate([ring for p in patches for ring in (p.polygon, *p.holes)])
    owner = np.repeat(np.arange(len(patches)), count)
    first = np.concatenate([[0], np.cumsum(count)[:-1]])
    ahead = np.arange(len(points)) + 1
    ahead[first + count - 1] = first
    normal = np.array([p.normal for p in patches])[owner]
    near = points[first][owner]
    fan = 0.5 * (cross(points - near, points[ahead] - near) * normal).sum(1)
    total = np.bincount(owner, fan)
    centre = np.stack(
        [np.bincount(owner, fan * (near + points + points[ahead])[:, k]) / (3 * total) for k in range(3)], 1
    )
    arm = points - centre[owner]
    part = 0.5 * (cross(arm, arm[ahead]) * normal).sum(1)
    share = 0.5 * part
    share[ahead] += 0.5 * part
    least = np.full(len(patches), np.inf)
    np.minimum.at(least, owner, part)
    for k in np.flatnonzero(least < -1e-12 * total).tolist() + [k for k, p in enumerate(patches) if p.holes]:
        share[first[k] : first[k] + count[k]] = _triangulated(patches[k])
    return points, share, count


def _triangulated(patch: Patch) -> Array:
    """Return a third of the triangles at each corner of a patch, boundary first, then holes (m,) [m2]."""
    rings = [(ring - patch.polygon[0]) @ patch.frame.T for ring in (patch.polygon, *patch.holes)]
    corners = np.concatenate(rings)
    cells = shapely.get_parts(shapely.constrained_delaunay_triangles(shapely.Polygon(rings[0], rings[1:])))
    at = shapely.get_coordinates(cells).reshape(-1, 4, 2)[:, :3]
    number = np.argmin(np.linalg.norm(at[:, :, None] - corners, axis=3), axis=2)
    return np.bincount(number.ravel(), np.repeat(shapely.area(cells) / 3, 3), len(corners))


@cache
def lobatto(n: int) -> tuple[Array, Array]:
    """Return n Gauss-Lobatto points on [0, 1], ends included, and their weights; exact to degree 2 n - 3."""
    series = np.polynomial.legendre.Legendre.basis(n - 1)
    inner = series.deriv().roots().real
    x = np.concatenate([[-1.0], np.sort(inner), [1.0]])
    weights = 2.0 / (n * (n - 1) * series(x) ** 2)
    return 0.5 * (x + 1), 0.5 * weights


def spread_points(patch: Patch, n: int, *, graded: bool = False) -> tuple[Array, Array]:
    """Return points (m, 3) over a patch and the area (m,) each stands for [m2].

    Parameters
    ----------
    patch : Patch
    n : int
        Points along each side of a quadrilateral.
    graded : bool
        Whether they are graded towards the boundary, for joints that crush; an odd n is raised by one then, and fewer
        than 8 are not graded.
    """
    rings = [(ring - patch.polygon[0]) @ patch.frame.T for ring in (patch.polygon, *patch.holes)]
    graded = graded and n >= LEAST_GRADED
    if len(rings) == 1 and len(rings[0]) == 4 and _convex(rings[0]):
        points, weights = _tensor(rings[0], graded_rule(n + n % 2) if graded else lobatto(n))
    else:
        rule = _towards_the_end((n + 1) // 2) if graded else lobatto(max(3, n // 2 + 1))
        parts = [_tensor(quad, rule) for quad in _quadrilaterals(rings)]
        points, weights = _together(*(np.concatenate(v) for v in zip(*parts, strict=True)))
    if graded:
        weights = _balanced(rings, points, weights)
    return patch.polygon[0] + points @ patch.frame, weights


def _towards_the_end(half: int) -> tuple[Array, Array]:
    """Return the rule of one half of a joint, its edge at 1."""
    x, share = graded_half(half)
    return 1.0 - x[::-1], share[::-1]


def _balanced(rings: list[Array], points: Array, weights: Array) -> Array:
    """Return weights (m,) of points (m, 2) changed by a linear share, so that area and centroid are those of rings."""
    whole = shapely.Polygon(rings[0], rings[1:])
    area, centre = whole.area, shapely.get_coordinates(whole.centroid)[0]
    shape = np.column_stack([np.ones(len(points)), (points - centre) / np.sqrt(area)])
    wrong = np.array([area, 0.0, 0.0]) - weights @ shape
    changed: Array = weights * (1.0 + shape @ np.linalg.solve((shape * weights[:, None]).T @ shape, wrong))
    return changed


def _convex(ring: Array) -> bool:
    before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    return bool((cross(before, after) > 0).all())


def _tensor(quad: Array, rule: tuple[Array, Array]) -> tuple[Array, Array]:
    """Return n x n points (n n, 2) of a quadrilateral (4, 2) by a rule on [0, 1], and their areas."""
    x, w = rule
    r, s = (v.ravel()[:, None] for v in np.meshgrid(x, x))
    a, b, c, d = quad
    points = (1 - r) * (1 - s) * a + r * (1 - s) * b + r * s * c + (1 - r) * s * d
    along, across = (1 - s) * (b - a) + s * (c - d), (1 - r) * (d - a) + r * (c - b)
    jacobian = cross(along, across)
    return points, np.outer(w, w).ravel() * jacobian


def _quadrilaterals(rings: list[Array]) -> list[Array]:
    """Return convex quadrilaterals (4, 2) that fill a polygon: its corners, halves of its sides and its centre."""
    outer = rings[0]
    if len(rings) == 1 and _convex(outer):
        cells = [outer]
    else:
        parts = shapely.get_parts(shapely.constrained_delaunay_triangles(shapely.Polygon(outer, rings[1:])))
        cells = [shapely.get_coordinates(shapely.orient_polygons(part))[:3] for part in parts]
    found = []
    for cell in cells:
        centre = polygon_moments(cell).centroid
        middle = 0.5 * (cell + np.roll(cell, -1, axis=0))
        before = np.roll(middle, 1, axis=0)
        found += [np.array([centre, m0, v, m1]) for m0, v, m1 in zip(before, cell, middle, strict=True)]
    return found


def _together(points: Array, weights: Array) -> tuple[Array, Array]:
    """Return points without those that several parts share, whose areas are added."""
    unit = 1e-9 * float(np.ptp(points, axis=0).max())
    keys, first, number = np.unique(np.round(points / unit), axis=0, return_index=True, return_inverse=True)
    return points[first], np.bincount(number.ravel(), weights, len(keys))
