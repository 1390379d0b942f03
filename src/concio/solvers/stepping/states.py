"""The laws of given states in a step, their solution, and the states that forces and velocities suggest.

With a state for every pair the problem is linear in the plane; in space the friction of a pair that slips turns with
its slip, and is linearised (:mod:`concio.solvers.states.pair_laws`). A small compliance (:attr:`StepProblem.added`)
gives the matrix A + C'DC, one d x d block D for each pair; iterative refinement against the equations without it takes
it out again. Where forces are not unique (rigid blocks on many corners) refinement from zero ends at those of least
norm.
"""

from __future__ import annotations

import numpy as np

from concio.problem import natural_map
from concio.problem.contact_problem import Array
from concio.problem.pair_state import PairStates
from concio.solvers.algebra.factor import Solves
from concio.solvers.states.pair_laws import PairLaws, dot, side_by_side
from concio.solvers.stepping.problem import Errors, StepProblem, largest, sizes

REFINED = 1e-13
"""Relative residual at which refinement stops."""

ROUNDS = 25
"""Largest number of refinements."""


def laws_of_step(p: StepProblem, states: PairStates, turn: Array) -> PairLaws:
    """Return the linear laws of states; ``turn`` (m,): compliance across the slip, see :func:`across_slip`."""
    cone, way = p.cone, states.direction
    delta_n, delta_t = p.added
    moves = p.flexibility[:, 1] + p.a_t > 0
    if p.plain:
        closed, zero = states.closed & p.active, np.zeros(p.pairs)
        rough = closed & cone.rough
        slips = rough & states.slips
        stick = rough & ~slips & moves
        pull, held = np.zeros_like(way), zero
    else:
        closed = (states.closed & p.active) | p.glued
        tension = np.where(p.glued | ~p.active, 0.0, cone.tension)
        cohesion = np.where(p.pinned, 0.0, cone.cohesion)
        holds = p.active & cone.rough & (~states.open | (cohesion - cone.friction * tension > 0))
        stick = ((holds & ~states.slips) | p.pinned) & moves
        slips = holds & ~stick
        pull = np.where(slips[:, None], -way * cohesion[:, None], 0.0)
        crushed = states.crushed & p.active
        held = np.where(crushed, np.where(np.isfinite(cone.cap), cone.cap, 0.0), -tension)
        held = np.where(closed, 0.0, held)
    drag = np.where(slips[:, None], -way * cone.friction[:, None], 0.0)
    wide = p.dilatancy[:, None] * way * slips[:, None] if p.dilates else np.zeros_like(way)
    soft_n, soft_t = p.a_n + delta_n, np.where(stick, p.a_t + delta_t, 1.0)
    if p.dilates:
        soft_n = soft_n - p.a_t * dot(wide, drag)
    turns = None
    if p.dim == 3:
        turns = slips & states.slips & np.isfinite(turn)
        soft_t = np.where(turns, p.a_t + delta_t + turn, soft_t)
    return PairLaws(closed, stick, drag, pull, held, wide, soft_n, soft_t, p.dilates, turns, way, turn)


def across_slip(p: StepProblem, x: Array, t: Array, errors: Errors | None = None) -> Array:
    """Return |y_t| / sigma (m,) of pairs at a point: how far friction lets a slip turn; infinite without friction.

    It is read off the natural map, so that it is positive wherever that map says that a pair slips.
    """
    if p.dim == 2:
        return np.zeros(p.pairs)
    y_n, y_t = p.relative(x, t) if errors is None else errors[1:]
    unit = np.where(p.flexibility[:, 1] > 0, p.flexibility[:, 1], 1.0)
    trial = t[:, 0] - y_n / np.where(p.flexibility[:, 0] > 0, p.flexibility[:, 0], 1.0)
    with np.errstate(invalid="ignore"):
        strength = p.cone.strength(np.clip(trial, -p.cone.tension, p.cone.cap))
    beyond = sizes(t[:, 1:] - y_t / unit[:, None]) - strength
    beyond = np.where(beyond > 0, beyond, sizes(y_t) / unit)
    usable = (strength > 0) & np.isfinite(strength)
    return np.where(usable, unit * beyond / np.where(usable, strength, 1.0), np.inf)


def solve_states(
    p: StepProblem, factor: Solves, laws: PairLaws, x: Array, t: Array, D: Array
) -> tuple[Array, Array, Errors]:
    """Solve the equations of given states by refinement from (x, t); the factor holds (nearly) their matrix.

    Returns
    -------
    x : (N,) array
    t : (m, d) array
    errors : Errors
        At that point.
    """
    drag, stiff, soft = laws.drag, D[:, 0, 0], laws.soft_t[:, None]
    t = laws.imposed(t)
    least, late, best = np.inf, 0, None
    for _ in range(ROUNDS):
        errors = p.errors(x, t)
        m_n, m_t = laws.misfit(errors.y_n, errors.y_t, t[:, 1:])
        residual = max(largest(errors.r_u) / p.force, max(largest(m_n), largest(m_t)) / p.length)
        late = late + 1 if residual > 0.3 * least else 0
        if best is None or residual < least:
            best, least = (x, t, errors), residual
        if not residual > REFINED or late >= 2 or residual > 1e3 * least:
            break
        n0, own = -m_n * stiff, -m_t / soft
        dx = factor.solve(errors.r_u + p.pull(side_by_side(n0, own + drag * n0[:, None])))
        v = p.opening(dx)
        v_n, v_t = v[:, 0], v[:, 1:]
        dt_n = n0 - stiff * (v_n - dot(laws.wide, v_t) if laws.opens else v_n)
        dt_t = own - laws.across(v_t) / soft + drag * dt_n[:, None]
        x, t = x + dx, t + side_by_side(dt_n, dt_t)
    assert best is not None
    return best


def read_states(p: StepProblem, x: Array, t: Array, errors: Errors | None = None) -> PairStates:
    """Return the states that the natural map assigns to a point, each pair measured by its own flexibility."""
    y_n, y_t = p.relative(x, t) if errors is None else errors[1:]
    y = np.column_stack([y_n, y_t]) / np.where(p.flexibility > 0, p.flexibility, 1.0)
    return natural_map.read_states(p.cone, y, t, p.dilatancy, p.active)


def halting(states: PairStates, before: PairStates) -> PairStates:
    """Return states, those sticking that would slide back after sliding forwards.

    What slides one way in one round and the other way in the next sticks in nine answers of ten.
    """
    back = ~states.open & ~before.open & (dot(states.direction, before.direction) < 0)
    return PairStates(states.normal, np.where(back[:, None], 0.0, states.direction))
