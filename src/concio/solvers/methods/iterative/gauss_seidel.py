r"""Nonlinear Gauss-Seidel, the workhorse of contact dynamics: pair after pair, each law solved exactly.

With the Delassus operator ``W = C A^{-1} C'`` the gaps are ``y = q + W t``. A sweep visits each pair, freezes the
forces of all others and solves the pair's own law with its ``d x d`` block of W exactly: in two dimensions the
candidates (open, stick, slip either way, crushed) are all tried and the one that obeys the law is kept; in three, one
projection is made. Pairs that share no body are treated at once (colours).

In dynamics A is a mass matrix and all bodies are held by their inertia. In statics ``A = K`` is singular for floating
bodies and W does not exist; they are given a proximal term, ``A = K + tau I`` in the place of inertia, with
``tau u_before`` among the loads, and ``u_before`` follows every few sweeps. The fixed point is the static
equilibrium, but information crosses one block a sweep and rigid motions creep: on elastic blocks convergence is slow
(thousands of sweeps for tens of blocks), near collapse it does not end. That is the method, not this file; it is
reported as what it is.

References
----------
M. Jean, The non-smooth contact dynamics method, *Comput. Methods Appl. Mech. Engrg.* 177 (1999) 235-257.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from concio.errors import MethodError
from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.solution import ProgressCallback, Solution
from concio.solvers.algebra.scaled import Scaled, scale
from concio.solvers.methods.iterative.delassus import colours, delassus
from concio.solvers.methods.iterative.iteration import GOAL, Record, Stopped, answer


def solve(
    problem: ContactProblem,
    *,
    progress: ProgressCallback | None = None,
    inertia: float = 0.03,
    sweeps: int = 3,
    limit: int = 3000,
) -> Solution:
    """Solve by nonlinear Gauss-Seidel.

    Parameters
    ----------
    problem : ContactProblem
    progress : callable, optional
    inertia : float
        Proximal weight tau in multiples of the typical stiffness, positive; zero, the plain method on
        ``W = C K^-1 C'``, only where no body floats.
    sweeps : int
        Sweeps between two updates of the proximal term.
    limit : int
        Sweeps in all.

    Raises
    ------
    MethodError
        An option is not usable, or ``inertia=0`` meets floating bodies.
    """
    if inertia < 0 or sweeps < 1:
        msg = f"inertia {inertia} must not be negative and sweeps {sweeps} at least 1"
        raise MethodError(msg, hint="try inertia=0.03, sweeps=3")
    if inertia == 0 and problem.rigid_motions:
        msg = f"the Delassus operator C K^-1 C' does not exist: {problem.rigid_motions} rigid motions are free"
        raise MethodError(msg, hint="leave inertia at its default, or take admm or interior-point")
    s = scale(problem)
    record = Record("gauss-seidel", s, progress)
    record.info["unknowns"] = s.x.size
    lu = record.factorise(np.zeros((s.pairs, s.dim, s.dim)), inertia)
    w = delassus(sp.csc_array(s.K + inertia * sp.eye_array(s.f.size)), s.C, problem.bodies)
    w = sp.csr_array(w + sp.diags_array(s.compliance.ravel()))
    groups = [_Group(s, w, pick) for pick in colours(w, s.dim)]
    u, t = s.glued, s.start
    record.info.update(inertia=inertia, colours=len(groups), delassus_entries=int(w.nnz))
    try:
        while len(record.history) < limit and not record.stalled(600, 0.9):
            free = u - lu.solve(s.K @ u - s.f)  # A^-1 (f + tau u), as an increment
            q = s.opening(free).ravel()
            for _ in range(sweeps):
                for group in groups:
                    t = group.visit(q, t)
            u = free + lu.solve(s.pull(t))
            record.solves(2)
            residual = np.inf
            for _ in range(sweeps):
                residual = record.note(u, t)
            if residual <= GOAL or not np.isfinite(residual):
                break
    except Stopped as stop:
        return answer(problem, record, cancelled=stop.cancelled)
    return answer(problem, record)


class _Group:
    """Pairs of one colour: their rows of W, their own blocks, their strength domains."""

    def __init__(self, s: Scaled, w: sp.csr_array, pick: Array) -> None:
        d = s.dim
        self.pick, self.d = pick, d
        rows = (pick[:, None] * d + np.arange(d)).ravel()
        self.rows = sp.csr_array(w[rows])
        own = sp.csr_array(self.rows[:, rows])
        self.block = np.zeros((pick.size, d, d))
        for i in range(d):
            for j in range(d):
                self.block[:, i, j] = sp.csr_array(own[i::d, j::d]).diagonal()
        self.cone = s.cone[pick]
        self.dilatancy = s.dilatancy[pick]
        self.stiffness = 1.0 / np.maximum(np.linalg.norm(self.block, ord=2, axis=(1, 2)), 1e-300)

    def visit(self, q: Array, t: Array) -> Array:
        """Return the forces with the law of each pair of the group solved, all others frozen."""
        now = t[self.pick]
        gap = q.reshape(t.shape)[self.pick] + (self.rows @ t.ravel()).reshape(now.shape)
        rest = gap - np.einsum("kij,kj->ki", self.block, now)
        t = t.copy()
        t[self.pick] = self._candidates(rest) if self.d == 2 else self._projected(gap, now)
        return t

    def _projected(self, gap: Array, now: Array) -> Array:
        return self.cone.project(now - self.stiffness[:, None] * gap, self.dilatancy)

    def _candidates(self, rest: Array) -> Array:
        """Return the exact local solution: the candidate state that violates the law least."""
        cone, w = self.cone, self.block
        w_nn, w_nt, w_tt = w[:, 0, 0], w[:, 0, 1], np.maximum(w[:, 1, 1], 1e-300)

        def held(t_n: Array) -> Array:
            bound = cone.strength(t_n)
            return np.column_stack([t_n, np.clip(-(rest[:, 1] + w_nt * t_n) / w_tt, -bound, bound)])

        def slipping(sign: float) -> Array:
            # y_n - tan(psi)|y_t| = 0 with t_t = sign (c + mu t_n), |y_t| = -sign y_t
            lean = sign * self.dilatancy
            friction, cohesion = sign * cone.friction, sign * cone.cohesion
            slope = w_nn + w_nt * friction + lean * (w_nt + w_tt * friction)
            value = rest[:, 0] + w_nt * cohesion + lean * (rest[:, 1] + w_tt * cohesion)
            t_n = np.clip(-value / np.where(slope == 0.0, 1e-300, slope), -cone.tension, cone.cap)
            return np.column_stack([t_n, sign * cone.strength(t_n)])

        determinant = np.maximum(w_nn * w_tt - w_nt**2, 1e-14 * w_nn * w_tt + 1e-300)
        stick_n = -(w_tt * rest[:, 0] - w_nt * rest[:, 1]) / determinant
        tries = [held(np.clip(stick_n, -cone.tension, cone.cap)), slipping(1.0), slipping(-1.0), held(-cone.tension)]
        if cone.capped.any():
            tries.append(held(np.where(cone.capped, cone.cap, -cone.tension)))
        scale = self.stiffness[:, None]
        wrong = []
        for t in tries:
            y = rest + np.einsum("kij,kj->ki", w, t)
            wrong.append(np.abs(t - cone.project(t - scale * y, self.dilatancy)).max(axis=1))
        chosen = np.argmin(np.array(wrong), axis=0)
        best: Array = np.array(tries)[chosen, np.arange(chosen.size)]
        return best
