r"""Factors of matrices of one symmetric pattern by dense fronts: LAPACK's speed on the graph of rigid blocks in space.

Each front of :mod:`concio.solvers.algebra.front_tree` is a dense matrix of four parts,

.. math:: \begin{bmatrix} F_{11} & F_{12} \\ F_{21} & F_{22} \end{bmatrix}, \qquad F_{11} = P L U, \qquad
    F_{22} - (F_{21} U^{-1}) (L^{-1} P^T F_{12}),

of which the first three are kept as factors, and the last is handed on to the next front. The diagonal of F11 is
brought to one first, and its rows are exchanged among each other only. What differs from matrix to matrix is numbers:
every entry has its place.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg.blas as blas
import scipy.linalg.lapack as lapack

from concio.problem.contact_problem import Array
from concio.solvers.algebra.front_tree import Front, FrontTree


@dataclass(frozen=True, eq=False)
class Handing:
    """Where the changes of a child (r, r), column by column, go in a front.

    Parameters
    ----------
    child : int
    kept, kept_at : integer arrays
        Entries that the front eliminates, and their places among its three parts.
    passed : int
        From this row and column on entries are changes of later unknowns.
    passed_at : integer array
        Places of these in F22.
    """

    child: int
    kept: Array
    kept_at: Array
    passed: int
    passed_at: Array


class FrontPlan:
    """Places of everything that the factors of one pattern are made of.

    Parameters
    ----------
    indptr, indices : integer arrays
        Symmetric pattern in a fill-reducing order, compressed by columns.
    group : int
        Consecutive unknowns of a node.
    """

    def __init__(self, indptr: Array, indices: Array, group: int) -> None:
        tree = FrontTree.of(indptr, indices, group)
        self.order, self.fronts = tree.order, tree.fronts
        n = len(self.order)
        sizes = [f.count * (f.count + 2 * len(f.rows)) for f in self.fronts]
        self.starts = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
        place = np.empty(n, dtype=np.int64)
        owner = np.repeat(np.arange(len(self.fronts)), [f.count for f in self.fronts])
        place[self.order] = np.arange(n)
        column, row = place[np.repeat(np.arange(n), np.diff(indptr))], place[indices]
        of = owner[np.minimum(row, column)]
        self.at = np.empty(len(row), dtype=np.int64)
        sequence = np.argsort(of, kind="stable")
        ends = np.searchsorted(of[sequence], np.arange(len(self.fronts) + 1))
        for k, front in enumerate(self.fronts):
            mine = sequence[ends[k] : ends[k + 1]]
            i, j = front.places(row[mine]), front.places(column[mine])
            self.at[mine] = self.starts[k] + _kept(i, j, front)
        self.handings = [[self._handing(front, child) for child in front.children] for front in self.fronts]

    def _handing(self, front: Front, child: int) -> Handing:
        places = front.places(self.fronts[child].rows)
        passed, rows = int(np.searchsorted(places, front.count)), len(front.rows)
        i, j = (x.ravel(order="F") for x in np.meshgrid(places, places, indexing="ij"))
        kept = np.flatnonzero((i < front.count) | (j < front.count))
        later = places[passed:] - front.count
        passed_at = (later[:, None] * rows + later).ravel()  # column by column
        return Handing(child, kept, _kept(i[kept], j[kept], front), passed, passed_at)

    @property
    def solve_operations(self) -> float:
        """Floating-point operations of a pair of triangular solves."""
        return 2.0 * float(self.starts[-1])

    @property
    def operations(self) -> float:
        """Floating-point operations of a factorisation."""
        k, r = (np.array(x, dtype=float) for x in zip(*((f.count, len(f.rows)) for f in self.fronts), strict=True))
        return float((2.0 / 3.0 * k**3 + 2.0 * k**2 * r + 2.0 * k * r**2).sum())


def _kept(i: Array, j: Array, front: Front) -> Array:
    """Return the places of entries among F11, F21 and F12, each column by column, one after the other."""
    k, r = front.count, len(front.rows)
    upper = k * k + k * r + i + (j - k) * k
    return np.asarray(np.where(j < k, np.where(i < k, i + j * k, k * k + (i - k) + j * r), upper))


class FrontFactor:
    """Factors of one matrix after another.

    Parameters
    ----------
    plan : FrontPlan
    """

    def __init__(self, plan: FrontPlan) -> None:
        self.plan = plan
        self.parts: list[tuple[Array, Array, Array | None, Array, Array]] = []

    def factorise(self, data: Array) -> None:
        """Factorise the matrix whose entries are ``data`` (nnz,), in the order of the pattern.

        Raises
        ------
        ZeroDivisionError
            A pivot is zero.
        """
        plan = self.plan
        kept = np.zeros(plan.starts[-1])
        kept[plan.at] = data
        self.parts, changes = [], dict[int, Array]()
        for number, (front, handings) in enumerate(zip(plan.fronts, plan.handings, strict=True)):
            k, r = front.count, len(front.rows)
            own = kept[plan.starts[number] : plan.starts[number + 1]]
            later = np.zeros(r * r) if handings else None
            for handing in handings:
                change = changes.pop(handing.child)
                own[handing.kept_at] += change.ravel(order="F")[handing.kept]
                if later is not None and handing.passed < len(change):
                    later[handing.passed_at] += change[handing.passed :, handing.passed :].ravel(order="F")
            pivots = _matrix(own[: k * k], k, k)
            unit = _unit(pivots)
            pivots *= unit[:, None]
            pivots *= unit
            lu, rows, zero = lapack.dgetrf(pivots, overwrite_a=True)
            if zero:
                raise ZeroDivisionError
            lower, upper = _matrix(own[k * k : k * (k + r)], r, k), _matrix(own[k * (k + r) :], k, r)
            if r:
                lower *= unit
                upper *= unit[:, None]
                lower = blas.dtrsm(1.0, lu, lower, side=1, overwrite_b=True)
                upper = lapack.dlaswp(upper, rows, overwrite_a=True)
                upper = blas.dtrsm(1.0, lu, upper, lower=1, diag=1, overwrite_b=True)
                if later is None:
                    changes[number] = blas.dgemm(-1.0, lower, upper)
                else:
                    before = _matrix(later, r, r)
                    changes[number] = blas.dgemm(-1.0, lower, upper, beta=1.0, c=before, overwrite_c=True)
            self.parts.append((unit, lu, _exchanged(rows), lower, upper))

    def solve(self, b: Array) -> Array:
        """Return the solution for the last matrix factorised; ``b`` is (N,) or (N, k)."""
        order = self.plan.order
        x, solve = b[order], _one if b.ndim == 1 else _many
        steps = list(zip(self.plan.fronts, self.parts, strict=True))
        for front, (unit, lu, exchanged, lower, _) in steps:
            own = slice(front.first, front.first + front.count)
            y = (unit * x[own].T).T
            y = solve(lu, y if exchanged is None else y[exchanged], 1)
            x[own] = y
            if len(front.rows):
                x[front.rows] -= lower @ y
        for front, (unit, lu, _, _, upper) in reversed(steps):
            own = slice(front.first, front.first + front.count)
            y = solve(lu, x[own] - upper @ x[front.rows] if len(front.rows) else x[own], 0)
            x[own] = (unit * y.T).T
        result: Array = np.empty_like(x)
        result[order] = x
        return result


def _one(lu: Array, b: Array, lower: int) -> Array:
    """Solve for one vector with the lower factor, whose diagonal is one, or with the upper one."""
    x: Array = blas.dtrsv(lu, b, lower=lower, diag=lower)
    return x


def _many(lu: Array, b: Array, lower: int) -> Array:
    """Solve for several columns."""
    x: Array = blas.dtrsm(1.0, lu, b, lower=lower, diag=lower)
    return x


def _unit(pivots: Array) -> Array:
    """Return the factors of rows and columns that bring the diagonal to one: stiffnesses span many powers of ten."""
    diagonal = np.abs(pivots.diagonal())
    return np.asarray(1.0 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0)))


def _exchanged(rows: Array) -> Array | None:
    """Return the order of rows after the exchanges of LAPACK, one after the other; None where there are none."""
    size = len(rows)
    if (rows == np.arange(size)).all():
        return None
    order: Array = lapack.dlaswp(np.arange(size, dtype=float)[:, None], rows)[:, 0].astype(np.int64)
    return order


def _matrix(values: Array, rows: int, columns: int) -> Array:
    """Return values as a matrix, column by column."""
    return values.reshape((rows, columns), order="F")
