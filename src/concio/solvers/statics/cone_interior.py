r"""Interior point for the second-order cone programmes of statics, on the graph of the blocks.

The largest multiplier of a load under which forces inside the cones are in balance,

.. math:: \max \lambda, \qquad C^T t + e + \lambda g = 0, \qquad
          t_n \ge 0,\ t_n \le N,\ \beta = (c + \mu t_n, t_t) \in Q,

and its dual, the motion v of least :math:`h(Cv) - e^T v` with g'v = 1. C holds the velocities of the pairs in rigid
motions of the blocks, d rows for each pair. With slacks s = G t + h in a product of half-lines and second-order cones,
multipliers z in the same and the scaling of Nesterov and Todd, Mehrotra's predictor and corrector leave in each step

.. math:: \begin{bmatrix} C^T D C & -g \\ g^T & 0 \end{bmatrix}, \qquad D = (G^T M G)^{-1} \ (d \times d \text{ a pair}),

symmetric, of the pattern of the blocks' graph, ordered once. The multipliers of an iterate lie strictly inside their
cones, so the motion is admissible to rounding as soon as Cv = G'z holds; what forces and motion prove is for the caller
to recompute from the original data.

Reference: Alizadeh and Goldfarb, Second-order cone programming, Math. Programming 95 (2003), 3-51.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace

import numpy as np
import scipy.sparse as sp

from concio.problem.contact_problem import Array
from concio.solvers.algebra.block_factor import BlockFactor
from concio.solvers.algebra.sparse_factor import SingularMatrixError
from concio.solvers.algebra.second_order_cone import Scaling, divide, product, reach, times

START = 3.0
"""Size of slacks and multipliers at the start, the largest load on a block being one."""

TARGET = 1e-11
"""Residuals and relative gap at which the iteration ends."""

MOST = 120
"""Largest number of iterations."""

PATIENCE = 15
"""Iterations without progress after which the best point met is returned."""

SHARE = 0.99
"""Share of the step to the boundary that is taken."""

PROXIMAL = 1e-12
"""Stiffness that keeps motions which no pair resists where they are, relative to a typical one; refined away."""

REFINEMENTS = 6
"""Largest number of times a direction is refined."""


@dataclass(frozen=True, eq=False)
class Cones:
    """Pairs of a cone programme.

    Parameters
    ----------
    C : (m d, r) CSR array
        Velocities of the pairs, d rows for each.
    mu, cohesion, cap : (m,) arrays
        Strengths of forces shifted so that t_n >= 0; ``cap`` may be inf.
    rough : (m,) boolean array
        Pairs that carry friction.
    bodies : (B+1,) integer array
        Motions of block k are ``bodies[k]:bodies[k+1]``.
    """

    C: sp.csr_array
    mu: Array
    cohesion: Array
    cap: Array
    rough: Array
    bodies: Array

    @property
    def pairs(self) -> int:
        """Number m of pairs."""
        return len(self.mu)

    @property
    def dim(self) -> int:
        """Space dimension d."""
        return self.C.shape[0] // max(self.pairs, 1)


@dataclass(frozen=True, eq=False)
class ConeAnswer:
    """A point of the programme.

    Parameters
    ----------
    t : (m, d) array
        Shifted forces.
    multiplier : float
    v : (r,) array
        Motion.
    primal, dual, gap : float
        Largest residual of balance, of Cv = G'z and g'v = 1, and the relative duality gap.
    iterations : int
    """

    t: Array
    multiplier: float
    v: Array
    primal: float
    dual: float
    gap: float
    iterations: int


@dataclass
class _Point:
    """Forces, multiplier, motion and the three groups of multipliers: half-line, cone, cap."""

    t: Array
    multiplier: float
    v: Array
    z: Array
    eta: Array
    w: Array

    def moved(self, d: _Point, primal: float, dual: float) -> _Point:
        step = {"t": primal, "multiplier": primal}
        return _Point(
            **{f.name: getattr(self, f.name) + step.get(f.name, dual) * getattr(d, f.name) for f in fields(self)}
        )


class ConeInterior:
    """The iteration on the pairs of one programme; keeps the pattern and counts factorisations.

    Parameters
    ----------
    cones : Cones
    """

    def __init__(self, cones: Cones) -> None:
        self.q = cones
        self.C, self.Ct = cones.C, sp.csr_array(cones.C.T)
        r = cones.C.shape[1]
        self.factor = BlockFactor(sp.csr_array((r, r)), cones.C, cones.pairs, cones.bodies)
        self.capped = np.isfinite(cones.cap)
        self.cap = np.where(self.capped, cones.cap, 0.0)
        self.line = ~cones.rough | (cones.cohesion > 0)  # where the cone itself does not keep t_n >= 0
        self.count = max(int(self.line.sum()) + 2 * int(cones.rough.sum()) + int(self.capped.sum()), 1)

    def rate(self, v: Array) -> Array:
        """Return C v (m, d)."""
        rates: Array = (self.C @ v).reshape(self.q.pairs, self.q.dim)
        return rates

    def strength(self, t: Array) -> Array:
        """Return beta (m, d); (1, 0) where there is no cone."""
        beta = t.copy()
        beta[:, 0] = self.q.cohesion + self.q.mu * t[:, 0]
        beta[~self.q.rough] = 0.0
        beta[~self.q.rough, 0] = 1.0
        return beta

    def pressed(self, z: Array, eta: Array, w: Array) -> Array:
        """Return G'z (m, d): the velocities that multipliers stand for."""
        rates = np.where(self.q.rough[:, None], eta, 0.0)
        rates[:, 0] = self.q.mu * rates[:, 0] + np.where(self.line, z, 0.0) - np.where(self.capped, w, 0.0)
        return rates

    def gap(self, p: _Point) -> float:
        """Return the sum of the complementarity products."""
        total = (p.t[:, 0] * p.z)[self.line].sum() + (self.strength(p.t) * p.eta)[self.q.rough].sum()
        return float(total + ((self.cap - p.t[:, 0]) * p.w)[self.capped].sum())

    def start(self, size: float = START) -> _Point:
        """Return a point far outside."""
        m, d = self.q.pairs, self.q.dim
        t, eta = np.zeros((m, d)), np.zeros((m, d))
        t[:, 0] = np.where(self.capped, np.minimum(size, 0.5 * self.q.cap), size)
        eta[:, 0] = size
        one = np.full(m, size)
        return _Point(t, 0.0, np.zeros(self.C.shape[1]), one, eta, one.copy())

    def solve(
        self, e: Array, g: Array, *, start: Array | None = None, stop: Callable[[ConeAnswer], bool] | None = None
    ) -> ConeAnswer:
        """Maximise the multiplier of g beside e, (r,) both, scaled so that the larger has entries of about one.

        Parameters
        ----------
        e, g : (r,) arrays
        start : (m, d) array, optional
            Forces strictly inside the cones to begin with.
        stop : callable, optional
            Looks at each iterate; true ends the iteration.
        """
        p = self.start()
        if start is not None:
            p.t = start.copy()
        best: ConeAnswer | None = None
        since, iteration, least = 0, 0, np.inf
        with np.errstate(all="ignore"):
            for iteration in range(MOST + 1):
                r_p = self.Ct @ p.t.ravel() + e + p.multiplier * g
                r_d = self.rate(p.v) - self.pressed(p.z, p.eta, p.w)
                r_d[~self.q.rough, 1:] = 0.0
                r_g = 1.0 - float(g @ p.v)
                gap = self.gap(p)
                force, speed = max(1.0, float(p.t[:, 0].max())), max(1.0, float(np.abs(p.v).max()))
                primal = float(np.abs(r_p).max(initial=0.0)) / force
                dual = max(float(np.abs(r_d).max(initial=0.0)) / speed, abs(r_g))
                relative = gap / max(1.0, abs(p.multiplier))
                worst = max(primal, dual, relative)
                if not np.isfinite(worst):
                    break
                since = 0 if worst < 0.9 * least else since + 1
                if worst < least:
                    least, best = worst, ConeAnswer(p.t, p.multiplier, p.v, primal, dual, relative, iteration)
                if stop is not None and stop(ConeAnswer(p.t, p.multiplier, p.v, primal, dual, relative, iteration)):
                    return ConeAnswer(p.t, p.multiplier, p.v, primal, dual, relative, iteration)
                if worst < TARGET or since > PATIENCE or iteration == MOST:
                    break
                step = _Step.at(self, p, g, r_p, r_d, r_g)
                following = None if step is None else step.mehrotra(gap)
                if following is None:
                    break
                p = following
        found = best or ConeAnswer(p.t, p.multiplier, p.v, np.inf, np.inf, np.inf, 0)
        return replace(found, iterations=iteration)


@dataclass(frozen=True, eq=False)
class _Step:
    """Newton's equations at one point, factorised."""

    it: ConeInterior
    p: _Point
    g: Array
    rest: tuple[Array, Array, float]
    beta: Array
    scaling: Scaling
    F: Array
    squeeze: Array
    border: Array

    @classmethod
    def at(cls, it: ConeInterior, p: _Point, g: Array, r_p: Array, r_d: Array, r_g: float) -> _Step | None:
        beta = it.strength(p.t)
        scaling = Scaling.of(beta, p.eta)
        if scaling is None:
            return None
        F, squeeze = _roots(it, p, scaling)
        try:
            D = np.matmul(F, F.transpose(0, 2, 1))
            it.factor.factorise(D, PROXIMAL * float(np.median(D[:, 0, 0])))
            border = it.factor.solve(g)
        except SingularMatrixError:
            return None
        return cls(it, p, g, (r_p, r_d, r_g), beta, scaling, F, squeeze, border)

    def solve(self, b: Array) -> tuple[Array, float, Array] | None:
        """Return (dt, d lambda, dv) of C'dt + g d lambda = -r_p, F'C dv + F^-1 dt = b, g'dv = r_g, refined so."""
        it, g = self.it, self.g
        r_p, _, r_g = self.rest
        Ft = self.F.transpose(0, 2, 1)
        dx, dv, dl, least = np.zeros_like(b), np.zeros_like(g), 0.0, np.inf
        kept: tuple[Array, float, Array] | None = None
        schur = float(g @ self.border)
        e1, e2, e3 = -r_p, b, r_g
        for _ in range(REFINEMENTS):
            x = it.factor.solve(it.Ct @ times(self.F, e2).ravel() - e1)
            extra = (e3 - float(g @ x)) / schur
            x += extra * self.border
            dv, dl, dx = dv + x, dl + extra, dx + e2 - times(Ft, it.rate(x))
            dt = times(self.F, dx)
            e1 = -r_p - it.Ct @ dt.ravel() - g * dl
            e2 = b - times(Ft, it.rate(dv)) - dx
            e3 = r_g - float(g @ dv)
            worst = max(float(np.abs(e1).max()), float(np.abs(e2).max(initial=0.0)), abs(e3))
            if not worst < 0.5 * least:
                break
            least, kept = worst, (dt, dl, dv)
            if worst < 1e-15:
                break
        return kept

    def direction(self, rc_z: Array, rc_t: Array, rc_w: Array) -> _Point | None:
        """Return the Newton direction for given right-hand sides of the products."""
        it, p = self.it, self.p
        q, rough = it.q, it.q.rough
        both = rough & (q.mu > 0)
        scaled = divide(self.scaling.point, rc_t)
        eta = times(self.scaling.inverse, scaled)
        of_line = np.where(it.line, rc_z / p.t[:, 0], 0.0)
        room = np.where(it.capped, it.cap - p.t[:, 0], 1.0)
        of_cap = np.where(it.capped, rc_w / room, 0.0)
        rest = -self.rest[1]
        rest[:, 0] += of_line - of_cap
        rest[rough & ~both, 1:] += eta[rough & ~both, 1:]
        # where F = G^-1 W squeeze, F'G' eta is taken from its scaled value, which loses nothing
        b = times(self.F.transpose(0, 2, 1), rest)
        b[both] += (scaled - self.squeeze * (self.squeeze * scaled).sum(axis=1, keepdims=True))[both]
        found = self.solve(b)
        if found is None:
            return None
        dt, dl, dv = found
        dz = np.where(it.line, of_line - p.z / p.t[:, 0] * dt[:, 0], 0.0)
        dw = np.where(it.capped, of_cap + p.w / room * dt[:, 0], 0.0)
        # velocities follow from the motion, whose rounding is small; M d beta would cancel
        moved = it.rate(dv) + self.rest[1]
        d_eta = np.zeros_like(dt)
        d_eta[:, 1:] = moved[:, 1:]
        d_eta[:, 0] = np.where(both, (moved[:, 0] - dz + dw) / np.where(both, q.mu, 1.0), 0.0)
        tresca = rough & ~both
        d_eta[tresca, 0] = (eta - times(self.scaling.M, self.of_strength(dt)))[tresca, 0]
        d_eta[~rough] = 0.0
        dz = np.where(~rough, moved[:, 0] + dw, dz)
        return _Point(dt, dl, dv, dz, d_eta, dw)

    def of_strength(self, dt: Array) -> Array:
        """Return d beta (m, d)."""
        d_beta = dt.copy()
        d_beta[:, 0] *= self.it.q.mu
        d_beta[~self.it.q.rough] = 0.0
        return d_beta

    def longest(self, d: _Point) -> tuple[float, float]:
        """Return the longest primal and dual steps up to one that stay inside."""
        it, p = self.it, self.p
        primal, dual = reach(self.beta, self.of_strength(d.t)), reach(p.eta, d.eta)
        room, less = (it.cap - p.t[:, 0])[it.capped], -d.t[it.capped, 0]
        primal = min(primal, _line(p.t[it.line, 0], d.t[it.line, 0]), _line(room, less))
        dual = min(dual, _line(p.z[it.line], d.z[it.line]), _line(p.w[it.capped], d.w[it.capped]))
        return min(1.0, primal), min(1.0, dual)

    def mehrotra(self, gap: float) -> _Point | None:
        """Return the next point."""
        it, p, point = self.it, self.p, self.scaling.point
        t_n, room = p.t[:, 0], it.cap - p.t[:, 0]
        d = self.direction(-t_n * p.z, -product(point, point), -room * p.w)
        if d is None:
            return None
        a = self.longest(d)
        after = it.gap(p.moved(d, *a))
        tau = gap / it.count * min(1.0, max((after / gap) ** 3, 1e-6))
        d_beta = self.of_strength(d.t)
        rc_t = -product(point, point)
        rc_t -= product(times(self.scaling.W, d.eta), times(self.scaling.inverse, d_beta))
        rc_t[:, 0] += 2.0 * tau
        d = self.direction(tau - t_n * p.z - d.t[:, 0] * d.z, rc_t, tau - room * p.w + d.t[:, 0] * d.w)
        if d is None:
            return None
        primal, dual = self.longest(d)
        return p.moved(d, min(1.0, SHARE * primal), min(1.0, SHARE * dual))


def _roots(it: ConeInterior, p: _Point, scaling: Scaling) -> tuple[Array, Array]:
    """Return F (m, d, d) with F F' = (G'M G)^-1, and s (m, d) with F = G^-1 W (I - s s') for pairs with friction.

    From the scaling itself: inverting M would lose its small values.
    """
    q, d = it.q, it.q.dim
    both = q.rough & (q.mu > 0)
    own = np.where(it.line, p.z / p.t[:, 0], 0.0) + np.where(it.capped, p.w / (it.cap - p.t[:, 0]), 0.0)
    F = np.zeros((q.pairs, d, d))
    F[both] = scaling.W[both]
    F[both, 0, :] /= q.mu[both, None]
    v = F[:, 0, :]
    size = np.where(both, (v * v).sum(axis=1), 1.0)
    less = (1.0 - 1.0 / np.sqrt(1.0 + own * size)) / size
    squeeze = np.where(both[:, None], np.sqrt(less)[:, None] * v, 0.0)
    F -= times(F, squeeze)[:, :, None] * squeeze[:, None, :]
    F[~both, 0, 0] = 1.0 / np.sqrt(own[~both])
    tresca = q.rough & ~both
    if tresca.any():
        M = scaling.M[tresca, 1:, 1:]
        F[tresca, 1:, 1:] = np.linalg.inv(np.linalg.cholesky(M)).transpose(0, 2, 1)
    return F, squeeze


def _line(x: Array, dx: Array) -> float:
    """Return the step at which the first entry of x + step dx reaches zero."""
    down = dx < 0
    return float(np.min(-x[down] / dx[down], initial=np.inf))
