r"""The problem with some complementarities dropped: a linear programme, and proofs that it is empty.

In units of the problem's own, with t_n = p + q and t_t = mu (p - q), so that p, q >= 0 is the friction cone and
s+ = 2 mu p, s- = 2 mu q, plain Coulomb friction reads

.. math::
    K u - C^T t = f, \qquad y - C u - a t = x, \qquad y_t = y^+ - y^-, \qquad p, q, y_n, y^+, y^- \ge 0,

with, of each pair, p = 0 or y+ = 0; q = 0 or y- = 0; p = q = 0 or y_n = 0 (smooth pairs: t_n = p alone). A
*relaxation* fixes some of these columns at zero and drops the alternatives not yet chosen.

Proof that a relaxation is empty (Farkas): multipliers z, w of the two sets of equations such that the coefficients of
the combination vanish for u and are not positive for every column that may be positive, while its right-hand side is
positive. The columns fixed at zero with a positive coefficient are the
*reasons*: as long as they stay fixed no state exists. The linear programme is solved with u eliminated; the multipliers
it returns are lifted to the original equations, and the combination is formed again from K, C, f, x. It is believed
only if what rounding left of the coefficients that must vanish could not make up for the right-hand side unless some
displacement or force exceeded :data:`REACH` of the problem's own units.

The dual simplex method starts from the last basis of which the columns now fixed are a part, which is dual feasible;
costs are drawn once, so that it does not stall, and are not perturbed by the solver.
"""

from __future__ import annotations

from typing import Any

import highspy
import numpy as np
import scipy.sparse as sp

from concio.problem.contact_problem import Array, ContactProblem
from concio.solvers.methods.exhaustive.state_questions import Empty, Point
from concio.solvers.methods.forms.reduction import Reduction, reduce

REACH = 1e7
"""States whose displacements and forces, scaled, stay below this are excluded beyond rounding."""

SIGNIFICANT = 1e-10
"""Coefficients of fixed columns below this share of the largest are left out of the reasons."""

OPTIONS: tuple[tuple[str, Any], ...] = (
    ("output_flag", False),
    ("presolve", "off"),
    ("solver", "simplex"),
    ("simplex_strategy", 1),
    ("threads", 1),
    ("simplex_iteration_limit", 3000),
    ("dual_simplex_cost_perturbation_multiplier", 0.0),
    ("primal_feasibility_tolerance", 1e-9),
    ("dual_feasibility_tolerance", 1e-9),
)
"""Of HiGHS: the dual simplex method from the last basis, its costs as they are."""


class Relaxation:
    """The linear programme of a plane problem with plain friction, and its solver.

    Parameters
    ----------
    problem : ContactProblem

    Attributes
    ----------
    reduction : Reduction
    m, k, n : int
        Number of pairs, of rough pairs and of columns that may be fixed: p (m), q (k), y_n (m), y+ (k), y- (k).
    K, C, x, a, load : arrays
        Of the problem, scaled; rows of normal directions first, then those of rough tangents.
    B, Y : (m + k, m + k) and (m + k, m + 2 k) arrays
        Forces t = B (p, q) and relative displacements y = Y (y_n, y+, y-).
    solves : int
        Linear programmes solved.
    """

    def __init__(self, problem: ContactProblem) -> None:
        red = self.reduction = reduce(problem)
        self.m, self.k = red.pairs, int(red.rough.size)
        self.n = 2 * self.m + 3 * self.k
        order = np.concatenate([2 * np.arange(self.m), 2 * red.rough + 1])
        system = red.system
        self.K, self.C = sp.csr_array(system.s.K), sp.csr_array(system.C[order])
        self.x, self.a, self.load = system.x.ravel()[order], system.a.ravel()[order], system.load
        self.R = sp.csc_array(problem.R)
        self.B, self.Y = _forces_of(red), _displacements_of(red)
        reach = np.abs(red.G).max(axis=0, initial=0.0)
        self.unit = np.where(reach > 0, 1.0 / np.where(reach > 0, reach, 1.0), 1.0)
        self.highs = self._solver()
        self.zeros = np.zeros(self.n)
        self.fixed = np.zeros(self.n, dtype=bool)
        self.bases: list[tuple[Array, highspy.HighsBasis]] = []
        self.solves = 0

    def _solver(self) -> Any:
        """Return HiGHS with the programme whose columns are all free to be positive; rigid motions come last."""
        red, m, k, r = self.reduction, self.m, self.k, self.R.shape[1]
        G = red.G * self.unit
        A = np.block([[-red.F @ self.B, self.Y, -G], [G.T @ self.B, np.zeros((r, m + 2 * k)), np.zeros((r, r))]])
        A[np.abs(A) < 1e-14 * np.abs(A).max(initial=1.0)] = 0.0
        sparse = sp.csc_array(A)
        lp = highspy.HighsLp()
        lp.num_row_, lp.num_col_ = A.shape
        lp.col_cost_ = np.concatenate([np.random.default_rng(0).uniform(0.5, 1.5, self.n), np.zeros(r)])
        lp.col_lower_ = np.concatenate([np.zeros(self.n), np.full(r, -np.inf)])
        lp.col_upper_ = np.full(self.n + r, np.inf)
        lp.row_lower_ = lp.row_upper_ = np.concatenate([red.y0, -red.e0 * self.unit])
        lp.a_matrix_.format_ = highspy.MatrixFormat.kColwise
        lp.a_matrix_.start_, lp.a_matrix_.index_, lp.a_matrix_.value_ = sparse.indptr, sparse.indices, sparse.data
        solver: Any = highspy.Highs  # its stubs leave out the constructor and getDualRay
        highs = solver()
        for name, value in OPTIONS:
            highs.setOptionValue(name, value)
        highs.passModel(lp)
        return highs

    def point(self, fixed: Array) -> Point | Empty | None:
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
        w, v = ray[:c], -ray[c : c + r] * self.unit
        z = red.flexible @ w + self.R @ v
        d_u, d_t = -(self.C.T @ w), -self.a * w
        right = w @ self.x
        size = np.abs(w) @ np.abs(self.x)
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


def _forces_of(red: Reduction) -> Array:
    """Return the matrix B (m + k, m + k) of t = B (p, q): t_n = p + q, t_t = mu (p - q)."""
    m, k = red.pairs, int(red.rough.size)
    rows, each = np.arange(k), np.arange(m)
    B = np.zeros((m + k, m + k))
    B[each, each] = 1.0
    B[red.rough, m + rows] = 1.0
    B[m + rows, red.rough] = red.mu
    B[m + rows, m + rows] = -red.mu
    return B


def _displacements_of(red: Reduction) -> Array:
    """Return the matrix Y (m + k, m + 2 k) of y = Y (y_n, y+, y-): y_t = y+ - y-."""
    m, k = red.pairs, int(red.rough.size)
    rows, each = np.arange(k), np.arange(m)
    Y = np.zeros((m + k, m + 2 * k))
    Y[each, each] = 1.0
    Y[m + rows, m + rows] = 1.0
    Y[m + rows, m + k + rows] = -1.0
    return Y
