"""Stresses of the bodies, tension positive: at integration points, at nodes, and the mean of each body."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from concio.errors import InputError
from concio.fem.constitutive import principal, principal_in_space
from concio.fem.discretisation import Discretisation
from concio.read_only import locked, read_only
from concio.representation import short_repr

Array = np.ndarray


@short_repr
@dataclass(frozen=True, eq=False)
@read_only
class Stress:
    """Stresses that follow from the displacements; rigid and fixed bodies have none (nan).

    Parameters
    ----------
    disc : Discretisation
    displacement : (N_all,) array
        Less what bodies expand by where their temperature changes [m].

    Examples
    --------
    The vertical stress of blocks under a pressure of 100 kN/m2, without weight:

    >>> import concio
    >>> pillar = concio.column(width=0.5, height=2.0, blocks=4, top_pressure=100.0, unit_weight=0.0)
    >>> result = concio.solve(pillar)
    >>> result.stress.mean[result.body_index("b02"), 1].round(6).item()
    -100.0
    """

    disc: Discretisation
    displacement: Array

    def _u(self, b: int) -> Array:
        return self.displacement[self.disc.offsets[b] : self.disc.offsets[b + 1]]

    def at_points(self, b: int) -> tuple[Array, Array]:
        """Return integration points (q, d) [m] and stresses (q, s) [kN/m2] of an elastic body.

        In the plane (s_x, s_y, t_xy), in space (s_x, s_y, s_z, t_xy, t_yz, t_xz).
        """
        shape = self.disc.shapes[self.disc.shape_of[b]]
        stress = (shape.stress_operator @ self._u(b)).reshape(-1, len(shape.D))
        return shape.elements.points + self.disc.origins[b], stress

    def at_nodes(self, b: int) -> Array:
        """Return nodal stresses (n, s) of an elastic body: the least-squares fit to those at the points [kN/m2]."""
        shape = self.disc.shapes[self.disc.shape_of[b]]
        _, stress = self.at_points(b)
        el = shape.elements
        load = el.N.T @ (el.weights[:, None] * stress)
        nodal: Array = shape.projection @ load
        return nodal

    @cached_property
    def mean(self) -> Array:
        """Mean stress of each body of the model (B, s) [kN/m2]."""
        found = np.full((len(self.disc.shape_of), 3 if self.disc.dim == 2 else 6), np.nan)
        for s, shape in enumerate(self.disc.shapes):
            bodies = np.flatnonzero(self.disc.shape_of == s)
            u = self.displacement[self.disc.offsets[bodies][:, None] + np.arange(shape.unknowns)]
            found[bodies] = u @ shape.mean_stress_operator.T
        return locked(found)

    @cached_property
    def principal(self) -> tuple[Array, Array, Array]:
        """Mean principal stresses of each body: s1 >= s2 [kN/m2] and the angle of s1 to the x axis [rad], each (B,).

        Of plane models; in space see :attr:`principal_in_space`.
        """
        if self.mean.shape[1] != 3:
            msg = "stresses in space have three principal values"
            raise InputError(msg, hint="they are in stress.principal_in_space")
        s1, s2, angle = principal(self.mean)
        return locked(s1), locked(s2), locked(angle)

    @cached_property
    def principal_in_space(self) -> tuple[Array, Array]:
        """Mean principal stresses (B, 3) of each body, s1 >= s2 >= s3 [kN/m2], and directions (B, 3, 3), one a row."""
        if self.mean.shape[1] != 6:
            msg = "the stresses of a plane model have no directions in space"
            raise InputError(msg, hint="they are in stress.principal")
        values, directions = principal_in_space(self.mean)
        return locked(values), locked(directions)
