"""Numbers by which a contact problem is brought to units of its own: stiffness, compliances, softness of pairs."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from concio.errors import MethodError
from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.tolerances import SMOOTH


def require_plane(problem: ContactProblem) -> None:
    """Refuse a problem in space.

    Raises
    ------
    MethodError
        The problem is not plane.
    """
    if problem.dim != 2:
        msg = "this method solves plane problems"
        raise MethodError(msg, hint="use a method that works in three dimensions, such as alart-curnier")


def interleaved(problem: ContactProblem) -> sp.csr_array:
    """Return C with the rows of each pair together, normal first, shape (m d, N)."""
    m, d = problem.pairs, problem.dim
    order = np.column_stack([np.arange(m), m + np.arange(m * (d - 1)).reshape(m, d - 1)]).ravel()
    return sp.csr_array(sp.csr_array(problem.C)[order])


def typical_stiffness(problem: ContactProblem) -> float:
    """Return the geometric mean of the stiffnesses met at the pairs [kN/m]; 1 for rigid bodies with hard joints.

    In space that of a node is the mean of its three, which no turn of the structure changes.
    """
    met = np.asarray(abs(problem.C).sum(axis=0)).ravel()
    diagonal = problem.K.diagonal()
    if problem.dim == 3 and diagonal.size % 3 == 0:
        met, diagonal = met.reshape(-1, 3).sum(axis=1), diagonal.reshape(-1, 3).mean(axis=1)
    diagonal = diagonal[met > 0]
    springs = [c[c > 0] for c in (problem.laws.normal_compliance, problem.laws.tangential_compliance)]
    found = np.concatenate([diagonal[diagonal > 0], *(1.0 / c for c in springs)])
    if found.size:
        return float(np.exp(np.log(found).mean()))
    return float(np.abs(problem.f).sum()) or 1.0


def compliances(problem: ContactProblem) -> Array:
    """Return a_n and a_t of each pair, (m, d) [m/kN]."""
    law = problem.laws
    return np.column_stack([law.normal_compliance, *[law.tangential_compliance] * (problem.dim - 1)])


def softness(problem: ContactProblem) -> Array:
    """Return how much the glued structure gives way at each pair before its own compliance counts, (m, d), scaled.

    In space one. In the plane what the interior point gives way where it begins, every slack equal to its multiplier:
    1 + 2 d along the normal, and 2 / mu in the joint where there is friction.
    """
    softness = np.ones((problem.pairs, problem.dim))
    if problem.dim == 2:
        rough, mu = problem.laws.cone.rough, problem.laws.cone.friction
        softness[:, 0] += np.where(rough, 2.0 * problem.laws.dilatancy, 0.0)
        softness[:, 1] = 2.0 / np.where(rough & (mu > SMOOTH), mu, 2.0)
    return softness
