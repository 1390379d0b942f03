r"""The problem in units of its own with the d rows of each pair together, for cones of any dimension.

Lengths and forces are divided by ``length`` and ``force`` so that a typical pair carries one and a typical stiffness is
one, as measured on the glued structure (every pair held by two-sided springs of the typical stiffness: one
factorisation). Strengths are shifted so that every pair reads ``t_n' = t_n + T >= 0``, ``|t_t| <= c' + mu t_n'``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from concio.problem.cone import Cone
from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.tolerances import GRANTED, ROUNDING
from concio.solvers.algebra.block_factor import BlockFactor
from concio.solvers.algebra.dimensionless import interleaved
from concio.solvers.algebra.scaled import typical_stiffness
from concio.solvers.algebra.sparse_factor import Engine

GLUE = 1e-9
"""Springs that keep the factorisation of the glued structure finite where a body hangs on nothing, scaled units."""


@dataclass(frozen=True, eq=False)
class Interleaved:
    """A contact problem divided by its own force and length; all fields dimensionless, pair arrays (m, d).

    Parameters
    ----------
    problem : ContactProblem
    force, length : float
        What one unit of force [kN] and of length [m] is.
    K : (N, N) CSR array
    f : (N,) array
    C : (m d, N) CSR array
        Rows of each pair together, normal first.
    x : (m, d) array
        Initial gap less the share of the tension shift, a_n T; and minus the slip origin.
    compliance : (m, d) array
        a_n, and a_t in every tangential direction.
    cone : Cone
        Strengths of shifted forces.
    tension, dilatancy : (m,) arrays
    share, inertia : (m,), (N,) arrays
        Tributary area of each pair and mass of each unknown, over their means.
    rigid : (N, r) CSC array
        Rigid motions K does nothing to, orthonormal.
    factor : BlockFactor
    """

    problem: ContactProblem
    force: float
    length: float
    K: sp.csr_array
    f: Array
    C: sp.csr_array
    x: Array
    compliance: Array
    cone: Cone
    tension: Array
    dilatancy: Array
    share: Array
    inertia: Array
    rigid: sp.csc_array
    factor: BlockFactor

    @property
    def pairs(self) -> int:
        """Number m of pairs."""
        return int(self.x.shape[0])

    @property
    def dim(self) -> int:
        """Space dimension d."""
        return int(self.x.shape[1])

    @cached_property
    def transposed(self) -> sp.csr_array:
        """C' in compressed rows, for fast products."""
        return sp.csr_array(self.C.T)

    @cached_property
    def stiffness_size(self) -> sp.csr_array:
        """Absolute values of K."""
        return abs(self.K)

    def pull(self, t: Array) -> Array:
        """Return C' t (N,) of pair forces (m, d)."""
        nodal: Array = self.transposed @ t.ravel()
        return nodal

    def rate(self, v: Array) -> Array:
        """Return C v (m, d)."""
        moved: Array = (self.C @ v).reshape(self.x.shape)
        return moved

    def elastic(self, u: Array) -> Array:
        """Return K u (N,), free of the resultants that rounding gives it on bodies that float."""
        forces: Array = self.K @ u
        if self.rigid.shape[1]:
            forces -= self.rigid @ (self.rigid.T @ forces)
        return forces

    def imbalance(self, u: Array, t: Array) -> Array:
        """Return K u - f - C' t (N,) of shifted forces (m, d)."""
        real = t.copy()
        real[:, 0] -= self.tension
        rest: Array = self.elastic(u) - self.f - self.pull(real)
        return rest

    def unbalanced(self, u: Array, t: Array, force: float) -> float:
        """Return the largest imbalance beyond what the rounding of u explains, over ``force``."""
        known = np.minimum(ROUNDING * (self.stiffness_size @ np.abs(u)), GRANTED * force)
        return float((np.abs(self.imbalance(u, t)) - known).max(initial=0.0)) / force

    def opening(self, u: Array, t: Array) -> Array:
        """Return gap without dilatancy and slip, x + C u + a t (m, d), of shifted forces."""
        y: Array = self.x + self.rate(u) + self.compliance * t
        return y

    def step_from(self, u: Array, e: float, forces: Array | None = None) -> Interleaved:
        """Return the problem of one step of slow motion from ``u`` (N,), its unknowns counted from there.

        K + e M stands for K; loads, gaps and slip origins are those left at ``u``.

        Parameters
        ----------
        u : (N,) array
        e : float
        forces : (m, d) array, optional
            Shifted forces at ``u``. Where given, slip is measured from there (friction opposes the rate of slip), else
            from the beginning.
        """
        added = e * self.inertia
        x = self.x + self.rate(u)
        if forces is not None:
            slip = x[:, 1:] + self.compliance[:, 1:] * forces[:, 1:]
            x[:, 0] -= self.dilatancy * np.linalg.norm(slip, axis=1)
            x[:, 1:] -= slip
        held = x[:, 0] * self.length + self.problem.laws.normal_compliance * self.problem.laws.tension
        problem = replace(self.problem, gap=held, slip_origin=-x[:, 1:] * self.length)
        return replace(
            self,
            problem=problem,
            K=sp.csr_array(self.K + sp.diags_array(added)),
            f=self.f - self.elastic(u),
            rigid=sp.csc_array((len(u), 0)),
            x=x,
            factor=self.factor.with_diagonal(added),
        )

    def acceleration(self, a: Array) -> Array:
        """Return the accelerations [m/s2] that belong to scaled ones, M a = F m' a'."""
        physical: Array = a * (self.force / self.problem.inertia.mean())
        return physical

    def restore(self, u: Array, t: Array) -> tuple[Array, Array, Array]:
        """Return u [m], t_n and t_t [kN] of the original problem."""
        return u * self.length, (t[:, 0] - self.tension) * self.force, t[:, 1:] * self.force


def interleave(problem: ContactProblem, engine: Engine = "superlu") -> Interleaved:
    """Bring a problem of any dimension to units of its own, rows of each pair together."""
    law, m, d = problem.laws, problem.pairs, problem.dim
    stiffness = typical_stiffness(problem)
    K = sp.csr_array(problem.K * (1.0 / stiffness))
    C = interleaved(problem)
    factor = BlockFactor(K, C, m, problem.bodies, engine)
    compliance = np.column_stack([law.normal_compliance, *[law.tangential_compliance] * (d - 1)]) * stiffness
    spring = 1.0 / (1.0 + compliance)
    factor.factorise(spring[:, :, None] * np.eye(d), GLUE)
    gaps = np.column_stack([problem.gap, -problem.slip_origin])
    if problem.f.any():
        gaps[:, 0] = np.minimum(gaps[:, 0], 0.0)
    pressed = spring * gaps
    u = factor.solve(problem.f / stiffness - C.T @ pressed.ravel())
    t = spring * (C @ u).reshape(m, d) + pressed
    size = np.sqrt(np.mean(t**2)) if m else 0.0
    length = float(size) if np.isfinite(size) and size > 0 else 1.0
    force = length * stiffness
    return Interleaved(
        problem=problem,
        force=force,
        length=length,
        K=K,
        f=problem.f / force,
        C=C,
        x=np.column_stack([problem.gap - law.normal_compliance * law.tension, -problem.slip_origin]) / length,
        compliance=compliance,
        cone=problem.cone.in_units(force).shifted,
        tension=law.tension / force,
        dilatancy=np.where(problem.cone.rough, law.dilatancy, 0.0),
        share=problem.area_share,
        inertia=problem.inertia / problem.inertia.mean(),
        rigid=problem.R,
        factor=factor,
    )
