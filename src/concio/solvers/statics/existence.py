r"""Are there forces within the cones that balance the loads? Yes with the forces, no with a mechanism, or undecided.

One linear programme answers, in space one over second-order cones (:mod:`concio.solvers.statics.cone_statics`): it
minimises what is left unbalanced. Where that is nothing, its variables are the forces; where it is not, its multipliers
are the motion to blame. Neither is believed as it comes. The forces count where, once rounding is taken out of them,
they balance the loads to :data:`concio.problem.tolerances.BALANCED`; the motion counts as
:func:`concio.solvers.statics.mechanism.proves` says. Close to the limit a programme may end with neither: then the
other method is asked, and where that has neither the answer is "undecided", not "no".

That the forces exist does not say that a *Coulomb* state does: friction is not associated.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp

from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.parts import Part, parts_of
from concio.problem.solution import Mechanism
from concio.problem.tolerances import BALANCED, NEARLY_BALANCED
from concio.representation import short_repr
from concio.solvers.statics.cone_statics import Balance, ConeStatics
from concio.solvers.statics.mechanism import mechanism_from, total_load
from concio.solvers.statics.programme import Method, StaticProgramme, optimise


@short_repr
@dataclass(frozen=True, eq=False)
class StaticState:
    """Outcome of the search for forces within the cones that balance the loads.

    Parameters
    ----------
    exists : bool
        True when the forces below balance the loads: a proof.
    normal_force : (m,) array
        t_n [kN].
    friction_force : (m, d-1) array
        t_t [kN].
    residual : float
        Largest entry of R'(f + C't) over the total load, recomputed from the problem.
    velocity : (N,) array
        Rigid motion dual to the forces.
    mechanism : Mechanism or None
        That motion, where it was verified: a proof that there are no such forces, nor any equilibrium.
    """

    exists: bool
    normal_force: Array
    friction_force: Array
    residual: float
    velocity: Array
    mechanism: Mechanism | None = None

    @property
    def decided(self) -> bool:
        """True where either is proven; where not, neither "yes" nor "no" may be said."""
        return self.exists or self.mechanism is not None


def statically_admissible(problem: ContactProblem, *, thorough: bool = True) -> StaticState:
    """Search forces within the cones of the joint laws that balance the loads on the rigid motions.

    Parameters
    ----------
    problem : ContactProblem
    thorough : bool
        Whether, in space, a programme that loses its digits goes on with pivoting, which costs many times as much.
        Without, it is undecided more often.

    Returns
    -------
    StaticState
        With forces, or with a mechanism, or (rarely, within rounding of the limit) with neither. Parts that touch only
        what is fixed are asked one by one: what one of them lacks is not a rounding error of another.
    """
    parts = [part for part in parts_of(problem) if part.unknowns.size]
    if len(parts) <= 1:
        return _of_one(problem, thorough=thorough)
    return _of_all(problem, parts, [_of_one(part.problem, thorough=thorough) for part in parts])


def _of_all(problem: ContactProblem, parts: Sequence[Part], found: Sequence[StaticState]) -> StaticState:
    """Return the state of the whole, of those of its parts; its motion is that of one part that has no forces."""
    t_n, t_t = np.zeros(problem.pairs), np.zeros((problem.pairs, problem.dim - 1))
    for part, one in zip(parts, found, strict=True):
        t_n[part.pairs], t_t[part.pairs] = one.normal_force, one.friction_force
    residual, exists = max(one.residual for one in found), all(one.exists for one in found)
    moving = max(range(len(found)), key=lambda k: (found[k].mechanism is not None, not found[k].exists))
    velocity, mechanism = np.zeros(problem.unknowns), found[moving].mechanism
    velocity[parts[moving].unknowns] = found[moving].velocity
    if mechanism is not None:
        whole = np.zeros(problem.unknowns)
        whole[parts[moving].unknowns] = mechanism.velocity
        mechanism = replace(mechanism, velocity=whole)
    return StaticState(exists, t_n, t_t, residual, velocity, mechanism)


def _of_one(problem: ContactProblem, *, thorough: bool) -> StaticState:
    """Search forces of a connected part."""
    m, r, s = problem.pairs, problem.rigid_motions, problem.dim - 1
    if r == 0:
        return StaticState(True, np.zeros(m), np.zeros((m, s)), 0.0, np.zeros(problem.unknowns))
    programme = StaticProgramme(problem)
    if m == 0:
        velocity = problem.R @ (programme.project(problem.f) / programme.scale)
        residual = float(np.abs(problem.R.T @ problem.f).max() / total_load(problem))
        exists = residual <= BALANCED
        proof = None if exists else mechanism_from(problem, velocity)
        return StaticState(exists, np.zeros(0), np.zeros((0, s)), residual, velocity, proof)
    if problem.dim == 3:
        return _by_cones(problem, ConeStatics(problem, pivoting=thorough).forces())
    methods: tuple[Method | None, ...] = (None, "interior", "highs")
    found = []
    for method in methods:  # a vertex that rounding moved has no forces left to balance with, an inner point has
        found.append(_least_imbalance(problem, programme, method))
        if found[-1].decided:
            return found[-1]
    return min(found, key=lambda state: state.residual)


def admissible_near(problem: ContactProblem, normal: Array, close: float = np.inf) -> tuple[StaticState, Array]:
    """Search forces of a problem in space from normal forces (m,) that are nearly those, without pivoting.

    Return the state, and the normal forces (m,) at the largest multiplier of what these normal forces do not balance:
    known to a gap of the share ``close`` of what that multiplier is away from one.
    """
    found = ConeStatics(problem, pivoting=False).forces(normal, close)
    return _by_cones(problem, found), found.at_bound


def _by_cones(problem: ContactProblem, found: Balance) -> StaticState:
    """Return what the forces and the motion of the cone programme prove."""
    exists = found.residual <= BALANCED
    proof = None if exists else mechanism_from(problem, found.velocity)
    return StaticState(exists, found.t[:, 0], found.t[:, 1:], found.residual, found.velocity, proof)


def _least_imbalance(problem: ContactProblem, programme: StaticProgramme, method: Method | None) -> StaticState:
    """Minimise the sum of what is left unbalanced by one method, and say what that proves."""
    m, r, s = problem.pairs, problem.rigid_motions, problem.dim - 1
    force = total_load(problem)
    load = programme.project(problem.f) / force
    A, e0 = programme.equilibrium
    n = A.shape[1]
    eye = sp.eye_array(r, format="csc")
    equations = sp.csc_array(sp.hstack([A, eye, -eye])), -load - e0 / force
    bounds = np.vstack([programme.bounds / force, np.tile([0.0, np.inf], (2 * r, 1))])
    caps = programme.caps
    if caps is not None:
        rows = sp.csc_array((caps[0].shape[0], 2 * r))
        caps = sp.csc_array(sp.hstack([caps[0], rows])), caps[1] / force
    result = optimise(np.r_[np.zeros(n), np.ones(2 * r)], equations, bounds, caps, method=method)
    if not result.x.size:
        return StaticState(False, np.zeros(m), np.zeros((m, s)), np.inf, np.zeros(problem.unknowns))
    x = result.x * force
    for attempt in range(2):
        t_n, t_t = programme.forces(x)
        left = problem.R.T @ (problem.f + problem.C_n.T @ t_n + problem.C_t.T @ t_t.ravel())
        residual = float(np.abs(left).max() / force)
        if attempt or not 1e-12 < residual < NEARLY_BALANCED:
            break
        x = programme.balance(x, problem.f)
    velocity = problem.R @ (-result.marginals / programme.scale)
    exists = residual <= BALANCED
    proof = None if exists else mechanism_from(problem, velocity)
    return StaticState(exists, t_n, t_t, residual, velocity, proof)


def find_mechanism(problem: ContactProblem) -> Mechanism | None:
    """Search a mechanism that proves there is no equilibrium.

    Parameters
    ----------
    problem : ContactProblem

    Returns
    -------
    Mechanism or None
        A verified proof, or None where the linear programme finds statically admissible forces or the motion it
        finds does not pass :func:`concio.solvers.statics.mechanism.verify_mechanism`.
    """
    return statically_admissible(problem).mechanism
