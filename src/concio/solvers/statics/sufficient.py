"""A sufficient condition for equilibrium (after Del Piero): positive normal forces that, alone, balance the loads."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.tolerances import ADMISSIBLE, CLEARLY
from concio.representation import short_repr
from concio.solvers.statics.mechanism import total_load
from concio.solvers.statics.programme import StaticProgramme, optimise


@short_repr
@dataclass(frozen=True, eq=False)
class SufficientCondition:
    """The paper's sufficient condition for the existence of an equilibrium.

    Parameters
    ----------
    margin : float
        Largest possible value of the smallest of all t_n and, where there is a cap, N - t_n [kN]; ``inf`` where it
        can grow without bound (jammed, or no floating bodies), ``-inf`` where normal forces alone cannot balance the
        loads.
    normal_force : (m,) array
        Normal forces that attain it (for an infinite margin: the total load), zeros where there are none [kN].
    holds : bool
        True when the margin is positive, clear of rounding.
    """

    margin: float
    normal_force: Array
    holds: bool


def sufficient_condition(problem: ContactProblem) -> SufficientCondition:
    """Maximise the smallest normal force in equilibrium with the loads, without friction.

    Parameters
    ----------
    problem : ContactProblem
    """
    m, r = problem.pairs, problem.rigid_motions
    force = total_load(problem)
    capped = problem.cone.capped
    if r == 0 or m == 0:
        moved = float(np.abs(problem.R.T @ problem.f).max(initial=0.0)) > CLEARLY * force
        return SufficientCondition(-np.inf if moved else np.inf, np.zeros(m), not moved)
    programme = StaticProgramme(problem)
    A_n = sp.csc_array(sp.diags_array(1.0 / programme.scale) @ (problem.R.T @ problem.C_n.T))
    load = programme.project(problem.f) / force
    # t_n = p + s with p >= 0, s the smallest force, both in units of the total load; s = 1 stands for "no end"
    equations = sp.csc_array(sp.hstack([A_n, sp.csc_array((A_n @ np.ones(m))[:, None])])), -load
    caps, top = None, 1.0
    if capped.any():
        top = float(problem.laws.cap.min()) / force
        rows = sp.csc_array(sp.hstack([sp.eye_array(m), sp.csc_array(np.full((m, 1), 2.0))]))  # p + s <= N - s
        caps = sp.csc_array(sp.csr_array(rows)[np.flatnonzero(capped)]), problem.laws.cap[capped] / force
    bounds = np.vstack([np.column_stack([np.zeros(m), np.full(m, np.inf)]), [-np.inf, top]])
    result = optimise(np.r_[np.zeros(m), -1.0], equations, bounds, caps)
    if result.status != 0:
        return SufficientCondition(-np.inf, np.zeros(m), False)
    s = float(result.x[-1])
    t_n = (result.x[:m] + s) * force
    balance = np.abs(problem.R.T @ (problem.f + problem.C_n.T @ t_n)).max(initial=0.0) / force
    holds = s > CLEARLY and float(balance) <= ADMISSIBLE
    endless = caps is None and s > 1.0 - 1e-9
    return SufficientCondition(np.inf if endless else s * force, t_n, holds)
