r"""Mechanisms: motions that prove that there is no equilibrium.

Let v = R alpha be a rigid motion whose power

.. math:: \Pi(v) = f^T v - \sum_k h_k, \qquad h_k = c|w_t| + T (w_n - \mu|w_t|)^+ + N (w_n - \mu|w_t|)^-,

is positive, with w = C v the velocities of the pairs and w_n >= mu |w_t| wherever the cap N is infinite. Then no
forces within the Coulomb cones balance the loads, whatever the bodies' stiffness, gaps, dilatancy and history.

*Proof* (weak duality). Multiply equilibrium (12), K u = f + C't, by v: as K v = 0 it leaves f'v + sum_k t_k . w_k = 0.
For every t_k with -T <= t_n <= N, |t_t| <= c + mu t_n,

.. math:: -t_k \cdot w_k \le (c + \mu t_n)|w_t| - t_n w_n = c|w_t| - t_n (w_n - \mu|w_t|) \le h_k,

hence f'v <= sum h_k, against the assumption. For plain friction h = 0 and the condition is f'v > 0 with v in the
associated cone w_n >= mu |w_t|. The converse (no such v: statically admissible forces exist) is strong duality of
linear programming. Neither says that a *Coulomb* state exists: friction is not associated.

A mechanism found by a linear programme is never believed: :func:`verify_mechanism` repeats the inequalities with
plain matrix products from the original data.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.solution import Mechanism
from concio.problem.tolerances import ADMISSIBLE, CLEARLY
from concio.solvers.statics.programme import StaticProgramme


def total_load(problem: ContactProblem) -> float:
    """Return the total load [kN], 1 where there is none."""
    return problem.total_load or 1.0


def mechanism_from(problem: ContactProblem, velocity: Array) -> Mechanism | None:
    """Return the verified mechanism next to an approximate ``velocity`` (N,), polished if need be, or None."""
    if not np.abs(velocity).max(initial=0.0) > 0:
        return None
    found = verify_mechanism(problem, velocity)
    for active in (1e-9, 1e-8, 1e-7, 1e-6):
        if proves(problem, found):
            return found
        found = verify_mechanism(problem, polish(problem, velocity, active))
    return found if proves(problem, found) else None


def pair_velocities(problem: ContactProblem, velocity: Array) -> tuple[Array, Array]:
    """Return w_n (m,) and |w_t| (m,) of a motion (N,)."""
    w_t = (problem.C_t @ velocity).reshape(problem.pairs, problem.dim - 1)
    return problem.C_n @ velocity, np.linalg.norm(w_t, axis=1)


def absorbed_power(problem: ContactProblem, velocity: Array) -> float:
    """Return sum h_k, the most the joints can absorb in a motion (N,) [kN]; the cone violations count as zero."""
    return float(problem.cone.absorbed_power(*pair_velocities(problem, velocity)).sum())


def verify_mechanism(problem: ContactProblem, velocity: Array) -> Mechanism:
    """Recompute power and violation of a motion from the original data with plain matrix products.

    Parameters
    ----------
    problem : ContactProblem
    velocity : (N,) array
        Any scale; the mechanism returned has largest entry 1.

    Returns
    -------
    Mechanism
        Whether it proves anything is for :func:`proves` to say.
    """
    top = float(np.abs(velocity).max(initial=0.0))
    if not (np.isfinite(top) and top > 0):
        return Mechanism(np.zeros(problem.unknowns), 0.0, np.inf)
    v = np.asarray(velocity, dtype=float) / top
    cone = problem.cone
    closer = -cone.lift(*pair_velocities(problem, v))
    violation = float(np.maximum(closer[~cone.capped], 0.0).max(initial=0.0))
    stiffness = float(abs(problem.K).max()) if problem.K.nnz else 0.0
    if stiffness:
        violation = max(violation, float(np.abs(problem.K @ v).max()) / stiffness)
    return Mechanism(v, float(problem.f @ v) - absorbed_power(problem, v), violation)


def proves(problem: ContactProblem, mechanism: Mechanism) -> bool:
    """Return True when a mechanism proves that no equilibrium exists.

    The violation must be rounding, and the power must exceed rounding and what the violation could hide: a hundred
    times the violation times the total load.
    """
    if not (np.isfinite(mechanism.power) and mechanism.violation <= ADMISSIBLE):
        return False
    size = float(np.abs(problem.f * mechanism.velocity).sum()) + absorbed_power(problem, mechanism.velocity)
    return bool(mechanism.power > CLEARLY * size + 100.0 * mechanism.violation * total_load(problem))


def polish(problem: ContactProblem, velocity: Array, active: float = 1e-6) -> Array:
    """Project a motion (N,) on the rigid motions with its nearly active pairs made exact (least change).

    Pairs with w_n - mu |w_t| below ``active`` times the largest velocity are given equality, those that hardly
    slide also w_t = 0.
    """
    top = float(np.abs(velocity).max(initial=0.0)) or 1.0
    programme = StaticProgramme(problem)
    R = sp.csc_array(problem.R @ sp.diags_array(1.0 / programme.scale))
    alpha = (problem.R.T @ velocity) * programme.scale
    w_n, w_t = pair_velocities(problem, velocity)
    s = problem.dim - 1
    mu = problem.cone.friction
    tight = np.abs(problem.cone.lift(w_n, w_t)) <= active * top
    still = tight & (w_t <= active * top)
    moving = np.flatnonzero(tight & ~still)
    direction = (problem.C_t @ velocity).reshape(problem.pairs, s) / np.where(w_t > 0, w_t, 1.0)[:, None]
    stuck = np.flatnonzero(still)
    along = sp.csr_array(
        (
            (mu[moving, None] * direction[moving]).ravel(),
            (np.repeat(np.arange(moving.size), s), (moving[:, None] * s + np.arange(s)).ravel()),
        ),
        shape=(moving.size, problem.C_t.shape[0]),
    )
    rows = sp.vstack(
        [
            problem.C_n[moving] - along @ problem.C_t,
            problem.C_n[stuck],
            problem.C_t[(stuck[:, None] * s + np.arange(s)).ravel()],
        ]
    )
    G = sp.csc_array(sp.csr_array(rows) @ R)
    if not G.shape[0]:
        return velocity
    r = alpha.size
    weak = -1e-10 * sp.eye_array(G.shape[0])  # redundant rows; its error is taken out by the repetition
    factors = splu(sp.csc_matrix(sp.block_array([[sp.eye_array(r), G.T], [G, weak]])), permc_spec="COLAMD")
    for _ in range(5):
        alpha = alpha - factors.solve(np.concatenate([np.zeros(r), G @ alpha]))[:r]
    polished: Array = R @ alpha
    return polished
