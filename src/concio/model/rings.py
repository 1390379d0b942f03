"""The rings of a polygon: its outline and its holes, checked and put the right way round."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from concio.errors import GeometryError
from concio.kinematics.mass import signed_area
from concio.model.limits import LARGEST_COORDINATE

Array = np.ndarray


def checked_ring(points: Array, what: str, where: str, *, clockwise: bool = False) -> Array:
    """Return a ring (n, 2) without the closing repetition, counter-clockwise or clockwise, not to be written to."""
    try:
        ring = np.array(points, dtype=float)
    except (TypeError, ValueError):
        msg = f"{what} is not a list of points (x, y)"
        raise GeometryError(msg, where=where) from None
    if ring.ndim != 2 or ring.shape[1] != 2:
        msg = f"{what} has shape {ring.shape}, expected (n, 2)"
        raise GeometryError(msg, where=where)
    if not np.isfinite(ring).all():
        msg = f"{what} holds a coordinate that is not finite"
        raise GeometryError(msg, where=where)
    if ring.size and np.abs(ring).max() >= LARGEST_COORDINATE:
        msg = f"{what} holds a coordinate of {np.abs(ring).max():g} m"
        raise GeometryError(msg, where=where, hint="no structure is that large: look at the number, and at its unit")
    if len(ring) > 1 and np.array_equal(ring[0], ring[-1]):
        ring = ring[:-1]
    if len(ring) < 3:
        msg = f"{what} has {len(ring)} different vertices, a polygon needs at least 3"
        raise GeometryError(msg, where=where)
    area = signed_area(ring)
    if abs(area) <= 1e-12 * np.ptp(ring, axis=0).max() ** 2:
        msg = f"{what} has no area"
        raise GeometryError(msg, where=where)
    if (area < 0) != clockwise:
        ring = ring[::-1].copy()
    ring.setflags(write=False)
    return ring


def following(counts: Sequence[int]) -> Array:
    """Return the number of the vertex that comes after each, for rings of ``counts`` vertices one after the other."""
    first = np.concatenate([[0], np.cumsum(counts)])
    number = np.arange(first[-1]) + 1
    number[first[1:] - 1] = first[:-1]
    return number


def check_holes(outline: Array, holes: Sequence[Array], where: str) -> None:
    """Refuse holes that leave the outline, touch it or each other.

    Raises
    ------
    GeometryError
    """
    shape = shapely.Polygon(outline)
    if not shape.is_valid:  # told where outlines are checked
        return
    rings = [shapely.Polygon(hole) for hole in holes]
    for k, ring in enumerate(rings):
        x, y = (float(v) for v in holes[k][0])
        at = f"at ({x:.6g}, {y:.6g}) m"
        if not ring.is_valid:
            msg = f"hole {k + 1} {at} crosses itself: {shapely.is_valid_reason(ring)}"
            raise GeometryError(msg, where=where, hint="give its vertices in order")
        if not shapely.contains_properly(shape, ring):
            msg = f"hole {k + 1} {at} does not lie inside the outline, clear of it"
            raise GeometryError(msg, where=where, hint="a notch that reaches the outline belongs to the outline")
        for j in range(k):
            if ring.intersects(rings[j]):
                msg = f"holes {j + 1} and {k + 1} touch or overlap {at}"
                raise GeometryError(msg, where=where, hint="make one hole of them")
