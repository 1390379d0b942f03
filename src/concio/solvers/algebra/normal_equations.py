"""Matrices A Theta A' of the statics of block structures: ordered once, and what is left unbalanced taken away by them.

The rows of A are the rigid motions of the blocks, its columns the forces of the joints: A Theta A' is the stiffness
matrix of rigid blocks on springs of stiffness Theta, its graph that of the structure. Where its band is narrow LAPACK
factorises the band by Cholesky's method, in a third of the time of SuperLU (walls of 70 to 180 stones); where rounding
leaves a pivot that is not positive, and for wide bands, SuperLU takes over.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass
from hashlib import blake2b
from typing import Any

import numpy as np
import scipy.linalg as sl
import scipy.sparse as sp
import scipy.sparse.linalg as sla

from concio.problem.contact_problem import Array
from concio.problem.products import product
from concio.solvers.algebra.sparse_factor import narrow_band, nested_dissection

GROUP = 3
"""Rows that stay together in the order: the rigid motions of a block in the plane."""

REPEATS = 4
"""Largest number of times a point is rebalanced."""

KEPT = 4
"""Matrices whose order and products are kept: programmes that follow each other differ in their bounds alone."""


class NormalEquations:
    """Factorises A Theta A' for changing positive Theta; the rows of A are put in a fill-reducing order once.

    Parameters
    ----------
    A : (M, n) sparse array
    """

    def __init__(self, A: sp.csc_array) -> None:
        made = _ordered(A)
        self.order, self.ordering, self.A, self.At = made.order, made.ordering, made.A, made.At
        self.weights, self.diagonal, self.band = made.weights, made.diagonal, made.band
        pattern = made.matrix
        self.matrix = sp.csc_matrix((pattern.data, pattern.indices, pattern.indptr), shape=pattern.shape)
        self.matrix.has_canonical_format = True
        self.lu: Any = None
        self.cholesky = np.zeros((0, 0))

    def factorise(self, theta: Array) -> None:
        """Factorise A diag(theta) A', its diagonal lifted by rounding; rows of nothing get a one."""
        data = product(self.weights, theta)
        diagonal = data[self.diagonal]
        lifted = diagonal * (1.0 + 1e-15) + 1e-14 * float(np.median(diagonal))
        data[self.diagonal] = np.where(lifted > 0, lifted, 1.0)
        self.matrix.data = data
        self.lu = None
        if self.band is not None:
            self.cholesky, wrong = sl.lapack.dpbtrf(self.band.filled(data), lower=1, overwrite_ab=1)
            if not wrong:
                return
        spec = "MMD_AT_PLUS_A" if self.ordering == "minimum degree" else "NATURAL"
        splu: Any = sla.splu
        self.lu = splu(self.matrix, permc_spec=spec, diag_pivot_thresh=0.0, options={"SymmetricMode": True})

    def solve(self, g: Array) -> Array:
        """Return M^-1 g for g in the order of :attr:`order`, once refined."""
        x = self.solve_once(g)
        x += self.solve_once(g - product(self.matrix, x))
        return x

    def solve_once(self, g: Array) -> Array:
        """Return M^-1 g for g in the order of :attr:`order`, as the factors give it."""
        if self.lu is not None:
            return np.asarray(self.lu.solve(g))
        x, _ = sl.lapack.dpbtrs(self.cholesky, g[:, None], lower=1)
        return np.asarray(x[:, 0])


@dataclass(frozen=True, eq=False)
class _Band:
    """Where the entries of a matrix at and below its diagonal stand in LAPACK's band.

    Parameters
    ----------
    shape : (int, int)
        Half the width plus one, and the number of rows.
    entries, places : (k,) integer arrays
        Among the values of the matrix and in the band, column by column.
    """

    shape: tuple[int, int]
    entries: Array
    places: Array

    @classmethod
    def of(cls, matrix: sp.csc_matrix, width: int) -> _Band:
        """Return the places of a matrix whose entries are at most ``width`` from its diagonal."""
        rows = matrix.shape[0]
        below = matrix.indices - np.repeat(np.arange(rows), np.diff(matrix.indptr))
        entries = np.flatnonzero(below >= 0)
        column = np.repeat(np.arange(rows), np.diff(matrix.indptr))[entries]
        return cls((width + 1, rows), entries, column * (width + 1) + below[entries])

    def filled(self, data: Array) -> Array:
        """Return the band (width + 1, rows) of values (nnz,)."""
        band = np.zeros(self.shape[0] * self.shape[1])
        band[self.places] = data[self.entries]
        return band.reshape(self.shape[1], -1).T


@dataclass(frozen=True, eq=False)
class _Ordered:
    """What does not depend on Theta: see :class:`NormalEquations`."""

    order: Array
    ordering: str
    A: sp.csr_array
    At: sp.csr_array
    matrix: sp.csc_matrix
    weights: sp.csr_array
    diagonal: Array
    band: _Band | None


_RECENT: OrderedDict[bytes, _Ordered] = OrderedDict()


def _ordered(A: sp.csc_array) -> _Ordered:
    """Return the order and the products of a matrix, those of the last few as they were made."""
    digest = blake2b(repr(A.shape).encode())
    for part in (A.indptr, A.indices, A.data):
        digest.update(np.ascontiguousarray(part).view(np.uint8).data)
    key = digest.digest()
    made = _RECENT.get(key)
    if made is None:
        pattern = sp.csr_array(abs(A) @ abs(A).T)
        order, width = narrow_band(pattern)
        ordering = "reverse Cuthill-McKee, a band"
        if width is None:
            order, ordering = nested_dissection(pattern, GROUP)
        mine = sp.csr_array(sp.csr_array(A)[order])
        matrix, weights, diagonal = _products(sp.csc_array(mine))
        band = None if width is None else _Band.of(matrix, width)
        made = _Ordered(order, ordering, mine, sp.csr_array(mine.T), matrix, weights, diagonal, band)
    _RECENT[key] = made
    while len(_RECENT) > KEPT:
        _RECENT.popitem(last=False)
    return made


def _products(A: sp.csc_array) -> tuple[sp.csc_matrix, sp.csr_array, Array]:
    """Return A Theta A' of zeros, the matrix that makes its entries of theta, and where its diagonal is among them.

    An entry (i, j) is the sum of A_ik A_jk theta_k over the columns k: linear in theta, by weights that stay.
    """
    rows, columns = A.shape
    entries = np.diff(A.indptr)
    column = np.repeat(np.arange(columns), entries)
    first = np.repeat(np.arange(A.nnz), entries[column])
    run = np.repeat(np.cumsum(entries[column]) - entries[column], entries[column])
    second = A.indptr[column[first]] + np.arange(first.size) - run
    keys = A.indices[second].astype(np.int64) * rows + A.indices[first]
    on_diagonal = np.arange(rows, dtype=np.int64) * (rows + 1)
    kept, slot = np.unique(np.concatenate([keys, on_diagonal]), return_inverse=True)
    value = A.data[first] * A.data[second]
    weights = sp.csr_array((value, (slot[: keys.size], column[first])), shape=(kept.size, columns))
    starts = np.searchsorted(kept, np.arange(rows + 1, dtype=np.int64) * rows)
    matrix = sp.csc_matrix((np.zeros(kept.size), kept % rows, starts), shape=(rows, rows))
    matrix.has_canonical_format = True
    return matrix, weights, slot[keys.size :]


def rebalance(A: sp.csc_array, x: Array, target: Array, bounds: Array) -> Array:
    """Remove what is left of A x + target by changes of x in proportion to the room within the bounds.

    With D the distance to the nearer bound (cut at the largest held x) and free columns F: x - D A'v for the held and
    x - phi for the free, where A D A'v + F phi = A x + target, F'v = 0; cut at the bounds, repeated while it helps.

    Parameters
    ----------
    A : (M, n) CSC array
    x : (n,) array
    target : (M,) array
    bounds : (n, 2) array
        Columns with two infinite bounds are free.
    """
    lower, upper = bounds[:, 0], bounds[:, 1]
    held = np.isfinite(lower) | np.isfinite(upper)
    x = np.clip(x, lower, upper)
    residual = A @ x + target
    if not np.abs(residual).max(initial=0.0) > 0:
        return x
    normal = NormalEquations(sp.csc_array(A[:, held]))
    F = A[:, ~held].toarray()[normal.order]
    for _ in range(REPEATS):
        room = np.minimum(np.minimum(x - lower, upper - x), np.abs(x[held]).max(initial=1e-300))[held]
        try:
            normal.factorise(room)
        except RuntimeError:
            break
        v = normal.solve(residual[normal.order])
        trial = x.copy()
        if F.shape[1]:
            solved = np.column_stack([normal.solve(f) for f in F.T])
            phi = np.linalg.solve(F.T @ solved, F.T @ v)
            trial[~held] -= phi
            v -= solved @ phi
        trial[held] -= room * (normal.At @ v)
        trial = np.clip(trial, lower, upper)
        left = A @ trial + target
        if not np.abs(left).max() < np.abs(residual).max():
            break
        x, residual = trial, left
    return x
