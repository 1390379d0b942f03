"""What the measurements cannot determine: combinations of motions that change none of them by more than its error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from concio.analysis.cracks.cause import Cause
from concio.analysis.cracks.fit import Fit, Fitter
from concio.analysis.cracks.forward import Prediction

Array = np.ndarray

SEEN = 2.0
"""A combination of motions of the size expected is seen where it changes the readings by more errors than this."""
PART = 0.1
"""Motions below this share of the largest of a combination are left out of it."""


@dataclass(frozen=True, eq=False)
class Unseen:
    """A combination of motions that these measurements do not distinguish from rest.

    Parameters
    ----------
    names : tuple of str
        Candidates in it.
    motions : tuple of float
        How far each moves in it [m, rad, or change of a load factor].
    change : float
        Root of the sum of squares of what it changes the readings by, in errors.
    """

    names: tuple[str, ...]
    motions: tuple[float, ...]
    change: float


def rivals_of(
    fitter: Fitter, cause: Cause, unseen: Sequence[Unseen], names: Sequence[str], allowed: float
) -> tuple[Prediction, ...]:
    """Return the states beside a cause to which combinations that the measurements leave open lead.

    Those within the bounds of the motions are followed, forwards and backwards; states whose misfit is above what is
    allowed are left out: the measurements tell them from the cause.

    Parameters
    ----------
    fitter : Fitter
    cause : Cause
    unseen : sequence of Unseen
    names : sequence of str
        Of all candidates.
    allowed : float
        Misfit within the errors.
    """
    numbers = {name: c for c, name in enumerate(names)}
    kept = np.ones(len(cause.residual), dtype=bool)
    kept[list(cause.left_out)] = False
    found = []
    for combination in unseen:
        step = np.zeros(len(names))
        step[[numbers[name] for name in combination.names]] = combination.motions
        for sign in (1.0, -1.0):
            motions = cause.motions + sign * step
            if not ((motions >= fitter.low) & (motions <= fitter.high)).all():
                continue
            there = fitter.forward.predict(motions)
            if there.reached and float((fitter.residual(there)[kept] ** 2).sum()) <= allowed:
                found.append(there)
    return tuple(found)


def unseen_of(fitter: Fitter, cause: Cause, names: Sequence[str]) -> tuple[Unseen, ...]:
    """Return the combinations of motions that the measurements leave open beside a cause.

    Parameters
    ----------
    fitter : Fitter
    cause : Cause
    names : sequence of str
        Of all candidates.
    """
    k = len(names)
    kept = np.ones(len(cause.residual), dtype=bool)
    kept[list(cause.left_out)] = False
    here = Fit(cause.chosen, cause.motions, cause.prediction, cause.residual, cause.slope, kept)
    others = [c for c in range(k) if c not in cause.chosen]
    slope = np.zeros((len(kept), k))
    slope[:, list(cause.chosen)] = cause.slope
    if others:
        slope[:, others], _ = fitter.derivatives(here, others, central=False)
    _, size, vt = np.linalg.svd(slope[kept] * fitter.scale, full_matrices=True)
    size = np.concatenate([size, np.zeros(k - len(size))])
    found = []
    for change, row in zip(size.tolist(), vt, strict=True):
        if change > SEEN:
            continue
        parts = np.abs(row) > PART * np.abs(row).max()
        motions = (row * fitter.scale)[parts] * np.sign(row[np.argmax(np.abs(row))])
        who = tuple(names[c] for c in np.flatnonzero(parts).tolist())
        found.append(Unseen(who, tuple(motions.tolist()), change))
    return tuple(found)
