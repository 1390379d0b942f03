r"""Limit load of associated friction: the static theorem, its dual mechanism, and the checks of both.

With dead load f and live load g, the *associated multiplier* is

.. math:: \lambda^* = \max\{\lambda : R^T (f + \lambda g + C^T t) = 0,\ t_k \in S_k\}
                    = \min\{h(C v) - f^T v : v = R\alpha,\ g^T v = 1,\ w_n \ge \mu |w_t| \text{ without cap}\},

the second by duality; h is the power the joints absorb (:mod:`concio.solvers.statics.mechanism`). It does not depend on
the bodies' stiffness. Every forces-and-motion pair is rechecked: the forces give a lower bound, the motion an upper
one, and what is between them is the duality gap. With Coulomb friction (no dilatancy) collapse may come earlier, never
later: lambda* is an upper bound there, and is not to be called the collapse load of a masonry wall.

Reference: Livesley, Limit analysis of structures formed from rigid blocks, Int. J. Num. Meth. Engng 12 (1978).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp

from concio.errors import SolverError
from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.parts import Part, parts_of
from concio.problem.solution import Mechanism
from concio.problem.tolerances import CHECKED, CONE_TARGET
from concio.read_only import read_only
from concio.representation import short_repr
from concio.solvers.statics.cone_statics import ConeStatics
from concio.solvers.statics.existence import statically_admissible
from concio.solvers.statics.mechanism import absorbed_power, polish, total_load, verify_mechanism
from concio.solvers.statics.programme import Method, StaticProgramme, optimise


@short_repr
@dataclass(frozen=True, eq=False)
@read_only
class LimitLoad:
    """Associated limit multiplier with its two proofs.

    Parameters
    ----------
    multiplier : float
        lambda*; ``inf`` where the load can grow without bound, ``nan`` where no multiplier with forces in balance was
        found. Where ``residual`` is not small either, nothing is known.
    upper : float
        Multiplier of the mechanism, recomputed from its velocity: h(Cv) - f'v with g'v = 1.
    normal_force, friction_force : arrays (m,), (m, d-1)
        Forces in equilibrium at the multiplier [kN].
    residual : float
        Largest entry of R'(f + lambda g + C't) and of the excess over the cones, relative to the total load.
    mechanism : Mechanism or None
        Motion of the collapse; its power is that of the loads at the multiplier less what the joints absorb: zero up
        to rounding.
    """

    multiplier: float
    upper: float
    normal_force: Array
    friction_force: Array
    residual: float
    mechanism: Mechanism | None

    @property
    def locked(self) -> bool:
        """True where friction and geometry carry any multiple of the load: it jams, and no multiplier is the last."""
        return self.multiplier == np.inf

    @property
    def words(self) -> str:
        """The multiplier, or the word for it where it is not a number."""
        if np.isnan(self.multiplier):
            return "none: no multiple of the load was found in balance"
        return "locked: any multiple of the load is carried" if self.locked else f"{self.multiplier:.6g}"

    @property
    def gap(self) -> float:
        """Relative distance of the two bounds."""
        if not np.isfinite(self.multiplier):
            return 0.0
        return abs(self.upper - self.multiplier) / max(1.0, abs(self.multiplier))

    @property
    def checked(self) -> bool:
        """True when forces and motion prove the multiplier from both sides (always for ``inf``: forces only)."""
        return self.worst <= CHECKED

    @property
    def worst(self) -> float:
        """Largest of residual, violation and gap."""
        if not np.isfinite(self.multiplier):
            return self.residual
        violation = self.mechanism.violation if self.mechanism else np.inf
        return max(self.residual, violation, self.gap)

    @property
    def bounds_hold(self) -> bool:
        """True when forces and motion are each beyond doubt, whatever lies between them.

        Then ``multiplier`` is carried and ``upper`` is not exceeded; they are the answer where they do not coincide.
        """
        violation = self.mechanism.violation if self.mechanism else np.inf
        return max(self.residual, violation) <= CHECKED


def associated_limit(problem: ContactProblem, live: Array, *, target: float = CONE_TARGET) -> LimitLoad:
    """Return the largest multiplier of the live load for associated friction.

    It is the least of the connected parts', each found by itself and in its own units.

    Parameters
    ----------
    problem : ContactProblem
        Its load is the dead load.
    live : (N,) array
        Load that is multiplied [kN].
    target : float
        Residuals and relative gap at which a cone programme ends (in space).

    Raises
    ------
    SolverError
        The linear programme stopped without an answer.
    """
    live = np.asarray(live, dtype=float)
    parts = [part for part in parts_of(problem) if part.unknowns.size]
    if len(parts) <= 1:
        return _of_one(problem, live, target)
    found = [_of_one(part.problem, live[part.unknowns], target) for part in parts]
    least = int(np.argmin([-np.inf if np.isnan(one.multiplier) else one.multiplier for one in found]))
    return _of_all(problem, live, parts, found, least)


def _of_all(
    problem: ContactProblem, live: Array, parts: Sequence[Part], found: Sequence[LimitLoad], least: int
) -> LimitLoad:
    """Return the limit load of the whole, of those of its parts."""
    m, s = problem.pairs, problem.dim - 1
    t_n, t_t, residual = np.zeros(m), np.zeros((m, s)), 0.0
    multiplier, mechanism = found[least].multiplier, found[least].mechanism
    for k, (part, one) in enumerate(zip(parts, found, strict=True)):
        normal, friction, error = one.normal_force, one.friction_force, one.residual
        if k != least and np.isfinite(multiplier):
            loads = part.problem.f + multiplier * live[part.unknowns]
            state = statically_admissible(part.problem.with_loads(loads))
            if state.exists:
                normal, friction, error = state.normal_force, state.friction_force, state.residual
            else:
                dead = statically_admissible(part.problem)
                if not (dead.exists and 0.0 < multiplier <= one.multiplier):
                    nothing = np.zeros(m), np.zeros((m, s))
                    return LimitLoad(np.nan, np.nan, *nothing, np.inf, None)  # what one carries is too little for it
                share = multiplier / one.multiplier  # what is admissible is convex: forces between those of two loads
                normal = share * normal + (1.0 - share) * dead.normal_force
                friction = share * friction + (1.0 - share) * dead.friction_force
                error = max(error, dead.residual)
        t_n[part.pairs], t_t[part.pairs], residual = normal, friction, max(residual, error)
    if mechanism is not None:
        velocity = np.zeros(problem.unknowns)
        velocity[parts[least].unknowns] = mechanism.velocity
        mechanism = replace(mechanism, velocity=velocity)
    return LimitLoad(multiplier, found[least].upper, t_n, t_t, residual, mechanism)


def _of_one(problem: ContactProblem, live: Array, target: float) -> LimitLoad:
    """Return the limit load of a connected part."""
    m, s = problem.pairs, problem.dim - 1
    nothing = (np.zeros(m), np.zeros((m, s)))
    size = float(np.abs(live).sum())
    pushed = float(np.abs(problem.R.T @ live).max(initial=0.0))
    if problem.rigid_motions == 0 or m == 0 or pushed <= 1e-12 * size:
        state = statically_admissible(problem)
        return LimitLoad(np.inf if state.exists else np.nan, np.inf, *nothing, state.residual, None)
    if problem.dim == 3:
        return cone_limit(problem, live, target)
    found = programmed_limit(problem, live, None)
    if np.isfinite(found.multiplier) and not found.checked:
        other = programmed_limit(problem, live, "highs")
        found = other if other.checked or other.worst < found.worst else found
    return found


def programmed_limit(problem: ContactProblem, live: Array, method: Method | None) -> LimitLoad:
    """Return what one linear programme says, rechecked; ``method`` as in :mod:`concio.solvers.statics.programme`."""
    nothing = (np.zeros(problem.pairs), np.zeros((problem.pairs, problem.dim - 1)))
    size = float(np.abs(live).sum())
    programme = StaticProgramme(problem)
    A, e0 = programme.equilibrium
    force = max(total_load(problem) if problem.f.any() else 0.0, size)
    column = sp.csc_array((programme.project(live) / size)[:, None])
    equations = sp.csc_array(sp.hstack([A, column])), -(programme.project(problem.f) + e0) / force
    bounds = np.vstack([programme.bounds / force, [-np.inf, np.inf]])
    caps = programme.caps
    if caps is not None:
        caps = sp.csc_array(sp.hstack([caps[0], sp.csc_array((caps[0].shape[0], 1))])), caps[1] / force
    result = optimise(np.r_[np.zeros(A.shape[1]), -1.0], equations, bounds, caps, method=method)
    if result.status == 2:
        return LimitLoad(np.nan, np.nan, *nothing, np.inf, None)
    if result.status == 3:
        state = statically_admissible(problem)
        return LimitLoad(np.inf, np.inf, state.normal_force, state.friction_force, state.residual, None)
    if result.status != 0:
        msg = f"the linear programme of the limit load stopped: {result.message}"
        raise SolverError(msg, hint="scale the model, or look for bodies of very different size")
    multiplier = float(result.x[-1]) * force / size
    x = result.x[:-1] * force
    loaded = problem.f + multiplier * live
    t_n, t_t = programme.forces(x)
    if static_residual(problem, loaded, t_n, t_t) > 1e-13:
        t_n, t_t = programme.forces(programme.balance(x, loaded))
    velocity = problem.R @ (-result.marginals / programme.scale)
    upper, mechanism = kinematic_bound(problem, live, multiplier, velocity)
    residual = static_residual(problem, loaded, t_n, t_t)
    return LimitLoad(multiplier + 0.0, upper, t_n, t_t, residual, mechanism)


def cone_limit(problem: ContactProblem, live: Array, target: float = CONE_TARGET) -> LimitLoad:
    """Return what the cone programme of space says, rechecked."""
    found = ConeStatics(problem, problem.f if problem.f.any() else live).largest(live, target=target)
    if np.isfinite(found.multiplier):
        upper, mechanism = kinematic_bound(problem, live, found.multiplier, found.velocity)
        return LimitLoad(found.multiplier + 0.0, upper, found.t[:, 0], found.t[:, 1:], found.residual, mechanism)
    dead, alone = statically_admissible(problem), statically_admissible(without_bounds(problem, live))
    worst = max(dead.residual, alone.residual)  # a load on the edge of what can grow is balanced to rounding only
    if worst <= CHECKED:
        return LimitLoad(np.inf, np.inf, dead.normal_force, dead.friction_force, worst, None)
    return LimitLoad(np.nan, np.nan, dead.normal_force, dead.friction_force, np.inf, None)


def without_bounds(problem: ContactProblem, live: Array) -> ContactProblem:
    """Return the problem whose forces may grow without bound: a load that it carries can be added any number of times.

    Pairs with a cap are left out, strength that does not grow with the pressure is taken away.
    """
    keep = ~problem.cone.capped
    s = problem.dim - 1
    zero = np.zeros(int(keep.sum()))
    laws = replace(problem.laws[keep], cohesion=zero, tension=zero)
    rows = np.repeat(keep, s)
    return replace(
        problem.with_loads(live), C_n=problem.C_n[keep], C_t=problem.C_t[rows], gap=problem.gap[keep], laws=laws,
        slip_origin=problem.slip_origin[keep], area=problem.area[keep],
    )  # fmt: skip


def static_residual(problem: ContactProblem, load: Array, t_n: Array, t_t: Array) -> float:
    """Return the largest entry of R'(load + C't) and of the excess over the cones, over the total load."""
    left = problem.R.T @ (load + problem.C_n.T @ t_n + problem.C_t.T @ t_t.ravel())
    worst = max(float(np.abs(left).max(initial=0.0)), float(problem.cone.excess(t_n, t_t).max(initial=0.0)))
    return worst / (float(np.abs(load).sum()) or 1.0)


def kinematic_bound(
    problem: ContactProblem, live: Array, multiplier: float, velocity: Array
) -> tuple[float, Mechanism]:
    """Return the multiplier of a motion (N,), polished if need be, and the motion as a rechecked mechanism.

    The mechanism is that of the load f + multiplier g; its power is zero up to rounding at the true multiplier.
    """
    loaded = problem.with_loads(problem.f + multiplier * live)
    best: tuple[float, Mechanism] | None = None
    for active in (None, 1e-9, 1e-8, 1e-7):
        v = velocity if active is None else polish(problem, velocity, active)
        mechanism = verify_mechanism(loaded, v)
        rate = float(live @ mechanism.velocity)
        if rate > 0:
            upper = (absorbed_power(problem, mechanism.velocity) - float(problem.f @ mechanism.velocity)) / rate
            if best is None or mechanism.violation < best[1].violation:
                best = upper, mechanism
        if best is not None and best[1].violation <= 1e-12:
            break
    return best if best is not None else (np.nan, verify_mechanism(loaded, velocity))
