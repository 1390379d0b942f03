r"""The least forces that could hold a structure which, loaded as it is, is not held.

Forces within the cones that balance the loads need not belong to any state that the loads bring about: two faces could
hold a block by friction, had anything pressed them against it. Such forces differ from those that the loads do cause by
*self-stress*, forces that balance themselves. Of all admissible forces those of least compression,

.. math:: \min \sum_k t_{n,k} \quad\text{subject to}\quad R^T (f + C^T t) = 0,\ t_k \in S_k,

tell how much of it would be needed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.tolerances import ADMISSIBLE
from concio.representation import short_repr
from concio.solvers.statics.limit import static_residual
from concio.solvers.statics.mechanism import total_load
from concio.solvers.statics.programme import StaticProgramme, optimise


@short_repr
@dataclass(frozen=True, eq=False)
class SelfStress:
    """Admissible forces of least compression, for loads that do not bring them about.

    Parameters
    ----------
    normal_force, friction_force : arrays (m,), (m, d-1)
        [kN].
    residual : float
        Largest imbalance and excess over the cones, relative to the total load.
    load : float
        Total load [kN].
    """

    normal_force: Array
    friction_force: Array
    residual: float
    load: float

    @property
    def compression(self) -> float:
        """Sum of the compressions of all joints [kN]."""
        return float(np.maximum(self.normal_force, 0.0).sum())


def least_compression(problem: ContactProblem) -> SelfStress | None:
    """Return the admissible forces of least compression, or None where none were found.

    Parameters
    ----------
    problem : ContactProblem
    """
    if not problem.pairs or not problem.rigid_motions:
        return None
    force = total_load(problem)
    programme = StaticProgramme(problem)
    A, e0 = programme.equilibrium
    matrix, _ = programme.map
    cost = np.asarray(matrix[: problem.pairs].sum(axis=0)).ravel()
    caps = programme.caps
    limits = None if caps is None else (caps[0], caps[1] / force)
    result = optimise(cost, (A, -(programme.project(problem.f) + e0) / force), programme.bounds / force, limits)
    if result.status != 0:
        return None
    x = programme.balance(result.x * force, problem.f)
    t_n, t_t = programme.forces(x)
    residual = static_residual(problem, problem.f, t_n, t_t)
    return SelfStress(t_n, t_t, residual, force) if residual <= ADMISSIBLE else None
