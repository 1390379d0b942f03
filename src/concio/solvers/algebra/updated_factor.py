r"""A sparse factorisation that survives the replacement of single rows.

:math:`F = A_0 + \sum_i e_{\varphi_i} v_i^T` after p rows of :math:`A_0` were replaced, and with
:math:`W = A_0^{-1}[e_{\varphi_1} \dots e_{\varphi_p}]`

.. math:: F^{-1} b = y - W (I + V^T W)^{-1} V^T y, \qquad y = A_0^{-1} b

(the Schur-complement update of Bisschop and Meeraus, *Mathematical Programming* 13 (1977) 241-254, for rows). A
replacement costs one pair of sparse triangular solves; after ``refresh`` different rows the matrix is factorised again.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import SuperLU, splu

from concio.problem.contact_problem import Array
from concio.solvers.algebra.sparse_factor import SingularMatrixError

CANCELLED = 1e5
"""Ratio of a column to its updated one beyond which digits are lost: the factorised matrix was nearly singular."""

Row = tuple[Array, Array]
"""Column numbers and values of a sparse row."""


class UpdatedFactor:
    """Factors of a sparse matrix whose rows are replaced one at a time.

    Parameters
    ----------
    rows : list of Row
        The n rows.
    refresh : int
        Number of different rows replaced before ``stale`` turns true.
    """

    def __init__(self, rows: list[Row], refresh: int = 64) -> None:
        self.rows = list(rows)
        self.n = len(rows)
        self.refresh = refresh
        self.factorisations = 0
        self.factorise()

    @property
    def stale(self) -> bool:
        """True when the next replacement should be preceded by a factorisation."""
        return len(self._places) >= self.refresh

    def matrix(self) -> sp.csr_array:
        """Return the current matrix."""
        counts = np.array([r[0].size for r in self.rows])
        indptr = np.concatenate([[0], np.cumsum(counts)])
        indices = np.concatenate([r[0] for r in self.rows])
        data = np.concatenate([r[1] for r in self.rows])
        return sp.csr_array((data, indices, indptr), shape=(self.n, self.n))

    def factorise(self) -> None:
        """Factorise the current matrix.

        Raises
        ------
        SingularMatrixError
            It is singular.
        """
        try:
            self._lu: SuperLU = splu(sp.csc_matrix(self.matrix()), permc_spec="COLAMD")
        except RuntimeError as error:
            raise SingularMatrixError(str(error)) from error
        self.factorisations += 1
        self._base = list(self.rows)
        self._places: list[int] = []
        self._where: dict[int, int] = {}
        self._columns: dict[int, Array] = {}
        self._W = np.zeros((self.n, self.refresh + 1), order="F")
        self._S = np.zeros((self.refresh + 1, self.refresh + 1))
        self._changes: list[Row] = []

    def column(self, place: int) -> Array:
        """Return F^-1 e_place, (n,); factorises again first where the update would cancel too many digits."""
        base = self._base_column(place)
        column = self._correct(base.copy())
        if self._places and float(np.abs(base).max()) > CANCELLED * float(np.abs(column).max()):
            self.factorise()
            column = self._base_column(place).copy()
        return column

    def solve(self, b: Array) -> Array:
        """Return F^-1 b, (n,)."""
        return self._correct(self._lu.solve(b))

    def replace(self, place: int, row: Row) -> None:
        """Put ``row`` in the place of row ``place``."""
        self.rows[place] = row
        p = self._where.get(place)
        if p is None:
            if self.stale:
                self.factorise()
                return
            p = len(self._places)
            self._W[:, p] = self._base_column(place)
            self._columns.pop(place, None)
            self._places.append(place)
            self._where[place] = p
            for i, (columns, values) in enumerate(self._changes):
                self._S[i, p] = values @ self._W[columns, p]
            self._changes.append(row)
        old, new = self._base[place], row
        change = (np.concatenate([new[0], old[0]]), np.concatenate([new[1], -old[1]]))
        self._changes[p] = change
        q = len(self._places)
        self._S[p, :q] = change[1] @ self._W[change[0], :q]
        self._S[p, p] += 1.0

    def _base_column(self, place: int) -> Array:
        p = self._where.get(place)
        if p is not None:
            column: Array = self._W[:, p]
            return column
        if place not in self._columns:
            unit = np.zeros(self.n)
            unit[place] = 1.0
            self._columns = {place: self._lu.solve(unit)}
        return self._columns[place]

    def _correct(self, y: Array) -> Array:
        q = len(self._places)
        if not q:
            return y
        short = np.array([values @ y[columns] for columns, values in self._changes])
        try:
            weights = np.linalg.solve(self._S[:q, :q], short)
        except np.linalg.LinAlgError as error:
            raise SingularMatrixError(str(error)) from error
        y -= self._W[:, :q] @ weights
        return y
