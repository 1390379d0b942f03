r"""Alternating normal and Tresca problems (Panagiotopoulos): Coulomb friction as a fixed point on the friction bound.

*Tresca friction* has a sliding strength that does not depend on the normal force; with it the contact problem is a
convex quadratic program. Two alternations lead from it to Coulomb friction:

* ``form="alternating"``, the classical one: normal forces with friction forces held (a unilateral problem), then
  friction forces with normal forces held (a problem of bounded friction), and again. Holding friction forces leaves a
  floating body nothing but its normals to rest on: a block on a flat base would need friction forces that balance to
  the last digit. It applies where K is positive definite, and converges where the bodies are held well.
* ``form="tresca"``, the default: both forces free, the sliding strength ``c + mu t_n`` held, then updated. It keeps
  the rigid motions and applies to floating bodies. A Tresca problem in between may have no equilibrium although the
  Coulomb problem has one; the first strength is therefore taken from associated friction, whose forces are in
  equilibrium, and a proximal term ``prox |u - u_before|^2 / 2`` bounds the steps; it vanishes at the fixed point.

Both contract for small friction (the map has a Lipschitz constant proportional to mu and to the coupling of normal and
tangential displacements) and oscillate beyond; the update is then relaxed, more when the change
grows and less when it falls. Each convex
problem is solved by the method of multipliers with Newton steps and a line search on its energy.

Dilatancy couples the normal problem to the slip: the opening ``tan(psi) |y_t|`` is held like the sliding strength.

References
----------
P. D. Panagiotopoulos, A nonlinear programming approach to the unilateral contact- and friction-boundary value problem
in the theory of elasticity, *Ingenieur-Archiv* 44 (1975) 421-432.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from concio.errors import MethodError
from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.solution import ProgressCallback, Solution
from concio.solvers.algebra.scaled import scale
from concio.solvers.methods.iterative.augmented import Augmented, multipliers
from concio.solvers.methods.iterative.de_saxce import LOOSE, change_stalls, inexact, isotropic
from concio.solvers.methods.iterative.iteration import GOAL, Record, Stopped, answer, require_positive


def solve(
    problem: ContactProblem,
    *,
    progress: ProgressCallback | None = None,
    form: str = "tresca",
    augmentation: float = 10.0,
    prox: float = 1e-3,
    limit: int = 150,
    steps: int = 3000,
) -> Solution:
    """Solve by alternating convex problems.

    Parameters
    ----------
    problem : ContactProblem
    progress : callable, optional
    form : {"tresca", "alternating"}
        Which alternation.
    augmentation : float
        rho of the convex problems in multiples of the typical stiffness, positive.
    prox : float
        Proximal weight of the Tresca form in multiples of the typical stiffness; ignored where K is regular.
    limit : int
        Alternations.
    steps : int
        Newton steps in all.

    Raises
    ------
    MethodError
        An option is not usable, or ``form="alternating"`` meets floating bodies.
    """
    if form not in ("tresca", "alternating"):
        msg = f"unknown form '{form}'"
        raise MethodError(msg, hint="one of: tresca, alternating")
    require_positive("augmentation", augmentation, "try 10")
    if form == "alternating" and problem.rigid_motions:
        msg = (
            f"alternating normal and friction problems need K positive definite, {problem.rigid_motions} rigid motions "
            "are free"
        )
        raise MethodError(msg, hint="form='tresca' keeps them, so do the methods simo-laursen and interior-point")
    s = scale(problem)
    record = Record("panagiotopoulos", s, progress, budget=steps)
    record.info["unknowns"] = s.f.size
    cycle = _tresca if form == "tresca" else _alternating
    prox = prox if problem.rigid_motions else 0.0
    rho, zero = np.full_like(s.x, augmentation), np.zeros(s.pairs)
    u, relax, before, outer = s.glued, 1.0, np.inf, 0
    slip = np.zeros(s.pairs)
    changes: list[float] = []
    try:
        associated = Augmented(s, s.cone, isotropic(s.compliance, augmentation), s.start, s.cone.friction)
        u, t, _ = multipliers(associated, u, record, goal=1e-3)
        held = t
        for outer in range(1, limit + 1):
            law = Augmented(s, s.cone, rho, t, flow=zero, shift=-s.dilatancy * slip, anchor=u, prox=prox)
            u, t = cycle(law, record, u, held, inexact(before, LOOSE))
            if record.note(u, t, f"alternation {outer}") <= 10.0 * GOAL:
                break
            change = float(np.abs(t - held).max(initial=0.0))
            if change > 0.95 * before:
                relax = max(0.5 * relax, 1.0 / 16.0)
            elif change < before:
                relax = min(1.1 * relax, 1.0)
            before = change
            held = held + relax * (t - held)
            slip = np.linalg.norm(s.opening(u)[:, 1:] + s.compliance[:, 1:] * t[:, 1:], axis=1)
            if change_stalls(changes, change):
                record.trace.append(f"the fixed point stopped contracting after {outer} problems.")
                break
    except Stopped as stop:
        return answer(problem, record, cancelled=stop.cancelled)
    record.info.update(alternations=outer, relaxation=relax, form=form)
    return answer(problem, record)


def _tresca(law: Augmented, record: Record, u: Array, held: Array, goal: float) -> tuple[Array, Array]:
    """One Tresca problem with the sliding strength of the normal forces held."""
    cone = law.scaled.cone
    u, t, _ = multipliers(replace(law, cone=cone.tresca(cone.strength(held[:, 0]))), u, record, goal=goal)
    return u, t


def _alternating(law: Augmented, record: Record, u: Array, held: Array, goal: float) -> tuple[Array, Array]:
    """One normal problem with friction held, one friction problem with the normal forces found held."""
    cone, zero = law.scaled.cone, law.flow
    normal, tangential = law.lam.copy(), held.copy()
    normal[:, 1:], tangential[:, 0] = 0.0, 0.0
    u, t, _ = multipliers(replace(law, cone=cone.tresca(zero), lam=normal, fixed=tangential), u, record, goal=goal)
    pressed = t.copy()
    pressed[:, 1:] = 0.0
    bound = replace(cone.tresca(cone.strength(t[:, 0])), tension=zero, cap=zero)
    u, t, _ = multipliers(replace(law, cone=bound, lam=tangential, shift=0.0, fixed=pressed), u, record, goal=goal)
    return u, t
