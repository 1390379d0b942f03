r"""Linear equations of a path between two events, and their factors, updated from event to event.

Unknowns X = (u, t_n, t_t, tau), all scaled to order one; one row for each:

====================  ==========================================================
equilibrium           K u - C_n' t_n - C_t' t_t - tau f' = f
open / crushed        t_n = -T / t_n = N
closed                C_n u + a_n t_n + tau x_n' - tan(psi) sigma (C_t u + a_t t_t + tau x_t') = ...
stick                 C_t u - x_t + a_t t_t + tau x_t' = s
slip sigma            t_t + sigma mu t_n = -sigma c
control               tau = given, or c'u = given
====================  ==========================================================

(the dilatancy term only while the pair slips). A change of state replaces one or two rows: the answer of the new
matrix follows from the factors of the old one by the Sherman-Morrison-Woodbury formula, with one more
back-substitution for each changed row, until a refactorisation costs less.

Redundant contacts (three pairs for the two relative motions of a corner) and bodies nothing holds make the matrix
singular though the problem is not contradictory. The factors are those of a matrix with a little compliance in every
hard closed pair and a little stiffness under every body; iterative refinement with the true matrix takes the
error out, and what remains undetermined is changed as little as possible (proximal point iteration).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from concio.problem.contact_problem import Array
from concio.solvers.path.path_state import CLOSED, CRUSHED, OPEN, STICK
from concio.solvers.path.scaling import ScaledPath

REGULAR = 1e-8
"""Compliance and stiffness added to the factors, in scaled units."""

POOR = 1e-9
"""Residual after refinement at which factors without pivoting are given up for better ones."""

UPDATES = 48
"""Changed rows after which the matrix is factorised again."""

INVERSE = 4
"""Inverse iterations on a runaway rate."""

SMALL = 1e-15
"""Refinement stops at this residual, relative to the right-hand side."""

SLOW = 0.2
"""A small residual that a round of refinement does not reduce to this share is rounding."""


class PathEquations:
    """The matrix of the current states, its factors and their updates.

    Parameters
    ----------
    scaled : ScaledPath
    contact, sliding : (m,) integer arrays
        States; changed only through :meth:`set_state`.
    control : (size,) array
        Functional of the scaled unknowns that is prescribed; changed only through :meth:`set_control`.
    """

    def __init__(self, scaled: ScaledPath, contact: Array, sliding: Array, control: Array) -> None:
        problem = scaled.path.problem
        self.scaled, self.data = scaled, scaled.data
        self.n, self.m = problem.unknowns, problem.pairs
        self.size = self.n + 2 * self.m + 1
        self.C_n, self.C_t = sp.csr_array(problem.C_n), sp.csr_array(problem.C_t)
        self.K = sp.csr_array(problem.K * (scaled.length / scaled.force))
        self.control = control
        self.contact, self.sliding = contact.copy(), sliding.copy()
        self.share = problem.area_share
        self.lent = REGULAR / self.share
        self.factorisations = 0
        self.factorise()

    # -- rows -----------------------------------------------------------------------------------------------------

    def normal_row(self, k: int) -> tuple[Array, Array]:
        """Return (columns, values) of the normal row of pair k in its present state."""
        d, n, m = self.data, self.n, self.m
        if self.contact[k] != CLOSED:
            return np.array([n + k]), np.ones(1)
        rows, values = self._row(self.C_n, k)
        columns, entries = [rows, np.array([n + k, self.size - 1])], [values, np.array([d.a_n[k], d.gap_rate[k]])]
        sigma = self.sliding[k]
        if d.dilatancy[k] > 0 and sigma != STICK:
            rows, values = self._row(self.C_t, k)
            factor = -d.dilatancy[k] * sigma
            columns += [rows, np.array([n + m + k, self.size - 1])]
            entries += [factor * values, factor * np.array([d.a_t[k], d.tangent_rate[k]])]
        return np.concatenate(columns), np.concatenate(entries)

    def tangential_row(self, k: int) -> tuple[Array, Array]:
        """Return (columns, values) of the tangential row of pair k in its present state."""
        d, n, m = self.data, self.n, self.m
        if self.sliding[k] == STICK:
            rows, values = self._row(self.C_t, k)
            return (
                np.concatenate([rows, [n + m + k, self.size - 1]]),
                np.concatenate([values, [d.a_t[k], d.tangent_rate[k]]]),
            )
        return np.array([n + k, n + m + k]), np.array([self.sliding[k] * d.cone.friction[k], 1.0])

    @staticmethod
    def _row(matrix: sp.csr_array, k: int) -> tuple[Array, Array]:
        span = slice(matrix.indptr[k], matrix.indptr[k + 1])
        return matrix.indices[span], matrix.data[span]

    def _lent(self, row: int) -> float:
        """Return what is added to the diagonal of a row in its present state."""
        n, m = self.n, self.m
        if row < n:
            return REGULAR
        if row < n + m:
            return float(self.lent[row - n]) if self.contact[row - n] == CLOSED else 0.0
        return float(self.lent[row - n - m]) if row < n + 2 * m and self.sliding[row - n - m] == STICK else 0.0

    def _lent_to_all(self) -> Array:
        """Return what is added to the diagonals (size,) in the present states."""
        closed, stick = self.contact == CLOSED, self.sliding == STICK
        bodies = np.full(self.n, REGULAR)
        return np.concatenate([bodies, np.where(closed, self.lent, 0.0), np.where(stick, self.lent, 0.0), [0.0]])

    # -- factors --------------------------------------------------------------------------------------------------

    def assemble(self) -> sp.csr_array:
        """Return the true matrix of the present states."""
        m, d = self.m, self.data
        one, closed, stick = np.ones(m), self.contact == CLOSED, self.sliding == STICK
        sigma = self.sliding.astype(float)
        keep_n, keep_t = sp.diags_array(closed.astype(float)), sp.diags_array(stick.astype(float))
        tilt = np.where(closed, d.dilatancy * sigma, 0.0)
        column_n = np.where(closed, d.gap_rate, 0.0) - tilt * d.tangent_rate
        column_t = np.where(stick, d.tangent_rate, 0.0)
        blocks: list[list[Any]] = [
            [self.K, -self.C_n.T, -self.C_t.T, sp.csr_array(-d.load_rate[:, None])],
            [
                keep_n @ self.C_n - sp.diags_array(tilt) @ self.C_t,
                sp.diags_array(np.where(closed, d.a_n, one)),
                sp.diags_array(-tilt * d.a_t),
                sp.csr_array(column_n[:, None]),
            ],
            [
                keep_t @ self.C_t,
                sp.diags_array(sigma * d.cone.friction),
                sp.diags_array(np.where(stick, d.a_t, one)),
                sp.csr_array(column_t[:, None]),
            ],
        ]
        top = sp.csr_array(sp.block_array(blocks, format="csr"))
        return sp.csr_array(sp.vstack([top, sp.csr_array(self.control[None])], format="csr"))

    def factorise(self, *, careful: bool = False) -> None:
        """Factorise the matrix of the present states; ``careful`` pivots for stability at the price of fill."""
        self.base = self.assemble()
        self.base_lent = self._lent_to_all()
        self.factors = splu(  # the lent terms make it quasidefinite: pivots stay on the diagonal, fill stays small
            sp.csc_matrix(self.base + sp.diags_array(self.base_lent)),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.01 if careful else 0.0,
            options={"SymmetricMode": True},
        )
        self.changed: dict[int, tuple[Array, Array]] = {}
        self.slots: dict[int, int] = {}
        self.columns = np.zeros((self.size, UPDATES), order="F")
        self.careful = careful
        self.factorisations += 1

    def set_state(self, k: int, contact: int, sliding: int) -> None:
        """Give pair k another state."""
        if (self.contact[k], self.sliding[k]) == (contact, sliding):
            return
        self.contact[k], self.sliding[k] = contact, sliding
        for row, entries in ((self.n + k, self.normal_row(k)), (self.n + self.m + k, self.tangential_row(k))):
            new = np.zeros(self.size)
            np.add.at(new, entries[0], entries[1])
            self._replace(row, new)

    def set_states(self, contact: Array, sliding: Array, lent: float = REGULAR) -> None:
        """Give all pairs other states (m,) at once, and perhaps the factors another compliance of hard pairs."""
        self.contact, self.sliding = contact.copy(), sliding.copy()
        self.lent = lent / self.share
        self.factorise()

    def set_control(self, control: Array) -> None:
        """Prescribe another functional (size,) of the scaled unknowns."""
        self.control = control
        self._replace(self.size - 1, control)

    def _replace(self, row: int, new: Array) -> None:
        span = slice(self.base.indptr[row], self.base.indptr[row + 1])
        old = np.zeros(self.size)
        old[self.base.indices[span]] = self.base.data[span]
        delta = new - old
        used = np.flatnonzero(delta)
        self.changed.pop(row, None)
        if used.size:
            self.changed[row] = (used, delta[used])

    def multiply(self, x: Array) -> Array:
        """Return the true matrix times x, shape (size,) or (size, k)."""
        y: Array = self.base @ x
        for row, (used, delta) in self.changed.items():
            y[row] += delta @ x[used]
        return y

    def approximate(self, b: Array) -> Array:
        """Solve with the matrix of the present states with the added compliance left in; b (size,) or (size, k)."""
        fresh = [row for row in self.changed if row not in self.slots]
        if len(self.slots) + len(fresh) > UPDATES:
            self.factorise()
            fresh = []
        x: Array = self.factors.solve(b)
        if not self.changed:
            return x
        for row in fresh:
            unit = np.zeros(self.size)
            unit[row] = 1.0
            self.columns[:, len(self.slots)] = self.factors.solve(unit)
            self.slots[row] = len(self.slots)
        W = self.columns[:, : len(self.slots)]
        small = np.eye(len(self.slots))
        right = np.zeros((len(self.slots), *b.shape[1:]))
        for row, (used, delta) in self.changed.items():
            i = self.slots[row]
            shift = self._lent(row) - self.base_lent[row]
            small[i] += delta @ W[used] + shift * W[row]
            right[i] = delta @ x[used] + shift * x[row]
        try:
            return np.asarray(x - W @ np.linalg.solve(small, right))
        except np.linalg.LinAlgError:
            self.factorise()
            return np.asarray(self.factors.solve(b))

    def refined(self, b: Array, rounds: int = 8) -> tuple[Array, float]:
        """Solve with the true matrix by refinement; b (size,) or (size, k).

        What the added compliance adds to the answer is kept in ``creep`` (like b): where redundant pairs do not move at
        all, it tells which way they would, were they a little compliant.

        Returns
        -------
        x : array like b
        residual : float
            Largest residual relative to the largest entry of the right-hand side; not small where the states form a
            mechanism that the right-hand side drives.
        """
        x = self.approximate(b)
        creep = np.zeros_like(x)
        best, smallest, self.creep = x, np.inf, creep
        size = np.abs(b).max(axis=0, initial=0.0)
        size = np.where(size > 0, size, 1.0)
        for _ in range(rounds):
            r = b - self.multiply(x)
            worst = float(np.max(np.abs(r).max(axis=0) / size))
            if not np.isfinite(worst) or worst >= smallest:
                break
            slow = worst > SLOW * smallest
            best, smallest, self.creep = x, worst, creep
            if worst <= SMALL or (slow and worst <= POOR):
                break
            change = self.approximate(r)
            x, creep = x + change, creep - change
        if smallest > POOR and not self.careful and self.control[-1] != 1.0:
            self.factorise(careful=True)  # under displacement control the matrix should be regular: try harder
            return self.refined(b, rounds)
        return best, smallest

    def null_motion(self, runaway: Array) -> Array:
        """Return the answer (size,) of a singular matrix cleared, by inverse iteration, of all that is not a motion."""
        lent, x = self._lent_to_all(), runaway
        for _ in range(INVERSE):
            y = self.approximate(lent * x)
            size = float(np.abs(y).max())
            if not np.isfinite(size) or size == 0.0:
                return runaway
            x = y / size
        return np.asarray(x if float(x @ runaway) >= 0 else -x)

    def slip_of(self, k: int) -> Array:
        """Return the plastic slip of pair k as a functional of the unknowns, (size,)."""
        row = np.zeros(self.size)
        columns, entries = self._row(self.C_t, k)
        row[columns] = entries
        row[self.n + self.m + k], row[-1] = self.data.a_t[k], self.data.tangent_rate[k]
        return row

    def opening_of(self, k: int) -> Array:
        """Return the opening of pair k as a functional of the unknowns, (size,)."""
        row = np.zeros(self.size)
        columns, entries = self._row(self.C_n, k)
        row[columns] = entries
        row[self.n + k], row[-1] = self.data.a_n[k], self.data.gap_rate[k]
        return row

    # -- right-hand sides and values ------------------------------------------------------------------------------

    def right_hand_side(self, slip: Array, offset: Array, given: float) -> Array:
        """Return the right-hand side for scaled slip s and offset o (m,) and the value of the control.

        ``offset`` of a slipping dilatant pair is that at the beginning of its slip, ``slip`` likewise.
        """
        d, n, m = self.data, self.n, self.m
        b = np.zeros(self.size)
        b[:n] = d.load
        sigma = self.sliding.astype(float)
        slip = slip + d.origin
        closed = -(d.gap + offset) - d.dilatancy * sigma * slip
        b[n : n + m] = np.select([self.contact == OPEN, self.contact == CRUSHED], [-d.cone.tension, d.cone.cap], closed)
        b[n + m : -1] = np.where(self.sliding == STICK, slip, -sigma * d.cone.cohesion)
        b[-1] = given
        return b

    def positions(self, x: Array, *, rate: bool = False) -> tuple[Array, Array]:
        """Return x_n + C_n u + a_n t_n and C_t u - x_t + a_t t_t + tau x_t', scaled, of an answer or of a rate."""
        d, n, m = self.data, self.n, self.m
        u, t_n, t_t, tau = x[:n], x[n : n + m], x[n + m : -1], x[-1]
        opening = self.C_n @ u + d.a_n * t_n + tau * d.gap_rate
        slip = self.C_t @ u + d.a_t * t_t + tau * d.tangent_rate
        return (opening, slip) if rate else (opening + d.gap, slip - d.origin)
