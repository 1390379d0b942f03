"""Products of sparse matrices with vectors, by the kernels that SciPy calls, to the same last bit.

A path of a structure of some hundred pairs takes hundreds of thousands of such products. SciPy spends thirty
microseconds of each on what surrounds the kernel, which takes two (decision 0405). The kernels are not part of SciPy's
public interface: a test compares them with the operator ``@``, to the bit.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.sparse import _sparsetools

Array = np.ndarray
Compressed = sp.csr_array | sp.csc_array | sp.csc_matrix

_BY_ROWS: Any = _sparsetools.csr_matvec
_BY_COLUMNS: Any = _sparsetools.csc_matvec


def product(A: Compressed, x: Array) -> Array:
    """Return A x (k,) of a matrix (k, n) in compressed rows or columns and a vector (n,)."""
    rows, columns = A.shape
    return _product(A.format == "csr", rows, columns, A, A.data, x)


def transposed_product(A: Compressed, x: Array) -> Array:
    """Return A' x (n,) of a matrix (k, n) in compressed rows or columns and a vector (k,)."""
    rows, columns = A.shape
    return _product(A.format != "csr", columns, rows, A, A.data, x)


def product_of_sizes(A: Compressed, x: Array) -> Array:
    """Return B x (k,), B the matrix of the absolute values of A."""
    rows, columns = A.shape
    return _product(A.format == "csr", rows, columns, A, np.abs(A.data), x)


def _product(by_rows: bool, rows: int, columns: int, A: Compressed, data: Array, x: Array) -> Array:
    x = np.asarray(x, dtype=float)
    if x.shape != (columns,):
        msg = f"a vector of {columns} entries is wanted, not an array of the shape {x.shape}"
        raise ValueError(msg)
    result = np.zeros(rows)
    kernel = _BY_ROWS if by_rows else _BY_COLUMNS
    kernel(rows, columns, A.indptr, A.indices, np.asarray(data, dtype=float), x, result)
    return result


def largest_of_columns(A: Compressed) -> Array:
    """Return the largest absolute value of each column (n,), 0 of those without entries."""
    A = A if A.format == "csc" else sp.csc_array(A)
    found = np.zeros(A.shape[1])
    some = np.flatnonzero(np.diff(A.indptr))
    if some.size:
        found[some] = np.maximum.reduceat(np.abs(A.data), A.indptr[some])
    return found
