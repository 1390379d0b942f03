r"""Augmented Lagrangian with nested or simultaneous updates of the multipliers (Simo and Laursen).

Penalty springs whose forces are corrected: with multipliers ``lam`` fixed, equilibrium under ``t = P(lam - rho
y(u))`` is found by the semismooth Newton steps of :mod:`.alart_curnier` (in each pair a spring of stiffness ``rho``
preloaded with ``lam``), then ``lam = t(u)`` and again, so that the exact joint law is reached at a finite, harmless
``rho``. *Nested* solves each equilibrium before it updates (Uzawa's outer loop, a Newton inner one); *simultaneous*
updates after each Newton step, cheaper where the states settle quickly. ``rho`` starts at ten times the typical
stiffness and is raised tenfold (at most to 1e5) while multipliers converge slowly.

Floating bodies are no obstacle; every joint law is supported. There is no proof of convergence for Coulomb friction
(no energy); the record says how far it came.

References
----------
J. C. Simo, T. A. Laursen, An augmented Lagrangian treatment of contact problems involving friction, *Computers &
Structures* 42 (1992) 97-116.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from concio.errors import MethodError
from concio.problem.contact_problem import ContactProblem
from concio.problem.solution import ProgressCallback, Solution
from concio.solvers.algebra.scaled import scale
from concio.solvers.methods.iterative.alart_curnier import newton
from concio.solvers.methods.iterative.iteration import GOAL, Record, Stopped, answer, require_positive

LARGEST = 1e5


def solve(
    problem: ContactProblem,
    *,
    progress: ProgressCallback | None = None,
    updates: str = "nested",
    augmentation: float = 10.0,
    limit: int = 400,
) -> Solution:
    """Solve by the augmented Lagrangian.

    Parameters
    ----------
    problem : ContactProblem
    progress : callable, optional
    updates : {"nested", "simultaneous"}
        When the multipliers are updated.
    augmentation : float
        rho in multiples of the typical stiffness, positive.
    limit : int
        Newton steps in all.

    Raises
    ------
    MethodError
        An option is not usable.
    """
    if updates not in ("nested", "simultaneous"):
        msg = f"unknown updates '{updates}'"
        raise MethodError(msg, hint="one of: nested, simultaneous")
    require_positive("augmentation", augmentation, "try 10")
    s = scale(problem)
    record = Record("simo-laursen", s, progress)
    record.info["unknowns"] = s.f.size + s.x.size
    u, t, rho, before = s.glued, s.start, augmentation, np.inf
    inner = 60 if updates == "nested" else 1
    try:
        while len(record.history) < limit and not record.stalled(80, 0.9):
            held = t
            springs = replace(s, compliance=s.compliance + 1.0 / rho, x=s.x - held / rho)
            u, t, _converged = newton(springs, record, u, t, goal=0.1 * GOAL, limit=inner)
            if record.note(u, t, "multipliers") <= GOAL:
                break
            change = float(np.abs(t - held).max(initial=0.0)) / rho
            if change > 0.25 * before and rho < LARGEST:
                rho *= 10.0
            before = change
    except Stopped as stop:
        return answer(problem, record, cancelled=stop.cancelled)
    record.info.update(augmentation=rho, updates=updates)
    return answer(problem, record)
