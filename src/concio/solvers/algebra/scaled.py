r"""A contact problem in units of its own, in the plane and in space, with what is factorised again and again.

Lengths and forces are divided by ``U`` and ``F`` so that a typical pair carries one and a typical stiffness is one.
``F`` is measured on the *glued* structure (every pair held by two-sided springs of about the typical stiffness, in
series with its own compliance), which is regular although ``K`` is singular. In the plane these are the springs of the
point where the interior point begins, so that its first system is factorised already. Penalties, step lengths and
tolerances of the methods mean something in these units only, and no answer depends on the user's.

Strengths are shifted by the tensile strength, so that every pair reads ``p = t_n + T >= 0``, ``|t_t| <= c' + mu p``:
the cone has no tension, loads hold the share ``-C_n' T`` of the shift and gaps the share ``-a_n T``. Rows of ``C`` are
interleaved: pair k owns rows ``k d`` (normal) to ``k d + d - 1`` (tangential). Forces and gaps are (m, d) arrays, and
``[:, 0]`` and ``[:, 1:]`` their normal and tangential parts.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp

from concio.problem.cone import Cone
from concio.problem.contact_problem import Array, ContactProblem, Engine
from concio.problem.natural_map import natural_map
from concio.problem.once import once
from concio.problem.products import product, product_of_sizes
from concio.problem.tolerances import BALANCE_ROUNDING, GRANTED, SMOOTH
from concio.solvers.algebra.block_factor import BlockFactor
from concio.solvers.algebra.scales import compliances, interleaved, softness, typical_stiffness

LOOSE = 1e-10
"""Stiffness of the springs that keep unknowns which nothing holds where they are, scaled units."""


@dataclass(frozen=True, eq=False)
class Scaled:
    """A contact problem divided by its own force and length; all fields dimensionless.

    Parameters
    ----------
    problem : ContactProblem
    force, length : float
        F [kN] and U [m].
    K : (N, N) CSR array
        Stiffness over F/U.
    C : (m d, N) CSR array
        Interleaved rows, normal first.
    f : (N,) array
        Loads over F, with the share of the shift.
    x : (m, d) array
        Initial gap with the share of the shift, and minus the slip origin, over U.
    cone : Cone
        Shifted: without tension.
    shift : (m,) array
        By how much normal forces are shifted [kN]: t_n + shift are the forces here; the tensile strength of each pair.
    dilatancy : (m,) array
        tan(psi); zero where a pair cannot carry friction.
    compliance : (m, d) array
        a_n and a_t.
    inertia : (N, N) CSR array
        Mass matrix over the mean of its diagonal.
    rigid : (N, r) CSC array
        Rigid motions K does nothing to, orthonormal; none where K holds them (:meth:`step_from`).
    factor : BlockFactor
        Factorises K + C' D C + diagonal for blocks D (m, d, d).
    glued : (N,) array
        Displacements of the glued structure.
    """

    problem: ContactProblem
    force: float
    length: float
    K: sp.csr_array
    C: sp.csr_array
    f: Array
    x: Array
    cone: Cone
    shift: Array
    dilatancy: Array
    compliance: Array
    inertia: sp.csr_array
    rigid: sp.csc_array
    factor: BlockFactor
    glued: Array

    @property
    def pairs(self) -> int:
        """Number m of pairs."""
        return len(self.x)

    @property
    def dim(self) -> int:
        """Space dimension d."""
        return int(self.x.shape[1])

    @property
    def rough(self) -> Array:
        """Pairs that can carry friction at all, (m,) booleans."""
        return self.cone.rough

    @cached_property
    def any_smooth(self) -> bool:
        """Whether any pair cannot carry friction."""
        return not bool(self.rough.all())

    @cached_property
    def any_capped(self) -> bool:
        """Whether any pair crushes."""
        return bool(self.cone.capped.any())

    @property
    def share(self) -> Array:
        """Tributary area of each pair over the mean, kept between 0.05 and 20 (m,)."""
        return self.problem.area_share

    @property
    def deforms(self) -> bool:
        """False for rigid bodies in hard joints: displacements have no scale of their own there."""
        return bool(self.K.nnz) or bool(self.compliance.any())

    @cached_property
    def transposed(self) -> sp.csr_array:
        """C' in compressed rows, for fast products."""
        return sp.csr_array(self.C.T)

    @cached_property
    def rigid_transposed(self) -> sp.csr_array:
        """The rigid motions in compressed rows, transposed."""
        return sp.csr_array(self.rigid.T)

    # -- equations ------------------------------------------------------------------------------------------------

    def along(self, v: Array) -> Array:
        """Return C v (m, d), the relative displacements of the pairs in a motion v (N,)."""
        return product(self.C, v).reshape(self.x.shape)

    def opening(self, u: Array) -> Array:
        """Return x + C u (m, d): gap and slip, compliance and dilatancy not yet counted."""
        return np.asarray(self.x + self.along(u))

    def position(self, u: Array, t: Array) -> Array:
        """Return x + C u + a t (m, d): gap without dilatancy, and slip."""
        return np.asarray(self.opening(u) + self.compliance * t)

    def pull(self, t: Array) -> Array:
        """Return the nodal forces C' t (N,) of pair forces (m, d)."""
        return product(self.transposed, t.ravel())

    def elastic(self, u: Array) -> Array:
        """Return K u (N,), free of the resultants that rounding gives it on bodies that float."""
        forces = product(self.K, u)
        if self.rigid.shape[1]:
            forces -= product(self.rigid, product(self.rigid_transposed, forces))
        return forces

    def imbalance(self, u: Array, t: Array) -> Array:
        """Return K u - f - C' t (N,), equation (12)."""
        rest: Array = self.elastic(u) - self.f - self.pull(t)
        return rest

    def unbalanced(self, u: Array, t: Array, force: float) -> float:
        """Return the largest imbalance beyond what the rounding of u explains, over the largest force."""
        known = np.minimum(BALANCE_ROUNDING * product_of_sizes(self.K, np.abs(u)), GRANTED * force)
        return float((np.abs(self.imbalance(u, t)) - known).max(initial=0.0)) / force

    def natural_map(self, u: Array, t: Array, unit: float = 1.0) -> Array:
        """Return t minus the return map of t - unit y, (m, d); zero exactly where the joint laws hold.

        Parameters
        ----------
        u, t : (N,), (m, d) arrays
        unit : float
            Force that counts as much as a length of one.
        """
        return natural_map(self.cone, self.weighted(u, t, unit), t, self.dilatancy)

    def weighted(self, u: Array, t: Array, unit: float) -> Array:
        """Return gap without dilatancy and slip (m, d) times a force ``unit``; no slip where pairs are smooth."""
        y = self.position(u, t) * unit
        if self.any_smooth:
            y[~self.rough, 1:] = 0.0
        return y

    # -- other data, other units ----------------------------------------------------------------------------------

    def step_from(self, u: Array, e: float, forgotten: Array | None = None) -> Scaled:
        """Return the problem of one step of slow motion from ``u`` (N,), its unknowns counted from there.

        K + e M stands for K; loads, gaps and slip origins are those left at ``u``.

        Parameters
        ----------
        u : (N,) array
        e : float
        forgotten : (m, d) array, optional
            Gap and slip that pairs forget at ``u``: their friction opposes the slip made from there on.
        """
        added, K, stiffness = self._resisting(e)
        moved = self.along(u) if forgotten is None else self.along(u) - forgotten
        problem, m, left = self.problem, self.pairs, self.elastic(u)
        return replace(
            self,
            problem=replace(
                problem,
                K=stiffness,
                f=problem.f - left * self.force,
                R=sp.csc_array((len(u), 0)),
                gap=problem.gap + moved[:, 0] * self.length,
                slip_origin=problem.slip_origin - moved[:, 1:].reshape(m, -1) * self.length,
            ),
            K=K,
            f=self.f - left,
            rigid=sp.csc_array((len(u), 0)),
            x=self.x + moved,
            factor=self.factor.with_added(added),
        )

    def _resisting(self, e: float) -> tuple[sp.csr_array, sp.csr_array, sp.csr_array]:
        """Return e M, K + e M, and the same unscaled: those of the last e are kept, as steps of one e follow others."""
        if self._resisted.get("e") != e:
            added = e * self.inertia
            K = sp.csr_array(self.K + added)
            unscaled = sp.csr_array(K * (self.force / self.length))
            self._resisted.update(e=e, matrices=(added, K, unscaled))
        matrices: tuple[sp.csr_array, sp.csr_array, sp.csr_array] = self._resisted["matrices"]
        return matrices

    @cached_property
    def _resisted(self) -> dict[str, Any]:
        """What :meth:`_resisting` keeps."""
        return {}

    def renewed(self, other: ContactProblem) -> Scaled:
        """Return another problem of the same bodies and pairs in the same units: other loads, gaps, origins, laws.

        K, C, ordering and factor are shared, and so is what is kept with the factor.
        """
        return replace(self, problem=other, **_in_units(other, self.C, self.force, self.length))

    def acceleration(self, a: Array) -> Array:
        """Return the accelerations [m/s2] that belong to scaled ones, M a = F m' a'."""
        physical: Array = a * (self.force / _mean_mass(self.problem))
        return physical

    def restore(self, u: Array, t: Array) -> tuple[Array, Array, Array]:
        """Return u (N,) [m], t_n (m,) and t_t (m, d-1) [kN] of the original problem."""
        return u * self.length, t[:, 0] * self.force - self.shift, t[:, 1:] * self.force

    def bring(self, u: Array, t_n: Array, t_t: Array) -> tuple[Array, Array]:
        """Return u (N,) and t (m, d), scaled, of displacements [m] and forces [kN] of the original problem."""
        t = np.column_stack([t_n + self.shift, t_t.reshape(self.pairs, -1)]) / self.force
        return u / self.length, t

    @property
    def unstressed(self) -> Array:
        """Forces (m, d) of pairs that carry nothing: of forces that are left open those nearest to these are taken."""
        return np.column_stack([self.shift / self.force, np.zeros((self.pairs, self.dim - 1))])

    def unshifted(self) -> Scaled:
        """Return the same in forces that are not shifted: strengths far above the loads cost no digits then."""
        return replace(self, **_in_units(self.problem, self.C, self.force, self.length, np.zeros(self.pairs)))

    @cached_property
    def bonded(self) -> Array:
        """Forces of the glued structure (m, d)."""
        springs = 1.0 / (softness(self.problem) + self.compliance)
        held = self.x if not self.problem.f.any() else np.minimum(self.x, 0.0)
        return np.asarray(self.unstressed - springs * (held + self.along(self.glued)))

    @cached_property
    def start(self) -> Array:
        """Forces of the glued structure brought into the cones (m, d): where iterations start."""
        return self.cone.project(self.bonded)

    @property
    def outside(self) -> float:
        """Largest distance of a force of the glued structure from its cone, over the largest of them."""
        largest = float(np.abs(self.bonded).max(initial=0.0))
        return float(np.abs(self.bonded - self.start).max(initial=0.0)) / largest if largest else 0.0


def scale(problem: ContactProblem) -> Scaled:
    """Bring a problem to units of its own."""
    m, d = problem.pairs, problem.dim
    stiffness, K, C, factor = _matrices(problem, problem.engine)
    springs = 1.0 / (softness(problem) + compliances(problem) * stiffness)
    factor.factorise(springs[:, :, None] * np.eye(d), LOOSE)
    gaps = np.column_stack([problem.gap, -problem.slip_origin])
    if problem.f.any():  # gaps stay open, and slips of the past are those of motions: they are no measure of the loads
        gaps = np.column_stack([np.minimum(problem.gap, 0.0), np.zeros((m, d - 1))])
    held = springs * gaps
    u = factor.solve(problem.f / stiffness - C.T @ held.ravel())
    t = springs * (C @ u).reshape(m, d) + held
    size = float(np.sqrt(np.mean(t**2))) if m else 0.0
    length = size if np.isfinite(size) and size > 0 else 1.0
    force = length * stiffness
    return Scaled(
        problem=problem,
        force=force,
        length=length,
        K=K,
        C=C,
        **_in_units(problem, C, force, length),
        inertia=sp.csr_array(problem.inertia * (1.0 / _mean_mass(problem))),
        rigid=problem.R,
        factor=factor,
        glued=u / length,
    )


def _matrices(problem: ContactProblem, engine: Engine) -> tuple[float, sp.csr_array, sp.csr_array, BlockFactor]:
    """Return the typical stiffness, K over it, C interleaved, and a factor that has made nothing yet.

    The matrix is put in order once for problems that share their matrices, however often and by whatever they are
    solved, unless its entries have been changed: that takes as long as some factorisations.
    """
    stiffness = typical_stiffness(problem)
    K, C = sp.csr_array(problem.K * (1.0 / stiffness)), interleaved(problem)
    ordered = _ordered(problem.K, problem.C_n, problem.C_t, problem.inertia, problem.bodies)
    kept = ordered.get(engine)
    mass = problem.inertia
    if kept is None or not (_same(kept[0], K) and _same(kept[1], C) and kept[2].may_add(mass)):
        factor = BlockFactor(K, C, problem.pairs, problem.bodies, engine, added=mass)
        kept = ordered[engine] = K, C, factor
    return stiffness, K, C, kept[2].afresh()


@once
def _ordered(*_: Array | sp.csr_array) -> dict[Engine, tuple[sp.csr_array, sp.csr_array, BlockFactor]]:
    """Return where the matrices of a structure and their factors in order are kept."""
    return {}


def _mean_mass(problem: ContactProblem) -> float:
    """Return the mean of the diagonal of the mass matrix [t]; 1 where there is none."""
    diagonal = problem.inertia.diagonal()
    return float(diagonal.mean()) if diagonal.any() else 1.0


def _same(a: sp.csr_array, b: sp.csr_array) -> bool:
    """Tell whether two matrices of one shape have the same entries at the same places."""
    return all(np.array_equal(getattr(a, part), getattr(b, part)) for part in ("data", "indices", "indptr"))


def _in_units(
    problem: ContactProblem, C: sp.csr_array, force: float, length: float, shift: Array | None = None
) -> dict[str, Any]:
    """Return loads, gaps, laws of :class:`Scaled` for given units, shifted by the tensile strength or by ``shift``."""
    law, m, d = problem.laws, problem.pairs, problem.dim
    by = law.tension if shift is None else shift
    compliance = compliances(problem) * (force / length)
    moved = np.column_stack([by / force, np.zeros((m, d - 1))])
    cone = (law.cone.shifted if shift is None else law.cone).in_units(force)
    cone = replace(cone, friction=np.where(cone.friction > SMOOTH, cone.friction, 0.0))
    return {
        "f": problem.f / force - C.T @ moved.ravel(),
        "x": np.column_stack([problem.gap, -problem.slip_origin]) / length - compliance * moved,
        "cone": cone,
        "shift": by,
        "dilatancy": np.where(cone.rough, law.dilatancy, 0.0),
        "compliance": compliance,
    }
