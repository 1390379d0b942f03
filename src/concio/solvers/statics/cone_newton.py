r"""The last digits of a cone programme: Newton's method on its optimality conditions.

With P the projection onto the strengths of the pairs (the return map with full dilatancy), forces t, motion v and
multiplier lambda are optimal where

.. math:: C^T t + e + \lambda g = 0, \qquad t - P(t - \rho\,C v) = 0, \qquad g^T v = 1,

piecewise smooth equations like those of a load step, here with the load's multiplier as one more unknown. Where the
optimum is no strictly complementary one (a load through a corner, a pair at the end of its strength) the interior point
ends at 1e-9; from there this converges quadratically to rounding, where it converges.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from concio.problem.contact_problem import Array
from concio.solvers.algebra.second_order_cone import times
from concio.solvers.algebra.sparse_factor import SingularMatrixError
from concio.solvers.statics.cone_interior import ConeAnswer, ConeInterior

WEIGHTS = (1.0, 10.0, 0.1)
"""Values of rho tried, in units of the largest force over the largest rate."""

ROUNDS = 8
"""Newton steps for each."""

DELTA, LOOSE = 1e-8, 1e-10
"""Compliance of the pairs and stiffness of what nothing holds in the factorised matrix; refined away."""

REFINEMENTS = 12
"""Largest number of times a step is refined."""

EXACT = 1e-13
"""Residual that counts as rounding."""


def sharpen(it: ConeInterior, e: Array, g: Array, start: ConeAnswer) -> ConeAnswer | None:
    """Return the optimum to rounding next to ``start``, or None where Newton's method does not get there."""
    for weight in WEIGHTS:
        found, left = _newton(it, e, g, start, weight)
        if left <= EXACT * max(1.0, float(np.abs(found.t).max(initial=0.0))):
            return found
    return None


def _newton(it: ConeInterior, e: Array, g: Array, start: ConeAnswer, weight: float) -> tuple[ConeAnswer, float]:
    """Return the best point of at most ``ROUNDS`` steps, and the largest residual there."""
    cone = it.pairs.cone
    t, v, multiplier = start.t, start.v, start.multiplier
    best, least = start, np.inf
    for _ in range(ROUNDS):
        rate = it.rate(v)
        rate[~it.rough, 1:] = 0.0
        rho = weight * float(np.abs(t).max(initial=0.0)) / (float(np.abs(rate).max(initial=0.0)) or 1.0)
        trial = t - rho * rate
        r_u = -(it.Ct @ t.ravel() + e + multiplier * g)
        r_t = cone.project(trial) - t
        r_t[~it.rough, 1:] = 0.0
        r_g = 1.0 - float(g @ v)
        primal, law = float(np.abs(r_u).max(initial=0.0)), float(np.abs(r_t).max(initial=0.0))
        left = max(primal, law, abs(r_g))
        if left < least:
            best, least = replace(start, t=t, v=v, multiplier=multiplier, primal=primal, dual=abs(r_g), gap=law), left
        if not np.isfinite(left) or left <= 0.1 * EXACT:
            break
        J = cone.derivative(trial)
        J[~it.rough, 1:, :] = 0.0
        step = _step(it, J, rho, g, (r_u, r_t, r_g))
        if step is None:
            break
        t, v, multiplier = t + step[0], v + step[1], multiplier + step[2]
    return best, least


def _step(
    it: ConeInterior, J: Array, rho: float, g: Array, rest: tuple[Array, Array, float]
) -> tuple[Array, Array, float] | None:
    """Solve C'dt + g d lambda = r_u, rho J C dv + (I - J) dt = r_t, g'dv = r_g, refined in this form."""
    r_u, r_t, r_g = rest
    eye = np.eye(it.pairs.dim)
    try:
        inverse = np.linalg.inv(eye - (1.0 - DELTA) * J)
        D = rho * np.matmul(inverse, J)
        it.factor.factorise(D, LOOSE * rho)
        border = it.factor.solve(g)
    except (SingularMatrixError, np.linalg.LinAlgError):
        return None
    schur = float(g @ border)
    dt, dv, dl = np.zeros_like(r_t), np.zeros_like(r_u), 0.0
    kept, least = (dt, dv, dl), np.inf
    e_u, e_t, e_g = r_u, r_t, r_g
    for _ in range(REFINEMENTS):
        pushed = times(inverse, e_t)
        x = it.factor.solve(it.Ct @ pushed.ravel() - e_u)
        extra = (e_g - float(g @ x)) / schur
        x += extra * border
        dt, dv, dl = dt + pushed - times(D, it.rate(x)), dv + x, dl + extra
        e_u = r_u - it.Ct @ dt.ravel() - g * dl
        e_t = r_t - rho * times(J, it.rate(dv)) - dt + times(J, dt)
        e_g = r_g - float(g @ dv)
        worst = max(float(np.abs(e_u).max(initial=0.0)), float(np.abs(e_t).max(initial=0.0)), abs(e_g))
        if not worst < 0.7 * least:
            break
        kept, least = (dt, dv, dl), worst
        if worst < 1e-16:
            break
    return kept
