"""The common polygon of two faces in space."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
import shapely

from concio.kinematics.frames import tangents, turned_left
from concio.kinematics.mass import polygon_moments

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Patch:
    """The common polygon of two faces that face each other.

    Parameters
    ----------
    a, b : int
        Indices of the bodies, ``a < b``.
    face_a, face_b : int
        Numbers of the faces.
    polygon : (k, 3) array
        Boundary on the face of ``a``, counter-clockwise about the normal [m].
    normal : (3,) array
        Unit normal from a to b.
    gap : (k,) array
        Initial gap at the vertices of the boundary, zero or positive [m]; zero wherever the faces are within the
        tolerance.
    signed_gap : (k,) array
        Distance as drawn, negative where the faces overlap (by at most the tolerance) [m].
    area : float
        [m2].
    holes : tuple of (h, 3) arrays
        Boundaries of holes, clockwise about the normal [m].
    """

    a: int
    b: int
    face_a: int
    face_b: int
    polygon: Array
    normal: Array
    gap: Array
    signed_gap: Array
    area: float
    holes: tuple[Array, ...] = ()

    dim: ClassVar[int] = 3

    def __repr__(self) -> str:
        return f"Patch({self.a}-{self.b}, {len(self.polygon)} vertices, area {self.area:.4g} m2)"

    @cached_property
    def frame(self) -> Array:
        """The two tangents (2, 3), right-handed with the normal."""
        return tangents(self.normal)

    @cached_property
    def middle(self) -> Array:
        """Centroid (3,) [m]."""
        flat = (self.polygon - self.polygon[0]) @ self.frame.T
        holes = [(hole - self.polygon[0]) @ self.frame.T for hole in self.holes]
        return np.asarray(self.polygon[0] + polygon_moments(flat, holes).centroid @ self.frame)

    @property
    def size(self) -> float:
        """Longest side of the box around it in its plane [m]."""
        return float(np.ptp(self.polygon @ self.frame.T, axis=0).max())

    @property
    def width(self) -> float:
        """Least distance between two parallel lines that hold it between them, however it is turned [m]."""
        hull = shapely.convex_hull(shapely.multipoints((self.polygon - self.polygon[0]) @ self.frame.T))
        flat = shapely.get_coordinates(hull)[:-1]
        along = np.roll(flat, -1, axis=0) - flat  # one of the lines lies on a side of the hull
        across = turned_left(along) / np.linalg.norm(along, axis=1)[:, None]
        return float(np.ptp(flat @ across.T, axis=0).min())

    def gap_at(self, points: Array) -> Array:
        """Return the initial gap (n,) at points (n, 3) of the patch, zero or positive [m]."""
        if not self.gap.any():
            return np.zeros(len(points))
        flat = (self.polygon - self.polygon[0]) @ self.frame.T
        system = np.column_stack([np.ones(len(flat)), flat])
        plane, *_ = np.linalg.lstsq(system, self.signed_gap, rcond=None)
        arm = (points - self.polygon[0]) @ self.frame.T
        return np.asarray(np.maximum(plane[0] + arm @ plane[1:], 0.0))
