"""What has sunk into each other in a step is moved apart: impacts are felt half a step late at most."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from scipy.optimize import nnls
from scipy.sparse.csgraph import connected_components

from concio.analysis.motion.joint_step import JointStep, PairData

Array = np.ndarray

SWEEPS = 3
"""Times in a step that what has sunk in is moved apart, of pairs that are too many to be solved."""

FEW = 60
"""Pairs of one connected part up to which the least displacement is found."""


def moved_apart(
    data: PairData, step: JointStep, end: Array, pressed: Array, mass: Array, body_a: Array, body_b: Array
) -> Array:
    """Return the displacement (N,) that moves apart what has sunk in: the least one, weighted by the masses.

    It is unique, also where several points stand for one contact: those at both ends of an edge in space move a block
    as one corner does in the plane. Of more than :data:`FEW` pairs in one connected part it is only approached.

    Parameters
    ----------
    data : PairData
    step : JointStep
    end : (m,) array
        Gaps at the end of the step [m].
    pressed : (m,) array
        Depths to which hard joints may be sunk in by force [m].
    mass : (N,) array
        Mass of each unknown that may be moved; infinite where it may not.
    body_a, body_b : (m,) integer arrays
    """
    n = len(mass)
    moved = np.zeros(n + 1)
    sunk = np.flatnonzero(data.active & ~step.springy & (end < -pressed))
    if not len(sunk):
        return moved[:n]
    columns, rows = data.columns[sunk], data.values[sunk, 0]
    inverse = np.append(1.0 / mass, 0.0)
    give = (rows**2 * inverse[columns]).sum(1)
    sunk, columns, rows, give = (v[give > 0] for v in (sunk, columns, rows, give))
    if not len(sunk):
        return moved[:n]
    wanted = -end[sunk] - 0.5 * pressed[sunk]
    for own in _parts(columns, inverse):
        if len(own) <= FEW:
            moved += _least(columns[own], rows[own], wanted[own], inverse)
        else:
            shares = body_a[sunk[own]], body_b[sunk[own]]
            moved += _swept(columns[own], rows[own], wanted[own], give[own], inverse, *shares)
    return moved[:n]


def _parts(columns: Array, inverse: Array) -> list[Array]:
    """Return the pairs of each connected part: those that move the same unknowns."""
    m, w = columns.shape
    moves = (inverse[columns] > 0).ravel()
    pair, unknown = np.repeat(np.arange(m), w)[moves], columns.ravel()[moves]
    link = sp.coo_array((np.ones(len(pair)), (pair, m + unknown)), shape=(m + len(inverse),) * 2)
    _, label = connected_components(link, directed=False)
    order = np.argsort(label[:m], kind="stable")
    return np.split(order, np.flatnonzero(np.diff(label[:m][order])) + 1)


def _least(columns: Array, rows: Array, wanted: Array, inverse: Array) -> Array:
    """Return the least displacement (N + 1,), weighted by masses, that opens pairs by at least ``wanted`` (k,) [m].

    As a least-distance problem, by least squares with multipliers that are not negative; Lawson and Hanson, Solving
    Least Squares Problems, chapter 23.
    """
    used, place = np.unique(columns, return_inverse=True)
    root, scale = np.sqrt(inverse[used]), float(wanted.max())
    G = np.zeros((len(rows), len(used)))
    np.add.at(G, (np.arange(len(rows))[:, None], place.reshape(columns.shape)), rows)
    G *= root
    size = float(np.linalg.norm(G, axis=1).max())
    E = np.vstack([G.T / size, wanted / scale])
    multiplier, _ = nnls(E, np.append(np.zeros(len(used)), 1.0), maxiter=30 * len(rows) + 30)
    left = E @ multiplier
    found = np.zeros(len(inverse))
    found[used] = root * left[:-1] / (1.0 - left[-1]) * scale / size
    return found


def _swept(
    columns: Array, rows: Array, wanted: Array, give: Array, inverse: Array, body_a: Array, body_b: Array
) -> Array:
    """Return a displacement (N + 1,) that opens pairs by about ``wanted`` (k,), the mean over the pairs of a body."""
    moved = np.zeros(len(inverse))
    count = np.bincount(np.concatenate([body_a, body_b]))
    shared = np.maximum(count[body_a], count[body_b])
    for _ in range(SWEEPS):
        push = np.maximum(wanted - (rows * moved[columns]).sum(1), 0.0) / (give * shared)
        moved += inverse * np.bincount(columns.ravel(), (rows * push[:, None]).ravel(), len(moved))
    return moved
