r"""The fronts of a symmetric pattern: which unknowns are eliminated together, and which of the others that changes.

Unknowns come in nodes (the motions of a rigid body). The structure of the factors follows from the graph of the nodes
in their order of elimination; a node and the one that it changes first are then put together wherever the arithmetic
added, at the speed of dense products, takes less time than a front of its own. So the fronts of a wall of blocks are
some fifty dense matrices of one to three hundred unknowns, in place of thousands of columns.

Reference: J. W. H. Liu, The multifrontal method for sparse matrix solution: theory and practice, SIAM Review 34 (1992)
82-109.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.problem.contact_problem import Array

CALL = 6e-5
"""Seconds that a front costs whatever its size, with some five solutions, for the choice of fronts alone."""

RATE, MOVE = 2e10, 4e-9
"""Operations of dense products in a second, and seconds that it takes to hand an entry on to the next front."""


@dataclass(frozen=True, eq=False)
class Front:
    """Unknowns that are eliminated together, in the order of the tree.

    Parameters
    ----------
    first, count : int
        The unknowns ``first`` to ``first + count - 1``.
    rows : (r,) integer array
        Later unknowns that their elimination changes, rising.
    children : tuple of int
        Fronts whose changes this one takes up first.
    """

    first: int
    count: int
    rows: Array
    children: tuple[int, ...]

    def places(self, unknowns: Array) -> Array:
        """Return the places of unknowns in the front: its own first, then those it changes."""
        inside = unknowns - self.first
        return np.where(inside < self.count, inside, self.count + np.searchsorted(self.rows, unknowns))


@dataclass(frozen=True, eq=False)
class FrontTree:
    """Fronts in the order in which they are eliminated.

    Parameters
    ----------
    order : (N,) integer array
        Unknowns in the order of the tree.
    fronts : tuple of Front
    """

    order: Array
    fronts: tuple[Front, ...]

    @classmethod
    def of(cls, indptr: Array, indices: Array, group: int) -> FrontTree:
        """Return the tree of a symmetric pattern in a fill-reducing order, of nodes of ``group`` unknowns."""
        nodes = (len(indptr) - 1) // group
        changed, parent = _structure(indptr, indices, group, nodes)
        rows = np.array([group * len(later) for later in changed])
        together, children = _together(rows, parent, group)
        roots = [node for node in range(nodes) if parent[node] < 0]
        fronts, placed, first = list[Front](), list[int](), dict[int, int]()
        place = np.empty(nodes, dtype=np.int64)
        sequence = _children_first(roots, children)
        for node in sequence:
            first[node] = len(placed)
            placed += together[node]
        place[placed] = np.arange(nodes)
        number = {node: k for k, node in enumerate(sequence)}
        for node in sequence:
            later = np.sort(place[list(changed[node])]) if changed[node] else np.zeros(0, dtype=np.int64)
            fronts.append(
                Front(
                    group * first[node],
                    group * len(together[node]),
                    _each(later, group),
                    tuple(number[child] for child in children[node]),
                )
            )
        return cls(_each(np.array(placed, dtype=np.int64), group), tuple(fronts))


def _each(nodes: Array, group: int) -> Array:
    """Return the unknowns of nodes."""
    unknowns: Array = (group * nodes[:, None] + np.arange(group)).ravel()
    return unknowns


def _structure(indptr: Array, indices: Array, group: int, nodes: int) -> tuple[list[set[int]], Array]:
    """Return for each node the later ones that its elimination changes, and the first of these (-1: none)."""
    row = np.repeat(np.arange(nodes * group), np.diff(indptr)) // group
    keys = np.unique(row.astype(np.int64) * nodes + indices // group)
    row, column = keys // nodes, keys % nodes
    later = column > row
    row, column = row[later], column[later]
    starts = np.searchsorted(row, np.arange(nodes + 1))
    changed: list[set[int]] = []
    parent, children = np.full(nodes, -1), [list[int]() for _ in range(nodes)]
    for node in range(nodes):
        met = set(column[starts[node] : starts[node + 1]].tolist())
        for child in children[node]:
            met |= changed[child]
        met.discard(node)
        changed.append(met)
        if met:
            parent[node] = min(met)
            children[parent[node]].append(node)
    return changed, parent


def _seconds(count: float, rows: float) -> float:
    """Return about how long a front takes that eliminates ``count`` unknowns and changes ``rows`` others."""
    operations = 2.0 / 3.0 * count**3 + 2.0 * count**2 * rows + 2.0 * count * rows**2
    return CALL + operations / RATE + MOVE * rows**2


def _together(rows: Array, parent: Array, group: int) -> tuple[list[list[int]], list[list[int]]]:
    """Return which nodes are eliminated with each, in order, and the children of what is left as a front."""
    nodes = len(rows)
    together, count = [[node] for node in range(nodes)], np.full(nodes, group)
    children = [list[int]() for _ in range(nodes)]
    for node in range(nodes):
        while children[node]:  # those that are known by now: children come before their parent
            alone = _seconds(count[node], rows[node])
            gains = [
                alone + _seconds(count[c], rows[c]) - _seconds(count[c] + count[node], rows[node])
                for c in children[node]
            ]
            best = int(np.argmax(gains))
            if gains[best] <= 0:
                break
            child = children[node].pop(best)
            together[node], count[node] = together[child] + together[node], count[node] + count[child]
            children[node] += children[child]
        if parent[node] >= 0:
            children[parent[node]].append(node)
    return together, children


def _children_first(roots: list[int], children: list[list[int]]) -> list[int]:
    """Return the fronts of trees, each after its children."""
    sequence, left = list[int](), [(root, False) for root in reversed(roots)]
    while left:
        node, open_ = left.pop()
        if open_:
            sequence.append(node)
        else:
            left.append((node, True))
            left += [(child, False) for child in children[node]]
    return sequence
