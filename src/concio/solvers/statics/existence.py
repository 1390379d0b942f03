r"""Is there an equilibrium? A sufficient condition, a necessary one, and the proof that there is none.

*Sufficient* (after Del Piero): a strictly positive t_n that, with t_t = 0, balances the loads on the rigid motions.

*No equilibrium*: let v = R alpha be a rigid motion whose power

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

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.solution import Mechanism
from concio.problem.tolerances import ADMISSIBLE, CLEARLY
from concio.solvers.statics.programme import StaticProgramme, optimise

NEARLY = 1e-6
"""Residual below which the forces of the linear programme are balanced once more, to tell rounding from collapse."""


@dataclass(frozen=True, eq=False)
class SufficientCondition:
    """The paper's sufficient condition for the existence of an equilibrium.

    Parameters
    ----------
    margin : float
        Largest possible value of the smallest of all t_n and, where there is a cap, N - t_n [kN]; ``inf`` where it
        can grow without end (jammed, or no floating bodies), ``-inf`` where normal forces alone cannot balance the
        loads.
    normal_force : (m,) array
        Normal forces that attain it (for an infinite margin: the total load), zeros where there are none [kN].
    holds : bool
        True when the margin is positive, clear of rounding.
    """

    margin: float
    normal_force: Array
    holds: bool


@dataclass(frozen=True, eq=False)
class StaticState:
    """Outcome of the search for forces within the cones that balance the loads.

    Parameters
    ----------
    exists : bool
        True when the forces below balance the loads to 1e-9 of the total load.
    normal_force : (m,) array
        t_n [kN].
    friction_force : (m, d-1) array
        t_t [kN].
    residual : float
        Largest entry of R'(f + C't) over the total load, recomputed from the problem.
    velocity : (N,) array
        Rigid motion dual to the forces; a mechanism where the forces do not exist.
    """

    exists: bool
    normal_force: Array
    friction_force: Array
    residual: float
    velocity: Array


def total_load(problem: ContactProblem) -> float:
    """Return the total load [kN], 1 where there is none."""
    return problem.total_load or 1.0


def sufficient_condition(problem: ContactProblem) -> SufficientCondition:
    """Maximise the smallest normal force in equilibrium with the loads, without friction.

    Parameters
    ----------
    problem : ContactProblem
    """
    m, r = problem.pairs, problem.rigid_motions
    force = total_load(problem)
    capped = problem.cone.capped
    if r == 0 or m == 0:
        moved = float(np.abs(problem.R.T @ problem.f).max(initial=0.0)) > CLEARLY * force
        return SufficientCondition(-np.inf if moved else np.inf, np.zeros(m), not moved)
    programme = StaticProgramme(problem)
    A_n = sp.csc_array(sp.diags_array(1.0 / programme.scale) @ (problem.R.T @ problem.C_n.T))
    load = programme.project(problem.f) / force
    # t_n = p + s with p >= 0, s the smallest force, both in units of the total load; s = 1 stands for "no end"
    equations = sp.csc_array(sp.hstack([A_n, sp.csc_array((A_n @ np.ones(m))[:, None])])), -load
    caps, top = None, 1.0
    if capped.any():
        top = float(problem.laws.cap.min()) / force
        rows = sp.csc_array(sp.hstack([sp.eye_array(m), sp.csc_array(np.full((m, 1), 2.0))]))  # p + s <= N - s
        caps = sp.csc_array(sp.csr_array(rows)[np.flatnonzero(capped)]), problem.laws.cap[capped] / force
    bounds = np.vstack([np.column_stack([np.zeros(m), np.full(m, np.inf)]), [-np.inf, top]])
    result = optimise(np.r_[np.zeros(m), -1.0], equations, bounds, caps)
    if result.status != 0:
        return SufficientCondition(-np.inf, np.zeros(m), False)
    s = float(result.x[-1])
    t_n = (result.x[:m] + s) * force
    balance = np.abs(problem.R.T @ (problem.f + problem.C_n.T @ t_n)).max(initial=0.0) / force
    holds = s > CLEARLY and float(balance) <= ADMISSIBLE
    endless = caps is None and s > 1.0 - 1e-9
    return SufficientCondition(np.inf if endless else s * force, t_n, holds)


def statically_admissible(problem: ContactProblem, *, around: bool = False) -> StaticState:
    """Search forces within the cones of the joint laws that balance the loads on the rigid motions.

    Minimises the sum of what is left unbalanced; zero means that the forces exist, and where they do not, the dual
    is the motion to blame.

    Parameters
    ----------
    problem : ContactProblem
    around : bool
        In space, use cones a little too large (for mechanisms) instead of a little too small (for forces).
    """
    m, r, s = problem.pairs, problem.rigid_motions, problem.dim - 1
    force = total_load(problem)
    if r == 0:
        return StaticState(True, np.zeros(m), np.zeros((m, s)), 0.0, np.zeros(problem.unknowns))
    programme = StaticProgramme(problem, around)
    load = programme.project(problem.f) / force
    if m == 0:
        velocity = problem.R @ (load / programme.scale)
        residual = float(np.abs(problem.R.T @ problem.f).max() / force)
        return StaticState(residual <= ADMISSIBLE, np.zeros(0), np.zeros((0, s)), residual, velocity)
    A, e0 = programme.equilibrium
    n = A.shape[1]
    eye = sp.eye_array(r, format="csc")
    equations = sp.csc_array(sp.hstack([A, eye, -eye])), -load - e0 / force
    bounds = np.vstack([programme.bounds / force, np.tile([0.0, np.inf], (2 * r, 1))])
    caps = programme.caps
    if caps is not None:
        rows = sp.csc_array((caps[0].shape[0], 2 * r))
        caps = sp.csc_array(sp.hstack([caps[0], rows])), caps[1] / force
    result = optimise(np.r_[np.zeros(n), np.ones(2 * r)], equations, bounds, caps)
    if not result.x.size:
        return StaticState(False, np.zeros(m), np.zeros((m, s)), np.inf, np.zeros(problem.unknowns))
    x = result.x * force
    for attempt in range(2):
        t_n, t_t = programme.forces(x)
        left = problem.R.T @ (problem.f + problem.C_n.T @ t_n + problem.C_t.T @ t_t.ravel())
        residual = float(np.abs(left).max() / force)
        if attempt or not 1e-12 < residual < NEARLY:
            break
        x = programme.balance(x, problem.f)
    velocity = problem.R @ (-result.marginals / programme.scale)
    return StaticState(residual <= ADMISSIBLE, t_n, t_t, residual, velocity)


def find_mechanism(problem: ContactProblem) -> Mechanism | None:
    """Search a mechanism that proves there is no equilibrium.

    Parameters
    ----------
    problem : ContactProblem

    Returns
    -------
    Mechanism or None
        A verified proof, or None where the linear programme finds statically admissible forces or the motion it
        finds does not pass :func:`verify_mechanism`.
    """
    state = statically_admissible(problem, around=True)
    return None if state.exists else mechanism_from(problem, state.velocity)


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
