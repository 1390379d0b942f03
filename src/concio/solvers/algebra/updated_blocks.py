r"""The factor at hand, and a few pairs whose blocks have changed since: Woodbury instead of a factorisation.

With factors of :math:`A = K + C^T D C + \rho I` and the rows :math:`C_P` of a few pairs P,

.. math:: (A + C_P^T\,\Delta\,C_P)^{-1} b = x - X\,(I + \Delta W)^{-1} \Delta\, C_P x, \qquad
          X = A^{-1} C_P^T, \quad W = C_P X, \quad x = A^{-1} b.

The columns X of a pair cost d back-substitutions, many at once much less than one by one; they are kept as long as the
factor is, whatever happens to the pair. Stiffness added this way loses no digits; stiffness taken away loses as many as
the pair was stiffer than what is left, which refinement makes up for.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.linalg as sl
import scipy.sparse as sp

from concio.problem.contact_problem import Array
from concio.solvers.algebra.block_factor import same_springs
from concio.solvers.algebra.factor import Factor, Springs
from concio.solvers.algebra.sparse_factor import SingularMatrixError

MOST = 48
"""Largest number of pairs whose columns are kept."""

AT_ONCE = 32
"""Largest number of columns solved for together."""

ROOM = 3e7
"""Largest number of entries of the columns kept."""


class UpdatedBlocks:
    """Factors of A = K + C' D C + diagonal whose blocks D differ in a few pairs from those factorised.

    Parameters
    ----------
    factor : Factor
        Of A.
    C : (m d, N) CSR array, or dense
        Columns beyond N are left out.
    N, d : int
    most : int
        Largest number of pairs whose columns are kept.

    Attributes
    ----------
    D : (m, d, d) array or None
        The blocks as they are now.
    """

    def __init__(self, factor: Factor, C: Any, N: int, d: int, most: int = MOST) -> None:
        self.factor, self.C, self.N, self.d = factor, C, N, d
        self.most = int(min(most, ROOM // max(N * d, 1)))
        self.forget()

    def forget(self) -> None:
        """Begin with the factor as it is: no columns, no changes."""
        self.version = self.factor.count
        self.pairs = np.zeros(0, dtype=int)
        self.X, self.W = np.zeros((self.N, 0)), np.zeros((0, 0))
        self.C_P: Any = None
        self._place = np.full(self.C.shape[0] // self.d, -1)
        self._delta = np.zeros((0, 0))
        self.D = self.factor.D

    def factorise(self, D: Array, diagonal: Springs) -> None:
        """Factorise again; no pair differs then.

        Raises
        ------
        SingularMatrixError
            The matrix cannot be factorised.
        """
        self.factor.factorise(D, diagonal)
        self.forget()

    def has(self, diagonal: Springs) -> bool:
        """Tell whether there is a factor at hand with this added to K."""
        return same_springs(self.factor.diagonal, diagonal)

    def room_for(self, pairs: Array) -> bool:
        """Tell whether the columns of some pairs (k,) can join those kept."""
        kept = self.pairs if self.version == self.factor.count else np.zeros(0, dtype=int)
        return np.union1d(kept, pairs).size <= self.most

    def change(self, pairs: Array, blocks: Array) -> None:
        """Let ``blocks`` (k, d, d) stand for those of ``pairs`` (k,), and all others be as they were factorised."""
        held = self.factor.D
        assert held is not None, "a factor at hand"
        if not pairs.size:
            self.D, self._delta = held, np.zeros((0, 0))
            return
        self._meet(pairs)
        delta = np.zeros((self.pairs.size, self.d, self.d))
        delta[self._places(pairs)] = blocks - held[pairs]
        self.D = held.copy()
        self.D[pairs] = blocks
        self._delta = block_diagonal(delta)
        if self._delta.any():
            system = np.eye(len(self.W)) + self._delta @ self.W
            lu, pivots, zero = sl.lapack.dgetrf(system)
            if zero or not np.isfinite(lu).all():
                msg = "the update makes the matrix singular"
                raise SingularMatrixError(msg)
            self._inverse = lu, pivots

    def solve(self, b: Array) -> Array:
        """Return the solution for the blocks as they are now; ``b`` is (N,)."""
        x = self.factor.solve(b)
        if not self._delta.any():
            return x
        shift = sl.lu_solve(self._inverse, self._delta @ (self.C_P @ x), check_finite=False)
        solution: Array = x - self.X @ shift
        return solution

    def flexibility(self, pairs: Array) -> Array:
        """Return C_P (A + ...)^-1 C_P', (k d, k d): displacements of some pairs under unit forces of theirs."""
        W = self.W
        if self._delta.any():
            W = W - W @ sl.lu_solve(self._inverse, self._delta @ W, check_finite=False)
        at = self._rows(self._places(pairs))
        return np.asarray(W[np.ix_(at, at)])

    def moved(self, pairs: Array, forces: Array) -> Array:
        """Return the displacements (N,) under forces (k d,) of some pairs whose columns are kept."""
        f = np.zeros(len(self.W))
        f[self._rows(self._places(pairs))] = forces
        if self._delta.any():
            f -= sl.lu_solve(self._inverse, self._delta @ (self.W @ f), check_finite=False)
        displacements: Array = self.X @ f
        return displacements

    def _places(self, pairs: Array) -> Array:
        """Return where pairs stand among those with columns."""
        return np.asarray(self._place[pairs])

    def _rows(self, pairs: Array) -> Array:
        """Return the numbers of the rows of some pairs, pair after pair."""
        return np.asarray(pairs[:, None] * self.d + np.arange(self.d)).ravel()

    def _meet(self, pairs: Array) -> None:
        """Work out the columns of pairs that have none yet."""
        if self.version != self.factor.count:
            self.forget()
        missing = np.zeros(len(self._place), dtype=bool)
        missing[pairs] = self._place[pairs] < 0
        new = np.flatnonzero(missing)
        if not new.size:
            return
        chosen = self._rows(new)
        X = np.empty((self.N, self.X.shape[1] + chosen.size))
        X[:, : self.X.shape[1]] = self.X
        for first in range(0, chosen.size, AT_ONCE):  # all at once would not fit beside large factors
            some = chosen[first : first + AT_ONCE]
            at = self.X.shape[1] + first
            X[:, at : at + some.size] = self.factor.solve(self._columns(some))
        self._place[new] = self.pairs.size + np.arange(new.size)
        self.X, self.pairs = X, np.concatenate([self.pairs, new])
        self.C_P = self._rows_of(self._rows(self.pairs))
        self.W = self.C_P @ self.X

    def _columns(self, rows: Array) -> Array:
        """Return some rows of C as columns (N, k)."""
        columns = np.zeros((self.N, rows.size))
        if isinstance(self.C, np.ndarray):
            columns[:] = self.C[rows, : self.N].T
            return columns
        number, unknown, value = self._entries(rows)
        columns[unknown, number] = value
        return columns

    def _rows_of(self, rows: Array) -> Any:
        """Return some rows of C, (k, N)."""
        if isinstance(self.C, np.ndarray):
            return self.C[rows, : self.N]
        number, unknown, value = self._entries(rows)
        return sp.csr_array((value, (number, unknown)), shape=(rows.size, self.N))

    def _entries(self, rows: Array) -> tuple[Array, Array, Array]:
        """Return the entries of some rows of a sparse C: which of the rows, unknowns below N, values."""
        first = self.C.indptr[rows]
        count = self.C.indptr[rows + 1] - first
        number = np.repeat(np.arange(rows.size), count)
        at = np.arange(number.size) + np.repeat(first - np.cumsum(count) + count, count)
        unknown = self.C.indices[at]
        own = unknown < self.N
        return number[own], unknown[own], self.C.data[at[own]]


def block_diagonal(blocks: Array) -> Array:
    """Return the matrix (k d, k d) of blocks (k, d, d) on its diagonal."""
    k, d, _ = blocks.shape
    matrix = np.zeros((k, d, k, d))
    matrix[np.arange(k), :, np.arange(k)] = blocks
    return matrix.reshape(k * d, k * d)
