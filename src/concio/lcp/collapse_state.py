r"""Direct search for a collapse state of Coulomb friction without dilatancy.

A *collapse state* is a multiplier lambda, forces t and a rigid motion v with g'v > 0 such that

.. math:: R^T (f + \lambda g + C^T t) = 0,\quad t_k \in S_k,\quad w_n \ge 0,\quad w_n (t_n + T) = 0,\quad
          t_t = -(c + \mu t_n)\, w_t/|w_t| \text{ where } w_t \ne 0,

with w = C v: the structure can begin to move at lambda with the friction that its joints really have. There may be
many; the least multiplier among them is a mathematical programme with complementarity constraints (Ferris and Tin-Loi,
Int. J. Mech. Sci. 43, 2001). The search here is the simple iteration on the sliding strength: with the strength frozen
at c + mu t_n of the forces found last, flow is associated and dilatancy zero, a linear programme; its forces, averaged
with the old ones, give the next strength (in the spirit of Gilbert, Casapulla and Ahmed, Comput. Struct. 84, 2006).

Nothing is believed because the iteration stands still: forces of the *true* cones, with every pair in the state that
the motion asks for, are found by one more linear programme, and the state is rechecked by plain matrix products.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp

from concio.contact.problem import Array, ContactProblem
from concio.errors import InputError
from concio.lcp.existence import pair_velocities
from concio.lcp.limit import associated_limit, static_residual
from concio.lcp.statics import StaticProgramme, optimise

MOVES = 1e-8
"""Relative velocities above this share of the largest count as opening or slipping."""

CERTIFIED = 1e-8
"""Largest residual of a collapse state that is returned."""


@dataclass(frozen=True, eq=False)
class CollapseState:
    """A certified state in which the structure can begin to move under Coulomb friction.

    Parameters
    ----------
    multiplier : float
    normal_force, friction_force : arrays (m,), (m, 1)
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
        return max(self.statics, self.flow) <= CERTIFIED


def find_collapse_state(
    problem: ContactProblem, live: Array, *, iterations: int = 60, average: float = 0.5
) -> CollapseState | None:
    """Search a Coulomb collapse state and return the certified one of least multiplier met, or None.

    Parameters
    ----------
    problem : ContactProblem
        With its dead load; two-dimensional, without caps.
    live : (N,) array
    iterations : int
        Linear programmes with frozen strength.
    average : float
        Weight of the new forces in the strength.
    """
    if problem.dim != 2 or np.isfinite(problem.laws.cap).any():
        msg = "the search for collapse states handles plane problems without compressive caps"
        raise InputError(msg, hint="follow the load path instead")
    law = problem.laws
    start = associated_limit(problem, live)
    if not np.isfinite(start.multiplier):
        return None
    strength = problem.sliding_strength(start.normal_force)
    best: CollapseState | None = None
    last = np.inf
    zero = np.zeros(problem.pairs)
    for count in range(1, iterations + 1):
        frozen = replace(law, friction=zero, dilatancy=zero, cohesion=strength)
        found = associated_limit(replace(problem, laws=frozen), live)
        if not np.isfinite(found.multiplier) or found.mechanism is None:
            return best
        if abs(found.multiplier - last) <= 1e-3 * max(1.0, abs(last)):
            state = certify_collapse(problem, live, found.mechanism.velocity, count)
            if state is not None and (best is None or state.multiplier < best.multiplier - 1e-12):
                best = state
        last = found.multiplier
        strength = (1 - average) * strength + average * problem.sliding_strength(found.normal_force)
    return best


def certify_collapse(problem: ContactProblem, live: Array, velocity: Array, iterations: int) -> CollapseState | None:
    """Find forces of the true cones that go with a motion (N,), and return the certified state or None."""
    programme = StaticProgramme(problem)
    law, v = problem.laws, velocity / float(np.abs(velocity).max())
    w_n, _ = pair_velocities(problem, v)
    w_t = problem.C_t @ v
    opens, slips = w_n > MOVES, np.abs(w_t) > MOVES
    bounds = programme.bounds.copy()
    pair, direction = programme.rays
    against = np.sign(w_t)[pair] * direction[:, 0]
    bounds[: pair.size][opens[pair] | (slips[pair] & (against > 0) & (law.friction[pair] > 0)), 1] = 0.0
    sticky = np.flatnonzero(programme.spare > 0)
    bounds[pair.size :][slips[sticky]] = (-np.sign(w_t) * programme.spare)[sticky][slips[sticky], None]
    A, e0 = programme.equilibrium
    force = max(float(np.abs(problem.f).sum()), float(np.abs(live).sum()))
    column = sp.csc_array((programme.project(live) / force)[:, None])
    equations = sp.csc_array(sp.hstack([A, column])), -(programme.project(problem.f) + e0) / force
    scaled = np.vstack([bounds / force, [-np.inf, np.inf]])
    result = optimise(np.r_[np.zeros(A.shape[1]), 1.0], equations, scaled)
    if result.status != 0:
        return None
    multiplier = float(result.x[-1])
    t_n, t_t = programme.forces(result.x[:-1] * force)
    load = problem.f + multiplier * live
    total = float(np.abs(load).sum())
    friction = problem.sliding_strength(t_n) * np.sign(w_t) + t_t[:, 0]
    wrong = np.maximum(
        np.abs(np.where(opens, w_n, 0.0) * (t_n + law.tension)), np.abs(np.where(slips, w_t, 0.0) * friction)
    )
    flow = max(float(wrong.max(initial=0.0)) / total, float(np.maximum(-w_n, 0.0).max(initial=0.0)))
    statics = static_residual(problem, load, t_n, t_t)
    state = CollapseState(multiplier, t_n, t_t, v, statics, flow, iterations)
    return state if state.certified and float(live @ v) > 0 else None
