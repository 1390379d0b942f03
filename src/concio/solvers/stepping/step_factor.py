"""Factors of A + C'DC for rows that change their values from step to step and their unknowns only with a new search."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from concio.problem.contact_problem import Array, Engine
from concio.solvers.algebra.factor import Springs
from concio.solvers.algebra.sparse_factor import OrderedFactor, Pattern, SingularMatrixError

SMALL = 40
"""Unknowns up to which a dense inverse is cheaper than everything around a sparse factor."""


class SmallInverse:
    """Factors of matrices of a pattern with few unknowns, as dense inverses."""

    def __init__(self, pattern: Pattern) -> None:
        self.count = 0
        major = pattern.order[np.repeat(np.arange(pattern.size), np.diff(pattern.indptr))]
        minor = pattern.order[pattern.minor]
        self._at = (minor, major) if pattern.engine == "superlu" else (major, minor)
        self._inverse: Array = np.zeros((pattern.size, pattern.size))

    def factorise(self, data: Array) -> None:
        """Invert the matrix with these entries; raises SingularMatrixError where that is not possible."""
        dense = np.zeros(self._inverse.shape)
        dense[self._at] = data
        try:
            inverse = np.linalg.inv(dense)
        except np.linalg.LinAlgError:
            inverse = np.full_like(dense, np.nan)
        if not np.isfinite(inverse.sum()):
            msg = "the matrix of a step is singular"
            raise SingularMatrixError(msg)
        self._inverse = inverse
        self.count += 1

    def solve(self, b: Array) -> Array:
        """Return the solution for the last matrix."""
        solution: Array = self._inverse @ b
        return solution


class StepFactor:
    """Pattern and ordering of one layout of pairs, and the factors of its matrices.

    Parameters
    ----------
    matrix : (N, N) CSR array
        A; its pattern must stay, its entries may change (:meth:`take`).
    columns : (m, w) integer array
        Unknowns of the rows of each pair; N where there is none.
    engine : {"superlu", "pardiso"}, optional
    """

    def __init__(self, matrix: sp.csr_array, columns: Array, engine: Engine = "superlu") -> None:
        n = matrix.shape[0]
        m, w = columns.shape
        coo = matrix.tocoo()
        row = np.broadcast_to(columns[:, :, None], (m, w, w)).ravel()
        column = np.broadcast_to(columns[:, None, :], (m, w, w)).ravel()
        inside = (row < n) & (column < n)
        identity = np.arange(n)
        pattern = Pattern.of(
            np.concatenate([coo.row, identity, row[inside]]),
            np.concatenate([coo.col, identity, column[inside]]),
            n,
            engine,
        )
        self.pattern = pattern
        self._matrix_slot, self._diagonal_slot = pattern.slot[: coo.nnz], pattern.slot[coo.nnz : coo.nnz + n]
        slot = np.full(m * w * w, pattern.nnz, dtype=np.int64)
        slot[inside] = pattern.slot[coo.nnz + n :]
        self._slot = self._slots_now = slot.reshape(m, w * w)
        self.numeric: SmallInverse | OrderedFactor = SmallInverse(pattern) if n <= SMALL else OrderedFactor(pattern)
        self.D: Array | None = None
        self.diagonal: Springs | None = None

    _rows: tuple[Array, Array, Array] | None = None
    """Places of entries of the pattern by rows, their columns, and where rows begin."""

    _matrix: sp.csr_array | None = None
    _entries: Array
    """A, and its entries in the pattern."""

    _assembled: tuple[Array, Array] | None = None
    """Blocks D of the last matrix of these rows, and its entries."""

    def take(self, matrix: sp.csr_array, values: Array, pick: Array | None = None) -> None:
        """Take other entries of A, and other rows ``values`` (m, d, w), for the factors to come.

        Where the rows are those of some pairs of the layout alone, ``pick`` says of which.
        """
        if self._matrix is not matrix:
            self._matrix = matrix
            self._entries = np.bincount(self._matrix_slot, weights=matrix.data, minlength=self.pattern.nnz)
        self._values, self._assembled = values, None
        self._slots_now = self._slot if pick is None else self._slot[pick]

    @property
    def count(self) -> int:
        """Number of factorisations made."""
        return self.numeric.count

    def factorise(self, D: Array, diagonal: Springs = 0.0) -> None:
        """Factorise A + C'DC + diagonal for blocks D (m, d, d).

        Raises
        ------
        SingularMatrixError
            A pivot is zero or not finite.
        """
        before = self._assembled
        change = D if before is None else D - before[0]
        some = filled(change)  # open pairs have none; from round to round few pairs change
        if before is not None and 2 * len(some) > len(D):
            before, change, some = None, D, filled(D)
        data = self._products(change, some)
        data += self._entries if before is None else before[1]
        self._assembled = D.copy(), data
        data = data.copy()
        assert not isinstance(diagonal, sp.csr_array), "a diagonal"
        if np.any(diagonal):
            data[self._diagonal_slot] += diagonal
        self.D = None
        self.numeric.factorise(data)
        self.D, self.diagonal = D, diagonal

    def _products(self, D: Array, some: Array) -> Array:
        """Return the entries of C'DC of some pairs."""
        nnz, values = self.pattern.nnz, self._values[some]
        local = np.matmul(values.transpose(0, 2, 1), np.matmul(D[some], values))
        found = np.bincount(self._slots_now[some].ravel(), weights=local.ravel(), minlength=nnz + 1)[:nnz]
        return np.asarray(found, dtype=float)

    def without(self, some: Array) -> sp.csr_array:
        """Return the last matrix factorised, without what pairs ``some`` (k,) have in it."""
        assert self._assembled is not None
        if self._rows is None:
            p = self.pattern
            major = p.order[np.repeat(np.arange(p.size), np.diff(p.indptr))]
            minor = p.order[p.minor]
            row, column = (minor, major) if p.engine == "superlu" else (major, minor)
            place = np.lexsort((column, row))
            ends = np.concatenate([[0], np.cumsum(np.bincount(row, minlength=p.size))]).astype(np.int32)
            self._rows = place, column[place].astype(np.int32), ends
        D, data = self._assembled
        place, column, ends = self._rows
        n = self.pattern.size
        return sp.csr_array(((data - self._products(D, some))[place], column, ends), shape=(n, n))

    def solve(self, b: Array) -> Array:
        """Return the solution for the last matrix factorised; ``b`` is (N,) or (N, k)."""
        return self.numeric.solve(b)


def filled(D: Array) -> Array:
    """Return the numbers of blocks (m, d, d) with an entry that is not zero."""
    found = np.zeros(len(D), dtype=bool)
    found[np.flatnonzero(D.ravel()) // (D.shape[1] * D.shape[2])] = True
    return np.flatnonzero(found)
