r"""Does the structure move away? The limit of vanishing inertia, and the accelerating motion that proves a collapse.

Forces within the cones may exist (no mechanism of :mod:`concio.solvers.statics.existence` proves collapse) and still no
state that obeys Coulomb friction: friction is not associated, and a panel between two smooth-faced walls slides down
although forces exist that could hold it, had anything pressed it against them. What does it do? It moves. Give the
bodies their masses M and release them from rest; over one long time step 1/sqrt(e) (implicit Euler) the joint laws hold
with

.. math:: (K + e M) u_e = f + C^T t_e, \qquad e > 0.

K + e M is positive definite, and then a Coulomb state exists whatever the friction (Brouwer's theorem on the normal
forces; Haslinger, Math. Methods Appl. Sci. 5, 1983). As e -> 0 either u_e stays bounded and its limit is an
equilibrium, or it grows: u_e = a/e + u + O(e). Then a is a rigid motion, and with it

.. math:: K u + M a = f + C^T t, \qquad K a = 0, \qquad \text{(u + s a, t) obeys every joint law for all } s \ge s_0:

constant forces, the whole structure accelerating along a, friction opposing the slip it really has. Multiplied by a,

.. math:: f^T a = a^T M a + \text{(dissipation)} > 0.

In space the slip of a pair turns towards its rate as it grows: what lies across is bounded and left out of account.

That is the proof of :attr:`concio.problem.solution.Status.COLLAPSES`, recomputed from the original arrays: the
certificate of (u + s_0 a, t) under the loads f - M a, and the laws of the rates along a. It shows that the structure,
released from rest, moves off; it does not show that no equilibrium exists: another history (prestress, wedging) might
reach one.

The motion is found by steps

.. math:: (K + e M)(u_{k+1} - u_k) = f - K u_k + C^T t_{k+1},

in which pairs that slip forget what they slipped before, so that friction opposes the rate of slip. Such steps become
equal, with equal forces and slips along their rates: a motion of constant acceleration.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from concio.problem.certificate import certify
from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.error_units import measure
from concio.problem.products import product, transposed_product
from concio.problem.solution import Departure
from concio.problem.tolerances import MOVING_ON, RIGID_BODY, SLIDES, STILL_PAIR
from concio.solvers.algebra.scaled import Scaled
from concio.solvers.algebra.sparse_factor import SingularMatrixError
from concio.solvers.interior.newton_finish import finish
from concio.solvers.states.given import GivenStates
from concio.solvers.states.state_reading import Finished
from concio.solvers.states.static_laws import laws_of

FINEST = (1e-5, 1e-7, 1e-9)
"""Values of e, scaled units, at which the acceleration is worked out."""

STEPS = 25
"""Largest number of steps for it."""

DIGITS = 1e-13
"""Violation of a proof below which no further step is made; above it steps go on while they halve it."""

STATES_AT, STATE_STEPS = (1e-6, 1e-8, 1e-10, 1e-12, 1e-14), 6
"""Values of e at which the motion of given states is worked out, and steps for it; each cuts what still deforms by e
over the least stiffness of the structure: what moves off slowly, under little load too many, needs the least."""

BEYOND = 100.0
"""Least length of the motion, in displacements besides it, at the point on it that is certified: directions of slips
that have only begun would be known to fewer digits."""


def unbounded_motion(s: Scaled, now: Finished, velocity: Array, resistance: float | None = None) -> Departure | None:
    """Return the certified motion that follows from a state of slow motion, or None.

    Parameters
    ----------
    s : Scaled
    now : Finished
        The state, scaled.
    velocity : (N,) array
        e (u_k+1 - u_k) of its last step.
    resistance : float, optional
        e of that step, at the start where the step was a long one.
    """
    if s.problem.rigid_motions == 0:
        return None
    for e in FINEST if resistance is None else (resistance, *FINEST):
        found = _equal_steps(s, now.u, now.t, velocity / e, e)
        if found is not None:
            return found
    return _of_states(s, now) if s.dim == 2 else None


def _equal_steps(s: Scaled, u: Array, t: Array, step: Array, e: float) -> Departure | None:
    """Make steps until they are equal; return the certified motion they amount to, or None."""
    last, best = np.inf, None
    for k in range(STEPS):
        new = finish(s.step_from(u, e, _forgotten(s, u, t, step)), step, t, rounds=12)
        if new.error > MOVING_ON:
            break
        size, change = float(np.abs(new.u).max(initial=0.0)), float(np.abs(new.u - step).max(initial=0.0))
        step, t, u = new.u, new.t, u + new.u
        if not np.isfinite(size) or size < 1.0:
            break  # it comes to rest
        found = _proof(s, e * step, u, t)
        if found is not None and found.certified:
            if best is not None and found.violation > 0.5 * best.violation:
                break
            best = found
            if best.violation < DIGITS:
                break
        elif best is not None or (k > 3 and change > 0.5 * last):
            break
        last = change
    return best


def _of_states(s: Scaled, now: Finished) -> Departure | None:
    """Return the certified motion that the pairs follow in the states they have, or None (plane problems).

    Where bodies are ten thousand times as soft as others, the digits of what deforms are lost in the length of Newton's
    steps. With the states known, the loads less M a leave linear equations of displacements that do not grow.
    """
    for e in STATES_AT:
        try:
            found = _states_moved(s, now, e)
        except SingularMatrixError:
            continue
        if found is not None and found.certified:
            return found
    return None


def _states_moved(s: Scaled, now: Finished, e: float) -> Departure | None:
    """Let the states move by steps (K + e M)(u' - u) = f - K u + C't, the last of them equal; prove their motion."""
    u, t, step = now.u, now.t, now.u
    given, laws, springs = GivenStates(s), laws_of(s, now.states), e * s.inertia
    for _ in range(STATE_STEPS):
        new, t, _ = given.refined(s, laws, u, t, springs=springs)
        step, u = new - u, new
        if not 1.0 <= float(np.abs(step).max()) < np.inf:
            return None  # it comes to rest
    R = s.problem.R
    a = e * product(R, transposed_product(R, step))
    held = replace(s, f=s.f - product(s.inertia, a))
    u = u - step * (float(step @ u) / float(step @ step))
    for _ in range(2):
        u, t, _ = given.refined(held, laws, u, t)
    return _proof(s, a, u, t)


def _forgotten(s: Scaled, u: Array, t: Array, step: Array) -> Array:
    """Return gap and slip (m, d) that pairs sliding in a step forget: their slip, and what it opened by dilatancy."""
    rate = np.linalg.norm(s.along(step)[:, 1:], axis=1)
    slides = s.rough & (t[:, 0] > 0) & (rate > SLIDES * float(rate.max(initial=0.0)))
    slip = np.where(slides[:, None], s.position(u, t)[:, 1:], 0.0)
    return np.column_stack([s.dilatancy * np.linalg.norm(slip, axis=1), slip])


def _proof(s: Scaled, a: Array, u: Array, t: Array) -> Departure | None:
    """Return what the rigid part of an acceleration proves, from a point far enough along its motion."""
    R = s.problem.R
    a = product(R, transposed_product(R, a))
    top = float(np.abs(a).max(initial=0.0))
    if not top > 0:
        return None
    u = u - a * (float(a @ u) / float(a @ a))
    if float(np.abs(u).max()) < RIGID_BODY:
        u = np.zeros_like(u)  # nothing deforms: rounding must not be measured against itself
    rate, y = s.along(a), s.position(u, t)
    speed = np.linalg.norm(rate[:, 1:], axis=1)
    slip = (rate[:, 1:] * y[:, 1:]).sum(axis=1) / np.where(speed > 0, speed, 1.0)
    gap = y[:, 0] - s.dilatancy * np.linalg.norm(y[:, 1:], axis=1)
    opening = (rate[:, 0] > STILL_PAIR * top) & (gap < 0) & (t[:, 0] <= 0)
    behind = (speed > STILL_PAIR * top) & (slip < 0) & s.rough
    far = np.concatenate([-gap[opening] / rate[opening, 0], -slip[behind] / speed[behind]]).max(initial=0.0)
    far, further = 1.01 * far, BEYOND * float(np.abs(u).max()) / top
    found = verify_motion(s.problem, s.acceleration(a), *s.restore(u + max(far, further) * a, t))
    if found.certified or s.dim == 3 or far >= further:
        return found
    # after a long way stiff joints have lost their digits: no more of it than the pairs need
    return verify_motion(s.problem, s.acceleration(a), *s.restore(u + far * a, t))


def verify_motion(problem: ContactProblem, a: Array, u: Array, t_n: Array, t_t: Array) -> Departure:
    """Recompute every condition of an unbounded motion from the original arrays; none of it is taken from a solver.

    Parameters
    ----------
    problem : ContactProblem
    a : (N,) array
        Accelerations [m/s2].
    u : (N,) array
        Displacements on the way [m].
    t_n, t_t : (m,), (m, d-1) arrays
        Forces [kN].
    """
    law = problem.laws
    top = float(np.abs(a).max(initial=0.0)) or 1.0
    w_t = product(problem.C_t, a).reshape(t_t.shape)
    speed = np.linalg.norm(w_t, axis=1)
    moving = without_slip_across(problem, u, t_t, np.where((speed > STILL_PAIR * top)[:, None], w_t, 0.0))
    moving = replace(moving, f=problem.f - product(problem.inertia, a), load=problem.applied)
    certificate, units = certify(moving, u, t_n, t_t), measure(moving, u, t_n, t_t)
    force = units.pair_force
    stiffness = float(np.abs(problem.K.data).max()) if problem.K.nnz else 1.0
    rigid = float(np.abs(product(problem.K, a)).max(initial=0.0)) / (stiffness * top)
    cone = problem.cone
    w_n = product(problem.C_n, a) - np.where(cone.rough, law.dilatancy * speed, 0.0)
    opening, closing = np.maximum(w_n, 0.0) / top, np.maximum(-w_n, 0.0) / top
    reserve = np.where(cone.capped, np.maximum(cone.cap - t_n, 0.0) / force, np.inf)  # against crushing
    wrong_way = np.linalg.norm(t_t - cone.opposing(t_n, w_t), axis=1) / force
    violation = max(
        certificate.worst,
        rigid,
        float(np.minimum(opening, (t_n + cone.tension) / force).max(initial=0.0)),
        float(np.minimum(closing, reserve).max(initial=0.0)),
        float(np.minimum(speed / top, wrong_way).max(initial=0.0)),
    )
    power = units.parts.total(units.parts.of_unknown, problem.f * a) / units.force
    return Departure(a, problem.inertia, u, t_n, t_t, float(power.max(initial=0.0)) / top, violation)


def without_slip_across(problem: ContactProblem, u: Array, t_t: Array, w_t: Array) -> ContactProblem:
    """Return the problem whose slips at u (N,) lie along their rates w_t (m, d-1), where these are not zero.

    What a pair slipped across the direction of its motion stays bounded while the slip along it grows without bound: in
    the limit the slip has the direction of its rate. In the plane there is no across.
    """
    slip = product(problem.C_t, u).reshape(t_t.shape) - problem.slip_origin
    slip += problem.laws.tangential_compliance[:, None] * t_t
    speed = np.linalg.norm(w_t, axis=1)
    direction = w_t / np.where(speed > 0, speed, 1.0)[:, None]
    across = slip - (slip * direction).sum(axis=1, keepdims=True) * direction
    return replace(problem, slip_origin=problem.slip_origin + np.where((speed > 0)[:, None], across, 0.0))
