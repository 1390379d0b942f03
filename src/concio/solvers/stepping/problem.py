r"""The contact problem of one step, as the rows come from moving bodies.

.. math::

    A x &= b + C^T t, \qquad y_n = g + C_n x + a_n t_n - \tan\psi\,|y_t|, \qquad y_t = C_t x - s + a_t t_t,\\
    0 &\le y_n \perp t_n + T \ge 0, \qquad |t_t| \le c + \mu t_n, \quad t_t \text{ against } y_t,

with A positive definite (masses over the step, stiffness times the step), x a velocity or a displacement. It is a
:class:`concio.problem.contact_problem.ContactProblem` (:meth:`StepProblem.contact_problem`) in which nothing floats;
only its rows are kept dense on the few unknowns each meets, for they change in every step.

Residuals are those of the certificate, measured by a force F and a velocity U that are given: the loads, and what they
do to a free body within the step. At rest every velocity is zero, and the largest of them measures nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sp

from concio.problem.cone import Cone
from concio.problem.contact_problem import Array, ContactProblem, Laws
from concio.problem.pair_state import PairStates
from concio.solvers.stepping.matrix import FEW, StepMatrix

DELTA = 1e-6
"""Compliance added to closed pairs in the factorised matrix, over the typical flexibility of a pair."""

ENOUGH = 1e-3
"""Own compliance of a pair over that, from which on nothing is added.

Beside a compliance of their size refinement hardly converges where forces are redundant."""

GLUED = 1e6
"""Tensile strength of glued pairs over F, where a method needs a number for it."""


class Errors(NamedTuple):
    """What is left of the equations at a point.

    Parameters
    ----------
    r_u : (N,) array
        Forces out of balance.
    y_n : (m,) array
        Gaps, without what dilatancy takes.
    y_t : (m, d-1) array
        Slips.
    """

    r_u: Array
    y_n: Array
    y_t: Array


@dataclass(frozen=True, eq=False)
class StepProblem:
    """One step of a motion.

    Parameters
    ----------
    matrix : StepMatrix
        A.
    b : (N,) array
    columns : (m, w) integer array
        Unknowns of each pair's rows; N where there is none.
    values : (m, d, w) array
        Rows of C, normal first.
    gap : (m,) array
    origin : (m, d-1) array
        s.
    cone : Cone
        T is infinite for glued pairs, which hold in both directions, c for pinned ones, which never slip.
    a_n, a_t : (m,) arrays
    dilatancy : (m,) array
    active : (m,) boolean array
        Pairs that can carry force; the others are far apart.
    force, length : float
        F and U.
    """

    matrix: StepMatrix
    b: Array
    columns: Array
    values: Array
    gap: Array
    origin: Array
    cone: Cone
    a_n: Array
    a_t: Array
    dilatancy: Array
    active: Array
    force: float
    length: float

    @property
    def pairs(self) -> int:
        """Number m of pairs."""
        return len(self.gap)

    @property
    def dim(self) -> int:
        """Space dimension d."""
        return int(self.values.shape[1])

    @cached_property
    def glued(self) -> Array:
        """Pairs that hold in both directions along their normal (m,)."""
        return np.asarray(np.isinf(self.cone.tension))

    @cached_property
    def pinned(self) -> Array:
        """Pairs that never slip (m,)."""
        return np.asarray(np.isinf(self.cone.cohesion))

    @cached_property
    def dilates(self) -> bool:
        """Whether any pair opens as it slips."""
        return bool(self.dilatancy.any())

    @cached_property
    def flexibility(self) -> Array:
        """Displacement of each pair under a unit force along each direction, roughly: C diag(A)^-1 C' (m, d)."""
        inverse = self.matrix.inverse_diagonal[self.columns]
        found = np.asarray(np.matmul(self.values * self.values, inverse[:, :, None])[:, :, 0])
        if self.dim == 3:  # one for all tangents: states are read in units of it, and a slip keeps its direction
            found[:, 1:] = found[:, 1:].max(axis=1, keepdims=True)
        return found

    @cached_property
    def added(self) -> tuple[Array, Array]:
        """Compliances (m,) added along normal and tangent where a pair has next to none of its own."""
        flexible, zero = self.flexibility, np.zeros(self.pairs)
        most = flexible.max(axis=0, initial=0.0)
        found = []
        for k, own in enumerate((self.a_n, self.a_t)):
            if not self.pairs or own.min() > ENOUGH * DELTA * most[k]:
                found.append(zero)
                continue
            delta = DELTA * np.maximum(flexible[:, k], 1e-3 * flexible[:, k].mean())
            found.append(np.where(own > ENOUGH * delta, 0.0, delta))
        return found[0], found[1]

    @cached_property
    def rows(self) -> tuple[Any, Any]:
        """C and its transpose: dense where unknowns are few, sparse and with a last column of zeros elsewhere."""
        (m, d, w), n = self.values.shape, len(self.b)
        if n <= FEW:
            dense = np.zeros((m, d, n + 1))
            dense[np.arange(m)[:, None, None], np.arange(d)[:, None], self.columns[:, None, :]] = self.values
            few = dense.reshape(m * d, n + 1)[:, :n]
            return few, few.T
        columns = np.repeat(self.columns.astype(np.int32), d, axis=0).ravel()
        ends = np.arange(0, m * d * w + 1, w, dtype=np.int32)
        C = sp.csr_array((self.values.ravel(), columns, ends), shape=(m * d, n + 1))
        return C, C.T

    def share_rows(self, other: StepProblem) -> None:
        """Take over what was worked out of the same rows and the same matrix in another problem."""
        for name in ("rows", "flexibility") if self.matrix is other.matrix else ("rows",):
            if name in other.__dict__:
                self.__dict__[name] = other.__dict__[name]

    def opening(self, x: Array) -> Array:
        """Return C x (m, d), normal first."""
        C = self.rows[0]
        moved: Array = C @ (x if C.shape[1] == len(x) else np.append(x, 0.0))
        return moved.reshape(-1, self.values.shape[1])

    def pull(self, t: Array) -> Array:
        """Return C' t (N,) of forces (m, d)."""
        total: Array = (self.rows[1] @ t.ravel())[: len(self.b)]
        return total

    @property
    def plain(self) -> bool:
        """Whether every pair has friction only: no strength without compression, no cap, nothing glued."""
        return self.cone.plain

    def relative(self, x: Array, t: Array) -> tuple[Array, Array]:
        """Return y_n (m,) without dilatancy and y_t (m, d-1)."""
        y = self.opening(x)
        return self.gap + y[:, 0] + self.a_n * t[:, 0], y[:, 1:] - self.origin + self.a_t[:, None] * t[:, 1:]

    def errors(self, x: Array, t: Array) -> Errors:
        """Return what is left of the equations at a point."""
        return Errors(self.b + self.pull(t) - self.matrix.times @ x, *self.relative(x, t))

    def residual(self, x: Array, t: Array) -> tuple[float, Array]:
        """Return the worst relative violation of any equation, and that of the joint law of each pair (m,)."""
        return self.violation(t, self.errors(x, t))

    def violation(self, t: Array, errors: Errors) -> tuple[float, Array]:
        """Return the residual of a point with forces t whose errors are known."""
        left = largest(errors.r_u) / self.force
        _, y_n, y_t = errors
        cone, t_n, t_t = self.cone, t[:, 0], t[:, 1:]
        if self.plain and self.dim == 2:
            y, along, force = y_t[:, 0], t[:, 1], self.force
            law = np.abs(np.minimum(t_n / force, (y_n - self.dilatancy * np.abs(y)) / self.length))
            strength = cone.strength(t_n)
            trial = along - force / self.length * y
            wrong = np.abs(along - np.minimum(np.maximum(trial, -strength), strength)) / force
            idle = np.maximum(np.abs(t_n), np.abs(along)) / force
            simple: Array = np.where(self.active, np.maximum(law, wrong), idle)
            return max(left, largest(simple)), simple
        glued = self.glued
        slip = sizes(y_t) if self.dilates else np.zeros(len(t))
        y_n = (y_n - np.where(cone.rough & ~glued, self.dilatancy * slip, 0.0)) / self.length
        ratio = self.force / self.length
        p = t_n / self.force
        law = np.abs(p - np.clip(p - y_n, -cone.tension / self.force, cone.cap / self.force))
        with np.errstate(invalid="ignore"):
            strength = np.where(self.pinned, np.inf, cone.strength(t_n))
        trial = t_t - ratio * y_t
        size = sizes(trial)
        outside = size > strength
        shrink = np.where(outside, np.where(outside, strength, 1.0) / np.where(outside, size, 1.0), 1.0)
        wrong = np.abs(t_t - shrink[:, None] * trial)
        law = np.maximum(law, sizes(wrong) / self.force)
        idle = np.maximum(np.abs(t_n), np.abs(t_t).max(axis=1)) / self.force
        laws: Array = np.where(self.active, law, idle)
        return max(left, largest(laws)), laws

    def contact_problem(self) -> ContactProblem:
        """Return the same problem in the form every method takes, its active pairs only."""
        n, pick = len(self.b), np.flatnonzero(self.active)
        m, d, w = len(pick), self.dim, self.columns.shape[1]
        columns, values = self.columns[pick], self.values[pick]
        inside = (columns < n).ravel()
        row = np.repeat(np.arange(m), w)[inside]
        at = columns.ravel()[inside]

        def operator(k: int) -> tuple[Array, Array]:
            return row, values[:, k].ravel()[inside]

        C_n = sp.csr_array((operator(0)[1], (row, at)), shape=(m, n))
        parts = [((d - 1) * row + k, operator(k + 1)[1]) for k in range(d - 1)]
        rows = np.concatenate([*(p[0] for p in parts), np.zeros(0, dtype=int)])
        data = np.concatenate([*(p[1] for p in parts), np.zeros(0)])
        C_t = sp.csr_array((data, (rows.astype(int), np.tile(at, d - 1))), shape=(m * (d - 1), n))
        glue = GLUED * self.force
        cone = self.cone[pick]
        laws = Laws(
            friction=np.where(self.glued[pick] | self.pinned[pick], 0.0, cone.friction),
            cohesion=np.minimum(cone.cohesion, glue),
            tension=np.minimum(cone.tension, glue),
            dilatancy=self.dilatancy[pick],
            normal_compliance=self.a_n[pick],
            tangential_compliance=self.a_t[pick],
            cap=cone.cap,
        )
        return ContactProblem(
            K=self.matrix.sparse, f=self.b, C_n=C_n, C_t=C_t, gap=self.gap[pick], laws=laws, R=sp.csc_array((n, 0)),
            bodies=np.array([0, n]), slip_origin=self.origin[pick], load=self.force,
        )  # fmt: skip


def sizes(v: Array) -> Array:
    """Return the lengths (m,) of tangential vectors (m, d-1)."""
    return np.asarray(np.abs(v[:, 0]) if v.shape[1] == 1 else np.hypot(v[:, 0], v[:, 1]))


def largest(v: Array) -> float:
    """Return the largest absolute value, zero of none."""
    return float(np.abs(v).max()) if v.size else 0.0


@dataclass(frozen=True, eq=False)
class StepSolution:
    """Answer of one step.

    Parameters
    ----------
    x : (N,) array
    t : (m, d) array
        Forces, normal first [kN].
    states : PairStates
    residual : float
        Worst relative violation of any equation.
    how : str
        What found it.
    factorisations : int
    """

    x: Array
    t: Array
    states: PairStates
    residual: float
    how: str
    factorisations: int
