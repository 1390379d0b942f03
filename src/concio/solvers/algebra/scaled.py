r"""The plane problem in units of its own, with what the engine factorises again and again.

Lengths and forces are divided by ``U`` and ``F`` so that a typical pair carries one and a typical stiffness is one;
``F`` is measured on the glued structure (every pair held by two-sided springs of the typical stiffness), which costs
one factorisation. Strengths are shifted so that every pair reads ``t_n' = t_n + T >= 0``, ``|t_t| <= c' + mu t_n'``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from concio.errors import MethodError
from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.tolerances import GRANTED, ROUNDING, SMOOTH
from concio.solvers.algebra.sparse_factor import Engine, PatternFactor


@dataclass(frozen=True, eq=False)
class Scaled:
    """A plane contact problem divided by its own force and length; all fields dimensionless.

    Parameters
    ----------
    problem : ContactProblem
    force, length : float
        F [kN] and U [m].
    K, C_n, C_t : CSR arrays
        Stiffness over F/U, and the operators of the problem.
    f : (N,) array
        Loads over F.
    gap, origin : (m,) arrays
        Initial gap and slip origin over U. The gap holds the share of the tension shift: x_n - a_n T.
    mu, cohesion, tension, dilatancy, a_n, a_t, cap : (m,) arrays
        Shifted laws: ``cohesion`` is c - mu T, ``cap`` is N + T.
    rough : (m,) boolean array
        Pairs that can carry friction at all; coefficients below 1e-12 count as none.
    share : (m,) array
        Tributary area of each pair over the mean, kept between 0.05 and 20.
    inertia : (N,) array
        Mass of each unknown over the mean.
    rigid : (N, r) CSC array
        Rigid motions K does nothing to, orthonormal; none where K holds them (:meth:`step_from`).
    factor : PatternFactor
        Factorises K + C' D C; couples are (n,n), (n,t), (t,n), (t,t), pair after pair within each.
    """

    problem: ContactProblem
    force: float
    length: float
    K: sp.csr_array
    C_n: sp.csr_array
    C_t: sp.csr_array
    f: Array
    gap: Array
    origin: Array
    mu: Array
    cohesion: Array
    tension: Array
    dilatancy: Array
    a_n: Array
    a_t: Array
    cap: Array
    rough: Array
    share: Array
    inertia: Array
    rigid: sp.csc_array
    factor: PatternFactor

    @property
    def pairs(self) -> int:
        """Number m of pairs."""
        return len(self.gap)

    @cached_property
    def transposed(self) -> tuple[sp.csr_array, sp.csr_array]:
        """C_n' and C_t' in compressed rows, for fast products."""
        return sp.csr_array(self.C_n.T), sp.csr_array(self.C_t.T)

    def pull(self, t_n: Array, t_t: Array) -> Array:
        """Return C_n' t_n + C_t' t_t (N,)."""
        nodal: Array = self.transposed[0] @ t_n + self.transposed[1] @ t_t
        return nodal

    @cached_property
    def stiffness_size(self) -> sp.csr_array:
        """Absolute values of K."""
        return abs(self.K)

    def elastic(self, u: Array) -> Array:
        """Return K u (N,), free of the resultants that rounding gives it on bodies that float."""
        forces: Array = self.K @ u
        if self.rigid.shape[1]:
            forces -= self.rigid @ (self.rigid.T @ forces)
        return forces

    def imbalance(self, u: Array, t_n: Array, t_t: Array) -> Array:
        """Return K u - f - C' t with shifted normal forces t_n' (N,)."""
        rest: Array = self.elastic(u) - self.f - self.pull(t_n - self.tension, t_t)
        return rest

    def unbalanced(self, u: Array, t_n: Array, t_t: Array, force: float) -> float:
        """Return the largest imbalance beyond what the rounding of u explains, over the largest force."""
        known = np.minimum(ROUNDING * (self.stiffness_size @ np.abs(u)), GRANTED * force)
        return float((np.abs(self.imbalance(u, t_n, t_t)) - known).max(initial=0.0)) / force

    def normal_gap(self, u: Array, t_n: Array) -> Array:
        """Return x_n + C_n u + a_n t_n without dilatancy, t_n' shifted (m,)."""
        gap: Array = self.gap + self.C_n @ u + self.a_n * t_n
        return gap

    def slip(self, u: Array, t_t: Array) -> Array:
        """Return y_t = C_t u - s + a_t t_t (m,)."""
        slip: Array = self.C_t @ u - self.origin + self.a_t * t_t
        return slip

    def step_from(self, u: Array, e: float) -> Scaled:
        """Return the problem of one step of slow motion from ``u`` (N,), its unknowns counted from there.

        K + e M stands for K; loads, gaps and slip origins are those left at ``u``.
        """
        added = e * self.inertia
        moved = self.problem.C @ (u * self.length)
        m = self.pairs
        return replace(
            self,
            problem=replace(
                self.problem,
                gap=self.problem.gap + moved[:m],
                slip_origin=self.problem.slip_origin - moved[m:, None],
            ),
            K=sp.csr_array(self.K + sp.diags_array(added)),
            f=self.f - self.elastic(u),
            rigid=sp.csc_array((len(u), 0)),
            gap=self.gap + moved[:m] / self.length,
            origin=self.origin - moved[m:] / self.length,
            factor=self.factor.with_diagonal(added),
        )

    def acceleration(self, a: Array) -> Array:
        """Return the accelerations [m/s2] that belong to scaled ones, M a = F m' a'."""
        physical: Array = a * (self.force / self.problem.inertia.mean())
        return physical

    def restore(self, u: Array, t_n: Array, t_t: Array) -> tuple[Array, Array, Array]:
        """Return u [m], t_n and t_t [kN] of the original problem."""
        return u * self.length, (t_n - self.tension) * self.force, t_t * self.force


def scale(problem: ContactProblem, engine: Engine = "superlu") -> Scaled:
    """Bring a plane problem to units of its own.

    Raises
    ------
    MethodError
        The problem is not plane.
    """
    if problem.dim != 2:
        msg = "this method solves plane problems"
        raise MethodError(msg, hint="use a method that lists three dimensions")
    law, m = problem.laws, problem.pairs
    stiffness = typical_stiffness(problem)
    K = sp.csr_array(problem.K * (1.0 / stiffness))
    C = problem.C
    n, t = np.arange(m), m + np.arange(m)
    couples = np.column_stack([np.concatenate([n, n, t, t]), np.concatenate([n, t, n, t])])
    factor = PatternFactor(K, C, couples, engine)
    spring = 1.0 / (1.0 + law.normal_compliance * stiffness)
    shear = 1.0 / (1.0 + law.tangential_compliance * stiffness)
    zero = np.zeros(m)
    factor.factorise(np.concatenate([spring, zero, zero, shear]), 1e-9)
    loads, gaps = problem.f / stiffness, np.concatenate([problem.gap, -problem.slip_origin[:, 0]])
    pressed = np.concatenate([spring, shear]) * (gaps if not problem.f.any() else np.minimum(gaps, 0.0))
    u = factor.solve(loads - C.T @ pressed)
    t = np.concatenate([spring, shear]) * (C @ u) + pressed
    size = np.sqrt(np.mean(t**2)) if m else 0.0
    length = float(size) if np.isfinite(size) and size > 0 else 1.0
    force = length * stiffness
    return Scaled(
        problem=problem,
        force=force,
        length=length,
        K=K,
        C_n=sp.csr_array(problem.C_n),
        C_t=sp.csr_array(problem.C_t),
        f=problem.f / force,
        gap=(problem.gap - law.normal_compliance * law.tension) / length,
        origin=problem.slip_origin[:, 0] / length,
        mu=np.where(law.friction > SMOOTH, law.friction, 0.0),
        cohesion=law.cone.spare / force,
        tension=law.tension / force,
        dilatancy=law.dilatancy,
        a_n=law.normal_compliance * stiffness,
        a_t=law.tangential_compliance * stiffness,
        cap=(law.cap + law.tension) / force,
        rough=law.cone.rough,
        share=problem.area_share,
        inertia=problem.inertia / problem.inertia.mean(),
        rigid=problem.R,
        factor=factor,
    )


def typical_stiffness(problem: ContactProblem) -> float:
    """Return the geometric mean of the stiffnesses met at the pairs [kN/m]; 1 for rigid bodies with hard joints."""
    touched = np.asarray(abs(problem.C).sum(axis=0)).ravel() > 0
    diagonal = problem.K.diagonal()[touched]
    springs = [c[c > 0] for c in (problem.laws.normal_compliance, problem.laws.tangential_compliance)]
    found = np.concatenate([diagonal[diagonal > 0], *(1.0 / c for c in springs)])
    if found.size:
        return float(np.exp(np.log(found).mean()))
    return float(np.abs(problem.f).sum()) or 1.0
