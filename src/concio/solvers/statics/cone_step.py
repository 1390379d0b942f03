"""One step of the interior point on a cone programme of statics: Newton's equations, predictor and corrector.

Where the digits are kept is explained in :mod:`concio.solvers.statics.cone_interior`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from concio.problem.contact_problem import Array
from concio.solvers.algebra.second_order_cone import Scaling, divide, dotted, product, times
from concio.solvers.algebra.sparse_factor import SingularMatrixError
from concio.solvers.statics.cone_programme import ConeProgramme, Point

SHARE = 0.99
"""Share of the step to the boundary that is taken."""

PROXIMAL = 1e-12
"""Stiffness that keeps motions which no pair resists where they are, relative to a typical one; refined away."""

LOST = 1e-11
"""Residual of a refined direction, relative to the largest force, above which the condensed matrix has lost it."""

PREDICTED, ROUNDED = 1e-8, 1e-15
"""Residual of a predictor and of a corrector, relative to the largest force, at which they are not refined further."""

PIVOTED = 60_000
"""Largest number of force components for which the system is then solved as a whole, with pivoting."""

REFINEMENTS = 6
"""Largest number of times a direction is refined."""


@dataclass(frozen=True, eq=False)
class Step:
    """Newton's equations at one point, factorised.

    Parameters
    ----------
    it : ConeProgramme
    p : Point
    g : (r,) array
        Load whose multiplier is sought.
    rest : ((r,) array, (m, d) array, float)
        Residuals of balance, of Cv = G'z and of g'v = 1.
    beta : (m, d) array
        Strengths.
    scaling : Scaling
        Of Nesterov and Todd.
    F, squeeze : (m, d, d) array, (m, d) array
        See :func:`_roots`; no entries of the second where nothing is squeezed.
    border : (r,) array
        The solution of C'DC x = g; empty where the condensed matrix has lost its digits.
    """

    it: ConeProgramme
    p: Point
    g: Array
    rest: tuple[Array, Array, float]
    beta: Array
    scaling: Scaling
    F: Array
    squeeze: Array
    border: Array

    @cached_property
    def Ft(self) -> Array:
        """F' (m, d, d)."""
        return self.F.transpose(0, 2, 1)

    @classmethod
    def at(cls, it: ConeProgramme, p: Point, g: Array, r_p: Array, r_d: Array, r_g: float) -> Step | None:
        """Return the equations at a point; None where it has left the cones."""
        beta = it.strength(p.t)
        scaling = Scaling.of(beta, p.eta)
        if scaling is None:
            return None
        F, squeeze = _roots(it, p, scaling)
        D = np.matmul(F, F.transpose(0, 2, 1))
        border = np.zeros(0)
        if not it.degenerate:
            try:
                it.factor.factorise(D, PROXIMAL * min(1.0, float(np.median(D[:, 0, 0]))))
                border = it.factor.solve(g)
            except SingularMatrixError:
                if not it.pivoting:
                    return None
                it.degenerate = True
        return cls(it, p, g, (r_p, r_d, r_g), beta, scaling, F, squeeze, border)

    def increments(self, b: Array, enough: float) -> tuple[Array, float, Array] | None:
        """Return (dt, d lambda, dv) of C'dt + g d lambda = -r_p, F'C dv + F^-1 dt = b, g'dv = r_g, refined so.

        No refinement is made at residuals below ``enough``.
        """
        it, g = self.it, self.g
        r_p, _, r_g = self.rest
        dx, dv, dl = np.zeros_like(b), np.zeros_like(g), 0.0
        kept: tuple[Array, float, Array] | None = None
        e1, e2, e3, least = -r_p, b, r_g, np.inf
        solver = self._pivoted if it.degenerate else self._condensed
        while True:
            least = np.inf
            for _ in range(REFINEMENTS):
                x, y, extra = solver(e1, e2, e3)
                trial = dx + y, dv + x, dl + extra
                dt = times(self.F, trial[0])
                left = (
                    -r_p - it.pull(dt) - g * trial[2],
                    b - times(self.Ft, it.rate(trial[1])) - trial[0],
                    r_g - float(g @ trial[1]),
                )
                worst = max(float(np.abs(left[0]).max()), float(np.abs(left[1]).max(initial=0.0)), abs(left[2]))
                if not worst < 0.5 * least:
                    break
                (dx, dv, dl), (e1, e2, e3) = trial, left
                least, kept = worst, (dt, dl, dv)
                if worst < enough:
                    break
            lost = not least < max(enough, LOST * max(1.0, float(np.abs(self.p.t).max())))
            if it.degenerate or not (lost and it.pivoting) or dx.size > PIVOTED:
                return kept
            it.degenerate, solver = True, self._pivoted
            dx, dv, dl = np.zeros_like(b), np.zeros_like(g), 0.0
            e1, e2, e3, kept = -r_p, b, r_g, None

    def _condensed(self, e1: Array, e2: Array, e3: float) -> tuple[Array, Array, float]:
        """Solve by C'DC, the multiplier bordered: digits are lost where that matrix is worse than 1e16."""
        it, g = self.it, self.g
        x = it.factor.solve(it.pull(times(self.F, e2)) - e1)
        across = float(g @ self.border)
        extra = (e3 - float(g @ x)) / across if across else np.nan  # digits are lost: pivoting takes over
        x += extra * self.border
        return x, e2 - times(self.Ft, it.rate(x)), extra

    @cached_property
    def _mixed(self) -> Any:
        """Factors with pivoting of the system in dx, dv and the multiplier, whose condition is the square root."""
        try:
            return self.it.mixed.factors(self.F, self.g, PROXIMAL)
        except RuntimeError:
            return None

    def _pivoted(self, e1: Array, e2: Array, e3: float) -> tuple[Array, Array, float]:
        """Solve the whole system with pivoting."""
        n = e2.size
        right = np.concatenate([e2.ravel(), e1, [e3]])
        x = np.full(right.size, np.nan) if self._mixed is None else self._mixed.solve(right)
        return x[n:-1], x[:n].reshape(e2.shape), float(x[-1])

    def direction(self, rc_z: Array, rc_t: Array, rc_w: Array, enough: float = ROUNDED) -> Point | None:
        """Return the Newton direction for given right-hand sides of the products, refined to a residual ``enough``."""
        it, p = self.it, self.p
        both, tresca, t_n = it.coulomb, it.tresca, p.t[:, 0]
        scaled = divide(self.scaling.point, rc_t)
        rest = -self.rest[1]
        of_line = of_cap = room = np.zeros(0)
        if it.has_lines:
            of_line = np.where(it.line, rc_z / t_n, 0.0)
            rest[:, 0] += of_line
        if it.has_caps:
            room = np.where(it.capped, it.cap - t_n, 1.0)
            of_cap = np.where(it.capped, rc_w / room, 0.0)
            rest[:, 0] -= of_cap
        eta = np.zeros(0)
        if it.has_tresca:
            eta = times(self.scaling.inverse, scaled)
            rest[tresca, 1:] += eta[tresca, 1:]
        # where F = G^-1 W squeeze, F'G' eta is taken from its scaled value, which loses nothing
        b = times(self.Ft, rest)
        squeezed = scaled - self.squeeze * dotted(self.squeeze, scaled)[:, None] if self.squeeze.size else scaled
        b += squeezed if not it.has_tresca and it.all_rough else np.where(both[:, None], squeezed, 0.0)
        found = self.increments(b, enough)
        if found is None:
            return None
        dt, dl, dv = found
        dz = np.where(it.line, of_line - p.z / t_n * dt[:, 0], 0.0) if it.has_lines else np.zeros_like(p.z)
        dw = np.where(it.capped, of_cap + p.w / room * dt[:, 0], 0.0) if it.has_caps else np.zeros_like(p.w)
        # velocities follow from the motion, whose rounding is small; M d beta would cancel
        d_eta = it.rate(dv) + self.rest[1]
        moved_n = d_eta[:, 0].copy()
        d_eta[:, 0] = np.where(both, (moved_n - dz + dw) / np.where(both, it.mu, 1.0), 0.0)
        if it.has_tresca:
            d_eta[tresca, 0] = (eta - times(self.scaling.M, self.of_strength(dt)))[tresca, 0]
        if not it.all_rough:
            d_eta[~it.rough] = 0.0
            dz = np.where(it.rough, dz, moved_n + dw)
        return Point(dt, dl, dv, dz, d_eta, dw)

    def of_strength(self, dt: Array) -> Array:
        """Return d beta (m, d)."""
        d_beta = dt.copy()
        d_beta[:, 0] *= self.it.mu
        if not self.it.all_rough:
            d_beta[~self.it.rough] = 0.0
        return d_beta

    def longest(self, d: Point) -> tuple[float, float]:
        """Return the longest primal and dual steps up to one that stay inside."""
        it, p = self.it, self.p
        primal, dual = self.scaling.reaches(self.of_strength(d.t), d.eta)
        if it.has_lines:
            primal = min(primal, _line(p.t[it.line, 0], d.t[it.line, 0]))
            dual = min(dual, _line(p.z[it.line], d.z[it.line]))
        if it.has_caps:
            primal = min(primal, _line((it.cap - p.t[:, 0])[it.capped], -d.t[it.capped, 0]))
            dual = min(dual, _line(p.w[it.capped], d.w[it.capped]))
        return min(1.0, primal), min(1.0, dual)

    def mehrotra(self, gap: float) -> Point | None:
        """Return the next point."""
        it, p, point = self.it, self.p, self.scaling.point
        t_n, room = p.t[:, 0], it.cap - p.t[:, 0]
        force = max(1.0, float(np.abs(p.t).max()))
        squared = product(point, point)
        d = self.direction(-t_n * p.z, -squared, -room * p.w, PREDICTED * force)
        if d is None:
            return None
        a = self.longest(d)
        after = it.gap(p.moved(d, *a))
        tau = gap / it.count * min(1.0, max((after / gap) ** 3, 1e-6))
        d_beta = self.of_strength(d.t)
        rc_t = -squared - product(times(self.scaling.W, d.eta), times(self.scaling.inverse, d_beta))
        rc_t[:, 0] += 2.0 * tau
        more = tau - t_n * p.z - d.t[:, 0] * d.z, rc_t, tau - room * p.w + d.t[:, 0] * d.w
        d = self.direction(*more, ROUNDED * force)
        if d is None:
            return None
        primal, dual = self.longest(d)
        return p.moved(d, SHARE * primal, SHARE * dual)


def _roots(it: ConeProgramme, p: Point, scaling: Scaling) -> tuple[Array, Array]:
    """Return F (m, d, d) with F F' = (G'M G)^-1, and s (m, d) with F = G^-1 W (I - s s') for pairs with friction.

    From the scaling itself: inverting M would lose its small values.
    """
    d, both = it.pairs.dim, it.coulomb
    if not (it.has_lines or it.has_caps):
        F = scaling.W.copy()
        F[:, 0, :] /= it.mu[:, None]
        return F, np.zeros(0)
    own = np.where(it.line, p.z / p.t[:, 0], 0.0)
    if it.has_caps:
        own += np.where(it.capped, p.w / (it.cap - p.t[:, 0]), 0.0)
    F = np.zeros((it.pairs.count, d, d))
    F[both] = scaling.W[both]
    F[both, 0, :] /= it.mu[both, None]
    v = F[:, 0, :].copy()
    size = np.where(both, dotted(v, v), 1.0)
    less = (1.0 - 1.0 / np.sqrt(1.0 + own * size)) / size
    squeeze = np.where(both[:, None], np.sqrt(less)[:, None] * v, 0.0)
    F -= times(F, squeeze)[:, :, None] * squeeze[:, None, :]
    F[both, 0, :] = (v / np.sqrt(1.0 + own * size)[:, None])[both]  # the same, without cancellation at a cap
    F[~both, 0, 0] = 1.0 / np.sqrt(own[~both])
    if it.has_tresca:
        M = scaling.M[it.tresca, 1:, 1:]
        F[it.tresca, 1:, 1:] = np.linalg.inv(np.linalg.cholesky(M)).transpose(0, 2, 1)
    return F, squeeze


def _line(x: Array, dx: Array) -> float:
    """Return the step at which the first entry of x + step dx reaches zero."""
    down = dx < 0
    return float(np.min(-x[down] / dx[down], initial=np.inf))
