r"""Statically admissible forces, written so that little more than sign conditions is left.

The forces a pair may carry, with friction mu, cohesion c, tensile strength T (mu T <= c) and cap N, are

.. math:: S_k = \{-T \le t_n \le N,\quad |t_t| \le c + \mu t_n\}.

In the plane every point of S_k is  t_n = p + q - T,  t_t = mu (p - q) + z  with p, q >= 0, |z| <= c - mu T and
p + q <= N + T: two rays of the cone and a segment. Equilibrium of the rigid motions, R'(f + C't) = 0, is then a
linear programme in standard form with r rows, which the simplex method likes. In space the cone is replaced by a
polygonal cone of ``SIDES`` rays: inside the circle when forces are wanted, so that none outside the cone are called
admissible, and around it when a mechanism is wanted, so that its motion satisfies w_n >= mu |w_t|.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.optimize import linprog
from scipy.sparse.linalg import splu

from concio.contact.problem import Array, ContactProblem

SIDES = 16
"""Rays of the polygonal friction cone in space."""

LARGE = 20_000
"""Number of columns from which the interior-point code of HiGHS is tried before the simplex method."""


@dataclass(frozen=True, eq=False)
class StaticProgramme:
    """Linear programme over the statically admissible forces of a problem.

    Its variables x >= 0 are the rays of the cones, then the segments z; see :attr:`map`.

    Parameters
    ----------
    problem : ContactProblem
    around : bool
        In space: polygonal cones around the circular ones instead of inside.
    """

    problem: ContactProblem
    around: bool = False

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
        """Return (pair, direction) of each ray: integers (k,) and vectors (k, d-1); smooth pairs have one."""
        m, d = self.problem.pairs, self.problem.dim
        angle = np.arange(SIDES) * (2 * np.pi / SIDES)
        ring = np.array([[1.0], [-1.0]]) if d == 2 else np.column_stack([np.cos(angle), np.sin(angle)])
        if self.around and d == 3:
            ring /= np.cos(np.pi / SIDES)
        rough = np.flatnonzero(self.problem.laws.friction > 0)
        pair = np.concatenate([np.arange(m), *(rough for _ in ring[1:])])
        direction = np.concatenate([np.tile(ring[0], (m, 1)), *(np.tile(a, (rough.size, 1)) for a in ring[1:])])
        return pair, direction

    @cached_property
    def spare(self) -> Array:
        """Half width of the segment of each pair, (m,): c - mu T, in space of the square inside or around."""
        law = self.problem.laws
        width: Array = np.maximum(law.cohesion - law.friction * law.tension, 0.0)
        return width if self.around else width / np.sqrt(self.problem.dim - 1)

    @cached_property
    def map(self) -> tuple[sp.csc_array, Array]:
        """Return (B, t0) with (t_n, t_t) = B x + t0, shapes (m d, n) and (m d,)."""
        m, s = self.problem.pairs, self.problem.dim - 1
        law = self.problem.laws
        pair, direction = self.rays
        sticky = np.flatnonzero(self.spare > 0)
        segment = (m + sticky[:, None] * s + np.arange(s)).ravel()
        ray = np.arange(pair.size)
        rows = [pair, *(m + pair * s + a for a in range(s)), segment]
        columns = [ray, *(ray for _ in range(s)), pair.size + np.arange(segment.size)]
        data = [np.ones(pair.size), *(law.friction[pair] * direction[:, a] for a in range(s)), np.ones(segment.size)]
        shape = (m * (1 + s), pair.size + segment.size)
        matrix = sp.csc_array((np.concatenate(data), (np.concatenate(rows), np.concatenate(columns))), shape)
        return matrix, np.concatenate([-law.tension, np.zeros(m * s)])

    @cached_property
    def bounds(self) -> Array:
        """Lower and upper bounds of x, (n, 2)."""
        law, s = self.problem.laws, self.problem.dim - 1
        pair, _ = self.rays
        top = np.full(pair.size, np.inf)
        smooth = ~(law.friction[pair] > 0)
        top[smooth] = law.cap[pair[smooth]] + law.tension[pair[smooth]]
        width = np.repeat(self.spare[self.spare > 0], s)
        return np.concatenate([np.column_stack([np.zeros_like(top), top]), np.column_stack([-width, width])])

    @cached_property
    def caps(self) -> tuple[sp.csc_array, Array] | None:
        """Return (A, b) of the rows sum of rays <= N + T of rough pairs with a cap; None where there are none."""
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
        """Return t_n (m,) and t_t (m, d-1) of the variables x."""
        matrix, offset = self.map
        t = matrix @ x[: matrix.shape[1]] + offset
        m = self.problem.pairs
        return t[:m], t[m:].reshape(m, -1)

    def balance(self, x: Array, load: Array, rounds: int = 3) -> Array:
        """Remove what rounding left unbalanced: least change of x (n,), each measured by its room within the bounds.

        The affine-scaling projection: with D the distance to the nearer bound, A D z = -(A x + e0 + R' load / scale),
        x + D z, cut at the bounds.
        """
        A, e0 = self.equilibrium
        target = self.project(load) + e0
        x = np.clip(x[: A.shape[1]], self.bounds[:, 0], self.bounds[:, 1])
        residual = A @ x + target
        for _ in range(rounds):
            room = np.minimum(np.minimum(x - self.bounds[:, 0], self.bounds[:, 1] - x), np.abs(x).max(initial=1.0))
            scaled = sp.csc_array(A @ sp.diags_array(room / (room.max(initial=0.0) or 1.0)))
            weak = -1e-12 * sp.eye_array(A.shape[0])
            matrix = sp.block_array([[sp.eye_array(x.size), scaled.T], [scaled, weak]])
            z = splu(sp.csc_matrix(matrix)).solve(np.concatenate([np.zeros(x.size), -residual]))[: x.size]
            step = room / (room.max(initial=0.0) or 1.0) * z
            trial = np.clip(x + step, self.bounds[:, 0], self.bounds[:, 1])
            left = A @ trial + target
            if not np.abs(left).max() < np.abs(residual).max():
                break
            x, residual = trial, left
        return x


def optimise(
    cost: Array,
    equations: tuple[sp.csc_array, Array],
    bounds: Array,
    inequalities: tuple[sp.csc_array, Array] | None = None,
    *,
    method: str | None = None,
) -> Any:
    """Minimise cost'x subject to A x = b, bounds and G x <= h by HiGHS; return SciPy's ``OptimizeResult``.

    Parameters
    ----------
    cost : (n,) array
    equations, inequalities : (matrix, right-hand side)
    bounds : (n, 2) array
    method : str, optional
        "highs-ds" or "highs-ipm"; default by size, and the other one where the first does not finish.
    """
    first = method or ("highs-ipm" if cost.size > LARGE else "highs-ds")
    options: dict[str, Any] = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}
    arguments: dict[str, Any] = {"A_eq": equations[0], "b_eq": equations[1], "bounds": bounds, "options": options}
    if inequalities is not None:
        arguments |= {"A_ub": inequalities[0], "b_ub": inequalities[1]}
    highs: Any = linprog
    result = highs(cost, method=first, **arguments)
    if result.status in (1, 4):  # iteration limit, numerical trouble
        result = highs(cost, method="highs-ds" if first == "highs-ipm" else "highs-ipm", **arguments)
    return result
