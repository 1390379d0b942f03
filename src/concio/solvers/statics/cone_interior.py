r"""Interior point for the second-order cone programmes of statics, on the graph of the blocks.

The largest multiplier of a load under which forces inside the cones are in balance,

.. math:: \max \lambda, \qquad C^T t + e + \lambda g = 0, \qquad
          t_n \ge 0,\ t_n \le N,\ \beta = (c + \mu t_n, t_t) \in Q,

and its dual, the motion v of least :math:`h(Cv) - e^T v` with g'v = 1. C holds the velocities of the pairs in rigid
motions of the blocks, d rows for each pair. With slacks s = G t + h in a product of half-lines and second-order cones,
multipliers z in the same and the scaling of Nesterov and Todd, Mehrotra's predictor and corrector leave in each step

.. math:: \begin{bmatrix} C^T D C & -g \\ g^T & 0 \end{bmatrix}, \qquad D = (G^T M G)^{-1},

D with a small dense block for each pair, symmetric, of the pattern of the blocks' graph, ordered once. The multipliers
of an iterate lie strictly inside their cones, so the motion is admissible to rounding as soon as Cv = G'z holds; what
forces and motion prove is for the caller to recompute from the original data.

Degenerate structures, where M spans twenty powers of ten, decide how it must be computed. The roots F of D come from
the scaling itself, never from inverting M, and forces are unknown as F dx. The change of the multipliers is read from
the motion, G'dz = C dv + residual, whose rounding is small, not from M d beta, which cancels: without this the gap
stops at 1e-6 to 1e-8, with it at 1e-12. Where friction is exhausted in all joints at once, C'DC is worse than 1e16:
then the system in dx and dv is solved as a whole, with pivoting.

Reference: Alizadeh and Goldfarb, Second-order cone programming, Math. Programming 95 (2003), 3-51.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sla

from concio.problem.cone import Cone
from concio.problem.contact_problem import Array
from concio.problem.tolerances import SMOOTH
from concio.solvers.algebra.block_factor import BlockFactor
from concio.solvers.algebra.second_order_cone import Scaling, divide, product, reach, times
from concio.solvers.algebra.sparse_factor import SingularMatrixError

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

LOST = 1e-11
"""Residual of a refined direction, relative to the largest force, above which the condensed matrix has lost it."""

PIVOTED = 60_000
"""Largest number of force components for which the system is then solved as a whole, with pivoting."""

REFINEMENTS = 6
"""Largest number of times a direction is refined."""


@dataclass(frozen=True, eq=False)
class Pairs:
    """Pairs of a cone programme.

    Parameters
    ----------
    C : (m d, r) CSR array
        Velocities of the pairs, d rows for each.
    cone : Cone
        Strengths of forces shifted so that t_n >= 0.
    bodies : (B+1,) integer array
        Motions of block k are ``bodies[k]:bodies[k+1]``.
    """

    C: sp.csr_array
    cone: Cone
    bodies: Array

    @property
    def count(self) -> int:
        """Number m of pairs."""
        return len(self.cone.cap)

    @property
    def dim(self) -> int:
        """Space dimension d."""
        return self.C.shape[0] // max(self.count, 1)


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
    pairs : Pairs
    """

    def __init__(self, pairs: Pairs) -> None:
        self.pairs = pairs
        self.C, self.Ct = pairs.C, sp.csr_array(pairs.C.T)
        r = pairs.C.shape[1]
        self.factor = BlockFactor(sp.csr_array((r, r)), pairs.C, pairs.count, pairs.bodies)
        cone = pairs.cone
        self.capped, self.rough = cone.capped, cone.rough
        self.cap = np.where(self.capped, cone.cap, 0.0)
        self.coulomb = self.rough & (cone.friction > SMOOTH)  # the others with friction have a constant strength
        self.mu = np.where(self.coulomb, cone.friction, 0.0)
        self.line = ~self.rough | (cone.cohesion > 0)  # where the cone itself does not keep t_n >= 0
        self.degenerate = False
        self.count = max(int(self.line.sum()) + 2 * int(self.rough.sum()) + int(self.capped.sum()), 1)

    def rate(self, v: Array) -> Array:
        """Return C v (m, d)."""
        rates: Array = (self.C @ v).reshape(self.pairs.count, self.pairs.dim)
        return rates

    def strength(self, t: Array) -> Array:
        """Return beta (m, d); (1, 0) where there is no cone."""
        beta = t.copy()
        beta[:, 0] = self.pairs.cone.cohesion + self.mu * t[:, 0]
        beta[~self.rough] = 0.0
        beta[~self.rough, 0] = 1.0
        return beta

    def pressed(self, z: Array, eta: Array, w: Array) -> Array:
        """Return G'z (m, d): the velocities that multipliers stand for."""
        rates = np.where(self.rough[:, None], eta, 0.0)
        rates[:, 0] = self.mu * rates[:, 0] + np.where(self.line, z, 0.0) - np.where(self.capped, w, 0.0)
        return rates

    def gap(self, p: _Point) -> float:
        """Return the sum of the complementarity products."""
        total = (p.t[:, 0] * p.z)[self.line].sum() + (self.strength(p.t) * p.eta)[self.rough].sum()
        return float(total + ((self.cap - p.t[:, 0]) * p.w)[self.capped].sum())

    def start(self, size: float = START) -> _Point:
        """Return a point far outside."""
        m, d = self.pairs.count, self.pairs.dim
        t, eta = np.zeros((m, d)), np.zeros((m, d))
        t[:, 0] = np.where(self.capped, np.minimum(size, 0.5 * self.pairs.cone.cap), size)
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
        self.degenerate = False
        if start is not None:
            p.t = start.copy()
        best: ConeAnswer | None = None
        since, iteration, least = 0, 0, np.inf
        with np.errstate(all="ignore"):
            for iteration in range(MOST + 1):
                r_p = self.Ct @ p.t.ravel() + e + p.multiplier * g
                r_d = self.rate(p.v) - self.pressed(p.z, p.eta, p.w)
                r_d[~self.rough, 1:] = 0.0
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
        D = np.matmul(F, F.transpose(0, 2, 1))
        border = np.zeros(0)
        if not it.degenerate:
            try:
                it.factor.factorise(D, PROXIMAL * min(1.0, float(np.median(D[:, 0, 0]))))
                border = it.factor.solve(g)
            except SingularMatrixError:
                it.degenerate = True
        return cls(it, p, g, (r_p, r_d, r_g), beta, scaling, F, squeeze, border)

    def solve(self, b: Array) -> tuple[Array, float, Array] | None:
        """Return (dt, d lambda, dv) of C'dt + g d lambda = -r_p, F'C dv + F^-1 dt = b, g'dv = r_g, refined so."""
        it, g = self.it, self.g
        r_p, _, r_g = self.rest
        Ft = self.F.transpose(0, 2, 1)
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
                    -r_p - it.Ct @ dt.ravel() - g * trial[2],
                    b - times(Ft, it.rate(trial[1])) - trial[0],
                    r_g - float(g @ trial[1]),
                )
                worst = max(float(np.abs(left[0]).max()), float(np.abs(left[1]).max(initial=0.0)), abs(left[2]))
                if not worst < 0.5 * least:
                    break
                (dx, dv, dl), (e1, e2, e3) = trial, left
                least, kept = worst, (dt, dl, dv)
                if worst < 1e-15:
                    break
            if it.degenerate or least < LOST * max(1.0, float(np.abs(self.p.t).max())) or dx.size > PIVOTED:
                return kept
            it.degenerate, solver = True, self._pivoted
            dx, dv, dl = np.zeros_like(b), np.zeros_like(g), 0.0
            e1, e2, e3, kept = -r_p, b, r_g, None

    def _condensed(self, e1: Array, e2: Array, e3: float) -> tuple[Array, Array, float]:
        """Solve by C'DC, the multiplier bordered: digits are lost where that matrix is worse than 1e16."""
        it, g = self.it, self.g
        x = it.factor.solve(it.Ct @ times(self.F, e2).ravel() - e1)
        extra = (e3 - float(g @ x)) / float(g @ self.border)
        x += extra * self.border
        return x, e2 - times(self.F.transpose(0, 2, 1), it.rate(x)), extra

    @cached_property
    def _mixed(self) -> Any:
        """Factors with pivoting of the system in dx, dv and the multiplier, whose condition is the square root."""
        it, (m, d, _) = self.it, self.F.shape
        roots = sp.bsr_array((self.F, np.arange(m), np.arange(m + 1)), shape=(m * d, m * d))
        FC, g = sp.csr_array(sp.csr_array(roots.T) @ it.C), sp.csr_array(self.g[:, None])
        loose = -PROXIMAL * sp.eye_array(self.g.size)
        matrix = sp.block_array([[sp.eye_array(m * d), FC, None], [FC.T, loose, g], [None, g.T, None]], format="csc")
        splu: Any = sla.splu
        try:
            return splu(sp.csc_matrix(matrix))
        except RuntimeError:
            return None

    def _pivoted(self, e1: Array, e2: Array, e3: float) -> tuple[Array, Array, float]:
        """Solve the whole system with pivoting."""
        n = e2.size
        right = np.concatenate([e2.ravel(), e1, [e3]])
        x = np.full(right.size, np.nan) if self._mixed is None else self._mixed.solve(right)
        return x[n:-1], x[:n].reshape(e2.shape), float(x[-1])

    def direction(self, rc_z: Array, rc_t: Array, rc_w: Array) -> _Point | None:
        """Return the Newton direction for given right-hand sides of the products."""
        it, p = self.it, self.p
        rough, both = it.rough, it.coulomb
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
        d_eta[:, 0] = np.where(both, (moved[:, 0] - dz + dw) / np.where(both, it.mu, 1.0), 0.0)
        tresca = rough & ~both
        d_eta[tresca, 0] = (eta - times(self.scaling.M, self.of_strength(dt)))[tresca, 0]
        d_eta[~rough] = 0.0
        dz = np.where(~rough, moved[:, 0] + dw, dz)
        return _Point(dt, dl, dv, dz, d_eta, dw)

    def of_strength(self, dt: Array) -> Array:
        """Return d beta (m, d)."""
        d_beta = dt.copy()
        d_beta[:, 0] *= self.it.mu
        d_beta[~self.it.rough] = 0.0
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
    d, both = it.pairs.dim, it.coulomb
    own = np.where(it.line, p.z / p.t[:, 0], 0.0) + np.where(it.capped, p.w / (it.cap - p.t[:, 0]), 0.0)
    F = np.zeros((it.pairs.count, d, d))
    F[both] = scaling.W[both]
    F[both, 0, :] /= it.mu[both, None]
    v = F[:, 0, :].copy()
    size = np.where(both, (v * v).sum(axis=1), 1.0)
    less = (1.0 - 1.0 / np.sqrt(1.0 + own * size)) / size
    squeeze = np.where(both[:, None], np.sqrt(less)[:, None] * v, 0.0)
    F -= times(F, squeeze)[:, :, None] * squeeze[:, None, :]
    F[both, 0, :] = (v / np.sqrt(1.0 + own * size)[:, None])[both]  # the same, without cancellation at a cap
    F[~both, 0, 0] = 1.0 / np.sqrt(own[~both])
    tresca = it.rough & ~both
    if tresca.any():
        M = scaling.M[tresca, 1:, 1:]
        F[tresca, 1:, 1:] = np.linalg.inv(np.linalg.cholesky(M)).transpose(0, 2, 1)
    return F, squeeze


def _line(x: Array, dx: Array) -> float:
    """Return the step at which the first entry of x + step dx reaches zero."""
    down = dx < 0
    return float(np.min(-x[down] / dx[down], initial=np.inf))
