"""A contact without area: two bodies that touch at a corner or along an edge."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from concio.kinematics.frames import tangents

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class PointContact:
    """A place where two bodies touch without a common face: one point, or the two ends of a piece of an edge.

    Parameters
    ----------
    a, b : int
        Indices of the bodies, ``a < b``.
    kind : str
        What meets, the feature of a first: "corner-face", "edge-face", "edge-edge", "corner-corner" and so on.
    points : (k, d) array
        One point or two, on ``a`` [m].
    normal : (d,) array
        Unit normal from a to b.
    gap : (k,) array
        Initial gap, zero or positive [m]; zero wherever the bodies are within the tolerance.
    signed_gap : (k,) array
        Distance as drawn, negative where the bodies overlap (by at most the tolerance) [m].
    scale : float
        Size of the smaller body, what a motion is large beside [m].
    """

    a: int
    b: int
    kind: str
    points: Array
    normal: Array
    gap: Array
    signed_gap: Array
    scale: float

    area: float = 0.0

    def __repr__(self) -> str:
        return f"PointContact({self.a}-{self.b}, {self.kind}, at {self.middle.tolist()})"

    @property
    def dim(self) -> int:
        """Space dimension, 2 or 3."""
        return int(self.points.shape[1])

    @cached_property
    def middle(self) -> Array:
        """The point, or the middle of the piece of an edge (d,) [m]."""
        return np.asarray(self.points.mean(0))

    @property
    def length(self) -> float:
        """Length of the piece of an edge, 0 of a point [m]."""
        return float(np.linalg.norm(self.points[-1] - self.points[0]))

    @property
    def size(self) -> float:
        """Length of the piece of an edge, 0 of a point [m]."""
        return self.length

    @property
    def width(self) -> float:
        """Size of the smaller body [m]; what a motion is large beside."""
        return self.scale

    @cached_property
    def frame(self) -> Array:
        """The tangents (d - 1, d), right-handed with the normal."""
        return tangents(self.normal)

    @property
    def ambiguous(self) -> bool:
        """Whether many directions keep the bodies apart there: none of the features is a face."""
        words = self.kind.split("-")
        return "face" not in words and ("corner" in words or self.dim == 2 or len(self.points) > 1)
