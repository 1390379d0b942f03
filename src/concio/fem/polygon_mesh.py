"""Meshes of polygons that are not rectangles: mapped quadrilaterals where there are four corners, else triangles.

Nodes stand at every vertex of the outline and at every break point, where an interface begins or ends, so that contact
never begins inside an element edge. The span between them is divided into equal parts no longer than the target size.
Quadrilaterals may add nodes to a side (a line of the mesh that starts at a break ends on the opposite side);
triangles keep the subdivision of the boundary exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from concio.errors import GeometryError, InputError
from concio.fem.mapped_mesh import corners_of, mapped_quads
from concio.fem.triangulate import triangles
from concio.kinematics.frames import turning

Array = np.ndarray


@dataclass(frozen=True)
class MeshQuality:
    """Shape of the worst cell.

    Parameters
    ----------
    smallest_angle, largest_angle : float
        Over all corners of all cells [degrees].
    largest_aspect : float
        Longest side over shortest side of a cell.
    """

    smallest_angle: float
    largest_angle: float
    largest_aspect: float


def mesh_polygon(
    outline: Array,
    size: float,
    breaks: Sequence[Array] | None = None,
    *,
    quads: bool = True,
    holes: Sequence[Array] = (),
) -> tuple[Array, Array]:
    """Return points (n, 2) and cells (k, 4) or (k, 3), counter-clockwise, of a polygon.

    Parameters
    ----------
    outline : (v, 2) array
        Counter-clockwise, without the closing repetition [m].
    size : float
        Target element size [m].
    breaks : sequence of (k,) arrays, optional
        For each edge of the outline, then of the holes, distances from its first vertex that must be nodes [m].
    quads : bool
        False asks for triangles in any case; there are triangles where there are holes.
    holes : sequence of (k, 2) arrays
        Interior rings, clockwise [m].

    Raises
    ------
    GeometryError
        The outline or a hole crosses or touches itself or another.
    """
    outline = np.asarray(outline, dtype=float)
    if not (0 < size < np.inf):
        msg = f"mesh size = {size:g} must be positive and finite"
        raise InputError(msg, hint="give it in m, for example a quarter of a block's length")
    rings = [outline, *(np.asarray(hole, dtype=float) for hole in holes)]
    start, stop = np.concatenate(rings), np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])
    marks = boundary_marks(start, stop, breaks)
    if quads and not holes and (corners := corners_of(outline)) is not None:
        found = mapped_quads(outline, corners, marks, size)
        if found is not None:
            return found
    sides = [_divided(a, b, at, size) for a, b, at in zip(start, stop, marks, strict=True)]
    ends = np.cumsum([0] + [len(ring) for ring in rings])
    return triangles([np.concatenate(sides[i:j]) for i, j in pairwise(ends)], size)


def _divided(a: Array, b: Array, marks: Array, size: float) -> Array:
    """Return the points (k, 2) of a side from a to b without b: its marks, and equal parts between them."""
    at = []
    for start, stop in pairwise(marks):
        parts = max(1, int(np.ceil((stop - start) / size - 1e-6)))
        at.append(start + (stop - start) * np.arange(parts) / parts)
    result: Array = a + np.outer(np.concatenate(at) / marks[-1], b - a)
    return result


def boundary_marks(start: Array, stop: Array, breaks: Sequence[Array] | None) -> list[Array]:
    """Return for each side its increasing marks: 0, the breaks that are not at its ends, its length [m]."""
    length = np.hypot(*(stop - start).T)
    if (length <= 0).any():
        at = start[int(np.argmin(length))]
        msg = f"two neighbouring vertices coincide at ({at[0]:.6g}, {at[1]:.6g}) m"
        raise GeometryError(msg, hint="delete one of them")
    if breaks is not None and len(breaks) != len(start):
        msg = f"{len(breaks)} lists of break points for {len(start)} edges"
        raise InputError(msg, hint="give one list for each edge, empty where there are none")
    tolerance = 1e-6 * float(np.ptp(start, axis=0).max())
    result = []
    for e, full in enumerate(length):
        marks = [0.0]
        for value in np.sort(np.asarray(breaks[e] if breaks is not None else (), dtype=float)):
            if value - marks[-1] > tolerance and full - value > tolerance:
                marks.append(float(value))
        result.append(np.array([*marks, full]))
    return result


def mesh_quality(points: Array, cells: Array) -> MeshQuality:
    """Return the worst angles and the worst aspect of the cells (k, 3 or 4)."""
    x = points[cells]
    ahead, back = np.roll(x, -1, axis=1) - x, np.roll(x, 1, axis=1) - x
    angle = np.rad2deg(turning(ahead, back))
    angle = np.where(angle < 0, angle + 360, angle)
    side = np.hypot(ahead[..., 0], ahead[..., 1])
    return MeshQuality(float(angle.min()), float(angle.max()), float((side.max(1) / side.min(1)).max()))
