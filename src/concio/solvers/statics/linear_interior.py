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
        self.capped = np.isfinite(self.upper)
        c, c_free = cost[self.held], cost[self.is_free] / self.width
        self.price = max(float(np.abs(c).max(initial=0.0)), float(np.abs(c_free).max(initial=0.0))) or 1.0
        self.c, self.c_free = c / self.price, c_free / self.price
        self.count = self.c.size + int(self.capped.sum())

    def start(self) -> _Point:
        x = np.full(self.c.size, START)
        x[self.capped] = np.minimum(START, 0.5 * self.upper[self.capped])
        s = np.where(self.capped, np.where(self.capped, self.upper, 0.0) - x, 1.0)
        z = np.full(self.c.size, START)
        w = np.where(self.capped, START, 0.0)
        return _Point(x, s, z, w, np.zeros(self.b.size), np.zeros(self.c_free.size))

    def residuals(self, p: _Point) -> tuple[Array, Array, Array, Array]:
        """Residuals of the equations, of the reduced costs, of those of free columns, and of the upper bounds."""
        r_p = self.b - self.normal.A @ p.x - self.F @ p.free
        r_d = self.c - self.normal.At @ p.y - p.z + p.w
        r_f = self.c_free - self.F.T @ p.y
        r_u = np.where(self.capped, np.where(self.capped, self.upper, 0.0) - p.x - p.s, 0.0)
        return r_p, r_d, r_f, r_u

    def gap(self, p: _Point) -> float:
        """Sum of the complementarity products."""
        return float(p.x @ p.z + p.s[self.capped] @ p.w[self.capped])

    def objective(self, value: float, cost: Array) -> float:
        """Return the objective of the scaled programme where that of the programme as it was given is ``value``."""
        return (value - float(cost[self.held] @ self.lower)) / (self.load * self.price)

    def least(self, y: Array) -> float:
        """Return what the objective is not below, by weak duality, where variables sum to less than ``LARGEST``."""
        below, capped = np.minimum(self.c - self.normal.At @ y, 0.0), self.capped
        wrong = max(float(-below[~capped].min(initial=0.0)), float(np.abs(self.c_free - self.F.T @ y).max(initial=0.0)))
        return float(self.b @ y + below[capped] @ self.upper[capped]) - LARGEST * wrong

    def steps(self, p: _Point, d: _Point) -> tuple[float, float]:
        """Longest steps <= 1 of the primal and of the dual part."""
        c = self.capped
        return min(_longest(p.x, d.x), _longest(p.s[c], d.s[c])), min(_longest(p.z, d.z), _longest(p.w[c], d.w[c]))

    def restore(self, p: _Point) -> tuple[Array, Array]:
        """Return x and y of the programme as it was given."""
        x = np.empty(self.held.size)
        x[self.held] = np.clip(p.x, 0.0, self.upper) * self.load + self.lower
        x[self.is_free] = p.free * self.load / self.width
        y = np.empty(self.b.size)
        y[self.normal.order] = p.y * self.price
        return x, y


def _longest(v: Array, d: Array) -> float:
    down = d < 0
    return min(1.0, float(np.min(-v[down] / d[down]))) if down.any() else 1.0


def _direction(
    q: _Programme, p: _Point, rest: tuple[Array, Array, Array, Array], border: tuple[Array, Array, Array], x_z: Array,
    s_w: Array,
) -> _Point:  # fmt: skip
    """Newton direction with x dz + z dx = x_z, s dw + w ds = s_w; border: Theta, M^-1 F, F'M^-1 F."""
    r_p, r_d, r_f, r_u = rest
    theta, solved, schur = border
    h = r_d - x_z / p.x + np.where(q.capped, (s_w - p.w * r_u) / p.s, 0.0)
    dy = q.normal.solve(r_p + q.normal.A @ (theta * h))
    free = np.linalg.solve(schur, q.F.T @ dy - r_f) if r_f.size else np.zeros(0)
    dy = dy - solved @ free
    dx = theta * (q.normal.At @ dy - h)
    ds = np.where(q.capped, r_u - dx, 0.0)
    return _Point(dx, ds, (x_z - p.z * dx) / p.x, np.where(q.capped, (s_w - p.w * ds) / p.s, 0.0), dy, free)


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
            if since > PATIENCE or iteration == PROGRAMME_ITERATIONS:
                break
            theta = 1.0 / (p.z / p.x + np.where(q.capped, p.w / p.s, 0.0))
            try:
                q.normal.factorise(theta)
            except RuntimeError:
                break
            solved = np.column_stack([q.normal.solve(f) for f in q.F.T]) if q.F.shape[1] else np.zeros_like(q.F)
            border = theta, solved, q.F.T @ solved
            d = _direction(q, p, rest, border, -p.x * p.z, -p.s * p.w)
            predicted = q.gap(p.moved(d, *q.steps(p, d)))
            tau = gap / q.count * max((predicted / gap) ** 3, 1e-6)
            d = _direction(q, p, rest, border, tau - p.x * p.z - d.x * d.z, tau - p.s * p.w - d.s * d.w)
            primal_step, dual_step = (a if a == 1.0 else SHORT_OF_ONE * a for a in q.steps(p, d))
            p = p.moved(d, primal_step, dual_step)
    if kept is None:
        return None
    return LinearAnswer(*q.restore(kept), *best, iteration)
