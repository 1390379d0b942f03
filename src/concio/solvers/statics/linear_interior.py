r"""Interior point for the linear programmes of statics: normal equations on the graph of the structure.

The programmes of :mod:`concio.solvers.statics.programme` have few rows (the rigid motions, three to a block in the
plane), each coupled only to its neighbours', and many columns. Mehrotra's predictor and corrector on

.. math::

    \min c^T x, \quad A x = b, \quad 0 \le x \le \bar u, \qquad
    A^T y + z - w = c, \quad x_j z_j = (\bar u - x)_j w_j = \tau \to 0,

leaves in each step one matrix :math:`A \Theta A^T`, :math:`\Theta^{-1} = Z/X + W/(\bar U - X)`, whose graph is that
of the blocks: it is ordered once by nested dissection and factorised in milliseconds. Free columns (the load
multiplier) are bordered. General codes spend their time elsewhere: simplex pivots, crossover, bases.

The answer is not a vertex but a point inside the optimal face, all of whose dual slacks are positive: the motion read
from y is admissible to rounding, whatever is left of the gap, and
:func:`concio.solvers.algebra.normal_equations.rebalance` takes
the last digits of the forces' imbalance away. What the pair of them proves is for the caller to recompute.

Reference: Mehrotra, On the implementation of a primal-dual interior point method, SIAM J. Optim. 2 (1992).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from concio.problem.contact_problem import Array
from concio.problem.limits_of_work import PROGRAMME_ITERATIONS
from concio.problem.products import product
from concio.problem.tolerances import PROGRAMME_ENOUGH, PROGRAMME_TARGET, STILL_CLOSE
from concio.solvers.algebra.normal_equations import NormalEquations

START = 10.0
"""Size of variables and slacks at the start, the largest entry of b and of c being one."""

PATIENCE = 25
"""Iterations without progress after which the best point met is returned."""

SHORT_OF_ONE = 0.995
"""Share of the step to the boundary that is taken."""

LARGEST, CLEARLY_ABOVE = 1e6, 1e-2
"""Largest sum of the variables, in largest loads, and by how much a bound passes a ceiling where a search ends."""

OBJECTIVE = 0.1
"""Objectives smaller than this, the programme scaled, are measured absolutely."""


@dataclass(frozen=True, eq=False)
class LinearAnswer:
    """Answer of :func:`solve_interior`.

    Parameters
    ----------
    x : (n,) array
    y : (M,) array
        Multipliers of the equations, c - A'y being the reduced costs.
    primal, dual, gap : float
        Largest residual of the equations and of the reduced costs, and the duality gap, all of the scaled programme.
    iterations : int
    """

    x: Array
    y: Array
    primal: float
    dual: float
    gap: float
    iterations: int

    @property
    def close(self) -> bool:
        """True when the point is worth being rechecked as an answer."""
        return max(self.primal, self.dual, self.gap) <= STILL_CLOSE


@dataclass
class _Point:
    """A point or a direction: variables, slacks of upper bounds, their multipliers, those of the equations, free ones.

    ``s`` and ``w`` have an entry for each variable with an upper bound.
    """

    x: Array
    s: Array
    z: Array
    w: Array
    y: Array
    free: Array

    def moved(self, d: _Point, primal: float, dual: float) -> _Point:
        return _Point(
            self.x + primal * d.x,
            self.s + primal * d.s,
            self.z + dual * d.z,
            self.w + dual * d.w,
            self.y + dual * d.y,
            self.free + primal * d.free,
        )


class _Programme:
    """The scaled programme: largest entry of b and c one, lower bounds zero, free columns of largest entry one."""

    def __init__(self, cost: Array, A: sp.csc_array, b: Array, bounds: Array) -> None:
        lower, upper = bounds[:, 0], bounds[:, 1]
        self.is_free = ~np.isfinite(lower) & ~np.isfinite(upper)
        self.held = ~self.is_free
        self.lower = lower[self.held]
        b = b - A[:, self.held] @ self.lower
        self.normal = NormalEquations(sp.csc_array(A[:, self.held]))
        order = self.normal.order
        F = A[:, self.is_free].toarray()[order]
        self.width = np.maximum(np.abs(F).max(axis=0, initial=0.0), 1e-300)
        self.F = F / self.width
        self.load = float(np.abs(b).max(initial=0.0)) or 1.0
        self.b = b[order] / self.load
        self.upper = (upper[self.held] - self.lower) / self.load
        self.capped = np.flatnonzero(np.isfinite(self.upper))
        self.room = self.upper[self.capped]
        c, c_free = cost[self.held], cost[self.is_free] / self.width
        self.price = max(float(np.abs(c).max(initial=0.0)), float(np.abs(c_free).max(initial=0.0))) or 1.0
        self.c, self.c_free = c / self.price, c_free / self.price
        self.count = self.c.size + self.capped.size

    def start(self) -> _Point:
        x = np.full(self.c.size, START)
        x[self.capped] = np.minimum(START, 0.5 * self.room)
        z, w = np.full(self.c.size, START), np.full(self.room.size, START)
        return _Point(x, self.room - x[self.capped], z, w, np.zeros(self.b.size), np.zeros(self.c_free.size))

    def residuals(self, p: _Point) -> tuple[Array, Array, Array, Array]:
        """Residuals of the equations, of the reduced costs, of those of free columns, and of the upper bounds."""
        r_p = self.b - product(self.normal.A, p.x) - self.F @ p.free
        r_d = self.c - product(self.normal.At, p.y) - p.z
        r_d[self.capped] += p.w
        return r_p, r_d, self.c_free - self.F.T @ p.y, self.room - p.x[self.capped] - p.s

    def gap(self, p: _Point) -> float:
        """Sum of the complementarity products."""
        return float(p.x @ p.z + p.s @ p.w)

    def objective(self, value: float, cost: Array) -> float:
        """Return the objective of the scaled programme where that of the programme as it was given is ``value``."""
        return (value - float(cost[self.held] @ self.lower)) / (self.load * self.price)

    def least(self, y: Array) -> float:
        """Return what the objective is not below, by weak duality, where variables sum to less than ``LARGEST``."""
        below = np.minimum(self.c - product(self.normal.At, y), 0.0)
        of_bounds = float(below[self.capped] @ self.room)
        below[self.capped] = 0.0
        wrong = max(float(-below.min(initial=0.0)), float(np.abs(self.c_free - self.F.T @ y).max(initial=0.0)))
        return float(self.b @ y) + of_bounds - LARGEST * wrong

    def steps(self, p: _Point, d: _Point) -> tuple[float, float]:
        """Longest steps <= 1 of the primal and of the dual part."""
        return min(_longest(p.x, d.x), _longest(p.s, d.s)), min(_longest(p.z, d.z), _longest(p.w, d.w))

    def restore(self, p: _Point) -> tuple[Array, Array]:
        """Return x and y of the programme as it was given."""
        x = np.empty(self.held.size)
        x[self.held] = np.clip(p.x, 0.0, self.upper) * self.load + self.lower
        x[self.is_free] = p.free * self.load / self.width
        y = np.empty(self.b.size)
        y[self.normal.order] = p.y * self.price
        return x, y


def _longest(v: Array, d: Array) -> float:
    """Return the longest step <= 1 at which no entry of v + step d, v positive, is negative."""
    fastest = float(np.fmax.reduce(-d / v, initial=0.0))
    return 1.0 / fastest if fastest > 1.0 else 1.0


@dataclass(frozen=True, eq=False)
class _Newton:
    """Newton's equations at a point, factorised: Theta, M^-1 F and F'M^-1 F."""

    q: _Programme
    p: _Point
    rest: tuple[Array, Array, Array, Array]
    theta: Array
    solved: Array
    schur: Array

    @classmethod
    def at(cls, q: _Programme, p: _Point, rest: tuple[Array, Array, Array, Array]) -> _Newton:
        """Factorise; RuntimeError where the matrix is singular."""
        stiff = p.z / p.x
        stiff[q.capped] += p.w / p.s
        theta = 1.0 / stiff
        q.normal.factorise(theta)
        solved = np.column_stack([q.normal.solve(f) for f in q.F.T]) if q.F.shape[1] else np.zeros_like(q.F)
        return cls(q, p, rest, theta, solved, q.F.T @ solved)

    def direction(self, x_z: Array, s_w: Array, *, refined: bool) -> _Point:
        """Direction with x dz + z dx = x_z, s dw + w ds = s_w; what a predictor decides needs no refinement."""
        q, p, theta = self.q, self.p, self.theta
        r_p, r_d, r_f, r_u = self.rest
        h = r_d - x_z / p.x
        h[q.capped] += (s_w - p.w * r_u) / p.s
        solve = q.normal.solve if refined else q.normal.solve_once
        dy = solve(r_p + product(q.normal.A, theta * h))
        free = np.zeros(0)
        if r_f.size:
            free = np.linalg.solve(self.schur, q.F.T @ dy - r_f)
            dy -= self.solved @ free
        dx = theta * (product(q.normal.At, dy) - h)
        ds = r_u - dx[q.capped]
        return _Point(dx, ds, (x_z - p.z * dx) / p.x, (s_w - p.w * ds) / p.s, dy, free)


def solve_interior(
    cost: Array, equations: tuple[sp.csc_array, Array], bounds: Array, ceiling: float = np.inf
) -> LinearAnswer | None:
    """Minimise cost'x subject to A x = b and bounds.

    Parameters
    ----------
    cost : (n,) array
    equations : (A, b)
        (M, n) CSC array and (M,) array; rows in groups of three coupled alike for the best ordering.
    bounds : (n, 2) array
        Columns with two infinite bounds are free; all others need a finite lower bound.
    ceiling : float
        Answers above it are not asked for: the search ends as soon as multipliers show that there is none below.

    Returns
    -------
    LinearAnswer or None
        The best point met; None where the numbers broke down at once, or where no answer is at or below ``ceiling``.
    """
    q = _Programme(cost, sp.csc_array(equations[0]), equations[1], bounds)
    p, top = q.start(), q.objective(ceiling, cost)
    top += CLEARLY_ABOVE * (1.0 + abs(top))
    best, kept, since, narrow, iteration = (np.inf, np.inf, np.inf), None, 0, np.inf, 0
    with np.errstate(all="ignore"):
        for iteration in range(PROGRAMME_ITERATIONS + 1):
            rest = q.residuals(p)
            gap = q.gap(p)
            objective = float(q.c @ p.x + q.c_free @ p.free)
            primal = float(np.abs(rest[0]).max(initial=0.0))
            dual = max(float(np.abs(r).max(initial=0.0)) for r in rest[1:])
            relative = gap / max(abs(objective), OBJECTIVE)
            if not np.isfinite(primal + dual + relative):
                break
            since = 0 if gap < 0.5 * narrow or max(primal, dual, relative) < 0.9 * max(best) else since + 1
            narrow = gap if since == 0 else narrow
            balanced = max(primal, dual) <= PROGRAMME_ENOUGH
            if max(primal, dual, relative) < max(best) or (balanced and relative < best[2]):
                best, kept = (primal, dual, relative), p
            if np.isfinite(top) and q.least(p.y) > top:
                return None
            if max(dual, relative) < PROGRAMME_TARGET and primal < PROGRAMME_ENOUGH:
                break
            if since > PATIENCE or iteration == PROGRAMME_ITERATIONS or not gap > 0:
                break
            try:
                newton = _Newton.at(q, p, rest)
            except RuntimeError:
                break
            products = p.x * p.z, p.s * p.w
            d = newton.direction(-products[0], -products[1], refined=False)
            predicted = q.gap(p.moved(d, *q.steps(p, d)))
            tau = gap / q.count * max((predicted / gap) ** 3, 1e-6)
            d = newton.direction(tau - products[0] - d.x * d.z, tau - products[1] - d.s * d.w, refined=True)
            primal_step, dual_step = (a if a == 1.0 else SHORT_OF_ONE * a for a in q.steps(p, d))
            p = p.moved(d, primal_step, dual_step)
    if kept is None:
        return None
    return LinearAnswer(*q.restore(kept), *best, iteration)
