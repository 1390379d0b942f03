r"""The linear equations of given states, and the states that forces and velocities suggest.

With a state for every pair the problem is linear in the plane; in space the friction of a pair that slips turns with
its slip, and is linearised about the direction and the size that the point before suggests:

.. math:: t_t = -\sigma(t_n)\, e - s\,(1 - e e^T)\, y_t, \qquad s = \sigma / |y_t|.

A small compliance (:attr:`StepProblem.added`) gives the
matrix A + C'DC, one d x d block D for each pair; iterative refinement against the equations without it takes it out
again. Where forces are not unique (rigid blocks on many corners) refinement from zero ends at those of least norm.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.problem import natural_map
from concio.problem.contact_problem import Array
from concio.problem.pair_state import PairStates
from concio.solvers.algebra.factor import Solves
from concio.solvers.stepping.problem import Errors, StepProblem, largest

REFINED = 1e-13
"""Relative residual at which refinement stops."""

ROUNDS = 25
"""Largest number of refinements."""


@dataclass(frozen=True, eq=False)
class Linear:
    """The linear law of each pair in given states: which rows hold, what friction goes with the normal force.

    Parameters
    ----------
    closed, stick : (m,) boolean arrays
        Pairs whose normal, whose tangential rows hold.
    drag : (m, d-1) array
        t_t = drag t_n + pull where a pair slips, along its slip.
    pull : (m, d-1) array
    held_n : (m,) array
        Normal force of pairs that are open or crushed.
    open_wide : (m, d-1) array
        Opening for each unit of slip.
    delta_n : (m,) array
        Compliance added along the normal.
    soft_t : (m,) array
        Compliance along the tangents with what is added; one where a pair neither sticks nor turns its slip.
    opens : bool
        Whether any pair opens as it slips.
    slips : (m,) boolean array or None
        Pairs whose slip may turn; None in the plane, where none may.
    direction : (m, d-1) array
        Along which they slip.
    turn : (m,) array
        Compliance |y_t| / sigma across it.
    """

    closed: Array
    stick: Array
    drag: Array
    pull: Array
    held_n: Array
    open_wide: Array
    delta_n: Array
    soft_t: Array
    opens: bool
    slips: Array | None
    direction: Array
    turn: Array

    @classmethod
    def of(cls, p: StepProblem, states: PairStates, turn: Array) -> Linear:
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
        soft = np.where(stick, p.a_t + delta_t, 1.0)
        turns = None
        if p.dim == 3:
            turns = slips & states.slips & np.isfinite(turn)
            soft = np.where(turns, p.a_t + delta_t + turn, soft)
        return cls(closed, stick, drag, pull, held, wide, delta_n, soft, p.dilates, turns, way, turn)

    def across(self, v: Array) -> Array:
        """Return the part (m, d-1) of tangential vectors that springs resist: all that sticks, across what slips."""
        found: Array = np.where(self.stick[:, None], v, 0.0)
        if self.slips is not None:
            e = self.direction
            found = np.where(self.slips[:, None], v - dot(e, v)[:, None] * e, found)
        return np.asarray(found)

    def yielded(self, t_t: Array) -> Array:
        """Return the slip (m, d-1) across which friction has turned, for friction t_t (m, d-1)."""
        if self.slips is None:
            return np.zeros_like(t_t)
        return np.asarray(np.where(self.slips[:, None], self.turn[:, None], 0.0) * t_t)

    def blocks(self, p: StepProblem) -> Array:
        """Return D (m, d, d)."""
        soft_n = p.a_n + self.delta_n
        if self.opens:
            soft_n = soft_n - p.a_t * dot(self.open_wide, self.drag)
        d_nn = np.where(self.closed, 1.0 / soft_n, 0.0)
        d_tn = self.drag * d_nn[:, None]
        D = np.zeros((p.pairs, p.dim, p.dim))
        D[:, 0, 0], D[:, 1:, 0] = d_nn, d_tn
        stiff = np.where(self.stick, 1.0 / self.soft_t, 0.0)
        if self.slips is not None:
            stiff = np.where(self.slips, 1.0 / self.soft_t, stiff)
            e = np.where(self.slips[:, None], self.direction, 0.0)
            D[:, 1:, 1:] -= stiff[:, None, None] * e[:, :, None] * e[:, None, :]
        for k in range(1, p.dim):
            D[:, k, k] += stiff
        if self.opens:
            D[:, 0, 1:] = -d_nn[:, None] * self.open_wide
            D[:, 1:, 1:] -= d_tn[:, :, None] * self.open_wide[:, None, :]
        return D


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
    beyond = _size(t[:, 1:] - y_t / unit[:, None]) - strength
    beyond = np.where(beyond > 0, beyond, _size(y_t) / unit)
    usable = (strength > 0) & np.isfinite(strength)
    return np.where(usable, unit * beyond / np.where(usable, strength, 1.0), np.inf)


def solve_states(
    p: StepProblem, factor: Solves, linear: Linear, x: Array, t: Array, D: Array
) -> tuple[Array, Array, Errors]:
    """Solve the equations of given states by refinement from (x, t); the factor holds (nearly) their matrix.

    Returns
    -------
    x : (N,) array
    t : (m, d) array
    errors : Errors
        At that point.
    """
    closed, drag = linear.closed, linear.drag
    t_n = np.where(closed, t[:, 0], linear.held_n)
    t = _side_by_side(t_n, linear.across(t[:, 1:]) + (drag * t_n[:, None] + linear.pull))
    stiff, opens, soft = D[:, 0, 0], linear.opens, linear.soft_t[:, None]
    least, late, best = np.inf, 0, None
    for _ in range(ROUNDS):
        errors = p.errors(x, t)
        slip = errors.y_t
        r_n = np.where(closed, dot(linear.open_wide, slip) - errors.y_n if opens else -errors.y_n, 0.0)
        r_t = linear.across(-slip - linear.yielded(t[:, 1:]))
        residual = max(largest(errors.r_u) / p.force, max(largest(r_n), largest(r_t)) / p.length)
        late = late + 1 if residual > 0.3 * least else 0
        if best is None or residual < least:
            best, least = (x, t, errors), residual
        if not residual > REFINED or late >= 2 or residual > 1e3 * least:
            break
        n0, own = r_n * stiff, r_t / soft
        dx = factor.solve(errors.r_u + p.pull(_side_by_side(n0, own + drag * n0[:, None])))
        v = p.opening(dx)
        v_n, v_t = v[:, 0], v[:, 1:]
        dt_n = n0 - stiff * (v_n - dot(linear.open_wide, v_t) if opens else v_n)
        dt_t = own - linear.across(v_t) / soft + drag * dt_n[:, None]
        x, t = x + dx, t + _side_by_side(dt_n, dt_t)
    assert best is not None
    return best


def dot(p: Array, q: Array) -> Array:
    """Return the scalar products (m,) of tangential vectors (m, d-1)."""
    first = p[:, 0] * q[:, 0]
    return np.asarray(first if p.shape[1] == 1 else first + p[:, 1] * q[:, 1])


def _size(v: Array) -> Array:
    """Return the lengths (m,) of tangential vectors (m, d-1)."""
    return np.asarray(np.sqrt(dot(v, v)))


def _side_by_side(first: Array, others: Array) -> Array:
    both = np.empty((len(first), 1 + others.shape[1]))
    both[:, 0], both[:, 1:] = first, others
    return both


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
