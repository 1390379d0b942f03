r"""The straight beginning of a path: from rest, under loads that grow in proportion, it is a ray.

Where nothing has a size of its own (no initial gap, no cohesion, tensile strength, cap or prestress) all conditions of
a load step are cones: if (u, t) is the answer to the loads f, then (tau u, tau t) answers tau f, with the same states.
Slip grows in one direction only, so friction opposes its rate as well as its sum, and the answers of all tau together
are a quasi-static path. One load step gives it exactly, and its end is all that later stages need: no events lie on it,
for pairs open, stick or slip from the first load on.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from concio.problem.contact_problem import ContactProblem
from concio.problem.limits_of_work import SMALL_PATH
from concio.problem.solution import ProgressCallback, Solution, Status
from concio.solvers.auto import chain as auto
from concio.solvers.interior import engine
from concio.solvers.path.path_state import LinearPath, PathState, state_of


def homogeneous(path: LinearPath) -> bool:
    """Tell whether a path begins without loads at rest, and nothing in it has a size of its own."""
    problem, law = path.problem, path.problem.laws
    sized = (law.cohesion > 0) | (law.tension > 0) | np.isfinite(law.cap) | (problem.gap != 0)
    return not (sized.any() or problem.f.any() or problem.slip_origin.any())


def ray(
    path: LinearPath, rest: PathState, *, until: float = 1.0, progress: ProgressCallback | None = None
) -> PathState | None:
    """Return the state at ``until`` on the straight path from rest; None where one load step does not find it.

    Parameters
    ----------
    path : LinearPath
        :func:`homogeneous`.
    rest : PathState
        At parameter 0.
    until : float
    progress : callable, optional
    """
    solution = solve_from_rest(path.at(until), progress)
    if not solution.solved:
        return None
    u, t_n, t_t = solution.displacement, solution.normal_force, solution.friction_force
    return state_of(path, until, u, t_n, t_t, before=rest)


def solve_from_rest(problem: ContactProblem, progress: ProgressCallback | None) -> Solution:
    """Solve one load step quickly; small problems by whatever else it takes."""
    solution = engine.solve(problem, homotopy=False, progress=progress)
    if solution.solved or problem.pairs > SMALL_PATH or solution.status is Status.CANCELLED:
        return solution
    return auto.solve(problem, progress=progress)


def restarted(state: PathState) -> PathState:
    """Return a state as the beginning of another path: parameter, work and dissipation count from it."""
    return replace(state, parameter=0.0, work=0.0, dissipation=0.0)
