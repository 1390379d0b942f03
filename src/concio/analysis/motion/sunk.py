"""What has sunk into each other in a step is moved apart: impacts are felt half a step late at most."""

from __future__ import annotations

import numpy as np

from concio.analysis.motion.joint_step import JointStep, PairData

Array = np.ndarray

SWEEPS = 3
"""Times in a step that what has sunk in is moved apart."""


def moved_apart(
    data: PairData, step: JointStep, end: Array, pressed: Array, mass: Array, body_a: Array, body_b: Array
) -> Array:
    """Return the displacement (N,) that moves apart what has sunk in, averaged over the pairs of each body.

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
    left = 0.5 * pressed[sunk]
    count = np.bincount(np.concatenate([body_a[sunk], body_b[sunk]]))
    shared = np.maximum(count[body_a[sunk]], count[body_b[sunk]])
    for _ in range(SWEEPS):
        gap = end[sunk] + (rows * moved[columns]).sum(1)
        push = np.maximum(-gap - left, 0.0) / (give * shared)
        added = np.bincount(columns.ravel(), (rows * push[:, None]).ravel(), n + 1)
        moved += inverse * added
    return moved[:n]
