r"""Least squares of measurements over the motions of a few candidates.

With the errors e_i the misfit is chi2(s) = sum ((g_i(s) - m_i) / e_i)^2, where g(s) is what the settlement path to the
motions s predicts. It is made smallest by Gauss-Newton steps with bounds; the derivatives begin as the responses to
each candidate alone, are corrected by what every prediction shows (Broyden's rank-one update), and are computed from
differences where that leads no further.

C. G. Broyden, "A class of methods for solving nonlinear simultaneous equations", Math. Comp. 19 (1965).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy.optimize import lsq_linear

from concio.analysis.cracks.forward import Forward, Prediction

Array = np.ndarray

MOST_STEPS = 8
"""Predictions along one descent, those for derivatives not counted..."""
LONGEST = 24
"""...and along one that has come near to what is allowed: a cause must not be turned down before its descent ends."""
FLAT = 0.02
"""Decrease of the misfit below which a descent ends."""
SLOW = 0.03
"""Relative decrease of the misfit below which a descent far from what is allowed ends."""
TRUST = 2.0
"""Longest first step over the size of a motion; it doubles where steps succeed, up to :data:`REACH` in all."""
REACH = 20.0
"""Furthest that a descent goes, over the size of a motion."""
TRIED = 3
"""Predictions after which a descent is to be better than what a part of the choice alone has reached."""
NEAR_BY = 4.0
"""Times the size of a motion within which a descent begins: the responses of rest say little of what lies further."""
DISTANT = 4.0
"""Times the misfit allowed from which on a descent is far from it."""
FAR = 20.0
"""Choices are left after one state where it and the linear model miss by this many times what is allowed."""
DIFFERENCE = 0.1
"""Step of a difference over the size of a motion."""


@dataclass(frozen=True, eq=False)
class Fit:
    """The motions of some candidates that fit the measurements best.

    Parameters
    ----------
    chosen : tuple of int
        Candidates that move.
    motions : (k,) array
        Of all candidates; zero of those that do not move.
    prediction : Prediction
    residual : (n,) array
        (predicted - measured) / error of every measurement, left out ones too.
    slope : (n, c) array
        Derivatives of the residuals with respect to the motions that move.
    kept : (n,) boolean array
        Measurements that count.
    fresh : bool
        Whether the derivatives were computed from differences at the end.
    left : bool
        Whether it is not a best fit: the first state was so far from the measurements that it was followed no further.
    """

    chosen: tuple[int, ...]
    motions: Array
    prediction: Prediction
    residual: Array
    slope: Array
    kept: Array
    fresh: bool = False
    left: bool = False

    @property
    def misfit(self) -> float:
        """Sum of squares of the residuals that count."""
        return float(self.residual[self.kept] @ self.residual[self.kept])

    @property
    def freedom(self) -> int:
        """Number of measurements that count, less the number of motions."""
        return int(self.kept.sum()) - len(self.chosen)


@dataclass(eq=False)
class Fitter:
    """Fits of one set of measurements.

    Parameters
    ----------
    forward : Forward
    value, error : (n,) arrays
    low, high : (k,) arrays
        Bounds of the motions.
    scale : (k,) array
        Motions that are large enough to be seen.
    """

    forward: Forward
    value: Array
    error: Array
    low: Array
    high: Array
    scale: Array

    def residual(self, prediction: Prediction) -> Array:
        """Return (predicted - measured) / error (n,)."""
        found: Array = (prediction.values - self.value) / self.error
        return found

    def response(self, candidate: int, sign: float) -> Array | None:
        """Return the slope of the residuals (n,) with one motion from rest to its scale; None where not reached."""
        motions = np.zeros(len(self.scale))
        bound = self.high[candidate] if sign > 0 else -self.low[candidate]
        size = min(float(self.scale[candidate]), float(bound))
        if not size > 0:
            return None
        rest = self.residual(self.forward.predict(motions))
        for _ in range(3):
            motions[candidate] = sign * size
            there = self.forward.predict(motions)
            if there.reached:
                return np.asarray((self.residual(there) - rest) / (sign * size))
            size /= 4
        return None

    def starts(self, chosen: Sequence[int], kept: Array) -> list[tuple[float, Array, Array]]:
        """Return (misfit expected, motions (c,), slopes (n, c)) of each pattern of signs, the best first.

        The misfit is that of the linear model without the one measurement that spoils it most.
        """
        rest = self.residual(self.forward.predict(np.zeros(len(self.scale))))
        found = []
        for signs in product((1.0, -1.0), repeat=len(chosen)):
            columns = [self.response(c, s) for c, s in zip(chosen, signs, strict=True)]
            if any(column is None for column in columns):
                continue
            J = np.column_stack([column for column in columns if column is not None])
            low = [0.0 if s > 0 else self.low[c] for c, s in zip(chosen, signs, strict=True)]
            high = [self.high[c] if s > 0 else 0.0 for c, s in zip(chosen, signs, strict=True)]
            step = self._step(J[kept], rest[kept], np.array(low), np.array(high), self.scale[list(chosen)])
            expected = float(_without_each((rest + J @ step)[kept], J[kept]).min())
            near = NEAR_BY * self.scale[list(chosen)]
            ends = [np.clip(np.array(end), -near, near) for end in (low, high)]
            step = self._step(J[kept], rest[kept], ends[0], ends[1], self.scale[list(chosen)])
            found.append((expected, step, J))
        return sorted(found, key=lambda item: item[0])

    def fit(
        self, chosen: Sequence[int], *, allowed: float, kept: Array | None = None, starts: int = 2,
        begin: Fit | None = None, part: Fit | None = None,
    ) -> Fit | None:  # fmt: skip
        """Return the best fit of the candidates chosen; None where no start was reached.

        Parameters
        ----------
        chosen : sequence of int
        allowed : float
            Misfit that is within the errors: what is far above it is not followed to the end.
        kept : (n,) boolean array, optional
            Measurements that count; by default all.
        starts : int
            Patterns of signs that are followed.
        begin : Fit, optional
            Begin at an earlier fit of the same candidates instead, whose paths may have been coarser.
        part : Fit, optional
            Best fit of some of the candidates, with all measurements: a descent begins there too, and others end that
            do not come below it soon.
        """
        kept = np.ones(len(self.value), dtype=bool) if kept is None else kept
        own = list(chosen)
        if begin is not None:
            here = self._first(own, begin.motions[own], begin.slope, kept)
            return None if here is None else self._descend(own, here, allowed)
        best = None if part is None else self._descend(own, self._beside(own, part), allowed)
        beaten = best
        for expected, start, J in self.starts(own, kept)[:starts]:
            if best is not None and best.misfit <= allowed:
                break
            if best is not beaten and best is not None and expected > max(DISTANT * allowed, 0.5 * best.misfit):
                break
            here = self._first(own, start, J, kept)
            if here is None:
                continue
            found = here
            if min(expected, float(without_each(here).min())) > FAR * allowed:
                found = replace(here, left=True)
            else:
                found = self._descend(own, here, allowed, beaten)
            if best is None or found.misfit < best.misfit:
                best = found
        return best

    def derivatives(
        self, at: Fit, candidates: Sequence[int], *, central: bool = True
    ) -> tuple[Array, list[Prediction | None]]:
        """Return slopes (n, c) of the residuals at a fit by differences, with a prediction each comes from.

        Differences are central where that is asked for and both sides are reached and allowed, one-sided otherwise.
        """
        columns, states = [], []
        for c in candidates:
            h = DIFFERENCE * max(abs(float(at.motions[c])), float(self.scale[c]))
            there: dict[float, Prediction] = {}
            for sign in (1.0, -1.0):
                moved = at.motions.copy()
                moved[c] += sign * h
                if there and not central:
                    break
                if self.low[c] <= moved[c] <= self.high[c]:
                    prediction = self.forward.predict(moved)
                    if prediction.reached:
                        there[sign] = prediction
            ends = [(s * h, self.residual(p)) for s, p in there.items()]
            ends += [(0.0, at.residual)] if len(ends) < 2 else []
            states.append(next(iter(there.values()), None))
            flat = len(ends) < 2
            columns.append(np.zeros(len(self.value)) if flat else (ends[0][1] - ends[1][1]) / (ends[0][0] - ends[1][0]))
        return np.column_stack(columns), states

    def _beside(self, own: list[int], part: Fit) -> Fit:
        """Return the best fit of some candidates as a fit of more, which do not move yet."""
        slope = np.zeros((len(self.value), len(own)))
        slope[:, [own.index(c) for c in part.chosen]] = part.slope
        further = [c for c in own if c not in part.chosen]
        slope[:, [own.index(c) for c in further]] = self.derivatives(part, further, central=False)[0]
        return replace(part, chosen=tuple(own), slope=slope)

    def _descend(self, own: list[int], here: Fit, allowed: float, beaten: Fit | None = None) -> Fit:
        """Return the end of a descent, which is given up where it does not come below another fit soon."""
        kept = here.kept
        radius, steps, refreshed = TRUST, 0, False
        reach = np.maximum(REACH * self.scale[own], np.abs(here.motions[own]))
        while steps < (LONGEST if here.misfit <= DISTANT * allowed else MOST_STEPS):
            if beaten is not None and steps >= TRIED and not _below(here, beaten):
                break
            s = here.motions[own]
            size = radius * self.scale[own]
            low = np.maximum(np.maximum(self.low[own], -reach) - s, -size)
            high = np.minimum(np.minimum(self.high[own], reach) - s, size)
            d = self._step(here.slope[kept], here.residual[kept], low, high, self.scale[own])
            expected = (here.residual + here.slope @ d)[kept]
            gain = here.misfit - float(expected @ expected)
            least = SLOW if here.misfit > DISTANT * allowed else 1e-3
            stuck = gain < max(FLAT, least * here.misfit)
            if stuck or radius < 1e-3:
                if here.misfit <= allowed or refreshed or float(without_each(here).min()) > FAR * allowed:
                    break
                here, refreshed, radius = self._refreshed(here), True, TRUST
                continue
            steps += 1
            there = self._moved(here, own, d)
            if there is None:
                radius = 0.3 * float(np.abs(d / self.scale[own]).max())
                continue
            if there.misfit < here.misfit - 0.1 * gain:
                rate = there.misfit / here.misfit
                here, refreshed, radius = there, False, 2.0 * radius
                if float(without_each(here).min()) * rate ** max(MOST_STEPS - steps, 0) > DISTANT * allowed:
                    break  # at this rate it comes nowhere near
                continue
            if not refreshed:
                here, refreshed = self._refreshed(here), True
            else:
                radius = 0.3 * float(np.abs(d / self.scale[own]).max())
                if there.misfit < here.misfit:
                    here = there
        return here

    def _first(self, own: list[int], start: Array, J: Array, kept: Array) -> Fit | None:
        """Return the state of a start, nearer to rest where it is not reached."""
        for share in (1.0, 0.5, 0.25, 0.1):
            motions = np.zeros(len(self.scale))
            motions[own] = share * start
            prediction = self.forward.predict(motions)
            if prediction.reached:
                return Fit(tuple(own), motions, prediction, self.residual(prediction), J, kept)
        return None

    def _moved(self, here: Fit, own: list[int], d: Array) -> Fit | None:
        """Return the fit at a step, with derivatives corrected by it; None where it was not reached."""
        motions = here.motions.copy()
        motions[own] += d
        prediction = self.forward.predict(motions)
        if not prediction.reached:
            return None
        residual = self.residual(prediction)
        x = d / self.scale[own]
        miss = residual - here.residual - here.slope @ d
        slope = here.slope + np.outer(miss, x / self.scale[own]) / float(x @ x)
        return Fit(here.chosen, motions, prediction, residual, slope, here.kept)

    def _refreshed(self, here: Fit) -> Fit:
        """Return a fit with derivatives from differences."""
        slope, _ = self.derivatives(here, here.chosen, central=False)
        return Fit(here.chosen, here.motions, here.prediction, here.residual, slope, here.kept, fresh=True)

    @staticmethod
    def _step(J: Array, r: Array, low: Array, high: Array, scale: Array) -> Array:
        """Return the step within bounds that makes J d + r smallest; the least one where several do."""
        wide = high > low
        d = np.zeros(len(low))
        if wide.any():
            own = J[:, wide] * scale[wide]
            damped = np.vstack([own, 1e-6 * max(float(np.abs(own).max(initial=0.0)), 1e-300) * np.eye(int(wide.sum()))])
            target = np.concatenate([-r, np.zeros(int(wide.sum()))])
            found = lsq_linear(damped, target, bounds=(low[wide] / scale[wide], high[wide] / scale[wide]))
            d[wide] = found.x * scale[wide]
        return d


def _below(fit: Fit, other: Fit) -> bool:
    """Return whether a fit is better than another, with all measurements or without the one that spoils it most."""
    return fit.misfit < other.misfit or float(without_each(fit).min()) < float(without_each(other).min())


def without_each(fit: Fit) -> Array:
    """Return the misfit (m,) that is left, to first order, without each of the m measurements that count.

    It is chi2 - r^2 / (1 - h), with the leverage h of the measurement: the diagonal of J (J'J)^-1 J'.
    """
    return _without_each(fit.residual[fit.kept], fit.slope[fit.kept])


def _without_each(r: Array, J: Array) -> Array:
    lever = np.zeros(len(r))
    if J.shape[1]:
        basis, size, _ = np.linalg.svd(J, full_matrices=False)
        lever = (basis[:, size > 1e-9 * max(float(size.max()), 1e-300)] ** 2).sum(1)
    left: Array = np.maximum(float(r @ r) - r**2 / np.maximum(1.0 - lever, 1e-9), 0.0)
    return left
