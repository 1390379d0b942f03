"""What a study says: probabilities with intervals, fragility curves with bands, sensitivities."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from concio.errors import InputError
from concio.problem.tolerances import SAME_VALUE

Array = np.ndarray


@dataclass(frozen=True)
class Probability:
    """A probability from independent runs, with its interval (Clopper and Pearson).

    Parameters
    ----------
    estimate : float
        Share of the decided runs; ``nan`` where there is none.
    low, high : float
        Interval that covers the probability with at least ``confidence``; undecided runs count against both ends.
    yes, runs, undecided : int
        Runs with the event, runs in all, and runs without an answer.
    confidence : float
    """

    estimate: float
    low: float
    high: float
    yes: int
    runs: int
    undecided: int
    confidence: float

    def __str__(self) -> str:
        """Return the probability in words."""
        text = f"{self.estimate:.4g} ({100 * self.confidence:g} % between {self.low:.4g} and {self.high:.4g})"
        return text + (f", {self.undecided} of {self.runs} runs undecided" if self.undecided else "")


def probability(event: Array, confidence: float = 0.95) -> Probability:
    """Return the probability of an event from its values (n,) in independent runs: 1, 0, or ``nan`` for undecided.

    Raises
    ------
    InputError
        The confidence is not between 0 and 1.
    """
    from scipy.stats import beta

    if not 0 < confidence < 1:
        msg = f"confidence = {confidence!r} must lie between 0 and 1"
        raise InputError(msg, hint="0.95 is usual")
    known = event[~np.isnan(event)]
    n, yes, unknown = len(event), int((known > 0).sum()), int(np.isnan(event).sum())
    tail = 0.5 * (1.0 - confidence)
    most = yes + unknown
    low = float(beta.ppf(tail, yes, n - yes + 1)) if yes else 0.0
    high = float(beta.ppf(1.0 - tail, most + 1, n - most)) if most < n else 1.0
    return Probability(yes / len(known) if len(known) else math.nan, low, high, yes, n, unknown, confidence)


@dataclass(frozen=True)
class Spread:
    """How an output is spread over all runs of a study, those without a number in the places where they belong.

    Parameters
    ----------
    values : (n,) array
        One a run: a number; ``inf`` where there is no end to it; the worse end of the scale, ``-inf`` or ``inf``, where
        the structure does not stand; ``nan`` where the run has no answer.
    fails : int
        Runs in which the structure does not stand, so that the output has no number of its own.
    end : {"low", "high", ""}
        Which end is the worse one, "" where there is none: runs that fail are ``nan`` then.
    """

    values: Array
    fails: int = 0
    end: str = ""

    @property
    def known(self) -> Array:
        """The finite numbers."""
        finite: Array = self.values[np.isfinite(self.values)]
        return finite

    @property
    def endless(self) -> int:
        """Runs in which the number itself is infinite."""
        infinite = int(np.isinf(self.values).sum())
        return infinite - self.fails if self.end else infinite

    @property
    def unanswered(self) -> int:
        """Runs without an answer."""
        nan = int(np.isnan(self.values).sum())
        return nan if self.end else nan - self.fails

    @property
    def counted(self) -> int:
        """Runs that quantiles are of: all, but those that fail where these have no place in the order."""
        return len(self.values) - (0 if self.end else self.fails)

    def quantile(self, share: float) -> tuple[float, float]:
        """Return the least and the largest that a quantile of the runs can be; both alike where all have an answer.

        Between two numbers it is interpolated; between a number and an infinite one it is the worse of the two.
        """
        n, known = self.counted, np.sort(self.values[~np.isnan(self.values)])
        if not n:
            return math.nan, math.nan
        gap = n - len(known)
        ends = [np.concatenate([known, np.full(gap, end)] if end > 0 else [np.full(gap, end), known])
                for end in (-math.inf, math.inf)]  # fmt: skip
        low, high = (_quantile(ordered, share, worse=self.end or "low") for ordered in ends)
        return low, high

    @property
    def mean(self) -> float:
        """Mean of the finite numbers; ``nan`` where there is none."""
        return float(self.known.mean()) if len(self.known) else math.nan

    @property
    def sd(self) -> float:
        """Standard deviation of the finite numbers; ``nan`` of fewer than two."""
        return float(self.known.std(ddof=1)) if len(self.known) > 1 else math.nan

    def as_dict(self) -> dict[str, Any]:
        """Return the numbers of ``--json``: quantiles of all runs, moments of the finite numbers."""
        told: dict[str, Any] = {
            "runs": len(self.known), "of": len(self.values), "do_not_stand": self.fails, "without_limit": self.endless,
            "unanswered": self.unanswered,
        }  # fmt: skip
        if len(self.known):
            told |= {
                "mean": self.mean, "sd": self.sd if len(self.known) > 1 else None,
                "min": float(self.known.min()), "max": float(self.known.max()),
            }  # fmt: skip
        shares = {"5 %": 0.05, "50 %": 0.5, "95 %": 0.95}
        told["quantiles"] = {word: [_text(x) for x in self.quantile(share)] for word, share in shares.items()}
        told["quantiles_of"] = self.counted
        return told


def _quantile(ordered: Array, share: float, *, worse: str) -> float:
    at = share * (len(ordered) - 1)
    low, high = float(ordered[math.floor(at)]), float(ordered[math.ceil(at)])
    if low == high:
        return low
    if math.isfinite(low) and math.isfinite(high):
        return low + (at - math.floor(at)) * (high - low)
    return low if worse == "low" else high


def _text(value: float) -> float | str | None:
    """Return a number for JSON, which has none that is infinite."""
    return value if math.isfinite(value) else None if math.isnan(value) else str(value)


@dataclass(frozen=True)
class Fragility:
    """A lognormal fragility curve: P(x) = Phi(ln(x / median) / beta), fitted by greatest likelihood.

    Parameters
    ----------
    median : float
        Intensity at which half of the structures fail.
    beta : float
        Standard deviation of its logarithm.
    covariance : (2, 2) array
        Of the intercept and the slope of the probit line a + b ln x, b = 1/beta.
    runs : int
        Runs that it was fitted to.
    left_out : int
        Runs without an answer, and runs that were not made.
    """

    median: float
    beta: float
    covariance: Array
    runs: int
    left_out: int = 0

    def probability(self, x: Any) -> Array:
        """Return the probability of failure at the intensities ``x`` (n,)."""
        from scipy.stats import norm

        p: Array = norm.cdf(np.log(np.asarray(x, dtype=float) / self.median) / self.beta)
        return p

    def band(self, x: Any, confidence: float = 0.95) -> tuple[Array, Array]:
        """Return (low, high) of the curve at ``x`` (n,): pointwise, from the information matrix of the fit."""
        from scipy.stats import norm

        logs = np.log(np.asarray(x, dtype=float))
        line = (logs - math.log(self.median)) / self.beta
        c = self.covariance
        error = np.sqrt(c[0, 0] + 2.0 * logs * c[0, 1] + logs**2 * c[1, 1])
        z = float(norm.ppf(0.5 + 0.5 * confidence))
        return norm.cdf(line - z * error), norm.cdf(line + z * error)


def fragility(intensity: Array, failed: Array) -> Fragility:
    """Fit a lognormal fragility curve to single runs.

    Parameters
    ----------
    intensity : (n,) array
        Positive.
    failed : (n,) array
        1, 0, or ``nan`` for runs without an answer, which are left out.

    Raises
    ------
    InputError
        Intensities that are not positive, runs that all end alike, or a clean cut between those that fail and the rest:
        no curve of finite slope is most likely then.
    """
    from scipy.optimize import minimize
    from scipy.stats import norm

    known = ~np.isnan(failed)
    x, y = np.asarray(intensity, dtype=float)[known], np.asarray(failed)[known] > 0
    if not len(x) or not (x > 0).all():
        msg = "a fragility curve needs positive intensities"
        raise InputError(msg)
    if y.all() or not y.any():
        msg = f"{'all' if y.all() else 'none'} of {len(y)} runs fail: there is no curve through that"
        raise InputError(msg, hint="widen the range of the intensity")
    if x[y].min() >= x[~y].max():
        msg = f"all runs fail from {x[y].min():g} on and none below: no finite spread is most likely"
        raise InputError(msg, hint="more runs between, or simply that threshold")
    if x[y].max() <= x[~y].min():
        msg = "runs fail below an intensity and hold above it: this is not a fragility curve"
        raise InputError(msg, hint="is the event reversed?")
    logs = np.log(x)
    centre, width = float(logs.mean()), float(logs.std()) or 1.0
    t, sign = (logs - centre) / width, np.where(y, 1.0, -1.0)

    def loss(p: Array) -> tuple[float, Array]:
        arg = sign * (p[0] + p[1] * t)
        log_cdf = norm.logcdf(arg)
        slope = sign * np.exp(norm.logpdf(arg) - log_cdf)
        return -float(log_cdf.sum()), -np.array([slope.sum(), (slope * t).sum()])

    a, b = minimize(loss, np.array([0.0, 1.0]), jac=True, method="BFGS").x
    if not b > 0:
        msg = "failures grow rarer with the intensity: this is not a fragility curve"
        raise InputError(msg, hint="is the event reversed?")
    line = a + b * t
    weight = np.exp(2.0 * norm.logpdf(line) - norm.logcdf(line) - norm.logsf(line))
    own = np.linalg.inv(np.array([[weight.sum(), (weight * t).sum()], [(weight * t).sum(), (weight * t**2).sum()]]))
    back = np.array([[1.0, -centre / width], [0.0, 1.0 / width]])  # (a, b) of t to those of ln x
    beta = width / b
    return Fragility(math.exp(centre - a * beta), float(beta), back @ own @ back.T, len(x), int((~known).sum()))


@dataclass(frozen=True)
class Sensitivity:
    """Shares of the variance of an output that variables bring (Sobol indices), or rank correlations.

    Parameters
    ----------
    names : tuple of str
    first, total : (k,) arrays
        First-order and total indices; of rank correlations the same numbers twice.
    first_error, total_error : (k,) arrays
        Half widths of their 95 % intervals; ``nan`` where not known.
    kind : str
        "Sobol" or "Spearman".
    left_out : int
        Runs without an answer, which have no rank.
    """

    names: tuple[str, ...]
    first: Array
    total: Array
    first_error: Array
    total_error: Array
    kind: str
    left_out: int = 0


def alike(values: Array) -> bool:
    """Return whether finite values (n,) differ by no more than rounding."""
    return bool(np.ptp(values) <= SAME_VALUE * np.abs(values).max())


def _tied(values: Array) -> Array:
    """Return values (n,) of which those that differ by rounding alone are equal: to the least of them."""
    order = np.argsort(values)
    ordered = values[order]
    with np.errstate(invalid="ignore"):  # infinite less infinite
        steps = np.diff(ordered)
        apart = np.where(np.isfinite(steps), steps > SAME_VALUE * np.abs(ordered[1:]), ordered[1:] != ordered[:-1])
    starts = np.concatenate([[True], apart])[: len(ordered)]
    first = np.maximum.accumulate(np.where(starts, np.arange(len(ordered)), 0))
    tied: Array = np.empty_like(ordered)
    tied[order] = ordered[first]
    return tied


def sobol_indices(names: Sequence[str], values: Array, seed: int = 0) -> Sensitivity:
    """Return Sobol indices of the values (n (k + 2),) of a ``saltelli`` sample, by SALib.

    Raises
    ------
    InputError
        A run has no value, all values are alike, or SALib is missing.
    """
    without = ~np.isfinite(values)
    if without.any():
        first = int(np.flatnonzero(without)[0])
        count = int(without.sum())
        several = f"{count:,} runs have no value, the first of them run {first}"
        msg = f"run {first} has no value" if count == 1 else several
        raise InputError(msg, hint="Sobol indices need a finite number of every run: look at the rows without one")
    if alike(values):
        msg = "all runs give the same value, and there is no variance to share"
        raise InputError(msg)
    try:
        from SALib.analyze import sobol
    except ImportError:
        msg = "Sobol indices need the package SALib"
        raise InputError(msg, hint="pip install 'concio[study]'") from None
    problem = {"num_vars": len(names), "names": list(names), "bounds": [[0.0, 1.0]] * len(names)}
    found = sobol.analyze(problem, values, calc_second_order=False, seed=seed)
    s1, st, s1_error, st_error = (np.asarray(found[key]) for key in ("S1", "ST", "S1_conf", "ST_conf"))
    return Sensitivity(tuple(names), s1, st, s1_error, st_error, "Sobol")


def rank_correlations(columns: Mapping[str, Array], values: Array) -> Sensitivity:
    """Return Spearman's correlation of an output with each variable.

    Infinite values have their rank at the end of the scale; values that differ by rounding alone have the same; runs
    without an answer (``nan``) are left out and counted.
    """
    from scipy.stats import rankdata

    known = ~np.isnan(values)
    ranks = rankdata(_tied(values[known]))
    found = []
    for column in columns.values():
        own = rankdata(column[known])
        spread = own.std() * ranks.std()
        found.append(float(((own - own.mean()) * (ranks - ranks.mean())).mean() / spread) if spread > 0 else 0.0)
    shares, nothing = np.array(found), np.full(len(found), math.nan)
    return Sensitivity(tuple(columns), shares, shares, nothing, nothing, "Spearman", int((~known).sum()))
