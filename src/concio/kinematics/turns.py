"""Rotations of many bodies, applied to vectors: the same calls in the plane and in space."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Turns:
    """Rotations of k bodies.

    In the plane a rotation is kept as the complex number e^(i angle): one product of complex numbers turns a vector,
    which is what the steps of a motion do most. Nothing outside of this class sees that; vectors go in and come out.

    Parameters
    ----------
    values : (k,) complex array in the plane, (k, 3, 3) array in space
        Rotation matrices in space.

    Examples
    --------
    >>> import numpy as np
    >>> from concio.kinematics.turns import Turns
    >>> Turns.of(np.array([np.pi / 2])).apply(np.array([[1.0, 0.0]])).round(12).tolist()
    [[0.0, 1.0]]
    """

    values: Array

    @classmethod
    def of(cls, rotation: Array) -> Turns:
        """Return the rotations by angles (k,) [rad], or of matrices (k, 3, 3)."""
        return cls(np.exp(1j * rotation) if rotation.ndim == 1 else rotation)

    def __getitem__(self, which: Any) -> Turns:
        """Return the rotations picked by numbers or by a mask."""
        return Turns(self.values[which])

    def __len__(self) -> int:
        return len(self.values)

    def apply(self, vector: Array) -> Array:
        """Return vectors (k, ..., d) turned, the first axis that of the rotations."""
        if self.values.ndim == 3:
            return np.asarray(np.einsum("kij,k...j->k...i", self.values, vector))
        return _from_complex(_fitting(self.values, vector) * _as_complex(vector))

    def undo(self, vector: Array) -> Array:
        """Return vectors (k, ..., d) turned back."""
        if self.values.ndim == 3:
            return np.asarray(np.einsum("kji,k...j->k...i", self.values, vector))
        return _from_complex(_fitting(np.conj(self.values), vector) * _as_complex(vector))

    @property
    def cosine(self) -> Array:
        """Cosines (k,) of the angles, in the plane."""
        return np.asarray(self.values.real)

    @property
    def sine(self) -> Array:
        """Sines (k,) of the angles, in the plane."""
        return np.asarray(self.values.imag)


def _fitting(values: Array, vector: Array) -> Array:
    """Return values (k,) with as many axes as there are of vectors."""
    return values if vector.ndim == 2 else values.reshape(-1, *(1,) * (vector.ndim - 2))


def _as_complex(v: Array) -> Array:
    """Return plane vectors (..., 2) as complex numbers (...)."""
    return np.ascontiguousarray(v, dtype=float).view(complex)[..., 0]


def _from_complex(z: Array) -> Array:
    """Return complex numbers (...) as plane vectors (..., 2)."""
    return z.view(float).reshape(*z.shape, 2)
