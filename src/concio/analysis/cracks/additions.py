"""Motions beside a cause that would fit clearly better, though the cause alone is within the errors.

The simplest causes are sought, and what contains one is not tried. A small motion beside a large one is then passed
over where the errors of all measurements together leave room for it. So each further candidate is tested by itself: of
a linear model the misfit falls by chi2 with one degree of freedom where the motion is not there. The chance of naming
any that is not there is that of the confidence, shared among the candidates (Bonferroni). So nothing is named where
there is one measurement more than motions: the misfit of the cause itself is below that quantile. The best is a cause
like any other, with intervals of its motions and what it predicts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from concio.analysis.cracks.cause import Cause, cause_of
from concio.analysis.cracks.fit import Fit, Fitter
from concio.analysis.cracks.search import allowed

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Addition:
    """A further motion with which the simplest cause fits clearly better.

    Parameters
    ----------
    name : str
        Candidate that moves besides.
    motion : float
        How far [m, rad, or change of a load factor].
    misfit : float
        That is left with it.
    names : tuple of str
        Candidates that move in all.
    motions : (c,) array
        How far each of them then moves.
    cause : Cause or None
        All of it with intervals, of the best.
    """

    name: str
    motion: float
    misfit: float
    names: tuple[str, ...]
    motions: Array
    cause: Cause | None = None


def additions_of(fitter: Fitter, cause: Cause, names: Sequence[str], confidence: float) -> tuple[Addition, ...]:
    """Return the motions that would improve a cause by more than errors explain, the best first.

    Parameters
    ----------
    fitter : Fitter
    cause : Cause
    names : sequence of str
        Of all candidates.
    confidence : float
    """
    others = [c for c in range(len(names)) if c not in cause.chosen]
    kept = np.ones(len(cause.residual), dtype=bool)
    kept[list(cause.left_out)] = False
    if not others or not cause.chosen:
        return ()
    clear = allowed(1, 1.0 - (1.0 - confidence) / len(others))
    here = Fit(cause.chosen, cause.motions, cause.prediction, cause.residual, cause.slope, kept)
    slopes, _ = fitter.derivatives(here, others, central=False)
    found: list[tuple[Addition, Fit]] = []
    for c, slope in zip(others, slopes.T, strict=True):
        both = [*cause.chosen, c]
        order = np.argsort(both)
        J = np.column_stack([cause.slope, slope])[:, order]
        chosen = tuple(int(both[k]) for k in order)
        if cause.misfit - _least(J[kept] * fitter.scale[list(chosen)], cause.residual[kept]) <= clear:
            continue
        begin = Fit(chosen, cause.motions, cause.prediction, cause.residual, J, kept)
        fit = fitter.fit(chosen, allowed=max(cause.misfit - clear, 1e-9), kept=kept, begin=begin)
        if fit is not None and cause.misfit - fit.misfit > clear:
            moved = fit.motions[list(chosen)]
            own = tuple(names[i] for i in chosen)
            found.append((Addition(names[c], float(fit.motions[c]), fit.misfit, own, moved), fit))
    found.sort(key=lambda pair: pair[1].misfit)
    told = [addition for addition, _ in found]
    if found:
        told[0] = replace(told[0], cause=cause_of(fitter, found[0][1], tuple(names), confidence))
    return tuple(told)


def _least(J: Array, residual: Array) -> float:
    """Return the misfit of the linear model at its best."""
    left = residual + J @ np.linalg.lstsq(J, -residual, rcond=1e-9)[0]
    return float(left @ left)
