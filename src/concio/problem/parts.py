r"""Connected parts: bodies that touch each other, directly or through others, each part a problem of its own.

Bodies that touch only through what is fixed are independent of each other: no entry of K and no row of C holds unknowns
of both, so that the equations fall apart. Each part has its own loads, its own displacements and its own answer, and
the units in which errors are measured are those of the part (:mod:`concio.problem.error_units`). A tie connects its
bodies, and so does an unknown that several bodies share.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.once import once
from concio.representation import short_repr


@short_repr
@dataclass(frozen=True, eq=False)
class Parts:
    """Which part each unknown and each pair belongs to.

    Parameters
    ----------
    count : int
        Number P of parts.
    of_unknown : (N,) integer array
        0 ... P - 1, in the order of the first unknown of each part.
    of_pair : (m,) integer array
        A pair between bodies without unknowns is a part of its own, numbered behind the others.
    """

    count: int
    of_unknown: Array
    of_pair: Array

    def largest(self, of: Array, values: Array) -> Array:
        """Return the largest entry of each part (P,), 0 where it has none; ``values`` >= 0, their parts in ``of``."""
        found = np.zeros(self.count)
        np.maximum.at(found, of, values)
        return found

    def total(self, of: Array, values: Array) -> Array:
        """Return the sum of the entries of each part (P,); their parts in ``of``."""
        return np.asarray(np.bincount(of, weights=values, minlength=self.count))


def connected_parts(problem: ContactProblem) -> Parts:
    """Return the connected parts of a problem, read off the patterns of K, C_n and C_t.

    Parameters
    ----------
    problem : ContactProblem
    """
    return _connected(problem.K, problem.C_n, problem.C_t, problem.bodies)


@once
def _connected(K: sp.csr_array, C_n: sp.csr_array, C_t: sp.csr_array, bodies: Array) -> Parts:
    """Return the connected parts of matrices."""
    m, n = C_n.shape
    sizes = np.diff(bodies)
    body = np.repeat(np.arange(sizes.size), sizes)  # of each unknown
    links = [_links(K, body, body)]
    rows = np.arange(m) + sizes.size  # every pair is a node beside the bodies
    links += [_links(C_n, rows, body), _links(C_t, np.repeat(rows, C_t.shape[0] // max(m, 1)), body)]
    start, end = np.concatenate(links, axis=1)
    nodes = sizes.size + m
    graph = sp.csr_array((np.ones(start.size, dtype=np.int8), (start, end)), shape=(nodes, nodes))
    _, label = connected_components(graph, directed=False)
    return _numbered(label[body] if n else np.zeros(0, dtype=int), label[sizes.size :])


def _links(matrix: sp.csr_array, of_row: Array, of_column: Array) -> Array:
    """Return the nodes (2, k) that entries of a matrix join, those that join two."""
    start = np.repeat(of_row, np.diff(matrix.indptr))
    end = of_column[matrix.indices]
    apart = start != end
    return np.array([start[apart], end[apart]])


def _numbered(of_unknown: Array, of_pair: Array) -> Parts:
    """Return parts numbered in the order of their first unknowns, behind them those that have pairs only."""
    every = np.concatenate([of_unknown, of_pair])
    _, first, inverse = np.unique(every, return_index=True, return_inverse=True)
    rank = np.empty(first.size, dtype=int)
    rank[np.argsort(first)] = np.arange(first.size)
    number = rank[inverse]
    return Parts(first.size, number[: of_unknown.size], number[of_unknown.size :])


@short_repr
@dataclass(frozen=True, eq=False)
class Part:
    """One part of a problem, and where it stands in the whole.

    Parameters
    ----------
    problem : ContactProblem
        The part alone.
    unknowns : (n,) integer array
        Its unknowns in the whole, ascending.
    pairs : (k,) integer array
        Its pairs in the whole, ascending.
    bodies : (b,) integer array
        Its bodies in the whole, those that have unknowns.
    """

    problem: ContactProblem
    unknowns: Array
    pairs: Array
    bodies: Array

    @cached_property
    def rows(self) -> Array:
        """Rows of C_t in the whole."""
        s = self.problem.dim - 1
        rows: Array = (self.pairs[:, None] * s + np.arange(s)).ravel()
        return rows


def parts_of(problem: ContactProblem) -> tuple[Part, ...]:
    """Return the parts of a problem in the order of their unknowns; the problem itself where it is one part.

    Pairs between bodies without unknowns are one part together.
    """
    parts = connected_parts(problem)
    with_unknowns = int(parts.of_unknown.max(initial=-1)) + 1
    of_pair = np.minimum(parts.of_pair, with_unknowns)
    count = with_unknowns + int(of_pair.max(initial=-1) == with_unknowns)
    if count <= 1:
        whole = np.arange(problem.unknowns), np.arange(problem.pairs), np.flatnonzero(np.diff(problem.bodies))
        return (Part(problem, *whole),)
    rigid = sp.csc_array(problem.R)
    of_motion = parts.of_unknown[rigid.indices[rigid.indptr[:-1]]]
    sizes = np.diff(problem.bodies)
    bodies = np.flatnonzero(sizes)
    of_body = parts.of_unknown[problem.bodies[bodies]]
    found = []
    for k in range(count):
        unknowns, pairs = np.flatnonzero(parts.of_unknown == k), np.flatnonzero(of_pair == k)
        own = bodies[of_body == k]
        part = _alone(problem, unknowns, pairs, sizes[own], np.flatnonzero(of_motion == k))
        found.append(Part(part, unknowns, pairs, own))
    return tuple(found)


def _alone(problem: ContactProblem, unknowns: Array, pairs: Array, sizes: Array, motions: Array) -> ContactProblem:
    """Return the problem of some unknowns, pairs and rigid motions alone."""
    s = problem.dim - 1
    rows = (pairs[:, None] * s + np.arange(s)).ravel()

    def cut(matrix: sp.csr_array, rows: Array) -> sp.csr_array:
        return sp.csr_array(sp.csr_array(matrix)[rows][:, unknowns])

    load = problem.load
    return replace(
        problem, K=cut(problem.K, unknowns), f=problem.f[unknowns], C_n=cut(problem.C_n, pairs),
        C_t=cut(problem.C_t, rows), gap=problem.gap[pairs], laws=problem.laws[pairs],
        R=sp.csc_array(sp.csc_array(problem.R)[:, motions].tocsr()[unknowns]),
        bodies=np.concatenate([[0], np.cumsum(sizes)]).astype(problem.bodies.dtype),
        slip_origin=problem.slip_origin[pairs], area=problem.area[pairs], inertia=cut(problem.inertia, unknowns),
        load=load[unknowns] if isinstance(load, np.ndarray) else load,
    )  # fmt: skip
