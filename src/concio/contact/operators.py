"""C_n and C_t of contact pairs on the unknowns of bodies, in any dimension: rigid sides and sides of nodes.

Rows are written as entries, side by side, and put together once. A side that moves rigidly has the displacement of a
point of its body; a meshed side a weighted mean of nodes. Frames hold the normal and the tangents of each pair as rows.
Rows of bodies that move are the same displacements kept dense (:mod:`concio.contact.rows`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.sparse as sp

from concio.kinematics.rigid import motions, write_rigid_rows

Array = np.ndarray
Entries = tuple[Array, Array, Array]
"""Pairs (e,), columns (e,), and values along normal and tangents (d, e)."""


def rigid_entries(pair: Array, frame: Array, arm: Array, reach: Array | float, first: Array, sign: float) -> Entries:
    """Return the entries of sides that move rigidly.

    Parameters
    ----------
    pair : (q,) integer array
    frame : (q, d, d) array
    arm : (q, d) array
        Of the points from the centroids of their bodies [m].
    reach : (q,) array or float
        Length that turns rotations into displacements [m].
    first : (q,) integer array
        First unknown of each body.
    sign : {1, -1}
        1 for side b.
    """
    d = frame.shape[-1]
    wide = motions(d)
    values = np.empty((len(pair), d, wide))
    write_rigid_rows(values, frame, arm, np.broadcast_to(np.asarray(reach, dtype=float), (len(pair),)))
    columns = first[:, None] + np.arange(wide)
    return np.repeat(pair, wide), columns.ravel(), sign * np.moveaxis(values, 1, 0).reshape(d, -1)


def nodal_entries(pair: Array, frame: Array, weight: Array, first: Array, sign: float) -> Entries:
    """Return the entries of sides that move as weighted means of nodes.

    Parameters
    ----------
    pair : (e,) integer array
    frame : (e, d, d) array
    weight : (e,) array
    first : (e,) integer array
        First unknown of each node.
    sign : {1, -1}
        1 for side b.
    """
    d = frame.shape[-1]
    columns = first[:, None] + np.arange(d)
    values = sign * frame * weight[:, None, None]
    return np.repeat(pair, d), columns.ravel(), np.moveaxis(values, 1, 0).reshape(d, -1)


def operators(entries: Sequence[Entries], pairs: int, unknowns: int, dim: int) -> tuple[sp.csr_array, sp.csr_array]:
    """Return C_n (m, N) and C_t (m (d-1), N) of entries: displacement of b less that of a."""
    none = np.zeros(0, dtype=int), np.zeros(0, dtype=int), np.zeros((dim, 0))
    row, column, value = (np.concatenate(v, axis=-1) for v in zip(none, *entries, strict=True))
    beside = np.concatenate([(dim - 1) * row + k for k in range(dim - 1)])
    C_n = sp.csr_array((value[0], (row, column)), shape=(pairs, unknowns))
    C_t = sp.csr_array((value[1:].ravel(), (beside, np.tile(column, dim - 1))), shape=((dim - 1) * pairs, unknowns))
    for matrix in (C_n, C_t):
        matrix.sum_duplicates()
        matrix.eliminate_zeros()
    return C_n, C_t
