r"""Uzawa's method with a proximal term: gradient steps on the contact forces, one factorisation.

Uzawa's classical method solves ``K u = f + C' t`` and then corrects ``t <- P(t - sigma y(u))``. It needs a regular K.
For floating bodies the displacements are held back by a proximal term, and the gaps extrapolated, which makes it the
primal-dual algorithm of Chambolle and Pock in a metric of the structure,

.. math::

    (K + M)\,u^{+} &= f + C^T t + M u, \qquad M = \theta K + \tau I,\\
    t^{+} &= P\bigl(t - \sigma\,(x + C(2u^{+} - u) + a\,t)\bigr),

``P`` the return map of the joint (Coulomb: normal force first, then friction on its disc). For associated friction it
converges when ``sigma |C M^{-1} C'| <= 1``: the step length is set from a power iteration, nothing is tuned. For
Coulomb friction there is no such proof. Rigid motions travel only through ``tau`` (default 0.1 of the typical
stiffness): convergence is linear and slow on tall walls. The method is here for comparison; where it does not
reach the accuracy of an answer it gives up and says what it reached.

References
----------
K. Arrow, L. Hurwicz, H. Uzawa, *Studies in Linear and Non-Linear Programming*, Stanford, 1958. A. Chambolle, T. Pock,
A first-order primal-dual algorithm for convex problems, *J. Math. Imaging Vision* 40 (2011) 120-145.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from concio.errors import MethodError
from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.solution import ProgressCallback, Solution
from concio.solvers.algebra.scaled import Scaled, scale
from concio.solvers.methods.iterative.iteration import GOAL, Record, Stopped, answer

POWER = 30
"""Steps of the power iteration."""


def solve(
    problem: ContactProblem,
    *,
    progress: ProgressCallback | None = None,
    inertia: float = 0.1,
    drag: float = 0.3,
    limit: int = 5000,
) -> Solution:
    """Solve by the proximal method of Uzawa.

    Parameters
    ----------
    problem : ContactProblem
    progress : callable, optional
    inertia : float
        Proximal weight tau in multiples of the typical stiffness, positive.
    drag : float
        Share theta of K in the proximal metric, not negative; 0 where K is regular is Uzawa's own method with
        extrapolation.
    limit : int
        Iterations.

    Raises
    ------
    MethodError
        An option is not usable.
    """
    if not inertia > 0 or drag < 0:
        msg = f"inertia {inertia} must be positive and drag {drag} not negative"
        raise MethodError(msg, hint="try inertia=0.1, drag=0.3")
    s = scale(problem)
    record = Record("uzawa", s, progress)
    record.info["unknowns"] = s.f.size + s.x.size
    none = np.zeros((s.pairs, s.dim, s.dim))
    if drag:  # M = theta (K + tau / theta)
        factor = record.factorise(none, inertia / drag)
        largest = _largest(s, factor.solve, record) / drag
    else:
        largest = _largest(s, np.array, record) / inertia
    sigma = 0.95 / max(largest, 1e-300)
    lu = record.factorise(none, inertia / (1.0 + drag))  # K + M = (1 + theta) (K + tau / (1 + theta))
    step = 1.0 / (1.0 / sigma + s.compliance.max(axis=1, keepdims=True))
    u, t = s.glued, s.start
    try:
        for _ in range(limit):
            # written as an increment: the proximal terms cancel and no digits are lost
            ahead = u - lu.solve(s.imbalance(u, t)) / (1.0 + drag)
            record.solves()
            y = s.opening(2.0 * ahead - u) + s.compliance * t
            u, t = ahead, s.cone.project(t - step * y, s.dilatancy)
            residual = record.note(u, t)
            if residual <= GOAL or not np.isfinite(residual) or record.stalled(1000, 0.9):
                break
    except Stopped as stop:
        return answer(problem, record, cancelled=stop.cancelled)
    record.info.update(step=float(sigma), inertia=inertia, drag=drag)
    return answer(problem, record)


def _largest(s: Scaled, solve: Callable[[Array], Array], record: Record) -> float:
    """Largest eigenvalue of C A^-1 C', ``solve`` being A^-1, by power iteration, enlarged by what that may miss."""
    v = np.cos(np.arange(s.x.size) * 1.7).reshape(s.x.shape)
    value = 0.0
    for _ in range(POWER):
        v = s.along(solve(s.pull(v)))
        record.solves()
        value = float(np.linalg.norm(v))
        if value == 0.0:
            break
        v /= value
    return 1.1 * value
