r"""Primal-dual interior point on the plane Coulomb problem itself, non-monotone as it is.

Unknowns are u, the shifted normal forces t_n, friction forces t_t, gaps y_n, the slacks s+ = c + mu t_n + t_t and
s- = c + mu t_n - t_t, and the slip parts y+ and y-, all of equations (5), (16), (18):

.. math::

    K u - f - C_n^T t_n - C_t^T t_t &= 0, &
    y_n &= x_n + C_n u + a_n t_n - \bar d\,(y^+ + y^-) + p, \\
    y^+ - y^- &= C_t u - s + a_t t_t, &
    t_n y_n &= s^+ y^+ = s^- y^- = q\,p = \tau \to 0, \qquad q = N - t_n .

Newton's equations of a pair are a 2 x 2 system; eliminated, they leave :math:`(K + C^T D C)\,\delta u = r`, sparse and
of one pattern, regular although K is singular. Steps follow Mehrotra's predictor and corrector. The dilatancy used is
:math:`\bar d = d + \theta(\mu - d)`: theta = 0 is the problem itself, theta = 1 associated flow, which is convex;
:mod:`concio.solvers.interior.homotopy` walks from one to the other.

What the iteration returns is a point close to a solution, or nothing; :mod:`concio.solvers.interior.exact_finish` makes
it exact.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace

import numpy as np

from concio.problem.contact_problem import Array
from concio.solvers.algebra.scaled import Scaled
from concio.solvers.algebra.sparse_factor import SingularMatrixError

PROXIMAL = 1e-10
"""Weight of the proximal term that keeps bodies which nothing holds where they are."""

START = 10.0
"""Size of slacks and multipliers at the start, in scaled units."""

SLOPES = ("t_n", "y_n", "s_p", "y_p", "s_m", "y_m", "q", "p")


@dataclass
class Iterate:
    """A point strictly inside: every slack and multiplier positive.

    Parameters
    ----------
    u : (N,) array
    t_n, t_t, y_n, s_p, y_p, s_m, y_m, q, p : (m,) arrays
        See the module's equations; ``q, p`` belong to capped pairs and are one elsewhere.
    """

    u: Array
    t_n: Array
    t_t: Array
    y_n: Array
    s_p: Array
    y_p: Array
    s_m: Array
    y_m: Array
    q: Array
    p: Array

    def copy(self) -> Iterate:
        """Return a copy that shares nothing."""
        return replace(self, **{f.name: getattr(self, f.name).copy() for f in fields(self)})


@dataclass(frozen=True)
class Outcome:
    """How an interior-point run ended.

    Parameters
    ----------
    converged : bool
        Residual and complementarity below the target.
    iterations : int
    residual : float
        Largest residual, forces relative to the largest force and lengths to the largest displacement.
    complementarity : float
        Mean product over both.
    """

    converged: bool
    iterations: int
    residual: float
    complementarity: float


class InteriorPoint:
    """The iteration on one scaled problem; keeps the pattern and counts factorisations.

    Parameters
    ----------
    scaled : Scaled
    """

    def __init__(self, scaled: Scaled) -> None:
        self.problem = scaled
        self.capped = np.isfinite(scaled.cap)
        self.rough = scaled.rough
        self.products = scaled.pairs + 2 * int(self.rough.sum()) + int(self.capped.sum())

    def start(self, size: float = START) -> Iterate:
        """Return the point from which the plain iteration starts: every slack and multiplier ``size``.

        Starting far outside (forces and gaps ten times the typical ones) halves the iterations near collapse.
        """
        s = self.problem
        one = np.full(s.pairs, size)
        t_n = np.where(self.capped, np.minimum(size, 0.5 * s.cap), size)
        strength = s.cohesion + s.mu * t_n
        slack = np.where(self.rough, strength, size)
        q = np.where(self.capped, np.where(self.capped, s.cap, 0.0) - t_n, size)
        return Iterate(
            np.zeros(len(s.f)), t_n, 0 * one, one.copy(), slack, one.copy(), slack.copy(), one.copy(), q, one.copy()
        )

    def gap(self, z: Iterate) -> float:
        """Return the mean complementarity product."""
        r, c = self.rough, self.capped
        total = (z.t_n * z.y_n).sum() + (z.s_p * z.y_p + z.s_m * z.y_m)[r].sum() + (z.q * z.p)[c].sum()
        return float(total / max(self.products, 1))

    def residuals(self, z: Iterate, theta: float) -> tuple[Array, Array, Array, Array, Array, Array]:
        """Return the residuals of equilibrium, gap, slip, s+, s- and cap."""
        s, r = self.problem, self.rough
        dilatancy = self.dilatancy(theta)
        r_u = s.imbalance(z.u, z.t_n, z.t_t)
        r_n = s.normal_gap(z.u, z.t_n) - dilatancy * (z.y_p + z.y_m) - z.y_n + np.where(self.capped, z.p, 0.0)
        r_t = np.where(r, s.slip(z.u, z.t_t) - z.y_p + z.y_m, 0.0)
        strength = s.cohesion + s.mu * z.t_n
        r_p = np.where(r, strength + z.t_t - z.s_p, 0.0)
        r_m = np.where(r, strength - z.t_t - z.s_m, 0.0)
        r_q = np.where(self.capped, np.where(self.capped, s.cap, 0.0) - z.t_n - z.q, 0.0)
        return r_u, r_n, r_t, r_p, r_m, r_q

    def dilatancy(self, theta: float) -> Array:
        """Return the dilatancy (m,) of the homotopy at ``theta``."""
        s = self.problem
        return np.where(self.rough, s.dilatancy + theta * (s.mu - s.dilatancy), 0.0)

    def run(
        self,
        z: Iterate,
        *,
        theta: float = 0.0,
        target: float = 1e-9,
        most: int = 80,
        level: float = 0.0,
        watch: Callable[[int, float], bool | None] | None = None,
    ) -> Outcome:
        """Iterate in place from ``z``.

        Parameters
        ----------
        z : Iterate
            Changed in place; where the run does not converge, the best point met is put back.
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
        """
        s, r, c = self.problem, self.rough, self.capped
        dilatancy, mu = self.dilatancy(theta), s.mu
        step, short = 1.0, 0
        best, kept, since = np.inf, z.copy(), 0
        for iteration in range(most + 1):
            r_u, r_n, r_t, r_p, r_m, r_q = self.residuals(z, theta)
            force = max(1.0, float(z.t_n.max(initial=0.0)), float(np.abs(z.t_t).max(initial=0.0)))
            length = max(1.0, float(np.abs(z.u).max(initial=0.0)))
            residual = max(
                *(float(np.abs(v).max(initial=0.0)) / force for v in (r_u, r_p, r_m, r_q)),
                *(float(np.abs(v).max(initial=0.0)) / length for v in (r_n, r_t)),
            )
            gap = self.gap(z)
            typical = max(1.0, float(z.t_n.mean())) * max(1.0, float((z.y_n + z.y_p + z.y_m).mean()))
            relative = gap / typical
            merit = max(residual, relative)
            if not np.isfinite(merit):
                break
            if merit < 0.9 * best:
                best, since = merit, 0
                for f in fields(z):
                    setattr(kept, f.name, getattr(z, f.name))
            else:
                since += 1
            if merit < target or (level and gap < level and residual < 1e-6):
                return Outcome(True, iteration, residual, relative)
            if watch is not None and watch(iteration, merit):
                break
            short = short + 1 if step < 0.02 else 0
            if iteration == most or short >= 8 or since >= 25 or (best < 1e-4 and (merit > 1e2 * best or since >= 6)):
                break
            big_p, big_q = np.where(r, z.y_p / z.s_p, 0.0), np.where(r, z.y_m / z.s_m, 0.0)  # P, Q
            crush = np.where(c, z.p / z.q, 0.0)
            h_nn = z.y_n / z.t_n + s.a_n + crush + dilatancy * mu * (big_p + big_q)
            h_nt = dilatancy * (big_p - big_q)
            h_tn = mu * (big_p - big_q)
            h_tt = np.where(r, big_p + big_q + s.a_t, 1.0)
            det = h_nn * h_tt - h_nt * h_tn
            if not det.all():
                break  # the path turns back: no direction
            d_nn, d_nt, d_tn, d_tt = h_tt / det, -h_nt / det, -h_tn / det, np.where(r, h_nn / det, 0.0)
            try:
                s.factor.factorise(np.concatenate([d_nn, d_nt, d_tn, d_tt]), PROXIMAL)
            except SingularMatrixError:
                break

            def direction(
                rc_n: Array,
                rc_p: Array,
                rc_m: Array,
                rc_q: Array,
                P: Array = big_p,
                Q: Array = big_q,
                D: tuple[Array, ...] = (d_nn, d_nt, d_tn, d_tt),
                rest: tuple[Array, ...] = (r_u, r_n, r_t, r_p, r_m, r_q),
            ) -> Iterate:
                r_u, r_n, r_t, r_p, r_m, r_q = rest
                # slip parts: dy+ = (rc_p - y+ ds+) / s+, ds+ = mu dt_n + dt_t + r_p
                plus = np.where(r, rc_p / z.s_p - P * r_p, 0.0)
                minus = np.where(r, rc_m / z.s_m - Q * r_m, 0.0)
                pressed = np.where(c, (rc_q - z.p * r_q) / z.q, 0.0)  # dp = pressed + (p/q) dt_n
                b_n = r_n - rc_n / z.t_n - dilatancy * (plus + minus) + pressed
                b_t = r_t - plus + minus
                n0, t0 = -(D[0] * b_n + D[1] * b_t), -(D[2] * b_n + D[3] * b_t)
                du = s.factor.solve(-r_u + s.pull(n0, t0))
                v_n, v_t = s.C_n @ du, s.C_t @ du
                dt_n = n0 - D[0] * v_n - D[1] * v_t
                dt_t = np.where(r, t0 - D[2] * v_n - D[3] * v_t, 0.0)
                ds_p, ds_m = mu * dt_n + dt_t + r_p, mu * dt_n - dt_t + r_m
                dq = np.where(c, r_q - dt_n, 0.0)
                return Iterate(
                    u=du,
                    t_n=dt_n,
                    t_t=dt_t,
                    y_n=(rc_n - z.y_n * dt_n) / z.t_n,
                    s_p=np.where(r, ds_p, 0.0),
                    y_p=np.where(r, (rc_p - z.y_p * ds_p) / z.s_p, 0.0),
                    s_m=np.where(r, ds_m, 0.0),
                    y_m=np.where(r, (rc_m - z.y_m * ds_m) / z.s_m, 0.0),
                    q=dq,
                    p=np.where(c, (rc_q - z.p * dq) / z.q, 0.0),
                )

            d = direction(-z.t_n * z.y_n, -z.s_p * z.y_p, -z.s_m * z.y_m, -z.q * z.p)
            step = _longest(z, d, 1.0)
            predicted = self.gap(_moved(z, d, step))
            centring = min(1.0, max((predicted / gap) ** 3, 1e-4)) if step > 0.05 else 0.5
            tau = centring * gap
            tau = max(tau, 0.3 * level, 0.03 * target * typical)
            d = direction(
                tau - z.t_n * z.y_n - step * d.t_n * d.y_n,
                tau - z.s_p * z.y_p - step * d.s_p * d.y_p,
                tau - z.s_m * z.y_m - step * d.s_m * d.y_m,
                tau - z.q * z.p - step * d.q * d.p,
            )
            step = _longest(z, d, 0.99)
            moved = _moved(z, d, step)
            for f in fields(z):
                setattr(z, f.name, getattr(moved, f.name))
        for f in fields(z):
            setattr(z, f.name, getattr(kept, f.name))
        return Outcome(False, iteration, best, self.gap(z))


def _longest(z: Iterate, d: Iterate, share: float) -> float:
    """Return the longest step <= 1 that keeps every slack and multiplier positive, times ``share``."""
    alpha = 1.0
    for name in SLOPES:
        x, dx = getattr(z, name), getattr(d, name)
        down = dx < 0
        if down.any():
            alpha = min(alpha, share * float(np.min(-x[down] / dx[down])))
    return alpha


def _moved(z: Iterate, d: Iterate, step: float) -> Iterate:
    return Iterate(**{f.name: getattr(z, f.name) + step * getattr(d, f.name) for f in fields(z)})
