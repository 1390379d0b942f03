r"""The linear equations of given states, and the states that forces and velocities suggest.

With a state for every pair the problem is linear. A small compliance (:attr:`StepProblem.added`) gives the
matrix A + C'DC, one 2 x 2 block D for each pair; iterative refinement against the equations without it takes it out
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
        Pairs whose normal, whose tangential row holds.
    drag : (m,) array
        t_t = drag t_n + pull where a pair slips.
    pull : (m,) array
    held_n : (m,) array
        Normal force of pairs that are open or crushed.
    open_wide : (m,) array
        Opening for each unit of slip.
    delta_n : (m,) array
        Compliance added along the normal.
    soft_t : (m,) array
        Compliance along the tangent with what is added; one where a pair does not stick.
    opens : bool
        Whether any pair opens as it slips.
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

    @classmethod
    def of(cls, p: StepProblem, states: PairStates) -> Linear:
        """Return the linear laws of states."""
        cone, sigma = p.cone, states.direction[:, 0]
        delta_n, delta_t = p.added
        if p.plain:
            closed, zero = states.closed & p.active, np.zeros(p.pairs)
            rough = closed & cone.rough
            stick = rough & (sigma == 0) & (p.flexibility[:, 1] + p.a_t > 0)
            slips = rough & (sigma != 0)
            drag = np.where(slips, -sigma * cone.friction, 0.0)
            return cls(
                closed, stick, drag, zero, zero, p.dilatancy * sigma * slips if p.dilates else zero, delta_n,
                np.where(stick, p.a_t + delta_t, 1.0), p.dilates,
            )  # fmt: skip
        closed = (states.closed & p.active) | p.glued
        tension = np.where(p.glued | ~p.active, 0.0, cone.tension)
        cohesion = np.where(p.pinned, 0.0, cone.cohesion)
        holds = p.active & cone.rough & (~states.open | (cohesion - cone.friction * tension > 0))
        stick = ((holds & (sigma == 0)) | p.pinned) & (p.flexibility[:, 1] + p.a_t > 0)
        slips = holds & ~stick
        drag = np.where(slips, -sigma * cone.friction, 0.0)
        pull = np.where(slips, -sigma * cohesion, 0.0)
        crushed = states.crushed & p.active
        held = np.where(crushed, np.where(np.isfinite(cone.cap), cone.cap, 0.0), -tension)
        return cls(
            closed,
            stick,
            drag,
            pull,
            np.where(closed, 0.0, held),
            p.dilatancy * sigma * slips,
            delta_n,
            np.where(stick, p.a_t + delta_t, 1.0),
            p.dilates,
        )

    def blocks(self, p: StepProblem) -> Array:
        """Return D (m, 2, 2)."""
        soft_n = p.a_n + self.delta_n
        if self.opens:
            soft_n = soft_n - self.open_wide * p.a_t * self.drag
        d_nn = np.where(self.closed, 1.0 / soft_n, 0.0)
        d_tn = self.drag * d_nn
        D = np.zeros((p.pairs, 2, 2))
        D[:, 0, 0], D[:, 1, 0] = d_nn, d_tn
        D[:, 1, 1] = np.where(self.stick, 1.0 / self.soft_t, 0.0)
        if self.opens:
            D[:, 0, 1] = -d_nn * self.open_wide
            D[:, 1, 1] -= d_tn * self.open_wide
        return D


def solve_states(
    p: StepProblem, factor: Solves, linear: Linear, x: Array, t: Array, D: Array
) -> tuple[Array, Array, Errors]:
    """Solve the equations of given states by refinement from (x, t); the factor holds (nearly) their matrix.

    Returns
    -------
    x : (N,) array
    t : (m, 2) array
    errors : Errors
        At that point.
    """
    closed, stick, drag = linear.closed, linear.stick, linear.drag
    t_n = np.where(closed, t[:, 0], linear.held_n)
    t_t = np.where(stick, t[:, 1], drag * t_n + linear.pull)
    t = _side_by_side(t_n, t_t)
    stiff, opens = D[:, 0, 0], linear.opens
    least, late, best = np.inf, 0, None
    for _ in range(ROUNDS):
        errors = p.errors(x, t)
        slip = errors.y_t[:, 0]
        r_n = np.where(closed, linear.open_wide * slip - errors.y_n if opens else -errors.y_n, 0.0)
        r_t = np.where(stick, -slip, 0.0)
        residual = max(largest(errors.r_u) / p.force, max(largest(r_n), largest(r_t)) / p.length)
        late = late + 1 if residual > 0.3 * least else 0
        if best is None or residual < least:
            best, least = (x, t, errors), residual
        if not residual > REFINED or late >= 2 or residual > 1e3 * least:
            break
        n0 = r_n * stiff
        t0 = np.where(stick, r_t / linear.soft_t, drag * n0)
        dx = factor.solve(errors.r_u + p.pull(_side_by_side(n0, t0)))
        v = p.opening(dx)
        v_n, v_t = v[:, 0], v[:, 1]
        dt_n = n0 - stiff * (v_n - linear.open_wide * v_t if opens else v_n)
        dt_t = np.where(stick, t0 - v_t / linear.soft_t, drag * dt_n)
        x, t = x + dx, t + _side_by_side(dt_n, dt_t)
    assert best is not None
    return best


def _side_by_side(first: Array, second: Array) -> Array:
    both = np.empty((len(first), 2))
    both[:, 0], both[:, 1] = first, second
    return both


def read_states(p: StepProblem, x: Array, t: Array, errors: Errors | None = None) -> PairStates:
    """Return the states that the natural map assigns to a point, each pair measured by its own flexibility."""
    y_n, y_t = p.relative(x, t) if errors is None else errors[1:]
    y = np.column_stack([y_n, y_t]) / np.where(p.flexibility > 0, p.flexibility, 1.0)
    return natural_map.read_states(p.cone, y, t, p.dilatancy, p.active)


def halting(states: PairStates, before: PairStates) -> PairStates:
    """Return states of plane pairs, those sticking that would slide back after sliding forwards.

    What slides one way in one round and the other way in the next sticks in nine answers of ten.
    """
    back = ~states.open & ~before.open & (states.direction[:, 0] * before.direction[:, 0] < 0)
    return PairStates(states.normal, np.where(back[:, None], 0.0, states.direction))
