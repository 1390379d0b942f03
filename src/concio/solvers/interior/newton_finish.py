r"""From a point close to a solution to the solution itself: Newton's method on the return map, any dimension.

With the trial force w = t - rho y and the return map P of :mod:`concio.problem.cone` (dilatancy is its flow parameter),
equilibrium and joint laws are

.. math:: K u - f - C^T t = 0, \qquad t - P(t - \rho\, y(u, t)) = 0,

piecewise smooth; open, sticking, slipping and crushed pairs are its pieces, the direction of slip an unknown like any
other. With J the derivative of P, Newton's equations of a pair are

.. math:: \rho J\, C\,\delta u + (I - J(I - \rho\,a))\,\delta t = P(w) - t .

A compliance ``DELTA`` added to a gives the matrix K + C'DC, D = (I - J(I - rho (a + delta)))^{-1} rho J, of the
engine's pattern; iterative refinement against the equations takes it out again. Redundant pairs (corners) and loose
bodies do no harm: their equations are consistent. Converges quadratically from where the interior point stops.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from concio.problem.contact_problem import Array
from concio.solvers.algebra.scaled import Scaled
from concio.solvers.algebra.second_order_cone import times
from concio.solvers.algebra.sparse_factor import SingularMatrixError

DELTA = 1e-6
"""Compliance added to pairs of mean area in the factorised matrix, scaled units."""

LOOSE = 1e-9
"""Stiffness of the springs that keep unknowns which nothing holds where they are, scaled units."""

SETTLED = 1e-13
"""Natural-map residual at which Newton's method stops."""

EXACT = 1e-11
"""Largest natural-map residual of an exact finish."""

STALE = 6
"""Rounds without a smaller residual after which Newton's method gives up."""

REFINEMENTS = 8
"""Largest number of times a direction is refined."""


@dataclass(frozen=True, eq=False)
class Finished:
    """Outcome of the exact finish, scaled units.

    Parameters
    ----------
    u, t : (N,), (m, d) arrays
        Shifted forces.
    error : float
        Natural-map residual: largest of imbalance and of the violation of the joint laws, relative.
    solves : int
        Linear systems factorised.
    """

    u: Array
    t: Array
    error: float
    solves: int


def sizes(u: Array, t: Array) -> tuple[float, float]:
    """Return the largest force and the largest displacement, at least one."""
    return max(1.0, float(np.abs(t).max(initial=0.0))), max(1.0, float(np.abs(u).max(initial=0.0)))


def natural_residual(s: Scaled, u: Array, t: Array) -> tuple[float, Array]:
    """Return the largest relative violation of equilibrium and joint laws, and that of the laws for each pair (m,).

    Forces count relative to the largest force, lengths relative to the largest displacement; the natural map
    t - P(t - y) is taken in these units.
    """
    force, length = sizes(u, t)
    laws: Array = np.linalg.norm(s.natural_map(u, t, force / length), axis=1) / force
    return max(s.unbalanced(u, t, force), float(laws.max(initial=0.0))), laws


def _mapped(s: Scaled, u: Array, t: Array, rho: float) -> tuple[Array, Array]:
    """Return the trial forces t - rho y and what the return map makes of them, (m, d) both."""
    w = t - rho * s.position(u, t)
    w[~s.rough, 1:] = 0.0
    return w, s.cone.project(w, s.dilatancy)


def finish(s: Scaled, u: Array, t: Array, *, rho: float = 1.0, rounds: int = 20) -> Finished:
    """Turn a point close to a solution into the solution, if Newton's method converges.

    Parameters
    ----------
    s : Scaled
    u, t : (N,), (m, d) arrays
        The point, scaled, forces shifted.
    rho : float
        Weight of lengths against forces in the natural map, scaled by the largest of both.
    rounds : int
        Largest number of Newton steps.
    """
    error, _ = natural_residual(s, u, t)
    best, stale, solves = Finished(u, t, error, 0), 0, 0
    for _ in range(rounds):
        force, length = sizes(u, t)
        found = _newton(s, u, t, rho * force / length)
        if found is None:
            break
        u, t = found
        solves += 1
        error, _ = natural_residual(s, u, t)
        stale = 0 if error < best.error else stale + 1
        if error < best.error:
            best = Finished(u, t, error, solves)
        if error < SETTLED or stale >= STALE or not np.isfinite(error):
            break
    return replace(best, solves=solves)


def _newton(s: Scaled, u: Array, t: Array, rho: float) -> tuple[Array, Array] | None:
    """Return the point after one Newton step; None where the matrix cannot be factorised."""
    w, mapped = _mapped(s, u, t, rho)
    J = s.cone.derivative(w, s.dilatancy)
    J[~s.rough, 1:, :] = 0.0
    eye = np.eye(s.dim)
    soft = s.compliance + (DELTA / s.share)[:, None]
    H = eye - J * (1.0 - rho * s.compliance)[:, None, :]
    B = rho * J
    try:
        inverse = np.linalg.inv(eye - J * (1.0 - rho * soft)[:, None, :])
        D = np.matmul(inverse, B)
        s.factor.factorise(D, LOOSE)
    except (SingularMatrixError, np.linalg.LinAlgError):
        return None
    r_u, r_t = -s.imbalance(u, t), mapped - t
    du, dt = np.zeros_like(u), np.zeros_like(t)
    e1, e2, least = r_u, r_t, np.inf
    kept = (du, dt)
    for _ in range(REFINEMENTS):
        pushed = times(inverse, e2)
        x = s.factor.solve(e1 + s.pull(pushed))
        du, dt = du + x, dt + pushed - times(D, s.along(x))
        e1 = r_u - s.elastic(du) + s.pull(dt)
        e2 = r_t - times(B, s.along(du)) - times(H, dt)
        worst = max(float(np.abs(e1).max(initial=0.0)), float(np.abs(e2).max(initial=0.0)))
        if not worst < 0.5 * least:
            break
        least, kept = worst, (du, dt)
        if worst < 1e-15:
            break
    u, t = u + kept[0], t + kept[1]
    t[~J.any(axis=(1, 2))] = 0.0  # open: exactly nothing
    return u, t
