"""The contact problem in units of its own: a typical pair carries 1, a typical stiffness is 1.

Penalty numbers, step lengths and tolerances of iterative methods mean something only relative to the forces and
stiffnesses of the structure. :func:`dimensionless` measures both on the *glued* structure (all pairs closed by springs
of the typical stiffness, two-sided: one factorisation, regular although ``K`` is singular) and divides by them; every
method of the family iterates on the :class:`Dimensionless` problem, whose answers do not depend on the user's units.

Rows of ``C`` are interleaved here: pair k owns rows ``k d`` (normal) and ``k d + 1 ... k d + d - 1`` (tangential), so
that forces and gaps are (m, d) arrays.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import SuperLU, splu

from concio.problem.cone import Cone
from concio.problem.contact_problem import Array, ContactProblem

PROXIMAL = 1e-9
"""Relative regularisation that keeps a factorisation finite where a body hangs on nothing."""


@dataclass(frozen=True, eq=False)
class Dimensionless:
    """A contact problem in units of its own force and length.

    Parameters
    ----------
    force, length : float
        What one unit of force [kN] and of length [m] is.
    K : (N, N) CSC array
    f : (N,) array
    C : (m d, N) CSR array
        Interleaved rows, normal first.
    x : (m, d) array
        Initial gap, and minus the slip origin.
    compliance : (m, d) array
        a_n and a_t.
    dilatancy : (m,) array
        tan(psi), zero where a pair has no friction (nothing to dilate against).
    cone : Cone
    u, t : (N,), (m, d) arrays
        Displacements and forces of the glued structure, brought into the cone: where iterations start.
    """

    force: float
    length: float
    K: sp.csc_array
    f: Array
    C: sp.csr_array
    x: Array
    compliance: Array
    dilatancy: Array
    cone: Cone
    u: Array
    t: Array

    @property
    def pairs(self) -> int:
        """Number of pairs."""
        return int(self.x.shape[0])

    @property
    def deforms(self) -> bool:
        """False for rigid bodies in hard joints: displacements have no scale of their own there."""
        return bool(self.K.nnz) or bool(self.compliance.any())

    @property
    def dim(self) -> int:
        """Space dimension."""
        return int(self.x.shape[1])

    def opening(self, u: Array) -> Array:
        """Gap and slip x + C u (m, d), compliance and dilatancy not yet counted."""
        gaps: Array = self.x + (self.C @ u).reshape(self.x.shape)
        return gaps

    def pull(self, t: Array) -> Array:
        """Nodal forces C' t (N,) of pair forces (m, d)."""
        nodal: Array = self.C.T @ t.ravel()
        return nodal

    def imbalance(self, u: Array, t: Array) -> Array:
        """K u - f - C' t (N,), equation (12)."""
        rest: Array = self.K @ u - self.f - self.pull(t)
        return rest

    def natural_map(self, u: Array, t: Array) -> Array:
        """Return t minus the return map of t - y, (m, d); zero exactly where the joint laws hold."""
        y = self.opening(u) + self.compliance * t
        distance: Array = t - self.cone.project(t - y, self.dilatancy)
        return distance

    def residual(self, u: Array, t: Array) -> float:
        """Bound on the certificate: imbalance over the load, natural map over the smaller of load and displacement."""
        load = float(np.abs(self.f).sum()) or max(float(np.abs(t).max(initial=0.0)), PROXIMAL)
        size = max(float(np.abs(u).max(initial=0.0)), PROXIMAL if self.deforms else 1.0)
        imbalance = float(np.abs(self.imbalance(u, t)).max(initial=0.0))
        law = float(np.abs(self.natural_map(u, t)).max(initial=0.0))
        return max(imbalance / load, law / min(load, size, 1.0))

    def restore(self, u: Array, t: Array) -> tuple[Array, Array, Array]:
        """Return displacements [m], normal forces and friction forces [kN] in the units of the original problem."""
        return u * self.length, t[:, 0] * self.force, t[:, 1:] * self.force


def factorise(matrix: sp.csc_array) -> SuperLU:
    """Factorise a matrix of symmetric structure (SuperLU, symmetric mode)."""
    return splu(
        sp.csc_matrix(matrix), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.01, options={"SymmetricMode": True}
    )


def interleaved(problem: ContactProblem) -> sp.csr_array:
    """Return C with the rows of each pair together, normal first, shape (m d, N)."""
    m, d = problem.pairs, problem.dim
    order = np.column_stack([np.arange(m), m + np.arange(m * (d - 1)).reshape(m, d - 1)]).ravel()
    return sp.csr_array(sp.csr_array(problem.C)[order])


def dimensionless(problem: ContactProblem) -> Dimensionless:
    """Bring a problem to units of its own."""
    m, d, laws = problem.pairs, problem.dim, problem.laws
    c, n = interleaved(problem), problem.unknowns
    compliance = np.column_stack([laws.normal_compliance, *[laws.tangential_compliance] * (d - 1)])
    x = np.column_stack([problem.gap, -problem.slip_origin])
    touched = np.asarray(abs(c).sum(axis=0)).ravel() > 0
    stiff = problem.K.diagonal()[touched]
    stiff = stiff[stiff > 0] if (stiff > 0).any() else 1.0 / compliance[compliance > 0]
    total = float(np.abs(problem.f).sum()) or 1.0
    stiffness = float(np.exp(np.log(stiff).mean())) if stiff.size else total

    glued = sp.csc_array(problem.K + stiffness * (c.T @ c) + 1e-8 * stiffness * sp.eye_array(n))
    lu = factorise(glued)
    start = x * (0.0 if problem.f.any() else 1.0)
    u = lu.solve(problem.f - stiffness * (c.T @ start.ravel()))
    t = -stiffness * (start + (c @ u).reshape(m, d))
    force = float(np.sqrt((t**2).sum(axis=1).mean())) if m else 0.0
    force = force if np.isfinite(force) and force > 0 else 1.0
    length = force / stiffness
    cone = laws.cone.in_units(force)
    return Dimensionless(
        force=force,
        length=length,
        K=sp.csc_array(problem.K * (1.0 / stiffness)),
        f=problem.f / force,
        C=c,
        x=x / length,
        compliance=compliance * stiffness,
        dilatancy=np.where(cone.rough, laws.dilatancy, 0.0),
        cone=cone,
        u=u / length,
        t=cone.project(t / force),
    )
