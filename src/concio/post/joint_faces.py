"""Joint faces in space as they are drawn: the piece of an interface that belongs to each contact pair.

The piece of a pair is what of the patch lies nearer to its point than to the points of the others, so that a face that
opens along a hinge shows the hinge.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from concio.kinematics.frames import cross
from concio.kinematics.rigid import swept
from concio.post.solids import body_motions_in_space
from concio.representation import short_repr

if TYPE_CHECKING:
    from concio.analysis.result import Result
    from concio.model.interfaces.patches import Patch

Array = np.ndarray

TINY = 1e-9
"""Share of a patch below which a piece of it is left out."""


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
    motion = body_motions_in_space(result, u)
    centroids, pairs = result.assembly.disc.centroids, result.assembly.pairs
    moved = []
    for side in (pairs.body_a[pair], pairs.body_b[pair]):
        arm = corners - centroids[side][:, None]
        moved.append(motion[side, None, :3] + swept(motion[side, None, 3:], arm))
    return JointFaces(corners, moved[0], moved[1], pair)


def pieces_of(result: Result) -> tuple[Array, Array]:
    """Return triangles (T, 3, 3) that cover the interfaces, and the pair (T,) of each."""
    pairs = result.assembly.pairs
    order = np.argsort(pairs.interface, kind="stable")
    bounds = np.searchsorted(pairs.interface[order], np.arange(len(result.assembly.detection.patches) + 1))
    corners, owner = [], []
    for k, patch in enumerate(result.assembly.detection.patches):
        own = order[bounds[k] : bounds[k + 1]]
        if not len(own):
            continue
        flat = patch.frame
        sites = (pairs.point[own] - patch.polygon[0]) @ flat.T
        for triangle in _triangles(patch):
            for j, pair in enumerate(own):
                cell = _cell(triangle, sites, j)
                if len(cell) < 3:
                    continue
                fan = np.array([(cell[0], cell[i], cell[i + 1]) for i in range(1, len(cell) - 1)])
                sizes = np.abs(cross(fan[:, 1] - fan[:, 0], fan[:, 2] - fan[:, 0]))
                fan = fan[sizes > TINY * patch.area]
                corners.append(patch.polygon[0] + fan @ flat)
                owner.append(np.full(len(fan), pair))
    if not corners:
        return np.zeros((0, 3, 3)), np.zeros(0, dtype=int)
    return np.vstack(corners), np.concatenate(owner)


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


def _cell(polygon: Array, sites: Array, j: int) -> Array:
    """Return what of a convex polygon (k, 2) lies nearest to site j of (n, 2)."""
    cell = polygon
    for i in range(len(sites)):
        if i == j or not len(cell):
            continue
        away = sites[i] - sites[j]
        if not away.any():
            continue
        side = (cell - 0.5 * (sites[i] + sites[j])) @ away
        if (side <= 0).all():
            continue
        kept = []
        for k in range(len(cell)):
            p, q, a, b = cell[k - 1], cell[k], side[k - 1], side[k]
            if (a <= 0) != (b <= 0):
                kept.append(p + a / (a - b) * (q - p))
            if b <= 0:
                kept.append(q)
        cell = np.array(kept).reshape(-1, 2)
    return cell
