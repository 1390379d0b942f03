r"""The problem with some complementarities dropped: a linear programme, and proofs that it is empty.

In units of the problem's own, with t_n = p + q and t_t = mu (p - q), so that p, q >= 0 is the friction cone and
s+ = 2 mu p, s- = 2 mu q, plain Coulomb friction reads

.. math::
    K u - C^T t = f, \qquad y - C u - a t = x, \qquad y_t = y^+ - y^-, \qquad p, q, y_n, y^+, y^- \ge 0,

with, of each pair, p = 0 or y+ = 0; q = 0 or y- = 0; p = q = 0 or y_n = 0 (smooth pairs: t_n = p alone). A
*relaxation* fixes some of these columns at zero and drops the alternatives not yet chosen. Multiplying equilibrium by
u shows that every state obeys the convex inequality

.. math:: u^T K u - f^T u + x^T t + t^T a t = t^T y \le 0 ,

the last because t_t y_t <= 0; its tangents are added where the linear programme violates it.

Proof that a relaxation is empty (Farkas): multipliers z, w of the two sets of equations and lambda >= 0 of the
tangents such that the coefficients of the combination vanish for u and are not positive for every column that may be
positive, while its right-hand side is positive. The columns fixed at zero with a positive coefficient are the
*reasons*: as long as they stay fixed no state exists. The linear programme is solved with u eliminated; the multipliers
it returns are lifted to the original equations, and the combination is formed again from K, C, f, x. It is believed
only if what rounding left of the coefficients that must vanish could not make up for the right-hand side unless some
displacement or force exceeded :data:`REACH` of the problem's own units.

The dual simplex method starts from the last basis of which the columns now fixed are a part, which is dual feasible;
costs are drawn once, so that it does not stall, and are not perturbed by the solver.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import highspy
import numpy as np
import scipy.sparse as sp

from concio.problem.contact_problem import Array, ContactProblem
from concio.solvers.exhaustive.states import Empty, Point
from concio.solvers.forms.reduction import Reduction, reduce

REACH = 1e7
"""States whose displacements and forces, scaled, stay below this are excluded beyond rounding."""

SIGNIFICANT = 1e-10
"""Coefficients of fixed columns below this share of the largest are left out of the reasons."""


@dataclass(eq=False)
class Relaxation:
    """The linear programme of a plane problem with plain friction, its cuts, and its solver.

    Parameters
    ----------
    problem : ContactProblem

    Attributes
    ----------
    reduction : Reduction
    m, k : int
        Number of pairs and of rough pairs; the columns are p (m), q (k), y_n (m), y+ (k), y- (k), then alpha (r).
    solves, cuts : int
        Linear programmes solved and tangents added.
    """

    problem: ContactProblem
    reduction: Reduction = field(init=False)
    solves: int = 0
    cuts: int = 0
    doubtful: int = 0

    def __post_init__(self) -> None:
        red = self.reduction = reduce(self.problem)
        self.m, self.k = red.pairs, int(red.rough.size)
        m, k, r = self.m, self.k, red.G.shape[1]
        c = m + k
        self.n = 2 * m + 3 * k
        system = red.system
        order = np.concatenate([2 * np.arange(m), 2 * red.rough + 1])
        self.K, self.C = sp.csr_array(system.s.K), sp.csr_array(system.C[order])
        self.x, self.a, self.load = system.x.ravel()[order], system.a.ravel()[order], system.load
        self.R = sp.csc_array(self.problem.R)
        rows, each = np.arange(k), np.arange(m)
        B = np.zeros((c, c))
        B[each, each] = 1.0
        B[red.rough, m + rows] = 1.0
        B[m + rows, red.rough] = red.mu
        B[m + rows, m + rows] = -red.mu
        self.B = B
        Y = np.zeros((c, m + 2 * k))
        Y[each, each] = 1.0
        Y[m + rows, m + rows] = 1.0
        Y[m + rows, m + k + rows] = -1.0
        self.Y = Y
        reach = np.abs(red.G).max(axis=0, initial=0.0)
        self.unit = np.where(reach > 0, 1.0 / np.where(reach > 0, reach, 1.0), 1.0)
        G = red.G * self.unit
        A = np.block([[-red.F @ B, Y, -G], [G.T @ B, np.zeros((r, m + 2 * k)), np.zeros((r, r))]])
        b = np.concatenate([red.y0, -red.e0 * self.unit])
        A[np.abs(A) < 1e-14 * np.abs(A).max(initial=1.0)] = 0.0
        self.tangents: list[tuple[Array, Array, float]] = []
        solver: Any = highspy.Highs  # its stubs leave out the constructor and getDualRay
        self.highs = highs = solver()
        for name, value in (
            ("output_flag", False),
            ("presolve", "off"),
            ("solver", "simplex"),
            ("simplex_strategy", 1),
            ("threads", 1),
            ("simplex_iteration_limit", 3000),
            ("dual_simplex_cost_perturbation_multiplier", 0.0),
            ("primal_feasibility_tolerance", 1e-9),
            ("dual_feasibility_tolerance", 1e-9),
        ):
            highs.setOptionValue(name, value)
        lp = highspy.HighsLp()
        lp.num_col_, lp.num_row_ = self.n + r, c + r
        lp.col_cost_ = np.concatenate([np.random.default_rng(0).uniform(0.5, 1.5, self.n), np.zeros(r)])
        lp.col_lower_ = np.concatenate([np.zeros(self.n), np.full(r, -np.inf)])
        lp.col_upper_ = np.full(self.n + r, np.inf)
        lp.row_lower_ = lp.row_upper_ = b
        sparse = sp.csc_array(A)
        lp.a_matrix_.format_ = highspy.MatrixFormat.kColwise
        lp.a_matrix_.start_, lp.a_matrix_.index_, lp.a_matrix_.value_ = sparse.indptr, sparse.indices, sparse.data
        highs.passModel(lp)
        self.index = np.arange(self.n, dtype=np.int32)
        self.zeros = np.zeros(self.n)
        self.fixed = np.zeros(self.n, dtype=bool)
        self.bases: list[tuple[Array, highspy.HighsBasis]] = []

    def solve(self, fixed: Array) -> Point | Empty | None:
        """Solve with columns ``fixed`` (n,) at zero; None where the solver or its proof is not to be trusted."""
        changed = np.flatnonzero(fixed != self.fixed).astype(np.int32)
        if changed.size:
            upper = np.where(fixed[changed], 0.0, np.inf)
            self.highs.changeColsBounds(changed.size, changed, self.zeros[changed], upper)
            self.fixed = fixed.copy()
        loosened = False
        while self.bases and (self.bases[-1][0] & ~fixed).any():
            self.bases.pop()
            loosened = True
        if loosened and self.bases:
            self.highs.setBasis(self.bases[-1][1])
        found = self._attempt(fixed)
        if found is None:
            self.highs.clearSolver()
            self.highs.setOptionValue("dual_simplex_cost_perturbation_multiplier", 1.0)
            found = self._attempt(fixed)
            self.highs.setOptionValue("dual_simplex_cost_perturbation_multiplier", 0.0)
            self.doubtful += found is None
        if isinstance(found, Point):
            self.bases.append((self.fixed, self.highs.getBasis()))
        return found

    def _attempt(self, fixed: Array) -> Point | Empty | None:
        self.solves += 1
        self.highs.run()
        status = self.highs.getModelStatus()
        if status == highspy.HighsModelStatus.kOptimal:
            values = np.array(self.highs.getSolution().col_value)
            c = self.m + self.k
            return Point(values[: self.n], self.B @ values[:c], values[self.n :] * self.unit)
        if status != highspy.HighsModelStatus.kInfeasible:
            return None
        _, exists, ray = self.highs.getDualRay()
        if not exists:
            return None
        ray = np.asarray(ray)
        return self.proof(ray, fixed) or self.proof(-ray, fixed)

    def proof(self, ray: Array, fixed: Array) -> Empty | None:
        """Form the combination of the original equations that ``ray`` suggests; None where it proves nothing."""
        c, r = self.m + self.k, self.R.shape[1]
        red = self.reduction
        w, v, share = ray[:c], -ray[c : c + r] * self.unit, np.maximum(-ray[c + r :], 0.0)
        z = red.flexible @ w + self.R @ v
        d_u, d_t = -(self.C.T @ w), -self.a * w
        right = w @ self.x
        size = np.abs(w) @ np.abs(self.x)
        for weight, (u_h, t_h, energy) in zip(share, self.tangents, strict=True):
            if weight:
                z = z + weight * (2.0 * (u_h - self.R @ (self.R.T @ u_h)) - red.u0)
                d_u = d_u - weight * (2.0 * (self.K @ u_h) - self.load)
                d_t = d_t - weight * (self.x + 2.0 * self.a * t_h)
                right -= weight * energy
                size += weight * abs(energy)
        d_u = d_u + self.K @ z
        d_t = d_t - self.C @ z
        right += z @ self.load
        size += np.abs(z) @ np.abs(self.load)
        d = np.concatenate([self.B.T @ d_t, self.Y.T @ w])
        top = np.abs(d).max(initial=0.0)
        reasons = fixed & (d > SIGNIFICANT * top)
        left = float(np.maximum(d[~reasons], 0.0).sum() + np.abs(d_u).sum())
        if not right > 1e-9 * size or right < REACH * left:
            return None
        return Empty(np.flatnonzero(reasons), right / left if left else np.inf)

    def displacement(self, point: Point) -> Array:
        """Return u (N,), scaled, of a point."""
        red = self.reduction
        u: Array = red.u0 + red.flexible @ point.t + self.R @ point.alpha
        return u

    def excess(self, point: Point) -> float:
        """Return t'y of a point, which no state has positive."""
        return float(point.t @ (self.Y @ point.columns[self.m + self.k :]))

    def cut(self, point: Point) -> None:
        """Add the tangent at a point to the energy inequality."""
        red, c = self.reduction, self.m + self.k
        u, t = self.displacement(point), point.t
        stress = self.K @ u
        energy = float(u @ stress + t @ (self.a * t))
        row_t = red.flexible.T @ (2.0 * stress - self.load) + self.x + 2.0 * self.a * t
        row = np.concatenate([row_t @ self.B, np.zeros(self.n - c), -red.e0 * self.unit])
        right = energy - float((2.0 * stress - self.load) @ red.u0)
        used = np.flatnonzero(row).astype(np.int32)
        self.bases.clear()
        self.highs.addRow(-np.inf, right, used.size, used, row[used])
        self.tangents.append((u, t, energy))
        self.cuts += 1
