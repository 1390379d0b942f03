r"""What is left of the contact problem when the displacements are eliminated: flexibility and rigid motions.

With a symmetric generalised inverse K+ of the stiffness (body by body) and in units of the problem's own,

.. math:: y = y_0 + F\,t + G\,\alpha,\qquad 0 = e_0 + G^T t,\qquad F = C K^+ C^T + \mathrm{diag}(a),\quad G = C R,

``y_0 = x + C K+ f``, ``e_0 = R' f``, free parameters alpha of the rigid motions. Compliance of joints adds to the
diagonal of F; a tensile strength T shifts the normal force, ``p = t_n + T >= 0``, and with it loads and gaps.
Components are the normals of all pairs, then the tangents of those that can carry friction.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from concio.errors import MethodError
from concio.problem.contact_problem import Array, ContactProblem
from concio.solvers.algebra.scaled import scale
from concio.solvers.pivoting.pair_rows import PairSystem


@dataclass(frozen=True, eq=False)
class Reduction:
    """Flexibility form of a plane contact problem with m pairs, k of them rough, and r rigid motions.

    Parameters
    ----------
    system : PairSystem
        The problem in units of its own.
    rough : (k,) integer array
        Pairs that can carry friction.
    F : (m + k, m + k) array
    y0 : (m + k,) array
    G : (m + k, r) array
    e0 : (r,) array
    flexible : (N, m + k) array
        K+ C'.
    u0 : (N,) array
        K+ f.
    """

    system: PairSystem
    rough: Array
    F: Array
    y0: Array
    G: Array
    e0: Array
    flexible: Array
    u0: Array

    @property
    def pairs(self) -> int:
        """Number m of pairs."""
        return self.system.m

    @property
    def mu(self) -> Array:
        """Friction of the rough pairs, (k,)."""
        return np.asarray(self.system.cone.friction[self.rough])

    @property
    def cohesion(self) -> Array:
        """Strength c' of the rough pairs at p = 0, (k,)."""
        return np.asarray(self.system.cone.cohesion[self.rough])

    @property
    def dilatancy(self) -> Array:
        """Tangent of the dilatancy angle of the rough pairs, (k,)."""
        return np.asarray(self.system.dilatancy[self.rough])

    def displacement(self, t: Array, alpha: Array) -> Array:
        """Return u (N,) [m] of component forces t (m + k,) and rigid motions alpha (r,), both scaled."""
        u: Array = self.u0 + self.flexible @ t + self.system.problem.R @ alpha
        return u * self.system.s.length

    def forces(self, t: Array) -> tuple[Array, Array]:
        """Return t_n and t_t (m,) [kN] of component forces t (m + k,)."""
        m, force = self.pairs, self.system.s.force
        t_t = np.zeros(m)
        t_t[self.rough] = t[m:] * force
        return t[:m] * force - self.system.problem.laws.tension, t_t

    def best_motion(self, t: Array, y: Array) -> Array:
        """Return the rigid motions alpha (r,) that bring y0 + F t + G alpha nearest to the components y (m + k,)."""
        if not self.G.shape[1]:
            return np.zeros(0)
        alpha: Array = np.linalg.lstsq(self.G, y - self.y0 - self.F @ t, rcond=None)[0]
        return alpha


def reduce(problem: ContactProblem) -> Reduction:
    """Eliminate the displacements.

    Raises
    ------
    MethodError
        The problem is not plane, or a pair has a cap on compression.
    """
    system = PairSystem(scale(problem))
    if system.cone.capped.any():
        msg = "the dense forms have no cap on compression"
        raise MethodError(msg, hint="use sparse-lemke or interior-point")
    m, R = system.m, sp.csc_array(problem.R)
    rough = np.flatnonzero(~system.frictionless)
    order = np.concatenate([2 * np.arange(m), 2 * rough + 1])
    C = sp.csr_array(system.C[order])
    held = sp.csc_matrix(sp.csr_array(system.s.K) + R @ R.T)
    try:
        lu = splu(held, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.01, options={"SymmetricMode": True})
    except RuntimeError as error:
        msg = "K + R R' is singular: R does not hold all rigid motions"
        raise MethodError(msg) from error

    def inverse(b: Array) -> Array:
        b = b - R @ (R.T @ b)
        x: Array = lu.solve(b)
        x = x + lu.solve(b - held @ x)
        projected: Array = x - R @ (R.T @ x)
        return projected

    flexible = inverse(C.T.toarray())
    F = C @ flexible
    F = 0.5 * (F + F.T)
    F[np.diag_indices_from(F)] += system.a.ravel()[order]
    u0 = inverse(system.load)
    y0 = system.x.ravel()[order] + C @ u0
    return Reduction(system, rough, F, y0, np.asarray((C @ R).toarray()), R.T @ system.load, flexible, u0)
