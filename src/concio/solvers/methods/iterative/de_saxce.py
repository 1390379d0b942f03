r"""Bipotential of De Saxcé: Coulomb friction as a fixed point on convex problems.

Coulomb's law is a normality rule for a shifted gap:

.. math:: -\bigl(y_n + (\mu - \tan\psi)\,|y_t|,\; y_t\bigr) \in N_S(t),

``S`` the strength domain of the pair and ``N_S`` its normal cone. With the shift ``s = (mu - tan psi)|y_t|`` held, this
is associated friction: a convex minimum problem (augmented Lagrangian with Euclidean projections, Newton steps with a
line search on its energy, no parameter to tune). Its slip gives the next shift. Associated joints
(``tan psi = mu``) need one problem; Coulomb joints a fixed point, which contracts where slip is moderate and may
oscillate near collapse: the shift is then under-relaxed, halved when the change grows and raised again when it falls.

Floating bodies are no obstacle; every joint law is supported (the cap truncates ``S``), in two and three dimensions.

References
----------
G. De Saxcé, Z.-Q. Feng, New inequation and functional for contact with friction: the implicit standard material
approach, *Mech. Struct. Mach.* 19 (1991) 301-325. V. Acary, F. Cadoux, C. Lemaréchal, J. Malick, A formulation of the
linear discrete Coulomb friction problem via convex optimization, *ZAMM* 91 (2011) 155-175 (the fixed point).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from concio.problem.contact_problem import ContactProblem
from concio.problem.solution import ProgressCallback, Solution
from concio.solvers.algebra.scaled import scale
from concio.solvers.methods.iterative.augmented import Augmented, multipliers
from concio.solvers.methods.iterative.iteration import GOAL, Record, Stopped, answer, require_positive

WINDOW = 20
"""Changes of a fixed point in which it has to make progress."""

LOOSE = 1e-4
"""Accuracy of the first convex problem: as the fixed point settles, the problems are solved more exactly."""


def solve(
    problem: ContactProblem,
    *,
    progress: ProgressCallback | None = None,
    augmentation: float = 10.0,
    limit: int = 300,
    steps: int = 3000,
) -> Solution:
    """Solve by the fixed point of the bipotential.

    Parameters
    ----------
    problem : ContactProblem
    progress : callable, optional
    augmentation : float
        rho of the convex problems in multiples of the typical stiffness, positive.
    limit : int
        Convex problems.
    steps : int
        Newton steps in all.

    Raises
    ------
    MethodError
        ``augmentation`` is not positive.
    """
    require_positive("augmentation", augmentation, "try 10")
    s = scale(problem)
    record = Record("de-saxce", s, progress, budget=steps)
    record.info["unknowns"] = s.f.size
    law = Augmented(s, s.cone, isotropic(s.compliance, augmentation), s.start, s.cone.friction)
    lag = np.maximum(s.cone.friction - s.dilatancy, 0.0)
    u, shift, relax, before, outer = s.glued, np.zeros(s.pairs), 1.0, np.inf, 0
    least = GOAL if (lag == 0.0).all() else LOOSE
    changes: list[float] = []
    try:
        for outer in range(1, limit + 1):
            u, t, law = multipliers(replace(law, shift=shift), u, record, goal=inexact(before, least))
            law = replace(law, rho=isotropic(s.compliance, augmentation))
            if record.note(u, t, f"convex problem {outer}") <= 10.0 * GOAL:
                break
            slip = np.linalg.norm(s.opening(u)[:, 1:] + s.compliance[:, 1:] * t[:, 1:], axis=1)
            change = float(np.abs(lag * slip - shift).max(initial=0.0))
            if change > 0.95 * before:
                relax = max(0.5 * relax, 1.0 / 16.0)
            elif change < before:
                relax = min(1.1 * relax, 1.0)
            before = change
            shift = shift + relax * (lag * slip - shift)
            if change_stalls(changes, change):
                record.trace.append(f"the fixed point stopped contracting after {outer} problems.")
                break
    except Stopped as stop:
        return answer(problem, record, cancelled=stop.cancelled)
    record.info.update(convex_problems=outer, relaxation=relax)
    return answer(problem, record)


def isotropic(compliance: np.ndarray, augmentation: float) -> np.ndarray:
    """Return rho (m, d) such that 1/rho + a is the same in all directions of a pair (Euclidean projections)."""
    total = 1.0 / augmentation + compliance.max(axis=1, keepdims=True)
    rho: np.ndarray = 1.0 / (total - compliance)
    return rho


def inexact(change: float, least: float) -> float:
    """Accuracy of the next convex problem: a hundredth of the last change of the fixed point, at most ``least``."""
    return max(0.1 * GOAL, min(least, 0.01 * change))


def change_stalls(changes: list[float], change: float) -> bool:
    """Append the change of a fixed point and tell whether the last ``WINDOW`` of them made no progress."""
    changes.append(change)
    return len(changes) > 2 * WINDOW and min(changes[-WINDOW:]) > 0.9 * min(changes[:-WINDOW])
