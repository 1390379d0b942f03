"""Distributions by name: what is not known about a number, as an engineer states it.

Parameters are those people know: mean and standard deviation (or coefficient of variation) of the quantity itself, its
bounds, its most likely value. Any continuous distribution may be cut at ``low`` and ``high``. Values come from the
inverse distribution function, so that every sample, whatever its design, is made of numbers between 0 and 1.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from concio.arguments import closest
from concio.errors import InputError

Array = np.ndarray


@dataclass(frozen=True)
class Family:
    """What a family of distributions takes.

    Parameters
    ----------
    needs : tuple of tuple of str
        Sets of parameters, one of which must be given.
    frozen : callable
        From the parameters to a distribution of SciPy.
    bounded : bool
        Whether ``low`` and ``high`` are parameters of its own, and not cuts.
    """

    needs: tuple[tuple[str, ...], ...]
    frozen: Callable[[Mapping[str, float]], Any]
    bounded: bool = False


def _spread(p: Mapping[str, float]) -> float:
    return p["sd"] if "sd" in p else abs(p["mean"]) * p["cov"]


def _normal(p: Mapping[str, float]) -> Any:
    from scipy.stats import norm

    return norm(p["mean"], _spread(p))


def _lognormal(p: Mapping[str, float]) -> Any:
    from scipy.stats import lognorm

    if "median" in p:
        return lognorm(p["beta"], scale=p["median"])
    beta = math.sqrt(math.log1p((_spread(p) / p["mean"]) ** 2))
    return lognorm(beta, scale=p["mean"] * math.exp(-0.5 * beta**2))


def _uniform(p: Mapping[str, float]) -> Any:
    from scipy.stats import uniform

    return uniform(p["low"], p["high"] - p["low"])


def _triangular(p: Mapping[str, float]) -> Any:
    from scipy.stats import triang

    width = p["high"] - p["low"]
    return triang((p["mode"] - p["low"]) / width, p["low"], width)


def _beta(p: Mapping[str, float]) -> Any:
    from scipy.stats import beta

    return beta(p["alpha"], p["beta"], p["low"], p["high"] - p["low"])


def _gumbel(p: Mapping[str, float]) -> Any:
    from scipy.stats import gumbel_r

    scale = _spread(p) * math.sqrt(6.0) / math.pi
    return gumbel_r(p["mean"] - np.euler_gamma * scale, scale)


def _weibull(p: Mapping[str, float]) -> Any:
    from scipy.stats import weibull_min

    return weibull_min(p["shape"], scale=p["scale"])


FAMILIES: dict[str, Family] = {
    "uniform": Family((("low", "high"),), _uniform, bounded=True),
    "normal": Family((("mean", "sd"), ("mean", "cov")), _normal),
    "lognormal": Family((("mean", "sd"), ("mean", "cov"), ("median", "beta")), _lognormal),
    "triangular": Family((("low", "mode", "high"),), _triangular, bounded=True),
    "beta": Family((("low", "high", "alpha", "beta"),), _beta, bounded=True),
    "gumbel": Family((("mean", "sd"), ("mean", "cov")), _gumbel),
    "weibull": Family((("shape", "scale"),), _weibull),
}
"""Continuous distributions by name."""

POSITIVE = ("sd", "cov", "beta", "alpha", "shape", "scale", "median")
"""Parameters that must be positive."""


@dataclass(frozen=True)
class Distribution:
    """A distribution of one quantity.

    Parameters
    ----------
    kind : str
        One of :data:`FAMILIES`.
    parameters : mapping of str to float
        Those of one of the sets the family takes; ``low`` and ``high`` cut families without bounds of their own.

    Raises
    ------
    InputError
        There is no such family, or the parameters do not fit it.
    """

    kind: str
    parameters: Mapping[str, float]

    def __post_init__(self) -> None:
        if self.kind not in FAMILIES:
            msg = f"there is no distribution '{self.kind}'"
            raise InputError(msg, hint=closest(self.kind, list(FAMILIES)))
        given = set(self.parameters) - (set() if FAMILIES[self.kind].bounded else {"low", "high"})
        needs = FAMILIES[self.kind].needs
        if not any(given == set(need) for need in needs):
            said = ", ".join(sorted(given)) or "nothing"
            msg = f"a {self.kind} distribution takes {' or '.join(' and '.join(n) for n in needs)}, not {said}"
            raise InputError(msg)
        for name, value in self.parameters.items():
            if not isinstance(value, int | float) or isinstance(value, bool) or not math.isfinite(value):
                msg = f"{name} = {value!r} is not a finite number"
                raise InputError(msg)
            if name in POSITIVE and not value > 0:
                msg = f"{name} = {value:g} must be positive"
                raise InputError(msg)
        low, high = self.bounds
        if not low < high:
            msg = f"low = {low:g} must be less than high = {high:g}"
            raise InputError(msg)
        if "mode" in self.parameters and not low <= self.parameters["mode"] <= high:
            msg = f"mode = {self.parameters['mode']:g} must lie between low and high"
            raise InputError(msg)
        if self.kind == "lognormal" and not self.parameters.get("mean", 1.0) > 0:
            msg = f"mean = {self.parameters['mean']:g} must be positive"
            raise InputError(msg)
        if "cov" in self.parameters and self.parameters["mean"] == 0:
            msg = "a coefficient of variation needs a mean other than zero"
            raise InputError(msg, hint="give sd")
        if not self._share[0] < self._share[1]:
            msg = f"nothing of the {self.kind} distribution lies between {low:g} and {high:g}"
            raise InputError(msg)

    @property
    def bounds(self) -> tuple[float, float]:
        """(low, high), infinite where nothing bounds it."""
        return float(self.parameters.get("low", -math.inf)), float(self.parameters.get("high", math.inf))

    @cached_property
    def _frozen(self) -> Any:
        return FAMILIES[self.kind].frozen(self.parameters)

    @cached_property
    def _share(self) -> tuple[float, float]:
        """Probabilities below the two cuts."""
        if FAMILIES[self.kind].bounded:
            return 0.0, 1.0
        low, high = self.bounds
        return float(self._frozen.cdf(low)), float(self._frozen.cdf(high))

    def quantile(self, u: Array) -> Array:
        """Return the values (n,) below which the shares ``u`` (n,) of all values lie."""
        first, last = self._share
        values: Array = np.clip(self._frozen.ppf(first + np.asarray(u) * (last - first)), *self.bounds)
        return values

    def standard(self, u: float) -> tuple[float, float]:
        """Return the value that a standard normal number stands for, and its derivative; exact in both tails."""
        first, last = self._share
        density = math.exp(-0.5 * u * u) / math.sqrt(2.0 * math.pi) * (last - first)
        tail = 0.5 * math.erfc(abs(u) / math.sqrt(2.0)) * (last - first)
        value = float(self._frozen.ppf(first + tail) if u <= 0 else self._frozen.isf((1.0 - last) + tail))
        there = float(self._frozen.pdf(value))
        return value, density / there if there > 0 else 0.0

    def describe(self) -> str:
        """Return the distribution in words, such as ``normal(mean 0.6, sd 0.06)``."""
        return f"{self.kind}({', '.join(f'{k} {v:g}' for k, v in self.parameters.items())})"
