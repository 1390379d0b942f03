r"""Collapse states of Coulomb friction without dilatancy, and their certificate.

A *collapse state* is a multiplier lambda, forces t and a rigid motion v with g'v > 0 such that

.. math:: R^T (f + \lambda g + C^T t) = 0,\quad t_k \in S_k,\quad w_n \ge 0,\quad w_n (t_n + T) = 0,\quad
          t_t = -(c + \mu t_n)\, w_t/|w_t| \text{ where } w_t \ne 0,

with w = C v: the structure can begin to move at lambda with the friction that its joints really have. There may be
many; :mod:`concio.solvers.statics.collapse_search` looks for the least.

Here a motion becomes a state: forces of the *true* cones, with every pair in the state that the motion asks for, are
found by a linear programme, in space by one over second-order cones
(:mod:`concio.solvers.statics.collapse_cones`), and the state is rechecked by plain matrix products.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.tolerances import CHECKED, MOVES
from concio.read_only import read_only
from concio.representation import short_repr
from concio.solvers.statics.associated_limit import static_residual
from concio.solvers.statics.collapse_cones import forces_in_space
from concio.solvers.statics.mechanism import pair_velocities
from concio.solvers.statics.programme import LARGE, Method, StaticProgramme, optimise

NEAR = 1e9
"""Slip directions that differ by less than one over this are asked for as one."""


@short_repr
@dataclass(frozen=True, eq=False)
@read_only
class CollapseState:
    """A certified state in which the structure can begin to move under Coulomb friction.

    Parameters
    ----------
    multiplier : float
    normal_force, friction_force : arrays (m,), (m, d-1)
        [kN].
    velocity : (N,) array
        Rigid motion, largest entry 1.
    statics : float
        Largest residual of equilibrium and excess over the cones, relative to the total load.
    flow : float
        Largest product of a relative velocity with the force that should vanish or the slip that should be opposed,
        relative to the largest velocity and the total load; and penetration rate relative to the largest velocity.
    iterations : int
        Linear programmes until it was found.
    """

    multiplier: float
    normal_force: Array
    friction_force: Array
    velocity: Array
    statics: float
    flow: float
    iterations: int

    @property
    def certified(self) -> bool:
        """True when all residuals are rounding."""
        return max(self.statics, self.flow) <= CHECKED


@short_repr
@dataclass(frozen=True, eq=False)
class Motion:
    """Which pairs open, slip (and which way) and crush in a motion.

    Parameters
    ----------
    velocity : (N,) array
        Largest entry 1.
    w_n, w_t : arrays (m,), (m, d-1)
        Its relative velocities.
    opens, slips, crushes : (m,) boolean arrays
    """

    velocity: Array
    w_n: Array
    w_t: Array
    opens: Array
    slips: Array
    crushes: Array

    @classmethod
    def of(cls, problem: ContactProblem, velocity: Array) -> Motion:
        """Return what a motion (N,) of any size asks of the pairs."""
        v = velocity / float(np.abs(velocity).max())
        w_n, speed = pair_velocities(problem, v)
        w_t = (problem.C_t @ v).reshape(problem.pairs, problem.dim - 1)
        crushes = problem.cone.capped & (w_n < -MOVES)
        return cls(v, w_n, w_t, w_n > MOVES, speed > MOVES, crushes)

    @cached_property
    def direction(self) -> Array:
        """Unit directions (m, d-1) of the slips; zero where a pair does not slip."""
        speed = np.linalg.norm(self.w_t, axis=1)
        unit: Array = np.where(self.slips[:, None], self.w_t / np.where(speed > 0, speed, 1.0)[:, None], 0.0)
        return unit

    @property
    def key(self) -> bytes:
        """The states of all pairs: equal keys ask for the same forces (in space, for nearly the same)."""
        return np.concatenate([self.opens, self.crushes, np.rint(NEAR * self.direction).ravel()]).tobytes()

    def flow_error(self, problem: ContactProblem, t_n: Array, t_t: Array) -> Array:
        """Return the power that should not be there at each pair, (m,), for forces t_n (m,), t_t (m, d-1) [kN]."""
        cone = problem.cone
        cap = np.where(cone.capped, cone.cap, 0.0)
        opposed = np.linalg.norm(t_t - cone.opposing(t_n, self.direction), axis=1)
        wrong: Array = np.maximum.reduce(
            [
                np.abs(np.where(self.opens, self.w_n, 0.0) * (t_n + cone.tension)),
                np.where(self.slips, np.linalg.norm(self.w_t, axis=1), 0.0) * opposed,
                np.abs(np.where(self.crushes, self.w_n, 0.0) * (cap - t_n)),
            ]
        )
        return wrong

    def penetration(self) -> float:
        """Largest rate at which pairs that do not crush come closer."""
        return float(np.where(self.crushes, 0.0, np.maximum(-self.w_n, 0.0)).max(initial=0.0))


def certify_collapse(
    problem: ContactProblem, live: Array, velocity: Array, iterations: int, most: float = np.inf
) -> CollapseState | None:
    """Find forces of the true cones that go with a motion (N,), and return the certified state or None.

    No collapse state has a multiplier above an associated bound, ``most``: where it is known, none is sought there.
    """
    motion = Motion.of(problem, velocity)
    found = _programmed(problem, motion, live, most) if problem.dim == 2 else forces_in_space(problem, motion, live)
    if found is None:
        return None
    state = judged(problem, live, motion, *found, iterations)
    return state if state.certified and float(live @ motion.velocity) > 0 else None


def judged(
    problem: ContactProblem, live: Array, motion: Motion, multiplier: float, t_n: Array, t_t: Array, iterations: int
) -> CollapseState:
    """Return forces t_n (m,), t_t (m, d-1) [kN] and a motion as a state, with the residuals of both."""
    load = problem.f + multiplier * live
    force = max(float(np.abs(problem.f).sum()), float(np.abs(live).sum()))
    size = float(np.abs(load).sum()) or force  # a live load may undo the dead one
    wrong = float(motion.flow_error(problem, t_n, t_t).max(initial=0.0)) / size
    flow = max(wrong, motion.penetration())
    statics = static_residual(problem, load, t_n, t_t)
    return CollapseState(multiplier + 0.0, t_n, t_t, motion.velocity, statics, flow, iterations)


def _programmed(
    problem: ContactProblem, motion: Motion, live: Array, most: float
) -> tuple[float, Array, Array] | None:
    """Return least multiplier and forces that go with a motion, by a linear programme; None where there are none."""
    programme = StaticProgramme(problem)
    equations, bounds, caps, force = forces_asked_for(programme, motion, live)
    alone: Method | None = "interior" if len(bounds) >= LARGE else None  # "there are none" is not worth minutes
    result = optimise(np.r_[np.zeros(len(bounds) - 1), 1.0], equations, bounds, caps, method=alone, ceiling=most)
    if result.status != 0:
        return None
    return float(result.x[-1]), *programme.forces(result.x[:-1] * force)


def forces_asked_for(
    programme: StaticProgramme, motion: Motion, live: Array
) -> tuple[tuple[sp.csc_array, Array], Array, tuple[sp.csc_array, Array] | None, float]:
    """Return equations, bounds, caps and unit of force [kN] of the programme over forces that a motion allows.

    Its variables are those of ``programme`` and the multiplier of the live load (N,). Pairs that open carry -T, pairs
    that slip the whole strength against the slip, pairs that crush the cap; all others what their cone allows.
    """
    problem, law = programme.problem, programme.problem.laws
    rough = law.friction > 0
    bounds = programme.bounds.copy()
    pair, side = programme.rays
    sign = np.sign(motion.w_t[:, 0])
    wrong_way = motion.slips[pair] & (sign[pair] * side > 0) & rough[pair]
    bounds[: pair.size][motion.opens[pair] | wrong_way, 1] = 0.0
    full = np.flatnonzero(motion.crushes[pair] & ~rough[pair])
    bounds[full, 0] = bounds[full, 1]
    spare = problem.cone.spare
    sticky = np.flatnonzero(spare > 0)
    bounds[pair.size :][motion.slips[sticky]] = (-sign * spare)[sticky][motion.slips[sticky], None]
    A, e0 = programme.equilibrium
    force = max(float(np.abs(problem.f).sum()), float(np.abs(live).sum()))
    column = sp.csc_array((programme.project(live) / force)[:, None])
    matrix, right = sp.csc_array(sp.hstack([A, column])), -(programme.project(problem.f) + e0) / force
    caps = programme.caps
    if caps is not None:
        rows = sp.csr_array(sp.hstack([caps[0], sp.csc_array((caps[0].shape[0], 1))]))
        full = motion.crushes[np.isfinite(law.cap) & rough]
        matrix = sp.csc_array(sp.vstack([matrix, rows[full]]))
        right = np.concatenate([right, caps[1][full] / force])
        caps = (sp.csc_array(rows[~full]), caps[1][~full] / force) if not full.all() else None
    return (matrix, right), np.vstack([bounds / force, [-np.inf, np.inf]]), caps, force
