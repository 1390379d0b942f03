r"""A periodic cell with its macroscopic quantities: volume, stress, and the problem in which strains are unknowns.

With V the volume of the cell and s the shift of a pair's image, the work of the contact forces F = t_n n + t_t t (on
side b) along the macroscopic strain E is that of the stress

.. math:: \Sigma = -\frac{1}{V} \sum_k F_k \otimes s_k ,

tension positive like any stress of bodies. It is symmetric because every body is in balance of moments; that it comes
out so is part of every certificate. Where the components of a macroscopic stress are given, the strains that go with
them are unknowns of the contact problem like the motions of one more body, which carries no stiffness of its own and is
loaded by V \Sigma: equilibrium of that body is :math:`V \Sigma = -\sum F \otimes s`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from concio.contact.assembly import Assembly, assemble
from concio.contact.macroscopic_strain import COMPONENTS, STRAINS, strain_columns
from concio.errors import InputError
from concio.kinematics.frames import cross
from concio.model.model import Model
from concio.problem.contact_problem import ContactProblem
from concio.representation import short_repr

Array = np.ndarray
Three = Sequence[float] | np.ndarray

ALL = (True, True, True)


@short_repr
@dataclass(frozen=True, eq=False)
class PeriodicCell:
    """An assembled cell.

    Parameters
    ----------
    assembly : Assembly
        Of a model with periods.
    """

    assembly: Assembly

    @classmethod
    def of(cls, cell: Model | Assembly | PeriodicCell) -> PeriodicCell:
        """Return the cell of a model with periods.

        Raises
        ------
        InputError
            The model has no periods, or cannot be assembled.
        """
        if isinstance(cell, PeriodicCell):
            return cell
        assembly = cell if isinstance(cell, Assembly) else assemble(cell)
        if assembly.model.periods is None:
            msg = "this model has no periods: it is not a cell"
            raise InputError(msg, hint="concio.cell makes one; periods = [[x1, y1], [x2, y2]] make any blocks one")
        return cls(assembly)

    @property
    def model(self) -> Model:
        """The model of the cell."""
        return self.assembly.model

    @cached_property
    def periods(self) -> Array:
        """The two periods as rows, (2, 2) [m]."""
        return np.asarray(self.model.periods, dtype=float)

    @cached_property
    def volume(self) -> float:
        """Area of the cell times its thickness [m3]."""
        return abs(float(np.linalg.det(self.periods))) * self.model.bodies[0].thickness

    @cached_property
    def size(self) -> float:
        """Root of the area of the cell [m]: strains times it are the unknowns of :meth:`problem`."""
        return float(np.sqrt(abs(np.linalg.det(self.periods))))

    @cached_property
    def columns(self) -> tuple[Array, Array]:
        """Relative displacements of the pairs along n and t, (m, 3), under unit macroscopic strains [m]."""
        return strain_columns(self.assembly.pairs, self.assembly.detection.segments)

    def stress(self, normal_force: Array, friction_force: Array) -> Array:
        """Return the macroscopic stress (3,) or (3, k) of contact forces (m,) or (m, k) [kN/m2]."""
        normal, tangential = self.columns
        found: Array = -(normal.T @ normal_force + tangential.T @ friction_force) / self.volume
        return found

    def turning(self, normal_force: Array, friction_force: Array) -> float:
        """Return half the difference of the stresses xy and yx of contact forces (m,), zero in balance [kN/m2]."""
        pairs, faces = self.assembly.pairs, self.assembly.detection.segments
        shift = np.array([face.shift for face in faces], dtype=float).reshape(-1, 2)[pairs.interface]
        force = normal_force[:, None] * pairs.normal + friction_force[:, None] * pairs.tangent
        return float(cross(force, shift).sum()) / (2 * self.volume)

    def problem(
        self, stress: Three = (0.0, 0.0, 0.0), strain: Three = (0.0, 0.0, 0.0), free: Sequence[bool] = ALL
    ) -> ContactProblem:
        """Return the contact problem in which some strains are unknowns under given stresses, the others given.

        Parameters
        ----------
        stress, strain : (3,)
            Components xx, yy, xy; of each the stress counts where the strain is free, else the strain.
        free : (3,) of bool
            Which strains are unknowns; they come after the displacements, times :attr:`size`.
        """
        loose = np.asarray(free, dtype=bool)
        base = self.assembly.problem({name: 0.0 for name in STRAINS})
        normal, tangential = self.columns
        given = np.where(loose, 0.0, np.asarray(strain, dtype=float))
        load = np.asarray(stress, dtype=float)[loose] * self.volume / self.size
        count, size = int(loose.sum()), self.size
        mass = float(base.inertia.diagonal().mean())
        nothing = sp.csr_array((count, count))
        return replace(
            base,
            K=sp.csr_array(sp.block_diag([base.K, nothing], format="csr")) if count else base.K,
            f=np.concatenate([base.f, load]),
            C_n=sp.csr_array(sp.hstack([base.C_n, sp.csr_array(normal[:, loose] / size)])),
            C_t=sp.csr_array(sp.hstack([base.C_t, sp.csr_array(tangential[:, loose] / size)])),
            gap=base.gap + normal @ given,
            slip_origin=base.slip_origin - (tangential @ given)[:, None],
            R=sp.csc_array(sp.block_diag([base.R, sp.eye_array(count)], format="csc")) if count else base.R,
            bodies=np.concatenate([base.bodies, [base.bodies[-1] + count]]) if count else base.bodies,
            inertia=sp.csr_array(sp.block_diag([base.inertia, mass * sp.eye_array(count)], format="csr")),
            load=0.0,
        )

    def load(self, stress: Three) -> Array:
        """Return the loads (N + 3,) that a macroscopic stress stands for in :meth:`problem` with free strains [kN]."""
        f = np.zeros(self.assembly.supported.T.shape[1] + 3)
        f[-3:] = np.asarray(stress, dtype=float) * self.volume / self.size
        return f


def component(name: str) -> int:
    """Return the number of a component "xx", "yy" or "xy".

    Raises
    ------
    InputError
    """
    if name not in COMPONENTS:
        msg = f"there is no component '{name}'"
        raise InputError(msg, hint="one of " + ", ".join(COMPONENTS))
    return COMPONENTS.index(name)


def three(value: Three, name: str) -> Array:
    """Return components xx, yy, xy as an array (3,).

    Raises
    ------
    InputError
        There are not three of them, or one is not finite.
    """
    try:
        found = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        found = np.zeros(0)
    if found.shape != (3,) or not np.isfinite(found).all():
        msg = f"{name} = {value!r} is not three numbers"
        raise InputError(msg, hint="give the components xx, yy, xy")
    return found
