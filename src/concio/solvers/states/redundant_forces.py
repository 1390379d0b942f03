r"""Forces that equilibrium and the joint laws leave open: the least of them, the same in every frame.

Where pairs are redundant (a node or an edge in which several blocks meet) an exact answer has forces of which a part
does no work at all: with displacements u, and so every K u, given, what is left to choose is

.. math:: \min \tfrac12 \sum_k |t_k - t^0_k|^2 / A_k, \qquad C^T t = C^T t^*, \quad t_k \in S_k(u) ,

with t* the forces found, t0 those of pairs that carry nothing (zero, or the shift that tensile strength brings, so that
a strength which is not reached changes no force), A the tributary areas, and S_k(u) the forces that Coulomb's law
allows at these displacements: none where the pair is open, those of full friction against the slip where it slips, its
whole cone where it does not move. This is strictly convex, so that there is one answer, which depends on nothing but
the structure.

It concerns few pairs. One that meets an unknown which no other pair meets has its force by equilibrium; taking such
pairs away, again and again, leaves the *core* of those that are entangled. For the core the dual is solved,

.. math:: t_k = P_k(t^0_k - A_k\, C_k v), \qquad C^T (t(v) - t^*) = 0 ,

P the projection onto S_k: the equations of a concave function with a continuous gradient, by Newton's method with a
line search. Where it does not converge the forces stay as they were found.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sla

from concio.problem.cone import Cone
from concio.problem.contact_problem import Array
from concio.problem.tolerances import AT_BOUND, EXACT
from concio.solvers.algebra.scaled import Scaled
from concio.solvers.states.state_reading import Finished, natural_residual, sizes

DETERMINED = 1e-8
"""Share of a pair's own stiffness that unknowns of its own must give it in every direction to determine its force."""

ROUNDS = 60
"""Largest number of Newton steps."""

LEAST_BALANCED = 1e-15
"""Imbalance over the largest force at which Newton's method stops."""

DENSE = 200
"""Largest number of unknowns whose equations are put together and solved as a full matrix."""

SOFT = 1e-12
"""Added to the diagonal of the matrix, over its largest entry: entangled pairs leave it singular."""


def least_forces(s: Scaled, found: Finished) -> Finished:
    """Return an exact answer with the least forces of all that its displacements allow.

    Parameters
    ----------
    s : Scaled
    found : Finished
        Exact, of :func:`concio.solvers.interior.newton_finish.finish`.

    Returns
    -------
    Finished
        The same where every force is determined, or where the least ones cannot be found.
    """
    force, length = sizes(found.u, found.t)
    y = s.position(found.u, found.t)
    slip = np.linalg.norm(y[:, 1:], axis=1) * s.rough
    opening = y[:, 0] - s.dilatancy * slip
    chosen = (np.abs(opening) <= AT_BOUND * length) & ~s.compliance.any(axis=1)
    slips = slip > AT_BOUND * length
    direction = np.where(slips[:, None], y[:, 1:] / np.where(slip > 0, slip, 1.0)[:, None], 0.0)
    core = _entangled(s, chosen, slips, direction)
    if not len(core):
        return found
    sets = _Sets(s.cone[core], slips[core], direction[core], s.rough[core])
    rows = (core[:, None] * s.dim + np.arange(s.dim)).ravel()
    C = sp.csr_array(s.C[rows])
    C = sp.csr_array(C[:, np.unique(C.indices)])
    t = _least(C.toarray() if C.shape[1] <= DENSE else C, sets, s.share[core], found.t[core], s.unstressed[core], force)
    if t is None:
        return found
    every = found.t.copy()
    every[core] = t
    error, laws = natural_residual(s, found.u, every)
    if error > max(found.error, EXACT):
        return found
    return replace(found, t=every, error=error, undecided=np.flatnonzero(laws > EXACT))


@dataclass(frozen=True, eq=False)
class _Sets:
    """Forces (c, d) that pairs may have: their cones, or where they slip rays along (1, -mu d) from tension -T on."""

    cone: Cone
    slips: Array
    direction: Array
    rough: Array

    @property
    def ray(self) -> Array:
        return np.column_stack([np.ones(len(self.slips)), -self.cone.friction[:, None] * self.direction])

    def project(self, w: Array) -> tuple[Array, Array]:
        """Return the nearest forces to w (c, d), and an element of the derivative (c, d, d)."""
        t, J = self.cone.project(w), self.cone.derivative(w)
        t[~self.rough, 1:] = 0.0
        J[~self.rough, 1:] = J[~self.rough, :, 1:] = 0.0
        ray = self.ray
        tension = self.cone.tension
        start = np.column_stack([-tension, -self.cone.spare[:, None] * self.direction])
        square = (ray * ray).sum(axis=1)
        along = ((w - start) * ray).sum(axis=1) / square
        most = self.cone.cap + tension
        t[self.slips] = (start + np.clip(along, 0.0, most)[:, None] * ray)[self.slips]
        inside = (along > 0) & (along < most)
        J[self.slips] = (ray[:, :, None] * ray[:, None, :] * (inside / square)[:, None, None])[self.slips]
        return t, J

    @property
    def spanned(self) -> Array:
        """Projections (c, d, d) onto the directions the forces may have."""
        ray = self.ray
        D = np.zeros((len(ray), ray.shape[1], ray.shape[1]))
        D[:, 0, 0] = 1.0
        D[self.rough] = np.eye(ray.shape[1])
        D[self.slips] = (ray[:, :, None] * ray[:, None, :] / (ray * ray).sum(axis=1)[:, None, None])[self.slips]
        return D


def _entangled(s: Scaled, chosen: Array, slips: Array, direction: Array) -> Array:
    """Return the numbers of the chosen pairs whose forces no unknown of their own determines."""
    d, pairs = s.dim, s.pairs
    # a pair that slips, or has no friction, has one unknown force, along its ray
    ray = np.column_stack([np.ones(pairs), -s.cone.friction[:, None] * direction])
    single = slips | ~s.rough
    rows = np.repeat(np.arange(pairs * d), np.diff(s.C.indptr))
    met, entry = np.unique(rows // d * s.f.size + s.C.indices, return_inverse=True)
    row = np.zeros((len(met), d))
    row[entry, rows % d] = s.C.data
    pair, unknown = np.divmod(met, s.f.size)
    squares = (row[:, :, None] * row[:, None, :]).reshape(-1, d * d)
    size = np.bincount(pair, weights=np.square(row).sum(axis=1), minlength=pairs)
    left = chosen.copy()
    while left.any():
        counted = left[pair]
        shared = np.bincount(unknown[counted], minlength=s.f.size)
        mine = np.flatnonzero(counted & (shared[unknown] == 1))
        sums = np.zeros((pairs, d * d))
        np.add.at(sums, pair[mine], squares[mine])
        own = sums.reshape(-1, d, d)
        pick = np.flatnonzero(left)
        along = np.einsum("ka,kab,kb->k", ray[pick], own[pick], ray[pick])
        least = np.where(single[pick], along, np.linalg.eigvalsh(own[pick])[:, 0])
        known = least > DETERMINED * size[pick]
        if not known.any():
            break
        left[pick[known]] = False
    return np.flatnonzero(left)


def _least(
    C: Array | sp.csr_array, sets: _Sets, share: Array, given: Array, middle: Array, force: float
) -> Array | None:
    """Return the forces (c, d) nearest to ``middle`` with the resultants C't of those given; None where it fails."""
    c, d = given.shape
    wanted = C.T @ given.ravel()

    def at(v: Array) -> tuple[Array, Array, Array, float]:
        strain = (C @ v).reshape(c, d)
        t, J = sets.project(middle - share[:, None] * strain)
        value = float(((t - middle) ** 2 / (2 * share[:, None]) + strain * (t - given)).sum())
        return t, J, C.T @ t.ravel() - wanted, value

    v = np.zeros(C.shape[1])
    t, _, left, value = at(v)
    J = sets.spanned
    best, stale = (np.inf, t), 0
    for _ in range(ROUNDS):
        x = _newton_step(C, share[:, None, None] * J, left)
        step = 1.0
        while step > 1e-6:
            t, J, new, other = at(v + step * x)
            if other >= value + 1e-4 * step * float(left @ x) or np.abs(new).max() <= 0.5 * np.abs(left).max():
                break
            step *= 0.5
        v, left, value = v + step * x, new, other
        size = float(np.abs(left).max())
        stale = 0 if size < 0.5 * best[0] else stale + 1
        if size < best[0]:
            best = size, t
        if size <= LEAST_BALANCED * force or (stale >= 3 and best[0] <= EXACT * force):
            break
    return best[1] if best[0] <= EXACT * force else None


def _newton_step(C: Array | sp.csr_array, D: Array, left: Array) -> Array:
    """Return the solution of C' D C x = left for blocks D (c, d, d), with a soft diagonal."""
    c, d = D.shape[:2]
    if isinstance(C, np.ndarray):
        H = C.T @ np.matmul(D, C.reshape(c, d, -1)).reshape(c * d, -1)
        H[np.diag_indices_from(H)] += SOFT * float(H.diagonal().max(initial=1e-300))
        return np.asarray(np.linalg.solve(H, left))
    blocks = sp.bsr_array((D, np.arange(c), np.arange(c + 1)), shape=(c * d, c * d))
    H = sp.csc_array(C.T @ (blocks @ C))
    soft = SOFT * float(H.diagonal().max(initial=1e-300))
    return np.asarray(sla.splu(H + soft * sp.eye_array(H.shape[0], format="csc"), diag_pivot_thresh=0.0).solve(left))
