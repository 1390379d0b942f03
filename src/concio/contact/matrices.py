"""Masses and stiffnesses of all bodies in their own frames: one matrix a shape, whatever the placement.

Lumped masses are the same in every direction, so that a M + b K of a body in its own frame does not change as the body
turns. Unknowns that a support holds keep their place with a mass of their own and nothing else.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from concio.fem.discretisation import Discretisation

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class BodyMatrices:
    """M (diagonal) and K (one block for each meshed body).

    Parameters
    ----------
    mass : (N,) array
        [t].
    shapes : tuple of (K, unknowns)
        Stiffness (2n, 2n) of each shape [kN/m] and the unknowns (b, 2n) of its bodies.
    held : (N,) boolean array
        Unknowns that do not move.
    """

    mass: Array
    shapes: tuple[tuple[sp.csr_array, Array], ...]
    held: Array

    @classmethod
    def of(cls, disc: Discretisation, mass: Array, held: Array) -> BodyMatrices:
        """Return the matrices of a discretised model."""
        shapes = []
        for s, shape in enumerate(disc.shapes):
            bodies = np.flatnonzero(disc.shape_of == s)
            if len(bodies):
                shapes.append((shape.K, disc.offsets[bodies][:, None] + np.arange(shape.unknowns)))
        return cls(mass, tuple(shapes), held)

    @property
    def elastic(self) -> bool:
        """Whether any body deforms."""
        return bool(self.shapes)

    def stiffness(self, x: Array) -> Array:
        """Return K x (N,)."""
        y = np.zeros_like(x)
        for K, unknowns in self.shapes:
            y[unknowns] = (K @ x[unknowns].T).T
        return y

    def entries(self, mass: float, stiffness: float) -> tuple[Array, Array, Array]:
        """Return rows, columns, values of ``mass`` M + ``stiffness`` K without what is held, all of the diagonal."""
        n = len(self.mass)
        rows, columns, values = [np.arange(n)], [np.arange(n)], [mass * self.mass]
        for K, unknowns in self.shapes:
            coo = K.tocoo()
            for own in unknowns:
                keep = ~(self.held[own[coo.row]] | self.held[own[coo.col]])
                rows.append(own[coo.row][keep])
                columns.append(own[coo.col][keep])
                values.append(stiffness * coo.data[keep])
        return np.concatenate(rows), np.concatenate(columns), np.concatenate(values)
