r"""Primal-dual interior point on the Coulomb problem, non-monotone as it is, in the plane and in space.

With the shifted forces of a pair, :math:`t_n \ge 0` and :math:`\beta = (c + \mu t_n, t_t)`, and with its gap and
:math:`\eta = (\sigma, y_t)`, sigma a bound on the size of slip,

.. math::

    K u - f - C^T t &= 0, & y_n &= x_n + C_n u + a_n t_n - \bar d\,\sigma + p, &
    y_t &= C_t u - s + a_t t_t, \\
    t_n y_n &= \tau, & \beta \circ \eta &= 2\tau e, & q\,p &= \tau, \quad q = N - t_n,

beta and eta inside the second-order cone, o the Jordan product of :mod:`concio.solvers.algebra.second_order_cone`. In
the limit tau = 0, sigma = |y_t| and t_t = -(c + mu t_n) y_t / |y_t|, or y_t = 0. In the plane the cone is a product of
two half-lines: with :math:`s^\pm = c + \mu t_n \pm t_t` and :math:`y^+ + y^- = \sigma`, :math:`y^+ - y^- = y_t` it
reads :math:`s^+ y^+ = s^- y^- = \tau`.

Each iteration solves Newton's equations (:mod:`concio.solvers.interior.newton`). Steps follow Mehrotra's predictor and
corrector, then in the plane up to two of Gondzio's centrality correctors, each of which costs one back-substitution and
stays only if it lengthens the step. The dilatancy used is :math:`\bar d = d + \theta(\mu - d)`: theta = 0 is the
problem itself, theta = 1 associated flow, which is convex; :mod:`concio.solvers.interior.homotopy` walks from one to
the other.

What the iteration returns is a point close to a solution, or nothing; the exact finish makes it exact.

References
----------
S. Mehrotra, On the implementation of a primal-dual interior point method, *SIAM J. Optim.* 2 (1992) 575-601.
J. Gondzio, Multiple centrality corrections in a primal-dual method for linear programming, *Comput. Optim. Appl.* 6
(1996) 137-156.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from concio.problem.contact_problem import Array
from concio.solvers.algebra.scaled import Scaled
from concio.solvers.interior.newton import Direction, NewtonStep
from concio.solvers.interior.point import CONE, Point, Residuals

START = 10.0
"""Size of forces, gaps and slips at the start, in scaled units."""

NEAR, WITHIN = 1.0, 0.1
"""How far inside the cones a run begins near a known state, in scaled units; so far at least from where pairs slide."""

SHARE = 0.99
"""Share of the step to the boundary that is taken."""

CORRECTORS = {2: 2, 3: 0}
"""Largest number of centrality correctors of an iteration, by dimension. In space they take some structures away that
are solved without (decision 0113)."""

DAMPED = {2: True, 3: False}
"""Whether the corrector counts the second order of the step that the predictor can go, or that of a full one."""

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
        Largest of the residuals and the mean product, relative: the least met where it did not converge.
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
    patient : bool
        False where a failure costs little, as the load step is then halved: the run ends earlier.
    """

    SHORT: ClassVar = (0.02, 8)
    """Steps below the first number, so many in a row: the path turns back."""
    PATIENCE: ClassVar = (25, 6)
    """Iterations without a tenth of progress: from afar, and once the residual was below :attr:`CLOSE`."""
    CLOSE: ClassVar = 1e-4
    WORSE: ClassVar = 1e2
    """A point that was close and whose residual then grows this much runs away."""
    ADVANCE: ClassVar = ((8, 0.15, 0.0), (5, 0.1, 3e-3))
    """So many steps that reduce the residuals by less than this share, while the residual is above the last number: a
    run without patience ends (decision 0500)."""

    most: int
    patient: bool = True
    best: float = np.inf
    since: int = 0
    short: int = 0
    left: list[float] = field(default_factory=list)

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
        self.left.append(1.0 - step)
        near = self.best < self.CLOSE
        if iteration == self.most:
            return "limit of iterations"
        if self.short >= self.SHORT[1] or self._hardly_advances():
            return "steps became short"
        if near and merit > self.WORSE * self.best:
            return "diverged"
        return "no progress" if self.since >= self.PATIENCE[near] else ""

    def _hardly_advances(self) -> bool:
        """Return whether the last steps of a run without patience were short together."""
        return not self.patient and any(
            len(self.left) > steps and self.best > far and 1.0 - float(np.prod(self.left[-steps:])) < least
            for steps, least, far in self.ADVANCE
        )


class InteriorPoint:
    """The iteration on one scaled problem; keeps the pattern and counts factorisations.

    Parameters
    ----------
    scaled : Scaled
    """

    def __init__(self, scaled: Scaled) -> None:
        self.problem = scaled
        self.correctors = CORRECTORS[scaled.dim]
        rough, capped = scaled.rough, scaled.cone.capped
        self.count = max(scaled.pairs + 2 * int(rough.sum()) + int(capped.sum()), 1)

    def start(self, force: float = START, length: float = START) -> Point:
        """Return a point far outside: every force ``force``, every gap and part of slip ``length``, no friction.

        Starting far outside (forces and gaps ten times the typical ones) halves the iterations near collapse. In the
        plane slip has two parts; and where both sizes are the same the first system is factorised already.
        """
        s = self.problem
        t, eta = np.zeros_like(s.x), np.zeros_like(s.x)
        t[:, 0] = np.where(s.cone.capped, np.minimum(force, 0.5 * s.cone.cap), force)
        eta[:, 0] = 2.0 * length if s.dim == 2 else length
        eta = CONE[s.dim].coordinates(eta)
        one = np.full(s.pairs, length)
        return Point(np.zeros(len(s.f)), t, one, eta, one.copy())

    def near(self, u: Array, t: Array) -> Point:
        """Return a point inside the cones around displacements (N,) and forces (m, d) that obey the joint laws nearly.

        Normal forces, gaps and slip bounds are larger by :data:`NEAR`, but so far from the cap, or half of it; friction
        is no larger than its strength was, and below what it is.
        """
        s = self.problem
        y, t_n, pull = s.position(u, t), np.maximum(t[:, 0], 0.0), np.linalg.norm(t[:, 1:], axis=1)
        before = s.cone.linear_strength(np.minimum(t_n, s.cone.cap))
        t_n = np.minimum(t_n + NEAR, s.cone.cap - np.minimum(NEAR, 0.5 * s.cone.cap))
        strength = s.cone.linear_strength(t_n)
        strength = np.minimum(before, strength - np.minimum(WITHIN, 0.5 * strength))
        kept = np.minimum(1.0, strength / np.where(pull > 0, pull, 1.0))
        eta = y.copy()
        eta[:, 0] = np.linalg.norm(y[:, 1:], axis=1) + NEAR
        return Point(
            u,
            np.column_stack([t_n, kept[:, None] * t[:, 1:]]),
            np.maximum(y[:, 0], 0.0) + NEAR,
            CONE[s.dim].coordinates(eta),
            np.full(s.pairs, NEAR),
        )

    def dilatancy(self, theta: float) -> Array:
        """Return the dilatancy (m,) of the homotopy at ``theta``."""
        s = self.problem
        return np.where(s.rough, s.dilatancy + theta * (s.cone.friction - s.dilatancy), 0.0)

    def run(
        self,
        z: Point,
        *,
        theta: float = 0.0,
        target: float = 1e-9,
        most: int = 100,
        share: float = SHARE,
        level: float = 0.0,
        patient: bool = True,
        watch: Callable[[int, float], bool | None] | None = None,
        ready: Callable[[Point, float], bool] | None = None,
    ) -> tuple[Point, Outcome]:
        """Iterate from ``z``; return the point reached, or the best met where it does not converge.

        Parameters
        ----------
        z : Point
        theta : float
            Share of associated flow.
        target : float
            Relative residual and mean product to reach.
        most : int
            Largest number of iterations.
        share : float
            Share of the step to the boundary that is taken.
        level : float
            Stop already at this mean product with small residuals (a point on the central path, for the homotopy).
        patient : bool
            False where a failure costs little: the run ends earlier.
        watch : callable, optional
            Called with (iteration, max of residual and product); true stops.
        ready : callable, optional
            Called with (point, max of residual and product); true stops before the target, as :data:`EARLY`.
        """
        stopping, dilatancy = Stopping(most, patient), self.dilatancy(theta)
        step, iteration, kept, why = 1.0, 0, z, ""
        while True:
            residuals = Residuals.of(self.problem, z, dilatancy)
            gap, typical = residuals.total / self.count, residuals.typical
            residual = residuals.worst
            merit = max(residual, gap / typical)
            if not np.isfinite(merit):
                why = "overflow"
                break
            if stopping.improved(merit):
                kept = z
            if merit < target or (level and gap < level and residual < 1e-6):
                return z, Outcome(True, iteration, merit, "converged")
            if watch is not None and watch(iteration, merit):
                why = "asked to"
                break
            if ready is not None and ready(z, merit):
                return z, Outcome(False, iteration, merit, EARLY)
            why = stopping.reason(iteration, merit, step)
            if why:
                break
            newton = NewtonStep.at(self.problem, z, residuals, dilatancy, 1e-3 * min(merit, 1e-6))
            floor = max(0.3 * level, 0.03 * target * typical)
            found = None if newton is None else self._direction(newton, floor, share)
            if found is None:
                why = "no direction"
                break
            direction, step = found
            z = z.moved(direction, step)
            iteration += 1
        return kept, Outcome(False, iteration, stopping.best, why)

    def _direction(self, newton: NewtonStep, floor: float, share: float) -> tuple[Direction, float] | None:
        """Return direction and step: predictor, corrector, centrality correctors; ``floor`` is the least target."""
        products = newton.products
        gap = products.total(newton.s) / self.count
        d = newton.direction(products.scaled(-1.0))
        if d is None:
            return None
        step = newton.longest(d)
        second = newton.second(d)
        after = gap + (step * (d.change.total(newton.s)) + step**2 * second.total(newton.s)) / self.count
        centring = min(1.0, max((after / gap) ** 3, 1e-4)) if step > 0.05 else 0.5
        tau = max(centring * gap, floor)
        change = products.towards(tau).plus(second, -step if DAMPED[newton.s.dim] else -1.0)
        d = newton.direction(change)
        if d is None:
            return None
        step = newton.longest(d, share)
        for _ in range(self.correctors):
            if step > 1.0 - FURTHER:
                break
            further = min(1.0, step + FURTHER)
            there = products.plus(d.change, further).plus(newton.second(d), further**2)
            other = newton.direction(d.change.plus(there.outliers(tau, OUTLIER)))
            longer = 0.0 if other is None else newton.longest(other, share)
            if other is None or longer < step + GAIN * FURTHER:
                break
            d, step = other, longer
        return d, step
