r"""Lagrange multipliers with an active set: guess the state of every pair, solve, correct the guess.

With a state for each pair (normal: open, closed, crushed; tangential: stick, slip either way) the contact conditions
are linear equations, the contact forces their Lagrange multipliers, and one sparse system gives displacements and
forces. States that contradict the answer are corrected:

* open and penetrating: close; closed and pulled beyond its strength: open; closed beyond the cap: crush;
* sticking beyond its strength: slip against the force; slipping the wrong way: stick.

All contradictions are corrected at once for 15 rounds, or until a set of states comes back (the iteration cycles,
which friction and redundant corners make common); from then on only the worst, one pair a factorisation. Correcting
all at once ends in a few rounds or wanders; correcting the worst first is slow and has ended on every standard problem,
jammed arches included. An answer is exact. There is no guarantee that it ends.

The system with states imposed is regularised by a compliance of 1e-3 (redundant corners: three pairs, two relative
motions; multipliers not unique) and a vanishing proximal term (bodies no closed pair holds), both taken out by
iterating on the multipliers with the same factors. Floating bodies are no obstacle where enough pairs close. Slip has
a sign only in two dimensions; in three, take ``alart-curnier``.

References
----------
G. Strang, *Introduction to Applied Mathematics*, 1986, section 8 (active sets). N. Kikuchi, J. T. Oden, *Contact
Problems in Elasticity*, SIAM, 1988 (multipliers in contact). M. Hintermüller, K. Ito, K. Kunisch, The primal-dual
active set strategy as a semismooth Newton method, *SIAM J. Optim.* 13 (2003) 865-888.
"""

from __future__ import annotations

import numpy as np

from concio.errors import MethodError
from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.pair_state import Normal, PairStates
from concio.problem.solution import ProgressCallback, Solution
from concio.solvers.algebra.scaled import Scaled, scale
from concio.solvers.methods.iterative.iteration import GOAL, Record, Stopped, answer

STIFFNESS = 1e3
"""Inverse of the compliance that regularises the multipliers."""

TOGETHER = 15
"""Rounds in which all contradictions are corrected at once."""


def solve(problem: ContactProblem, *, progress: ProgressCallback | None = None, limit: int = 600) -> Solution:
    """Solve by multipliers and an active set.

    Parameters
    ----------
    problem : ContactProblem
        In two dimensions.
    progress : callable, optional
    limit : int
        State corrections, one factorisation each.

    Raises
    ------
    MethodError
        The problem is three-dimensional.
    """
    if problem.dim != 2:
        msg = "the active set of signed slips is two-dimensional"
        raise MethodError(msg, hint="alart-curnier and simo-laursen do three")
    s = scale(problem)
    record = Record("lagrange", s, progress)
    record.info["unknowns"] = s.f.size + s.x.size
    u, t = s.glued, s.start
    states = _guess(s, u, t)
    seen = {states.key()}
    single = False
    try:
        for _ in range(limit):
            u, t = _solve_states(s, record, states, u, t)
            if not np.isfinite(u).all() or record.note(u, t) <= 5.0 * GOAL:
                break
            corrected = _corrected(s, states, u, t, single=single)
            if corrected.key() == states.key():
                record.trace.append("no state is contradicted, yet the equations do not hold: the system is singular.")
                break
            if not single and (corrected.key() in seen or len(record.history) >= TOGETHER):
                single = True
                record.trace.append(f"from correction {len(record.history)} on one at a time, the worst first.")
                corrected = _corrected(s, states, u, t, single=True)
            seen.add(corrected.key())
            states = corrected
    except Stopped as stop:
        return answer(problem, record, cancelled=stop.cancelled)
    return answer(problem, record)


def _guess(s: Scaled, u: Array, t: Array) -> PairStates:
    """States of the glued structure."""
    y = s.opening(u)
    normal = np.where(t[:, 0] - y[:, 0] > -s.cone.tension, Normal.CLOSED, Normal.OPEN)
    slips = np.abs(t[:, 1]) >= s.cone.strength(t[:, 0])
    return PairStates.plane(normal, np.where(slips, -np.sign(t[:, 1]), 0))


def _solve_states(s: Scaled, record: Record, states: PairStates, u: Array, t: Array) -> tuple[Array, Array]:
    """Return displacements and multipliers with the states imposed."""
    cone, closed, sign = s.cone, states.closed, -states.direction[:, 0]  # of the friction force
    slips = sign != 0
    stiffness = 1.0 / (1.0 / STIFFNESS + s.compliance)
    r_n, r_t = stiffness[:, 0], stiffness[:, 1]
    kappa = np.where(slips, s.dilatancy, 0.0) * r_n / r_t
    scale = closed / (1.0 + kappa * cone.friction)
    jacobian = np.zeros((s.pairs, 2, 2))
    jacobian[:, 0, 0] = scale
    jacobian[:, 0, 1] = scale * kappa * sign
    jacobian[:, 1, 0] = sign * cone.friction * jacobian[:, 0, 0]
    jacobian[:, 1, 1] = np.where(slips, sign * cone.friction * jacobian[:, 0, 1], ~_idle(s, states))
    imposed = np.where(states.open, -cone.tension, np.where(closed, -scale * kappa * cone.cohesion, 0.0))
    imposed = np.where(states.crushed, cone.cap, imposed)
    constant = np.column_stack([imposed, np.where(slips, sign * cone.linear_strength(imposed), 0.0)])

    def forces(v: Array, multiplier: Array) -> Array:
        w = stiffness * (multiplier / STIFFNESS - s.opening(v))
        t: Array = constant + np.einsum("kij,kj->ki", jacobian, w)
        return t

    lu = record.factorise(jacobian * stiffness[:, None, :], 1e-8)
    best = np.inf
    for _ in range(12):
        for _ in range(2):
            u = u - lu.solve(s.imbalance(u, forces(u, t)))
            record.solves()
        new = forces(u, t)
        change = float(np.abs(new - t).max(initial=0.0)) / STIFFNESS
        t = new
        if change < 1e-15 or change > 0.5 * best:
            break
        best = change
    return u, t


def _corrected(s: Scaled, states: PairStates, u: Array, t: Array, *, single: bool) -> PairStates:
    """Return the states with contradictions corrected: all of them, or only the worst."""
    cone, normal, sign = s.cone, states.normal, -states.direction[:, 0]
    y = s.opening(u) + s.compliance * t
    gap = y[:, 0] - np.where(sign != 0, -s.dilatancy * sign * y[:, 1], 0.0)
    eps = 1e-12
    n_wrong = np.select(
        [states.open, states.closed],
        [-gap, np.maximum(-cone.tension - t[:, 0], t[:, 0] - cone.cap)],
        gap,
    )
    radius = cone.strength(t[:, 0])
    t_wrong = np.where(sign != 0, sign * y[:, 1], np.abs(t[:, 1]) - radius)
    t_wrong = np.where(_idle(s, states), 0.0, t_wrong)
    fix_n, fix_t = n_wrong > eps, t_wrong > eps
    if single:
        worst = max(n_wrong.max(initial=0.0), t_wrong.max(initial=0.0))
        fix_n = n_wrong >= worst
        fix_t = (t_wrong >= worst) & ~fix_n
    toggled = np.where(t[:, 0] < -cone.tension + eps, Normal.OPEN, Normal.CRUSHED)
    toggled = np.where(states.closed, toggled, Normal.CLOSED)
    turned = np.where(sign != 0, 0.0, np.sign(t[:, 1]))
    closing = fix_n & _idle(s, states)
    sign = np.where(fix_t, turned, np.where(closing, 0.0, sign))
    return PairStates.plane(np.where(fix_n, toggled, normal), -sign)


def _idle(s: Scaled, states: PairStates) -> Array:
    """Open pairs without cohesion: they carry no friction, whatever their tangential state is called."""
    idle: Array = states.open & (s.cone.spare == 0.0)
    return idle
