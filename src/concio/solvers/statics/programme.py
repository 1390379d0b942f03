r"""Statically admissible forces, written so that little more than sign conditions is left.

The forces a pair may carry, with friction mu, cohesion c, tensile strength T (mu T <= c) and cap N, are

.. math:: S_k = \{-T \le t_n \le N,\quad |t_t| \le c + \mu t_n\}.

In the plane every point of S_k is  t_n = p + q - T,  t_t = mu (p - q) + z  with p, q >= 0, |z| <= c - mu T and
p + q <= N + T: two rays of the cone and a segment. Equilibrium of the rigid motions, R'(f + C't) = 0, is then a
linear programme in standard form with r rows, which the simplex method likes. Round cones of space are not polygons:
:mod:`concio.solvers.statics.cone_statics`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Literal

import numpy as np
import scipy.sparse as sp

from concio.problem.contact_problem import Array, ContactProblem
from concio.solvers.algebra.normal_equations import rebalance
from concio.solvers.statics.highs import Algorithm, minimise
from concio.solvers.statics.linear_interior import solve_interior

LARGE = 1_000
"""Number of columns from which the interior point is tried before the simplex method; below, the latter is as fast."""

HUGE = 5_000
"""Number of columns from which HiGHS, where it is asked, begins with its interior point."""

TOLERANCES = (1e-10, 1e-9)
"""Feasibility asked of HiGHS; at the first it may end with an error where at the second it sees an unbounded one."""

Method = Literal["interior", "highs"]


@dataclass(frozen=True, eq=False)
class StaticProgramme:
    """Linear programme over the statically admissible forces of a problem.

    Its variables x >= 0 are the rays of the cones, then the segments z; see :attr:`map`.

    Parameters
    ----------
    problem : ContactProblem
        Plane; :attr:`scale` and :meth:`project` serve any dimension.
    """

    problem: ContactProblem

    @cached_property
    def scale(self) -> Array:
        """Largest relative velocity each rigid motion causes at a pair, (r,); 1 where it causes none."""
        moved = abs(sp.csc_array(self.problem.C @ self.problem.R))
        reach = np.zeros(self.problem.rigid_motions)
        columns = np.repeat(np.arange(moved.shape[1]), np.diff(moved.indptr))
        np.maximum.at(reach, columns, moved.data)
        return np.where(reach > 0, reach, 1.0)

    def project(self, load: Array) -> Array:
        """Return R' load with each row divided by :attr:`scale`, (r,)."""
        projected: Array = (self.problem.R.T @ load) / self.scale
        return projected

    @cached_property
    def rays(self) -> tuple[Array, Array]:
        """Return (pair, sign) of each ray, (k,): two of pairs with friction (t_t = +- mu t_n), one of others."""
        m, frictional = self.problem.pairs, np.flatnonzero(self.problem.laws.friction > 0)
        return np.concatenate([np.arange(m), frictional]), np.concatenate([np.ones(m), -np.ones(frictional.size)])

    @cached_property
    def map(self) -> tuple[sp.csc_array, Array]:
        """Return (B, t0) with (t_n, t_t) = B x + t0, shapes (2 m, n) and (2 m,)."""
        m, law = self.problem.pairs, self.problem.laws
        pair, sign = self.rays
        sticky = np.flatnonzero(self.problem.cone.spare > 0)
        ray = np.arange(pair.size)
        rows = [pair, m + pair, m + sticky]
        columns = [ray, ray, pair.size + np.arange(sticky.size)]
        data = [np.ones(pair.size), law.friction[pair] * sign, np.ones(sticky.size)]
        shape = (2 * m, pair.size + sticky.size)
        matrix = sp.csc_array((np.concatenate(data), (np.concatenate(rows), np.concatenate(columns))), shape)
        return matrix, np.concatenate([-law.tension, np.zeros(m)])

    @cached_property
    def bounds(self) -> Array:
        """Lower and upper bounds of x, (n, 2)."""
        law, spare = self.problem.laws, self.problem.cone.spare
        pair, _ = self.rays
        top = np.full(pair.size, np.inf)
        smooth = ~(law.friction[pair] > 0)
        top[smooth] = law.cap[pair[smooth]] + law.tension[pair[smooth]]
        width = spare[spare > 0]
        return np.concatenate([np.column_stack([np.zeros_like(top), top]), np.column_stack([-width, width])])

    @cached_property
    def caps(self) -> tuple[sp.csc_array, Array] | None:
        """Return (A, b) of the rows sum of rays <= N + T of pairs with friction and a cap; None without any."""
        law = self.problem.laws
        capped = np.flatnonzero(np.isfinite(law.cap) & (law.friction > 0))
        if not capped.size:
            return None
        matrix, _ = self.map
        return sp.csc_array(sp.csr_array(matrix)[capped]), law.cap[capped] + law.tension[capped]

    @cached_property
    def equilibrium(self) -> tuple[sp.csc_array, Array]:
        """Return (A, e0) of the rows A x + e0 + R'f / scale = 0; shapes (r, n), (r,)."""
        matrix, offset = self.map
        problem = self.problem
        reduced = sp.csr_array(problem.R.T @ problem.C.T)
        reduced = sp.csr_array(sp.diags_array(1.0 / self.scale) @ reduced)
        return sp.csc_array(reduced @ matrix), reduced @ offset

    def forces(self, x: Array) -> tuple[Array, Array]:
        """Return t_n (m,) and t_t (m, 1) of the variables x."""
        matrix, offset = self.map
        t = matrix @ x[: matrix.shape[1]] + offset
        m = self.problem.pairs
        return t[:m], t[m:].reshape(m, -1)

    def balance(self, x: Array, load: Array) -> Array:
        """Remove what rounding left unbalanced, by the least change of x (n,) within bounds and caps."""
        A, e0 = self.equilibrium
        x, target, bounds = x[: A.shape[1]], self.project(load) + e0, self.bounds
        if self.caps is None:
            return rebalance(A, x, target, bounds)
        (A, b), bounds = with_slacks((A, -target), bounds, self.caps)
        G, h = self.caps
        return rebalance(A, np.concatenate([x, np.maximum(h - G @ x, 0.0)]), -b, bounds)[: x.size]


def with_slacks(
    equations: tuple[sp.csc_array, Array], bounds: Array, inequalities: tuple[sp.csc_array, Array]
) -> tuple[tuple[sp.csc_array, Array], Array]:
    """Return equations and bounds in which G x <= h has become G x + s = h, s >= 0."""
    G, h = inequalities
    A = sp.block_array([[equations[0], None], [G, sp.eye_array(h.size)]], format="csc")
    slack = np.tile([0.0, np.inf], (h.size, 1))
    return (sp.csc_array(A), np.concatenate([equations[1], h])), np.vstack([bounds, slack])


@dataclass(frozen=True, eq=False)
class Optimum:
    """Answer of :func:`optimise`.

    Parameters
    ----------
    status : int
        0 optimal, 2 infeasible, 3 unbounded, anything else: no answer (the numbers of SciPy's ``linprog``).
    x : (n,) array
        Empty where there is no answer.
    marginals : (M,) array
        Multipliers y of the equations: the reduced costs are c - A'y.
    message : str
    """

    status: int
    x: Array
    marginals: Array
    message: str


def optimise(
    cost: Array,
    equations: tuple[sp.csc_array, Array],
    bounds: Array,
    inequalities: tuple[sp.csc_array, Array] | None = None,
    *,
    method: Method | None = None,
    ceiling: float = np.inf,
) -> Optimum:
    """Minimise cost'x subject to A x = b, bounds and G x <= h.

    Parameters
    ----------
    cost : (n,) array
    equations, inequalities : (matrix, right-hand side)
    bounds : (n, 2) array
    method : {"interior", "highs"}, optional
        :func:`concio.solvers.statics.linear_interior.solve_interior` or HiGHS, alone; by default the first from
        ``LARGE`` columns on, and the other where it finds no answer.
    ceiling : float
        Answers above it are not asked for; the interior point ends as soon as it shows that there is none below.
    """
    reducible = not (~np.isfinite(bounds[:, 0]) & np.isfinite(bounds[:, 1])).any()
    if method == "interior" or (method is None and cost.size >= LARGE and reducible):
        found = _interior(cost, equations, bounds, inequalities, ceiling)
        if found is not None:
            return found
        if method is not None:
            return Optimum(4, np.zeros(0), np.zeros(0), "the interior point did not converge")
    return _highs(cost, equations, bounds, inequalities)


def _interior(
    cost: Array,
    equations: tuple[sp.csc_array, Array],
    bounds: Array,
    inequalities: tuple[sp.csc_array, Array] | None,
    ceiling: float,
) -> Optimum | None:
    """Interior point, its equations made exact to rounding; None where it does not converge."""
    n, rows = cost.size, equations[1].size
    if inequalities is not None:
        equations, bounds = with_slacks(equations, bounds, inequalities)
        cost = np.concatenate([cost, np.zeros(inequalities[1].size)])
    A, b = sp.csc_array(equations[0]), equations[1]
    x, moves = bounds[:, 0].copy(), bounds[:, 0] < bounds[:, 1]
    if not moves.all():
        ceiling -= float(cost[~moves] @ x[~moves])
        A, b = sp.csc_array(A[:, moves]), b - A[:, ~moves] @ x[~moves]
        cost, bounds = cost[moves], bounds[moves]
    found = solve_interior(cost, (A, b), bounds, ceiling)
    if found is None or not found.close:
        return None
    x[moves] = rebalance(A, found.x, -b, bounds)
    return Optimum(0, x[:n], found.y[:rows], f"interior point: {found.iterations} iterations")


def _highs(
    cost: Array,
    equations: tuple[sp.csc_array, Array],
    bounds: Array,
    inequalities: tuple[sp.csc_array, Array] | None,
) -> Optimum:
    """HiGHS, right-hand sides scaled to one: the dual simplex method, or interior point for large programmes.

    Where the first does not finish, the other is tried, and both again with the second of ``TOLERANCES``.
    """
    A, b = equations
    unit = float(np.abs(b).max(initial=0.0)) or 1.0
    rows, others = np.column_stack([b, b]) / unit, 0
    if inequalities is not None:
        G, h = inequalities
        A, others = sp.csc_array(sp.vstack([G, A])), h.size
        rows = np.vstack([np.column_stack([np.full(others, -np.inf), h / unit]), rows])
    algorithms: tuple[Algorithm, Algorithm] = ("ipm", "simplex") if cost.size > HUGE else ("simplex", "ipm")
    for tolerance, algorithm in product(TOLERANCES, algorithms):
        status, x, y, message = minimise(cost, sp.csc_array(A), rows, bounds / unit, algorithm, tolerance)
        if status not in (1, 4):  # iteration limit, numerical trouble
            break
    return Optimum(status, x * unit, y[others:], message)
