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

import numpy as np

from concio.problem.contact_problem import Array
from concio.problem.tolerances import EXACT
from concio.solvers.algebra.scaled import Scaled
from concio.solvers.algebra.second_order_cone import times
from concio.solvers.algebra.sparse_factor import SingularMatrixError
from concio.solvers.states.redundant_forces import least_forces
from concio.solvers.states.state_reading import Finished, natural_residual, read_states, sizes

DELTA = 1e-3
"""Compliance added to pairs of mean area in the factorised matrix, scaled units."""

LOOSE = 1e-9
"""Stiffness of the springs that keep unknowns which nothing holds where they are, scaled units."""

SETTLED = 1e-13
"""Natural-map residual at which Newton's method stops."""

STALE = 6
"""Rounds without a smaller residual after which Newton's method gives up where nothing else is asked for."""

FURTHER = 10
"""Rounds beyond those asked for in which an exact answer is brought to the last digits, which the least forces need."""

UNDECIDED = 1e-10
"""Violation of its law from which on a pair counts as undecided."""

REFINEMENTS = 40
"""Largest number of times a direction is refined."""


def _trial(s: Scaled, u: Array, t: Array, rho: float) -> Array:
    """Return the trial forces t - rho y (m, d)."""
    w: Array = t - s.weighted(u, t, rho)
    w[~s.rough, 1:] = 0.0
    return w


def _derivative(s: Scaled, w: Array) -> Array:
    """Return the derivative (m, d, d) of the return map at trial forces."""
    J = s.cone.derivative(w, s.dilatancy)
    J[~s.rough, 1:, :] = 0.0
    return J


def finish(
    s: Scaled,
    u: Array,
    t: Array,
    *,
    rho: float = 1.0,
    rounds: int = 20,
    patience: int = STALE,
    least: bool = True,
    delta: float = DELTA,
) -> Finished:
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
    patience : int
        How many of them in a row may bring no smaller residual.
    least : bool
        Whether forces that are not unique are the least of all; otherwise those near to the point.
    delta : float
        Compliance added to pairs of mean area in the factorised matrix, scaled units.
    """
    error, laws = natural_residual(s, u, t)
    best, stale, solves = (u, t, error, laws), 0, 0
    for k in range(rounds + FURTHER):
        if k >= rounds and not best[2] <= EXACT:
            break
        force, length = sizes(u, t)
        moved = _newton(s, u, t, rho * force / length, delta)
        if moved is None:
            break
        u, t = moved
        solves += 1
        error, laws = natural_residual(s, u, t)
        stale = 0 if error < best[2] else stale + 1
        if error < best[2]:
            best = u, t, error, laws
        if error < SETTLED or stale >= patience or not np.isfinite(error):
            break
    u, t, error, laws = best
    found = Finished(u, t, read_states(s, u, t), error, solves, np.flatnonzero(laws > UNDECIDED))
    return least_forces(s, found) if least and error <= EXACT else found


def stuck(s: Scaled, delta: float) -> tuple[Array, Array] | None:
    """Return the point (u, t) at which every pair sticks, whatever its strength; forces left open are the least.

    Parameters
    ----------
    s : Scaled
        In forces that are not shifted, so that those of least norm are the least.
    delta : float
        Compliance added to pairs of mean area in the factorised matrix, scaled units.
    """
    u, t = np.zeros_like(s.f), np.zeros_like(s.x)
    w, J = _trial(s, u, t, 1.0), np.zeros((s.pairs, s.dim, s.dim))
    J[:] = np.eye(s.dim)
    J[~s.rough, 1:, :] = 0.0
    return _step(s, (u, t), (w, J), 1.0, delta)


def _newton(s: Scaled, u: Array, t: Array, rho: float, delta: float) -> tuple[Array, Array] | None:
    """Return the point after one Newton step; None where the matrix cannot be factorised."""
    w = _trial(s, u, t, rho)
    mapped, J = s.cone.project(w, s.dilatancy), _derivative(s, w)
    moved = _step(s, (u, t), (mapped, J), rho, delta)
    if moved is not None:
        given = ~J.any(axis=(1, 2))
        moved[1][given] = mapped[given]  # open: exactly nothing, or the tensile strength
    return moved


def _step(
    s: Scaled, at: tuple[Array, Array], law: tuple[Array, Array], rho: float, delta: float
) -> tuple[Array, Array] | None:
    """Solve the linear equations of a point, its mapped forces (m, d) and their derivative (m, d, d)."""
    (u, t), (mapped, J) = at, law
    eye = np.eye(s.dim)
    soft = s.compliance + (delta / s.share)[:, None]
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
        if not worst < least:
            break
        least, kept = worst, (du, dt)
        if worst < 1e-15:
            break
    return u + kept[0], t + kept[1]
