r"""The motion that never ends, in space: found by steps in which friction opposes the rate of slip.

The equations are those of :mod:`concio.solvers.motion.departure`. In the plane the states of the pairs give them at
once; in space the directions of slip are unknown as well. Here the structure makes steps of

.. math:: (K + e M)(u_{k+1} - u_k) = f - K u_k + C^T t_{k+1},

in which pairs that slip forget what they slipped before. A motion of constant acceleration is what such steps settle
into: equal steps, equal forces, slips along their rates.
"""

from __future__ import annotations

import numpy as np

from concio.problem.contact_problem import Array
from concio.problem.solution import Departure
from concio.solvers.algebra.scaled import Scaled
from concio.solvers.interior.newton_finish import finish
from concio.solvers.motion.departure import STILL, verify_departure

FINEST = (1e-5, 1e-7, 1e-9)
"""Values of e, scaled units, at which the acceleration is worked out."""

STEPS = 25
"""Largest number of steps for it."""

SOLVED = 1e-9
"""Natural-map residual up to which a step counts as solved."""

RIGID = 1e-6
"""Largest scaled displacement, besides the motion, that is taken for none: elastic bodies under load move by one."""

BEYOND = 100.0
"""Least length of the motion, in displacements besides it, at the point on it that is certified: directions of slips
that have only begun would be known to fewer digits."""

SLIDES = 1e-6
"""Share of the largest slip of a step from which on a pair counts as sliding."""


def departure(s: Scaled, u: Array, t: Array, velocity: Array, resistance: float | None = None) -> Departure | None:
    """Return the certified motion that follows from a state of slow motion, or None.

    Parameters
    ----------
    s : Scaled
    u, t : (N,), (m, d) arrays
        Displacements and forces of the state, scaled.
    velocity : (N,) array
        e (u_k+1 - u_k) of its last step.
    resistance : float, optional
        e of that step, to begin with where the step was a long one.
    """
    if s.problem.rigid_motions == 0:
        return None
    for e in FINEST if resistance is None else (resistance, *FINEST):
        found = _settled(s, u, t, velocity / e, e)
        if found is not None and found.certified:
            return found
    return None


def _settled(s: Scaled, u: Array, t: Array, step: Array, e: float) -> Departure | None:
    """Make steps until they no longer change; return the motion they amount to."""
    last = np.inf
    for k in range(STEPS):
        new = finish(s.step_from(u, e, _forgotten(s, u, t, step)), step, t, rounds=12)
        if new.error > SOLVED:
            return None
        size, change = float(np.abs(new.u).max(initial=0.0)), float(np.abs(new.u - step).max(initial=0.0))
        step, t, u = new.u, new.t, u + new.u
        if not np.isfinite(size) or size < 1.0:
            return None  # it comes to rest
        found = _proof(s, e * step, u, t)
        if found is not None and found.certified:
            return found
        if k > 3 and change > 0.5 * last:
            return None
        last = change
    return None


def _forgotten(s: Scaled, u: Array, t: Array, step: Array) -> Array:
    """Return gap and slip (m, d) that pairs sliding in a step forget: their slip, and what it opened by dilatancy."""
    rate = np.linalg.norm(s.along(step)[:, 1:], axis=1)
    slides = s.rough & (t[:, 0] > 0) & (rate > SLIDES * float(rate.max(initial=0.0)))
    slip = np.where(slides[:, None], s.position(u, t)[:, 1:], 0.0)
    return np.column_stack([s.dilatancy * np.linalg.norm(slip, axis=1), slip])


def _proof(s: Scaled, a: Array, u: Array, t: Array) -> Departure | None:
    """Return what the rigid part of an acceleration proves, from a point far enough along its motion."""
    R = s.problem.R
    a = R @ (R.T @ a)
    top = float(np.abs(a).max(initial=0.0))
    if not top > 0:
        return None
    u = u - a * (float(a @ u) / float(a @ a))
    if float(np.abs(u).max()) < RIGID:
        u = np.zeros_like(u)  # nothing deforms: rounding must not be measured against itself
    rate, y = s.along(a), s.position(u, t)
    speed = np.linalg.norm(rate[:, 1:], axis=1)
    slip = (rate[:, 1:] * y[:, 1:]).sum(axis=1) / np.where(speed > 0, speed, 1.0)
    gap = y[:, 0] - s.dilatancy * np.linalg.norm(y[:, 1:], axis=1)
    opening = (rate[:, 0] > STILL * top) & (gap < 0) & (t[:, 0] <= 0)
    behind = (speed > STILL * top) & (slip < 0) & s.rough
    far = np.concatenate([-gap[opening] / rate[opening, 0], -slip[behind] / speed[behind]]).max(initial=0.0)
    far = max(1.01 * far, BEYOND * float(np.abs(u).max()) / top)
    return verify_departure(s.problem, s.acceleration(a), *s.restore(u + far * a, t))
