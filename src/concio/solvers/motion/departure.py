r"""Does the structure move away? The limit of vanishing inertia, and the accelerating motion that proves a collapse.

Forces within the cones may exist (no mechanism of :mod:`concio.solvers.statics.existence` proves collapse) and still no
state that
obeys Coulomb friction: friction is not associated, and a panel between two smooth-faced walls slides down although
forces exist that could hold it, had anything pressed it against them. What does it do? It moves. Give the bodies their
masses M and release them from rest; over one long time step 1/sqrt(e) (implicit Euler) the joint laws hold with

.. math:: (K + e M) u_e = f + C^T t_e, \qquad e > 0.

K + e M is positive definite, and then a Coulomb state exists whatever the friction (Brouwer's theorem on the normal
forces; Haslinger, Math. Methods Appl. Sci. 5, 1983). As e -> 0 either u_e stays bounded and its limit is an
equilibrium, or it grows: u_e = a/e + u + O(e). Then a is a rigid motion, and with it

.. math:: K u + M a = f + C^T t, \qquad K a = 0, \qquad \text{(u + s a, t) obeys every joint law for all } s \ge s_0:

constant forces, the whole structure accelerating along a, friction opposing the slip it really has. Multiplied by a,

.. math:: f^T a = a^T M a + \text{(dissipation)} > 0.

In space the slip of a pair turns towards its rate as it grows: what lies across is bounded and left out of account.

That is the proof of :attr:`concio.problem.solution.Status.COLLAPSES`, found from the states of u_e and then recomputed
from
the original arrays: the certificate of (u + s_0 a, t) under the loads f - M a, and the laws of the rates along a. It
shows that the structure, released from rest, moves off; it does not show that no equilibrium exists: another history
(prestress, wedging) might reach one.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from concio.problem.certificate import certify
from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.pair_state import PairStates
from concio.problem.solution import Departure
from concio.problem.units import measure
from concio.solvers.algebra.scaled import Scaled
from concio.solvers.algebra.sparse_factor import SingularMatrixError
from concio.solvers.states.equations import StateEquations
from concio.solvers.states.given import GivenStates

FINEST = (1e-6, 1e-8)
"""Values of e, scaled units, at which the acceleration of given states is worked out."""

STEPS = 6
"""Number of steps for it; each cuts what still deforms by e over the least stiffness of the structure."""

STILL = 1e-9
"""Relative velocities up to this share of the largest velocity count as none."""


def departure(s: Scaled, states: PairStates, u: Array, t: Array) -> Departure | None:
    """Return the certified motion that pairs in given states would follow, or None.

    Parameters
    ----------
    s : Scaled
    states : PairStates
        States of the pairs during the motion.
    u, t : (N,), (m, 2) arrays
        Any point in these states, scaled; where the linear solves begin.
    """
    if s.problem.rigid_motions == 0:
        return None
    for e in FINEST:
        try:
            found = _departure(s, states, u, t, e)
        except SingularMatrixError:
            continue
        if found is not None and found.certified:
            return found
    return None


def _departure(s: Scaled, states: PairStates, u: Array, t: Array, e: float) -> Departure | None:
    """Let given states move by steps of (K + e M)(u' - u) = f - K u + C't, of which the last ones are alike."""
    given, held, springs = GivenStates(s), StateEquations(s, states), e * s.inertia
    for _ in range(STEPS):
        new, t, _ = given.solve(held, u, t, springs=springs)
        step, u = new - u, new
        if not 1.0 <= float(np.abs(step).max()) < np.inf:
            return None  # it comes to rest
    R = s.problem.R
    a = e * (R @ (R.T @ step))
    moving = replace(s, f=s.f - s.inertia @ a)
    u = u - step * (float(step @ u) / float(step @ step))
    held = StateEquations(moving, states)
    for _ in range(2):
        u, t, _ = given.solve(held, u, t)
    # far enough along the motion that every opening pair is open and every slipping one has slipped its way
    rate_n, rate_t = s.along(a).T
    top = float(np.abs(a).max())
    gap, slip = s.position(u, t).T
    opening = states.open & (rate_n > STILL * top) & (gap < 0)
    wrong = ~states.open & (states.sign * rate_t > STILL * top) & (states.sign * slip < 0)
    far = np.concatenate([-gap[opening] / rate_n[opening], -slip[wrong] / rate_t[wrong]]).max(initial=0.0)
    return verify_departure(s.problem, s.acceleration(a), *s.restore(u + 1.01 * far * a, t))


def verify_departure(problem: ContactProblem, a: Array, u: Array, t_n: Array, t_t: Array) -> Departure:
    """Recompute every condition of a departure from the original arrays; none of it is taken from a solver.

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
    w_t = (problem.C_t @ a).reshape(t_t.shape)
    speed = np.linalg.norm(w_t, axis=1)
    moving = without_slip_across(problem, u, t_t, np.where((speed > STILL * top)[:, None], w_t, 0.0))
    moving = replace(moving, f=problem.f - problem.inertia @ a, load=problem.applied)
    certificate, units = certify(moving, u, t_n, t_t), measure(moving, u, t_n, t_t)
    force = units.pair_force
    stiffness = float(abs(problem.K).max()) if problem.K.nnz else 1.0
    rigid = float(np.abs(problem.K @ a).max(initial=0.0)) / (stiffness * top)
    cone = problem.cone
    w_n = problem.C_n @ a - np.where(cone.rough, law.dilatancy * speed, 0.0)
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

    What a pair slipped across the direction of its motion stays bounded while the slip along it grows without end: in
    the limit the slip has the direction of its rate. In the plane there is no across.
    """
    slip = (problem.C_t @ u).reshape(t_t.shape) - problem.slip_origin
    slip += problem.laws.tangential_compliance[:, None] * t_t
    speed = np.linalg.norm(w_t, axis=1)
    direction = w_t / np.where(speed > 0, speed, 1.0)[:, None]
    across = slip - (slip * direction).sum(axis=1, keepdims=True) * direction
    return replace(problem, slip_origin=problem.slip_origin + np.where((speed > 0)[:, None], across, 0.0))
