r"""Sparse factorisation of matrices of one pattern, :math:`K + C^T D C + \rho I`, ordered once.

All the engine's time goes into these factorisations. The pattern is the graph of the structure, so the fill-reducing
ordering is computed once, on the graph of the nodes, and every later matrix is handed over already permuted. Measured
on running-bond walls (``benchmarks/orderings.py``), nested dissection costs a quarter of the minimum-degree ordering.
Where the structure is small or slender its matrix is a narrow band, which LAPACK factorises in a seventh to three
quarters of the time: panels of some thirty elastic or four hundred rigid blocks, columns and arches of any length.
Large structures of rigid blocks in space are factorised as dense fronts by LAPACK, in half the time of SuperLU
(:mod:`concio.solvers.algebra.front_factor`).

Engines, chosen by name and never by what happens to be installed: ``superlu`` (what comes with SciPy: SuperLU, and
LAPACK for narrow bands) and ``pardiso`` (extra ``fast``). A contact problem says which (``ContactProblem.engine``).
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg as sl
import scipy.sparse as sp
import scipy.sparse.linalg as sla
from scipy.sparse import csgraph

from concio.errors import ConcioError, InputError
from concio.problem.contact_problem import Array, Engine
from concio.solvers.algebra.front_factor import FrontFactor, FrontPlan

PIVOT = 0.01
"""Share of the largest entry of its column down to which a diagonal entry is the pivot, unless stated otherwise."""

PANEL = 8
"""Columns that SuperLU works on together; its own default of 20 is a tenth slower on walls of every size."""

NARROW = 1.1e7
"""Unknowns times the square of half the band up to which LAPACK factorises the band."""


BODY, FRONTS = 6, 3000
"""Least unknowns of a node and of a matrix that LAPACK factorises as dense fronts: rigid blocks in space."""


class SingularMatrixError(ConcioError):
    """A factorisation met a zero or a non-finite pivot."""


def nested_dissection(pattern: sp.csr_array, group: int = 2) -> tuple[Array, str]:
    """Return a fill-reducing permutation of a symmetric pattern and the name of the method.

    Parameters
    ----------
    pattern : (N, N) CSR array
        Symmetric pattern; values do not matter.
    group : int
        Consecutive unknowns that belong together (2 for the two displacements of a node) where N is a multiple. Nodes
        of three displacements ordered in twos cost a third more time than in threes.
    """
    n = pattern.shape[0]
    if n % group:
        group = 1
    rows = np.repeat(np.arange(n), np.diff(pattern.indptr)) // group
    graph = sp.csr_array(
        (np.ones(pattern.nnz, dtype=np.int8), (rows, pattern.indices // group)), shape=(n // group,) * 2
    )
    graph.sum_duplicates()
    graph.setdiag(0)
    graph.eliminate_zeros()
    try:
        import pymetis
    except ImportError:
        return np.arange(n), "minimum degree"
    if graph.nnz == 0:
        return np.arange(n), "natural"
    adjacency = pymetis.CSRAdjacency(adj_starts=graph.indptr.tolist(), adjacent=graph.indices.tolist())
    order, _ = pymetis.nested_dissection(adjacency=adjacency)
    return (group * np.asarray(order)[:, None] + np.arange(group)).ravel(), "nested dissection"


def narrow_band(pattern: sp.csr_array) -> tuple[Array, int | None]:
    """Return the order that gathers a symmetric pattern about its diagonal, and half the width of the band.

    The width is None where the band is so wide that its factorisation would cost more than a sparse one.
    """
    n = pattern.shape[0]
    if not n:
        return np.zeros(0, dtype=np.int32), None
    order = np.asarray(csgraph.reverse_cuthill_mckee(sp.csr_matrix(pattern), symmetric_mode=True))
    place = np.empty(n, dtype=np.int64)
    place[order] = np.arange(n)
    row = np.repeat(place, np.diff(pattern.indptr))
    width = int(np.abs(row - place[pattern.indices]).max(initial=0))
    return order, width if n * width**2 <= NARROW else None


@dataclass(frozen=True, eq=False)
class Pattern:
    """A symmetric pattern in its fill-reducing order, compressed as an engine needs it.

    Parameters
    ----------
    engine : {"superlu", "pardiso"}
    order : (N,) integer array
        Unknowns in the order of elimination.
    ordering : str
        Name of the method.
    minor, indptr : integer arrays
        Compressed by columns (superlu) or rows (pardiso), permuted.
    slot : (k,) integer array
        Place among the values of each entry the pattern was made of.
    width : int or None
        Farthest entry from the diagonal where LAPACK is to factorise the band; else None.
    fronts : FrontPlan or None
        Dense fronts where LAPACK is to factorise these; else None.
    """

    engine: Engine
    order: Array
    ordering: str
    minor: Array
    indptr: Array
    slot: Array
    width: int | None = None
    fronts: FrontPlan | None = None

    @classmethod
    def of(cls, row: Array, column: Array, size: int, engine: Engine = "superlu", group: int = 2) -> Pattern:
        """Return the pattern of entries (k,), repeated ones among them, of a matrix of ``size`` unknowns.

        ``group`` consecutive unknowns each belong to one node, or to one rigid body, as in :func:`nested_dissection`.
        """
        if engine not in ("superlu", "pardiso"):
            msg = f"unknown factorisation engine '{engine}'"
            raise InputError(msg, hint="superlu or pardiso")
        pattern = sp.csr_array((np.ones(len(row), dtype=np.int8), (row, column)), shape=(size, size))
        pattern.sum_duplicates()
        width = None
        if engine == "superlu":
            order, width = narrow_band(pattern)
        if width is None:
            order, ordering = nested_dissection(pattern, group)
        else:
            ordering = "reverse Cuthill-McKee, a band"
        place = np.empty(size, dtype=np.int64)
        place[order] = np.arange(size)
        major, minor = (place[column], place[row]) if engine == "superlu" else (place[row], place[column])
        keys, slot = np.unique(major * size + minor, return_inverse=True)
        indptr = np.searchsorted(keys, np.arange(size + 1, dtype=np.int64) * size).astype(np.int32)
        minor = (keys % size).astype(np.int32)
        dense = ordering == "nested dissection" and engine == "superlu" and group >= BODY and size >= FRONTS
        fronts = FrontPlan(indptr, minor, group) if dense and not size % group else None
        return cls(engine, order, ordering, minor, indptr, slot, width, fronts)

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return len(self.order)

    @property
    def nnz(self) -> int:
        """Number of entries."""
        return len(self.minor)


class OrderedFactor:
    """Factors of matrices of one pattern, ordered once.

    Parameters
    ----------
    pattern : Pattern
    pivot : float
        Diagonal entries are pivots down to this share of the largest entry of their column (SuperLU).
    """

    def __init__(self, pattern: Pattern, pivot: float = PIVOT) -> None:
        self.pattern, self.pivot = pattern, pivot
        self.count = 0
        self._lu: Any = None
        self._pardiso: Any = None
        self._fronts = None if pattern.fronts is None else FrontFactor(pattern.fronts)
        if self._fronts is not None:
            return
        if pattern.width is not None:
            column = np.repeat(np.arange(pattern.size), np.diff(pattern.indptr))
            self._in_band = column * (3 * pattern.width + 1) + 2 * pattern.width + pattern.minor - column
            return
        kind = sp.csr_matrix if pattern.engine == "pardiso" else sp.csc_matrix
        self._matrix: Any = kind((np.zeros(pattern.nnz), pattern.minor, pattern.indptr), shape=(pattern.size,) * 2)
        self._matrix.has_canonical_format = True

    def factorise(self, data: Array) -> None:
        """Factorise the matrix whose entries are ``data`` (nnz,), as :attr:`Pattern.slot` places them.

        Raises
        ------
        SingularMatrixError
            A pivot is zero or not finite.
        """
        if not np.isfinite(data).all():
            msg = "the matrix holds a value that is not finite"
            raise SingularMatrixError(msg)
        self.count += 1
        p = self.pattern
        if self._fronts is not None:
            self._factorise_fronts(self._fronts, data)
            return
        if p.width is not None:
            self._factorise_band(data, p.width)
            return
        self._matrix.data = data
        if p.engine == "pardiso":
            self._factorise_pardiso(self._matrix)
            return
        self._lu = None  # its memory is needed
        spec = "MMD_AT_PLUS_A" if p.ordering == "minimum degree" else "NATURAL"
        try:
            splu: Any = sla.splu
            self._lu = splu(
                self._matrix,
                permc_spec=spec,
                diag_pivot_thresh=self.pivot,
                panel_size=PANEL,
                options={"SymmetricMode": True},
            )
        except RuntimeError as error:
            raise SingularMatrixError(str(error)) from None
        except MemoryError:
            msg = f"not enough memory to factorise {p.size:,} unknowns"
            raise ConcioError(msg, hint="use larger elements or rigid blocks") from None

    def _factorise_fronts(self, fronts: FrontFactor, data: Array) -> None:
        try:
            fronts.factorise(data)
        except ZeroDivisionError:
            msg = "the matrix is singular"
            raise SingularMatrixError(msg) from None
        except MemoryError:
            msg = f"not enough memory to factorise {self.pattern.size:,} unknowns"
            raise ConcioError(msg, hint="use larger elements or rigid blocks") from None

    def _factorise_band(self, data: Array, width: int) -> None:
        band = np.zeros(self.pattern.size * (3 * width + 1))
        band[self._in_band] = data
        lu, pivots, zero = sl.lapack.dgbtrf(band.reshape(self.pattern.size, -1).T, width, width, overwrite_ab=True)
        if zero:
            msg = "the matrix is singular"
            raise SingularMatrixError(msg)
        self._lu = lu, pivots

    def _factorise_pardiso(self, matrix: Any) -> None:
        try:
            import pypardiso
        except ImportError:
            msg = "the engine 'pardiso' is not installed"
            raise InputError(msg, hint="install it with: pip install 'concio[fast]'") from None
        first = self._pardiso is None
        if first:
            self._pardiso = pypardiso.PyPardisoSolver(mtype=1)  # structurally symmetric
            # the library it searched the disk for, so that the next solver of this process need not
            os.environ.setdefault("PYPARDISO_MKL_RT", self._pardiso.libmkl._name)
            for position, value in ((1, 1), (2, 2), (8, 0), (10, 13), (11, 0), (13, 0), (24, 1)):
                self._pardiso.set_iparm(position, value)
        self._pardiso.set_phase(12 if first else 22)
        try:
            self._pardiso._call_pardiso(matrix, np.zeros((self.pattern.size, 1)))
        except pypardiso.PyPardisoError as error:
            raise SingularMatrixError(str(error)) from None

    def solve_share(self) -> float:
        """Return floating-point operations of a pair of triangular solves over those of a factorisation."""
        if self.pattern.engine == "pardiso":
            return float(2e-6 * self._pardiso.get_iparm(18) / max(self._pardiso.get_iparm(19), 1))  # fill, Mflop
        if self.pattern.fronts is not None:
            return self.pattern.fronts.solve_operations / self.pattern.fronts.operations
        if self.pattern.width is not None:
            return 3.0 / (2.0 * max(self.pattern.width, 2))  # 6 n w over 4 n w^2, the rows exchanged among them
        columns = np.diff(self._lu.L.indptr).astype(float)
        return float(2.0 * self._lu.nnz / max(2.0 * (columns**2).sum(), 2.0 * self._lu.nnz))

    def solve(self, b: Array) -> Array:
        """Return the solution for the last matrix factorised; ``b`` is (N,) or (N, k)."""
        order = self.pattern.order
        permuted = np.ascontiguousarray(b[order])
        if self.pattern.engine == "pardiso":
            self._pardiso.set_phase(33)
            columns = np.asfortranarray(permuted.reshape(order.size, -1))
            x = self._pardiso._call_pardiso(self._matrix, columns).reshape(b.shape)
        elif self.pattern.width is not None:
            lu, pivots = self._lu
            x, _ = sl.lapack.dgbtrs(lu, self.pattern.width, self.pattern.width, permuted, pivots)
        elif self._fronts is not None:
            x = self._fronts.solve(permuted)
        else:
            x = self._lu.solve(permuted)
        result = np.empty_like(b)
        result[order] = x
        return result
