r"""Factors of :math:`K + C^T D C + \rho I` with one small dense block of D for each pair, for changing D.

The couplings of pairs that meet the same unknowns (all contact points between two rigid blocks) are summed as small
dense matrices before they are added to the pattern, which costs a fraction of adding them one by one. Pattern, ordering
and engines are those of :mod:`concio.solvers.algebra.sparse_factor`; D need not be symmetric.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from concio.problem.contact_problem import Array, Engine
from concio.solvers.algebra.factor import Springs
from concio.solvers.algebra.sparse_factor import OrderedFactor, Pattern

PIVOT = 0.0
"""Every diagonal entry is a pivot: refinement costs less than the fill that others bring late in an iteration."""

SAME = 1e-13
"""Relative difference up to which two blocks are the same."""

SMALL_BODY = 6
"""Bodies of up to this many unknowns are coupled as wholes: rigid blocks."""


def same_springs(a: Springs | None, b: Springs | None) -> bool:
    """Tell whether two are the same."""
    if isinstance(a, sp.csr_array) or isinstance(b, sp.csr_array):
        both = isinstance(a, sp.csr_array) and isinstance(b, sp.csr_array)
        return both and all(np.array_equal(getattr(a, p), getattr(b, p)) for p in ("data", "indices", "indptr"))
    return a is not None and b is not None and np.array_equal(np.asarray(a), np.asarray(b))


def times_springs(springs: Springs, v: Array) -> Array:
    """Return the forces (N,) of springs stretched by v (N,)."""
    forces: Array = springs @ v if isinstance(springs, sp.csr_array) else springs * v
    return forces


@dataclass(frozen=True, eq=False)
class Clique:
    """Pairs in groups that meet the same unknowns.

    Parameters
    ----------
    pairs : (g, p) integer array
        p pairs of each of g groups.
    L : (g, p d, w) array
        Their rows of C on the w unknowns of the group.
    slot : (g w w,) integer array
        Where the entries of L' D L go.
    """

    pairs: Array
    L: Array
    slot: Array


class BlockFactor:
    """Factorises K + C' D C + diagonal for changing block-diagonal D, without touching the pattern again.

    Parameters
    ----------
    K : (N, N) CSR array
    C : (m d, N) CSR array
        d rows for each pair, together.
    pairs : int
        m.
    bodies : (B+1,) integer array
        Unknowns of body k are ``bodies[k]:bodies[k+1]``.
    engine : {"superlu", "pardiso"}, optional
    added : (N, N) CSR array, optional
        Has the entries that may be added to K.

    Attributes
    ----------
    D : (m, d, d) array or None
        Blocks of the factors at hand; None before there are any.
    diagonal : (N,) array, float, (N, N) CSR array or None
        What was added with them.
    """

    def __init__(
        self, K: sp.csr_array, C: sp.csr_array, pairs: int, bodies: Array, engine: Engine = "superlu",
        added: sp.csr_array | None = None,
    ) -> None:  # fmt: skip
        n = K.shape[0]
        groups = _groups(C, pairs, bodies)
        rows = [np.repeat(u, u.shape[1], axis=1).ravel() for _, _, u in groups]
        columns = [np.tile(u, (1, u.shape[1])).ravel() for _, _, u in groups]
        coo, more = K.tocoo(), sp.coo_array((n, n)) if added is None else added.tocoo()
        identity = np.arange(n)
        row = np.concatenate([coo.row, identity, more.row, *rows])
        column = np.concatenate([coo.col, identity, more.col, *columns])
        pattern = Pattern.of(row, column, n, engine, _together(C.shape[0] // max(pairs, 1), bodies))
        slots = np.split(pattern.slot, np.cumsum([coo.nnz, n, more.nnz, *(r.size for r in rows)]))
        self._base = np.bincount(slots[0], weights=coo.data, minlength=pattern.nnz).astype(float)
        self._diagonal, self._added, self._places = *slots[1:3], (more.row, more.col)
        self.cliques = [
            Clique(pair, L, slot.astype(np.int32)) for (pair, L, _), slot in zip(groups, slots[3:-1], strict=True)
        ]
        self.pattern = pattern
        self.numeric = OrderedFactor(pattern, PIVOT)
        self._made = [0]  # shared with all that share the pattern
        self.D: Array | None = None
        self.diagonal: Springs | None = None

    @property
    def engine(self) -> Engine:
        """Name of the factorisation."""
        return self.pattern.engine

    @property
    def ordering(self) -> str:
        """Name of the fill-reducing ordering."""
        return self.pattern.ordering

    @property
    def count(self) -> int:
        """Number of factorisations made."""
        return self.numeric.count

    @property
    def made(self) -> int:
        """Number of factorisations made by this and by all that share its pattern."""
        return self._made[0]

    def has(self, D: Array, diagonal: float) -> bool:
        """Tell whether the factors at hand are those of D (m, d, d) and this diagonal, but for rounding."""
        if self.D is None or not same_springs(self.diagonal, diagonal):
            return False
        return bool((np.abs(D - self.D) <= SAME * np.abs(self.D)).all())

    def with_added(self, matrix: sp.csr_array) -> BlockFactor:
        """Return a factor of K + matrix, which has the entries of ``added``; ordering and pattern are shared."""
        other = self.afresh()
        other._made = self._made
        other._base = self._base.copy()
        other._add(other._base, matrix)
        return other

    def may_add(self, matrix: sp.csr_array) -> bool:
        """Tell whether a matrix has the entries of ``added``, in their order."""
        coo = matrix.tocoo()
        return np.array_equal(coo.row, self._places[0]) and np.array_equal(coo.col, self._places[1])

    def _add(self, data: Array, springs: Springs) -> None:
        """Add a diagonal, or a matrix with the entries of ``added``, to the values of the pattern."""
        if not isinstance(springs, sp.csr_array):
            data[self._diagonal] += springs
            return
        assert springs.nnz == self._added.size, "the entries that may be added"
        data[self._added] += springs.data

    def afresh(self) -> BlockFactor:
        """Return a factor of the same matrices that has made nothing yet; pattern and ordering are shared."""
        other = copy(self)
        other.numeric = OrderedFactor(self.pattern, PIVOT)
        other._made = [0]
        other.D = other.diagonal = None
        return other

    def factorise(self, D: Array, diagonal: Springs = 0.0) -> None:
        """Factorise K + C' D C + diag(diagonal), D of shape (m, d, d); or a matrix with the entries of ``added``.

        Raises
        ------
        SingularMatrixError
            A pivot is zero or not finite.
        """
        data = self._base.copy()
        d = D.shape[1]
        for clique in self.cliques:
            g, rows, w = clique.L.shape
            scaled = np.matmul(D[clique.pairs.ravel()], clique.L.reshape(-1, d, w)).reshape(g, rows, w)
            block = np.matmul(clique.L.transpose(0, 2, 1), scaled)
            data += np.bincount(clique.slot, weights=block.ravel(), minlength=data.size)
        self._add(data, diagonal)
        self.D = self.diagonal = None
        self._made[0] += 1
        self.numeric.factorise(data)
        self.D, self.diagonal = D, diagonal

    def solve(self, b: Array) -> Array:
        """Return the solution for the last matrix factorised; ``b`` is (N,) or (N, k)."""
        return self.numeric.solve(b)


def _together(d: int, bodies: Array) -> int:
    """Return how many consecutive unknowns belong to one node, or body where all that move are rigid ones in space.

    Without pairs, which say what the dimension is (d = 0), none do.
    """
    sizes = np.diff(bodies)
    return SMALL_BODY if d == 3 and bool((sizes[sizes > 0] == SMALL_BODY).all()) else max(d, 1)


def _groups(C: sp.csr_array, pairs: int, bodies: Array) -> list[tuple[Array, Array, Array]]:
    """Return pairs (g, p), rows of C (g, p d, w) and unknowns (g, w) of groups that meet the same unknowns."""
    if not pairs:
        return []
    d = C.shape[0] // pairs
    n = C.shape[1]
    C = sp.csr_array(C)
    C.sum_duplicates()
    row = np.repeat(np.arange(C.shape[0]), np.diff(C.indptr))
    pair, column = row // d, C.indices.astype(np.int64)
    size = np.diff(bodies)
    body = np.repeat(np.arange(size.size), size)[column]
    whole = size[body] <= SMALL_BODY
    keys = [pair[~whole] * n + column[~whole]]
    touched = np.unique(pair[whole] * size.size + body[whole])
    of, at = touched // size.size, touched % size.size
    for k in range(SMALL_BODY):
        here = size[at] > k
        keys.append(of[here] * n + bodies[at[here]] + k)
    key = np.unique(np.concatenate(keys))  # the unknowns of each pair, in order
    who, unknown = key // n, key % n
    count = np.bincount(who, minlength=pairs)
    first = np.concatenate([[0], np.cumsum(count)])
    place = np.arange(key.size) - first[who]
    found = []
    for w in np.unique(count[count > 0]):
        members = np.flatnonzero(count == w)
        number = np.full(pairs, -1)
        number[members] = np.arange(members.size)
        mine = number[who] >= 0
        unknowns = np.empty((members.size, w), dtype=np.int64)
        unknowns[number[who[mine]], place[mine]] = unknown[mine]
        L = np.zeros((members.size, d, w))
        mine = number[pair] >= 0
        at_key = np.searchsorted(key, pair[mine] * n + column[mine])
        L[number[pair[mine]], row[mine] % d, place[at_key]] = C.data[mine]
        _, group = np.unique(unknowns, axis=0, return_inverse=True)
        group = group.ravel()
        order = np.argsort(group, kind="stable")
        ends = np.concatenate([[0], np.cumsum(np.bincount(group))])
        for p in np.unique(np.diff(ends)):
            chosen = np.flatnonzero(np.diff(ends) == p)
            inside = order[ends[chosen][:, None] + np.arange(p)]
            found.append((members[inside], L[inside].reshape(chosen.size, p * d, w), unknowns[inside[:, 0]]))
    return found
