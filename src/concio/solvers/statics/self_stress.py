r"""The least forces that could hold a structure which, loaded as it is, is not held.

Forces within the cones that balance the loads need not belong to any state that the loads bring about: two faces could
hold a block by friction, had anything pressed them against it. Such forces differ from those that the loads do cause by
*self-stress*, forces that balance themselves. Of all admissible forces those of least compression,

.. math:: \min \sum_k t_{n,k} \quad\text{subject to}\quad R^T (f + C^T t) = 0,\ t_k \in S_k,

tell how much of it would be needed: a linear programme in the plane. In space it is the limit programme of one more
motion, which every pair closes at the rate one and a load B presses shut: the largest load that pulls it open is B less
the least compression.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
import scipy.sparse as sp

from concio.problem.contact_problem import Array, ContactProblem, Laws
from concio.problem.parts import parts_of
from concio.problem.tolerances import ADMISSIBLE
from concio.representation import short_repr
from concio.solvers.statics.associated_limit import static_residual
from concio.solvers.statics.cone_statics import ConeStatics
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
    if problem.dim == 3:
        return _by_cones(problem)
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


def least_compression_of(problem: ContactProblem, pairs: Sequence[Array]) -> SelfStress | None:
    """Return the same for some connected parts of a problem, zero elsewhere; None where a part has none.

    Parameters
    ----------
    problem : ContactProblem
    pairs : sequence of integer arrays
        The pairs of each part.
    """
    t_n, t_t = np.zeros(problem.pairs), np.zeros((problem.pairs, problem.dim - 1))
    residual, load = 0.0, 0.0
    for part in parts_of(problem):
        if not any(np.array_equal(part.pairs, one) for one in pairs):
            continue
        found = least_compression(part.problem)
        if found is None:
            return None
        t_n[part.pairs], t_t[part.pairs] = found.normal_force, found.friction_force
        residual, load = max(residual, found.residual), load + found.load
    return SelfStress(t_n, t_t, residual, load)


def _by_cones(problem: ContactProblem) -> SelfStress | None:
    """Return the admissible forces of least compression of a problem in space."""
    force = total_load(problem)
    some = ConeStatics(problem).forces()
    if some.residual > ADMISSIBLE:
        return None
    budget = 2.0 * float(np.maximum(some.t[:, 0], 0.0).sum()) + force
    found = ConeStatics(*_closing(problem, budget)).largest(np.r_[np.zeros(problem.unknowns), 1.0]).t[:-1]
    candidates = [(t, static_residual(problem, problem.f, t[:, 0], t[:, 1:])) for t in (found, some.t)]
    t, residual = next(((t, r) for t, r in candidates if r <= ADMISSIBLE), candidates[1])
    return SelfStress(t[:, 0], t[:, 1:], residual, force)


def _closing(problem: ContactProblem, budget: float) -> tuple[ContactProblem, Array]:
    """Return the problem with a motion that every pair closes and a smooth pair of its own, and its load (N + 1,)."""
    m, n, s = problem.pairs, problem.unknowns, problem.dim - 1
    f = np.r_[problem.f, -budget]
    free = Laws.coulomb(0.0, 1)
    laws = Laws(*(np.concatenate([getattr(problem.laws, x.name), getattr(free, x.name)]) for x in fields(Laws)))
    R = sp.block_diag([problem.R, sp.eye_array(1)], format="csc")
    closing = sp.csr_array(np.ones((m + 1, 1)))
    closed = replace(
        problem, K=sp.csr_array((n + 1, n + 1)), f=f,
        C_n=sp.csr_array(sp.hstack([sp.vstack([problem.C_n, sp.csr_array((1, n))]), closing])),
        C_t=sp.csr_array(sp.block_diag([problem.C_t, sp.csr_array((s, 1))])), gap=np.zeros(m + 1), laws=laws,
        R=sp.csc_array(R), bodies=np.r_[problem.bodies, n + 1], slip_origin=np.zeros((m + 1, s)),
        area=np.zeros(0), inertia=sp.csr_array((0, 0)), load=0.0,
    )  # fmt: skip
    return closed, f
