r"""Alternating direction method of multipliers: one factorisation, then solves and projections.

The gaps ``z`` of the joints are unknowns of their own, tied to the bodies by ``z = x + C u`` through multipliers (the
contact forces) and an augmentation ``rho``. In turn

.. math::

    (K + C^T \rho\, C)\,u &= f + C^T (t + \rho\,(z - x)),\\
    w &= t - \rho\,y, \qquad y = \omega\,(x + C u) + (1 - \omega)\,z,\\
    t &= P_S\bigl(r\,(w/\rho - s)\bigr), \qquad z = (t - w)/\rho,

``P_S`` the Euclidean projection onto the strength domain, ``1/r = 1/rho + a`` with the compliance ``a`` of the joint
(``rho`` chosen so that ``r`` is the same in all directions of a pair), ``omega`` an over-relaxation. The shift
``s = (mu - tan psi)|z_t|`` of De Saxcé turns associated friction into Coulomb's and is updated at every iteration.
For associated joints (no shift) the problem is convex and convergence proved; with the shift moving it is a heuristic
that works where slip is moderate.

``K + C' rho C`` is regular where pairs hold the bodies, so floating bodies are kept as they are; one factorisation
serves until ``rho`` is balanced again (at most ten times). Convergence is linear: expect hundreds to thousands of cheap
iterations, and an honest "gave up" with the accuracy reached where that is not enough (near collapse, jammed).

References
----------
V. Acary, M. Brémond, O. Huber, On solving contact problems with Coulomb friction: formulations and numerical
comparisons, in *Advanced Topics in Nonsmooth Dynamics*, Springer, 2018. S. Boyd et al., Distributed optimization and
statistical learning via the alternating direction method of multipliers, *Found. Trends Mach. Learn.* 3 (2011) 1-122
(balancing of rho, over-relaxation).
"""

from __future__ import annotations

import numpy as np

from concio.errors import MethodError
from concio.problem.contact_problem import ContactProblem
from concio.problem.solution import ProgressCallback, Solution
from concio.solvers.algebra.scaled import Scaled, scale
from concio.solvers.methods.iterative.de_saxce import isotropic
from concio.solvers.methods.iterative.iteration import GOAL, Record, Stopped, answer, require_positive

PROXIMAL = 1e-9
"""Regularisation that keeps the factorisation finite where a body hangs on nothing."""

BALANCE_EVERY = 50
REFACTORISATIONS = 10


def solve(
    problem: ContactProblem,
    *,
    progress: ProgressCallback | None = None,
    augmentation: float = 1.0,
    relaxation: float = 1.0,
    limit: int = 5000,
) -> Solution:
    """Solve by alternating directions.

    Parameters
    ----------
    problem : ContactProblem
    progress : callable, optional
    augmentation : float
        First rho in multiples of the typical stiffness, positive.
    relaxation : float
        Over-relaxation, 0 < omega < 2. Above 1 it speeds convex problems up, and makes the moving shift oscillate.
    limit : int
        Iterations.

    Raises
    ------
    MethodError
        An option is not usable.
    """
    require_positive("augmentation", augmentation, "try 1")
    if not 0 < relaxation < 2:
        msg = f"relaxation {relaxation} is not between 0 and 2"
        raise MethodError(msg, hint="try 1")
    s = scale(problem)
    record = Record("admm", s, progress)
    record.info["unknowns"] = s.f.size + 2 * s.x.size
    try:
        rho = _iterate(s, record, augmentation, relaxation, limit)
    except Stopped as stop:
        return answer(problem, record, cancelled=stop.cancelled)
    record.info.update(augmentation=rho, relaxation=relaxation)
    return answer(problem, record)


def _iterate(s: Scaled, record: Record, level: float, omega: float, limit: int) -> float:
    """Run the iteration; returns the last augmentation."""
    lag = np.maximum(s.cone.friction - s.dilatancy, 0.0)
    u, t = s.glued, s.start
    z = s.opening(u)
    rho, lu = isotropic(s.compliance, level), None
    refactorised = 0
    primal = dual = 0.0
    for k in range(1, limit + 1):
        if lu is None:
            lu = record.factorise(rho[:, :, None] * np.eye(s.dim), PROXIMAL)
        rhs = s.f + s.pull(t + rho * (z - s.x))
        u = u + lu.solve(rhs - s.K @ u - s.pull(rho * s.along(u)))  # the increment loses no digits
        record.solves()
        y = s.opening(u)
        held = lag * np.linalg.norm(z[:, 1:] + s.compliance[:, 1:] * t[:, 1:], axis=1)
        w = t - rho * (omega * y + (1.0 - omega) * z)
        scaled = w / rho
        scaled[:, 0] -= held
        t_new = s.cone.project(scaled / (1.0 / rho + s.compliance))
        z_new = (t_new - w) / rho
        primal += float(np.linalg.norm(y - z_new))
        dual += float(np.linalg.norm(z_new - z))
        t, z = t_new, z_new
        residual = record.note(u, t)
        if residual <= GOAL or not np.isfinite(residual) or record.stalled(1000, 0.9):
            break
        if k % BALANCE_EVERY == 0:
            ratio = primal / max(dual, 1e-300)
            if refactorised < REFACTORISATIONS and not 0.2 < ratio < 5.0:
                level *= float(np.clip(np.sqrt(ratio), 0.1, 10.0))
                rho, lu, refactorised = isotropic(s.compliance, level), None, refactorised + 1
                z = y.copy()
            primal = dual = 0.0
    return level
