r"""Rotations of rigid bodies as unknowns: an angle in the plane, components along the principal axes in space.

In its principal axes, which turn with it, the inertia of a body is diagonal and constant, and a rotation about a fixed
axis is what it is in the plane. What turns a body has there the law of Euler,

.. math:: J \dot\Omega = m - \Omega \times J \Omega ,

whose last term, the gyroscopic moment, does no work and is zero in the plane.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from concio.kinematics.frames import cross
from concio.kinematics.turns import Turns

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class SpinAxes:
    """The principal axes of B bodies as described.

    Parameters
    ----------
    axes : (B, 3, 3) array, or None in the plane
        Unit vectors as columns, right-handed.

    Examples
    --------
    >>> import numpy as np
    >>> from concio.kinematics.spins import SpinAxes
    >>> from concio.kinematics.turns import Turns
    >>> plane = SpinAxes(None)
    >>> plane.own(np.array([0.5]), np.array([0]), Turns.of(np.zeros(1))).tolist()
    [[0.5]]
    """

    axes: Array | None

    @classmethod
    def of(cls, inertia: Sequence[Array]) -> SpinAxes:
        """Return the principal axes of tensors of inertia, (1, 1) each in the plane or (3, 3) in space."""
        if not len(inertia) or inertia[0].shape == (1, 1):
            return cls(None)
        axes = np.linalg.eigh(np.array(inertia))[1]
        axes[np.linalg.det(axes) < 0, :, 0] *= -1.0
        return cls(axes)

    @property
    def count(self) -> int:
        """Components of a rotation: one in the plane, three in space."""
        return 1 if self.axes is None else 3

    def placed(self, body: Array, turn: Turns) -> Array:
        """Return the axes (k, 3, 3) of bodies (k,) where rotations ``turn`` of all bodies have brought them."""
        assert self.axes is not None, "bodies in space"
        return orthonormal(turn.values[body] @ self.axes[body])  # rounding that stays the same would add up

    def own(self, spin: Array, body: Array, turn: Turns) -> Array:
        """Return spins or moments of bodies (k,), (k,) in the plane and (k, ..., 3) in space, along their own axes.

        The result is (k, 1) in the plane and (k, ..., 3) in space.
        """
        if self.axes is None:
            return spin[:, None]
        return np.asarray(np.einsum("kji,k...j->k...i", self.placed(body, turn), spin))

    def outward(self, own: Array, body: Array, turn: Turns) -> Array:
        """Return what components (k, 1) or (k, 3) along their own axes of bodies (k,) are in the plane or in space."""
        if self.axes is None:
            return own[:, 0]
        return np.asarray(np.einsum("kij,kj->ki", self.placed(body, turn), own))


def gyroscopic(inertia: Array, spin: Array) -> Array:
    """Return the gyroscopic moments (k, 1 or 3) of bodies that spin, along their own axes [kN m].

    Parameters
    ----------
    inertia : (k, 1 or 3) array
        Principal moments of inertia [t m2].
    spin : (k, 1 or 3) array
        Along the same axes [rad/s].
    """
    if spin.shape[-1] == 1:
        return np.zeros_like(spin)
    return -cross(spin, inertia * spin)


def orthonormal(matrix: Array) -> Array:
    """Return rotation matrices (..., 3, 3) without the rounding that products of many have gathered."""
    return np.asarray(1.5 * matrix - 0.5 * matrix @ (np.swapaxes(matrix, -1, -2) @ matrix))


def rotation_vector(matrix: Array) -> Array:
    """Return the vectors (..., 3) of rotations (..., 3, 3), of a length between 0 and pi [rad]."""
    off = matrix - np.swapaxes(matrix, -1, -2)
    axial = 0.5 * np.stack([off[..., 2, 1], off[..., 0, 2], off[..., 1, 0]], axis=-1)
    sine = np.linalg.norm(axial, axis=-1)
    cosine = 0.5 * (np.trace(matrix, axis1=-2, axis2=-1) - 1.0)
    angle = np.arctan2(sine, cosine)
    far = cosine < -0.9  # near a half turn the sine says little of the axis: the symmetric part has it
    scale = np.where(sine > 0, angle / np.where(sine > 0, sine, 1.0), 1.0)
    found = scale[..., None] * axial
    if np.any(far):
        even = 0.5 * (matrix + np.swapaxes(matrix, -1, -2)) - cosine[..., None, None] * np.eye(3)
        column = np.argmax(np.einsum("...ii->...i", even), axis=-1)
        axis = np.take_along_axis(even, column[..., None, None], axis=-1)[..., 0]
        size = np.linalg.norm(axis, axis=-1)[..., None]
        axis = axis / np.where(size > 0, size, 1.0)
        sign = np.where((axis * axial).sum(-1) < 0, -1.0, 1.0)
        found = np.where(far[..., None], (sign * angle)[..., None] * axis, found)
    return np.asarray(found)


def turned_from(before: Array, after: Array) -> Array:
    """Return the rotations between two placements: angles (k,) in the plane, vectors (k, 3) in space [rad]."""
    if before.ndim == 1:
        return np.asarray(after - before)
    return rotation_vector(after @ np.swapaxes(before, 1, 2))


def turned_by(rotation: Array) -> Array:
    """Return by how much bodies have turned (k,), from angles (k,) in the plane or matrices (k, 3, 3) [rad]."""
    if rotation.ndim == 1:
        return np.asarray(np.abs(rotation))
    return np.asarray(np.linalg.norm(rotation_vector(rotation), axis=-1))
