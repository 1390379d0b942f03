r"""Primal-dual interior point on the plane Coulomb problem itself, non-monotone as it is.

Unknowns are u, the shifted normal forces t_n, friction forces t_t, gaps y_n, the slacks s+ = c + mu t_n + t_t and
s- = c + mu t_n - t_t, and the slip parts y+ and y-, all of equations (5), (16), (18):

.. math::

    K u - f - C_n^T t_n - C_t^T t_t &= 0, &
    y_n &= x_n + C_n u + a_n t_n - \bar d\,(y^+ + y^-) + p, \\
    y^+ - y^- &= C_t u - s + a_t t_t, &
    t_n y_n &= s^+ y^+ = s^- y^- = q\,p = \tau \to 0, \qquad q = N - t_n .

Each iteration solves Newton's equations (:mod:`concio.solvers.interior.newton_equations`). Steps follow Mehrotra's
predictor and corrector, then up to :data:`CORRECTORS` of Gondzio's centrality correctors, each of which costs one
back-substitution and stays only if it lengthens the step. The dilatancy used is :math:`\bar d = d + \theta(\mu - d)`:
theta = 0 is the problem itself, theta = 1 associated flow, which is convex; :mod:`concio.solvers.interior.homotopy`
walks from one to the other.

What the iteration returns is a point close to a solution, or nothing; the exact finish makes it exact.

References
----------
S. Mehrotra, On the implementation of a primal-dual interior point method, *SIAM J. Optim.* 2 (1992) 575-601.
J. Gondzio, Multiple centrality corrections in a primal-dual method for linear programming, *Comput. Optim. Appl.* 6
(1996) 137-156.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from concio.problem.contact_problem import Array
from concio.solvers.algebra.scaled import Scaled
from concio.solvers.algebra.sparse_factor import SingularMatrixError
from concio.solvers.interior.iterate import Iterate, Residuals
from concio.solvers.interior.newton_equations import Newton

START = 10.0
"""Size of slacks and multipliers at the start, in scaled units."""

BOUNDARY = 0.99
"""Share of the step to the boundary that is taken."""

CORRECTORS = 2
"""Largest number of centrality correctors of an iteration."""

FURTHER, GAIN = 0.1, 0.1
"""A corrector aims at a step longer by ``FURTHER`` and stays if it gains this share of that."""

OUTLIER = 10.0
"""Products this many times too large or too small are what centrality correctors correct."""

EARLY = "states hardly change"
"""Why a run ends whose caller finds its point good enough to be finished."""


@dataclass(frozen=True)
class Outcome:
    """How an interior-point run ended.

    Parameters
    ----------
    converged : bool
        Residual and complementarity below the target.
    iterations : int
    residual : float
        Largest residual or product, forces relative to the largest force and lengths to the largest displacement.
    why : str
        Why it ended: "converged", or what :class:`Stopping` says.
    """

    converged: bool
    iterations: int
    residual: float
    why: str


@dataclass
class Stopping:
    """When to give up a run: the rule and what it remembers.

    Parameters
    ----------
    most : int
        Largest number of iterations.
    """

    SHORT: ClassVar = (0.02, 8)
    """Steps below the first number, so many in a row: the path turns back."""
    PATIENCE: ClassVar = (25, 6)
    """Iterations without a tenth of progress: from afar, and once the residual was below :attr:`CLOSE`."""
    CLOSE: ClassVar = 1e-4
    WORSE: ClassVar = 1e2
    """A point that was close and whose residual then grows this much runs away."""

    most: int
    best: float = np.inf
    since: int = 0
    short: int = 0

    def improved(self, merit: float) -> bool:
        """Note the merit of an iterate; return whether it is the best by a tenth."""
        if merit < 0.9 * self.best:
            self.best, self.since = merit, 0
            return True
        self.since += 1
        return False

    def reason(self, iteration: int, merit: float, step: float) -> str:
        """Return why to stop before the next iteration; empty where there is none."""
        self.short = self.short + 1 if step < self.SHORT[0] else 0
        near = self.best < self.CLOSE
        if iteration == self.most:
            return "limit of iterations"
        if self.short >= self.SHORT[1]:
            return "steps became short"
        if near and merit > self.WORSE * self.best:
            return "ran away"
        return "no progress" if self.since >= self.PATIENCE[near] else ""


class InteriorPoint:
    """The iteration on one scaled problem; keeps the pattern and counts factorisations.

    Parameters
    ----------
    scaled : Scaled
    correctors : int
        Largest number of centrality correctors of an iteration.
    """

    def __init__(self, scaled: Scaled, correctors: int = CORRECTORS) -> None:
        self.problem, self.correctors = scaled, correctors
        rough, capped = scaled.rough, scaled.cone.capped
        self.used = np.array([np.ones(scaled.pairs, dtype=bool), rough, rough, capped]).astype(float)
        """One where a product of a pair is there, else zero, (4, m)."""
        self.cap = np.where(capped, scaled.cone.cap, 0.0)

    def start(self, size: float = START) -> Iterate:
        """Return the point from which the plain iteration starts: every slack and multiplier ``size``.

        Starting far outside (forces and gaps ten times the typical ones) halves the iterations near collapse.
        """
        s, cone = self.problem, self.problem.cone
        one = np.full(s.pairs, size)
        t_n = np.where(cone.capped, np.minimum(size, 0.5 * cone.cap), size)
        slack = np.where(s.rough, cone.strength(t_n), size)
        q = np.where(cone.capped, cone.cap - t_n, size)
        return Iterate(np.zeros(len(s.f)), 0 * one, np.array([t_n, slack, slack, q]), np.array([one] * 4))

    def gap(self, z: Iterate) -> float:
        """Return the mean complementarity product."""
        return float((z.products() * self.used).sum() / max(float(self.used.sum()), 1.0))

    def residuals(self, z: Iterate, theta: float) -> Residuals:
        """Return what the linear equations leave at a point."""
        s, (_, rough, _, capped) = self.problem, self.used
        t = z.t
        y = s.position(z.u, t)
        t_n, s_p, s_m, q = z.slack
        y_n, y_p, y_m, p = z.dual
        strength = s.cone.linear_strength(t_n)
        return Residuals(
            u=s.imbalance(z.u, t),
            n=y[:, 0] - self.dilatancy(theta) * (y_p + y_m) - y_n + capped * p,
            t=rough * (y[:, 1] - y_p + y_m),
            p=rough * (strength + z.t_t - s_p),
            m=rough * (strength - z.t_t - s_m),
            q=capped * (self.cap - t_n - q),
        )

    def dilatancy(self, theta: float) -> Array:
        """Return the dilatancy (m,) of the homotopy at ``theta``."""
        s = self.problem
        return np.where(s.rough, s.dilatancy + theta * (s.cone.friction - s.dilatancy), 0.0)

    def run(
        self,
        z: Iterate,
        *,
        theta: float = 0.0,
        target: float = 1e-9,
        most: int = 80,
        level: float = 0.0,
        watch: Callable[[int, float], bool | None] | None = None,
        ready: Callable[[Iterate, float], bool] | None = None,
    ) -> tuple[Iterate, Outcome]:
        """Iterate from ``z``; return the point reached, or the best met where it does not converge.

        Parameters
        ----------
        z : Iterate
        theta : float
            Share of associated flow.
        target : float
            Relative residual and mean product to reach.
        most : int
            Largest number of iterations.
        level : float
            Stop already at this mean product and residual (a point on the central path, for the homotopy).
        watch : callable, optional
            Called with (iteration, max of residual and product); true stops.
        ready : callable, optional
            Called with (point, max of residual and product); true stops before the target, as :data:`EARLY`.
        """
        stopping = Stopping(most)
        step, iteration, kept, why = 1.0, 0, z, ""
        while True:
            rest, gap = self.residuals(z, theta), self.gap(z)
            residual, typical = rest.size(*z.size()), z.typical_product()
            merit = max(residual, gap / typical)
            if not np.isfinite(merit):
                why = "numbers ran over"
                break
            if stopping.improved(merit):
                kept = z
            if merit < target or (level and gap < level and residual < 1e-6):
                return z, Outcome(True, iteration, residual, "converged")
            if watch is not None and watch(iteration, merit):
                why = "asked to"
                break
            if ready is not None and ready(z, merit):
                return z, Outcome(False, iteration, merit, EARLY)
            why = stopping.reason(iteration, merit, step)
            if why:
                break
            try:
                newton = Newton(self.problem, z, rest, self.dilatancy(theta), self.used)
            except SingularMatrixError:
                why = "no direction"
                break
            floor = max(0.3 * level, 0.03 * target * typical)
            d, step = self._direction(newton, z, gap, floor)
            z = z.moved(d, step)
            iteration += 1
        return kept, Outcome(False, iteration, stopping.best, why)

    def _direction(self, newton: Newton, z: Iterate, gap: float, floor: float) -> tuple[Iterate, float]:
        """Return direction and step: predictor, corrector, centrality correctors; ``floor`` is the least target."""
        products = z.products()
        d = newton.direction(-products)
        step = z.longest(d)
        predicted = self.gap(z.moved(d, step))
        centring = min(1.0, max((predicted / gap) ** 3, 1e-4)) if step > 0.05 else 0.5
        tau = max(centring * gap, floor)
        change = tau - products - step * d.products()
        d = newton.direction(change)
        step = z.longest(d, BOUNDARY)
        for _ in range(self.correctors):
            if step > 1.0 - FURTHER:
                break
            there = z.moved(d, min(1.0, step + FURTHER)).products()
            pull = np.clip(there, tau / OUTLIER, tau * OUTLIER) - there
            trial = change + self.used * np.maximum(pull, -OUTLIER * tau)
            other = newton.direction(trial)
            longer = z.longest(other, BOUNDARY)
            if longer < step + GAIN * FURTHER:
                break
            d, step, change = other, longer, trial
        return d, step
