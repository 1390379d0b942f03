r"""From a point close to a solution to the solution itself: states read off, imposed, solved, signs checked.

With a state for every pair (open, stick, slip either way; crushed) the equations are linear,

.. math::
    \begin{bmatrix} K & -C_c^T \\ G_c & A_c \end{bmatrix} \begin{bmatrix} u \\ t_c \end{bmatrix} =
    \begin{bmatrix} f \\ b_c \end{bmatrix},

with the closed pairs c, friction of slipping pairs expressed by their normal force. A compliance ``DELTA`` added to the
closed pairs gives a matrix of the engine's pattern, K + C'DC, factorised with the ordering already known; iterative
refinement against the original equations takes it out again. Redundant pairs (corners) and loose bodies do no harm:
their equations are consistent, and refinement converges to the answer nearest to where it began.

If the signs of the answer agree with the states, it is exact. If not, states are updated (primal-dual active set) a few
times; what then keeps flipping is returned as undecided, for pivoting.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from concio.problem.contact_problem import Array
from concio.problem.pair_state import Normal, PairStates
from concio.problem.tolerances import EXACT
from concio.solvers.algebra.scaled import Scaled
from concio.solvers.algebra.sparse_factor import SingularMatrixError

DELTA = 1e-6
"""Compliance of closed pairs of mean area in the factorised matrix, scaled units."""

LOOSE = 1e-9
"""Stiffness of the springs that keep unknowns which nothing holds where they are, scaled units."""

ANCHORS = 8
"""Largest number of times the springs of loose unknowns are anchored anew."""

REFINED = 1e-14
"""Relative residual at which refinement stops; it stops before where it no longer halves the residual."""


@dataclass(frozen=True, eq=False)
class Finished:
    """Outcome of the exact finish, scaled units.

    Parameters
    ----------
    u, t : arrays
        Shapes (N,), (m, d).
    states : PairStates
    error : float
        Natural-map residual: largest of imbalance and of the violation of the joint laws, relative.
    solves : int
        Linear systems factorised.
    undecided : (k,) integer array
        Pairs whose state changed in the last round; empty when exact.
    """

    u: Array
    t: Array
    states: PairStates
    error: float
    solves: int
    undecided: Array


def sizes(u: Array, t: Array) -> tuple[float, float]:
    """Return the largest force and the largest displacement, at least one."""
    return max(1.0, float(np.abs(t).max(initial=0.0))), max(1.0, float(np.abs(u).max(initial=0.0)))


def natural_residual(s: Scaled, u: Array, t: Array) -> tuple[float, Array]:
    """Return the largest relative violation of equilibrium and joint laws, and that of the laws for each pair (m,).

    Forces count relative to the largest force, lengths relative to the largest displacement.
    """
    force, length = sizes(u, t)
    laws: Array = np.abs(s.natural_map(u, t, force / length)).max(axis=1, initial=0.0) / force
    return max(s.unbalanced(u, t, force), float(laws.max(initial=0.0))), laws


def read_states(s: Scaled, u: Array, t: Array) -> PairStates:
    """Return the states that the natural map assigns to a point of a plane problem."""
    force, length = sizes(u, t)
    y = s.position(u, t) * (force / length)
    slip = np.where(s.rough, y[:, 1], 0.0)
    trial = t[:, 0] - y[:, 0] + s.dilatancy * np.abs(slip)
    closed = trial > 0
    strength = np.where(s.rough, s.cone.strength(np.clip(trial, 0.0, s.cone.cap)), 0.0)
    tangential = t[:, 1] - slip
    sliding = np.where(tangential < -strength, 1, np.where(tangential > strength, -1, 0))
    sliding = np.where(closed & s.rough, sliding, 0)
    normal = np.where(trial > s.cone.cap, Normal.CRUSHED, np.where(closed, Normal.CLOSED, Normal.OPEN))
    return PairStates.plane(normal, sliding)


def solve_states(
    s: Scaled,
    states: PairStates,
    u: Array,
    t: Array,
    anchor: Array | None = None,
    *,
    springs: Array | float = LOOSE,
    again: bool = False,
) -> tuple[Array, Array, float]:
    """Solve the linear equations of given states, starting refinement from (u, t).

    Unknowns are tied to ``anchor`` (N,) by ``springs`` of stiffness ``LOOSE``: what nothing holds stays there, and what
    is held feels less than the equilibrium's rounding. ``again`` reuses the factorisation of the call before.

    Returns
    -------
    u, t : arrays
    residual : float
        Largest residual of the linear equations of these states.

    Raises
    ------
    SingularMatrixError
        The matrix of these states cannot be factorised.
    """
    touching, hard = ~states.open, states.closed
    sigma = states.direction[:, 0] * touching
    stick = touching & (sigma == 0) & s.rough
    drag = -sigma * s.cone.friction  # t_t = drag t_n - sigma c where slipping
    wide = s.dilatancy * sigma
    # gap of a slipping pair: x + C_n u + a_n t_n - d sigma (C_t u - s + a_t t_t)
    delta = DELTA / s.share
    soft_n = np.where(hard, s.compliance[:, 0] - wide * s.compliance[:, 1] * drag + delta, 1.0)
    soft_t = np.where(stick, s.compliance[:, 1] + delta, 1.0)
    d_nn = np.where(hard, 1.0 / soft_n, 0.0)
    d_tt = np.where(stick, 1.0 / soft_t, 0.0)
    if not again:
        d_tn = d_nn * drag
        D = np.stack([d_nn, -d_nn * wide, d_tn, d_tt - d_tn * wide], axis=1)
        s.factor.factorise(D.reshape(-1, 2, 2), springs)
    t_n = np.where(states.crushed, s.cone.cap, np.where(touching, t[:, 0], 0.0))
    t_t = np.where(stick, t[:, 1], drag * t_n - sigma * s.cone.cohesion) * touching
    t = np.column_stack([t_n, t_t])
    anchor = u if anchor is None else anchor
    best, late = (u, t, np.inf), 0
    for _ in range(40):
        r_u = -s.imbalance(u, t) - springs * (u - anchor)
        y = s.position(u, t)
        r_n = np.where(hard, -(y[:, 0] - wide * y[:, 1]), 0.0)
        r_t = np.where(stick, -y[:, 1], 0.0)
        force, length = sizes(u, t)
        residual = max(
            float(np.abs(r).max(initial=0.0)) / size for r, size in ((r_u, force), (r_n, length), (r_t, length))
        )
        late = late + 1 if residual > 0.5 * best[2] else 0
        if residual < best[2]:
            best = (u, t, residual)
        if not residual > REFINED or residual > 1e3 * best[2] or late >= 3:
            break
        n0, t0 = r_n * d_nn, r_t * d_tt
        du = s.factor.solve(r_u + s.pull(np.column_stack([n0, t0 + drag * n0])))
        v = s.along(du)
        dt_n = n0 - d_nn * (v[:, 0] - wide * v[:, 1])
        dt_t = np.where(stick, t0 - d_tt * v[:, 1], drag * dt_n)
        u, t = u + du, t + np.column_stack([dt_n, dt_t])
    return best


def _least_norm(s: Scaled, found: Finished) -> Finished:
    """Return the same answer with the least-norm forces among those of its states, if these obey the joint laws.

    Where pairs are redundant (corners) their forces are not unique. Refinement from zero forces ends at the least norm,
    which depends on nothing but the structure; the displacements are the same. Each pair's compliance goes with the
    inverse of its area, so it is the norm of the tractions: a uniform pressure is reported as one. The springs of
    loose unknowns are anchored anew at the answer, which takes their last influence out.
    """
    for start in (found.t, np.zeros_like(found.t)):
        u, t, _ = solve_states(s, found.states, found.u, start, found.u, again=True)
        error, _ = natural_residual(s, u, t)
        if error <= max(found.error, EXACT):
            found = replace(found, u=u, t=t, error=error)
    return found


def _far_from_anchor(
    s: Scaled, states: PairStates, u: Array, t: Array, error: float, laws: Array
) -> tuple[Array, Array, float, Array]:
    """Anchor the springs of loose unknowns anew, as long as that lowers the error of settled states.

    A slender arch is hardly stiffer than these springs: where it goes far, they pull, and less at each new anchor.
    """
    for _ in range(ANCHORS):
        new_u, new_t, _ = solve_states(s, states, u, t, u, again=True)
        new_error, new_laws = natural_residual(s, new_u, new_t)
        if not new_error < 0.5 * error:
            break
        u, t, error, laws = new_u, new_t, new_error, new_laws
        if error < EXACT:
            break
    return u, t, error, laws


def finish(
    s: Scaled,
    u: Array,
    t: Array,
    rounds: int = 12,
    states: PairStates | None = None,
    *,
    least: bool = True,
) -> Finished:
    """Turn a point close to a solution into the solution, if its states can be settled.

    Parameters
    ----------
    s : Scaled
    u, t : (N,), (m, 2) arrays
        The point, scaled.
    rounds : int
        Largest number of active-set rounds.
    states : PairStates, optional
        States to begin with; default are those the point suggests.
    least : bool
        Whether forces that are not unique are those of least norm; otherwise those near to the point.
    """
    states = states or read_states(s, u, t)
    anchor = u
    seen: set[bytes] = set()
    best: Finished | None = None
    solves = 0
    for _ in range(rounds):
        seen.add(states.key())
        try:
            u, t, _ = solve_states(s, states, u, t, anchor)
        except SingularMatrixError:
            break
        solves += 1
        error, laws = natural_residual(s, u, t)
        new = read_states(s, u, t)
        if error >= EXACT and new.key() == states.key():
            u, t, error, laws = _far_from_anchor(s, states, u, t, error, laws)
            new = read_states(s, u, t)
        undecided = np.flatnonzero((laws > 1e-10) & new.differ(states))
        if best is None or error < best.error:
            best = Finished(u, t, states, error, solves, undecided)
        if error < EXACT:
            best = _least_norm(s, best) if least else best
            break
        if new.key() in seen:
            break
        states = new
    if best is None:
        error, laws = natural_residual(s, u, t)
        return Finished(u, t, states, error, solves, np.flatnonzero(laws > 1e-10))
    return replace(best, solves=solves)
