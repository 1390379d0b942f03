r"""Semismooth Newton on the mixed augmented Lagrangian (Alart and Curnier), with a line search.

Displacements and contact forces are unknowns together:

.. math:: K u - f - C^T t = 0, \qquad (t - P(t - \rho\,y))/\rho = 0,

``P`` the return map with the joint's dilatancy (0: Coulomb). A generalised Newton step linearises ``P`` at the state
each pair is in (open, stick, slip, crushed). The contact rows are eliminated pair by pair after a shift of 1e-7 of
their diagonal (exactly singular otherwise where a pair sticks, and on corners with more pairs than motions): one
sparse matrix of the structure of ``K + C'C`` for each step, the residual exact, so the shift costs digits of speed and
none of accuracy.

Globalisation: Armijo line search on the norm of the residual, non-monotone over the last five steps; where it has to
take short steps the shift (a proximal term on the forces) and a proximal term on the displacements are raised, as
Levenberg and Marquardt do, and lowered again as soon as full steps work; no step moves a body further than ten times
what the glued structure moves. The method may still stall at a point where
the norm has a local minimum, and says so.

References
----------
P. Alart, A. Curnier, A mixed formulation for frictional contact problems prone to Newton like solution methods,
*Comput. Methods Appl. Mech. Engrg.* 92 (1991) 353-375.
"""

from __future__ import annotations

import numpy as np

from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.solution import ProgressCallback, Solution
from concio.solvers.algebra.scaled import Scaled, scale
from concio.solvers.methods.iterative.augmented import proximal
from concio.solvers.methods.iterative.iteration import GOAL, Record, Stopped, answer, require_positive, residual_of

SHIFT = 1e-7
"""Least damping: relative shift of the contact rows."""

SHORT, SLOW = 0.2, 0.9
"""A shorter step, or a residual that falls by less, raises the damping tenfold; other steps lower it."""

HOLD = 0.01
"""Proximal weight on displacements for a damping of 1."""

REACH = 10.0
"""Longest displacement in one step, in multiples of the largest of the glued structure (bodies nothing holds fly)."""


def solve(
    problem: ContactProblem,
    *,
    progress: ProgressCallback | None = None,
    augmentation: float = 1.0,
    line_search: bool = True,
    limit: int = 200,
) -> Solution:
    """Solve by semismooth Newton steps on displacements and forces.

    Parameters
    ----------
    problem : ContactProblem
    progress : callable, optional
    augmentation : float
        rho in multiples of the typical stiffness, positive: scales the two residuals against each other and decides
        how early states change.
    line_search : bool
        Whether steps are shortened until the residual falls; off: plain Newton steps.
    limit : int
        Newton steps.

    Raises
    ------
    MethodError
        ``augmentation`` is not positive.
    """
    require_positive("augmentation", augmentation, "try 1")
    s = scale(problem)
    record = Record("alart-curnier", s, progress)
    record.info["unknowns"] = s.f.size + s.x.size
    u, t = s.glued, s.start
    try:
        record.note(u, t, "start")
        newton(s, record, u, t, augmentation=augmentation, limit=limit, line_search=line_search)
    except Stopped as stop:
        return answer(problem, record, cancelled=stop.cancelled)
    record.info.update(augmentation=augmentation, line_search=line_search)
    return answer(problem, record)


def newton(
    s: Scaled,
    record: Record,
    u: Array,
    t: Array,
    *,
    augmentation: float = 1.0,
    goal: float = GOAL,
    limit: int = 200,
    line_search: bool = True,
) -> tuple[Array, Array, bool]:
    """Semismooth Newton steps on a scaled problem, from (u, t); returns u, t and whether ``goal`` was reached.

    ``s`` need not be the problem of the record: the penalty and the multiplier methods solve problems with springs in
    the joints, and have them recorded against the joints they stand for.
    """
    recent: list[float] = []
    residual = residual_of(s, u, t)
    best, damping = [residual], SHIFT
    for _ in range(limit):
        if residual <= goal:
            return u, t, True
        if len(best) > 60 and min(best[-40:]) > 0.9 * min(best[:-40]):
            return u, t, False
        du, dt = _newton_step(s, record, u, t, augmentation, residual, damping)
        if not np.isfinite(du).all():
            record.trace.append("a Newton matrix was singular.")
            return u, t, False
        length = _step_length(s, u, t, du, dt, augmentation, recent) if line_search else 1.0
        u, t = u + length * du, t + length * dt
        slow = length < SHORT or (len(recent) > 1 and recent[-1] > SLOW * recent[-2])
        damping = min(max(10.0 * damping, 1e-3), 1.0) if slow and line_search else max(0.1 * damping, SHIFT)
        residual = residual_of(s, u, t)
        best.append(residual)
        record.note(u, t, f"Newton step {length:.3g}")
    return u, t, residual <= goal


def _law_residual(s: Scaled, u: Array, t: Array, rho: float) -> tuple[Array, Array]:
    """Return the trial force and (t - P)/rho."""
    w = t - rho * s.position(u, t)
    return w, (t - s.cone.project(w, s.dilatancy)) / rho


def _newton_step(
    s: Scaled, record: Record, u: Array, t: Array, rho: float, residual: float, damping: float
) -> tuple[Array, Array]:
    """Return the Newton direction (du, dt)."""
    w, law = _law_residual(s, u, t, rho)
    jacobian = s.cone.derivative(w, s.dilatancy)
    d = s.dim
    diagonal = (1.0 - rho * s.compliance)[:, None, :]
    local = np.linalg.inv((1.0 + damping) * np.eye(d) - jacobian * diagonal)
    blocks = rho * local @ jacobian
    kick = -rho * (local @ law[:, :, None])[:, :, 0]
    lu = record.factorise(blocks, max(proximal(residual), HOLD * (damping - SHIFT)))
    du = lu.solve(-s.imbalance(u, t) + s.pull(kick))
    record.solves()
    dt = kick - (blocks @ s.along(du)[:, :, None])[:, :, 0]
    return du, dt


def _step_length(s: Scaled, u: Array, t: Array, du: Array, dt: Array, rho: float, recent: list[float]) -> float:
    """Return the step length of a non-monotone Armijo search on the residual's norm."""

    def norm(length: float) -> float:
        a, b = u + length * du, t + length * dt
        return float(np.hypot(np.linalg.norm(s.imbalance(a, b)), np.linalg.norm(_law_residual(s, a, b, rho)[1])))

    recent.append(norm(0.0))
    bound = max(recent[-5:])
    reach = REACH * max(1.0, float(np.abs(s.glued).max(initial=0.0)))
    first = min(1.0, reach / max(float(np.abs(du).max(initial=0.0)), 1e-300))
    trials = [first * 0.5**k for k in range(9)]
    best, best_length = np.inf, trials[-1]
    for length in trials:
        value = norm(length)
        if value <= (1.0 - 1e-4 * length) * bound:
            return length
        if value < best:
            best, best_length = value, length
    return best_length
