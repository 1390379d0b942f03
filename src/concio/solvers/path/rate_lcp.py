r"""Small dense linear complementarity problem of a vertex of the path, by Lemke's method.

Where many pairs change state at once, or where flipping one after the other goes round in circles, the directions
the path may take are the solutions of a linear complementarity problem among the critical pairs alone, all other
pairs eliminated: 0 <= z, w = q + A z >= 0, z'w = 0. Its size is that of the vertex, some tens of unknowns.

The ratio test is lexicographic (Cottle, Pang and Stone, The Linear Complementarity Problem, 1992, section 4.9).
"""

from __future__ import annotations

import numpy as np

from concio.problem.contact_problem import Array

TINY = 1e-11
"""Pivots below this are not taken."""


def lemke(A: Array, q: Array, *, cover: Array | None = None, limit: int | None = None) -> Array | None:
    """Solve 0 <= z, q + A z >= 0, z'(q + A z) = 0.

    Parameters
    ----------
    A : (n, n) array
    q : (n,) array
    cover : (n,) array, optional
        Positive covering vector; ones by default.
    limit : int, optional
        Largest number of pivots.

    Returns
    -------
    (n,) array or None
        z, or None where the method ends on a ray or at the limit.
    """
    n = q.size
    if n == 0 or q.min() >= 0:
        return np.zeros(n)
    e = np.ones(n) if cover is None else cover
    # columns: w (n), z (n), z0, right-hand side;  w - A z - e z0 = q
    table = np.hstack([np.eye(n), -A, -e[:, None], q[:, None]])
    basis = np.arange(n)

    def pivot(row: int, column: int) -> None:
        table[row] /= table[row, column]
        factor = table[:, column].copy()
        factor[row] = 0.0
        table[:] -= np.outer(factor, table[row])
        basis[row] = column

    row = int(np.argmin(q / e))
    leaving = int(basis[row])
    pivot(row, 2 * n)
    for _ in range(limit or 50 * n + 100):
        entering = leaving + n if leaving < n else leaving - n
        column = table[:, entering]
        rows = np.flatnonzero(column > TINY * max(1.0, np.abs(column).max()))
        if not rows.size:
            z0 = np.flatnonzero(basis == 2 * n)
            return _read(basis, table, n) if z0.size and abs(table[z0[0], -1]) <= 1e-10 else None
        keys = np.column_stack([table[rows, -1], table[rows, :n]]) / column[rows, None]
        least = keys[:, 0].min()
        tied = np.flatnonzero(keys[:, 0] <= least + 1e-13 * max(1.0, abs(least)))
        drop = [i for i in tied if basis[rows[i]] == 2 * n]
        choice = drop[0] if drop else tied[np.lexsort(keys[tied].T[::-1])[0]]
        row = int(rows[choice])
        leaving = int(basis[row])
        pivot(row, entering)
        if leaving == 2 * n:
            return _read(basis, table, n)
    return None


def _read(basis: Array, table: Array, n: int) -> Array:
    z = np.zeros(2 * n + 1)
    z[basis] = table[:, -1]
    return np.maximum(z[n : 2 * n], 0.0)
