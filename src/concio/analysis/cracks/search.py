"""Which candidates explain the measurements: every choice of a few, from the fewest on; and which measurement is odd.

A choice is a cause where its misfit is within the errors: below the quantile of chi2 with as many degrees of freedom as
there are measurements more than motions. Choices that contain a cause are not examined: they explain no more
with more. Where a measurement spoils an otherwise good choice it is named, with the mistake that would explain it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.special import gammainccinv

from concio.analysis.cracks.fit import FAR, Fit, Fitter, without_each
from concio.problem.solution import Progress, ProgressCallback

Array = np.ndarray

HOPELESS = 4.0
"""A misfit without a measurement, to first order, that is this many times the one allowed is not examined further."""
SURE = 2.0
"""Times the change of a reading in finer steps that is allowed for where a choice is turned down on coarse ones."""
CLEAR = 4.0
"""A measurement that is left out must be further than this from what the others predict, in standard deviations."""


@dataclass(frozen=True, eq=False)
class Trial:
    """A choice of candidates that was examined.

    Parameters
    ----------
    chosen : tuple of int
    fit : Fit or None
        None where no motion of them was reached.
    coarse : bool
        Whether it was turned down on paths of coarser steps than the others, from which it was too far off.
    """

    chosen: tuple[int, ...]
    fit: Fit | None
    coarse: bool = False


@dataclass(frozen=True, eq=False)
class Found:
    """What a search found.

    Parameters
    ----------
    accepted : tuple of Fit
        Causes within the errors, all measurements counted.
    spoiled : tuple of Fit
        Causes within the errors where a measurement is left out.
    trials : tuple of Trial
        Every choice that was examined.
    """

    accepted: tuple[Fit, ...]
    spoiled: tuple[Fit, ...]
    trials: tuple[Trial, ...]


def allowed(freedom: int, confidence: float) -> float:
    """Return the misfit that is within the errors with a confidence: the quantile of chi2."""
    return float(2.0 * gammainccinv(freedom / 2.0, 1.0 - confidence)) if freedom > 0 else 0.0


def search(
    fitter: Fitter, movers: Sequence[str], *, most: int, beyond: int, confidence: float,
    coarse: Sequence[Trial] = (), change: float = 0.0,
    progress: ProgressCallback | None = None,
) -> Found:  # fmt: skip
    """Return the causes of up to ``most`` motions, ``beyond`` more than the simplest needs at most.

    Parameters
    ----------
    fitter : Fitter
    movers : sequence of str
        What each candidate moves; the causes are ranked by how many of these move, then by motions, then by misfit.
    most, beyond : int
    confidence : float
    coarse : sequence of Trial
        What a search with coarser paths examined: its fits are begun with, and those far off are taken as they are.
    change : float
        How much finer steps changed the readings of the best of these, root of the sum of squares in errors: by so
        much the root of its misfit changes at most. Twice as much is allowed for the others.
    progress : callable, optional
    """
    before = {t.chosen: t for t in coarse}
    candidates = range(len(movers))
    n = len(fitter.value)
    accepted: list[Fit] = []
    turned_down: list[Fit] = []
    trials: list[Trial] = []
    last = most
    for size in range(min(most, n - 1) + 1):
        if size > last:
            break
        choices = [c for c in combinations(candidates, size) if not any(set(a.chosen) <= set(c) for a in accepted)]
        limit = allowed(n - size, confidence)
        for i, chosen in enumerate(choices):
            if progress is not None:
                progress(Progress("diagnose", len(trials), 1.0 - i / len(choices), f"{size} motions"))
            known = before.get(chosen)
            begin = None if known is None else known.fit
            if begin is not None and size and begin.misfit > limit:
                least = float(np.sqrt(without_each(begin).min()))
                if begin.left or least > min(np.sqrt(FAR * limit), np.sqrt(limit) + SURE * change):
                    trials.append(Trial(chosen, begin, coarse=True))
                    continue
            part = _part(turned_down, chosen)
            fit = fitter.fit(chosen, allowed=limit, begin=begin, part=part) if size else _rest(fitter)
            trials.append(Trial(chosen, fit))
            if fit is None or fit.left:
                continue
            if fit.misfit <= limit:
                accepted.append(fit)
            else:
                turned_down.append(fit)
        if accepted and last == most:
            last = min(most, size + beyond)
    simplest = min((len(f.chosen) for f in accepted), default=n)
    fewer = [f for f in turned_down if len(f.chosen) < simplest]  # what is no simpler than a cause casts no doubt
    spoiled = [f for fit in fewer for f in without_one(fitter, fit, confidence)]

    def rank(fit: Fit) -> tuple[int, int, float]:
        return len({movers[c] for c in fit.chosen}), len(fit.chosen), fit.misfit

    return Found(tuple(sorted(accepted, key=rank)), tuple(sorted(spoiled, key=rank)), tuple(trials))


def _part(known: Sequence[Fit], chosen: tuple[int, ...]) -> Fit | None:
    """Return the best of the fits in which some of the candidates of a choice move; None where there is none."""
    parts = [f for f in known if f.chosen and set(f.chosen) < set(chosen)]
    return min(parts, key=lambda f: f.misfit, default=None)


def without_one(fitter: Fitter, fit: Fit, confidence: float) -> list[Fit]:
    """Return the fits within the errors that leave one measurement out which all others contradict.

    Which one is chosen from the misfit without it to first order, chi2 - r^2 / (1 - h) with the leverage h of the
    measurement; the choices are then fitted again.
    """
    n, size = len(fit.residual), len(fit.chosen)
    if n - 1 - size < 2:
        return []
    limit = allowed(n - 1 - size, confidence)
    loss = without_each(fit)
    found = []
    for i in np.argsort(loss)[:2].tolist():
        if loss[i] > HOPELESS * limit:
            continue
        kept = np.ones(n, dtype=bool)
        kept[i] = False
        again = fitter.fit(fit.chosen, allowed=limit, kept=kept, starts=1) if size else _rest(fitter, kept)
        if again is not None and again.misfit <= limit and abs(float(again.residual[i])) > CLEAR:
            found.append(again)
    return found


def _rest(fitter: Fitter, kept: Array | None = None) -> Fit:
    """Return the fit in which nothing moves."""
    motions = np.zeros(len(fitter.scale))
    prediction = fitter.forward.predict(motions)
    n = len(fitter.value)
    kept = np.ones(n, dtype=bool) if kept is None else kept
    return Fit((), motions, prediction, fitter.residual(prediction), np.zeros((n, 0)), kept, fresh=True)


