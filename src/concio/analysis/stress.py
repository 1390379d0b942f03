"""Stresses of the bodies, tension positive: at integration points, at nodes, and the mean of each body."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from concio.fem.constitutive import principal
from concio.fem.discretisation import Discretisation

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Stress:
    """Stresses that follow from the displacements; rigid and fixed bodies have none (nan).

    Parameters
    ----------
    disc : Discretisation
    displacement : (N_all,) array
        [m].
    """

    disc: Discretisation
    displacement: Array

    def _u(self, b: int) -> Array:
        return self.displacement[self.disc.offsets[b] : self.disc.offsets[b + 1]]

    def at_points(self, b: int) -> tuple[Array, Array]:
        """Return integration points (q, 2) [m] and stresses (q, 3) = (s_x, s_y, t_xy) [kN/m2] of an elastic body."""
        shape = self.disc.shapes[self.disc.shape_of[b]]
        stress = (shape.stress_operator @ self._u(b)).reshape(-1, 3)
        return shape.elements.points + self.disc.origins[b], stress

    def at_nodes(self, b: int) -> Array:
        """Return nodal stresses (n, 3) of an elastic body: the least-squares fit to those at the points [kN/m2]."""
        shape = self.disc.shapes[self.disc.shape_of[b]]
        _, stress = self.at_points(b)
        el = shape.elements
        load = el.N.T @ (el.weights[:, None] * stress)
        nodal: Array = shape.projection @ load
        return nodal

    @cached_property
    def mean(self) -> Array:
        """Mean stress of each body of the model (B, 3) [kN/m2]."""
        found = np.full((len(self.disc.shape_of), 3), np.nan)
        for s, shape in enumerate(self.disc.shapes):
            bodies = np.flatnonzero(self.disc.shape_of == s)
            u = self.displacement[self.disc.offsets[bodies][:, None] + np.arange(shape.unknowns)]
            found[bodies] = u @ shape.mean_stress_operator.T
        return found

    @cached_property
    def principal(self) -> tuple[Array, Array, Array]:
        """Mean principal stresses of each body: s1 >= s2 [kN/m2] and the angle of s1 to the x axis [rad], each (B,)."""
        return principal(self.mean)
