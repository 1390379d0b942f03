"""Where each body is: the position of its centroid and its rotation, apart from what it is made of."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from concio.kinematics.rigid import plane_rotation, rotation_matrix, swept
from concio.kinematics.spins import orthonormal
from concio.kinematics.turns import Turns

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Placement:
    """Placements of B bodies.

    Parameters
    ----------
    centre : (B, d) array
        Positions of the centroids [m].
    rotation : (B,) array in the plane, (B, 3, 3) in space
        Angles from the reference, anticlockwise and not wrapped [rad]; rotation matrices in space.
    """

    centre: Array
    rotation: Array

    @classmethod
    def at_rest(cls, centre: Array) -> Placement:
        """Return the placement of bodies where they were described."""
        count, dim = centre.shape
        return cls(centre.copy(), np.zeros(count) if dim == 2 else np.tile(np.eye(3), (count, 1, 1)))

    @property
    def dim(self) -> int:
        """Space dimension, 2 or 3."""
        return int(self.centre.shape[1])

    @property
    def no_spin(self) -> Array:
        """Spins of bodies that do not turn: (B,) in the plane, (B, 3) in space."""
        return np.zeros(len(self.centre) if self.dim == 2 else self.centre.shape)

    @cached_property
    def matrix(self) -> Array:
        """Rotation matrices (B, d, d)."""
        if self.dim == 3:
            return self.rotation
        return plane_rotation(self.rotation)

    @cached_property
    def turns(self) -> Turns:
        """Rotations (B,), ready to be applied to vectors."""
        return Turns.of(self.rotation)

    def moved(self, translation: Array, turn: Array) -> Placement:
        """Return the placement after a displacement of the centroids and a finite rotation about them.

        Parameters
        ----------
        translation : (B, d) array
            [m].
        turn : (B,) array in the plane, (B, 3) in space
            [rad].
        """
        if self.dim == 2:
            return Placement(self.centre + translation, self.rotation + turn)
        return Placement(self.centre + translation, orthonormal(rotation_matrix(turn) @ self.rotation))

    def screwed(self, shift: Array, turn: Array) -> Placement:
        """Return the placement after motions of constant velocity that turns with the body: exact about fixed axes.

        Parameters
        ----------
        shift : (B, d) array
            Displacements of the centroids if they did not turn [m].
        turn : (B,) array in the plane, (B, 3) in space
            [rad].
        """
        angle = (turn if self.dim == 2 else np.linalg.norm(turn, axis=1))[:, None]
        across = swept(turn, shift)
        small = np.abs(angle) < 1e-4
        safe = np.where(small, 1.0, angle)
        versine = 0.5 * np.sinc(angle / (2 * np.pi)) ** 2
        third = np.where(small, 1.0 / 6.0, (safe - np.sin(safe)) / safe**3)
        return self.moved(shift + versine * across + third * swept(turn, across), turn)

    def points(self, body: Array, arm: Array) -> Array:
        """Return the positions (k, d) of points at reference arms (k, d) of bodies (k,) [m]."""
        return np.asarray(self.centre[body] + self.turns[body].apply(arm))
