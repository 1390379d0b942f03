r"""Penalty method: joints are springs, stiff in contact and in stick (Kikuchi and Oden).

Every hard joint is given the compliance ``1/r`` of a spring,

.. math:: t_n = \mathrm{clip}(-r\,y_n, -T, N), \qquad t_t = \mathrm{proj}_{|t_t| \le c + \mu t_n}(-r\,y_t),

and equilibrium is found by the semismooth Newton steps of :mod:`.alart_curnier` on
displacements and spring
forces together (same answer as on displacements alone, and much more robust), ``r`` raised tenfold at a time from the
typical stiffness so that each problem starts near its answer.

The error it leaves: bodies overlap by ``t_n / r`` and creep by ``t_t / r`` before they slip, so that displacements are
wrong by about ``1/r`` in units of the typical displacement (reported as ``info["penetration"]``, in metres). A larger
``r`` leaves less and makes the Newton steps harder. On hard joints the method therefore never certifies: its outcome
is "gave up" at the accuracy of ``info["accuracy"]``. Joints with compliance of their own are springs already; they get
no other, and where all are, the answer is exact.

Floating bodies are no obstacle: ``K + r C' P' C`` is regular where contacts hold them.

References
----------
N. Kikuchi, J. T. Oden, *Contact Problems in Elasticity*, SIAM, 1988.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from concio.problem.contact_problem import ContactProblem
from concio.problem.solution import ProgressCallback, Solution
from concio.solvers.algebra.scaled import scale
from concio.solvers.methods.iterative.alart_curnier import newton
from concio.solvers.methods.iterative.iteration import GOAL, Record, Stopped, answer, require_positive, residual_of


def solve(
    problem: ContactProblem,
    *,
    progress: ProgressCallback | None = None,
    stiffness: float = 1e4,
    limit: int = 60,
) -> Solution:
    """Solve by penalty springs.

    Parameters
    ----------
    problem : ContactProblem
    progress : callable, optional
    stiffness : float
        Spring stiffness r in multiples of the typical stiffness of the structure, positive.
    limit : int
        Newton steps at each stiffness.

    Raises
    ------
    MethodError
        ``stiffness`` is not positive.
    """
    require_positive("penalty stiffness", stiffness, "try 1e4")
    s = scale(problem)
    record = Record("penalty", s, progress)
    record.info["unknowns"] = s.f.size + s.x.size
    u, t = s.glued, s.start
    hard = s.compliance == 0.0
    steps = np.geomspace(1.0, stiffness, 1 + max(1, round(np.log10(max(stiffness, 1.0))))) if hard.any() else [1.0]
    converged, r = False, 1.0
    try:
        for r in steps:
            springs = replace(s, compliance=np.where(hard, 1.0 / r, s.compliance))
            u, t, converged = newton(springs, record, u, t, goal=GOAL, limit=limit)
            record.best = (residual_of(s, u, t), u, t)
    except Stopped as stop:
        return answer(problem, record, cancelled=stop.cancelled)
    left = np.where(hard, np.abs(t) / r, 0.0)[:, 0]
    record.info.update(stiffness=stiffness, penetration=float(left.max(initial=0.0)) * s.length)
    record.trace.append(
        f"penalty springs of {stiffness:.0e} times the typical stiffness leave a penetration of "
        f"{record.info['penetration']:.1e} m."
        if converged
        else f"Newton steps did not find the equilibrium of the penalty springs (last stiffness {r:.0e})."
    )
    return answer(problem, record)
