r"""A cause that fits the measurements: its motions with intervals, and what it predicts.

To first order the covariance of the motions is (J'J)^-1, with the slopes J of the residuals over their errors. The ends
of an interval are looked for along the line on which the other motions follow as they do to first order, where the
misfit has grown by the square of the normal quantile: exact for a linear model, and computed by the settlement path
where it bends (profile of the likelihood; D. M. Bates and D. G. Watts, "Nonlinear Regression Analysis and Its
Applications", 1988, chapter 6).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import gammaincc, ndtri

from concio.analysis.cracks.fit import Fit, Fitter
from concio.analysis.cracks.forward import Prediction
from concio.analysis.path_result import PathResult
from concio.analysis.result import Result
from concio.representation import short_repr

Array = np.ndarray

RATIO = 1e-4
"""Singular values of the slopes below this share of the largest tell nothing."""
PROFILE = 3
"""Predictions at most for each end of an interval."""
WITHIN = 0.1
"""Relative error of the distance at which an end of an interval is taken as it is."""


@short_repr
@dataclass(frozen=True, eq=False)
class Cause:
    """Motions that explain the measurements within their errors.

    Parameters
    ----------
    names : tuple of str
        Candidates that move, none where nothing needs to have moved.
    chosen : tuple of int
        Their numbers.
    motion : (c,) array
        How far they have moved [m, rad, or change of a load factor].
    low, high : (c,) arrays
        Ends of the intervals of the motions.
    covariance : (c, c) array
        Of the motions, to first order.
    misfit : float
        Sum of squares of (predicted - measured) / error of the measurements that count.
    freedom : int
        Measurements that count less motions.
    predicted : (n,) array
        What every measurement would read [m or rad].
    residual : (n,) array
        (predicted - measured) / error.
    left_out : tuple of int
        Measurements that do not count.
    prediction : Prediction
        The state with its path.
    slope : (n, c) array
        Derivatives of the residuals.
    neighbours : tuple of Prediction or None
        A state near by for each motion, from which derivatives of other places come.
    """

    names: tuple[str, ...]
    chosen: tuple[int, ...]
    motion: Array
    low: Array
    high: Array
    covariance: Array
    misfit: float
    freedom: int
    predicted: Array
    residual: Array
    left_out: tuple[int, ...]
    prediction: Prediction
    slope: Array
    neighbours: tuple[Prediction | None, ...]

    @property
    def probability(self) -> float:
        """Probability that errors alone make a misfit as large as this or larger."""
        return float(gammaincc(self.freedom / 2, self.misfit / 2)) if self.freedom > 0 else math.nan

    @property
    def motions(self) -> Array:
        """Motions (k,) of all candidates."""
        return self.prediction.motions

    @property
    def path(self) -> PathResult:
        """The settlement path from the loaded structure to the state."""
        return self.prediction.path

    @cached_property
    def result(self) -> Result:
        """The state that the cause leads to, with its joints, forces and certificate."""
        return self.path.result(-1)

    @property
    def certificate(self) -> float:
        """Worst relative violation of the equations of the model in the states of the path."""
        return self.path.certificate

    @property
    def determined(self) -> bool:
        """Whether the measurements tell every motion: no end of an interval is unknown."""
        return bool(np.isfinite(self.low).all() and np.isfinite(self.high).all())


def cause_of(fitter: Fitter, fit: Fit, names: tuple[str, ...], confidence: float) -> Cause:
    """Return a fit with derivatives from differences and intervals of its motions."""
    own = list(fit.chosen)
    kept = fit.kept
    slope, near = fitter.derivatives(fit, own) if own else (np.zeros((len(kept), 0)), [])
    scale = fitter.scale[own]
    covariance, seen = _covariance(slope[kept] * scale)
    covariance = covariance * np.outer(scale, scale)
    z = float(ndtri(0.5 + confidence / 2))
    ends = np.array([
        [_end(fitter, fit, covariance, i, sign * z) if seen[i] else sign * math.inf for sign in (-1.0, 1.0)]
        for i in range(len(own))
    ]).reshape(-1, 2)  # fmt: skip
    low, high = fitter.low[own], fitter.high[own]
    return Cause(
        tuple(names[c] for c in own), fit.chosen, fit.motions[own], np.maximum(ends[:, 0], low),
        np.minimum(ends[:, 1], high), covariance, fit.misfit, fit.freedom, fit.prediction.values, fit.residual,
        tuple(np.flatnonzero(~kept).tolist()), fit.prediction, slope, tuple(near),
    )  # fmt: skip


def _covariance(J: Array) -> tuple[Array, Array]:
    """Return (J'J)^-1 over what the slopes tell, and which of the motions they tell."""
    c = J.shape[1]
    if not c:
        return np.zeros((0, 0)), np.zeros(0, dtype=bool)
    _, size, vt = np.linalg.svd(J, full_matrices=True)
    size = np.concatenate([size, np.zeros(c - len(size))])
    clear = size > RATIO * max(float(size.max()), 1e-300)
    seen = (np.abs(vt[~clear]) < 1e-6).all(axis=0) if (~clear).any() else np.ones(c, dtype=bool)
    inverse = vt[clear].T / size[clear] ** 2 @ vt[clear]
    return inverse, seen & (size.max() > 0)


def _end(fitter: Fitter, fit: Fit, covariance: Array, i: int, z: float) -> float:
    """Return where the misfit has grown by z^2 along the line on which the other motions follow motion i."""
    own = list(fit.chosen)
    deviation = math.sqrt(covariance[i, i])
    line = covariance[:, i] / deviation
    t, best = z, z
    for _ in range(PROFILE):
        motions = fit.motions.copy()
        motions[own] += t * line
        inside = (motions[own] >= fitter.low[own]) & (motions[own] <= fitter.high[own])
        if not inside.all():
            break
        there = fitter.forward.predict(motions)
        if not there.reached:
            break
        residual = fitter.residual(there)[fit.kept]
        grown = float(residual @ residual) - fit.misfit
        if grown <= 0:
            t *= 2.0
            best = t
            continue
        best = t * abs(z) / math.sqrt(grown)
        if abs(best / t - 1) < WITHIN:
            break
        t = best
    return float(fit.motions[own[i]] + best * deviation)
