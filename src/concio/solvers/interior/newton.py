r"""Newton's equations of the interior point, those of each pair eliminated to a d x d matrix.

With the scaling of Nesterov and Todd they are, pair by pair, d eta = q - M d beta and H dt = b - C du with

.. math::

    H = \begin{bmatrix} y_n/t_n + a_n + p/q + \bar d \mu M_{00} & \bar d M_{0t} \\
        \mu M_{t0} & M_{tt} + a_t \end{bmatrix}, \qquad
    b = \begin{bmatrix} r_{cn}/t_n - r_n + \bar d q_0 - r_{cq}/q \\ q_t - r_t \end{bmatrix},

and (K + C'DC) du = -r_u + C'D b, D = H^{-1}, is what is left: blocks of d x d, not symmetric, one fixed pattern,
regular although K is singular. One factorisation for each point, one back-substitution for each right-hand side; in
space these are refined, as round cones make them less exact.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from concio.problem.contact_problem import Array
from concio.solvers.algebra.half_lines import HalfLines
from concio.solvers.algebra.scaled import LOOSE, Scaled
from concio.solvers.algebra.second_order_cone import Scaling, inverses, times
from concio.solvers.algebra.sparse_factor import SingularMatrixError
from concio.solvers.interior.point import CONE, Point, Residuals

REFINEMENTS = {2: 0, 3: 6}
"""Largest number of times a direction is refined against the equations it was eliminated from, by dimension."""


@dataclass(frozen=True, eq=False)
class Products:
    """The complementarity products of each pair, or a change of them.

    Parameters
    ----------
    n : (m,) array
        t_n y_n.
    t : (m, d) array
        beta o eta as the scaling sees it, in the coordinates of the cone.
    q : (m,) array or None
        Room to the cap times crushing; None where no pair is capped.
    """

    n: Array
    t: Array
    q: Array | None

    def scaled(self, factor: float) -> Products:
        """Return a multiple."""
        return Products(factor * self.n, factor * self.t, None if self.q is None else factor * self.q)

    def plus(self, other: Products, factor: float = 1.0) -> Products:
        """Return the sum with a multiple of others."""
        q = None if self.q is None or other.q is None else self.q + factor * other.q
        return Products(self.n + factor * other.n, self.t + factor * other.t, q)

    def towards(self, tau: float) -> Products:
        """Return the change that makes every product tau."""
        t = CONE[self.t.shape[1]].shifted(-self.t, 2.0 * tau)
        return Products(tau - self.n, t, None if self.q is None else tau - self.q)

    def outliers(self, tau: float, factor: float) -> Products:
        """Return the change that brings products within a factor of tau, large ones by ``factor`` tau at most."""

        def pulled(x: Array, one: float, clip: Callable[[Array, float, float], Array]) -> Array:
            return clip(clip(x, one / factor, one * factor) - x, -factor * one, np.inf)

        cone, line = CONE[self.t.shape[1]].clipped, HalfLines.clipped
        q = None if self.q is None else pulled(self.q, tau, line)
        return Products(pulled(self.n, tau, line), pulled(self.t, 2.0 * tau, cone), q)

    def total(self, s: Scaled) -> float:
        """Return the sum over all pairs of the products they have."""
        t = self.t[s.rough] if s.any_smooth else self.t
        total = float(self.n.sum()) + (0.5 * float(t.sum()) if s.dim == 2 else float(t[:, 0].sum()))
        return total if self.q is None else total + float(self.q[s.cone.capped].sum())


@dataclass(frozen=True, eq=False)
class Direction(Point):
    """A direction, and the change of products to first order that it was asked for.

    Parameters
    ----------
    change : Products
    beta : (m, d) array
        How beta changes, in the coordinates of the cone.
    """

    change: Products
    beta: Array


@dataclass(frozen=True, eq=False)
class NewtonStep:
    """Newton's equations at one point, factorised.

    Parameters
    ----------
    s : Scaled
    z : Point
    residuals : Residuals
    dilatancy : (m,) array
    scaling : Scaling or HalfLines
    H, D : (m, d, d) arrays
    products : Products
        At the point.
    enough : float
        Residual to which directions are refined.
    """

    s: Scaled
    z: Point
    residuals: Residuals
    dilatancy: Array
    scaling: Scaling | HalfLines
    H: Array
    D: Array
    products: Products
    enough: float

    @classmethod
    def at(cls, s: Scaled, z: Point, residuals: Residuals, dilatancy: Array, enough: float = 1e-9) -> NewtonStep | None:
        """Scale and factorise; None where the numbers do not allow it: the path turns back."""
        scaling = CONE[s.dim].of(residuals.beta, z.eta)
        if scaling is None:
            return None
        M, mu, capped = scaling.M, s.cone.friction, s.cone.capped
        H = M.copy()
        H[:, 0, 0] = z.y_n / z.t[:, 0] + s.compliance[:, 0] + dilatancy * mu * M[:, 0, 0]
        if s.any_capped:
            if not residuals.room[capped].min() > 0:  # rounded up to the cap
                return None
            H[capped, 0, 0] += (z.p / residuals.room)[capped]
        H[:, 0, 1:] *= dilatancy[:, None]
        H[:, 1:, 0] *= mu[:, None]
        for k in range(1, s.dim):
            H[:, k, k] += s.compliance[:, k]
        if s.any_smooth:
            H[~s.rough, 1:, :] = 0.0
            H[~s.rough, 1:, 1:] = np.eye(s.dim - 1)
        try:
            D = inverses(H)
            if s.any_smooth:
                D[~s.rough, 1:, 1:] = 0.0
            if not s.factor.has(D, LOOSE):  # it has where the plane iteration begins
                s.factor.factorise(D, LOOSE)
        except (SingularMatrixError, np.linalg.LinAlgError):
            return None
        products = Products(z.t[:, 0] * z.y_n, scaling.square, residuals.room * z.p if s.any_capped else None)
        return cls(s, z, residuals, dilatancy, scaling, H, D, products, enough)

    def increments(self, r: Array, b: Array) -> tuple[Array, Array] | None:
        """Return (du, dt) of K du - C'dt = r, C du + H dt = b; None if refinement fails."""
        s, pushed = self.s, times(self.D, b)
        du = s.factor.solve(r + s.pull(pushed))
        dt = pushed - times(self.D, s.along(du))
        return (du, dt) if not REFINEMENTS[s.dim] else self._refined(r, b, du, dt)

    def _refined(self, r: Array, b: Array, du: Array, dt: Array) -> tuple[Array, Array] | None:
        """Return a solution refined against the equations as they stand, until both are met to ``enough``."""
        s, least = self.s, np.inf
        kept: tuple[Array, Array] | None = None
        for left in range(REFINEMENTS[s.dim] - 1, -1, -1):
            e1 = r - s.elastic(du) + s.pull(dt)
            e2 = b - s.along(du) - times(self.H, dt)
            if s.any_smooth:
                e2[~s.rough, 1:] = 0.0
            worst = max(float(np.abs(e1).max(initial=0.0)), float(np.abs(e2).max(initial=0.0)) / self.residuals.length)
            if not worst < 0.5 * least:
                break
            least, kept = worst, (du, dt)
            if worst < self.enough or not left:
                break
            pushed = times(self.D, e2)
            x = s.factor.solve(e1 + s.pull(pushed))
            du, dt = du + x, dt + pushed - times(self.D, s.along(x))
        return kept

    def direction(self, change: Products) -> Direction | None:
        """Return the direction that changes the products by ``change`` to first order."""
        s, z, r = self.s, self.z, self.residuals
        cone = CONE[s.dim]
        corrector, rough = self.scaling.corrector(change.t), s.rough
        q, free = cone.vector(corrector), change.n / z.t[:, 0]
        if s.any_smooth:
            q[~rough] = 0.0
        b = np.empty_like(q)
        b[:, 0] = free - r.n + self.dilatancy * q[:, 0]
        b[:, 1:] = q[:, 1:] - r.t
        pressed = None if change.q is None else np.where(s.cone.capped, change.q / r.room, 0.0)
        if pressed is not None:
            b[:, 0] -= pressed
        found = self.increments(-r.u, b)
        if found is None:
            return None
        du, dt = found
        d_beta = dt.copy()
        d_beta[:, 0] *= s.cone.friction
        if s.any_smooth:
            d_beta[~rough] = 0.0
        d_beta = cone.coordinates(d_beta)
        d_eta = corrector - self.scaling.along(d_beta)
        if s.any_smooth:
            d_eta[~rough] = 0.0
        d_n = free - z.y_n / z.t[:, 0] * dt[:, 0]
        if pressed is None:
            d_p = np.zeros_like(d_n)
        else:
            d_p = np.where(s.cone.capped, pressed + z.p / r.room * dt[:, 0], 0.0)
        return Direction(du, dt, d_n, d_eta, d_p, change, d_beta)

    def second(self, d: Direction) -> Products:
        """Return what the products of a full step along a direction have of second order."""
        dt_n = d.t[:, 0]
        return Products(dt_n * d.y_n, self.scaling.second(d.eta, d.beta), -dt_n * d.p if self.s.any_capped else None)

    def longest(self, d: Direction, share: float = 1.0) -> float:
        """Return ``share`` of the longest step along d that stays inside, at most 1."""
        z, r, t_n = self.z, self.residuals, d.t[:, 0]
        steepest = min(float((t_n / z.t[:, 0]).min(initial=0.0)), float((d.y_n / z.y_n).min(initial=0.0)))
        if self.s.any_capped:
            down = np.where(self.s.cone.capped, t_n, 0.0) / r.room
            steepest = min(steepest, -float(down.max(initial=0.0)), float((d.p / z.p).min(initial=0.0)))
        farthest = -1.0 / steepest if steepest < 0 else np.inf
        return min(1.0, share * min(farthest, self.scaling.reach(d.beta, d.eta)))
