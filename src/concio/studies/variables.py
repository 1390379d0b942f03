"""Variables of a study: a name, how its values are distributed, and which keys of the model file take them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from concio.arguments import closest, strict, strict_class
from concio.errors import InputError
from concio.studies.distributions import FAMILIES, Distribution

Array = np.ndarray

OWN = ("choice", "seed")
"""Kinds of variables beside the distributions: one of several values, and a number to begin random numbers with."""


@strict_class
@dataclass(frozen=True)
class Variable:
    """Something that differs from run to run.

    Parameters
    ----------
    name : str
        What it is called in tables, and as an argument of functions.
    distribution : str
        One of :data:`concio.studies.distributions.FAMILIES`, "choice" (one of ``values``) or "seed" (a whole number of
        its own for every run).
    keys : tuple of str
        Keys of the model file that take the value, as paths (:mod:`concio.model.file.keys`); none where a function
        uses it.
    unit : str
        Unit of the values, such as "MPa"; bare numbers are in the system of the file.
    parameters : mapping of str to float
        Parameters of the distribution; :func:`variable` takes them as arguments.
    values : tuple
        What a choice is made of: numbers or texts. Of other kinds, the levels of a grid.
    weights : tuple of float
        Probabilities of the values of a choice; equal by default.
    levels : int
        Number of levels in a grid, where ``values`` does not give them.

    Raises
    ------
    InputError
        Something does not fit; the message names the variable.

    Examples
    --------
    >>> import concio
    >>> import numpy as np
    >>> mu = concio.Variable("mu", "uniform", keys=("arch.friction",), parameters={"low": 0.4, "high": 0.8})
    >>> mu.quantile(np.array([0.0, 0.5, 1.0])).round(6).tolist()
    [0.4, 0.6, 0.8]
    """

    name: str
    distribution: str
    keys: tuple[str, ...] = ()
    unit: str = ""
    parameters: Mapping[str, float] = field(default_factory=dict)
    values: tuple[Any, ...] = ()
    weights: tuple[float, ...] = ()
    levels: int = 5

    def __post_init__(self) -> None:
        object.__setattr__(self, "keys", tuple(self.keys))
        object.__setattr__(self, "values", tuple(self.values))
        object.__setattr__(self, "weights", tuple(self.weights))
        where = f"variable '{self.name}'"
        if not isinstance(self.name, str) or not self.name:
            msg = "a variable needs a name"
            raise InputError(msg)
        if self.distribution not in (*FAMILIES, *OWN):
            msg = f"there is no distribution '{self.distribution}'"
            raise InputError(msg, where=where, hint=closest(self.distribution, [*FAMILIES, *OWN]))
        if self.distribution in OWN and self.parameters:
            msg = f"a {self.distribution} takes no {next(iter(self.parameters))}"
            raise InputError(msg, where=where)
        if self.distribution == "choice":
            self._check_choice(where)
        elif self.weights:
            msg = "only a choice has weights"
            raise InputError(msg, where=where)
        if self.distribution in FAMILIES:
            try:
                Distribution(self.distribution, self.parameters)
            except InputError as error:
                raise InputError(error.what, where=where, hint=error.hint) from None
            if any(isinstance(v, str) for v in self.values):
                msg = "the levels of a continuous variable are numbers"
                raise InputError(msg, where=where)
        if not isinstance(self.levels, int) or isinstance(self.levels, bool) or not 1 <= self.levels <= 100_000:
            msg = f"levels = {self.levels!r} must be a whole number from 1 to 100,000"
            raise InputError(msg, where=where)

    def _check_choice(self, where: str) -> None:
        if not self.values:
            msg = "a choice needs values"
            raise InputError(msg, where=where, hint='for example values = ["running", "english"]')
        if self.weights and (
            len(self.weights) != len(self.values) or min(self.weights) < 0 or not sum(self.weights) > 0
        ):
            msg = f"{len(self.values)} values need as many weights, none negative and not all zero"
            raise InputError(msg, where=where)

    @property
    def numeric(self) -> bool:
        """Whether its values are numbers with an order."""
        return all(isinstance(v, int | float) and not isinstance(v, bool) for v in self.values)

    @property
    def shares(self) -> Array:
        """Probabilities (k,) of the values of a choice."""
        weights = np.array(self.weights or [1.0] * len(self.values), dtype=float)
        shares: Array = weights / weights.sum()
        return shares

    def quantile(self, u: Array) -> Array:
        """Return what the shares ``u`` (n,) mean: values, or the indices (n,) of those of a choice."""
        if self.distribution == "choice":
            edges = np.cumsum(self.shares)[:-1]
            found: Array = np.searchsorted(edges, u, side="right").astype(float)
            return found
        if self.distribution == "seed":
            return np.floor(np.asarray(u) * 2.0**31)
        return Distribution(self.distribution, self.parameters).quantile(u)

    def grid(self) -> Array:
        """Return the levels (k,) of a grid: its values, or levels between its bounds, or of equal probability."""
        if self.distribution == "choice":
            return np.arange(len(self.values), dtype=float)
        if self.values:
            return np.array(self.values, dtype=float)
        if self.distribution == "uniform":
            return np.linspace(self.parameters["low"], self.parameters["high"], self.levels)
        return self.quantile((np.arange(self.levels) + 0.5) / self.levels)

    def value(self, number: float) -> Any:
        """Return what a number of the sample stands for: itself, a value of the choice, a whole number."""
        if self.distribution == "choice":
            return self.values[int(number)]
        return int(number) if self.distribution == "seed" else float(number)

    def written(self, number: float) -> Any:
        """Return the value as a model file writes it, with its unit."""
        value = self.value(number)
        return f"{value!r} {self.unit}" if self.unit and not isinstance(value, str) else value

    def describe(self) -> str:
        """Return the distribution in words."""
        if self.distribution == "choice":
            return "one of " + ", ".join(map(str, self.values))
        if self.distribution == "seed":
            return "a seed of its own for every run"
        return Distribution(self.distribution, self.parameters).describe() + (f" {self.unit}" if self.unit else "")


@strict
def variable(
    name: str,
    distribution: str = "uniform",
    *,
    keys: str | Sequence[str] = (),
    unit: str = "",
    values: Sequence[Any] = (),
    weights: Sequence[float] = (),
    levels: int = 5,
    **parameters: float,
) -> Variable:
    """Return a variable; parameters of its distribution are arguments.

    Examples
    --------
    The median, and the value 1.645 standard deviations below it:

    >>> import concio
    >>> import numpy as np
    >>> mu = concio.variable("mu", "normal", keys="wall.friction", mean=0.6, sd=0.06)
    >>> mu.quantile(np.array([0.5, 0.05])).round(4).tolist()
    [0.6, 0.5013]
    """
    if any(not math.isfinite(w) for w in weights):
        msg = "weights must be finite"
        raise InputError(msg, where=f"variable '{name}'")
    given = (keys,) if isinstance(keys, str) else tuple(keys)
    return Variable(name, distribution, given, unit, parameters, tuple(values), tuple(weights), levels)
