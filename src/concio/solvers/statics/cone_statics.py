r"""Statics with round cones: forces in balance, the mechanism that excludes them, the largest multiplier of a load.

All of it is one programme, the largest multiplier of a load beside another
(:mod:`concio.solvers.statics.cone_interior`), and nothing of what it says is believed: forces are brought into balance
and examined in the original data, motions likewise.

*Existence.* Forces of one unit on every contact, t = (1, 0, 0), balance the load :math:`f_r = -R^T C^T t`. Let
lambda be the largest multiplier of :math:`f_r + \lambda (f - f_r)`. It is at least 1 if and only if forces for f exist,
since strengths are convex and the forces of multipliers up to lambda can be had by interpolation; if it is below 1 the
mechanism that proves it does positive work with f itself.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.tolerances import CONE_TARGET, PROGRAMME_ROUNDING, PROGRAMME_SETTLED
from concio.solvers.algebra.scales import interleaved
from concio.solvers.algebra.second_order_cone import determinant, times
from concio.solvers.algebra.sparse_factor import SingularMatrixError
from concio.solvers.statics.cone_interior import ConeAnswer, maximise
from concio.solvers.statics.cone_programme import ConeProgramme, Pairs
from concio.solvers.statics.cone_step import PROXIMAL

ENDLESS = 1e7
"""Multiplier, in units of the programme, from which on a load may be one that can grow without bound."""

CLEAR = 100.0
"""Times the gap that the multiplier must be away from one for the programme to stop with a motion as its answer."""

LEAST = 1e-3
"""Least initial normal force, as a share of the mean."""

ROUNDS = 6
"""Times forces are brought closer to balance."""


@dataclass(frozen=True, eq=False)
class Balance:
    """Outcome of the search for forces in balance with a load.

    Parameters
    ----------
    t : (m, d) array
        Forces, normal first [kN].
    residual : float
        Largest entry of R'(f + C't) and of the excess over the strengths, over the total load.
    velocity : (N,) array
        Motion to blame where there are no such forces.
    multiplier : float
        Largest multiplier of the programme; below 1 where there are none.
    at_bound : (m,) array
        Normal forces at that multiplier [kN].
    """

    t: Array
    residual: float
    velocity: Array
    multiplier: float
    at_bound: Array


@dataclass(frozen=True, eq=False)
class Bounds:
    """Forces and motion of a largest multiplier.

    Parameters
    ----------
    multiplier : float
        That of the forces; inf where it seems to grow without bound, -inf where there seem to be none.
    t : (m, d) array
        Forces, normal first [kN].
    residual : float
        Largest entry of what they leave unbalanced and of their excess over the strengths, over the total load.
    velocity : (N,) array
        Motion that excludes larger ones.
    """

    multiplier: float
    t: Array
    residual: float
    velocity: Array


class ConeStatics:
    """Cone programmes of one problem: strengths and rates in units of their own, pattern ordered once.

    Parameters
    ----------
    problem : ContactProblem
    load : (N,) array, optional
        Loads that make up the unit of force; default those of the problem.
    pivoting : bool
        As in :class:`~concio.solvers.statics.cone_programme.ConeProgramme`.
    """

    def __init__(self, problem: ContactProblem, load: Array | None = None, *, pivoting: bool = True) -> None:
        self.problem = problem
        load = problem.f if load is None else load
        R = problem.R
        moved = sp.csc_array(interleaved(problem) @ R)
        reach = np.maximum.reduceat(np.r_[np.abs(moved.data), 0.0], moved.indptr[:-1])
        reach[np.diff(moved.indptr) == 0] = 0.0
        self.scale = np.where(reach > 0, reach, 1.0)
        self.force = float(np.abs(R.T @ load / self.scale).max(initial=0.0)) or 1.0
        motions = sp.csr_array(moved @ sp.diags_array(1.0 / self.scale))
        strengths = problem.cone.in_units(self.force)
        pairs = Pairs(motions, strengths.shifted, _motions_of_bodies(problem), problem.engine)
        self.programme = ConeProgramme(pairs, pivoting=pivoting)
        self.shift = np.zeros((problem.pairs, problem.dim))
        self.shift[:, 0] = strengths.tension

    def project(self, load: Array) -> Array:
        """Return R' load in units of the programme (r,)."""
        projected: Array = (self.problem.R.T @ load) / (self.scale * self.force)
        return projected

    def balance(self, t: Array, load: Array) -> Array:
        """Return shifted forces next to ``t`` in balance with ``load`` (r,), moved in proportion to their room."""
        it = self.programme
        residual = it.pull(t) + load
        room = _room(it, t)
        try:
            it.factor.factorise(room, PROXIMAL * float(np.median(room[:, 0, 0])))
        except SingularMatrixError:
            return t
        for _ in range(ROUNDS):
            trial = t - times(room, it.rate(it.factor.solve(residual)))
            left = it.pull(trial) + load
            if not np.abs(left).max(initial=0.0) < np.abs(residual).max(initial=0.0):
                break
            t, residual = trial, left
        return t

    def real(self, t: Array) -> Array:
        """Return forces (m, d) [kN] of shifted ones in units of the programme."""
        forces: Array = (t - self.shift) * self.force
        return forces

    def velocity(self, v: Array) -> Array:
        """Return the motion (N,) of one of the programme, largest entry 1."""
        moved: Array = self.problem.R @ (v / self.scale)
        return moved / (float(np.abs(moved).max(initial=0.0)) or 1.0)

    def excess(self, t: Array, load: Array) -> float:
        """Return the largest entry of R'(load + C't) and of the excess over the strengths, over the total load."""
        problem = self.problem
        left = problem.R.T @ (load + problem.C_n.T @ t[:, 0] + problem.C_t.T @ t[:, 1:].ravel())
        over = problem.cone.excess(t[:, 0], t[:, 1:])
        worst = max(float(np.abs(left).max(initial=0.0)), float(over.max(initial=0.0)))
        return worst / (float(np.abs(load).sum()) or 1.0)

    def offset(self, load: Array) -> Array:
        """Return R'(load - C' of the shift of the forces) in units of the programme (r,)."""
        offset: Array = self.project(load) - self.programme.pull(self.shift)
        return offset

    def forces(self, normal: Array | None = None, close: float = np.inf) -> Balance:
        """Search forces in balance with the load of the problem.

        Parameters
        ----------
        normal : (m,) array, optional
            Normal forces [kN] with whose load the multiplied load begins, instead of one unit on every contact.
        close : float
            Largest gap, as a share of what the multiplier is away from 1, at which the programme may end as decided.
        """
        it, m = self.programme, self.problem.pairs
        ones, unit = np.zeros((m, self.problem.dim)), np.ones(m)
        if normal is not None:
            unit = normal / self.force + self.shift[:, 0]
            unit = np.maximum(unit, LEAST * float(unit.mean()))
        ones[:, 0] = np.minimum(unit, 0.5 * it.pairs.cone.cap)
        e, f = -(it.pull(ones)), self.offset(self.problem.f)
        g = f - e
        size = float(np.abs(g).max(initial=0.0))
        if not size > 0:
            return self._judged(ones, f, np.zeros_like(f), 1.0, ones)

        def decided(a: ConeAnswer) -> bool:
            if a.gap * max(1.0, abs(a.multiplier)) > close * abs(a.multiplier - size):
                return False
            carried = a.multiplier >= size and a.primal < PROGRAMME_SETTLED
            above = a.multiplier + a.gap * max(1.0, abs(a.multiplier))  # what the motion does not exceed
            return carried or (a.dual < PROGRAMME_SETTLED and CLEAR * (above - a.multiplier) < size - above)

        answer = maximise(it, e, g / size, start=ones, stop=decided)
        multiplier = answer.multiplier / size
        share = min(1.0 / multiplier, 1.0) if multiplier > 0 else 1.0
        t = (1.0 - share) * ones + share * answer.t
        return self._judged(t, f, answer.v, multiplier, answer.t)

    def _judged(self, t: Array, f: Array, v: Array, multiplier: float, at_bound: Array) -> Balance:
        real = self.real(t)
        residual = self.excess(real, self.problem.f)
        if multiplier >= 1.0 - 1e-9 and residual > PROGRAMME_ROUNDING:
            nearer = self.real(self.balance(t, f))
            left = self.excess(nearer, self.problem.f)
            real, residual = (nearer, left) if left < residual else (real, residual)
        return Balance(real, residual, self.velocity(v), multiplier, self.real(at_bound)[:, 0])

    def largest(self, live: Array, least: float = -np.inf, target: float = CONE_TARGET) -> Bounds:
        """Search the largest multiplier of the live load (N,) beside the load of the problem.

        Parameters
        ----------
        live : (N,) array
        least : float
            In units of the programme. A motion that excludes all multipliers from below this on ends the search without
            an answer, -inf: where no forces exist, the bound of the motions falls without bound.
        target : float
            Residuals and relative gap at which the search ends.
        """
        it = self.programme
        e, g = self.offset(self.problem.f), self.project(live)
        size = float(np.abs(g).max(initial=0.0))
        answer = maximise(it, e, g / size, stop=lambda a: a.multiplier > ENDLESS or a.bound < least, target=target)
        if answer.multiplier > ENDLESS:
            return Bounds(np.inf, self.real(answer.t), np.inf, self.velocity(answer.v))
        if answer.bound < least:
            return Bounds(-np.inf, self.real(answer.t), np.inf, self.velocity(answer.v))
        multiplier = answer.multiplier / size
        load = self.problem.f + multiplier * live
        t = self.real(answer.t)
        residual = self.excess(t, load)
        if residual > PROGRAMME_ROUNDING:
            nearer = self.real(self.balance(answer.t, e + answer.multiplier * (g / size)))
            left = self.excess(nearer, load)
            t, residual = (nearer, left) if left < residual else (t, residual)
        return Bounds(multiplier, t, residual, self.velocity(answer.v))


def _motions_of_bodies(problem: ContactProblem) -> Array:
    """Return the ranges of rigid motions that belong to one body each; single motions where they are not in order."""
    R = sp.csc_array(problem.R)
    r = R.shape[1]
    first = R.indices[R.indptr[:-1]] if r else np.zeros(0, dtype=int)
    body = np.searchsorted(problem.bodies, first, side="right") - 1
    if (np.diff(body) < 0).any():
        return np.arange(r + 1)
    return np.concatenate([[0], np.flatnonzero(np.diff(body)) + 1, [r]]) if r else np.zeros(1, dtype=int)


def _room(it: ConeProgramme, t: Array) -> Array:
    """Return the inverse Hessian (m, d, d) of a barrier of the cones: 1/sqrt(2) of its unit ball lies inside."""
    beta = it.strength(t)
    sized = np.maximum(determinant(beta), 0.0)
    cone = 2.0 * beta[:, :, None] * beta[:, None, :]
    mirror = -np.ones(it.pairs.dim)
    mirror[0] = 1.0
    cone -= sized[:, None, None] * np.diag(mirror)
    both = it.coulomb
    room = np.where(both[:, None, None], cone, 0.0)
    room[both, 0, :] /= it.mu[both, None]
    room[both, :, 0] /= it.mu[both, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        own = np.where(it.line, 1.0 / t[:, 0] ** 2, 0.0) + np.where(it.capped, 1.0 / (it.cap - t[:, 0]) ** 2, 0.0)
        share = np.where(own > 0, 1.0 / (1.0 / own + room[:, 0, 0]), 0.0)
    column = room[:, :, 0].copy()
    room -= share[:, None, None] * column[:, :, None] * column[:, None, :]
    room[~both, 0, 0] = np.divide(1.0, own, out=np.zeros_like(own), where=own > 0)[~both]
    tresca = it.rough & ~both
    side = beta[tresca, 1:]
    far = (beta[tresca] ** 2).sum(1)
    within = np.eye(it.pairs.dim - 1) - 2.0 * side[:, :, None] * side[:, None, :] / far[:, None, None]
    room[tresca, 1:, 1:] = sized[tresca, None, None] * within
    return room
