"""Which boxes meet: the broad phase of every search for contacts, in the plane and in space.

Boxes are sorted by size into levels, each with a grid whose cells are as large as its largest box. A box lies in at
most two cells along each axis in the grid of its own level and in those of larger ones; boxes that share a cell are
compared. The work grows with the number of boxes that meet, whatever their arrangement: a tree of two dimensions
compares all that stand above each other.
"""

from __future__ import annotations

import numpy as np

Array = np.ndarray

ROOM = 1.0 + 1e-9
"""A cell over the largest box of its level."""

FINEST = 1e-6
"""Smallest cell over the box around all: the numbers of cells stay below 2^63."""


def meeting_boxes(low: Array, high: Array) -> tuple[Array, Array]:
    """Return all pairs i < j of boxes that meet, sorted, from their corners (n, d); boxes that touch meet.

    Examples
    --------
    >>> import numpy as np
    >>> from concio.kinematics.boxes import meeting_boxes
    >>> low = np.array([[0.0, 0.0], [1.0, 0.0], [3.0, 0.0]])
    >>> [found.tolist() for found in meeting_boxes(low, low + 1.0)]
    [[0], [1]]
    """
    n = len(low)
    i, j = _meeting(low, high, np.zeros(n, dtype=bool), False)
    i, j = np.minimum(i, j), np.maximum(i, j)
    return _sorted(i, j, n)


def boxes_meeting(low: Array, high: Array, other_low: Array, other_high: Array) -> tuple[Array, Array]:
    """Return all pairs i, j, sorted, of boxes (n, d) of one kind and boxes (k, d) of another that meet."""
    n, k = len(low), len(other_low)
    both = np.concatenate([np.zeros(n, dtype=bool), np.ones(k, dtype=bool)])
    i, j = _meeting(np.concatenate([low, other_low]), np.concatenate([high, other_high]), both, True)
    i, j = np.where(both[i], j, i), np.where(both[i], i, j) - n
    return _sorted(i, j, k)


def _sorted(i: Array, j: Array, count: int) -> tuple[Array, Array]:
    order = np.argsort(i.astype(np.int64) * max(count, 1) + j, kind="stable")
    return i[order], j[order]


def _meeting(low: Array, high: Array, kind: Array, across: bool) -> tuple[Array, Array]:
    """Return the pairs of boxes that meet, each once; those of two kinds only where ``across``."""
    none = np.zeros(0, dtype=np.intp)
    if len(low) < 2:
        return none, none
    extent = (high - low).max(axis=1)
    least = max(float(np.median(extent)), FINEST * float((high.max(0) - low.min(0)).max()))
    if not least > 0:
        least = 1.0
    level = np.maximum(np.ceil(np.log2(np.maximum(extent, least) / least)), 0).astype(int)
    origin, found = low.min(axis=0), [(none, none)]
    for m in np.unique(level).tolist():
        size = ROOM * least * 2.0**m
        own, all_ = np.flatnonzero(level == m), np.flatnonzero(level <= m)
        begin, end = (np.floor((v[all_] - origin) / size).astype(np.int64) for v in (low, high))
        box, key = _cells(begin, end)
        order = np.argsort(key, kind="stable")
        box, key = box[order], key[order]
        mine = level[all_[box]] == m
        where = np.searchsorted(key, key[mine])
        count = np.searchsorted(key, key[mine], side="right") - where
        first = np.repeat(box[mine], count)
        second = box[np.arange(len(first)) - np.repeat(np.cumsum(count) - count - where, count)]
        shared = np.repeat(key[mine], count)
        i, j = all_[first], all_[second]
        keep = ((level[j] < m) | (i < j)) if len(own) < len(all_) else i < j
        if across:
            keep &= kind[i] != kind[j]
        i, j, first, second, shared = (v[keep] for v in (i, j, first, second, shared))
        keep = ((low[i] <= high[j]) & (low[j] <= high[i])).all(axis=1)
        i, j, first, second, shared = (v[keep] for v in (i, j, first, second, shared))
        once = _key(np.maximum(begin[first], begin[second]), end.max(axis=0)) == shared
        found.append((i[once], j[once]))
    return np.concatenate([f[0] for f in found]), np.concatenate([f[1] for f in found])


def _key(cell: Array, most: Array) -> Array:
    """Return a number (n,) for each cell (n, d)."""
    found = cell[:, 0].copy()
    for axis in range(1, cell.shape[1]):
        found = found * (int(most[axis]) + 1) + cell[:, axis]
    return np.asarray(found)


def _cells(begin: Array, end: Array) -> tuple[Array, Array]:
    """Return the boxes and the numbers of the cells in which they lie, from their first and last cells (n, d)."""
    most, d = end.max(axis=0), begin.shape[1]
    boxes, keys = [], []
    for corner in range(2**d):
        far = np.array([corner >> axis & 1 for axis in range(d)], dtype=bool)
        some = np.flatnonzero((~far | (end > begin)).all(axis=1))
        boxes.append(some)
        keys.append(_key(np.where(far, end[some], begin[some]), most))
    return np.concatenate(boxes), np.concatenate(keys)
