r"""The Delassus operator: flexibility of the structure seen from its contact pairs, ``W = C A^{-1} C'``.

``A`` is block diagonal, one definite block for each body: K itself where no body floats, else K with a proximal term
(see :mod:`.gauss_seidel`). W couples the pairs of one body with each other and nothing else; it
is computed body by body and kept sparse. Pairs that share no body can be treated at once: :func:`colours` sorts them.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from concio.problem.contact_problem import Array


def delassus(a: sp.csc_array, c: sp.csr_array, bodies: Array) -> sp.csr_array:
    """Return W = C A^-1 C', shape (m d, m d).

    Parameters
    ----------
    a : (N, N) CSC array
        Definite and block diagonal.
    c : (m d, N) CSR array
    bodies : (B+1,) integer array
        Unknowns of body k are ``bodies[k]:bodies[k+1]``.
    """
    columns = sp.csc_array(c)
    rows, cols, values = [], [], []
    for start, stop in pairwise(bodies):
        mine = columns[:, start:stop]
        touched = np.unique(mine.indices)
        if not touched.size:
            continue
        part = sp.csr_array(mine)[touched].toarray()
        block = sp.csc_matrix(a[start:stop, start:stop])
        w = part @ splu(block).solve(np.ascontiguousarray(part.T))
        rows.append(np.repeat(touched, touched.size))
        cols.append(np.tile(touched, touched.size))
        values.append((0.5 * (w + w.T)).ravel())
    n = c.shape[0]
    if not rows:
        return sp.csr_array((n, n))
    return sp.csr_array(sp.coo_array((np.concatenate(values), (np.concatenate(rows), np.concatenate(cols))), (n, n)))


def colours(w: sp.csr_array, d: int) -> list[Array]:
    """Return groups of pairs none of which W couples with another of its group (greedy colouring).

    Parameters
    ----------
    w : (m d, m d) CSR array
    d : int
        Rows of a pair.
    """
    m = w.shape[0] // d
    entries = w.tocoo()
    graph = sp.csr_array((np.ones(entries.nnz), (entries.row // d, entries.col // d)), shape=(m, m))
    colour = np.full(m, -1)
    for k in range(m):
        near = colour[graph.indices[graph.indptr[k] : graph.indptr[k + 1]]]
        taken = np.zeros(near.size + 1, dtype=bool)
        taken[near[(near >= 0) & (near < taken.size)]] = True
        colour[k] = int(np.argmin(taken))
    return [np.flatnonzero(colour == c) for c in range(int(colour.max(initial=-1)) + 1)]
