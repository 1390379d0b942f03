r"""The basis of Lemke's method: columns of ``[I, -M, -d]``, and two ways to keep it solvable as columns change.

* :class:`ExplicitInverse`: the dense inverse, one rank-one update (BLAS 2) a pivot.
* :class:`ProductForm`: a factorisation (SuperLU, or LAPACK where more than a fifth of the entries are not zero), and
  one eta vector a pivot.

Both are refactorised every ``refresh`` pivots; what was measured is in
``docs/research/the-basis-is-kept-in-product-form.md``.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np
import scipy.linalg as sl
import scipy.sparse as sp
from scipy.linalg.blas import dger
from scipy.linalg.lapack import dgetrf
from scipy.sparse.linalg import SuperLU, splu

from concio.problem.contact_problem import Array
from concio.solvers.algebra.sparse_factor import SingularMatrixError
from concio.solvers.lcp.linear_problem import Matrix, is_sparse

DENSE = 0.2
"""Share of entries that are not zero above which the product form factorises a full matrix."""


class Basis(Protocol):
    """What the pivoting needs of a basis B of n columns."""

    @property
    def updates(self) -> int:
        """Pivots since the factorisation."""
        ...

    def solve(self, a: Array) -> Array:
        """Return B^-1 a, (n,)."""
        ...

    def replace(self, row: int, column: Array) -> None:
        """Let the column whose image is ``column`` = B^-1 a take the place ``row``."""
        ...


class Columns:
    """The columns of [I, -M, -d]: w_j is j, z_j is n + j, z0 is 2 n.

    Parameters
    ----------
    M : (n, n) array or CSR array
    d : (n,) array
    """

    def __init__(self, M: Matrix, d: Array) -> None:
        self.n = n = d.size
        self.sparse = is_sparse(M)
        if self.sparse:
            self._all = sp.csc_array(sp.hstack([sp.eye_array(n), -sp.csc_array(M), -sp.csc_array(d[:, None])]))
        else:
            self._dense = np.asfortranarray(M)
            self._d = d

    def column(self, j: int) -> Array:
        """Return column j, (n,)."""
        n = self.n
        out = np.zeros(n)
        if self.sparse:
            part = slice(self._all.indptr[j], self._all.indptr[j + 1])
            out[self._all.indices[part]] = self._all.data[part]
        elif j < n:
            out[j] = 1.0
        else:
            out = -(self._dense[:, j - n] if j < 2 * n else self._d)
        return out

    def matrix(self, basis: Array) -> Matrix:
        """Return the matrix of the columns named by ``basis`` (n,)."""
        if self.sparse:
            return self._all[:, basis]
        n, j = self.n, np.asarray(basis)
        out = np.zeros((n, j.size), order="F")
        w, z, last = np.flatnonzero(j < n), np.flatnonzero((j >= n) & (j < 2 * n)), np.flatnonzero(j == 2 * n)
        out[j[w], w] = 1.0
        out[:, z] = -self._dense[:, j[z] - n]
        out[:, last] = -self._d[:, None]
        return out


class ExplicitInverse:
    """Dense inverse of the basis, updated by rank one."""

    def __init__(self, columns: Columns, basis: Array) -> None:
        matrix = columns.matrix(basis)
        dense = matrix.toarray() if is_sparse(matrix) else matrix
        try:
            self._inverse: Array = np.asfortranarray(np.linalg.inv(dense))
        except np.linalg.LinAlgError as error:
            raise SingularMatrixError(str(error)) from error
        self.updates = 0

    def solve(self, a: Array) -> Array:
        """Return B^-1 a, (n,)."""
        support = np.flatnonzero(a)
        if support.size * 4 < a.size:
            out: Array = self._inverse[:, support] @ a[support]
            return out
        return np.asarray(self._inverse @ a)

    def replace(self, row: int, column: Array) -> None:
        """Let the column whose image is ``column`` take the place ``row``."""
        pivot_row = self._inverse[row] / column[row]
        change = column.copy()
        change[row] -= 1.0
        self._inverse = dger(-1.0, change, pivot_row, a=self._inverse, overwrite_a=1)
        self.updates += 1


class ProductForm:
    """LU factors of an earlier basis and the eta vectors of the pivots since."""

    def __init__(self, columns: Columns, basis: Array) -> None:
        matrix = columns.matrix(basis)
        count = matrix.nnz if is_sparse(matrix) else np.count_nonzero(matrix)
        self._solve: Callable[[Array], Array]
        if count > DENSE * basis.size**2:
            dense = matrix.toarray() if is_sparse(matrix) else matrix
            lu, rows, zero = dgetrf(dense)
            if zero:
                msg = "a pivot is zero"
                raise SingularMatrixError(msg)
            self._solve = lambda a: sl.lu_solve((lu, rows), a, check_finite=False)
        else:
            try:
                factors: SuperLU = splu(sp.csc_matrix(matrix))
            except RuntimeError as error:
                raise SingularMatrixError(str(error)) from error
            self._solve = factors.solve
        self._etas: list[tuple[int, float, Array]] = []

    @property
    def updates(self) -> int:
        """Pivots since the factorisation."""
        return len(self._etas)

    def solve(self, a: Array) -> Array:
        """Return B^-1 a, (n,)."""
        x = self._solve(a)
        for row, pivot, eta in self._etas:
            value = x[row] / pivot
            if value != 0.0:
                x -= value * eta
                x[row] = value
        return x

    def replace(self, row: int, column: Array) -> None:
        """Let the column whose image is ``column`` take the place ``row``."""
        self._etas.append((row, float(column[row]), column.copy()))
