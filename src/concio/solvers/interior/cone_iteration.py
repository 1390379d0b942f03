r"""Primal-dual interior point on the Coulomb problem with round cones, non-monotone as it is.

With the shifted forces of a pair, :math:`t_n \ge 0` and :math:`\beta = (c + \mu t_n, t_t)`, and with its gap and
:math:`\eta = (\sigma, y_t)`, sigma a bound on the size of slip,

.. math::

    K u - f - C^T t &= 0, & y_n &= x_n + C_n u + a_n t_n - \bar d\,\sigma + p, &
    y_t &= C_t u - s + a_t t_t, \\
    t_n y_n &= \tau, & \beta \circ \eta &= 2\tau e, & q\,p &= \tau, \quad q = N - t_n,

beta and eta inside the second-order cone, o the Jordan product of :mod:`concio.solvers.algebra.second_order_cone`. In
the limit tau = 0, sigma = |y_t| and t_t = -(c + mu t_n) y_t / |y_t|, or y_t = 0. In the plane this is
s+ y+ = s- y- = tau, the iteration of :mod:`concio.solvers.interior.interior_point`.

Newton's equations with the scaling of Nesterov and Todd are, pair by pair, d eta = q - M d beta and H dt = b - C du
with

.. math::

    H = \begin{bmatrix} y_n/t_n + a_n + p/q + \bar d \mu M_{00} & \bar d M_{0t} \\ \mu M_{t0} & M_{tt} + a_t
    \end{bmatrix}, \qquad
    b = \begin{bmatrix} r_{cn}/t_n - r_n + \bar d q_0 - r_{cq}/q \\ q_t - r_t \end{bmatrix},

and (K + C'DC) du = -r_u + C'D b, D = H^{-1}, is what is left: blocks of d x d, not symmetric, one fixed pattern. The
dilatancy used is :math:`\bar d = d + \theta(\mu - d)`; theta = 1 is associated flow, which is convex.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace

import numpy as np

from concio.problem.contact_problem import Array
from concio.solvers.algebra.scaled import Scaled
from concio.solvers.algebra.second_order_cone import Scaling, product, reach, times
from concio.solvers.algebra.sparse_factor import SingularMatrixError

PROXIMAL = 1e-10
"""Weight of the proximal term that keeps bodies which nothing holds where they are."""

SHARE = 0.99
"""Share of the step to the boundary that is taken."""

REFINEMENTS = 6
"""Largest number of times a direction is refined against the equations it was eliminated from."""


@dataclass
class ConePoint:
    """A point strictly inside every cone.

    Parameters
    ----------
    u : (N,) array
    t : (m, d) array
        Shifted forces, normal first.
    y_n : (m,) array
    eta : (m, d) array
        sigma and y_t.
    p : (m,) array
        Crushing of capped pairs; one elsewhere.
    """

    u: Array
    t: Array
    y_n: Array
    eta: Array
    p: Array

    def copy(self) -> ConePoint:
        """Return a copy that shares nothing."""
        return replace(self, **{f.name: getattr(self, f.name).copy() for f in fields(self)})

    def move(self, d: ConePoint, step: float) -> None:
        """Go ``step`` along a direction."""
        for f in fields(self):
            setattr(self, f.name, getattr(self, f.name) + step * getattr(d, f.name))

    def become(self, other: ConePoint) -> None:
        """Take over the arrays of another point."""
        for f in fields(self):
            setattr(self, f.name, getattr(other, f.name))


@dataclass(frozen=True)
class Outcome:
    """How a run ended.

    Parameters
    ----------
    converged : bool
        Residuals and products below the target.
    iterations : int
    merit : float
        Largest of the residuals and the mean product, relative: the least met.
    """

    converged: bool
    iterations: int
    merit: float


@dataclass(frozen=True, eq=False)
class Residuals:
    """What Newton's equations have to bring to zero, and the sizes it is measured by."""

    u: Array
    n: Array
    t: Array
    force: float
    length: float

    @property
    def worst(self) -> float:
        """Largest entry, forces over the largest force, lengths over the largest displacement."""
        return max(
            float(np.abs(self.u).max(initial=0.0)) / self.force,
            float(np.abs(self.n).max(initial=0.0)) / self.length,
            float(np.abs(self.t).max(initial=0.0)) / self.length,
        )


class ConeIteration:
    """The iteration on one problem; keeps the pattern and counts factorisations.

    Parameters
    ----------
    scaled : Scaled
    """

    def __init__(self, scaled: Scaled) -> None:
        self.s = scaled
        self.capped, self.rough = scaled.cone.capped, scaled.cone.rough
        self.cap = np.where(self.capped, scaled.cone.cap, 0.0)
        self.products = scaled.pairs + 2 * int(self.rough.sum()) + int(self.capped.sum())

    def start(self, force: float, length: float) -> ConePoint:
        """Return a point far outside: every force ``force``, every gap and slip bound ``length``, no friction."""
        s = self.s
        t, eta = np.zeros_like(s.x), np.zeros_like(s.x)
        t[:, 0] = np.where(self.capped, np.minimum(force, 0.5 * s.cone.cap), force)
        eta[:, 0] = length
        one = np.full(s.pairs, length)
        return ConePoint(np.zeros(len(s.f)), t, one, eta, one.copy())

    def dilatancy(self, theta: float) -> Array:
        """Return the dilatancy (m,) at a share ``theta`` of associated flow."""
        s = self.s
        return np.where(self.rough, s.dilatancy + theta * (self.s.cone.friction - s.dilatancy), 0.0)

    def strength(self, z: ConePoint) -> Array:
        """Return beta (m, d), (1, 0) where a pair is smooth."""
        beta = z.t.copy()
        beta[:, 0] = self.s.cone.linear_strength(z.t[:, 0])
        beta[~self.rough] = 0.0
        beta[~self.rough, 0] = 1.0
        return beta

    def room(self, z: ConePoint) -> Array:
        """Return what is left to the cap, N - t_n (m,); one where there is none."""
        return np.where(self.capped, self.cap - z.t[:, 0], 1.0)

    def gap(self, z: ConePoint, beta: Array, room: Array) -> float:
        """Return the mean complementarity product."""
        total = float((z.t[:, 0] * z.y_n).sum() + (beta * z.eta)[self.rough].sum() + (room * z.p)[self.capped].sum())
        return total / max(self.products, 1)

    def residuals(self, z: ConePoint, dilatancy: Array) -> Residuals:
        """Return the residuals of equilibrium, gap and slip."""
        s = self.s
        y = s.position(z.u, z.t)
        r_n = y[:, 0] - dilatancy * z.eta[:, 0] - z.y_n + np.where(self.capped, z.p, 0.0)
        r_t = np.where(self.rough[:, None], y[:, 1:] - z.eta[:, 1:], 0.0)
        force, length = max(1.0, float(z.t[:, 0].max(initial=0.0))), max(1.0, float(np.abs(z.u).max(initial=0.0)))
        return Residuals(s.imbalance(z.u, z.t), r_n, r_t, force, length)

    def run(
        self,
        z: ConePoint,
        *,
        theta: float = 0.0,
        target: float = 1e-9,
        most: int = 100,
        share: float = SHARE,
        level: float = 0.0,
        watch: Callable[[int, float], bool | None] | None = None,
    ) -> Outcome:
        """Iterate in place from ``z``.

        Parameters
        ----------
        z : ConePoint
            Changed in place; where the run does not converge, the best point met is put back.
        theta : float
            Share of associated flow.
        target : float
            Relative residual and mean product to reach.
        most : int
            Largest number of iterations.
        share : float
            Share of the step to the boundary that is taken.
        level : float
            Stop already at this mean product with small residuals: a point on the central path, for a homotopy.
        watch : callable, optional
            Called with (iteration, merit); true stops.
        """
        dilatancy = self.dilatancy(theta)
        step, short, best, since, kept, iteration = 1.0, 0, np.inf, 0, z.copy(), 0
        for iteration in range(most + 1):
            beta, room = self.strength(z), self.room(z)
            r = self.residuals(z, dilatancy)
            gap = self.gap(z, beta, room)
            typical = max(1.0, float(z.t[:, 0].mean())) * max(1.0, float((z.y_n + z.eta[:, 0]).mean()))
            merit = max(r.worst, gap / typical)
            if not np.isfinite(merit):
                break
            since = 0 if merit < 0.9 * best else since + 1
            if since == 0:
                best, kept = merit, z.copy()
            if merit < target or (level and gap < level and r.worst < 1e-6):
                return Outcome(True, iteration, merit)
            if watch is not None and watch(iteration, merit):
                break
            short = short + 1 if step < 0.02 else 0
            lost = best < 1e-4 and (merit > 1e2 * best or since >= 6)
            if iteration == most or short >= 8 or since >= 25 or lost:
                break
            newton = NewtonStep.at(self, z, beta, room, r, dilatancy)
            if newton is None:
                break
            found = newton.mehrotra(gap, max(0.3 * level, 0.03 * target * typical), share, merit)
            if found is None:
                break
            direction, step = found
            z.move(direction, step)
        z.become(kept)
        return Outcome(False, iteration, best)


@dataclass(frozen=True, eq=False)
class NewtonStep:
    """Newton's equations at one point, factorised.

    Parameters
    ----------
    iteration : ConeIteration
    z : ConePoint
    beta, room : arrays
        Strengths and room to the cap at z.
    residuals : Residuals
    dilatancy : (m,) array
    scaling : Scaling
    H, D : (m, d, d) arrays
    """

    iteration: ConeIteration
    z: ConePoint
    beta: Array
    room: Array
    residuals: Residuals
    dilatancy: Array
    scaling: Scaling
    H: Array
    D: Array

    @classmethod
    def at(
        cls, iteration: ConeIteration, z: ConePoint, beta: Array, room: Array, residuals: Residuals, dilatancy: Array
    ) -> NewtonStep | None:
        """Scale and factorise; None where the numbers do not allow it."""
        s, rough = iteration.s, iteration.rough
        scaling = Scaling.of(beta, z.eta)
        if scaling is None:
            return None
        M, mu = scaling.M, s.cone.friction
        H = np.empty_like(M)
        H[:, 0, 0] = z.y_n / z.t[:, 0] + s.compliance[:, 0] + np.where(iteration.capped, z.p / room, 0.0)
        H[:, 0, 0] += dilatancy * mu * M[:, 0, 0]
        H[:, 0, 1:] = dilatancy[:, None] * M[:, 0, 1:]
        H[:, 1:, 0] = mu[:, None] * M[:, 1:, 0]
        H[:, 1:, 1:] = M[:, 1:, 1:]
        for k in range(1, s.dim):
            H[:, k, k] += s.compliance[:, k]
        smooth = ~rough
        H[smooth, 1:, :] = 0.0
        H[smooth, 1:, 1:] = np.eye(s.dim - 1)
        try:
            D = np.linalg.inv(H)
            D[smooth, 1:, 1:] = 0.0
            s.factor.factorise(D, PROXIMAL)
        except (SingularMatrixError, np.linalg.LinAlgError):
            return None
        return cls(iteration, z, beta, room, residuals, dilatancy, scaling, H, D)

    def solve(self, r: Array, b: Array, enough: float) -> tuple[Array, Array] | None:
        """Return (du, dt) of K du - C'dt = r, C du + H dt = b, refined in this form to ``enough``; None if it fails."""
        s, rough = self.iteration.s, self.iteration.rough
        du, dt = np.zeros_like(self.z.u), np.zeros_like(self.z.t)
        e1, e2, least = r, b, np.inf
        kept: tuple[Array, Array] | None = None
        for _ in range(REFINEMENTS):
            pushed = times(self.D, e2)
            x = s.factor.solve(e1 + s.pull(pushed))
            du, dt = du + x, dt + pushed - times(self.D, s.along(x))
            e1 = r - s.elastic(du) + s.pull(dt)
            e2 = b - s.along(du) - times(self.H, dt)
            e2[~rough, 1:] = 0.0
            worst = max(float(np.abs(e1).max()), float(np.abs(e2).max(initial=0.0)) / self.residuals.length)
            if not worst < 0.5 * least:
                break
            least, kept = worst, (du, dt)
            if worst < enough:
                break
        return kept

    def direction(self, rc_n: Array, rc_t: Array, rc_q: Array, enough: float) -> ConePoint | None:
        """Return the Newton direction for given right-hand sides of the products."""
        it, z, r = self.iteration, self.z, self.residuals
        rough, capped = it.rough, it.capped
        q = self.scaling.corrector(rc_t)
        q[~rough] = 0.0
        pressed = np.where(capped, rc_q / self.room, 0.0)
        b = np.empty_like(q)
        b[:, 0] = rc_n / z.t[:, 0] - r.n + self.dilatancy * q[:, 0] - pressed
        b[:, 1:] = np.where(rough[:, None], q[:, 1:] - r.t, 0.0)
        found = self.solve(-r.u, b, enough)
        if found is None:
            return None
        du, dt = found
        d_eta = q - times(self.scaling.M, self.of_strength(dt))
        d_eta[~rough] = 0.0
        dp = np.where(capped, pressed + z.p / self.room * dt[:, 0], 0.0)
        return ConePoint(du, dt, (rc_n - z.y_n * dt[:, 0]) / z.t[:, 0], d_eta, dp)

    def of_strength(self, dt: Array) -> Array:
        """Return d beta (m, d)."""
        d_beta = dt.copy()
        d_beta[:, 0] *= self.iteration.s.cone.friction
        d_beta[~self.iteration.rough] = 0.0
        return d_beta

    def longest(self, d: ConePoint, share: float) -> float:
        """Return the longest step up to one that stays inside, times ``share``."""
        z, d_beta = self.z, self.of_strength(d.t)
        alpha = min(reach(self.beta, d_beta), reach(z.eta, d.eta))
        capped = self.iteration.capped
        room = np.where(capped, -d.t[:, 0], 0.0)
        for x, dx in ((z.t[:, 0], d.t[:, 0]), (z.y_n, d.y_n), (z.p, d.p), (self.room, room)):
            down = dx < 0
            alpha = min(alpha, float(np.min(-x[down] / dx[down], initial=np.inf)))
        return min(1.0, share * alpha)

    def mehrotra(self, gap: float, least: float, share: float, merit: float) -> tuple[ConePoint, float] | None:
        """Return the direction after prediction and correction, and the step to take."""
        it, z, scaling = self.iteration, self.z, self.scaling
        t_n, point = z.t[:, 0], scaling.point
        enough = 1e-3 * min(merit, 1e-6)
        d = self.direction(-t_n * z.y_n, -product(point, point), -self.room * z.p, enough)
        if d is None:
            return None
        a = self.longest(d, 1.0)
        d_beta = self.of_strength(d.t)
        moved = replace(z, u=z.u, t=z.t + a * d.t, y_n=z.y_n + a * d.y_n, eta=z.eta + a * d.eta, p=z.p + a * d.p)
        after = it.gap(moved, self.beta + a * d_beta, self.room - np.where(it.capped, a * d.t[:, 0], 0.0))
        centring = min(1.0, max((after / gap) ** 3, 1e-4)) if a > 0.05 else 0.5
        tau = max(centring * gap, least)
        rc_t = -product(point, point) - product(times(scaling.W, d.eta), times(scaling.inverse, d_beta))
        rc_t[:, 0] += 2.0 * tau
        d = self.direction(
            tau - t_n * z.y_n - d.t[:, 0] * d.y_n, rc_t, tau - self.room * z.p + d.t[:, 0] * d.p, enough
        )
        return None if d is None else (d, self.longest(d, share))
