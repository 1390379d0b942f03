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
    u, t_n, t_t : arrays
        Shapes (N,), (m,), (m,).
    states : PairStates
    error : float
        Natural-map residual: largest of imbalance and of the violation of the joint laws, relative.
    solves : int
        Linear systems factorised.
    undecided : (k,) integer array
        Pairs whose state changed in the last round; empty when exact.
    """

    u: Array
    t_n: Array
    t_t: Array
    states: PairStates
    error: float
    solves: int
    undecided: Array


def sizes(u: Array, t_n: Array, t_t: Array) -> tuple[float, float]:
    """Return the largest force and the largest displacement, at least one."""
    force = max(1.0, float(np.abs(t_n).max(initial=0.0)), float(np.abs(t_t).max(initial=0.0)))
    return force, max(1.0, float(np.abs(u).max(initial=0.0)))


def natural_residual(s: Scaled, u: Array, t_n: Array, t_t: Array) -> tuple[float, Array]:
    """Return the largest relative violation of equilibrium and joint laws, and that of the laws for each pair (m,).

    Forces count relative to the largest force, lengths relative to the largest displacement; the natural map
    ``t - P(t - y)`` is taken in these units.
    """
    force, length = sizes(u, t_n, t_t)
    imbalance = s.unbalanced(u, t_n, t_t, force)
    slip = np.where(s.rough, s.slip(u, t_t), 0.0)
    gap = (s.normal_gap(u, t_n) - s.dilatancy * np.abs(slip)) / length
    p_n, p_t, cap = t_n / force, t_t / force, s.cap / force
    law_n = np.abs(p_n - np.clip(p_n - gap, 0.0, cap))
    strength = np.where(s.rough, s.cohesion / force + s.mu * np.maximum(p_n, 0.0), 0.0)
    law_t = np.abs(p_t - np.clip(p_t - slip / length, -strength, strength))
    laws: Array = np.maximum(law_n, law_t)
    return max(imbalance, float(laws.max(initial=0.0))), laws


def read_states(s: Scaled, u: Array, t_n: Array, t_t: Array) -> PairStates:
    """Return the states that the natural map assigns to a point."""
    force, length = sizes(u, t_n, t_t)
    slip = np.where(s.rough, s.slip(u, t_t), 0.0) * (force / length)
    gap = s.normal_gap(u, t_n) * (force / length) - s.dilatancy * np.abs(slip)
    trial = t_n - gap
    closed = trial > 0
    strength = np.where(s.rough, s.cohesion + s.mu * np.clip(trial, 0.0, s.cap), 0.0)
    tangential = t_t - slip
    sliding = np.where(tangential < -strength, 1, np.where(tangential > strength, -1, 0))
    sliding = np.where(closed & s.rough, sliding, 0)
    normal = np.where(trial > s.cap, Normal.CRUSHED, np.where(closed, Normal.CLOSED, Normal.OPEN))
    return PairStates.plane(normal, sliding)


def solve_states(
    s: Scaled,
    states: PairStates,
    u: Array,
    t_n: Array,
    t_t: Array,
    anchor: Array | None = None,
    *,
    springs: Array | float = LOOSE,
    again: bool = False,
) -> tuple[Array, Array, Array, float]:
    """Solve the linear equations of given states, starting refinement from (u, t_n, t_t).

    Unknowns are tied to ``anchor`` (N,) by ``springs`` of stiffness ``LOOSE``: what nothing holds stays there, and what
    is held feels less than the equilibrium's rounding. ``again`` reuses the factorisation of the call before.

    Returns
    -------
    u, t_n, t_t : arrays
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
    drag = -sigma * s.mu  # t_t = drag t_n - sigma c where slipping
    open_wide = s.dilatancy * sigma
    # gap of a slipping pair: x + C_n u + a_n t_n - d sigma (C_t u - s + a_t t_t)
    delta = DELTA / s.share
    soft_n = np.where(hard, s.a_n - open_wide * s.a_t * drag + delta, 1.0)
    soft_t = np.where(stick, s.a_t + delta, 1.0)
    d_nn = np.where(hard, 1.0 / soft_n, 0.0)
    d_tt = np.where(stick, 1.0 / soft_t, 0.0)
    if not again:
        d_tn = d_nn * drag
        s.factor.factorise(np.concatenate([d_nn, -d_nn * open_wide, d_tn, d_tt - d_tn * open_wide]), springs)
    t_n = np.where(states.crushed, s.cap, np.where(touching, t_n, 0.0))
    t_t = np.where(stick, t_t, drag * t_n - sigma * s.cohesion) * touching
    anchor = u if anchor is None else anchor
    best, late = (u, t_n, t_t, np.inf), 0
    for _ in range(40):
        r_u = -s.imbalance(u, t_n, t_t) - springs * (u - anchor)
        slip_now = s.slip(u, t_t)
        r_n = np.where(hard, -(s.normal_gap(u, t_n) - open_wide * slip_now), 0.0)
        r_t = np.where(stick, -slip_now, 0.0)
        force, length = sizes(u, t_n, t_t)
        residual = max(
            float(np.abs(r).max(initial=0.0)) / size for r, size in ((r_u, force), (r_n, length), (r_t, length))
        )
        late = late + 1 if residual > 0.5 * best[3] else 0
        if residual < best[3]:
            best = (u, t_n, t_t, residual)
        if not residual > REFINED or residual > 1e3 * best[3] or late >= 3:
            break
        n0, t0 = r_n * d_nn, r_t * d_tt
        du = s.factor.solve(r_u + s.pull(n0, t0 + drag * n0))
        v_t = s.C_t @ du
        dt_n = n0 - d_nn * (s.C_n @ du - open_wide * v_t)
        dt_t = np.where(stick, t0 - d_tt * v_t, drag * dt_n)
        u, t_n, t_t = u + du, t_n + dt_n, t_t + dt_t
    return best


def _least_norm(s: Scaled, found: Finished) -> Finished:
    """Return the same answer with the least-norm forces among those of its states, if these obey the joint laws.

    Where pairs are redundant (corners) their forces are not unique. Refinement from zero forces ends at the least norm,
    which depends on nothing but the structure; the displacements are the same. Each pair's compliance goes with the
    inverse of its area, so it is the norm of the tractions: a uniform pressure is reported as one. The springs of
    loose unknowns are anchored anew at the answer, which takes their last influence out.
    """
    zero = np.zeros(s.pairs)
    for start_n, start_t in ((found.t_n, found.t_t), (zero, zero)):
        u, t_n, t_t, _ = solve_states(s, found.states, found.u, start_n, start_t, found.u, again=True)
        error, _ = natural_residual(s, u, t_n, t_t)
        if error <= max(found.error, EXACT):
            found = replace(found, u=u, t_n=t_n, t_t=t_t, error=error)
    return found


def _far_from_anchor(
    s: Scaled, states: PairStates, u: Array, t_n: Array, t_t: Array, error: float, laws: Array
) -> tuple[Array, Array, Array, float, Array]:
    """Anchor the springs of loose unknowns anew, as long as that lowers the error of settled states.

    A slender arch is hardly stiffer than these springs: where it goes far, they pull, and less at each new anchor.
    """
    for _ in range(ANCHORS):
        new_u, new_n, new_t, _ = solve_states(s, states, u, t_n, t_t, u, again=True)
        new_error, new_laws = natural_residual(s, new_u, new_n, new_t)
        if not new_error < 0.5 * error:
            break
        u, t_n, t_t, error, laws = new_u, new_n, new_t, new_error, new_laws
        if error < EXACT:
            break
    return u, t_n, t_t, error, laws


def finish(
    s: Scaled,
    u: Array,
    t_n: Array,
    t_t: Array,
    rounds: int = 12,
    states: PairStates | None = None,
    *,
    least: bool = True,
) -> Finished:
    """Turn a point close to a solution into the solution, if its states can be settled.

    Parameters
    ----------
    s : Scaled
    u, t_n, t_t : arrays
        The point, scaled, ``t_n`` shifted.
    rounds : int
        Largest number of active-set rounds.
    states : PairStates, optional
        States to begin with; default are those the point suggests.
    least : bool
        Whether forces that are not unique are those of least norm; otherwise those near to the point.
    """
    states = states or read_states(s, u, t_n, t_t)
    anchor = u
    seen: set[bytes] = set()
    best: Finished | None = None
    solves = 0
    for _ in range(rounds):
        seen.add(states.key())
        try:
            u, t_n, t_t, _ = solve_states(s, states, u, t_n, t_t, anchor)
        except SingularMatrixError:
            break
        solves += 1
        error, laws = natural_residual(s, u, t_n, t_t)
        new = read_states(s, u, t_n, t_t)
        if error >= EXACT and new.key() == states.key():
            u, t_n, t_t, error, laws = _far_from_anchor(s, states, u, t_n, t_t, error, laws)
            new = read_states(s, u, t_n, t_t)
        undecided = np.flatnonzero((laws > 1e-10) & new.differ(states))
        if best is None or error < best.error:
            best = Finished(u, t_n, t_t, states, error, solves, undecided)
        if error < EXACT:
            best = _least_norm(s, best) if least else best
            break
        if new.key() in seen:
            break
        states = new
    if best is None:
        error, laws = natural_residual(s, u, t_n, t_t)
        return Finished(u, t_n, t_t, states, error, solves, np.flatnonzero(laws > 1e-10))
    return Finished(best.u, best.t_n, best.t_t, best.states, best.error, solves, best.undecided)
