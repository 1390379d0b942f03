r"""First-order reliability (FORM): how far in standard deviations a structure is from its limit state.

Variables x are functions of independent standard normal numbers u, x_i = F_i^{-1}(Phi(u_i)). The limit state g(x) is
positive where the structure holds. The index of Hasofer and Lind is the distance beta of the surface g = 0 from the
origin of u, its nearest point is the design point, and Phi(-beta) is the probability of failure where g is linear in u,
and an approximation otherwise. The point is found by the iteration of Hasofer, Lind, Rackwitz and Fiessler with a line
search on a merit function; where the surface is so curved about it that steps go back and forth, by sequential
quadratic programming (SLSQP of SciPy), checked by the same conditions. Of several nearest points it finds one.

Sources: A. M. Hasofer, N. C. Lind, J. Eng. Mech. Div. 100 (1974) 111-121; R. Rackwitz, B. Fiessler, Comput. Struct. 9
(1978) 489-494; Y. Zhang, A. Der Kiureghian, in: Reliability and Optimization of Structural Systems (1995) 297-304.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.special import ndtr

from concio.arguments import strict
from concio.errors import InputError, SolverError
from concio.representation import short_repr
from concio.studies.distributions import FAMILIES, Distribution
from concio.studies.variables import Variable

if TYPE_CHECKING:
    from concio.model.model import Model

Array = np.ndarray
Gradient = Mapping[str, float]
LimitState = Callable[[dict[str, float]], Any]

CLOSE = 1e-10
"""Distance of the last two points, relative to one plus their distance from the origin, at which the iteration ends."""
NEARLY = 1e-6
"""The same of a point found by quadratic programmes; the index, a least distance, is then off by its square."""
STEP = 1e-4
"""Step in standard deviations of differences, where a limit state gives no gradient."""
SEEN = 1e-4
"""Length of steps, relative to one plus the distance from the origin, of which the merit function sees the decrease."""
LEAST = 2.0**-12
"""Shortest step of the line search, as a share of the whole."""


@short_repr
@dataclass(frozen=True, eq=False)
class Reliability:
    """A design point with its index.

    Parameters
    ----------
    beta : float
        Index of Hasofer and Lind; negative where the structure does not hold at the medians.
    point : dict of str to float
        Values of the variables at the design point, the likeliest with which the limit state is reached.
    importance : dict of str to float
        Share of each variable in the variance of the linearised limit state; the sum is one.
    direction : dict of str to float
        Change of the index per standard deviation of each variable: positive ones add to the safety.
    limit_state : float
        Its value at the design point, relative to that at the medians or to its change over one standard deviation,
        whichever is larger.
    evaluations : int
        Of the limit state.

    Examples
    --------
    >>> import concio
    >>> x = concio.variable("x", "normal", mean=3.0, sd=1.0)
    >>> round(concio.reliability(lambda v: v["x"] - 1.0, [x]).probability, 6)
    0.02275
    """

    beta: float
    point: dict[str, float]
    importance: dict[str, float]
    direction: dict[str, float]
    limit_state: float
    evaluations: int

    @property
    def probability(self) -> float:
        """Probability of failure with the limit state linearised at the design point, Phi(-beta)."""
        return float(ndtr(-self.beta))

    @property
    def sentence(self) -> str:
        """Index, probability and the variables that matter most, in words."""
        names = sorted(self.importance, key=lambda name: -self.importance[name])[:3]
        told = ", ".join(f"{name} {100 * self.importance[name]:.3g} %" for name in names)
        return (
            f"Reliability index {self.beta:.4g} (first order): probability of failure {self.probability:.3g}; "
            f"shares of the variance: {told}"
        )


@strict
def reliability(limit_state: LimitState, variables: Sequence[Variable], *, most: int = 100) -> Reliability:
    """Return the index of Hasofer and Lind of a limit state, with its design point.

    Parameters
    ----------
    limit_state : callable
        Takes the values of the variables by name and returns g, positive where the structure holds; or g and a mapping
        with its derivative with respect to each variable, as :func:`multiplier_over` does. Without derivatives they
        are taken by differences.
    variables : sequence of Variable
        Independent and continuous.
    most : int
        Largest number of steps.

    Returns
    -------
    Reliability

    Raises
    ------
    InputError
        A variable is not continuous, or g does not depend on any.
    SolverError
        No design point was found: g has none, or is not smooth.

    Examples
    --------
    Of a resistance and a load, both normal, the index is the difference of the means over that of the deviations:

    >>> import concio
    >>> r = concio.variable("r", "normal", mean=10.0, sd=3.0)
    >>> s = concio.variable("s", "normal", mean=5.0, sd=4.0)
    >>> found = concio.reliability(lambda x: x["r"] - x["s"], [r, s])
    >>> round(found.beta, 9), {name: round(v, 6) for name, v in found.point.items()}
    (1.0, {'r': 8.2, 's': 8.2})
    """
    search = _Search(limit_state, variables)
    u = np.zeros(len(search.names))
    g, slope = search.at(u)
    if not 0 < np.linalg.norm(slope) < np.inf:
        msg = "the limit state does not depend on any of the variables there"
        raise InputError(msg, where=", ".join(f"{k} = {v:.4g}" for k, v in search.values(u).items()))
    first = max(abs(g), float(np.linalg.norm(slope)))  # g may be zero to rounding from the start
    found = _by_steps(search, u, g, slope, first, most) or _by_programming(search, first, most)
    if found is None:
        msg = f"no design point was found in {search.evaluations} evaluations of the limit state"
        raise SolverError(msg, hint="is it smooth, and does it become zero? Sample it with concio.study")
    return found


def _by_steps(search: _Search, u: Array, g: float, slope: Array, first: float, most: int) -> Reliability | None:
    """Return the design point to which steps to tangent planes lead, with a line search; None where they do not."""
    weight = 0.0
    for _ in range(most):
        size = float(np.linalg.norm(slope))
        if not 0 < size < math.inf:
            return None
        step = _step(u, g, slope)
        if np.linalg.norm(step) <= CLOSE * (1.0 + np.linalg.norm(u)) and abs(g) <= 1e-8 * first:
            return search.found(u, g / first, slope / size)
        weight = max(weight, 2.0 * float(np.linalg.norm(u)) / size, float(u @ u + step @ step) / (abs(g) or first))
        merit, share = 0.5 * float(u @ u) + weight * abs(g), 1.0
        near = np.linalg.norm(step) <= SEEN * (1.0 + np.linalg.norm(u))
        while True:
            new = u + share * step
            g_new, slope_new = search.at(new)
            if near:  # by the merit, a square, any short step would do
                lower = bool(np.linalg.norm(_step(new, g_new, slope_new)) < np.linalg.norm(step))
            else:
                lower = math.isfinite(g_new) and 0.5 * float(new @ new) + weight * abs(g_new) <= merit * (1 + 1e-12)
            if lower or share <= LEAST:
                break
            share /= 2
        if not math.isfinite(g_new):
            return None
        u, g, slope = new, g_new, slope_new
    return None


def _by_programming(search: _Search, first: float, most: int) -> Reliability | None:
    """Return the point nearest to the origin on the surface g = 0 by quadratic programmes, if its conditions hold."""
    from scipy.optimize import minimize

    known = lru_cache(maxsize=4)(lambda point: search.at(np.array(point)))

    def at(u: Array) -> tuple[float, Array]:
        return known(tuple(u.tolist()))

    programme: Any = minimize
    answer = programme(
        lambda u: 0.5 * float(u @ u),
        np.zeros(len(search.names)),
        jac=lambda u: u,
        method="SLSQP",
        constraints={"type": "eq", "fun": lambda u: at(u)[0] / first, "jac": lambda u: at(u)[1] / first},
        options={"maxiter": most, "ftol": NEARLY**2},
    )
    u = np.asarray(answer.x)
    if not np.isfinite(u).all():
        return None
    g, slope = at(u)
    size = float(np.linalg.norm(slope))
    if not (0 < size < math.inf and abs(g) <= 1e-8 * first):
        return None
    if np.linalg.norm(_step(u, g, slope)) > NEARLY * (1.0 + np.linalg.norm(u)):
        return None
    return search.found(u, g / first, slope / size)


def _step(u: Array, g: float, slope: Array) -> Array:
    """Return the way from u to the point of the tangent plane of the surface g = 0 that is nearest to the origin."""
    step: Array = (slope @ u - g) / float(slope @ slope) * slope - u
    return step


@strict
def multiplier_over(
    model: Callable[[dict[str, float]], Model], required: float = 1.0, live: Sequence[str] = ("live",)
) -> LimitState:
    """Return the limit state "associated multiplier less what is required", with its derivatives by duality.

    Derivatives come without another solution (:meth:`~concio.analysis.limit_result.LimitResult.sensitivity`). The
    associated multiplier is at or above that of Coulomb friction where joints slide; its index is then an upper bound.

    Parameters
    ----------
    model : callable
        Takes the values of the variables by name and returns the model they make.
    required : float
    live : sequence of str
        Load groups that are multiplied.

    Examples
    --------
    A pillar tips at width over height, and so its margin grows by one over the height:

    >>> import concio
    >>> pillar = lambda v: concio.column(width=v["b"], height=2.0, blocks=1, block="rigid", horizontal=1.0)
    >>> margin, slopes = concio.multiplier_over(pillar, required=0.2)({"b": 0.5})
    >>> round(margin, 9), round(slopes["b"], 9)
    (0.05, 0.5)
    """
    from concio.analysis.limit import limit

    def state(values: dict[str, float]) -> tuple[float, dict[str, float]]:
        found = limit(model(values), list(live), path=False, steps=False, search=False, friction=False)
        changes = {name: _changed(model, values, name) for name in values}
        rows = found.sensitivity(changes)
        rates = {r.of: r for r in rows.rows}
        without = [name for name in values if name not in rates]
        if without:
            msg = f"the multiplier has no derivative with respect to '{without[0]}': models beside have other joints"
            raise InputError(msg, hint="sample it with concio.study")
        slopes = {name: r.above if math.isfinite(r.above) else r.below for name, r in rates.items()}
        return found.associated.multiplier - required, slopes

    return state


def _changed(
    model: Callable[[dict[str, float]], Model], values: dict[str, float], name: str
) -> Callable[[float], Model]:
    return lambda more: model({**values, name: values[name] + more})


class _Search:
    """A limit state over standard normal numbers."""

    def __init__(self, limit_state: LimitState, variables: Sequence[Variable]) -> None:
        for v in variables:
            if v.distribution not in FAMILIES:
                msg = f"variable '{v.name}' is a {v.distribution}, and first-order reliability takes continuous ones"
                raise InputError(msg, hint="sample it with concio.study")
        if not variables:
            msg = "there are no variables"
            raise InputError(msg)
        self.limit_state, self.evaluations = limit_state, 0
        self.names = [v.name for v in variables]
        self.made = [Distribution(v.distribution, v.parameters) for v in variables]

    def values(self, u: Array) -> dict[str, float]:
        """Return the values of the variables."""
        return {n: d.standard(float(w))[0] for n, d, w in zip(self.names, self.made, u, strict=True)}

    def at(self, u: Array) -> tuple[float, Array]:
        """Return g and its gradient with respect to u."""
        g, slopes = self._asked(u)
        if slopes is None:
            return g, np.array([(self._asked(u + h)[0] - self._asked(u - h)[0]) / (2 * STEP)
                                for h in STEP * np.eye(len(u))])  # fmt: skip
        rates = [d.standard(float(w))[1] for d, w in zip(self.made, u, strict=True)]
        return g, np.array([slopes[name] * rate for name, rate in zip(self.names, rates, strict=True)])

    def _asked(self, u: Array) -> tuple[float, Gradient | None]:
        self.evaluations += 1
        said = self.limit_state(self.values(u))
        return (float(said[0]), said[1]) if isinstance(said, tuple) else (float(said), None)

    def found(self, u: Array, g: float, way: Array) -> Reliability:
        """Return the result at a design point with the direction of the gradient there."""
        shares = dict(zip(self.names, (way**2).tolist(), strict=True))
        return Reliability(-float(way @ u), self.values(u), shares, dict(zip(self.names, way.tolist(), strict=True)),
                           g, self.evaluations)  # fmt: skip
