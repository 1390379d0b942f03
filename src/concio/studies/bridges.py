"""Bridges to libraries that engineers use for uncertainty: problems of SALib, samples of OpenTURNS, both ways."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from concio.arguments import closest
from concio.errors import InputError
from concio.studies.sampling import Sample, given_sample
from concio.studies.variables import Variable, variable

Array = np.ndarray


def variables_of_salib(problem: Mapping[str, Any], keys: Mapping[str, str] | None = None) -> tuple[Variable, ...]:
    """Return the variables of a problem dictionary of SALib.

    Parameters
    ----------
    problem : mapping
        ``num_vars``, ``names``, ``bounds`` and perhaps ``dists`` ("unif", "triang", "norm", "truncnorm", "lognorm").
    keys : mapping of str to str, optional
        Keys of the model file by the names of variables.

    Raises
    ------
    InputError
        The dictionary does not fit, or has a distribution that is not known here.
    """
    try:
        names, bounds = [str(n) for n in problem["names"]], [list(map(float, b)) for b in problem["bounds"]]
        dists = list(problem.get("dists") or ["unif"] * len(names))
    except (KeyError, TypeError, ValueError) as error:
        msg = f"this is not a problem dictionary of SALib: {error!r}"
        raise InputError(msg, hint="it has num_vars, names and bounds") from None
    if not len(names) == len(bounds) == len(dists) == problem.get("num_vars", len(names)):
        msg = "num_vars, names, bounds and dists of the problem differ in number"
        raise InputError(msg)
    if problem.get("groups") and list(problem["groups"]) != names:
        msg = "groups of variables are not known here"
        raise InputError(msg, hint="leave groups out")
    made = []
    for name, bound, dist in zip(names, bounds, dists, strict=True):
        own = (keys or {}).get(name, ())
        if dist not in _FROM:
            msg = f"there is no distribution '{dist}'"
            raise InputError(msg, where=f"variable '{name}'", hint=closest(dist, list(_FROM)))
        kind, arguments = _FROM[dist](bound)
        made.append(variable(name, kind, keys=own, **arguments))
    return tuple(made)


def _triang(b: Sequence[float]) -> tuple[str, dict[str, float]]:
    return "triangular", {"low": b[0], "high": b[1], "mode": b[0] + b[2] * (b[1] - b[0])}


def _lognorm(b: Sequence[float]) -> tuple[str, dict[str, float]]:
    return "lognormal", {"median": math.exp(b[0]), "beta": b[1]}


def _unif(b: Sequence[float]) -> tuple[str, dict[str, float]]:
    return "uniform", {"low": b[0], "high": b[1]}


def _norm(b: Sequence[float]) -> tuple[str, dict[str, float]]:
    return "normal", {"mean": b[0], "sd": b[1]}


def _truncnorm(b: Sequence[float]) -> tuple[str, dict[str, float]]:
    return "normal", {"low": b[0], "high": b[1], "mean": b[2], "sd": b[3]}


_FROM: dict[str, Callable[[Sequence[float]], tuple[str, dict[str, Any]]]] = {
    "unif": _unif,
    "triang": _triang,
    "norm": _norm,
    "truncnorm": _truncnorm,
    "lognorm": _lognorm,
}


def salib_problem(variables: Sequence[Variable]) -> dict[str, Any]:
    """Return the problem dictionary of SALib for some variables.

    Raises
    ------
    InputError
        SALib has no such distribution.
    """
    bounds, dists = [], []
    for v in variables:
        p = v.parameters
        cut = "low" in p or "high" in p
        if v.distribution == "uniform":
            dist, bound = "unif", [p["low"], p["high"]]
        elif v.distribution == "triangular":
            dist, bound = "triang", [p["low"], p["high"], (p["mode"] - p["low"]) / (p["high"] - p["low"])]
        elif v.distribution == "normal" and (not cut or {"low", "high"} <= set(p)):
            spread = p["sd"] if "sd" in p else abs(p["mean"]) * p["cov"]
            dist, bound = "norm", [p["mean"], spread]
            if cut:
                dist, bound = "truncnorm", [p["low"], p["high"], *bound]
        elif v.distribution == "lognormal" and not cut:
            if "median" in p:
                beta, median = p["beta"], p["median"]
            else:
                cov = p["cov"] if "cov" in p else p["sd"] / p["mean"]
                beta = math.sqrt(math.log1p(cov**2))
                median = p["mean"] * math.exp(-0.5 * beta**2)
            dist, bound = "lognorm", [math.log(median), beta]
        else:
            msg = f"SALib has no distribution like {v.describe()}"
            raise InputError(
                msg, where=f"variable '{v.name}'", hint="draw the sample here and hand it over as an array"
            )
        dists.append(dist)
        bounds.append(bound)
    return {"num_vars": len(bounds), "names": [v.name for v in variables], "bounds": bounds, "dists": dists}


def openturns_sample(sample: Sample) -> Any:
    """Return the values of a sample as an ``openturns.Sample`` with the names of its variables.

    Raises
    ------
    InputError
        OpenTURNS is not installed.
    """
    try:
        import openturns as ot
    except ImportError:
        msg = "this needs the package openturns"
        raise InputError(msg, hint="pip install 'concio[uq]'") from None
    made = ot.Sample(sample.numbers.tolist())
    made.setDescription([v.name for v in sample.variables])
    return made


def sample_of_openturns(variables: Sequence[Variable], sample: Any, seed: int = 0) -> Sample:
    """Return a sample made by OpenTURNS; where its columns have the names of the variables, in any order.

    Raises
    ------
    InputError
        Its columns do not fit the variables.
    """
    table = np.array(sample, dtype=float)
    described = list(sample.getDescription())
    names = [v.name for v in variables]
    if set(described) == set(names):
        table = table[:, [described.index(name) for name in names]]
    return given_sample(variables, table, seed=seed)
