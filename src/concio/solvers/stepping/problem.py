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

import numpy as np
import scipy.sparse as sp

from concio.problem.cone import Cone
from concio.problem.contact_problem import Array, ContactProblem, Laws

GLUED = 1e6
"""Tensile strength of glued pairs over F, where a method needs a number for it."""


@dataclass(frozen=True, eq=False)
class StepProblem:
    """One step of a motion.

    Parameters
    ----------
    matrix : (N, N) CSR array
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

    matrix: sp.csr_array
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
    def diagonal(self) -> Array:
        """Diagonal of A (N,)."""
        return np.asarray(self.matrix.diagonal())

    @cached_property
    def flexibility(self) -> Array:
        """Displacement of each pair under a unit force along each direction, roughly: C diag(A)^-1 C' (m, d)."""
        inverse = np.append(1.0 / self.diagonal, 0.0)
        return np.asarray(np.einsum("mdw,mdw,mw->md", self.values, self.values, inverse[self.columns]))

    def opening(self, x: Array) -> Array:
        """Return C x (m, d), normal first."""
        extended = np.append(x, 0.0)
        moved: Array = np.matmul(self.values, extended[self.columns][:, :, None])[:, :, 0]
        return moved

    def pull(self, t: Array) -> Array:
        """Return C' t (N,) of forces (m, d)."""
        nodal = np.matmul(t[:, None, :], self.values)[:, 0]
        total: Array = np.bincount(self.columns.ravel(), weights=nodal.ravel(), minlength=len(self.b) + 1)[
            : len(self.b)
        ]
        return total

    def relative(self, x: Array, t: Array) -> tuple[Array, Array]:
        """Return y_n (m,) without dilatancy and y_t (m, d-1)."""
        y = self.opening(x)
        return self.gap + y[:, 0] + self.a_n * t[:, 0], y[:, 1:] - self.origin + self.a_t[:, None] * t[:, 1:]

    def residual(self, x: Array, t: Array) -> tuple[float, Array]:
        """Return the worst relative violation of any equation, and that of the joint law of each pair (m,)."""
        left = np.abs(self.matrix @ x - self.b - self.pull(t)).max(initial=0.0) / self.force
        y_n, y_t = self.relative(x, t)
        cone, t_n, t_t = self.cone, t[:, 0], t[:, 1:]
        glued = self.glued
        slip = np.abs(y_t[:, 0]) if self.dim == 2 else np.linalg.norm(y_t, axis=1)
        y_n = (y_n - np.where(cone.rough & ~glued, self.dilatancy * slip, 0.0)) / self.length
        ratio = self.force / self.length
        p = t_n / self.force
        law = np.abs(p - np.clip(p - y_n, -cone.tension / self.force, cone.cap / self.force))
        with np.errstate(invalid="ignore"):
            strength = np.where(self.pinned, np.inf, np.maximum(cone.cohesion + cone.friction * t_n, 0.0))
        trial = t_t - ratio * y_t
        size = np.abs(trial[:, 0]) if self.dim == 2 else np.linalg.norm(trial, axis=1)
        outside = size > strength
        shrink = np.where(outside, np.where(outside, strength, 1.0) / np.where(outside, size, 1.0), 1.0)
        wrong = np.abs(t_t - shrink[:, None] * trial)
        law = np.maximum(law, (wrong[:, 0] if self.dim == 2 else np.linalg.norm(wrong, axis=1)) / self.force)
        idle = np.maximum(np.abs(t_n), np.abs(t_t).max(axis=1)) / self.force
        laws: Array = np.where(self.active, law, idle)
        return float(max(left, laws.max(initial=0.0))), laws

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
            K=self.matrix, f=self.b, C_n=C_n, C_t=C_t, gap=self.gap[pick], laws=laws, R=sp.csc_array((n, 0)),
            bodies=np.array([0, n]), slip_origin=self.origin[pick], load=self.force,
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class StepStates:
    """States of the pairs of a step.

    Parameters
    ----------
    contact : (m,) integer array
        0 open, 1 closed, 2 crushed.
    slip : (m,) integer array
        Sign of the slip; 0 where a pair sticks.
    """

    contact: Array
    slip: Array

    def same(self, other: StepStates) -> bool:
        """Return whether all states are the same."""
        return bool((self.contact == other.contact).all() and (self.slip == other.slip).all())


@dataclass(frozen=True, eq=False)
class StepSolution:
    """Answer of one step.

    Parameters
    ----------
    x : (N,) array
    t : (m, d) array
        Forces, normal first [kN].
    states : StepStates
    residual : float
        Worst relative violation of any equation.
    how : str
        What found it.
    factorisations : int
    """

    x: Array
    t: Array
    states: StepStates
    residual: float
    how: str
    factorisations: int
