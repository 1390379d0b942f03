r"""Newton's equations of a cone programme as a whole, factorised with pivoting: ordered once for all points.

In the scaled forces dx, the motion dv and the multiplier they are

.. math:: \begin{bmatrix} I & F^T C & 0 \\ C^T F & -\rho I & g \\ 0 & g^T & 0 \end{bmatrix},

whose condition is the square root of that of the condensed matrix C'DC, D = FF'. The roots F have one dense block for
each pair, so that the pattern is that of the pairs whatever the point, and so is the order of its columns.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sla

from concio.problem.contact_problem import Array
from concio.solvers.algebra.sparse_factor import nested_dissection


class Mixed:
    """Factorises that matrix for changing roots F (m, d, d) and loads g (r,).

    Columns are eliminated by nested dissection of the pattern of A'A, whatever rows the pivots are found in: a third of
    the fill of the usual order of columns, and a quarter of the time.

    Parameters
    ----------
    C : (m d, r) CSR array
        Velocities of the pairs, d rows for each.
    pairs : int
        m.
    """

    def __init__(self, C: sp.csr_array, pairs: int) -> None:
        rows, r = C.shape
        d = rows // max(pairs, 1)
        entries = C.tocoo()
        met, place = np.unique(entries.row // d * np.int64(r) + entries.col, return_inverse=True)
        self.pair, column = met // r, met % r
        self.C = np.zeros((met.size, d))  # the d velocities of a pair in each motion that it feels
        self.C[place, entries.row % d] = entries.data
        force = (d * self.pair[:, None] + np.arange(d)).ravel()
        motion = rows + np.repeat(column, d)
        own, moved, last = np.arange(rows), rows + np.arange(r), np.full(r, rows + r)
        row = np.concatenate([own, force, motion, moved, moved, last])
        col = np.concatenate([own, motion, force, moved, last, moved])
        n = rows + r + 1
        inner = sp.csr_array((np.ones(row.size - 2 * r), (row[: -2 * r], col[: -2 * r])), shape=(n - 1, n - 1))
        order, _ = nested_dissection(sp.csr_array(inner.T @ inner), group=1)
        self.spec = "MMD_ATA" if np.array_equal(order, np.arange(order.size)) else "NATURAL"
        self.order = np.append(order, n - 1)
        at = np.empty(n, dtype=np.int64)
        at[self.order] = np.arange(n)
        self.sorted = np.lexsort((row, at[col]))
        starts = np.concatenate([[0], np.cumsum(np.bincount(at[col], minlength=n))])
        self.shape, self.indices, self.indptr = (n, n), row[self.sorted].astype(np.int32), starts.astype(np.int32)

    def factors(self, F: Array, g: Array, loose: float) -> Pivoted:
        """Return the factors for roots F (m, d, d), a load g (r,) and a stiffness ``loose`` of every motion.

        Raises
        ------
        RuntimeError
            The matrix is singular.
        """
        velocities = np.matmul(self.C[:, None, :], F[self.pair])[:, 0, :].ravel()
        ones, springs = np.ones(F.shape[0] * F.shape[1]), np.full(g.size, -loose)
        data = np.concatenate([ones, velocities, velocities, springs, g, g])[self.sorted]
        matrix = sp.csc_matrix((data, self.indices, self.indptr), shape=self.shape)
        matrix.has_canonical_format = True
        splu: Any = sla.splu
        return Pivoted(splu(matrix, permc_spec=self.spec), self.order)


class Pivoted:
    """Factors whose columns were put in order.

    Parameters
    ----------
    factors : SuperLU
        Of the matrix with its columns in order.
    order : (N,) integer array
    """

    def __init__(self, factors: Any, order: Array) -> None:
        self.factors, self.order = factors, order

    def solve(self, right: Array) -> Array:
        """Return x (N,) with A x = right."""
        x = np.empty_like(right)
        x[self.order] = self.factors.solve(right)
        return x
