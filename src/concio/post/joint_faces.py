"""Joint faces in space as they are drawn: the piece of an interface that belongs to each contact pair.

The piece of a pair is what of the patch lies nearer to its point than to the points of the others, so that a face that
opens along a hinge shows the hinge. Where bodies touch with a corner or an edge, it is a small octahedron.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from concio.kinematics.rigid import swept
from concio.post.body_motion import body_motions
from concio.representation import short_repr

if TYPE_CHECKING:
    from concio.analysis.result import Result
    from concio.model.interfaces.patch import Patch

Array = np.ndarray

TINY = 1e-9
"""Share of a patch below which a piece of it is left out."""

MARK = 0.08
"""Half the size of the mark of a corner that touches, over the size of the smaller body."""

OCTAHEDRON = np.array(
    [[[x, 0, 0], [0, y, 0], [0, 0, z]] if x * y * z > 0 else [[0, y, 0], [x, 0, 0], [0, 0, z]]
     for x in (1, -1) for y in (1, -1) for z in (1, -1)], dtype=float,
)  # fmt: skip
"""Triangles (8, 3, 3) of half a diagonal of one, counter-clockwise seen from outside."""


@short_repr
@dataclass(frozen=True, eq=False)
class JointFaces:
    """Triangles on the interfaces, T in all.

    Parameters
    ----------
    corners : (T, 3, 3) array
        [m].
    moved_a, moved_b : (T, 3, 3) arrays
        Displacements of the corners with the body on either side [m].
    pair : (T,) integer array
        Contact pair that each triangle belongs to.
    """

    corners: Array
    moved_a: Array
    moved_b: Array
    pair: Array


def joint_faces(result: Result, u: Array | None = None) -> JointFaces:
    """Return the pieces of all interfaces, moved with the bodies on their two sides.

    Parameters
    ----------
    result : Result
        Of a model in space.
    u : (N_all,) array, optional
        Displacements to show in place of the result's, such as a mechanism.
    """
    corners, pair = pieces_of(result)
    motion = body_motions(result, u)
    centroids, pairs = result.assembly.disc.centroids, result.assembly.pairs
    moved = []
    for side in (pairs.body_a[pair], pairs.body_b[pair]):
        arm = corners - centroids[side][:, None]
        moved.append(motion[side, None, :3] + swept(motion[side, None, 3:], arm))
    return JointFaces(corners, moved[0], moved[1], pair)


def pieces_of(result: Result) -> tuple[Array, Array]:
    """Return triangles (T, 3, 3) that cover the interfaces, and the pair (T,) of each."""
    pairs, patches = result.assembly.pairs, result.assembly.detection.patches
    order = np.argsort(pairs.interface, kind="stable")
    bounds = np.searchsorted(pairs.interface[order], np.arange(len(patches) + 1))
    alike: dict[tuple[int, int], list[tuple[int, Array]]] = {}
    for k, patch in enumerate(patches):
        count = int(bounds[k + 1] - bounds[k])
        for polygon in _triangles(patch) if count else ():
            alike.setdefault((len(polygon), count), []).append((k, polygon))
    corners, owner = [np.zeros((0, 3, 3))], [np.zeros(0, dtype=int)]
    for (_, count), group in alike.items():
        number = np.array([k for k, _ in group])
        own = order[bounds[number][:, None] + np.arange(count)]  # (g, n)
        frame = np.array([patches[k].frame for k in number])  # (g, 2, 3)
        origin = np.array([patches[k].polygon[0] for k in number])
        sites = np.einsum("gnd,gcd->gnc", pairs.point[own] - origin[:, None], frame)
        cells, sides = _nearest(np.array([polygon for _, polygon in group]), sites)
        area = np.array([patches[k].area for k in number])
        for j in range(1, cells.shape[2] - 1):  # a fan from the first corner of each cell
            fan = cells[:, :, [0, j, j + 1]]
            p, q = fan[:, :, 1] - fan[:, :, 0], fan[:, :, 2] - fan[:, :, 0]
            size = np.abs(p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0])
            g, n = np.nonzero((j + 1 < sides) & (size > TINY * area[:, None]))
            corners.append(origin[g, None] + np.einsum("tvc,tcd->tvd", fan[g, n], frame[g]))
            owner.append(own[g, n])
    marks, marked = _point_marks(result)
    corners.append(marks)
    owner.append(marked)
    pair = np.concatenate(owner)
    first = np.argsort(pair, kind="stable")
    return np.concatenate(corners)[first], pair[first]


def _point_marks(result: Result) -> tuple[Array, Array]:
    """Return octahedra (T, 3, 3) where bodies touch without a common face, and their pairs (T,)."""
    pairs, detection = result.assembly.pairs, result.assembly.detection
    pair = np.flatnonzero(pairs.interface >= len(detection.patches))
    size = np.array([MARK * detection.interfaces[k].scale for k in pairs.interface[pair].tolist()])
    found = pairs.point[pair][:, None, None] + size[:, None, None, None] * OCTAHEDRON
    return found.reshape(-1, 3, 3), np.repeat(pair, len(OCTAHEDRON))


def _triangles(patch: Patch) -> list[Array]:
    """Return triangles (3, 2) in the frame of the patch; one convex polygon where it is convex."""
    import shapely

    rings = [(ring - patch.polygon[0]) @ patch.frame.T for ring in (patch.polygon, *patch.holes)]
    turn = np.diff(np.vstack([rings[0], rings[0][:2]]), axis=0)
    if len(rings) == 1 and (turn[:-1, 0] * turn[1:, 1] - turn[:-1, 1] * turn[1:, 0] >= -1e-12).all():
        return [rings[0]]
    shape = shapely.Polygon(rings[0], rings[1:])
    parts = shapely.get_parts(shapely.constrained_delaunay_triangles(shape))
    return [shapely.get_coordinates(part)[:3] for part in parts]


def _nearest(polygons: Array, sites: Array) -> tuple[Array, Array]:
    """Return of convex polygons (g, k, 2) what lies nearest to each of their sites (g, n, 2).

    The cells (g, n, m, 2) and their numbers of corners (g, n); what follows the last corner means nothing.
    """
    groups, n = sites.shape[:2]
    cell = np.repeat(polygons, n, axis=0)  # (g n, m, 2)
    count = np.full(len(cell), polygons.shape[1])
    own = sites.reshape(-1, 2)
    for i in range(n):
        other = np.repeat(sites[:, i], n, axis=0)
        away = other - own
        cell, count = _halved(cell, count, 0.5 * (other + own), away)
    return cell.reshape(groups, n, -1, 2), count.reshape(groups, n)


def _halved(cell: Array, count: Array, at: Array, away: Array) -> tuple[Array, Array]:
    """Return convex polygons (b, m, 2) of ``count`` corners without what lies beyond lines through ``at``."""
    rows, room = np.arange(len(cell)), cell.shape[1]
    side = np.einsum("bmc,bc->bm", cell - at[:, None], away)
    real = np.arange(room) < count[:, None]
    before = np.where(np.arange(room) > 0, np.arange(room) - 1, np.maximum(count, 1)[:, None] - 1)
    behind, inside = side[rows[:, None], before], side <= 0
    crosses = real & (inside != (behind <= 0))
    keeps = real & inside
    if not crosses.any():
        return cell, np.where(keeps.any(axis=1), count, 0)
    place = np.cumsum(crosses.astype(int) + keeps, axis=1)
    fresh = np.zeros((len(cell), int(place[:, -1].max(initial=0)), 2))
    b, m = np.nonzero(crosses)
    last = cell[b, before[b, m]]
    share = behind[b, m] / (behind[b, m] - side[b, m])
    fresh[b, place[b, m] - 1 - keeps[b, m]] = last + share[:, None] * (cell[b, m] - last)
    b, m = np.nonzero(keeps)
    fresh[b, place[b, m] - 1] = cell[b, m]
    return fresh, place[:, -1]
